//! Which points of the units at hand are shown, and in which colours?
//!
//! All points of all units that are there are shown. A point has the mean colour of those that it
//! stands for until the unit is there in whose cube it lies, and from then on its own.

use super::cloud_point::wrong;
use super::payload::{CloudPoint, Correction, PointUnit, octant_of};
use crate::content::points::cloud::Cloud;
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use std::collections::{BTreeMap, HashSet};

/// Bits of a place in a cube that is shown.
pub const SHOWN_BITS: u8 = 16;
/// Number of octants of a cube.
pub const OCTANTS: usize = 8;

/// Points that may lie where others do before it is looked which.
const MOST_REPEATS: usize = 16;

/// A point as it is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShownPoint {
    /// Its place in the cube of its unit, in 65536ths of a side.
    pub place: [u16; 3],
    /// Red, green and blue as codes of the file.
    pub colour: [u16; 3],
}

impl ShownPoint {
    /// The octant of its unit's cube in which it lies: 1, 2 and 4 for the farther half along x, y
    /// and z.
    #[must_use]
    pub fn octant(&self) -> u8 {
        let [x, y, z] = self.place.map(|it| (it >> 15) as u8);
        x | y << 1 | z << 2
    }
}

/// A unit of points that is there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlacedPoints {
    /// The corner of its cube on the grid of its object.
    pub corner: [u32; 3],
    /// Bits of a place in the cube along an axis.
    pub bits: u8,
    /// Length of a cell along an axis, in steps of the grid.
    pub cell_steps: u64,
    /// Its points.
    pub points: Vec<ShownPoint>,
    /// The units that are there and refine its octants.
    pub refined_by: [Option<UnitId>; OCTANTS],
    /// The unit that it refines, and which octant of it.
    refines: Option<(UnitId, u8)>,
    corrections: Vec<Correction>,
    /// The first of all points at each place, in order; where these are about all, nothing.
    firsts: Option<Vec<u32>>,
}

impl PlacedPoints {
    /// The points to draw: where many lie at one place the first of them, which hides the others.
    pub fn drawn(&self) -> impl ExactSizeIterator<Item = &ShownPoint> {
        let count = self.firsts.as_ref().map_or(self.points.len(), Vec::len);
        (0..count).map(|number| match &self.firsts {
            Some(firsts) => &self.points[firsts[number] as usize],
            None => &self.points[number],
        })
    }

    /// The unit that it refines; of a root none.
    #[must_use]
    pub fn parent(&self) -> Option<UnitId> {
        self.refines.map(|(parent, _)| parent)
    }

    /// The colours of its points in one of its octants, in their order.
    fn colours_in(&mut self, octant: u8) -> impl Iterator<Item = &mut [u16; 3]> {
        let inside = self
            .points
            .iter_mut()
            .filter(move |it| it.octant() == octant);
        inside.map(|it| &mut it.colour)
    }
}

/// The units of points that are there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PointCut {
    units: BTreeMap<UnitId, PlacedPoints>,
}

impl PointCut {
    /// Adds a unit of a cloud, after the unit whose octant it refines, where it is no root.
    ///
    /// # Errors
    /// That is not there, or the unit does not fit to it: nothing changed then.
    pub fn insert(
        &mut self,
        unit: UnitId,
        refines: Option<(UnitId, u8)>,
        payload: &PointUnit,
        cloud: &Cloud,
    ) -> Result<&PlacedPoints, PackError> {
        match refines {
            Some((parent, octant)) => self.correct(parent, octant, unit, payload)?,
            None if payload.corrections.is_empty() => {}
            None => {
                return Err(wrong(
                    "corrections",
                    payload.corrections.len(),
                    "none of a root",
                ));
            }
        }
        let points = shown(payload, cloud);
        let placed = PlacedPoints {
            corner: payload.corner,
            bits: payload.bits,
            cell_steps: payload.cell_steps(),
            firsts: firsts(&points),
            points,
            refined_by: [None; OCTANTS],
            refines,
            corrections: payload.corrections.clone(),
        };
        Ok(self.units.entry(unit).insert_entry(placed).into_mut())
    }

