//! How does what a session decides reach what draws?

use crate::error::PlayError;
use foveal_core::content::payload::Payload;
use foveal_core::session::actions::{Cache, Now, SessionAction};
use foveal_core::session::session::Session;
use foveal_render::Drawer;

/// Moves a session on and draws what it shows; returns whether the picture changed, and what is
/// left to do.
pub(crate) fn step(
    session: &mut Session,
    now: &Now,
    cache: &mut Cache<Payload>,
    drawer: &mut Drawer,
) -> Result<(bool, Vec<SessionAction>), PlayError> {
    perform(session.step(now), cache, drawer)
}

/// Draws what is shown; returns whether the picture changed, and what is left to do.
pub(crate) fn perform(
    actions: Vec<SessionAction>,
    cache: &mut Cache<Payload>,
    drawer: &mut Drawer,
) -> Result<(bool, Vec<SessionAction>), PlayError> {
    let (mut changed, mut left) = (false, Vec::new());
    for action in actions {
        match action {
            SessionAction::BeginFrame(frame) => {
                drawer.begin_frame(frame);
                changed = true;
            }
            SessionAction::Upload(piece) => {
                if let Some(payload) = cache.take(piece) {
                    drawer.upload(piece, payload)?;
                    changed = true;
                }
            }
            SessionAction::Keep(units) => {
                drawer.keep(&units);
                changed = true;
            }
            SessionAction::Drop(piece) => drop(cache.take(piece)),
            other => left.push(other),
        }
    }
    Ok((changed, left))
}
