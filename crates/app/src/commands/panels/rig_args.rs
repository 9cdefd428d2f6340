//! Which rig, whose eye, which source, and where does that lie?

use crate::options::policy::parse_size;
use crate::report::output::say;
use anyhow::Context;
use clap::{Args, ValueEnum};
use foveal_core::view::panel::fit::{PlacementRule, SourceFit, SourceSize, fit};
use foveal_core::view::panel::rig::{Panel, Rig};
use foveal_core::view::surface::Eye;
use foveal_media::VideoInput;
use foveal_scene::rig::{NotedRig, read_rig_seen_from};
use std::path::{Path, PathBuf};

/// Whose panels are served together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RigEye {
    /// Those that the left eye looks at.
    Left,
    /// Those that the right eye looks at.
    Right,
    /// All, by one source.
    Both,
}

impl RigEye {
    /// The eye, where it is one.
    pub(crate) fn eye(self) -> Option<Eye> {
        match self {
            Self::Left => Some(Eye::Left),
            Self::Right => Some(Eye::Right),
            Self::Both => None,
        }
    }
}

/// Where the source lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlacementName {
    /// The rig's screen where it has one; a plane while panels lie within 65° of one axis, else
    /// what needs least of the curved ones.
    Auto,
    /// Square to the head and centred, as Strege 2009 has it.
    Seed,
    /// The plane of which the fewest pixels are needed.
    Plane,
    /// A cylinder: columns are azimuths, rows tangents of elevations.
    Cylinder,
    /// A sphere: columns are azimuths, rows elevations.
    Equirect,
}

impl From<PlacementName> for PlacementRule {
    fn from(name: PlacementName) -> Self {
        match name {
            PlacementName::Auto => Self::Auto,
            PlacementName::Seed => Self::Seed,
            PlacementName::Plane => Self::Plane,
            PlacementName::Cylinder => Self::Cylinder,
            PlacementName::Equirect => Self::Equirect,
        }
    }
}

/// The options of every command that reads a rig.
#[derive(Clone, Debug, Args)]
pub(crate) struct RigArgs {
    /// File that describes the panels: TOML or JSON, an MPCDI, or a warp mesh;
    /// docs/formats/panels.md.
    pub(crate) rig: PathBuf,
    /// Whose panels one source serves.
    #[arg(long, value_enum, default_value = "left")]
    pub(crate) eye: RigEye,
    /// Where the source lies.
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) placement: PlacementName,
}

impl RigArgs {
    /// Reads the rig.
    pub(crate) fn read(&self) -> anyhow::Result<Rig> {
        read_noting(&self.rig, None).map(|found| found.rig)
    }

    /// The panels that are asked for.
    pub(crate) fn panels<'a>(&self, rig: &'a Rig) -> Vec<&'a Panel> {
        rig.seen_by(self.eye.eye())
    }

    /// Places a source of a size, or of any, before panels of the rig: on its screen, where it has
    /// one and nothing else is asked for.
    pub(crate) fn fit(
        &self,
        rig: &Rig,
        panels: &[&Panel],
        source: impl Into<SourceSize>,
    ) -> anyhow::Result<SourceFit> {
        let rule = match (self.placement, rig.screen) {
            (PlacementName::Auto, Some(size)) => PlacementRule::Screen(size),
            (name, _) => name.into(),
        };
        let found = fit(panels, rule, source);
        found.with_context(|| format!("{}: no source can be placed", self.rig.display()))
    }
}

/// Reads a rig, and says which parts of its file are left out or mended.
pub(super) fn read_noting(path: &Path, eye: Option<[f64; 3]>) -> anyhow::Result<NotedRig> {
    let found = read_rig_seen_from(path, eye)?;
    for note in &found.notes {
        say(&format!("{}: {note}", path.display()));
    }
    Ok(found)
}

/// What is drawn for the window where it is written as `WxH`, else a picture or video file.
pub(crate) fn source_size(source: Option<&str>) -> anyhow::Result<SourceSize> {
    let Some(source) = source else {
        return Ok(SourceSize::Needed);
    };
    if let Ok(size) = parse_size(source) {
        return Ok(SourceSize::Drawn(size));
    }
    let input = VideoInput::open(Path::new(source))
        .with_context(|| format!("--source {source:?}: give a size as 1600x1200, or a file"))?;
    let info = input.info();
    Ok(SourceSize::Picture([info.width, info.height]))
}
