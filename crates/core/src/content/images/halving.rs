//! What does the next coarser level of a texture look like?
//!
//! Each texel is the mean light of four, weighed by their alpha, so that what is not seen lends no
//! colour. The same for who prepares and for who draws.

use super::picture::TexturePicture;
use crate::perception::luminance::linear_from_srgb;

/// Turns codes into light and back.
#[derive(Clone, Debug)]
pub struct Halving {
    linear: [f32; 256],
    /// The light half way between each code and the next.
    between: [f32; 255],
}

impl Default for Halving {
    fn default() -> Self {
        let linear: [f32; 256] = core::array::from_fn(|code| linear_from_srgb(code as u8) as f32);
        Self {
            between: core::array::from_fn(|code| (linear[code] + linear[code + 1]) / 2.0),
            linear,
        }
    }
}

impl Halving {
    /// The code whose light is nearest.
    #[must_use]
    pub fn code(&self, light: f32) -> u8 {
        self.between.partition_point(|it| *it <= light) as u8
    }

    /// The light of a code, from 0 to 1.
    #[must_use]
    pub fn light(&self, code: u8) -> f32 {
        self.linear[usize::from(code)]
    }

    /// A picture of half as many columns and rows, rounded up; what is odd counts its last texels
    /// twice. Costs a pass over the picture.
    #[must_use]
    pub fn halved(&self, fine: &TexturePicture) -> TexturePicture {
        let size = fine.size.map(|side| side.div_ceil(2));
        let [columns, rows] = size;
        let texel = |column: u32, row: u32| {
            let pair = |it: u32, k: usize| [2 * it, (2 * it + 1).min(fine.size[k] - 1)];
            let ([left, right], [top, bottom]) = (pair(column, 0), pair(row, 1));
            let at = [[left, top], [right, top], [left, bottom], [right, bottom]];
            self.mean(at.map(|it| fine.at(it)))
        };
        let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        TexturePicture {
            size,
            texels: all.map(|(column, row)| texel(column, row)).collect(),
        }
    }

    fn mean(&self, texels: [[u8; 4]; 4]) -> [u8; 4] {
        let alpha: u32 = texels.iter().map(|it| u32::from(it[3])).sum();
        let weight = |texel: &[u8; 4]| match alpha {
            0 => 0.25,
            _ => f32::from(texel[3]) / alpha as f32,
        };
        let channel = |k: usize| {
            let light = texels.iter().map(|it| self.light(it[k]) * weight(it));
            self.code(light.sum())
        };
        [channel(0), channel(1), channel(2), ((alpha + 2) / 4) as u8]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_come_back_and_halves_keep_the_light() {
        let halving = Halving::default();
        for code in 0..=255 {
            assert_eq!(halving.code(halving.light(code)), code);
        }
        let mut state = 1_u32;
        let mut any = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let mut level = TexturePicture {
            size: [64, 64],
            texels: (0..64 * 64).map(|_| [any(), any(), any(), 255]).collect(),
        };
        let light = |level: &TexturePicture| {
            let all = level
                .texels
                .iter()
                .map(|it| f64::from(halving.light(it[1])));
            all.sum::<f64>() / level.texels.len() as f64
        };
        let source = light(&level);
        while level.size != [1, 1] {
            level = halving.halved(&level);
            assert!(
                (light(&level) / source - 1.0).abs() < 0.01,
                "{:?}",
                level.size
            );
        }
    }

    #[test]
    fn what_is_not_seen_lends_no_colour() {
        let halving = Halving::default();
        let fine = TexturePicture {
            size: [2, 1],
            texels: vec![[255, 0, 0, 255], [0, 255, 0, 0]],
        };
        assert_eq!(halving.halved(&fine).texels, [[255, 0, 0, 128]]);
    }
}
