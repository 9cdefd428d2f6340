//! How sensitive is the eye to a band, at a luminance and an eccentricity, without computing it?
//!
//! The closed formula is [`foveal_core::perception::sensitivity`]; the published metric reads it
//! from a table of 32 x 32 x 32 entries, whose interpolation is part of its scores.

use super::constants::{CHANNEL_HERTZ, SENSITIVITY_FACTOR};
use super::rules::SensitivityRule;
use foveal_core::perception::sensitivity::{cortical_magnification, sensitivity};
use foveal_core::units::{Cpd, Radians};
use std::sync::{Arc, OnceLock};

/// Least sensitivity that a table holds.
const LEAST: f64 = 1e-4;

/// One axis of a table: `entries` values evenly spaced over a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// First and last value.
    pub range: [f64; 2],
    /// Two at least.
    pub entries: usize,
}

impl Axis {
    /// The place of a value, from 0 to the last entry: what lies beyond is clamped.
    #[must_use]
    pub fn place(&self, value: f64) -> f64 {
        let [first, last] = self.range;
        let steps = (self.entries - 1) as f64;
        ((value - first) / (last - first) * steps).clamp(0.0, steps)
    }

    fn value(&self, index: usize) -> f64 {
        let [first, last] = self.range;
        first + (last - first) * index as f64 / (self.entries - 1) as f64
    }
}

/// Log2 of the sensitivities of both channels, interpolated linearly.
#[derive(Clone, Debug)]
pub struct LogSensitivityTable {
    /// Over log2 of cd/m².
    pub luminance: Axis,
    /// Over log2 of cycles per degree: in the picture, or where eccentricity has no axis at the
    /// cortex.
    pub frequency: Axis,
    /// Over the root of degrees; one entry where eccentricity only stretches frequency.
    pub eccentricity: Axis,
    /// Log2 of sustained and transient sensitivity; luminance changes fastest, then frequency.
    pub entries: Arc<Vec<[f64; 2]>>,
}

/// The published grid: luminance 0.001 to 10000 cd/m², frequency 1/16 to 64, eccentricity to 120°.
const COARSE: [Axis; 3] = [
    Axis {
        range: [-9.965_784_284_662_087, 13.287_712_379_549_45],
        entries: 32,
    },
    Axis {
        range: [-4.0, 6.0],
        entries: 32,
    },
    Axis {
        range: [0.0, 10.954_451_150_103_322],
        entries: 32,
    },
];
/// Steps of 1/8 octave of luminance and 1/32 of frequency: the formula within 2e-5.
const FINE: [Axis; 3] = [
    Axis {
        range: [-10.0, 14.0],
        entries: 24 * 8 + 1,
    },
    Axis {
        range: [-6.0, 9.0],
        entries: 15 * 32 + 1,
    },
    Axis {
        range: [0.0, 1.0],
        entries: 1,
    },
];

impl LogSensitivityTable {
    /// The table of a rule; made once, in about a tenth of a second.
    #[must_use]
    pub fn of(rule: SensitivityRule) -> Self {
        static TABLES: [OnceLock<Arc<Vec<[f64; 2]>>>; 2] = [OnceLock::new(), OnceLock::new()];
        let (axes, kept) = match rule {
            SensitivityRule::Coarse => (COARSE, &TABLES[0]),
            SensitivityRule::Fine => (FINE, &TABLES[1]),
        };
        let entries = kept.get_or_init(|| Arc::new(entries(axes)));
        let [luminance, frequency, eccentricity] = axes;
        Self {
            luminance,
            frequency,
            eccentricity,
            entries: Arc::clone(entries),
        }
    }

    /// Whether eccentricity has an axis of its own.
    #[must_use]
    pub fn has_eccentricity(&self) -> bool {
        self.eccentricity.entries > 1
    }

