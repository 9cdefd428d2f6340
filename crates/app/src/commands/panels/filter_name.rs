//! What are the filters called?

use clap::ValueEnum;
use foveal_render::warp::WarpFilter;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum FilterName {
    /// Bicubic where the source is magnified, anisotropic where it is minified.
    #[default]
    Auto,
    /// Four texels.
    Bilinear,
    /// As coarse as the longer step between pixels.
    Trilinear,
    /// Sixteen texels, for sources that are magnified.
    Bicubic,
    /// At most 16 samples along the longer step.
    Anisotropic,
    /// Feline: at most 16 samples along the ellipse of a pixel.
    Feline,
    /// The elliptical weighted average, on the CPU: what the others are judged by.
    Ewa,
}

impl FilterName {
    pub(super) fn name(self) -> String {
        self.to_possible_value()
            .map_or_else(String::new, |it| it.get_name().to_owned())
    }
}

impl FilterName {
    /// The pass's own; of the elliptical weighted average there is none.
    pub(super) fn of_pass(self) -> Option<WarpFilter> {
        Some(match self {
            Self::Auto => WarpFilter::Auto,
            Self::Bilinear => WarpFilter::Bilinear,
            Self::Trilinear => WarpFilter::Trilinear,
            Self::Bicubic => WarpFilter::Bicubic,
            Self::Anisotropic => WarpFilter::Anisotropic,
            Self::Feline => WarpFilter::Feline,
            Self::Ewa => return None,
        })
    }
}