    /// Gives points of an octant their own colours.
    fn correct(
        &mut self,
        parent: UnitId,
        octant: u8,
        unit: UnitId,
        payload: &PointUnit,
    ) -> Result<(), PackError> {
        let Some(there) = self
            .units
            .get_mut(&parent)
            .filter(|_| usize::from(octant) < OCTANTS)
        else {
            return Err(wrong(
                "refines",
                format!("octant {octant} of {parent:?}"),
                "one there",
            ));
        };
        if there.refined_by[usize::from(octant)].is_some_and(|by| by != unit) {
            return Err(wrong(
                "refines",
                octant,
                "an octant that no other unit refines",
            ));
        }
        let cube = octant_of(there.corner, there.bits, octant);
        if (payload.corner, payload.bits) != cube {
            let found = format!("{:?}, {:?}", payload.corner, payload.bits);
            return Err(wrong(
                "cube",
                found,
                format!("{cube:?}, the octant that it refines"),
            ));
        }
        let own: Vec<Option<[u16; 3]>> = there
            .colours_in(octant)
            .zip(&payload.corrections)
            .map(|(colour, by)| corrected(*colour, *by, 1))
            .collect();
        let points = there.colours_in(octant).count();
        if points != payload.corrections.len() {
            let found = payload.corrections.len();
            return Err(wrong(
                "corrections",
                found,
                format!("{points}, as points lie in it"),
            ));
        }
        let Some(own) = own.into_iter().collect::<Option<Vec<_>>>() else {
            return Err(wrong("corrections", "a code beyond 65535", "0 to 65535"));
        };
        let colours = there.colours_in(octant).zip(own);
        colours.for_each(|(colour, own)| *colour = own);
        there.refined_by[usize::from(octant)] = Some(unit);
        Ok(())
    }

    /// Takes a unit away that no other needs: what it refined has its mean colours again.
    pub fn remove(&mut self, unit: UnitId) -> Option<PlacedPoints> {
        let removed = self.units.remove(&unit)?;
        self.recolour(&removed, None, -1);
        Some(removed)
    }

    /// Adds what [`Self::remove`] took away, while what it refines is there.
    pub fn put_back(&mut self, unit: UnitId, placed: PlacedPoints) {
        self.recolour(&placed, Some(unit), 1);
        self.units.insert(unit, placed);
    }

    /// Adds the corrections of a unit so many times to what it refines, and records which unit does
    /// that.
    fn recolour(&mut self, placed: &PlacedPoints, by: Option<UnitId>, times: i64) {
        let there = placed.refines.and_then(|(parent, octant)| {
            let there = self.units.get_mut(&parent)?;
            Some((there, octant))
        });
        let Some((there, octant)) = there else {
            return;
        };
        there.refined_by[usize::from(octant)] = by;
        for (colour, by) in there.colours_in(octant).zip(&placed.corrections) {
            // What was added can be taken away.
            *colour = corrected(*colour, *by, times).unwrap_or(*colour);
        }
    }

    /// A unit that is there.
    #[must_use]
    pub fn unit(&self, unit: UnitId) -> Option<&PlacedPoints> {
        self.units.get(&unit)
    }

    /// The units that are there, in order.
    pub fn units(&self) -> impl Iterator<Item = (UnitId, &PlacedPoints)> {
        self.units.iter().map(|(unit, placed)| (*unit, placed))
    }
}

fn corrected(colour: [u16; 3], by: Correction, times: i64) -> Option<[u16; 3]> {
    let mut own = colour;
    for (own, by) in own.iter_mut().zip(by) {
        *own = u16::try_from(i64::from(*own) + times * i64::from(by)).ok()?;
    }
    Some(own)
}

/// The points of a unit as they are shown: those without colours in greys of their intensities.
fn shown(payload: &PointUnit, cloud: &Cloud) -> Vec<ShownPoint> {
    let along = |place: u32, axis: usize| {
        let (from, bits) = (place.wrapping_sub(payload.corner[axis]), payload.bits);
        match bits.checked_sub(SHOWN_BITS) {
            Some(more) => from >> more,
            None => from << (SHOWN_BITS - bits),
        }
    };
    let attributes = cloud.attributes;
    let colour = |point: &CloudPoint| match attributes.intensities {
        _ if attributes.colours => point.colour,
        true => [cloud.grey_of(point.intensity); 3],
        false => [u16::MAX; 3],
    };
    let point = |point: &CloudPoint| ShownPoint {
        place: [0, 1, 2].map(|axis| along(point.place[axis], axis) as u16),
        colour: colour(point),
    };
    payload.points.iter().map(point).collect()
}

