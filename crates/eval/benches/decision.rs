//! How long does one decision for one viewer of a 16K cube take?

#[path = "../../core/tests/looking/mod.rs"]
mod looking;
#[path = "../../core/tests/made_video/mod.rs"]
mod made_video;

use criterion::{Criterion, criterion_group, criterion_main};
use foveal_core::content::demand::Content;
use foveal_core::content::policy::Policy;
use foveal_core::content::policy::asked::Detail;
use foveal_core::pack::PackError;
use foveal_core::session::actions::Pace;
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::view::surface::Projection;
use std::sync::Arc;

fn decision(criterion: &mut Criterion) -> Result<(), PackError> {
    let video = made_video::Made::new(Projection::Cube, [4096; 2], 256).build()?;
    let scene: Vec<Arc<dyn Content>> = vec![video];
    let mut group = criterion.benchmark_group("decision, 16K cube in tiles of 256");
    for policy in [Policy::Acuity, Policy::Viewport, Policy::Perceptual] {
        let settings = SessionSettings {
            policy: Detail::Usual.of(policy),
            bytes_per_s: Some(200_000.0),
            since: None,
            zooms: false,
            measures: false,
            bounds: Bounds::default(),
        };
        let mut session = Session::new(scene.clone(), settings);
        let mut step = 0u32;
        group.bench_function(policy.name(), |bencher| {
            bencher.iter(|| {
                step += 1;
                let at = f64::from(step) * 0.04;
                let gaze = [0.1 * f64::from(step), 0.1];
                let now = looking::looking(at, at, Pace::Playing, gaze, 1000);
                session.pass(u64::from(step), &now)
            });
        });
    }
    group.finish();
    Ok(())
}

fn run(criterion: &mut Criterion) {
    if let Err(error) = decision(criterion) {
        eprintln!("{error}");
    }
}

criterion_group!(benches, run);
criterion_main!(benches);
