//! How do two assets play, within one budget?

use foveal_core::content::demand::Content;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::session::actions::{Cache, Now, Pace, SessionAction, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::{Piece, UnitState};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Seconds ahead that a standing picture borrows bytes, at most.
const BORROWED_S: f64 = 8.0;

/// Plays some steps of two assets, whose pieces are there at the next step. Returns the bytes that
/// became resident of each, beyond its coarsest level; never more than the link brings.
pub fn play(
    contents: &[Arc<dyn Content>; 2],
    (policy, bytes_per_s): (Policy, f64),
    steps: &[Now],
    payload: impl Fn(Piece) -> Payload,
    mut perform: impl FnMut(Vec<SessionAction>, &mut Cache<Payload>, &Now) -> Option<SessionEvent>,
) -> [u64; 2] {
    let settings = SessionSettings {
        policy: PolicyConfig::new(policy),
        bytes_per_s: Some(bytes_per_s),
        since: None,
        zooms: false,
        measures: false,
        bounds: Bounds::default(),
    };
    let mut session = Session::new(contents.to_vec(), settings);
    let (mut cache, mut seen, mut bytes) = (Cache::default(), BTreeSet::new(), [0; 2]);
    for now in steps {
        let actions = session.step(now);
        let evicted = perform(actions, &mut cache, now);
        evicted.into_iter().for_each(|event| session.take(event));
        let shown = session.states().in_state(UnitState::Shown).into_iter();
        for new in shown.map(|it| it.unit).filter(|unit| seen.insert(*unit)) {
            let asset = usize::from(new.asset.0);
            let unit = contents[asset].unit(new.unit);
            let is_fine = unit.level < contents[asset].coarsest();
            bytes[asset] += u64::from(is_fine) * u64::from(unit.bytes.unwrap());
        }
        let passed = match now.pace {
            Pace::Standing => now.wall.0 + BORROWED_S,
            _ => now.wall.0,
        };
        let spent = bytes.iter().sum::<u64>() as f64;
        assert!(spent <= passed * bytes_per_s, "{spent} in {passed} s");
        for piece in session.requested().to_vec() {
            cache.insert(piece, payload(piece));
            session.take(SessionEvent::Decoded { piece, frames: 1 });
        }
    }
    bytes
}
