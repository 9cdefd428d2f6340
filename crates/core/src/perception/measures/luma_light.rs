//! What is the mean of some code values of luma?
//!
//! Averaged as light: a mean of code values is darker than what it stands for wherever texture is
//! strong, and the eye sees the darkening of a whole region long after it has lost the texture
//! (docs/decisions/0012-levels-keep-their-light.md). Whatever makes a coarser picture of a finer
//! one, when content is prepared or when it is drawn, uses this table.

use crate::perception::luminance::linear_from_srgb;
use crate::view::picture::Colour;
use std::sync::LazyLock;

/// Light of white: 14 bits, so that six weighted samples fit into 32 and neighbouring dark codes
/// stay apart.
const WHITE: i32 = (1 << 14) - 1;

/// Light of code values of luma, and code values of light.
///
/// ```
/// use foveal_core::view::picture::{Colour, Matrix};
/// use foveal_core::perception::measures::luma_light::LumaLight;
/// let colour = Colour { matrix: Matrix::Bt709, full_range: true, chroma_left: false };
/// let table = LumaLight::of(colour);
/// let mean = (table.light(40) + table.light(200)) / 2;
/// assert_eq!(table.code(mean), 149);
/// ```
#[derive(Debug)]
pub struct LumaLight {
    light: [u16; 256],
    code: Vec<u8>,
}

static FULL_RANGE: LazyLock<LumaLight> = LazyLock::new(|| LumaLight::new([0.0, 255.0]));
static LIMITED_RANGE: LazyLock<LumaLight> = LazyLock::new(|| LumaLight::new([16.0, 235.0]));

impl LumaLight {
    /// The table of a picture's luma. Made once, in about a millisecond.
    #[must_use]
    pub fn of(colour: Colour) -> &'static Self {
        if colour.full_range {
            &FULL_RANGE
        } else {
            &LIMITED_RANGE
        }
    }

    /// For codes of black and white; codes beyond them, which a display does not show, count as
    /// they.
    fn new([black, white]: [f64; 2]) -> Self {
        let light = |code: usize| {
            let share = ((code as f64 - black) / (white - black)).clamp(0.0, 1.0);
            let grey = share * 255.0;
            // The curve between two sRGB codes is nearly straight.
            let [below, above] =
                [libm::floor(grey), libm::ceil(grey)].map(|k| linear_from_srgb(k as u8));
            (below + (above - below) * (grey - libm::floor(grey))) * f64::from(WHITE)
        };
        let exact: [f64; 256] = core::array::from_fn(light);
        // Codes below black share its light: black is what they become.
        let codes = black as usize..=white as usize;
        let nearest = |light: i32| {
            let light = f64::from(light);
            let mut codes = codes.clone();
            let above = codes.find(|code| exact[*code] >= light);
            let above = above.unwrap_or(white as usize);
            let below = above.saturating_sub(1).max(black as usize);
            let is_above = exact[above] - light <= light - exact[below];
            (if is_above { above } else { below }) as u8
        };
        Self {
            light: exact.map(|light| libm::round(light) as u16),
            code: (0..=WHITE).map(nearest).collect(),
        }
    }

    /// Light of a code value, 0 to 2^14 - 1.
    #[inline]
    #[must_use]
    pub fn light(&self, code: u8) -> i32 {
        i32::from(self.light[usize::from(code)])
    }

    /// The code value whose light is nearest; light beyond black or white counts as these.
    #[inline]
    #[must_use]
    pub fn code(&self, light: i32) -> u8 {
        self.code[light.clamp(0, WHITE) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::picture::Matrix;

    #[test]
    fn every_code_that_is_shown_stays_itself() {
        for (full_range, codes) in [(true, 0..=255), (false, 16..=235)] {
            let table = LumaLight::of(Colour {
                matrix: Matrix::Bt709,
                full_range,
                chroma_left: false,
            });
            for code in codes {
                assert_eq!(table.code(table.light(code)), code, "{full_range}");
            }
        }
    }
}
