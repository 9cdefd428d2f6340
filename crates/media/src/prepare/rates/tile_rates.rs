//! How fine is one tile coded, by what is seen in it?
//!
//! What coding leaves is seen most where it is dark and flat, and least where it is bright and busy
//! (docs/decisions/0027-quantisers-follow-content.md has the experiment).

use crate::tiles::encode_settings::Rate;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::view::picture::{Colour, Picture};

/// Side of the blocks whose texture is looked at, in pixels.
const BLOCK: usize = 8;
/// Places of the table: mean code of luma, 0 black and 255 white.
const LIGHTS: [f64; 5] = [16.0, 32.0, 64.0, 128.0, 208.0];
/// Places of the table: texture, see [`TileLook`].
const TEXTURES: [f64; 5] = [0.5, 1.5, 2.5, 3.5, 4.5];
/// By light, then by texture: a tile's quantiser over that of its level.
const FACTORS: [[f64; 5]; 5] = [
    [0.46, 0.46, 0.48, 0.54, 0.58],
    [0.46, 0.46, 0.51, 0.58, 0.66],
    [0.54, 0.56, 0.70, 0.85, 0.90],
    [0.88, 0.82, 0.79, 0.88, 1.00],
    [1.16, 1.00, 1.04, 1.13, 1.13],
];
/// Coarsest quantiser that a tile is given.
const COARSEST: f64 = 56.0;
/// Finest.
const FINEST: f64 = 2.0;

/// What of a tile decides how well the noise of coding hides in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileLook {
    /// Mean code of luma, 0 black and 255 white.
    pub light: f64,
    /// Mean over blocks of 8 x 8 pixels of log2(1 + standard deviation of codes): one busy block
    /// hides nothing in the others.
    pub texture: f64,
}

impl TileLook {
    /// The look of a picture.
    #[must_use]
    pub fn of(picture: &Picture, colour: Colour) -> Self {
        let scale = if colour.full_range {
            1.0
        } else {
            255.0 / 219.0
        };
        let black = if colour.full_range { 0.0 } else { 16.0 };
        let width = picture.width as usize;
        let (mut codes, mut texture, mut blocks) = (0_u64, 0.0, 0_u32);
        for rows in picture.planes[0].chunks(width * BLOCK) {
            for left in (0..width).step_by(BLOCK) {
                let (mut count, mut sum, mut squares) = (0_u64, 0_u64, 0_u64);
                for row in rows.chunks(width) {
                    for code in &row[left..(left + BLOCK).min(width)] {
                        let code = u64::from(*code);
                        count += 1;
                        sum += code;
                        squares += code * code;
                    }
                }
                let variance = (count * squares - sum * sum) as f64 / (count * count) as f64;
                texture += (1.0 + variance.sqrt() * scale).log2();
                codes += sum;
                blocks += 1;
            }
        }
        let mean = codes as f64 / picture.planes[0].len().max(1) as f64;
        Self {
            light: ((mean - black) * scale).clamp(0.0, 255.0),
            texture: texture / f64::from(blocks.max(1)),
        }
    }

    /// A tile's quantiser over that of its level.
    fn factor(self) -> f64 {
        let (row, down) = place(self.light, LIGHTS);
        let (column, along) = place(self.texture, TEXTURES);
        let at = |row: usize| {
            let [near, far] = [FACTORS[row][column], FACTORS[row][column + 1]];
            near + (far - near) * along
        };
        at(row) + (at(row + 1) - at(row)) * down
    }
}

/// The place of a value between two of rising ones: the first of them, and the share of the way.
fn place(value: f64, places: [f64; 5]) -> (usize, f64) {
    let after = places.iter().position(|place| *place > value);
    let first = after.unwrap_or(places.len() - 1).clamp(1, places.len() - 1) - 1;
    let share = (value - places[first]) / (places[first + 1] - places[first]);
    (first, share.clamp(0.0, 1.0))
}

