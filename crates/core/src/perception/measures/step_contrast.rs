//! How much contrast, octave by octave, does one picture show that another does not?

use crate::perception::measures::contrast::{BandContrast, SIGNATURE_BANDS, Signature};
use crate::perception::measures::pyramid::{
    Sample, band_gain, bands_of, doubled, half_size, halved,
};

/// Texels that are added side by side.
const LANES: usize = 8;
/// Texels whose sums are kept in the precision of the pictures.
const BLOCK: usize = 2048;

/// Contrasts of pictures before and after a step, gathered over all their pixels that count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepContrast {
    bands: [BandSums; SIGNATURE_BANDS],
}

/// Sums over the texels of one octave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BandSums {
    texels: u64,
    /// Of sizes of contrast before and after, and of their difference, times the band's gain.
    sizes: [f64; 3],
    fourth_powers: f64,
}

impl StepContrast {
    /// Adds two pictures of `size`, luminance in cd/m² above 0, with whether each pixel counts; a
    /// texel of a coarser octave counts where one of its pixels does. Costs one pass over both.
    ///
    /// # Panics
    /// When there are not as many values as pixels.
    pub fn add(&mut self, pictures: [Vec<f64>; 2], mut counts: Vec<bool>, size: [u32; 2]) {
        let pixels = size[0] as usize * size[1] as usize;
        assert!(counts.len() == pixels, "one value for every pixel");
        self.add_octaves(pictures, size, |sums, before, after, size| {
            sums.add(before, after, &counts);
            counts = any_of_four(&counts, size);
        });
    }

    /// The same where every pixel counts.
    ///
    /// # Panics
    /// When there are not as many values as pixels.
    pub fn add_whole<S: Sample>(&mut self, pictures: [Vec<S>; 2], size: [u32; 2]) {
        self.add_octaves(pictures, size, |sums, before, after, _| {
            sums.add_whole(before, after);
        });
    }

    /// Gives `add` the pictures before and after the step, octave by octave, as luminance and its
    /// local mean.
    fn add_octaves<S: Sample>(
        &mut self,
        [mut before, mut after]: [Vec<S>; 2],
        mut size: [u32; 2],
        mut add: impl FnMut(&mut BandSums, [&[S]; 2], [&[S]; 2], [u32; 2]),
    ) {
        let pixels = size[0] as usize * size[1] as usize;
        let lengths = [before.len(), after.len()];
        assert!(lengths == [pixels; 2], "one value for every pixel");
        for sums in self.bands.iter_mut().take(bands_of(size)) {
            let (coarse_before, coarse_size) = halved(&before, size);
            let (coarse_after, _) = halved(&after, size);
            let mean_before = doubled(&coarse_before, coarse_size, size);
            let mean_after = doubled(&coarse_after, coarse_size, size);
            add(sums, [&before, &mean_before], [&after, &mean_after], size);
            (before, after, size) = (coarse_before, coarse_after, coarse_size);
        }
    }

    /// The means of all that was added. Octaves that no picture has count as no contrast.
    #[must_use]
    pub fn signature(&self) -> Signature {
        let band = |index: usize| self.bands[index].means(band_gain(index));
        Signature {
            bands: core::array::from_fn(band),
        }
    }
}

impl BandSums {
    /// Adds the texels that count, of pictures given as luminance and its local mean.
    fn add(
        &mut self,
        [before, mean_before]: [&[f64]; 2],
        [after, mean_after]: [&[f64]; 2],
        counts: &[bool],
    ) {
        let pairs = before.iter().zip(mean_before);
        let pairs = pairs.zip(after.iter().zip(mean_after)).zip(counts);
        for (((b, mean_b), (a, mean_a)), _) in pairs.filter(|(_, counts)| **counts) {
            let (b, a) = ((b - mean_b) / mean_b, (a - mean_a) / mean_a);
            for (sum, value) in self.sizes.iter_mut().zip([b, a, a - b]) {
                *sum += value.abs();
            }
            let square = (a - b) * (a - b);
            self.fourth_powers += square * square;
            self.texels += 1;
        }
    }

    /// Adds all texels, several side by side.
    fn add_whole<S: Sample>(
        &mut self,
        [before, mean_before]: [&[S]; 2],
        [after, mean_after]: [&[S]; 2],
    ) {
        let all = [before, mean_before, after, mean_after];
        for start in (0..before.len()).step_by(BLOCK) {
            let end = (start + BLOCK).min(before.len());
            let [b, mean_b, a, mean_a] = all.map(|it| it[start..end].as_chunks::<LANES>());
            let mut lanes = [[S::from(0.0); LANES]; 4];
            let sides = b.0.iter().zip(mean_b.0).zip(a.0.iter().zip(mean_a.0));
            for ((b, mean_b), (a, mean_a)) in sides {
                for lane in 0..LANES {
                    let terms = terms(b[lane], mean_b[lane], a[lane], mean_a[lane]);
                    for (lanes, term) in lanes.iter_mut().zip(terms) {
                        lanes[lane] = lanes[lane] + term;
                    }
                }
            }
            let rest = b.1.iter().zip(mean_b.1).zip(a.1.iter().zip(mean_a.1));
            for ((b, mean_b), (a, mean_a)) in rest {
                for (lanes, term) in lanes.iter_mut().zip(terms(*b, *mean_b, *a, *mean_a)) {
                    lanes[0] = lanes[0] + term;
                }
            }
            let sums = lanes.map(|lanes| lanes.into_iter().map(Into::into).sum::<f64>());
            for (sum, of_block) in self.sizes.iter_mut().zip(sums) {
                *sum += of_block;
            }
            self.fourth_powers += sums[3];
        }
        self.texels += before.len() as u64;
    }

