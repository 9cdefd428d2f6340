//! What does `--preset` set?
//!
//! A preset stands for options of a published system; an option that is given itself wins.
//! docs/concepts/kastner.md lists what each sets.

use crate::gaze_source::preset_of;
use crate::options::policy::{CutOptions, MappingName, PolicyOptions};
use crate::options::showing::InterpolationName;
use crate::report::output::WrongUsage;
use crate::run::timed::Way;
use anyhow::bail;
use clap::{Args, ValueEnum};
use foveal_core::content::policy::{MaskConfig, Policy, PolicyConfig};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::view::surface::Projection;
use foveal_media::prepare::Quality;
use foveal_render::Interpolation;
use std::path::Path;

/// A published system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SystemPreset {
    /// Kastner 2016: a grid of 4x4, three levels in steps of 1/4; grid around the viewer, samples
    /// on a wide screen.
    #[value(name = "kastner-2016")]
    Kastner2016,
}

/// Samples of the published mask (Kastner 2016, section 4.1.1).
const KASTNER_SAMPLES: u32 = 690_926;
/// Quality of the JPEG tiles of its panoramas (section 5.4.2).
const KASTNER_JPEG: u8 = 90;

impl SystemPreset {
    /// The preset of a name, if it is one.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::from_str(name, false).ok()
    }

    /// How content is cut.
    pub(crate) fn cut(self, given: &CutOptions) -> CutOptions {
        let Self::Kastner2016 = self;
        CutOptions {
            tile: given.tile,
            grid: given.grid.or(given.tile.is_none().then_some([4, 4])),
            levels: given.levels.or(Some(3)),
            level_ratio: given.level_ratio.or(Some(4)),
        }
    }

    /// How pixels lie over the faces of a cube.
    pub(crate) fn mapping(self, given: Option<MappingName>) -> MappingName {
        let Self::Kastner2016 = self;
        given.unwrap_or(MappingName::Gnomonic)
    }

    /// How levels are chosen on content of a projection.
    pub(crate) fn policy(self, given: &PolicyOptions, projection: Projection) -> PolicyOptions {
        let mut options = given.under(given.named().unwrap_or(self.rule(projection)));
        options.samples = given.samples.or(Some(KASTNER_SAMPLES));
        options
    }

    /// How frames of content of a projection are chosen and drawn, to be timed.
    pub(crate) fn way(self, projection: Projection) -> Way {
        let config = PolicyConfig::new(self.rule(projection));
        Way {
            config: PolicyConfig {
                mask: MaskConfig {
                    samples: Some(KASTNER_SAMPLES),
                    ..config.mask
                },
                ..config
            },
            interpolation: Interpolation::Nearest,
        }
    }

    /// What its panoramas are coded with, and what its wide screens: `None` as usual.
    pub(crate) fn coding(self, projection: Projection) -> Option<(Codec, Quality)> {
        let Self::Kastner2016 = self;
        match projection {
            Projection::Flat => None,
            Projection::Cube | Projection::Equirect => {
                Some((Codec::Jpeg, Quality::Ijg(vec![KASTNER_JPEG])))
            }
        }
    }

    /// The policy on content of a projection.
    fn rule(self, projection: Projection) -> Policy {
        let Self::Kastner2016 = self;
        match projection {
            Projection::Flat => Policy::Sampled,
            Projection::Cube | Projection::Equirect => Policy::Grid,
        }
    }

    /// Its name on the command line.
    pub(crate) fn name(self) -> &'static str {
        let Self::Kastner2016 = self;
        "kastner-2016"
    }
}

/// The presets of whatever plays: of the viewer and of a published system.
#[derive(Clone, Debug, Args)]
pub(crate) struct PlayPresets {
    /// How gaze follows the head: free-viewing (default), search or a file that `gaze fit head`
    /// wrote; or, in addition, a published system to choose as: kastner-2016.
    #[arg(long, value_name = "NAME|FILE.toml")]
    preset: Vec<String>,
}

impl PlayPresets {
    /// How the viewer's gaze follows the head.
    pub(crate) fn head_gaze(&self) -> anyhow::Result<HeadGazePreset> {
        let is_of_viewer = |name: &&String| SystemPreset::named(name).is_none();
        let mut of_viewer = self.preset.iter().filter(is_of_viewer);
        let preset = of_viewer.next().map_or("free-viewing", String::as_str);
        if let Some(second) = of_viewer.next() {
            bail!(WrongUsage(format!(
                "--preset: gaze follows the head as in {preset} or as in {second}, not both"
            )));
        }
        preset_of(preset, true)
    }

    /// The files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.preset.iter().map(Path::new)
    }

    /// The published system that was asked for.
    pub(crate) fn system(&self) -> Option<SystemPreset> {
        self.preset
            .iter()
            .find_map(|name| SystemPreset::named(name))
    }

    /// How levels are chosen on content of a projection, with what the system sets.
    pub(crate) fn policy(&self, given: &PolicyOptions, projection: Projection) -> PolicyOptions {
        let system = self.system();
        system.map_or_else(|| given.clone(), |it| it.policy(given, projection))
    }

    /// How pixels between samples are filled unless `--interpolation` is given.
    pub(crate) fn interpolation(&self) -> InterpolationName {
        match self.system() {
            Some(SystemPreset::Kastner2016) => InterpolationName::Nearest,
            None => InterpolationName::Blended,
        }
    }

    /// Refuses a published system of video for a scene.
    pub(crate) fn refuse_for_scene(&self) -> anyhow::Result<()> {
        match self.system() {
            Some(system) => bail!(WrongUsage(format!(
                "--preset {} chooses tiles of video, and this is a scene; leave it out",
                system.name()
            ))),
            None => Ok(()),
        }
    }
}
