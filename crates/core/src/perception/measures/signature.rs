//! How much contrast does a tile show that its next coarser level does not?
//!
//! Measured once, while preparing, so that a step can be valued for any gaze without drawing it: of
//! video on both levels as they are decoded, of others on one picture.

use crate::perception::gain::BandStep;
use crate::perception::measures::contrast::{SIGNATURE_BANDS, Signature};
use crate::perception::measures::pyramid::{band_frequency, doubled, halved};
use crate::perception::measures::step_contrast::StepContrast;
use crate::perception::parameters::Parameters;
use crate::units::Ppd;
use crate::view::picture::{Colour, Picture};

/// The signature of a tile's picture, against the same picture `ratio` times coarser and enlarged
/// again. Luminance is that of the default display. Costs one pass over the picture.
///
/// # Panics
/// When `ratio` is not a power of two.
#[must_use]
pub fn signature_of(picture: &Picture, colour: Colour, ratio: u32) -> Signature {
    assert!(ratio.is_power_of_two(), "a ratio of {ratio} between levels");
    let parameters = Parameters::default();
    let table = luminance_table(&parameters, colour);
    let size = [picture.width, picture.height];
    let codes = picture.planes[0].iter();
    let after: Vec<f64> = codes.map(|code| table[usize::from(*code)]).collect();
    let before = blurred(&after, size, ratio.trailing_zeros());
    let mut contrast = StepContrast::default();
    contrast.add_whole([before, after], size);
    contrast.signature()
}

/// A plane of luma: rows of codes from the top on, without gaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LumaPlane<'a> {
    /// A code for each pixel.
    pub codes: &'a [u8],
    /// Columns and rows.
    pub size: [u32; 2],
}

/// Measures steps between pictures of two levels, as they are shown.
#[derive(Clone, Debug)]
pub struct StepMeter {
    /// Luminance of every code on the default display, in cd/m².
    light: [f32; 256],
    octaves: u32,
}

impl StepMeter {
    /// For luma of this colour, and levels that are `ratio` times apart.
    ///
    /// # Panics
    /// When `ratio` is not a power of two.
    #[must_use]
    pub fn new(colour: Colour, ratio: u32) -> Self {
        assert!(ratio.is_power_of_two(), "a ratio of {ratio} between levels");
        let table = luminance_table(&Parameters::default(), colour);
        Self {
            light: table.map(|light| light as f32),
            octaves: ratio.trailing_zeros(),
        }
    }

    /// What `fine` shows that `coarse` does not: errors of coding count like detail, on either
    /// side. `fine` begins `at` pixels of its own right of and below where `coarse` begins. Costs
    /// about 10 ns a pixel.
    ///
    /// # Panics
    /// When a plane has not as many codes as pixels, or none.
    #[must_use]
    pub fn signature(&self, coarse: LumaPlane, fine: LumaPlane, at: [u32; 2]) -> Signature {
        let before = self.enlarged(coarse, fine.size, at);
        let after = self.lit(fine.codes);
        let mut contrast = StepContrast::default();
        contrast.add_whole([before, after], fine.size);
        contrast.signature()
    }

    fn lit(&self, codes: &[u8]) -> Vec<f32> {
        let light = |code: &u8| self.light[usize::from(*code)];
        codes.iter().map(light).collect()
    }

    /// The light of a coarse picture at `size` fine pixels from `at` on; its borders repeat.
    fn enlarged(&self, coarse: LumaPlane, size: [u32; 2], at: [u32; 2]) -> Vec<f32> {
        let pixels = coarse.size[0] as usize * coarse.size[1] as usize;
        assert!(
            coarse.codes.len() == pixels && pixels > 0,
            "one code a pixel"
        );
        let ratio = 1 << self.octaves;
        // With a pixel more on each side, which those at the border are interpolated with.
        let from = [0, 1].map(|k| (at[k] / ratio).saturating_sub(1).min(coarse.size[k] - 1));
        let to = [0, 1].map(|k| {
            let end = (at[k] + size[k]).div_ceil(ratio) + 1;
            end.clamp(from[k] + 1, coarse.size[k])
        });
        let mut part = Vec::new();
        for row in from[1]..to[1] {
            let row = &coarse.codes[row as usize * coarse.size[0] as usize..];
            part.extend(self.lit(&row[from[0] as usize..to[0] as usize]));
        }
        let mut part_size = [0, 1].map(|k| to[k] - from[k]);
        for _ in 0..self.octaves {
            let twice = part_size.map(|side| 2 * side);
            part = doubled(&part, part_size, twice);
            part_size = twice;
        }
        let left = [0, 1].map(|k| at[k] - from[k] * ratio);
        let mut out = Vec::with_capacity(size[0] as usize * size[1] as usize);
        for y in 0..size[1] {
            let y = (left[1] + y).min(part_size[1] - 1) as usize;
            let row = &part[y * part_size[0] as usize..][..part_size[0] as usize];
            let first = left[0].min(part_size[0] - 1) as usize;
            let inside = (size[0] as usize).min(row.len() - first);
            out.extend_from_slice(&row[first..first + inside]);
            out.resize(
                out.len() + size[0] as usize - inside,
                row[first + inside - 1],
            );
        }
        out
    }
}

