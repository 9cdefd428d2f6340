//! What do the bytes of a unit of points say?
//!
//! A unit adds points to a cube of space, on the grid of its file. Points of a unit that others
//! refine have the mean colour of those that they stand for; what is missing to their own comes
//! with the unit in whose cube they lie. All units together give each point of the file, bit for
//! bit, in another order. Normative: docs/formats/pack.md.
//!
//! In order, numbers little-endian:
//!
//! 1. Head: a byte with the version in its high four bits and in its low ones what points have (1:
//!    colours, 2: intensities, 4: classes); which [`Order`] they come in, a byte; the bits of a
//!    place in the cube along an axis, a byte; into how many cells a side of the cube is cut so
//!    that about one point lies in each that has any, as a power of two, a byte; the number of
//!    points and that of corrections, two bytes each; the corner of the cube, four bytes an axis.
//! 2. Lists of numbers as `lengths.rs` says. Where points lie, as `payload/places.rs` says; of
//!    colours green, then red and blue as `payload/colours.rs` says; intensities and classes, each
//!    as what is added to the one before, from 0; corrections of colours.

mod colours;
mod places;
#[cfg(test)]
mod tests;

use super::cloud_point::wrong;
pub use super::cloud_point::{CloudPoint, Correction};
use super::lengths::{NumberList, signed_from_unsigned, unsigned_from_signed, write_list};
use crate::pack::PackError;
pub use places::Order;
use places::{MOST_BITS, ordered, read_places, write_places};
use serde::{Deserialize, Serialize};

/// Version of the layout.
const VERSION: u8 = 2;
/// Bytes of the head.
const HEAD_BYTES: usize = 20;
/// Most points of a unit, and most corrections.
pub const MOST_POINTS: usize = 8192;

/// What points of an object have in addition to a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointAttributes {
    /// Colours; without, the object's own.
    pub colours: bool,
    /// Intensities.
    pub intensities: bool,
    /// Classes.
    pub classes: bool,
}

impl PointAttributes {
    fn flags(self) -> u8 {
        u8::from(self.colours) | u8::from(self.intensities) << 1 | u8::from(self.classes) << 2
    }
}

/// What one unit says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PointUnit {
    /// The corner of its cube with the smallest coordinates, on the grid of its object.
    pub corner: [u32; 3],
    /// Bits of a place in the cube along an axis, up to 32. An octant has one less, and no less
    /// than 0.
    pub bits: u8,
    /// Into how many cells a side of the cube is cut so that about one point is shown in each that
    /// has any, as a power of two.
    pub cells: u8,
    /// The points that it adds, all in the cube.
    pub points: Vec<CloudPoint>,
    /// For each point of the unit that it needs which lies in its cube, in the order in which that
    /// has them, what is added to its colour from now on.
    pub corrections: Vec<Correction>,
}

impl PointUnit {
    /// The unit as bytes, of an object whose points have these attributes. The points are put in
    /// the order in which [`Self::parse`] gives them, which corrections of finer units count on.
    ///
    /// # Errors
    /// More points than a unit can hold, or some that do not lie in its cube.
    pub fn write(&mut self, attributes: PointAttributes) -> Result<Vec<u8>, PackError> {
        self.check()?;
        let order = ordered(&mut self.points, (self.corner, self.bits));
        let mut bytes = vec![VERSION << 4 | attributes.flags(), order as u8];
        bytes.extend([self.bits, self.cells]);
        for count in [self.points.len(), self.corrections.len()] {
            bytes.extend((count as u16).to_le_bytes());
        }
        bytes.extend(self.corner.iter().flat_map(|it| it.to_le_bytes()));
        write_places(&self.points, (self.corner, self.bits), order, &mut bytes);
        if attributes.colours {
            colours::write(self.points.iter().map(|it| it.colour), &mut bytes);
        }
        if attributes.intensities {
            write_steps(self.points.iter().map(|it| it.intensity), &mut bytes);
        }
        if attributes.classes {
            write_steps(self.points.iter().map(|it| it.class.into()), &mut bytes);
        }
        if attributes.colours {
            colours::write_corrections(&self.corrections, &mut bytes);
        }
        Ok(bytes)
    }

    /// Reads the unit of an object whose points have these attributes.
    ///
    /// All points lie in its cube then. Takes at most some hundred kilobytes, whatever it is given.
    ///
    /// # Errors
    /// The bytes are no such unit.
    pub fn parse(bytes: &[u8], attributes: PointAttributes) -> Result<Self, PackError> {
        let Some((head, rest)) = bytes.split_at_checked(HEAD_BYTES) else {
            return Err(wrong(
                "head",
                format!("{} bytes", bytes.len()),
                "20 and more",
            ));
        };
        if head[0] >> 4 != VERSION {
            return Err(wrong("version", head[0] >> 4, VERSION));
        }
        if head[0] & 15 != attributes.flags() {
            return Err(wrong("attributes", head[0] & 15, attributes.flags()));
        }
        let order = Order::of(head[1]).ok_or_else(|| wrong("order", head[1], "0 to 3"))?;
        let [points, corrections] = [4, 6].map(|at| u16::from_le_bytes([head[at], head[at + 1]]));
        let [points, corrections] = [points, corrections].map(usize::from);
        if points.max(corrections) > MOST_POINTS {
            return Err(wrong("number", points.max(corrections), MOST_POINTS));
        }
        let mut unit = Self {
            corner: [8, 12, 16].map(|at| crate::pack::u32_at(head, at)),
            bits: head[2],
            cells: head[3],
            ..Self::default()
        };
        unit.check()?;
        unit.points.resize(points, CloudPoint::default());
        let mut rest = rest;
        let (cube, shown) = ((unit.corner, unit.bits), &mut unit.points);
        read_places(shown, cube, order, &mut rest)?;
        if attributes.colours {
            colours::read(shown, &mut rest)?;
        }
        read_steps(shown, attributes, &mut rest)?;
        if attributes.colours {
            unit.corrections = colours::read_corrections(corrections, &mut rest)?;
        } else {
            unit.corrections.resize(corrections, [0; 3]);
        }
        match rest.len() {
            0 => Ok(unit),
            left => Err(wrong("end", format!("{left} bytes left"), "none")),
        }
    }