    /// Octaves by which eccentricity raises frequency before it is looked up.
    #[must_use]
    pub fn raised(&self, eccentricity_deg: f64) -> f64 {
        if self.has_eccentricity() {
            return 0.0;
        }
        -cortical_magnification(Radians::from_degrees(eccentricity_deg)).log2()
    }

    /// Sustained and transient sensitivity, corrected as the fit asks.
    #[must_use]
    pub fn at(&self, frequency: f64, luminance: f64, eccentricity_deg: f64) -> [f64; 2] {
        let octave = frequency.log2() + self.raised(eccentricity_deg);
        let across = self.luminance.place(luminance.log2());
        let down = self.frequency.place(octave);
        let deep = if self.has_eccentricity() {
            self.eccentricity.place(eccentricity_deg.sqrt())
        } else {
            0.0
        };
        let [w, h] = [self.luminance.entries, self.frequency.entries];
        let mut log2 = [0.0; 2];
        for (z, share_z) in neighbours(deep, self.eccentricity.entries) {
            for (y, share_y) in neighbours(down, h) {
                for (x, share_x) in neighbours(across, w) {
                    let entry = self.entries[(z * h + y) * w + x];
                    for (sum, log2) in log2.iter_mut().zip(entry) {
                        *sum += share_z * share_y * share_x * log2;
                    }
                }
            }
        }
        log2.map(|log2| log2.exp2() * SENSITIVITY_FACTOR)
    }
}

/// The entries that a place lies between, and their shares.
fn neighbours(place: f64, entries: usize) -> [(usize, f64); 2] {
    let low = (place as usize).min(entries.saturating_sub(2));
    let share = place - low as f64;
    [(low, 1.0 - share), ((low + 1).min(entries - 1), share)]
}

fn entries([luminance, frequency, eccentricity]: [Axis; 3]) -> Vec<[f64; 2]> {
    let mut entries = Vec::new();
    for z in 0..eccentricity.entries {
        let root = if eccentricity.entries > 1 {
            eccentricity.value(z)
        } else {
            0.0
        };
        let apart = Radians::from_degrees(root * root);
        for y in 0..frequency.entries {
            let frequency = Cpd(frequency.value(y).exp2());
            for x in 0..luminance.entries {
                let light = luminance.value(x).exp2();
                entries.push(CHANNEL_HERTZ.map(|hertz| {
                    let found = sensitivity(frequency, hertz, light, apart);
                    found.max(LEAST).log2()
                }));
            }
        }
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fine_table_is_the_formula_and_the_coarse_one_is_near_it() {
        let [fine, coarse] =
            [SensitivityRule::Fine, SensitivityRule::Coarse].map(LogSensitivityTable::of);
        for frequency in [0.3, 1.0, 3.7, 7.9, 19.0] {
            for luminance in [0.11, 2.0, 33.0, 180.0] {
                for degrees in [0.0, 1.0, 7.0, 31.0, 60.0] {
                    let found = fine.at(frequency, luminance, degrees);
                    let near = coarse.at(frequency, luminance, degrees);
                    for (channel, hertz) in CHANNEL_HERTZ.into_iter().enumerate() {
                        let apart = Radians::from_degrees(degrees);
                        let wanted = sensitivity(Cpd(frequency), hertz, luminance, apart)
                            .max(LEAST)
                            * SENSITIVITY_FACTOR;
                        let case = (frequency, luminance, degrees, channel);
                        let ratio = found[channel] / wanted;
                        assert!((ratio - 1.0).abs() < 2e-3, "{case:?}: {ratio}");
                        let ratio = near[channel] / wanted;
                        assert!((0.7..1.3).contains(&ratio), "{case:?}: {ratio}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_lies_beyond_a_table_has_the_value_at_its_edge() {
        let table = LogSensitivityTable::of(SensitivityRule::Coarse);
        assert_eq!(table.at(200.0, 1e6, 150.0), table.at(64.0, 1e4, 120.0));
        assert_eq!(table.at(1e-3, 1e-6, 0.0), table.at(1.0 / 16.0, 1e-3, 0.0));
    }
}