/// What a signature says of a step to a level that has `ppd` pixels a degree where it is seen.
#[must_use]
pub fn band_steps(signature: &Signature, ppd: Ppd) -> [BandStep; SIGNATURE_BANDS] {
    core::array::from_fn(|index| {
        let band = signature.bands[index];
        BandStep {
            cpd: band_frequency(index, ppd),
            contrast_before: band.before,
            contrast_after: band.after,
            difference: band.difference,
        }
    })
}

/// Luminance in cd/m² of every code value of the Y plane.
fn luminance_table(parameters: &Parameters, colour: Colour) -> [f64; 256] {
    let full = parameters.luma_table();
    if colour.full_range {
        return full;
    }
    core::array::from_fn(|code| {
        let stretched = (code as f64 - 16.0) * 255.0 / 219.0;
        full[stretched.round().clamp(0.0, 255.0) as usize]
    })
}

/// The picture halved `times` and enlarged to its size again.
fn blurred(fine: &[f64], size: [u32; 2], times: u32) -> Vec<f64> {
    if times == 0 {
        return fine.to_vec();
    }
    let (coarse, coarse_size) = halved(fine, size);
    doubled(&blurred(&coarse, coarse_size, times - 1), coarse_size, size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::perception::measures::contrast::BandContrast;
    use crate::perception::measures::pyramid::Pyramid;
    use crate::view::picture::Matrix;

    const COLOUR: Colour = Colour {
        matrix: Matrix::Bt709,
        full_range: true,
        chroma_left: false,
    };

    /// Vertical stripes of a period in pixels round mid-grey.
    fn stripes(period: f64, amplitude: f64) -> Picture {
        let mut picture = Picture::filled(128, 128, [128; 3]);
        for (k, sample) in picture.planes[0].iter_mut().enumerate() {
            let phase = core::f64::consts::TAU * ((k % 128) as f64 + 0.5) / period;
            *sample = (128.0 + amplitude * phase.cos()).round() as u8;
        }
        picture
    }

    fn differences(picture: &Picture) -> [f64; SIGNATURE_BANDS] {
        signature_of(picture, COLOUR, 2)
            .bands
            .map(|band| band.difference)
    }

    /// The definition: means over two whole pyramids.
    #[test]
    fn a_signature_is_the_mean_difference_of_two_pyramids() {
        for (size, ratio) in [([64, 48], 2u32), ([37, 53], 4), ([9, 5], 2), ([3, 8], 2)] {
            let mut picture = Picture::filled(size[0], size[1], [0, 128, 128]);
            for (k, sample) in (0u32..).zip(&mut picture.planes[0]) {
                *sample = (k.wrapping_mul(2_654_435_761) >> 24) as u8;
            }
            let table = luminance_table(&Parameters::default(), COLOUR);
            let after: Vec<f64> = picture.planes[0]
                .iter()
                .map(|c| table[usize::from(*c)])
                .collect();
            let before = blurred(&after, size, ratio.ilog2());
            let [before, after] = [before, after].map(|values| Pyramid::of(values, size).bands);
            let signature = signature_of(&picture, COLOUR, ratio);
            for (k, band) in signature.bands.iter().enumerate() {
                let (Some(before), Some(after)) = (before.get(k), after.get(k)) else {
                    assert_eq!(*band, BandContrast::default());
                    continue;
                };
                let mean = |at: &dyn Fn(usize) -> f64| {
                    let count = after.contrast.len();
                    (0..count).map(|k| at(k).abs()).sum::<f64>() / count as f64
                };
                let expected = [
                    mean(&|k| before.contrast[k]),
                    mean(&|k| after.contrast[k]),
                    mean(&|k| after.contrast[k] - before.contrast[k]),
                ];
                let found = [band.before, band.after, band.difference];
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!(
                        (found - expected).abs() < 1e-12,
                        "{size:?} {found} {expected}"
                    );
                }
            }
        }
    }

    /// Noise without a pattern, brighter to the right.
    fn rough(size: [u32; 2], seed: u32) -> Vec<u8> {
        let code = |k: u32| {
            let noise = (k + seed).wrapping_mul(2_654_435_761) >> 27;
            (60 + noise + k % size[0]) as u8
        };
        (0..size[0] * size[1]).map(code).collect()
    }

    /// A part of a plane, its last pixels repeated beyond its borders.
    fn part_of(codes: &[u8], size: [u32; 2], at: [u32; 2], part: [u32; 2]) -> Vec<u8> {
        let column = |y: u32, x: u32| {
            let [x, y] = [at[0] + x, at[1] + y];
            codes[(y.min(size[1] - 1) * size[0] + x.min(size[0] - 1)) as usize]
        };
        let row = |y| (0..part[0]).map(move |x| column(y, x));
        (0..part[1]).flat_map(row).collect()
    }

    #[test]
    fn a_step_is_measured_where_the_fine_picture_lies_in_the_coarse_one() {
        for (ratio, at, size) in [
            (2, [0, 0], [40, 32]),
            (2, [32, 14], [29, 31]),
            (4, [18, 0], [18, 18]),
            (4, [54, 36], [9, 27]),
        ] {
            let meter = StepMeter::new(COLOUR, ratio);
            let coarse_size = [40, 30];
            let codes = rough(coarse_size, 1);
            let coarse = LumaPlane {
                codes: &codes,
                size: coarse_size,
            };
            let light: Vec<f32> = codes
                .iter()
                .map(|code| meter.light[usize::from(*code)])
                .collect();
            let (mut whole, mut whole_size) = (light, coarse_size);
            while whole_size[0] < ratio * coarse_size[0] {
                let twice = whole_size.map(|side| 2 * side);
                whole = doubled(&whole, whole_size, twice);
                whole_size = twice;
            }
            let found = meter.enlarged(coarse, size, at);
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let expected = whole[((at[1] + y) * whole_size[0] + at[0] + x) as usize];
                    assert_eq!(
                        found[(y * size[0] + x) as usize],
                        expected,
                        "{at:?} {x} {y}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_step_tells_of_noise_on_either_side() {
        let meter = StepMeter::new(COLOUR, 2);
        let sizes = [[32, 32], [64, 64]];
        let grey = sizes.map(|size| vec![100; (size[0] * size[1]) as usize]);
        let noise = sizes.map(|size| part_of(&rough([4000, 64], 3), [4000, 64], [0; 2], size));
        let norms = |coarse: &[u8], fine: &[u8]| {
            let [coarse, fine] = [(coarse, sizes[0]), (fine, sizes[1])]
                .map(|(codes, size)| LumaPlane { codes, size });
            meter
                .signature(coarse, fine, [0; 2])
                .bands
                .map(|band| band.norm)
        };
        assert_eq!(norms(&grey[0], &grey[1]), [0.0; SIGNATURE_BANDS]);
        let [fine, coarse] = [norms(&grey[0], &noise[1]), norms(&noise[0], &grey[1])];
        assert!(fine[0] > 0.03 && coarse[1] > 0.03, "{fine:?} {coarse:?}");
    }

    #[test]
    fn what_enters_late_is_told_as_if_it_had_been_there_at_first() {
        let meter = StepMeter::new(COLOUR, 2);
        let [empty, there] = [40, 200].map(|code| {
            let mut codes = vec![40; 64 * 64];
            for k in 0..6 {
                codes[(20 + k) * 64 + 21..][..3].fill(code);
            }
            codes
        });
        let coarse = vec![40; 32 * 32];
        let signature = |codes: &Vec<u8>| {
            let fine = LumaPlane {
                codes,
                size: [64; 2],
            };
            let coarse = LumaPlane {
                codes: &coarse,
                size: [32; 2],
            };
            meter.signature(coarse, fine, [0; 2])
        };
        let group = |late: usize| {
            let frames = (0..8).map(|frame| signature(if frame < late { &empty } else { &there }));
            frames.fold(Signature::default(), Signature::strongest)
        };
        let first = group(0);
        assert!(first.bands[0].norm > 0.1, "{first:?}");
        for late in 1..8 {
            assert_eq!(group(late), first);
        }
    }

    #[test]
    fn a_plain_tile_gains_nothing() {
        for size in [[128, 128], [1, 1], [7, 30]] {
            let plain = Picture::filled(size[0], size[1], [200, 128, 128]);
            let signature = signature_of(&plain, COLOUR, 2);
            assert!(signature.bands.iter().all(|band| band.difference < 1e-9));
        }
    }

    #[test]
    fn what_the_coarser_level_cannot_hold_is_gained() {
        let fine = differences(&stripes(3.0, 60.0));
        let coarse = differences(&stripes(16.0, 60.0));
        assert!(
            fine[0] > 0.1 && coarse[0] < 0.1 * fine[0],
            "{fine:?} {coarse:?}"
        );
    }

    #[test]
    fn stronger_detail_gains_more() {
        let [weak, strong] = [10.0, 60.0].map(|amplitude| differences(&stripes(3.0, amplitude)));
        assert!(strong[0] > 3.0 * weak[0]);
    }

    #[test]
    fn limited_range_means_the_same_light() {
        let limited = luminance_table(
            &Parameters::default(),
            Colour {
                full_range: false,
                ..COLOUR
            },
        );
        let full = luminance_table(&Parameters::default(), COLOUR);
        assert_eq!(
            [limited[16], limited[235], limited[255]],
            [full[0], full[255], full[255]]
        );
    }
}
