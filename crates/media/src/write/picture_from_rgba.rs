//! How does a drawn picture become planes that a video file takes?

use foveal_core::view::picture::{Colour, Picture, plane_size};

/// 4:2:0 planes of an RGBA picture (four bytes a pixel, rows from the top); chroma is the mean of
/// its two by two pixels, so centre-sited. ITU-R BT.601, BT.709 and BT.2020 by `colour`.
///
/// # Panics
/// `rgba` does not hold four bytes for each pixel of `size`.
#[must_use]
pub fn picture_from_rgba(rgba: &[u8], [width, height]: [u32; 2], colour: Colour) -> Picture {
    let row = width as usize * 4;
    assert_eq!(
        rgba.len(),
        row * height as usize,
        "an RGBA picture of {width}x{height}"
    );
    let mut planes = PlanesOfRows::new([width, height], colour);
    for pair in rgba.chunks(2 * row) {
        let (top, bottom) = pair.split_at(row);
        planes.push(
            top,
            if bottom.is_empty() {
                None
            } else {
                Some(bottom)
            },
            4,
        );
    }
    planes.picture
}

/// Planes that grow by two rows of a picture.
pub(crate) struct PlanesOfRows {
    pub(crate) picture: Picture,
    /// Of red, green and blue in Y, Cb and Cr: [`ONE`] for a code value a code value.
    weights: [[i32; 3]; 3],
    /// Y, Cb and Cr of black, and a half: what is cut off after it is rounded.
    offsets: [i32; 3],
    /// Sums of two by two pixels of the last two rows.
    sums: Vec<[i32; 3]>,
}

/// Bits behind the point of a weight: three of them are off by less than 0.006 code values.
const BITS: u32 = 16;
const ONE: f32 = (1 << BITS) as f32;

impl PlanesOfRows {
    /// Planes without rows yet of a picture of `size`.
    pub(crate) fn new([width, height]: [u32; 2], colour: Colour) -> Self {
        let [kr, kb] = colour.matrix.luma_weights();
        let grey = [kr, 1.0 - kr - kb, kb];
        let (black, luma, chroma) = if colour.full_range {
            (0.0, 255.0, 255.0)
        } else {
            (16.0, 219.0, 224.0)
        };
        // A colour's difference from grey, of which the weight is what the colour adds to grey.
        let difference = |of: usize| {
            let step = chroma / (2.0 * (1.0 - grey[of]) * 255.0);
            [0, 1, 2].map(|c| (f32::from(u8::from(c == of)) - grey[c]) * step)
        };
        let weights = [
            grey.map(|weight| weight * luma / 255.0),
            difference(2),
            difference(0),
        ];
        let fixed = |value: f32| (value * ONE).round() as i32;
        let planes = [0, 1, 2].map(|p| {
            let [w, h] = plane_size(width, height, p).map(|side| side as usize);
            Vec::with_capacity(w * h)
        });
        Self {
            picture: Picture {
                width,
                height,
                planes,
            },
            weights: weights.map(|row| row.map(fixed)),
            offsets: [black + 0.5, 128.5, 128.5].map(fixed),
            sums: Vec::new(),
        }
    }

    /// Appends a row and the one below it, the last of an odd height without; `channels` samples a
    /// pixel: grey, grey and alpha, RGB or RGBA.
    pub(crate) fn push(&mut self, top: &[u8], bottom: Option<&[u8]>, channels: usize) {
        match channels {
            1 => self.push_of::<1>(top, bottom),
            2 => self.push_of::<2>(top, bottom),
            3 => self.push_of::<3>(top, bottom),
            4 => self.push_of::<4>(top, bottom),
            other => unreachable!("pixels of {other} samples"),
        }
    }

