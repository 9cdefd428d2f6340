//! How does a pack play while something else goes on, as a window does?
//!
//! Time comes in as an argument; units are decoded by threads and shown as they come.

use crate::decoding::Decoding;
use crate::error::PlayError;
use crate::feed::{DecodeFeed, Decoder};
use crate::mesh_reader::MeshReader;
use crate::step::step;
use crate::tile_decoder::TileDecoder;
use foveal_core::content::opened::Opened;
use foveal_core::content::payload::Payload;
use foveal_core::session::actions::{Cache, Now, SessionAction, SessionEvent};
use foveal_core::session::session::{Session, SessionSettings};
use foveal_media::pack::pack::Pack;
use foveal_render::{Drawer, DrawnScene, TileDrawer};

/// Tiles under way for each decoding thread.
const TILES_AHEAD: usize = 2;
/// Units of a scene that are read whatever is wanted next.
const MESHES_AHEAD: usize = 4;

/// What decodes a pack, and how many pieces that takes at once.
fn decoder(pack: &Pack, decoding: Decoding) -> Result<(Box<dyn Decoder>, usize), PlayError> {
    Ok(match pack {
        Pack::Video(file) => {
            let most = decoding.jobs.max(1) * TILES_AHEAD;
            (Box::new(TileDecoder::new(file, decoding)?), most)
        }
        Pack::Scene(file) => (Box::new(MeshReader::new(file)), MESHES_AHEAD),
    })
}

/// How a pack is played live.
#[derive(Clone, Debug)]
pub struct LiveOptions {
    /// What the session begins with.
    pub session: SessionSettings,
    /// Who decodes.
    pub decoding: Decoding,
    /// Receives what a person should know but is not an error.
    pub tell: fn(&str),
}

/// A session with what decodes and draws for it.
pub struct LivePlayer {
    pack: Pack,
    opened: Opened,
    session: Session,
    feed: DecodeFeed,
    cache: Cache<Payload>,
    drawer: Drawer,
    /// Bytes of a scene's units that were read.
    fetched_bytes: u64,
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
    /// Plays a pack, opened on a screen; `woken` is called when something was decoded.
    ///
    /// # Errors
    /// The pack cannot be decoded.
    pub fn new(
        (pack, opened): (Pack, Opened),
        options: LiveOptions,
        drawer: Drawer,
        woken: impl Fn() + Send + 'static,
    ) -> Result<Self, PlayError> {
        let (decoder, most) = decoder(&pack, options.decoding)?;
        Ok(Self {
            session: Session::new(vec![opened.content()], options.session),
            feed: DecodeFeed::new(decoder, most, options.tell, woken)?,
            cache: Cache::default(),
            drawer,
            fetched_bytes: 0,
            pack,
            opened,
        })
    }

    /// The file of the pack.
    #[must_use]
    pub fn pack(&self) -> &Pack {
        &self.pack
    }

    /// What is in it.
    #[must_use]
    pub fn opened(&self) -> &Opened {
        &self.opened
    }

    /// Bytes of a scene's units that were read so far, as often as they were; of video none.
    #[must_use]
    pub fn fetched_bytes(&self) -> u64 {
        self.fetched_bytes
    }

    /// Triangles of a scene that the last picture drew; of video none.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        let scene = self.drawer.scene();
        scene.map_or(0, DrawnScene::triangles_drawn)
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

    /// How tiles become a picture; of a scene as by default.
    #[must_use]
    pub fn style(&self) -> foveal_render::TileStyle {
        let tiles = self.drawer.tiles();
        tiles.map(TileDrawer::style).unwrap_or_default()
    }

    /// Whether units of a scene are on their way to their places: the picture changes by itself.
    #[must_use]
    pub fn is_morphing(&self) -> bool {
        self.drawer.is_morphing()
    }

    /// Starts over on another device.
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
            if let (Pack::Scene(file), SessionEvent::Decoded { piece, .. }) = (&self.pack, &event) {
                self.fetched_bytes += u64::from(file.pack().entry(piece.unit.unit).bytes);
            }
            self.session.take(event);
        }
        let (cache, drawer) = (&mut self.cache, &mut self.drawer);
        let (changed, left) = step(&mut self.session, now, cache, drawer)?;
        let mut log = String::new();
        for action in left {
            match action {
                SessionAction::Want(pieces) => self.feed.want(&pieces),
                SessionAction::Log(lines) => log.push_str(&lines),
                SessionAction::Count => self.session.take(self.drawer.count()),
                _ => {}
            }
        }
        Ok(Stepped { changed, log })
    }
}
