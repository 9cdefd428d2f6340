//! Which options say how resident tiles become a picture, and whose?

use crate::options::policy::Switch;
use clap::{Args, ValueEnum};
use foveal_core::view::surface::Eye;
use foveal_render::Interpolation;
use foveal_render::TileStyle;

/// Whose picture is shown, of content for two eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EyeName {
    Left,
    Right,
    Both,
}

impl EyeName {
    /// The eyes, from left to right.
    pub(crate) fn eyes(self) -> &'static [Eye] {
        match self {
            Self::Left => &[Eye::Left],
            Self::Right => &[Eye::Right],
            Self::Both => &[Eye::Left, Eye::Right],
        }
    }

    /// Its name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Both => "both",
        }
    }

    /// The next one round.
    pub(crate) fn next(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Both,
            Self::Both => Self::Left,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Reconstruction {
    /// Resident tiles in one atlas, faded into each other where levels meet.
    Atlas,
    /// A texture for every level, as large as the whole surface there; nothing fades.
    Textures,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InterpolationName {
    /// The nearest sample, as published.
    Nearest,
    /// The nearest sample and those that touch it, by distance, each the mean of its surroundings.
    Blended,
}

/// How what is resident becomes a picture.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShowingOptions {
    /// What tiles lie in on the GPU.
    #[arg(long, value_enum, default_value = "atlas")]
    pub(crate) reconstruction: Reconstruction,
    /// sampled: how pixels between samples are filled (default: blended; nearest with --preset
    /// kastner-2016).
    #[arg(long, value_enum)]
    pub(crate) interpolation: Option<InterpolationName>,
    /// Blur what lies outside the fovea as acuity falls off.
    #[arg(long, value_enum, default_value = "off")]
    pub(crate) blur: Switch,
}

impl ShowingOptions {
    /// Whether tiles lie in textures.
    pub(crate) fn has_textures(&self) -> bool {
        self.reconstruction == Reconstruction::Textures
    }

    /// What was asked for; `interpolation` by default.
    pub(crate) fn showing(&self, interpolation: InterpolationName) -> TileStyle {
        TileStyle {
            has_textures: self.has_textures(),
            interpolation: match self.interpolation.unwrap_or(interpolation) {
                InterpolationName::Nearest => Interpolation::Nearest,
                InterpolationName::Blended => Interpolation::Blended,
            },
            blurs: self.blur == Switch::On,
            samples: false,
        }
    }
}
