//! What is a finished picture?

use foveal_core::view::picture::{Colour, Picture};

/// Red, green, blue and alpha, 8 bits each, rows from the top without padding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbaImage {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Four bytes a pixel.
    pub pixels: Vec<u8>,
}

impl RgbaImage {
    /// An opaque black picture.
    #[must_use]
    pub fn black(size: [u32; 2]) -> Self {
        let count = size[0] as usize * size[1] as usize;
        Self {
            size,
            pixels: [0, 0, 0, 255].repeat(count),
        }
    }

    /// A tile by itself, in its own pixels; each chroma sample colours the four pixels over it.
    #[must_use]
    pub fn from_planes(picture: &Picture, colour: Colour) -> Self {
        let rows = colour.rgb_from_yuv();
        let half = picture.plane_size(1)[0];
        let mut image = Self::black([picture.width, picture.height]);
        for y in 0..picture.height {
            for x in 0..picture.width {
                let code = picture.planes[0][(y * picture.width + x) as usize];
                let at = (y / 2 * half + x / 2) as usize;
                let codes = [code, picture.planes[1][at], picture.planes[2][at]];
                let [luma, u, v] = codes.map(|code| f32::from(code) / 255.0);
                let rgb = rows.map(|r| r[0] * luma + r[1] * u + r[2] * v + r[3]);
                let [r, g, b] = rgb.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
                image.set_pixel([x, y], [r, g, b, 255]);
            }
        }
        image
    }

    /// This picture with another of the same height to its right.
    ///
    /// # Panics
    /// When their heights differ.
    #[must_use]
    pub fn beside(&self, right: &Self) -> Self {
        assert_eq!(self.size[1], right.size[1], "pictures of two heights");
        let rows = |image: &Self| image.size[0].max(1) as usize * 4;
        let pairs = self
            .pixels
            .chunks(rows(self))
            .zip(right.pixels.chunks(rows(right)));
        Self {
            size: [self.size[0] + right.size[0], self.size[1]],
            pixels: pairs
                .flat_map(|(left, right)| [left, right].concat())
                .collect(),
        }
    }

    /// The four bytes of the pixel in column `x` of row `y`.
    #[must_use]
    pub fn pixel(&self, [x, y]: [u32; 2]) -> [u8; 4] {
        let at = (y as usize * self.size[0] as usize + x as usize) * 4;
        [0, 1, 2, 3].map(|k| self.pixels[at + k])
    }

    /// Writes a pixel; the inverse of [`Self::pixel`].
    pub fn set_pixel(&mut self, [x, y]: [u32; 2], rgba: [u8; 4]) {
        let at = (y as usize * self.size[0] as usize + x as usize) * 4;
        self.pixels[at..at + 4].copy_from_slice(&rgba);
    }
}