/// The first of all points at each place; nothing where few share one, which costs less to draw
/// than to find.
fn firsts(points: &[ShownPoint]) -> Option<Vec<u32>> {
    const MARKS: usize = 1 << 16;
    let mut marks = vec![0_u64; MARKS / 64];
    let may_repeat = |point: &&ShownPoint| {
        // The fraction of the golden ratio (Knuth, TAOCP 3, 6.4).
        let [x, y, z] = point.place.map(u64::from);
        let hash = (x | y << 16 | z << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mark = (hash >> 48) as usize;
        let was = marks[mark / 64] >> (mark % 64) & 1;
        marks[mark / 64] |= 1 << (mark % 64);
        was > 0
    };
    let repeats = points.iter().filter(may_repeat).count();
    if repeats < MOST_REPEATS.max(points.len() / 4) {
        return None;
    }
    let mut known = HashSet::new();
    let numbered = (0..).zip(points);
    let firsts = numbered.filter(|(_, point)| known.insert(point.place));
    Some(firsts.map(|(number, _)| number).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud() -> Cloud {
        let mut cloud = Cloud::default();
        cloud.attributes.colours = true;
        cloud
    }

    fn point(place: [u32; 3], red: u16) -> CloudPoint {
        CloudPoint {
            place,
            colour: [red, 10, 20],
            ..CloudPoint::default()
        }
    }

    fn root() -> PointUnit {
        PointUnit {
            bits: 4,
            points: vec![point([1, 2, 3], 100), point([9, 2, 15], 200)],
            ..PointUnit::default()
        }
    }

    fn child() -> PointUnit {
        PointUnit {
            corner: [8, 0, 8],
            bits: 3,
            points: vec![point([9, 3, 15], 50)],
            corrections: vec![[-150, 0, 1]],
            ..PointUnit::default()
        }
    }

    #[test]
    fn a_point_has_its_own_colour_while_the_unit_is_there_in_which_it_lies() {
        let mut cut = PointCut::default();
        cut.insert(UnitId(0), None, &root(), &cloud()).unwrap();
        let before = cut.clone();
        let refines = Some((UnitId(0), 5));
        let placed = cut.insert(UnitId(3), refines, &child(), &cloud()).unwrap();
        assert_eq!(placed.points[0].place, [1 << 13, 3 << 13, 7 << 13]);
        let root = cut.unit(UnitId(0)).unwrap();
        let reds = root.points.iter().map(|it| it.colour[0]);
        assert_eq!(reds.collect::<Vec<_>>(), [100, 50]);
        assert_eq!(root.refined_by[5], Some(UnitId(3)));
        let with = cut.clone();
        let removed = cut.remove(UnitId(3)).unwrap();
        assert_eq!((removed.parent(), &cut), (Some(UnitId(0)), &before));
        cut.put_back(UnitId(3), removed);
        assert_eq!(cut, with);
    }

    #[test]
    fn of_many_points_at_one_place_the_first_is_drawn() {
        let place = |k: u32| [[1, 2, 3], [4, 5, 6]][(k % 2) as usize];
        let many = PointUnit {
            bits: 4,
            points: (0..1000).map(|k| point(place(k), k as u16)).collect(),
            ..PointUnit::default()
        };
        let mut cut = PointCut::default();
        let placed = cut.insert(UnitId(0), None, &many, &cloud()).unwrap();
        let reds: Vec<u16> = placed.drawn().map(|it| it.colour[0]).collect();
        assert_eq!((reds, placed.points.len()), (vec![0, 1], 1000));
        let placed = cut.insert(UnitId(1), None, &root(), &cloud()).unwrap();
        assert_eq!(placed.drawn().len(), 2);
    }

    #[test]
    fn a_unit_that_does_not_fit_changes_nothing() {
        let mut cut = PointCut::default();
        cut.insert(UnitId(0), None, &root(), &cloud()).unwrap();
        let before = cut.clone();
        let mut wrong = vec![(child(), 4), (child(), 9), (root(), 5)];
        for corrections in [
            vec![],
            vec![[0; 3]; 2],
            vec![[-201, 0, 0]],
            vec![[i32::MAX; 3]],
        ] {
            let bad = PointUnit {
                corrections,
                ..child()
            };
            wrong.push((bad, 5));
        }
        for (payload, octant) in wrong {
            let refines = Some((UnitId(0), octant));
            assert!(cut.insert(UnitId(1), refines, &payload, &cloud()).is_err());
            assert_eq!(cut, before);
        }
        assert!(cut.insert(UnitId(2), None, &child(), &cloud()).is_err());
    }
}
