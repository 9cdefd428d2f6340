//! Do the units of clouds fit to each other?

use super::cloud_point::wrong;
use super::cut::OCTANTS;
use super::payload::{PointUnit, octant_of};
use crate::content::payload::Payload;
use crate::content::scene::unit_table::UnitRow;
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use std::collections::HashMap;

/// What is kept of a unit for those that refine it.
#[derive(Clone, Copy, Debug)]
struct Cube {
    corner: [u32; 3],
    bits: u8,
    /// Number of points in each octant.
    points: [usize; OCTANTS],
}

/// Compares units with those that they refine, which come before them.
#[derive(Clone, Debug, Default)]
pub struct CloudCheck {
    cubes: HashMap<UnitId, Cube>,
}

impl CloudCheck {
    /// Adds a unit of any kind.
    ///
    /// # Errors
    /// It has other corrections than there are points to be corrected, or another cube than the
    /// octant that it refines.
    pub fn add(&mut self, unit: UnitId, row: &UnitRow, payload: &Payload) -> Result<(), PackError> {
        let Payload::Points(payload) = payload else {
            return Ok(());
        };
        let refines = row.needs.first().zip(row.replaces.first());
        let there = refines.and_then(|(need, octant)| Some((*self.cubes.get(need)?, *octant)));
        self.cubes.insert(unit, Cube::of(payload));
        let (expected, points) = match there {
            Some((cube, octant)) => {
                let octant = octant.part;
                let points = cube.points.get(usize::from(octant)).copied();
                (
                    octant_of(cube.corner, cube.bits, octant),
                    points.unwrap_or(0),
                )
            }
            // What it refines is damaged itself.
            None if refines.is_some() => return Ok(()),
            None => ((payload.corner, payload.bits), 0),
        };
        let found = (payload.corner, payload.bits, payload.corrections.len());
        match found == (expected.0, expected.1, points) {
            true => Ok(()),
            false => Err(wrong(
                &format!("unit {}, cube and corrections", unit.0),
                format!("{found:?}"),
                format!("{expected:?} and {points}, as what it refines has"),
            )),
        }
    }
}

impl Cube {
    fn of(payload: &PointUnit) -> Self {
        let mut points = [0; OCTANTS];
        for point in &payload.points {
            points[usize::from(payload.octant_of_place(point.place))] += 1;
        }
        Self {
            corner: payload.corner,
            bits: payload.bits,
            points,
        }
    }
}
