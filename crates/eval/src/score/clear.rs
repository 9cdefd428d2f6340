//! What does the metric compute, equation by equation?
//!
//! Double precision, one pixel after the other, nothing kept that could be made again: the oracle
//! of [`super::fast`]. A 1080p video takes some seconds a frame.

use super::constants::{
    CHANNEL_WEIGHTS, COARSE_BAND_GAIN, DIFFERENCE_EXPONENT, LEAST_ADAPTATION, MASKING,
    MASKING_EXPONENTS, MOST_CONTRAST, MOST_DIFFERENCE, SPACE_EXPONENT,
};
use super::error::ScoreError;
use super::geometry::Geometry;
use super::picture::ScorePicture;
use super::pooling::{BandSums, FrameScore, ZONE_BORDERS_DEG, jod_lost};
use super::pyramid::{Plane, expanded, reduced};
use super::sensitivity::LogSensitivityTable;
use super::viewing::Viewing;
use std::collections::VecDeque;

/// Scores frame after frame.
pub struct ClearJudge {
    viewing: Viewing,
    geometry: Geometry,
    table: LogSensitivityTable,
    taps: Vec<[f64; 2]>,
    /// Luminance of reference and test, newest first; as many as there are taps.
    frames: VecDeque<[Plane; 2]>,
}

/// What is found in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ClearFrame {
    /// Its score.
    pub score: FrameScore,
    /// JOD lost at every pixel.
    pub heat: Plane,
}

/// One channel of one frame: levels of the reference and of the test, finest first.
struct Levels([Vec<Plane>; 2]);

impl ClearJudge {
    /// A judge that has seen nothing.
    #[must_use]
    pub fn new(viewing: &Viewing) -> Self {
        Self {
            viewing: viewing.clone(),
            geometry: Geometry::new(viewing),
            table: LogSensitivityTable::of(viewing.rules.sensitivity),
            taps: viewing.taps(),
            frames: VecDeque::new(),
        }
    }

    /// Scores the next frame for an eye that looks at `gaze_px` (0, 0 is the middle of the first
    /// pixel). Before the first frame that frame was shown.
    ///
    /// # Errors
    /// When a picture has another size than the judge was made for.
    pub fn frame(
        &mut self,
        reference: &ScorePicture,
        test: &ScorePicture,
        gaze_px: [f64; 2],
    ) -> Result<ClearFrame, ScoreError> {
        let mut luminance = Vec::new();
        for picture in [reference, test] {
            picture.expect_size(self.viewing.size)?;
            luminance.push(Plane {
                size: self.viewing.size.map(|side| side as usize),
                values: picture.luminance(&self.viewing.display),
            });
        }
        let [Some(test), Some(reference)] = [luminance.pop(), luminance.pop()] else {
            unreachable!("two pictures were pushed");
        };
        self.frames.push_front([reference, test]);
        self.frames.truncate(self.taps.len());
        Ok(self.judged(gaze_px))
    }

    fn judged(&self, gaze_px: [f64; 2]) -> ClearFrame {
        let channels: Vec<Levels> = (0..self.viewing.channels())
            .map(|channel| Levels([0, 1].map(|picture| self.levels(channel, picture))))
            .collect();
        let gaze = self.geometry.gaze(gaze_px);
        let (mut sums, mut heats) = (Vec::new(), Vec::new());
        for (band, cpd) in self.viewing.bands().into_iter().enumerate() {
            let (sum, heat) = self.band(&channels, band, cpd, gaze);
            sums.push(sum);
            heats.push(heat);
        }
        ClearFrame {
            score: FrameScore::new(&sums, self.viewing.foveated),
            heat: heat_of(heats),
        }
    }

