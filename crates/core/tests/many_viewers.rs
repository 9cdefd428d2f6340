//! How much does each of many viewers of one scene hold, and how long does it take to choose?

use crate::counting;
use crate::looking;
use crate::made_video;
use foveal_core::content::demand::Content;
use foveal_core::content::policy::asked::Detail;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::session::actions::{Pace, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::view::surface::Projection;
use std::sync::Arc;
use std::time::Instant;

/// Viewers of the scene.
const VIEWERS: u32 = 100;
/// What each may hold of its own, in bytes.
const MOST: i64 = 1 << 20;

fn viewer(scene: &[Arc<dyn Content>], config: &PolicyConfig) -> Session {
    let settings = SessionSettings {
        policy: config.clone(),
        bytes_per_s: Some(200_000.0),
        since: None,
        zooms: false,
        measures: false,
        bounds: Bounds::default(),
    };
    Session::new(scene.to_vec(), settings)
}

/// Lets a viewer look here and there; returns the times that choosing took, in milliseconds.
fn look(session: &mut Session, viewer: u32) -> Vec<f64> {
    let look = |step: u32| {
        let at = f64::from(step) * 0.04;
        let gaze = [0.01 * f64::from(viewer) + 0.1 * f64::from(step), 0.1];
        let now = looking::looking(at, at, Pace::Playing, gaze, 1000);
        let begun = Instant::now();
        session.step(&now);
        let took = begun.elapsed().as_secs_f64() * 1e3;
        for piece in session.requested().to_vec() {
            session.take(SessionEvent::Decoded { piece, frames: 1 });
        }
        took
    };
    (0..4).map(look).collect()
}

#[test]
fn a_hundred_viewers_of_a_16k_cube_hold_at_most_a_mebibyte_each() {
    let video = made_video::Made::new(Projection::Cube, [4096; 2], 256).build();
    let scene: Vec<Arc<dyn Content>> = vec![video.unwrap()];
    let configs = [Policy::Acuity, Policy::Viewport, Policy::Perceptual];
    let configs = configs.map(|policy| Detail::Usual.of(policy));
    // What the first viewers make for all is not the others'.
    let firsts = configs.each_ref().map(|config| {
        let mut session = viewer(&scene, config);
        look(&mut session, 0);
        session
    });
    let mut seen = [(0, Vec::new()), (0, Vec::new()), (0, Vec::new())];
    let mut sessions = Vec::with_capacity(VIEWERS as usize);
    for number in 0..VIEWERS {
        let which = number as usize % configs.len();
        let before = counting::held();
        let mut session = viewer(&scene, &configs[which]);
        let times = look(&mut session, number);
        sessions.push(session);
        let held = counting::held() - before;
        assert!(held <= MOST, "{:?}: {held} bytes", configs[which].policy);
        seen[which].0 = seen[which].0.max(held);
        seen[which].1.extend_from_slice(&times[1..]);
    }
    for (config, (held, mut times)) in configs.iter().zip(seen) {
        times.sort_by(f64::total_cmp);
        let (policy, median) = (config.policy.name(), times[times.len() / 2]);
        eprintln!("{policy}: at most {held} bytes a viewer, {median:.2} ms a decision");
    }
    assert_eq!(sessions.len() + firsts.len(), 103);
}
