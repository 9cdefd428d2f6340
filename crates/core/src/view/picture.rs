//! What is a picture between the decoder and the GPU?
//!
//! Always 8-bit 4:2:0 planes: what every video codec delivers, half the bytes of RGB, and converted
//! once, in the shader that shows it.

use serde::{Deserialize, Serialize};

/// One picture as three tightly packed 8-bit planes: Y at full size, then U and V at half.
///
/// Row `y` of plane `p` is `planes[p][y * width_p..][..width_p]`; there is no row padding.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Picture {
    /// Width of the luma plane in pixels.
    pub width: u32,
    /// Height of the luma plane in pixels.
    pub height: u32,
    /// Y, U and V samples.
    pub planes: [Vec<u8>; 3],
}

impl Picture {
    /// A picture of one colour, given as Y, U, V.
    #[must_use]
    pub fn filled(width: u32, height: u32, yuv: [u8; 3]) -> Self {
        let planes = [0, 1, 2].map(|p| {
            let [w, h] = plane_size(width, height, p);
            vec![yuv[p]; w as usize * h as usize]
        });
        Self {
            width,
            height,
            planes,
        }
    }

    /// Size in samples of plane `p` (0 is Y, 1 is U, 2 is V).
    #[must_use]
    pub fn plane_size(&self, p: usize) -> [u32; 2] {
        plane_size(self.width, self.height, p)
    }

    /// Whether every plane holds exactly the samples that the size asks for.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        (0..3).all(|p| {
            let [w, h] = self.plane_size(p);
            self.planes[p].len() == w as usize * h as usize
        })
    }

    /// The part of this picture that starts at (`x`, `y`), `width` by `height` luma pixels; what
    /// lies beyond the right or bottom border repeats the last sample.
    ///
    /// `x` and `y` must be even, or chroma would shift by half a sample.
    #[must_use]
    pub fn crop(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> Self {
        assert!(
            x % 2 == 0 && y % 2 == 0,
            "a crop at an odd offset shifts chroma: {x},{y}"
        );
        let planes = [0, 1, 2].map(|p| {
            let half = u32::from(p > 0);
            let [from_w, from_h] = self.plane_size(p);
            let [w, h] = plane_size(width, height, p);
            let mut out = Vec::with_capacity(w as usize * h as usize);
            let left = (x >> half).min(from_w - 1) as usize;
            let inside = (w as usize).min(from_w as usize - left);
            for row in 0..h {
                let from_row = ((y >> half) + row).min(from_h - 1) as usize;
                let line = &self.planes[p][from_row * from_w as usize..][..from_w as usize];
                out.extend_from_slice(&line[left..left + inside]);
                out.resize(out.len() + w as usize - inside, line[left + inside - 1]);
            }
            out
        });
        Self {
            width,
            height,
            planes,
        }
    }
}

/// Size in samples of plane `p` of a 4:2:0 picture: chroma is half, rounded up.
#[must_use]
pub fn plane_size(width: u32, height: u32, p: usize) -> [u32; 2] {
    if p == 0 {
        [width, height]
    } else {
        [width.div_ceil(2), height.div_ceil(2)]
    }
}

/// Which linear combination of R, G, B the Y plane holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Matrix {
    /// ITU-R BT.601, standard definition.
    Bt601,
    /// ITU-R BT.709, high definition.
    Bt709,
    /// ITU-R BT.2020, ultra-high definition, non-constant luminance.
    Bt2020,
}

impl Matrix {
    /// The luma weights of red and blue (Kr, Kb).
    #[must_use]
    pub fn luma_weights(self) -> [f32; 2] {
        match self {
            Matrix::Bt601 => [0.299, 0.114],
            Matrix::Bt709 => [0.2126, 0.0722],
            Matrix::Bt2020 => [0.2627, 0.0593],
        }
    }
}

/// How code values of the planes become red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Colour {
    /// Combination of primaries in Y.
    pub matrix: Matrix,
    /// True when Y uses 0–255, false when it uses 16–235 (and chroma 16–240).
    pub full_range: bool,
    /// True when level 0's chroma samples sit on the left luma sample of their pair (MPEG-2, H.264,
    /// VP9's default), false when they sit between the two (JPEG).
    pub chroma_left: bool,
}

impl Colour {
    /// Rows that turn (Y, U, V, 1) into red, green, blue, all 0 to 1. ITU-T H.273, equations 35 to
    /// 43: limited or full range, then the matrix of the luma weights.
    #[must_use]
    pub fn rgb_from_yuv(self) -> [[f32; 4]; 3] {
        let [kr, kb] = self.matrix.luma_weights().map(f64::from);
        let kg = 1.0 - kr - kb;
        let (luma, black, chroma) = if self.full_range {
            (1.0, 0.0, 1.0)
        } else {
            (255.0 / 219.0, 16.0 / 255.0, 255.0 / 224.0)
        };
        let (red, blue) = (2.0 * (1.0 - kr) * chroma, 2.0 * (1.0 - kb) * chroma);
        let grey = 128.0 / 255.0;
        let row = |u: f64, v: f64| {
            [luma, u, v, -luma * black - grey * (u + v)].map(|coefficient| coefficient as f32)
        };
        [
            row(0.0, red),
            row(-blue * kb / kg, -red * kr / kg),
            row(blue, 0.0),
        ]
    }
}