    /// The filtered picture and every level below it.
    fn levels(&self, channel: usize, picture: usize) -> Vec<Plane> {
        let oldest = self.frames.len() - 1;
        let mut finest = Plane {
            size: self.frames[0][picture].size,
            values: vec![0.0; self.frames[0][picture].values.len()],
        };
        for (age, weights) in self.taps.iter().enumerate() {
            let frame = &self.frames[age.min(oldest)][picture];
            for (sum, light) in finest.values.iter_mut().zip(&frame.values) {
                *sum += weights[channel] * light;
            }
        }
        let mut levels = vec![finest];
        for _ in self.viewing.bands() {
            let coarser = reduced(&levels[levels.len() - 1], self.viewing.rules.border);
            levels.push(coarser);
        }
        levels
    }

    /// Sums over a band, and its part of the heat map.
    fn band(
        &self,
        channels: &[Levels],
        band: usize,
        cpd: f64,
        gaze: [f64; 2],
    ) -> (BandSums, Plane) {
        let size = channels[0].0[0][band].size;
        let coarse: Vec<[Plane; 2]> = channels
            .iter()
            .map(|levels| [0, 1].map(|k: usize| expanded(&levels.0[k][band + 1], size)))
            .collect();
        let gain = if band == 0 { 1.0 } else { COARSE_BAND_GAIN };
        let mut sums = BandSums::default();
        let mut heat = vec![0.0; size[0] * size[1]];
        for (at, heat) in heat.iter_mut().enumerate() {
            let place = [
                self.geometry.tangent(0, at % size[0], size[0]),
                self.geometry.tangent(1, at / size[0], size[1]),
            ];
            let (eccentricity, magnification) = if self.viewing.foveated {
                (
                    self.geometry.eccentricity_deg(place, gaze),
                    self.geometry.magnification(place),
                )
            } else {
                (0.0, 1.0)
            };
            let adaptation = coarse[0][0].values[at].max(LEAST_ADAPTATION);
            let seen = self.table.at(cpd * magnification, adaptation, eccentricity);
            let zone = zone(eccentricity);
            sums.pixels[zone] += 1.0;
            for (channel, levels) in channels.iter().enumerate() {
                let contrast = [0, 1].map(|k| {
                    let detail = levels.0[k][band].values[at] - coarse[channel][k].values[at];
                    (detail / adaptation).min(MOST_CONTRAST) * gain * seen[channel]
                });
                let difference = masked(contrast, channel);
                sums.sums[zone][channel] += difference.powf(SPACE_EXPONENT);
                *heat += CHANNEL_WEIGHTS[channel] * difference / gain;
            }
        }
        (sums, Plane { size, values: heat })
    }
}

/// Which zone of [`ZONE_BORDERS_DEG`] an eccentricity is in.
fn zone(eccentricity_deg: f64) -> usize {
    let beyond = ZONE_BORDERS_DEG.iter();
    beyond.filter(|border| eccentricity_deg >= **border).count()
}

/// Visible difference of the contrasts of reference and test, in multiples of their thresholds:
/// Mantiuk et al. 2021, contrast masking, mutual.
fn masked([reference, test]: [f64; 2], channel: usize) -> f64 {
    let mask = MASKING * reference.abs().min(test.abs());
    let raw = (test - reference).abs().powf(DIFFERENCE_EXPONENT);
    (raw / (1.0 + mask.powf(MASKING_EXPONENTS[channel]))).min(MOST_DIFFERENCE)
}

/// Bands put together as a pyramid, then on the scale of JODs.
fn heat_of(mut bands: Vec<Plane>) -> Plane {
    let Some(mut sum) = bands.pop() else {
        unreachable!("a viewing has one band at least");
    };
    while let Some(finer) = bands.pop() {
        let below = expanded(&sum, finer.size);
        let values = finer.values.iter().zip(&below.values);
        sum = Plane {
            size: finer.size,
            values: values.map(|(a, b)| a + b).collect(),
        };
    }
    sum.values
        .iter_mut()
        .for_each(|value| *value = jod_lost(*value));
    sum
}
