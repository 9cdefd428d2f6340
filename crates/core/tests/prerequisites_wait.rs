//! Is a unit shown after all that it needs, in whatever order units arrive?

// A test that cannot go on panics.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod looking;
mod scene_packs;

use foveal_core::content::demand::Content;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::pack::ScenePack;
use foveal_core::pack::{HEADER_BYTES, Header};
use foveal_core::session::actions::{Pace, SessionAction, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::{Session, SessionSettings};
use std::sync::Arc;

/// The scene of the square that is refined once.
fn scene() -> Scene {
    let bytes = scene_packs::pack_of(|_| ());
    let header = Header::parse(&bytes).unwrap();
    let part = |from: u64, bytes_of: u64| &bytes[from as usize..(from + bytes_of) as usize];
    let description = part(HEADER_BYTES as u64, u64::from(header.description_bytes));
    let about = ScenePack::describe(&header, description).unwrap();
    let table = about.units_table().unwrap();
    let table = part(table.offset, table.bytes);
    let index = part(header.index_offset, header.index_bytes);
    let pack = ScenePack::new(&header, about, index, table).unwrap();
    Scene::new("square", Arc::new(pack))
}

/// The numbers of the units that are uploaded.
fn uploaded(actions: &[SessionAction]) -> Vec<u32> {
    let unit = |action: &SessionAction| match action {
        SessionAction::Upload(piece) => Some(piece.unit.unit.0),
        _ => None,
    };
    actions.iter().filter_map(unit).collect()
}

#[test]
fn what_arrives_before_its_prerequisite_waits_for_it() {
    let settings = SessionSettings {
        policy: PolicyConfig::new(Policy::Full),
        bytes_per_s: None,
        since: None,
        zooms: false,
        bounds: Bounds::default(),
    };
    let mut session = Session::new(vec![Arc::new(scene()) as Arc<dyn Content>], settings);
    let now = |wall| looking::looking(wall, 0.0, Pace::Standing, [0.0; 2], 100);
    session.step(&now(0.0));
    let asked = session.requested().to_vec();
    let units: Vec<u32> = asked.iter().map(|piece| piece.unit.unit.0).collect();
    assert_eq!(units, [0, 1], "what is needed is asked for first");
    let arrives = |session: &mut Session, piece| {
        session.take(SessionEvent::Decoded { piece, frames: 1 });
        let wall = f64::from(session.requested().len() as u32 + 1);
        uploaded(&session.step(&now(wall)))
    };
    assert!(arrives(&mut session, asked[1]).is_empty());
    assert!(!session.states().is_resident(asked[1]));
    assert_eq!(arrives(&mut session, asked[0]), [0, 1]);
    assert!(session.is_settled());
}
