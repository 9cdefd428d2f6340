//! What is known of a pack that is loaded in parts?

use crate::opening::{OpenPack, PackKind};
use crate::options::Options;
use foveal_core::content::opened::Opened;
use foveal_core::content::scene::Scene;
use foveal_core::content::video::Video;
use foveal_core::pack::{Header, TableEntry};
use foveal_core::session::bounds::{Bounds, CLIENT_BYTES};
use foveal_core::units::Radians;
use foveal_core::view::navigation::Navigation;
use foveal_core::view::surface::Screen;
use foveal_render::{DrawDevice, Drawer, RenderError, TileStyle};
use std::sync::Arc;

/// What a page keeps below of a video: its memory holds 4 GiB at most, of which decoded pictures
/// may take a quarter, and phones have little more for graphics.
const OF_VIDEO: Bounds = Bounds {
    in_flight: 512 << 20,
    cached: 1 << 30,
    gpu: 2 << 30,
    client: CLIENT_BYTES,
};
/// The same of a scene, whose units stay on the GPU as long as they are seen. Few are asked for at
/// once, so that turning away is not delayed by stale requests.
const OF_SCENE: Bounds = Bounds {
    in_flight: 8 << 20,
    cached: 256 << 20,
    gpu: 256 << 20,
    client: CLIENT_BYTES,
};

/// A pack of which all has been loaded that comes before its units.
pub(crate) struct PackInParts {
    header: Header,
    /// What it holds: of a video, pages of the index and side tables come while it plays; of a
    /// scene, index and table of units are there.
    pub(crate) content: Opened,
}

impl PackInParts {
    /// What an open pack holds, called `name` in logs, flat content filling `screen`.
    pub(crate) fn new(pack: &OpenPack, name: &str, screen: Screen) -> Self {
        let content = match &pack.kind {
            PackKind::Video(pack) => {
                Opened::Video(Arc::new(Video::new(name, Arc::clone(pack), screen)))
            }
            PackKind::Scene(pack) => Opened::Scene(Arc::new(Scene::new(name, Arc::clone(pack)))),
        };
        let header = pack.header;
        Self { header, content }
    }

    /// Where a viewer begins.
    pub(crate) fn navigation(&self, options: &Options) -> Navigation {
        let field = Radians::from_degrees(options.field_deg);
        self.content.navigation(field)
    }

    /// What a session keeps below.
    pub(crate) fn bounds(&self) -> Bounds {
        match self.content.facts().has_tiles {
            true => OF_VIDEO,
            false => OF_SCENE,
        }
    }

    /// What draws it; nothing is resident yet.
    pub(crate) fn drawer(&self, device: &DrawDevice) -> Result<Drawer, RenderError> {
        Drawer::of_opened(device, &self.content, TileStyle::default(), OF_SCENE.gpu)
    }

    /// A side table that the file has and that may still come; `None` where it has none of that
    /// name.
    pub(crate) fn table_to_come(&self, name: &str) -> Option<&TableEntry> {
        let table = self.content.video()?.table_to_come(name)?;
        table.range(self.header.file_bytes).is_ok().then_some(table)
    }
}
