//! What does `--preset` set?
//!
//! A preset stands for options of a published system; an option that is given itself wins. What
//! each sets is told in docs/concepts/video.md.

use crate::options::policy::{CutOptions, MappingName, PolicyOptions};
use clap::ValueEnum;
use foveal_core::content::policy::Policy;
use foveal_core::view::surface::Projection;

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
        let Self::Kastner2016 = self;
        let policy = match projection {
            Projection::Flat => Policy::Sampled,
            Projection::Cube | Projection::Equirect => Policy::Grid,
        };
        let mut options = given.clone();
        options.policy = given.policy.or(Some(policy));
        options.samples = given.samples.or(Some(KASTNER_SAMPLES));
        options
    }
}
