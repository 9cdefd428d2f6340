//! How does what a session decides reach what draws?

use crate::error::PlayError;
use foveal_core::content::payload::Payload;
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Cache, Now, SessionAction};
use foveal_core::session::session::Session;
use foveal_render::Drawer;

/// Moves a session on: what is to be done then.
pub(crate) fn decide(session: &mut Session, now: &Now) -> Vec<SessionAction> {
    session.step(now)
}

/// Has a session leave room on the GPU for the pictures of a moment.
pub(crate) fn leave_room(
    session: &mut Session,
    drawer: &mut Drawer,
    moment: &Moment,
) -> Result<(), PlayError> {
    if let Some(room) = drawer.expect(&moment.views)? {
        session.take(room);
    }
    Ok(())
}

/// Moves a session on and draws what it shows; returns whether the picture changed, and what is
/// left to do.
pub(crate) fn step(
    session: &mut Session,
    now: &Now,
    cache: &mut Cache<Payload>,
    drawer: &mut Drawer,
) -> Result<(bool, Vec<SessionAction>), PlayError> {
    leave_room(session, drawer, &now.moment)?;
    let measured = drawer.measure(session, &now.moment)?;
    let evicted = drawer.take_evicted();
    measured
        .into_iter()
        .chain(evicted)
        .for_each(|event| session.take(event));
    let performed = drawer.perform(decide(session, now), cache, now)?;
    // What came is measured while the next picture is awaited.
    let measured = drawer.measure(session, &now.moment)?;
    measured.into_iter().for_each(|event| session.take(event));
    Ok(performed)
}