    fn check(&self) -> Result<(), PackError> {
        let (points, corrections) = (self.points.len(), self.corrections.len());
        if points.max(corrections) > MOST_POINTS {
            return Err(wrong("number", points.max(corrections), MOST_POINTS));
        }
        let is_cube = |bits: u8| {
            let last = (1_u64 << bits) - 1;
            let mut corner = self.corner.iter();
            corner.all(|it| u64::from(*it) + last <= u64::from(u32::MAX))
        };
        if self.bits > MOST_BITS || self.cells > MOST_BITS || !is_cube(self.bits) {
            let found = format!("{:?}, {}, {}", self.corner, self.bits, self.cells);
            return Err(wrong("cube", found, "a cube of at most 2^32 steps"));
        }
        let is_inside = |point: &CloudPoint| self.has_inside(point.place);
        match self.points.iter().find(|it| !is_inside(it)) {
            None => Ok(()),
            Some(point) => Err(wrong("place", format!("{:?}", point.place), "in its cube")),
        }
    }

    /// Whether a place lies in the cube.
    #[must_use]
    pub fn has_inside(&self, place: [u32; 3]) -> bool {
        let along = |axis: usize| {
            let from = place[axis].checked_sub(self.corner[axis]);
            from.is_some_and(|from| u64::from(from) >> self.bits == 0)
        };
        [0, 1, 2].into_iter().all(along)
    }

    /// The octant of its cube in which a place in it lies: 1, 2 and 4 for the farther half along x,
    /// y and z.
    #[must_use]
    pub fn octant_of_place(&self, place: [u32; 3]) -> u8 {
        let Some(bit) = self.bits.checked_sub(1) else {
            return 0;
        };
        let far = |k: usize| (place[k].wrapping_sub(self.corner[k]) >> bit & 1) as u8;
        far(0) | far(1) << 1 | far(2) << 2
    }

    /// Length of a cell along an axis, in steps of the grid: about how far points are apart.
    #[must_use]
    pub fn cell_steps(&self) -> u64 {
        1 << self.bits.saturating_sub(self.cells)
    }
}

/// Corner and bits of an octant of a cube.
pub(super) fn octant_of(corner: [u32; 3], bits: u8, octant: u8) -> ([u32; 3], u8) {
    let half = match bits.checked_sub(1) {
        Some(bits) => 1_u32 << bits,
        None => 0,
    };
    let along = |k: usize| corner[k].saturating_add(half * u32::from(octant >> k & 1));
    ([0, 1, 2].map(along), bits.saturating_sub(1))
}

/// Writes numbers as what is added to the one before.
fn write_steps(numbers: impl Iterator<Item = u16>, bytes: &mut Vec<u8>) {
    let mut before = 0;
    let steps = numbers.map(|it| {
        let it = i64::from(it);
        unsigned_from_signed(it - core::mem::replace(&mut before, it))
    });
    write_list(&steps.collect::<Vec<_>>(), bytes);
}

/// Reads intensities and classes, where there are any.
fn read_steps(
    points: &mut [CloudPoint],
    attributes: PointAttributes,
    bytes: &mut &[u8],
) -> Result<(), PackError> {
    let mut intensities = Steps::take(attributes.intensities, bytes)?;
    let mut classes = Steps::take(attributes.classes, bytes)?;
    // What takes no bits stays 0.
    if intensities.list.is_some() || classes.list.is_some() {
        for point in points {
            point.intensity = intensities.next() as u16;
            point.class = classes.next() as u8;
        }
    }
    intensities.end(u16::MAX.into())?;
    classes.end(u8::MAX.into())
}

/// Numbers written as differences from the one before.
#[derive(Default)]
struct Steps<'a> {
    /// `None` where all of them are 0.
    list: Option<NumberList<'a>>,
    number: i64,
    /// All bits that any of them has.
    all: i64,
}

impl<'a> Steps<'a> {
    fn take(is_there: bool, bytes: &mut &'a [u8]) -> Result<Self, PackError> {
        if !is_there {
            return Ok(Self::default());
        }
        let list = NumberList::take(bytes)?;
        if list.only() == Some(0) {
            list.end()?;
            return Ok(Self::default());
        }
        Ok(Self {
            list: Some(list),
            ..Self::default()
        })
    }

    #[inline]
    fn next(&mut self) -> i64 {
        if let Some(list) = &mut self.list {
            self.number = self.number.wrapping_add(signed_from_unsigned(list.next()));
            self.all |= self.number;
        }
        self.number
    }

    /// Ends to read them; they must not be below 0, or above `most`, all of whose low bits are set.
    fn end(self, most: i64) -> Result<(), PackError> {
        self.list.map_or(Ok(()), NumberList::end)?;
        match self.all & !most {
            0 => Ok(()),
            _ => Err(wrong("intensity or class", "too large a number", most)),
        }
    }
}