    fn push_of<const N: usize>(&mut self, top: &[u8], bottom: Option<&[u8]>) {
        let [luma, blue, red] = &mut self.picture.planes;
        let code = |plane: usize, sum: [i32; 3], bits: u32| {
            let scale = bits - BITS;
            let [r, g, b] = self.weights[plane];
            let fixed = (self.offsets[plane] << scale) + r * sum[0] + g * sum[1] + b * sum[2];
            (fixed >> bits).clamp(0, 255) as u8
        };
        for row in [Some(top), bottom].into_iter().flatten() {
            luma.extend(
                row.chunks_exact(N)
                    .map(|pixel| code(0, rgb::<N>(pixel), BITS)),
            );
        }
        let bottom = bottom.unwrap_or(top);
        let pairs = top.chunks_exact(2 * N).zip(bottom.chunks_exact(2 * N));
        self.sums.clear();
        self.sums.extend(pairs.map(|(above, below)| {
            let left = added(rgb::<N>(above), rgb::<N>(below));
            added(left, added(rgb::<N>(&above[N..]), rgb::<N>(&below[N..])))
        }));
        // The last pixel of an odd width stands for two.
        if let Some(above) = top.chunks_exact(2 * N).remainder().get(..N) {
            let below = bottom.chunks_exact(2 * N).remainder();
            let last = added(rgb::<N>(above), rgb::<N>(below));
            self.sums.push(added(last, last));
        }
        blue.extend(self.sums.iter().map(|sum| code(1, *sum, BITS + 2)));
        red.extend(self.sums.iter().map(|sum| code(2, *sum, BITS + 2)));
    }
}

fn rgb<const N: usize>(pixel: &[u8]) -> [i32; 3] {
    if N < 3 {
        [i32::from(pixel[0]); 3]
    } else {
        [0, 1, 2].map(|c| i32::from(pixel[c]))
    }
}

fn added(a: [i32; 3], b: [i32; 3]) -> [i32; 3] {
    [0, 1, 2].map(|c| a[c] + b[c])
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::picture::Matrix;

    #[test]
    fn primary_colours_have_their_code_values() {
        let colour = Colour {
            matrix: Matrix::Bt709,
            full_range: false,
            chroma_left: false,
        };
        for (rgb, yuv) in [
            ([255, 255, 255], [235, 128, 128]),
            ([0, 0, 0], [16, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 0, 255], [32, 240, 118]),
        ] {
            let [r, g, b] = rgb;
            let picture = picture_from_rgba(&[r, g, b, 255].repeat(9), [3, 3], colour);
            assert_eq!([0, 1, 2].map(|p| *picture.planes[p].last().unwrap()), yuv);
        }
    }

    #[test]
    fn every_colour_is_the_formula_s_within_a_code_value_and_borders_stand_for_themselves() {
        let size = [7, 5];
        let rgba: Vec<u8> = (0..7 * 5 * 4).map(|at| (at * 89 % 256) as u8).collect();
        for (matrix, full_range) in [(Matrix::Bt601, true), (Matrix::Bt2020, false)] {
            let colour = Colour {
                matrix,
                full_range,
                chroma_left: false,
            };
            let picture = picture_from_rgba(&rgba, size, colour);
            assert!(picture.is_consistent());
            let [kr, kb] = matrix.luma_weights().map(f64::from);
            let [black, luma, chroma] = if full_range {
                [0.0, 255.0, 255.0]
            } else {
                [16.0, 219.0, 224.0]
            };
            let pixel = |x: usize, y: usize| {
                let at = (y.min(4) * 7 + x.min(6)) * 4;
                [0, 1, 2].map(|c| f64::from(rgba[at + c]) / 255.0)
            };
            let grey = |[r, g, b]: [f64; 3]| kr * r + (1.0 - kr - kb) * g + kb * b;
            let near = |found: u8, expected: f64| {
                assert!(
                    (f64::from(found) - expected).abs() < 0.51,
                    "{found}, not {expected}"
                );
            };
            for (x, y) in (0..35).map(|at| (at % 7, at / 7)) {
                near(
                    picture.planes[0][y * 7 + x],
                    black + luma * grey(pixel(x, y)),
                );
            }
            for (x, y) in (0..12).map(|at| (at % 4, at / 4)) {
                let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
                let corners = corners.map(|(i, j)| pixel(2 * x + i, 2 * y + j));
                let mean = [0, 1, 2].map(|c| corners.iter().map(|p| p[c]).sum::<f64>() / 4.0);
                let code = |side: f64, weight: f64| {
                    let code = 128.0 + chroma * (side - grey(mean)) / (2.0 * (1.0 - weight));
                    code.min(255.0)
                };
                near(picture.planes[1][y * 4 + x], code(mean[2], kb));
                near(picture.planes[2][y * 4 + x], code(mean[0], kr));
            }
        }
    }
}
