//! Which part of a unit that came before does another refine?

use crate::pack::unit::UnitId;

/// Most parts of a unit, and most that one unit is shown in place of.
pub const MOST_PARTS: usize = 16;

/// A part of a unit that came before: a cluster of triangles, a quarter of a page of a texture, or
/// an octant of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PartRef {
    /// Which of the refining unit's prerequisites it came with.
    pub need: u8,
    /// Its number there.
    pub part: u8,
}

impl PartRef {
    /// As the table of units stores it: the prerequisite times 16, plus the number there.
    #[must_use]
    pub fn to_byte(self) -> u8 {
        self.need << 4 | (self.part & 15)
    }

    /// The part that such a byte encodes. Every byte is one.
    #[must_use]
    pub fn from_byte(byte: u8) -> Self {
        Self {
            need: byte >> 4,
            part: byte & 15,
        }
    }

    /// Whether it came with one of these units.
    #[must_use]
    pub fn is_of(&self, needs: &[UnitId]) -> bool {
        usize::from(self.need) < needs.len()
    }
}
