//! How is a texture cut into pages?
//!
//! Level 0 has the texels of the source; each further level half as many along a side, rounded up,
//! so that a texel of level l spans 2^l texels of the source, from its left and top on. A level is
//! cut into pages from its left and top. A page is sent with a border of the texels round it, so
//! that it can be drawn between its texels without its neighbours. The coarsest level that is sent
//! is the first that one page holds; the drawing side makes those down to one texel from it.

use super::picture::TexturePicture;
use super::wrap::Wrap;

/// Texels along a side of a page, without its border.
pub const PAGE_SIDE: u32 = 256;
/// Texels of the border, on each side.
pub const BORDER: u32 = 1;
/// Most texels along a side of a page with its border.
pub const SLOT_SIDE: u32 = PAGE_SIDE + 2 * BORDER;
/// Bytes that a page takes on a GPU, whatever part of it is filled.
pub const SLOT_BYTES: u64 = 4 * SLOT_SIDE as u64 * SLOT_SIDE as u64;
/// Most texels along a side of a texture.
pub const MOST_SIDE: u32 = 1 << 14;

/// A page of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PagePlace {
    /// The level, 0 the finest.
    pub level: u8,
    /// Column and row of the page in its level.
    pub place: [u16; 2],
}

impl PagePlace {
    /// Which quarter of the page that it lies in it is: 0 and 1 above, 2 and 3 below.
    #[must_use]
    pub fn quarter(self) -> u8 {
        let [column, row] = self.place.map(|it| (it % 2) as u8);
        column + 2 * row
    }

    /// The page of the next coarser level that it lies in.
    #[must_use]
    pub fn coarser(self) -> Self {
        Self {
            level: self.level + 1,
            place: self.place.map(|it| it / 2),
        }
    }
}

/// How a texture is cut into pages.
///
/// ```
/// use foveal_core::content::images::shape::TextureShape;
/// let shape = TextureShape { size: [1000, 600] };
/// assert_eq!((shape.root(), shape.levels()), (2, 11));
/// assert_eq!((shape.level_size(1), shape.pages(1)), ([500, 300], [2, 2]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureShape {
    /// Columns and rows of the source, each from 1 to [`MOST_SIDE`].
    pub size: [u32; 2],
}

impl TextureShape {
    /// Columns and rows of a level.
    #[must_use]
    pub fn level_size(&self, level: u8) -> [u32; 2] {
        self.size.map(|side| side.div_ceil(1 << level))
    }

    /// Columns and rows of pages of a level.
    #[must_use]
    pub fn pages(&self, level: u8) -> [u32; 2] {
        self.level_size(level).map(|side| side.div_ceil(PAGE_SIDE))
    }

    /// The finest level that one page holds: the coarsest that is sent.
    #[must_use]
    pub fn root(&self) -> u8 {
        let largest = self.size[0].max(self.size[1]).max(1);
        largest.div_ceil(PAGE_SIDE).next_power_of_two().ilog2() as u8
    }

    /// Number of levels down to one texel.
    #[must_use]
    pub fn levels(&self) -> u8 {
        let largest = self.size[0].max(self.size[1]).max(1);
        largest.next_power_of_two().ilog2() as u8 + 1
    }

    /// Columns and rows of a page, without its border; `None` where there is no such page.
    #[must_use]
    pub fn page_size(&self, page: PagePlace) -> Option<[u32; 2]> {
        if page.level > self.root() {
            return None;
        }
        let size = self.level_size(page.level);
        let first = page.place.map(|it| u32::from(it) * PAGE_SIDE);
        let left = [0, 1].map(|k| size[k].saturating_sub(first[k]).min(PAGE_SIDE));
        (left[0] > 0 && left[1] > 0).then_some(left)
    }

    /// A page of a level whose texels are all there, with its border.
    ///
    /// # Panics
    /// There must be such a page, and the picture must have the size of its level.
    #[must_use]
    pub fn cut(&self, level: &TexturePicture, page: PagePlace, wrap: [Wrap; 2]) -> TexturePicture {
        assert_eq!(level.size, self.level_size(page.level), "size of the level");
        let columns = level.size[0] as usize;
        let row = |row: u32| &level.texels[row as usize * columns..][..columns];
        self.cut_of_rows(&row, page, wrap)
    }

    /// The same of a level whose rows `row` gives: those of the page and those next to it.
    ///
    /// # Panics
    /// There must be such a page, and the rows must be as long as those of its level.
    #[must_use]
    pub fn cut_of_rows<'a>(
        &self,
        row: &dyn Fn(u32) -> &'a [[u8; 4]],
        page: PagePlace,
        wrap: [Wrap; 2],
    ) -> TexturePicture {
        let inner = self.page_size(page).unwrap_or_default();
        let level_size = self.level_size(page.level);
        let along = |k: usize| {
            let first = i64::from(page.place[k]) * i64::from(PAGE_SIDE);
            let border = i64::from(BORDER);
            let all = first - border..first + i64::from(inner[k]) + border;
            all.map(move |it| wrap[k].texel(it, level_size[k]))
        };
        let rows = along(1).map(row);
        let texels = rows.flat_map(|row| along(0).map(move |column| row[column as usize]));
        TexturePicture {
            size: inner.map(|side| side + 2 * BORDER),
            texels: texels.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_texel_lies_in_one_page_and_its_coarser_one_in_the_coarser_page() {
        for size in [[1, 1], [256, 256], [257, 3], [1000, 600], [16384, 512]] {
            let shape = TextureShape { size };
            for level in 0..=shape.root() {
                let [columns, rows] = shape.pages(level);
                let mut texels = [0; 2];
                for place in (0..columns.max(rows)).map(|it| it as u16) {
                    let page = |place| shape.page_size(PagePlace { level, place });
                    texels[0] += page([place, 0]).map_or(0, |it| it[0]);
                    texels[1] += page([0, place]).map_or(0, |it| it[1]);
                }
                assert_eq!(texels, shape.level_size(level), "{size:?} {level}");
            }
            assert_eq!(shape.pages(shape.root()), [1, 1]);
            assert_eq!(shape.level_size(shape.levels() - 1), [1, 1]);
            assert!(shape.root() == 0 || shape.pages(shape.root() - 1) != [1, 1]);
        }
    }

    #[test]
    fn a_border_has_what_lies_beside_the_page_or_what_the_wrap_says() {
        let shape = TextureShape { size: [300, 2] };
        let level = TexturePicture {
            size: [300, 2],
            texels: (0..600_u32)
                .map(|it| [(it % 300 / 2) as u8, (it / 300) as u8, 0, 255])
                .collect(),
        };
        let page = |place| PagePlace { level: 0, place };
        let first = shape.cut(&level, page([0, 0]), [Wrap::Repeat, Wrap::Clamp]);
        assert_eq!(first.size, [258, 4]);
        assert_eq!(first.at([0, 1]), level.at([299, 0]));
        assert_eq!(first.at([257, 0]), level.at([256, 0]));
        let last = shape.cut(&level, page([1, 0]), [Wrap::Mirror, Wrap::Repeat]);
        assert_eq!(last.size, [46, 4]);
        assert_eq!(last.at([45, 0]), level.at([299, 1]));
    }
}
