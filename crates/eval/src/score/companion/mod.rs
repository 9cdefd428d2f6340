//! What do measures say that share nothing with the model of the eye that detail is chosen by?
//!
//! A score that is made of the same sensitivity as the selection could flatter it; these
//! accompany it. Those that know no gaze are for comparison with the literature.

mod errors;
mod sphere;
mod ssim;
mod weight;

use super::error::ScoreError;
use super::geometry::Geometry;
use super::picture::ScorePicture;
use super::viewing::Viewing;
use errors::{luma_errors, squared_errors};
use serde::Serialize;
use sphere::{equator_weights, sphere_places};
use ssim::ssim;
use weight::weighted_error;

/// A measure of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Companion {
    /// Peak signal to noise over all samples, decibels.
    Psnr,
    /// The same, errors weighed by the cells of the eye that look there.
    FwPsnr,
    /// Structural similarity of luma, at most 1.
    Ssim,
    /// The same in the square round the fovea (2.5° round the gaze).
    FovealSsim,
    /// Luma of an equirectangular picture, rows weighed by their length on the sphere, decibels.
    WsPsnr,
    /// Luma of an equirectangular picture at places spread evenly over the sphere, decibels.
    SPsnr,
}

/// Radius of the fovea, degrees.
const FOVEA_DEG: f64 = 2.5;

impl Companion {
    /// Its name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Psnr => "psnr",
            Self::FwPsnr => "fw-psnr",
            Self::Ssim => "ssim",
            Self::FovealSsim => "foveal-ssim",
            Self::WsPsnr => "ws-psnr",
            Self::SPsnr => "s-psnr",
        }
    }

    /// Whether it asks where the eye looks.
    #[must_use]
    pub fn needs_gaze(self) -> bool {
        matches!(self, Self::FwPsnr | Self::FovealSsim)
    }

    /// Whether pictures must be equirectangular.
    #[must_use]
    pub fn needs_sphere(self) -> bool {
        matches!(self, Self::WsPsnr | Self::SPsnr)
    }

    fn is_similarity(self) -> bool {
        matches!(self, Self::Ssim | Self::FovealSsim)
    }
}

/// Takes in frame after frame.
pub struct CompanionJudge {
    companion: Companion,
    size: [u32; 2],
    ppd: f64,
    geometry: Geometry,
    /// Sums of weighed errors, or of similarities.
    sum: f64,
    weights: f64,
}

impl CompanionJudge {
    /// A judge of frames as `viewing` shows them.
    ///
    /// # Errors
    /// When the measure asks for a gaze or a whole sphere and there is none.
    pub fn new(companion: Companion, viewing: &Viewing) -> Result<Self, ScoreError> {
        let [w, h] = viewing.size;
        if companion.needs_sphere() && w != 2 * h {
            let expected = "an equirectangular one, twice as wide as high";
            return Err(ScoreError::field(
                "the picture",
                format!("{w}x{h}"),
                expected,
            ));
        }
        if companion.needs_gaze() && !viewing.foveated {
            return Err(ScoreError::field(
                "the gaze",
                "missing",
                "where the eye looks",
            ));
        }
        Ok(Self {
            companion,
            size: viewing.size,
            ppd: viewing.display.ppd(),
            geometry: Geometry::new(viewing),
            sum: 0.0,
            weights: 0.0,
        })
    }

    /// Takes in a frame, and returns its value: infinite decibels for the same picture, no number
    /// where it has no fovea of 11 pixels.
    ///
    /// # Errors
    /// When a picture has another size than the judge was made for.
    pub fn frame(
        &mut self,
        reference: &ScorePicture,
        test: &ScorePicture,
        gaze_px: [f64; 2],
    ) -> Result<f64, ScoreError> {
        reference.expect_size(self.size)?;
        test.expect_size(self.size)?;
        let [sum, weights] = match self.companion {
            Companion::Psnr => squared_errors(reference, test),
            Companion::FwPsnr => {
                let gaze = self.geometry.gaze(gaze_px);
                weighted_error(reference, test, &self.geometry, self.ppd, gaze)
            }
            Companion::Ssim => similarity(reference, test, [[0; 2], self.size]),
            Companion::FovealSsim => similarity(reference, test, self.fovea(gaze_px)),
            Companion::WsPsnr => {
                let weights = equator_weights(self.size[1]);
                let columns = self.size[0] as usize;
                luma_errors(reference, test, |at| weights[at / columns])
            }
            Companion::SPsnr => {
                let mut counts = vec![0_u32; reference.samples_of_one()];
                sphere_places(self.size).for_each(|at| counts[at] += 1);
                luma_errors(reference, test, |at| f64::from(counts[at]))
            }
        };
        if weights > 0.0 {
            self.sum += sum;
            self.weights += weights;
        }
        Ok(self.value(sum, weights))
    }

    /// The value over all frames: of the mean error, or the mean similarity.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.value(self.sum, self.weights)
    }

    fn value(&self, sum: f64, weights: f64) -> f64 {
        let mean = sum / weights;
        if self.companion.is_similarity() {
            mean
        } else {
            -10.0 * mean.log10()
        }
    }

    /// First column and row of the square round the fovea, and the ones after its last.
    fn fovea(&self, gaze_px: [f64; 2]) -> [[u32; 2]; 2] {
        let radius = FOVEA_DEG * self.ppd;
        let side = |k: usize, by: f64| {
            (gaze_px[k] + 0.5 + by)
                .round()
                .clamp(0.0, f64::from(self.size[k])) as u32
        };
        [
            [0, 1].map(|k| side(k, -radius)),
            [0, 1].map(|k| side(k, radius)),
        ]
    }
}

/// Sum of the similarities of windows, and their number.
fn similarity(
    reference: &ScorePicture,
    test: &ScorePicture,
    [from, to]: [[u32; 2]; 2],
) -> [f64; 2] {
    let size = [0, 1].map(|k: usize| (to[k].saturating_sub(from[k])) as usize);
    let luma = |picture: &ScorePicture| -> Vec<f64> {
        let columns = picture.size()[0];
        let rows = (from[1]..to[1]).flat_map(|y| (from[0]..to[0]).map(move |x| (x, y)));
        rows.map(|(x, y)| picture.luma((y * columns + x) as usize))
            .collect()
    };
    ssim(&luma(reference), &luma(test), size)
}

#[cfg(test)]
mod tests;
