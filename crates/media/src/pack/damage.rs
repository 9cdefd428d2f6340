//! What is damaged in a pack, however much that is?

use crate::pack::open_pack::PackFileError;

/// Most damaged places that are kept.
const MOST_KEPT: usize = 100;

/// The first damaged places of a pack, and how many there are.
#[derive(Debug, Default)]
pub struct Damage {
    first: Vec<PackFileError>,
    places: u64,
    is_tangled: bool,
}

impl Damage {
    /// Of chunks or tables that overlap or leave gaps: nothing else is looked for.
    pub(crate) fn tangled(error: PackFileError) -> Self {
        Self {
            first: vec![error],
            places: 1,
            is_tangled: true,
        }
    }

    /// Whether chunks or tables overlap or leave gaps.
    #[must_use]
    pub fn is_tangled(&self) -> bool {
        self.is_tangled
    }

    /// Counts a part that could not be read.
    pub(crate) fn add<T>(&mut self, read: Result<T, PackFileError>) {
        let Err(error) = read else { return };
        self.places += 1;
        if self.first.len() < MOST_KEPT {
            self.first.push(error);
        }
    }

    /// Whether all is well.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places == 0
    }

    /// How many places are damaged.
    #[must_use]
    pub fn places(&self) -> u64 {
        self.places
    }

    /// The first of them, at most a hundred.
    #[must_use]
    pub fn first(&self) -> &[PackFileError] {
        &self.first
    }
}
