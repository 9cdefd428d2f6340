//! How much of its light does each pixel of a panel keep?

/// Shares of linear light, measured or drawn for a panel that others overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlphaMap {
    columns: usize,
    shares: Vec<u16>,
}

impl AlphaMap {
    /// Shares row by row as the eye sees the panel, 65,535 for all light.
    ///
    /// # Panics
    /// When there are not as many as pixels.
    #[must_use]
    pub fn new(size: [u32; 2], shares: Vec<u16>) -> Self {
        let [columns, rows] = size.map(|side| side as usize);
        assert_eq!(shares.len(), columns * rows, "a share a pixel");
        Self { columns, shares }
    }

    /// The share of a pixel of the panel, from 0 to 65,535.
    ///
    /// # Panics
    /// When there is no such pixel.
    #[must_use]
    pub fn at(&self, [column, row]: [u32; 2]) -> u16 {
        self.shares[row as usize * self.columns + column as usize]
    }

    /// All of them, row by row.
    #[must_use]
    pub fn shares(&self) -> &[u16] {
        &self.shares
    }

    /// The same for a panel of other pixels: of each the share at its middle.
    #[must_use]
    pub fn resized(&self, own: [u32; 2], size: [u32; 2]) -> Self {
        let nearest = |k: usize, at: u32| {
            let place = (f64::from(at) + 0.5) * f64::from(own[k]) / f64::from(size[k]);
            (place as u32).min(own[k] - 1)
        };
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        let shares = pixels.map(|[x, y]| self.at([nearest(0, x), nearest(1, y)]));
        Self::new(size, shares.collect())
    }

    /// The same in a mirror.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let rows = self.shares.chunks(self.columns.max(1));
        Self {
            columns: self.columns,
            shares: rows.flat_map(|row| row.iter().rev().copied()).collect(),
        }
    }
}
