//! What does a part of a texture look like?

/// Texels of a texture, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TexturePicture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Red, green and blue as sRGB codes, and alpha; as many as `size` says.
    pub texels: Vec<[u8; 4]>,
}

impl TexturePicture {
    /// A picture of one texel.
    #[must_use]
    pub fn of_one(texel: [u8; 4]) -> Self {
        Self {
            size: [1, 1],
            texels: vec![texel],
        }
    }

    /// The texel at a column and a row.
    ///
    /// # Panics
    /// There must be one.
    #[must_use]
    pub fn at(&self, [column, row]: [u32; 2]) -> [u8; 4] {
        self.texels[row as usize * self.size[0] as usize + column as usize]
    }

    /// All bytes, as files and GPUs have them.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.texels.as_flattened()
    }
}
