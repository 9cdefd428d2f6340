//! How does a pack play while something else goes on, as a window does?
//!
//! Time comes in as an argument; units are decoded by threads and shown as they come.

use crate::decoding::Decoding;
use crate::error::PlayError;
use crate::feed::DecodeFeed;
use crate::step::step;
use foveal_core::content::demand::Content;
use foveal_core::content::payload::Payload;
use foveal_core::content::video::Video;
use foveal_core::session::actions::{Cache, Now, SessionAction, SessionEvent};
use foveal_core::session::session::{Session, SessionSettings};
use foveal_media::pack::pack_file::PackFile;
use foveal_render::Drawer;
use std::path::Path;
use std::sync::Arc;

/// How a pack is played live.
#[derive(Clone, Debug)]
pub struct LiveOptions {
    /// What the session begins with.
    pub session: SessionSettings,
    /// Who decodes.
    pub decoding: Decoding,
    /// Told what a person should know and no error is.
    pub tell: fn(&str),
}

/// A session with what decodes and draws for it.
pub struct LivePlayer {
    file: Arc<PackFile>,
    session: Session,
    feed: DecodeFeed,
    cache: Cache<Payload>,
    drawer: Drawer,
}

/// What a step did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stepped {
    /// Whether the picture changed.
    pub changed: bool,
    /// Lines of the session log.
    pub log: String,
}

impl LivePlayer {
    /// Plays a pack; `woken` is called when something was decoded.
    ///
    /// # Errors
    /// The pack cannot be decoded.
    pub fn new(
        file: Arc<PackFile>,
        video: &Arc<Video>,
        options: LiveOptions,
        drawer: Drawer,
        woken: impl Fn() + Send + 'static,
    ) -> Result<Self, PlayError> {
        let scene = vec![Arc::clone(video) as Arc<dyn Content>];
        Ok(Self {
            session: Session::new(scene, options.session),
            feed: DecodeFeed::new(&file, options.decoding, options.tell, woken)?,
            cache: Cache::default(),
            drawer,
            file,
        })
    }

    /// The pack.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.file.path()
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
    pub fn drawer(&mut self) -> &mut Drawer {
        &mut self.drawer
    }

    /// How tiles become a picture.
    #[must_use]
    pub fn style(&self) -> foveal_render::TileStyle {
        self.drawer.style()
    }

    /// Begins anew on another device.
    pub fn recover(&mut self, drawer: Drawer) {
        self.drawer = drawer;
        self.session.take(SessionEvent::DeviceLost);
    }

    /// Takes what was decoded, shows what is due, and orders what comes.
    ///
    /// # Errors
    /// The device was lost, or a decoder gave another frame than it was asked for.
    pub fn step(&mut self, now: &Now) -> Result<Stepped, PlayError> {
        for event in self.feed.take(&mut self.cache)? {
            self.session.take(event);
        }
        let (cache, drawer) = (&mut self.cache, &mut self.drawer);
        let (changed, left) = step(&mut self.session, now, cache, drawer)?;
        let mut log = String::new();
        for action in left {
            match action {
                SessionAction::Want(pieces) => self.feed.want(&pieces),
                SessionAction::Log(lines) => log.push_str(&lines),
                SessionAction::Count => self.count(),
                _ => {}
            }
        }
        Ok(Stepped { changed, log })
    }

    fn count(&mut self) {
        let wrong = self.drawer.wrong_frame_units() as u64;
        let figures = &mut self.session.figures;
        figures.wrong_frame_units += wrong;
        figures.gpu_bytes = self.drawer.gpu_bytes();
    }
}