/// The rate of a tile over a group of a level with a rate: the finer one that its first and its
/// last picture ask for.
pub(in crate::prepare) fn rate_of_tile(rate: Rate, group: &[Picture], colour: Colour) -> Rate {
    let (Rate::Quantiser(level), [first, ..], [.., last]) = (rate, group, group) else {
        return rate;
    };
    let factor = |picture| TileLook::of(picture, colour).factor();
    let factor = factor(first).min(factor(last));
    let quantiser = (f64::from(level) * factor).round().clamp(FINEST, COARSEST);
    Rate::Quantiser(quantiser as u8)
}

/// Quantisers of the levels, finest first, where the finest has this one; a coarser level is shown
/// one to one, with all of its noise, where a finer one is shown smaller.
pub(in crate::prepare) fn ladder(finest: u8, levels: u8) -> Vec<u8> {
    let level = |level: u8| {
        let share = LEVELS[usize::from(level).min(LEVELS.len() - 1)];
        (f64::from(finest) * share).round().max(FINEST) as u8
    };
    (0..levels).map(level).collect()
}

/// A level's quantiser over that of the finest, finest first.
const LEVELS: [f64; 5] = [1.0, 0.98, 0.96, 0.94, 0.92];

/// Whether quantisers of this codec can be looked for.
pub(in crate::prepare) fn follows_content(codec: Codec) -> bool {
    codec == Codec::Vp9
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::picture::Matrix;

    const COLOUR: Colour = Colour {
        matrix: Matrix::Bt709,
        full_range: true,
        chroma_left: false,
    };

    fn rough(light: u8, depth: u32) -> Picture {
        let mut picture = Picture::filled(50, 34, [light, 128, 128]);
        for (k, code) in (0_u32..).zip(&mut picture.planes[0]) {
            let noise = k.wrapping_mul(2_654_435_761) >> 16;
            *code = light + (noise % (depth + 1)) as u8;
        }
        picture
    }

    #[test]
    fn dark_and_flat_tiles_are_coded_finer() {
        let of = |light, depth| {
            let group = [rough(light, depth), rough(light, depth)];
            match rate_of_tile(Rate::Quantiser(20), &group, COLOUR) {
                Rate::Quantiser(q) => q,
                rate => panic!("{rate:?}"),
            }
        };
        assert!(of(10, 0) < of(160, 0) || of(10, 0) < of(160, 60));
        assert!(of(160, 0) < of(160, 60));
        let look = TileLook::of(&rough(100, 0), COLOUR);
        assert_eq!([look.light, look.texture], [100.0, 0.0]);
    }

    #[test]
    fn what_gets_dark_within_a_group_is_coded_as_dark() {
        let group = [rough(200, 40), rough(10, 0)];
        let dark = [rough(10, 0), rough(10, 0)];
        let of = |group: &[Picture]| rate_of_tile(Rate::Quantiser(20), group, COLOUR);
        assert_eq!(of(&group), of(&dark));
        assert_eq!(rate_of_tile(Rate::Bits(9), &dark, COLOUR), Rate::Bits(9));
        assert_eq!(of(&[]), Rate::Quantiser(20));
    }

    #[test]
    fn a_ladder_falls_from_the_finest_level_on() {
        for finest in 2..=56 {
            let ladder = ladder(finest, 8);
            assert!(
                ladder[0] == finest && ladder.is_sorted_by(|a, b| a >= b),
                "{ladder:?}"
            );
            assert!(ladder.iter().all(|q| *q >= 2));
        }
    }

    #[test]
    fn the_table_is_met_at_its_places_and_goes_on_beyond_them() {
        for (row, light) in LIGHTS.into_iter().enumerate() {
            for (column, texture) in TEXTURES.into_iter().enumerate() {
                let found = TileLook { light, texture }.factor();
                assert!((found - FACTORS[row][column]).abs() < 1e-12);
            }
        }
        let beyond = TileLook {
            light: 255.0,
            texture: 8.0,
        };
        assert_eq!(beyond.factor(), FACTORS[4][4]);
    }
}
