//! How do differences everywhere become one number?
//!
//! Mantiuk et al. 2021, pooling: a norm over pixels, sums over bands, a norm over channels, a
//! mean over frames, and a power to the scale of just-objectionable differences.

use super::constants::{CHANNEL_EXPONENT, CHANNEL_WEIGHTS, SPACE_EXPONENT};
use serde::Serialize;

/// Borders between zones, degrees of eccentricity.
pub const ZONE_BORDERS_DEG: [f64; 2] = [5.0, 20.0];
/// Zones of eccentricity: under 5°, 5° to 20°, over 20°.
pub const ZONES: usize = 3;

/// What was summed up over the pixels of one band, by zone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BandSums {
    /// By zone: the sums of `D^beta` of the sustained and the transient channel.
    pub sums: [[f64; 2]; ZONES],
    /// By zone: the number of pixels.
    pub pixels: [f64; ZONES],
}

impl BandSums {
    /// Adds what was summed up elsewhere in the same band.
    pub fn add(&mut self, other: &Self) {
        for zone in 0..ZONES {
            for channel in 0..2 {
                self.sums[zone][channel] += other.sums[zone][channel];
            }
            self.pixels[zone] += other.pixels[zone];
        }
    }

    /// Energies of the two channels over all zones.
    fn energies(&self) -> [f64; 2] {
        let total = |channel: usize| self.sums.iter().map(|sums| sums[channel]).sum::<f64>();
        let pixels: f64 = self.pixels.iter().sum();
        [0, 1].map(|channel| energy(total(channel), pixels))
    }

    fn energies_of(&self, zone: usize) -> [f64; 2] {
        self.sums[zone].map(|sum| energy(sum, self.pixels[zone]))
    }
}

/// The norm over pixels: `(mean of D^beta)^(1/beta)`, 0 of none.
fn energy(sum: f64, pixels: f64) -> f64 {
    (sum / pixels.max(1.0)).powf(1.0 / SPACE_EXPONENT)
}

/// Quality difference of energies by band: sum over bands, norm over channels.
#[must_use]
pub fn quality(bands: &[[f64; 2]]) -> f64 {
    let channel = |channel: usize| {
        let sum: f64 = bands.iter().map(|energies| energies[channel]).sum();
        (sum * CHANNEL_WEIGHTS[channel]).powf(CHANNEL_EXPONENT)
    };
    (channel(0) + channel(1)).powf(1.0 / CHANNEL_EXPONENT)
}

/// Just-objectionable differences of a quality difference: 10 for none, 1 less where three of four
/// people prefer the other; no lower limit.
#[must_use]
pub fn jod(quality: f64) -> f64 {
    10.0 - jod_lost(quality)
}

/// What is missing to 10.
pub use foveal_core::perception::visible_loss::jod_lost;

/// Score of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameScore {
    /// Just-objectionable differences, had all frames been like this.
    pub jod: f64,
    /// What is averaged over frames.
    pub quality: f64,
    /// Sustained and transient energies, finest band first.
    pub bands: Vec<[f64; 2]>,
    /// By zone, had the whole picture been like it; `None` without a gaze or outside the picture.
    pub zones: [Option<ZoneQuality>; ZONES],
}

/// One zone of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZoneQuality {
    /// As of a whole picture.
    pub quality: f64,
    /// Share of the frame's pixels.
    pub pixels_share: f64,
}

impl FrameScore {
    /// Of the sums of every band, finest first.
    #[must_use]
    pub fn new(sums: &[BandSums], foveated: bool) -> Self {
        let bands: Vec<[f64; 2]> = sums.iter().map(BandSums::energies).collect();
        let quality = quality(&bands);
        let zones = [0, 1, 2].map(|zone| zone_quality(sums, zone).filter(|_| foveated));
        Self {
            jod: jod(quality),
            quality,
            bands,
            zones,
        }
    }
}

fn zone_quality(sums: &[BandSums], zone: usize) -> Option<ZoneQuality> {
    let finest = sums.first()?;
    let all: f64 = finest.pixels.iter().sum();
    if finest.pixels[zone] == 0.0 {
        return None;
    }
    let bands: Vec<[f64; 2]> = sums.iter().map(|sums| sums.energies_of(zone)).collect();
    Some(ZoneQuality {
        quality: quality(&bands),
        pixels_share: finest.pixels[zone] / all,
    })
}

