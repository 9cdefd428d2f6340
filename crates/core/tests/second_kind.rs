//! Do selection and sessions serve a kind of content that they have never heard of?

use crate::boxes::Boxes;
use crate::looking;
use crate::made_video;
use foveal_core::content::demand::Content;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::session::actions::{Pace, SessionAction, SessionEvent};
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::UnitState;
use foveal_core::session::{bounds::Bounds, log_of_parts::SessionLog};
use foveal_core::view::surface::Projection;
use std::collections::BTreeSet;
use std::sync::Arc;

const BYTES_PER_S: f64 = 20_000.0;

#[test]
fn boxes_beside_a_video_are_bought_within_one_budget_hidden_logged_and_replayed() {
    let video = made_video::Made::new(Projection::Flat, [800, 480], 64).build();
    let scene: Vec<Arc<dyn Content>> = vec![video.unwrap(), Arc::new(Boxes::default())];
    let settings = SessionSettings {
        policy: PolicyConfig::new(Policy::Perceptual),
        bytes_per_s: Some(BYTES_PER_S),
        since: None,
        zooms: false,
        measures: false,
        bounds: Bounds::default(),
    };
    let mut session = Session::new(scene.clone(), settings);
    let (mut text, mut spent, mut is_hidden) = (String::new(), 0, false);
    let mut seen = BTreeSet::<UnitRef>::new();
    for step in 0..160 {
        let (at, yaw) = (f64::from(step) * 0.02, f64::from(step / 80) * 0.5 - 0.25);
        for action in session.step(&looking::looking(at, at, Pace::Playing, [yaw, 0.0], 640)) {
            if let SessionAction::Log(lines) = action {
                text.push_str(&lines);
            }
        }
        let shown = session.states().in_state(UnitState::Shown);
        let shown: BTreeSet<UnitRef> = shown.into_iter().map(|it| it.unit).collect();
        let mut boxes = seen.iter().filter(|it| it.asset.0 == 1);
        is_hidden |= boxes.any(|it| !shown.contains(it));
        for unit in shown.into_iter().filter(|unit| seen.insert(*unit)) {
            let (content, unit) = (&scene[usize::from(unit.asset.0)], unit.unit);
            let is_fine = content.unit(unit).level < content.coarsest();
            spent += u64::from(is_fine) * u64::from(content.unit(unit).bytes.unwrap());
        }
        assert!(spent as f64 <= at * BYTES_PER_S, "{spent} bytes in {at} s");
        for piece in session.requested().to_vec() {
            session.take(SessionEvent::Decoded { piece, frames: 1 });
        }
    }
    let boxes = seen.iter().filter(|it| it.asset.0 == 1).count();
    assert!(boxes.min(seen.len() - boxes) > 50 && is_hidden, "{boxes}");
    let log = SessionLog::parse(&text).unwrap();
    let content = |asset: AssetId| Arc::clone(&scene[usize::from(asset.0)]);
    let again = log.replay(&|asset, head, config| content(asset).demand(head, config));
    assert_eq!(again.write(), text);
    assert!(log.parts[0].frames.iter().any(|it| it.more[0].samples > 1));
}
