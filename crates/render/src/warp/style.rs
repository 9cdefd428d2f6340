//! How is the source filtered?

/// How the samples of a source become the light of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WarpFilter {
    /// Four texels of the finest level.
    Bilinear,
    /// As coarse as the longer step from pixel to pixel.
    Trilinear,
    /// Sixteen texels of the finest level, by a cubic.
    Bicubic,
    /// At most 16 even samples along the longer step: the device's own filter, where it has a good
    /// one.
    Anisotropic,
    /// Feline, with at most 16 samples.
    Feline,
    /// Bicubic where the source is magnified, anisotropic where it is minified.
    #[default]
    Auto,
}

/// How a plan is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WarpStyle {
    /// The filter.
    pub filter: WarpFilter,
    /// Whether pixels of which Feline takes more than one sample are painted.
    pub paints: bool,
}

impl WarpFilter {
    /// All of them, in the order of the shader's numbers.
    pub const ALL: [Self; 6] = [
        Self::Bilinear,
        Self::Trilinear,
        Self::Bicubic,
        Self::Anisotropic,
        Self::Feline,
        Self::Auto,
    ];

    /// Variance of what is taken along a long step, over the square of that step: of a box along
    /// it, or of Feline's `exp(-2 r²)` from -1 to 1. `None` where pixels take nothing along a line,
    /// so that no eye's blur can be drawn.
    #[must_use]
    pub fn moment(self) -> Option<f64> {
        match self {
            Self::Anisotropic | Self::Auto => Some(1.0 / 12.0),
            Self::Feline => Some(0.193_435),
            Self::Bilinear | Self::Trilinear | Self::Bicubic => None,
        }
    }

    /// Whether coarser levels of the source are read where some pixel covers more than a texel.
    #[must_use]
    pub fn reads_levels(self) -> bool {
        !matches!(self, Self::Bilinear | Self::Bicubic)
    }
}
