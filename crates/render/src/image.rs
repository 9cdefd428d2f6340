//! What is a finished picture?

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
