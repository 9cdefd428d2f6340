//! How do the rows of a picture become the pages of all its levels, a few rows at a time?
//!
//! Each level keeps the rows of one row of pages and what lies next to them, and hands on every two
//! of its rows as one of the next coarser level. So a picture takes memory for its columns, times
//! some hundred rows, however many rows it has.

use foveal_core::content::images::halving::Halving;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::{PAGE_SIDE, PagePlace, TextureShape};
use foveal_core::content::images::wrap::Wrap;
use rayon::prelude::*;

/// Rows that come at a time: so few that they take little memory, so many that all threads have
/// some.
pub(super) const BAND_ROWS: u32 = 64;

type Texel = [u8; 4];

/// What is made of a page once its texels are there.
pub(super) trait PageMaker: Sync {
    /// A page that is made.
    type Made: Send;
    /// Why one cannot be.
    type Error: Send;

    /// The pages that are wanted of a row of pages of a level.
    fn wanted(&self, level: u8, row: u16) -> Vec<PagePlace>;

    /// Makes a page of its texels, with their border.
    fn make(&self, place: PagePlace, texels: &TexturePicture) -> Result<Self::Made, Self::Error>;
}

/// The levels of a picture whose rows come one after the other.
pub(super) struct PageLevels<'a, M: PageMaker> {
    maker: &'a M,
    halving: Halving,
    levels: Vec<Level>,
    made: Vec<M::Made>,
}

/// The rows of a level that are still needed.
struct Level {
    number: u8,
    shape: TextureShape,
    wrap: [Wrap; 2],
    columns: usize,
    rows: u32,
    /// Rows in a row, from `first` on.
    kept: Vec<Texel>,
    first: u32,
    /// How many came.
    came: u32,
    /// How many rows of pages were made, of which the first may wait for the last row.
    made_rows: u16,
    /// Row 0, for what lies below the last one.
    top: Vec<Texel>,
    /// The first row of pages where it waits, with the row below it.
    waits: Option<Vec<Texel>>,
    /// A row whose other half has not come.
    half: Vec<Texel>,
}

impl<'a, M: PageMaker> PageLevels<'a, M> {
    /// Nothing of a picture of this shape.
    pub(super) fn new(maker: &'a M, shape: TextureShape, wrap: [Wrap; 2]) -> Self {
        let level = |number: u8| {
            let [columns, rows] = shape.level_size(number);
            Level {
                number,
                shape,
                wrap,
                columns: columns as usize,
                rows,
                kept: Vec::new(),
                first: 0,
                came: 0,
                made_rows: 0,
                top: Vec::new(),
                waits: None,
                half: Vec::new(),
            }
        };
        Self {
            maker,
            halving: Halving::default(),
            levels: (0..=shape.root()).map(level).collect(),
            made: Vec::new(),
        }
    }

    /// Takes the next rows of the picture.
    ///
    /// # Errors
    /// Those of the maker of pages.
    pub(super) fn push(&mut self, rows: Vec<Texel>) -> Result<(), M::Error> {
        let mut rows = rows;
        for level in 0..self.levels.len() {
            let coarser = self.levels[level].take(&rows, &self.halving);
            let made = self.levels[level].make(self.maker)?;
            self.made.extend(made);
            rows = coarser;
        }
        Ok(())
    }

    /// All pages that are made since this was last asked, in no order.
    pub(super) fn take_made(&mut self) -> Vec<M::Made> {
        std::mem::take(&mut self.made)
    }

    /// The one texel that is left of all, once all rows came.
    pub(super) fn mean(&self) -> Texel {
        let Some(root) = self.levels.last() else {
            return [255; 4];
        };
        // The coarsest level has one row of pages, all of whose rows are kept.
        let mut level = TexturePicture {
            size: [root.columns as u32, root.rows],
            texels: root.kept.clone(),
        };
        while level.size != [1, 1] {
            level = self.halving.halved(&level);
        }
        level.at([0, 0])
    }
}

impl Level {
    /// Keeps rows, and gives those of the next coarser level that they make.
    fn take(&mut self, rows: &[Texel], halving: &Halving) -> Vec<Texel> {
        if self.came == 0 {
            self.top = rows.get(..self.columns).unwrap_or_default().to_vec();
        }
        self.came += (rows.len() / self.columns) as u32;
        self.kept.extend_from_slice(rows);
        let joined = match self.half.is_empty() {
            true => std::borrow::Cow::Borrowed(rows),
            false => {
                let mut joined = std::mem::take(&mut self.half);
                joined.extend_from_slice(rows);
                joined.into()
            }
        };
        // The last row stands for the one that an odd number lacks.
        let is_whole = self.came == self.rows;
        let count = joined.len() / self.columns;
        let paired = if is_whole { count } else { count - count % 2 };
        let (paired, left) = joined.split_at(paired * self.columns);
        self.half = left.to_vec();
        let halved = |pair: &[Texel]| {
            let fine = TexturePicture {
                size: [self.columns as u32, (pair.len() / self.columns) as u32],
                texels: pair.to_vec(),
            };
            halving.halved(&fine).texels
        };
        let pairs = paired.par_chunks(2 * self.columns);
        let coarser: Vec<Vec<Texel>> = pairs.map(halved).collect();
        coarser.concat()
    }

