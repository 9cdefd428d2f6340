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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_is_a_part_and_every_part_has_a_byte_of_its_own() {
        for byte in 0..=u8::MAX {
            let part = PartRef::from_byte(byte);
            assert_eq!(part.to_byte(), byte);
            assert!(
                usize::from(part.need.max(part.part)) < MOST_PARTS,
                "{part:?}"
            );
        }
    }

    #[test]
    fn a_part_came_with_one_of_the_units_that_its_unit_needs() {
        let needs = [UnitId(7), UnitId(9)];
        let of = |need| PartRef { need, part: 15 }.is_of(&needs);
        assert_eq!([0, 1, 2, 15].map(of), [true, true, false, false]);
        assert!(!PartRef::from_byte(0).is_of(&[]));
    }
}
