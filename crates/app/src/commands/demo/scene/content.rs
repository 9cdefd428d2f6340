//! Which mesh or cloud does the demo show, and where does a viewer look at it?

use crate::commands::prepare::scene::{check_scene, prepare_usual};
use crate::report::output;
use crate::run::mesh_file::ply;
use foveal_media::pack::scene_file::SceneFile;
use foveal_scene::generate::knot;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Vertices along and around the generated rope: twice as many triangles as their product.
const KNOT: [u32; 2] = [2600, 144];
/// A 3D file to show.
#[derive(Clone, Debug)]
pub(crate) struct SceneContent {
    /// Name of its pack, without ending.
    pub(crate) name: String,
    source: PathBuf,
    pub(crate) is_drawn: bool,
}

/// A scene as a pack, and how it became one.
pub(crate) struct PreparedScene {
    pub(crate) content: SceneContent,
    pub(crate) file: Arc<SceneFile>,
    pub(crate) took: Duration,
}

impl SceneContent {
    /// A file of the user's.
    pub(crate) fn file(name: String, source: PathBuf) -> Self {
        Self {
            name,
            source,
            is_drawn: false,
        }
    }

    /// A knot that is drawn under `out`.
    pub(crate) fn knot(out: &Path) -> Self {
        Self {
            name: "knot".to_owned(),
            source: out.join("knot.ply"),
            is_drawn: true,
        }
    }

    /// Refuses a file that cannot be read.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        match self.is_drawn {
            true => Ok(()),
            false => check_scene(&self.source),
        }
    }

    /// Makes a pack under `out`, or finds that the one there is still good.
    pub(crate) fn prepare(&self, out: &Path) -> anyhow::Result<PreparedScene> {
        let begun = Instant::now();
        if self.is_drawn {
            let [along, around] = KNOT;
            output::write_whole(&self.source, &ply(&knot(along, around)))?;
        }
        let pack = out.join(format!("{}.foveal", self.name));
        prepare_usual(&self.source, &pack)?;
        Ok(PreparedScene {
            content: self.clone(),
            file: Arc::new(SceneFile::open(&pack)?),
            took: begun.elapsed(),
        })
    }

    /// Where a viewer of it looks, in degrees to the right and up of its middle; `None` where that
    /// follows from what it looks like.
    pub(crate) fn gaze_deg(&self) -> Option<[f64; 2]> {
        self.is_drawn.then_some([4.4, 9.2])
    }
}
