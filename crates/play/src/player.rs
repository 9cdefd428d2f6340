//! How does what a session decides become pictures?
//!
//! Every player of Foveal is this one: of a window and a page, which move it on as time goes by
//! with [`Player::step`], and of simulations, which have it make one picture after the other.

use crate::error::PlayError;
use crate::supply::Supply;
use foveal_core::content::opened::Opened;
use foveal_core::content::payload::Payload;
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Cache, Now, SessionAction, SessionEvent};
use foveal_core::session::decoder::{DecodeError, Decoded};
use foveal_core::session::log::SessionFrame;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::Piece;
use foveal_render::{Drawer, DrawnScene, TileDrawer, TileStyle};
use std::error::Error;

/// A session with what brings and draws for it.
pub struct Player {
    pub(crate) opened: Opened,
    pub(crate) session: Session,
    pub(crate) drawer: Drawer,
    pub(crate) supply: Box<dyn Supply>,
    cache: Cache<Payload>,
    /// Receives what a person should know but is not an error.
    tell: fn(&str),
    /// A person knows of damage.
    has_warned: bool,
    #[cfg(feature = "native")]
    pub(crate) run: crate::run_memory::RunMemory,
}

/// What a step did.
#[derive(Clone, Debug, Default)]
pub struct Stepped {
    /// Whether the picture changed.
    pub changed: bool,
    /// Whether other pieces are wanted than before.
    pub wants: bool,
    /// Lines of the session log.
    pub log: String,
    /// What was chosen, as the log records it, where something was.
    pub chosen: Option<Box<SessionFrame>>,
}

impl Player {
    /// Plays what was opened; `tell` receives what a person should know but is not an error.
    #[must_use]
    pub fn new(
        opened: Opened,
        settings: SessionSettings,
        drawer: Drawer,
        supply: Box<dyn Supply>,
        tell: fn(&str),
    ) -> Self {
        Self {
            session: Session::new(vec![opened.content()], settings),
            opened,
            drawer,
            supply,
            cache: Cache::default(),
            tell,
            has_warned: false,
            #[cfg(feature = "native")]
            run: Default::default(),
        }
    }

    /// What is played.
    #[must_use]
    pub fn opened(&self) -> &Opened {
        &self.opened
    }

    /// What decides.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// What decides, to be asked for something else.
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// What draws.
    #[must_use]
    pub fn drawer(&self) -> &Drawer {
        &self.drawer
    }

    /// What draws, to draw.
    pub fn drawer_mut(&mut self) -> &mut Drawer {
        &mut self.drawer
    }

    /// How tiles become a picture; of a scene as by default.
    #[must_use]
    pub fn style(&self) -> TileStyle {
        let tiles = self.drawer.tiles();
        tiles.map(TileDrawer::style).unwrap_or_default()
    }

    /// Triangles of a scene that the last picture drew; of video none.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        let scene = self.drawer.scene();
        scene.map_or(0, DrawnScene::triangles_drawn)
    }

    /// Pieces that could not be decoded so far, or did not fit to what they refine; coarser ones
    /// stand in for them.
    #[must_use]
    pub fn damaged_units(&self) -> u64 {
        self.session.figures().damaged_units + self.drawer.refused_units()
    }

    /// Goes on with another device.
    pub fn recover(&mut self, drawer: Drawer) {
        self.drawer = drawer;
        self.session.take(SessionEvent::DeviceLost);
    }

    /// Takes a piece for which so many frames were decoded; `None` where it is damaged.
    pub fn take(&mut self, piece: Piece, frames: u32, payload: Option<Payload>) {
        let event = match payload {
            Some(payload) => {
                self.cache.insert(piece, payload);
                SessionEvent::Decoded { piece, frames }
            }
            None => SessionEvent::Damaged { piece, frames },
        };
        self.session.take(event);
    }

    /// Takes what a decoder is done with. A person hears of damage once.
    ///
    /// # Errors
    /// It made something else than what it was asked for.
    pub(crate) fn receive(&mut self, decoded: Decoded) -> Result<(), PlayError> {
        let payload = match decoded.payload {
            Ok(payload) => Some(payload),
            Err(DecodeError::Wrong(error)) => return Err(PlayError::Wrong(error)),
            Err(DecodeError::Damaged(error)) => {
                if !std::mem::replace(&mut self.has_warned, true) {
                    (self.tell)(&format!(
                        "{}; what there is else is shown; `foveal verify` lists all damage",
                        with_cause(&*error)
                    ));
                }
                None
            }
        };
        self.take(decoded.piece, decoded.frames, payload);
        Ok(())
    }

    /// Takes what came, shows what is due, and orders what comes.
    ///
    /// # Errors
    /// The device was lost, or a decoder made something else than what it was asked for.
    pub fn step(&mut self, now: &Now) -> Result<Stepped, PlayError> {
        while let Some(decoded) = self.supply.next(Some(std::time::Duration::ZERO)) {
            self.receive(decoded)?;
        }
        self.leave_room(&now.moment)?;
        let measured = self.drawer.measure(&self.session, &now.moment)?;
        let evicted = self.drawer.take_evicted();
        self.tell_session(measured.into_iter().chain(evicted));
        let actions = self.session.step(now);
        let stepped = self.perform(actions, now)?;
        // What came is measured while the next picture is awaited.
        let measured = self.drawer.measure(&self.session, &now.moment)?;
        self.tell_session(measured);
        Ok(stepped)
    }

    /// Has the session leave room on the GPU for the pictures of a moment.
    pub(crate) fn leave_room(&mut self, moment: &Moment) -> Result<(), PlayError> {
        let room = self.drawer.expect(&moment.views)?;
        self.tell_session(room);
        Ok(())
    }

    /// Does what the session asks for.
    pub(crate) fn perform(
        &mut self,
        actions: Vec<SessionAction>,
        now: &Now,
    ) -> Result<Stepped, PlayError> {
        let (changed, left) = self.drawer.perform(actions, &mut self.cache, now)?;
        let mut stepped = Stepped {
            changed,
            ..Stepped::default()
        };
        for action in left {
            match action {
                SessionAction::Want(pieces) => {
                    stepped.wants = true;
                    self.supply.want(&pieces);
                }
                SessionAction::Log(lines) => stepped.log.push_str(&lines),
                SessionAction::Chosen(line) => stepped.chosen = Some(line),
                SessionAction::Count => self.session.take(self.drawer.count()),
                _ => {}
            }
        }
        Ok(stepped)
    }

    pub(crate) fn tell_session(&mut self, events: impl IntoIterator<Item = SessionEvent>) {
        let events = events.into_iter();
        events.for_each(|event| self.session.take(event));
    }
}

/// What is wrong, and why where it does not say so itself.
fn with_cause(error: &dyn Error) -> String {
    let what = error.to_string();
    let cause = error.source().map(ToString::to_string);
    match cause.filter(|cause| !what.contains(cause)) {
        Some(cause) => format!("{what} ({cause})"),
        None => what,
    }
}