    fn means(&self, gain: f64) -> BandContrast {
        let count = self.texels.max(1) as f64;
        let [before, after, difference] = self.sizes.map(|sum| sum / gain / count);
        BandContrast {
            before,
            after,
            difference,
            norm: (self.fourth_powers / count).sqrt().sqrt() / gain,
        }
    }
}

/// Of one texel, the sizes of contrast before and after and of their difference, and the fourth
/// power of that.
#[inline(always)]
fn terms<S: Sample>(before: S, mean_before: S, after: S, mean_after: S) -> [S; 4] {
    let b = (before - mean_before) / mean_before;
    let a = (after - mean_after) / mean_after;
    let square = (a - b) * (a - b);
    [b.size(), a.size(), (a - b).size(), square * square]
}

/// For each texel of the next coarser octave whether one of the up to four in it counts.
fn any_of_four(counts: &[bool], size: [u32; 2]) -> Vec<bool> {
    let half = half_size(size);
    let [columns, rows] = size.map(|side| side as usize);
    let mut coarse = vec![false; half[0] as usize * half[1] as usize];
    for (y, row) in counts.chunks_exact(columns).take(rows).enumerate() {
        let coarse = &mut coarse[y / 2 * half[0] as usize..];
        for (x, counts) in row.iter().enumerate() {
            coarse[x / 2] |= *counts;
        }
    }
    coarse
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [24, 20];

    fn noise(seed: u32) -> Vec<f64> {
        let value = |k: u32| {
            let bits = (k + seed).wrapping_mul(2_654_435_761) >> 20;
            10.0 + f64::from(bits) / 50.0
        };
        (0..SIZE[0] * SIZE[1]).map(value).collect()
    }

    fn all() -> Vec<bool> {
        vec![true; noise(0).len()]
    }

    fn of(before: Vec<f64>, after: Vec<f64>, counts: Vec<bool>) -> Signature {
        let mut sums = StepContrast::default();
        sums.add([before, after], counts, SIZE);
        sums.signature()
    }

    #[test]
    fn a_step_that_changes_nothing_adds_nothing() {
        for band in of(noise(1), noise(1), all()).bands {
            assert!(band.before > 0.0 && band.before == band.after, "{band:?}");
            assert_eq!([band.difference, band.norm], [0.0; 2]);
        }
    }

    #[test]
    fn pictures_pool_by_the_pixels_that_count() {
        let once = of(noise(1), noise(2), all());
        let mut twice = StepContrast::default();
        for _ in 0..2 {
            twice.add([noise(1), noise(2)], all(), SIZE);
        }
        twice.add([noise(3), noise(4)], vec![false; all().len()], SIZE);
        for (once, twice) in once.bands.iter().zip(twice.signature().bands) {
            assert!((once.difference - twice.difference).abs() < 1e-12);
            assert!((once.norm - twice.norm).abs() < 1e-12);
        }
    }

    #[test]
    fn what_does_not_count_is_not_weighed() {
        let is_left = |k: usize| k % (SIZE[0] as usize) < 12;
        let mut after = noise(1);
        for (k, light) in after.iter_mut().enumerate() {
            *light *= if is_left(k) { 1.0 } else { (1 + k % 3) as f64 };
        }
        let counted = |left: bool| {
            let counts = (0..after.len()).map(|k| is_left(k) == left).collect();
            of(noise(1), after.clone(), counts)
        };
        // Filters reach a few texels over the middle.
        let [left, right] = [true, false].map(|left| counted(left).bands[0].difference);
        assert!(left < 0.2 * right, "{left} {right}");
    }

    #[test]
    fn small_pictures_have_fewer_octaves_or_none() {
        for (size, bands) in [([1, 1], 0), ([3, 9], 0), ([4, 4], 1), ([8, 8], 2)] {
            let pixels = (size[0] * size[1]) as usize;
            let mut sums = StepContrast::default();
            let pictures = [vec![5.0; pixels], noise(1)[..pixels].to_vec()];
            sums.add(pictures, vec![true; pixels], size);
            let told = sums.signature().bands;
            let told = told.iter().filter(|it| it.difference > 0.0).count();
            assert_eq!(told, bands, "{size:?}");
        }
    }
}
