//! Which numbers does the metric take, and what are they called in print?
//!
//! Fitted constants of Mantiuk et al. 2021 in their version 1.2. Versions differ by whole JODs, so
//! a score always names the one it was made with.

pub use foveal_core::perception::visible_loss::{
    DIFFERENCE_EXPONENT, JOD_EXPONENT, JOD_SCALE, MASKING, MASKING_EXPONENTS, SPACE_EXPONENT,
};

/// Name of the metric in results.
pub const METRIC: &str = "fovvideovdp";
/// Version of the fitted constants.
pub const VERSION: &str = "1.2";
/// The paper, ready for a list of references.
pub const CITATION: &str = "Rafał K. Mantiuk, Gyorgy Denes, Alexandre Chapiro, Anton Kaplanyan, \
Gizem Rufo, Romain Bachy, Trisha Lian and Anjul Patney. 2021. FovVideoVDP: A visible difference \
predictor for wide field-of-view video. ACM Transactions on Graphics 40(4), article 49. \
doi:10.1145/3450626.3459831";

/// Weights of the channels: sustained, transient (`w_transient`).
pub const CHANNEL_WEIGHTS: [f64; 2] = [1.0, 0.25];
/// Exponent of pooling over the two channels (`beta_tch`); over bands and frames it is 1.
pub const CHANNEL_EXPONENT: f64 = 0.666_092;
/// What sensitivities are multiplied by: 16.2596 dB (`sensitivity_correction`).
pub const SENSITIVITY_FACTOR: f64 = 6.500_997_5;

/// Flicker of the two channels in hertz.
pub const CHANNEL_HERTZ: [f64; 2] = [0.0, 5.0];
/// Least luminance that the eye is taken to adapt to, cd/m².
pub const LEAST_ADAPTATION: f64 = 0.1;
/// Largest contrast.
pub const MOST_CONTRAST: f64 = 1000.0;
/// Largest difference of a pixel after masking.
pub const MOST_DIFFERENCE: f64 = 1e4;
/// What the contrast of every band but the finest is multiplied by.
pub const COARSE_BAND_GAIN: f64 = 2.0;
/// Centre frequencies of bands over half the pixels per degree: the finest, and the one after it;
/// every further one is half the one before.
pub const BAND_CENTRES: [f64; 2] = [1.0, 0.3228];
/// The first band at or below this frequency is the last, cycles per degree.
pub const LOWEST_BAND_CPD: f64 = 0.5;

/// Where the sustained response peaks, in seconds (`sustained_beta`).
pub const SUSTAINED_PEAK_S: f64 = 0.06;
/// Its width in natural logarithms of time (`sustained_sigma`).
pub const SUSTAINED_WIDTH: f64 = 0.5;
/// Gain of the transient response, seconds.
pub const TRANSIENT_GAIN: f64 = 0.062_170_507_756_932;

/// Share of red, green and blue in luminance (sRGB primaries, D65).
pub const LUMINANCE_WEIGHTS: [f64; 3] = [0.212_672_9, 0.715_152_2, 0.072_175_0];