    /// Makes the pages whose rows are there.
    fn make<M: PageMaker>(&mut self, maker: &M) -> Result<Vec<M::Made>, M::Error> {
        let mut made = Vec::new();
        let is_whole = self.came == self.rows;
        while u32::from(self.made_rows) * PAGE_SIDE < self.rows {
            let end = (u32::from(self.made_rows) + 1) * PAGE_SIDE;
            // With the row next to it.
            if self.came < (end + 1).min(self.rows) {
                break;
            }
            let waits = self.made_rows == 0 && self.wrap[1] == Wrap::Repeat && !is_whole;
            match waits {
                true => {
                    let needed = (end + 1) as usize * self.columns;
                    self.waits = Some(self.kept[..needed.min(self.kept.len())].to_vec());
                }
                false => {
                    made.extend(self.made_of(maker, self.made_rows, &self.kept, self.first)?);
                }
            }
            self.made_rows += 1;
            self.forget(end);
        }
        if is_whole && let Some(first) = self.waits.take() {
            made.extend(self.made_of(maker, 0, &first, 0)?);
        }
        Ok(made)
    }

    /// Keeps only what the row of pages below a row needs, and all of the coarsest level.
    fn forget(&mut self, end: u32) {
        // The last row lies next to the first one.
        let needed = end.saturating_sub(1).min(self.rows - 1);
        if self.rows > PAGE_SIDE && needed > self.first {
            let gone = (needed - self.first) as usize * self.columns;
            self.kept.drain(..gone.min(self.kept.len()));
            self.first = needed;
        }
    }

    /// The pages of a row of pages, of rows that are kept from one on.
    fn made_of<M: PageMaker>(
        &self,
        maker: &M,
        pages: u16,
        kept: &[Texel],
        first: u32,
    ) -> Result<Vec<M::Made>, M::Error> {
        let within = |kept: &'_ [Texel], first: u32, row: u32| {
            let at = row.checked_sub(first)? as usize * self.columns;
            (at + self.columns <= kept.len()).then_some(at)
        };
        let row = |row: u32| -> &[Texel] {
            let found = within(kept, first, row).map(|at| &kept[at..at + self.columns]);
            let last =
                || within(&self.kept, self.first, row).map(|at| &self.kept[at..at + self.columns]);
            found.or_else(last).unwrap_or(&self.top)
        };
        let wanted = maker.wanted(self.number, pages);
        let all = wanted.par_iter().map(|place| {
            let texels = self.shape.cut_of_rows(&row, *place, self.wrap);
            maker.make(*place, &texels)
        });
        all.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// Hands on the texels of all pages.
    struct All(TextureShape);

    impl PageMaker for All {
        type Made = (PagePlace, TexturePicture);
        type Error = Infallible;

        fn wanted(&self, level: u8, row: u16) -> Vec<PagePlace> {
            let columns = self.0.pages(level)[0] as u16;
            let place = |column| PagePlace {
                level,
                place: [column, row],
            };
            (0..columns).map(place).collect()
        }

        fn make(
            &self,
            place: PagePlace,
            texels: &TexturePicture,
        ) -> Result<Self::Made, Self::Error> {
            Ok((place, texels.clone()))
        }
    }

    fn noise(size: [u32; 2]) -> TexturePicture {
        let mut state = size[0] * 7 + size[1];
        let mut texel = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state.to_be_bytes()
        };
        TexturePicture {
            size,
            texels: (0..size[0] * size[1]).map(|_| texel()).collect(),
        }
    }

    #[test]
    fn pages_in_bands_are_those_of_whole_levels() {
        for size in [
            [1, 1],
            [3, 256],
            [5, 257],
            [300, 512],
            [7, 1025],
            [520, 771],
            [2, 3000],
        ] {
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                let (shape, wrap) = (TextureShape { size }, [Wrap::Clamp, wrap]);
                let picture = noise(size);
                let maker = All(shape);
                let mut pyramid = PageLevels::new(&maker, shape, wrap);
                for band in picture.texels.chunks((size[0] * BAND_ROWS) as usize) {
                    pyramid.push(band.to_vec()).unwrap();
                }
                let mut made = pyramid.take_made();
                made.sort_by_key(|(place, _)| *place);
                let mut level = picture;
                let mut pages = made.into_iter();
                for number in 0..=shape.root() {
                    let [columns, rows] = shape.pages(number).map(|it| it as u16);
                    for place in (0..columns).flat_map(|x| (0..rows).map(move |y| [x, y])) {
                        let place = PagePlace {
                            level: number,
                            place,
                        };
                        let expected = (place, shape.cut(&level, place, wrap));
                        assert!(
                            pages.next() == Some(expected),
                            "{size:?} {wrap:?} {place:?}"
                        );
                    }
                    level = Halving::default().halved(&level);
                }
                assert!(pages.next().is_none());
                while level.size != [1, 1] {
                    level = Halving::default().halved(&level);
                }
                assert_eq!(pyramid.mean(), level.at([0, 0]), "{size:?}");
            }
        }
    }
}
