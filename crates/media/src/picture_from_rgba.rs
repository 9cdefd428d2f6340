//! How does a drawn picture become planes that a video file takes?

use foveal_core::asset::picture::{Colour, Picture};

/// 4:2:0 planes of an RGBA picture (four bytes a pixel, rows from the top); chroma is the mean of
/// its two by two pixels, so centre-sited. ITU-R BT.601, BT.709 and BT.2020 by `colour`.
///
/// # Panics
/// `rgba` does not hold four bytes for each pixel of `size`.
#[must_use]
pub fn picture_from_rgba(rgba: &[u8], [width, height]: [u32; 2], colour: Colour) -> Picture {
    let (w, h) = (width as usize, height as usize);
    assert_eq!(rgba.len(), w * h * 4, "an RGBA picture of {width}x{height}");
    let [kr, kb] = colour.matrix.luma_weights();
    let (black, luma, chroma) = if colour.full_range {
        (0.0, 255.0, 255.0)
    } else {
        (16.0, 219.0, 224.0)
    };
    let pixel = |x: usize, y: usize| {
        let at = (y.min(h - 1) * w + x.min(w - 1)) * 4;
        [0, 1, 2].map(|c| f32::from(rgba[at + c]) / 255.0)
    };
    let luma_of = |[r, g, b]: [f32; 3]| kr * r + (1.0 - kr - kb) * g + kb * b;
    let mut picture = Picture::filled(width, height, [0; 3]);
    for y in 0..h {
        for x in 0..w {
            picture.planes[0][y * w + x] = (black + luma * luma_of(pixel(x, y))).round() as u8;
        }
    }
    let [half_w, half_h] = picture.plane_size(1).map(|side| side as usize);
    for y in 0..half_h {
        for x in 0..half_w {
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
            let sum = corners
                .map(|(i, j)| pixel(2 * x + i, 2 * y + j))
                .into_iter();
            let mean = sum.fold([0.0; 3], |a, b| [0, 1, 2].map(|c| a[c] + b[c] / 4.0));
            let grey = luma_of(mean);
            let code = |side: f32, weight: f32| {
                (128.0 + chroma * (side - grey) / (2.0 * (1.0 - weight))).round() as u8
            };
            picture.planes[1][y * half_w + x] = code(mean[2], kb);
            picture.planes[2][y * half_w + x] = code(mean[0], kr);
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::asset::picture::Matrix;

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
}