/// Score of a whole comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Just-objectionable differences: 10 is no difference.
    pub jod: f64,
    /// Frames that it is the score of.
    pub frames: usize,
    /// Mean energies, finest band first.
    pub bands: Vec<BandEnergies>,
    /// By eccentricity; `None` where there is no gaze.
    pub zones: Option<Zones>,
    /// Just-objectionable differences of every frame.
    pub per_frame: Vec<f64>,
}

/// Mean energies of one band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BandEnergies {
    /// Its centre, cycles per degree in the middle of the panel.
    pub cpd: f64,
    /// Of what stays.
    pub sustained: f64,
    /// Of what changes.
    pub transient: f64,
}

/// Scores by eccentricity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Zones {
    /// Where the eye looks.
    pub under_5_deg: Option<Zone>,
    /// Around.
    pub from_5_to_20_deg: Option<Zone>,
    /// The rest.
    pub over_20_deg: Option<Zone>,
}

/// Score of one zone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Zone {
    /// Just-objectionable differences, had the whole picture been like it.
    pub jod: f64,
    /// Mean share of the pixels.
    pub pixels_share: f64,
}

/// Takes in frame after frame; keeps a number a frame.
#[derive(Clone, Debug, Default)]
pub struct Pool {
    quality: f64,
    bands: Vec<[f64; 2]>,
    zones: [Option<(ZoneQuality, f64)>; ZONES],
    per_frame: Vec<f64>,
}

impl Pool {
    /// Takes in the next frame.
    pub fn add(&mut self, frame: &FrameScore) {
        self.per_frame.push(frame.jod);
        self.quality += frame.quality;
        self.bands.resize(frame.bands.len(), [0.0; 2]);
        for (sum, band) in self.bands.iter_mut().zip(&frame.bands) {
            sum[0] += band[0];
            sum[1] += band[1];
        }
        for (sum, zone) in self.zones.iter_mut().zip(frame.zones) {
            let Some(zone) = zone else { continue };
            let (before, frames) = sum.unwrap_or((
                ZoneQuality {
                    quality: 0.0,
                    pixels_share: 0.0,
                },
                0.0,
            ));
            let added = ZoneQuality {
                quality: before.quality + zone.quality,
                pixels_share: before.pixels_share + zone.pixels_share,
            };
            *sum = Some((added, frames + 1.0));
        }
    }

    /// The score of the frames so far, whose bands are centred at `centres`; `None` of none.
    #[must_use]
    pub fn score(&self, centres: &[f64]) -> Option<Score> {
        let frames = self.per_frame.len();
        if frames == 0 {
            return None;
        }
        let count = frames as f64;
        let bands = centres.iter().zip(&self.bands);
        let zone = |zone: usize| {
            self.zones[zone].map(|(sum, frames)| Zone {
                jod: jod(sum.quality / frames),
                pixels_share: sum.pixels_share / count,
            })
        };
        Some(Score {
            jod: jod(self.quality / count),
            frames,
            bands: bands
                .map(|(cpd, sums)| BandEnergies {
                    cpd: *cpd,
                    sustained: sums[0] / count,
                    transient: sums[1] / count,
                })
                .collect(),
            zones: self.zones.iter().any(Option::is_some).then(|| Zones {
                under_5_deg: zone(0),
                from_5_to_20_deg: zone(1),
                over_20_deg: zone(2),
            }),
            per_frame: self.per_frame.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_difference_is_10_and_more_is_less() {
        assert_eq!(jod(0.0), 10.0);
        let scores: Vec<f64> = (0..50).map(|n| jod(f64::from(n) * 100.0)).collect();
        assert!(scores.windows(2).all(|pair| pair[1] < pair[0]));
    }

    #[test]
    fn published_energies_give_the_published_score() {
        // Case G1 of the goldens: a still, six bands.
        let sustained = [56.75, 4934.74, 3089.71, 909.129, 805.322, 71.3477];
        let bands = sustained.map(|energy| [energy, 0.0]);
        assert!((jod(quality(&bands)) - 6.27135).abs() < 2e-4);
    }

    #[test]
    fn zones_add_up_to_the_picture() {
        let part = |n: f64| [n * 3.0, n];
        let sums = BandSums {
            sums: [part(1.0), part(2.0), part(5.0)],
            pixels: [10.0, 20.0, 50.0],
        };
        let frame = FrameScore::new(&[sums], true);
        // The same mean in every zone.
        for zone in frame.zones {
            assert!((zone.unwrap().quality - frame.quality).abs() < 1e-9);
        }
        let shares: f64 = frame.zones.iter().flatten().map(|z| z.pixels_share).sum();
        assert!((shares - 1.0).abs() < 1e-12);
        assert_eq!(FrameScore::new(&[sums], false).zones, [None; 3]);
    }
}
