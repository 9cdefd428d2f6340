//! Into which pieces is the work on a cube cut?

/// Columns of half an upright face, or rows of a quarter of the top face, in one part of the work.
pub(super) const STRIP: usize = 16;

/// Index of the top face.
pub(super) const TOP: usize = 4;

/// Index of the bottom face.
pub(super) const BOTTOM: usize = 5;

/// A finished rectangle of a plane of one face.
pub(super) struct Block {
    pub(super) face: usize,
    pub(super) at: [usize; 2],
    pub(super) width: usize,
    pub(super) samples: Vec<u8>,
}

impl Block {
    /// Puts it into its place on the plane of a face.
    pub(super) fn write_to(&self, plane: &mut [u8], face_size: usize) {
        let [x, y] = self.at;
        for (row, samples) in self.samples.chunks_exact(self.width).enumerate() {
            plane[(y + row) * face_size + x..][..self.width].copy_from_slice(samples);
        }
    }
}
