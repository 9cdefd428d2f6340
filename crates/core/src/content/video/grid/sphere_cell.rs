//! What of the sphere does a cell of an equirectangular picture cover?
//!
//! All yaws and pitches between two: its sides are meridians and parallels, and the latter are no
//! straight lines.

use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::units::Radians;
use crate::view::axes::{angle_between, direction_from_yaw_pitch, yaw_pitch_from_direction};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::DVec3;

/// The yaws and pitches of a cell, in radians, the lesser first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereCell {
    yaws: [f64; 2],
    pitches: [f64; 2],
}

impl SphereCell {
    /// Of a cell, or a tile of any level, of an equirectangular picture.
    pub(crate) fn new(grid: &TileGrid, cell: Tile) -> Self {
        let (from, size) = (grid.origin(cell), grid.covered(cell));
        let angles = |k: u32| {
            let corner = [0, 1].map(|axis| f64::from(from[axis] + k * size[axis]));
            grid.surface.tangent(corner)
        };
        let [[left, upper], [right, lower]] = [angles(0), angles(1)];
        Self {
            yaws: [left, right],
            pitches: [-lower, -upper],
        }
    }

    /// Directions between which it lies: its corners, those nearer to the equator moved to where
    /// the great circle that touches the parallel there meets the sides. What is half a turn wide
    /// or more lies between none, which these stand for too.
    pub(crate) fn hull(&self) -> [DVec3; 4] {
        let [left, right] = self.yaws;
        let half = (right - left) / 2.0;
        if half >= FRAC_PI_2 - 1e-6 {
            let ahead = direction(left, 0.0);
            return [ahead, -ahead, ahead, -ahead];
        }
        let [lower, upper] = self.pitches;
        // A parallel bends away from the equator over the great circle that touches it.
        let moved = |pitch: f64| libm::atan(libm::tan(pitch) * libm::cos(half));
        let [lower, upper] = [
            if lower > 0.0 { moved(lower) } else { lower },
            if upper < 0.0 { moved(upper) } else { upper },
        ];
        [
            direction(left, upper),
            direction(right, upper),
            direction(left, lower),
            direction(right, lower),
        ]
    }

    /// The radius round its middle that its corners do not show: half a turn where it is wider than
    /// that, as then its farthest place need be no corner, else 0.
    pub(crate) fn least_radius(&self) -> f64 {
        let is_wide = self.yaws[1] - self.yaws[0] > PI;
        if is_wide { PI } else { 0.0 }
    }

    /// Angle between a direction and the nearest place; 0 inside, borders included.
    pub(crate) fn angle_to(&self, towards: DVec3) -> Radians {
        let (yaw, pitch) = yaw_pitch_from_direction(towards);
        let [left, right] = self.yaws;
        let [lower, upper] = self.pitches;
        let beyond = libm::remainder(yaw.0 - (left + right) / 2.0, TAU).abs();
        let aside = beyond - (right - left) / 2.0;
        if aside <= 0.0 {
            return Radians((pitch.0 - upper).max(lower - pitch.0).max(0.0));
        }
        // Along the nearer side the cosine is sin p sin q + cos p cos q cos(aside): most at an end,
        // or where its slope is 0.
        let (sin, cos) = (libm::sin(pitch.0), libm::cos(pitch.0) * libm::cos(aside));
        let middle = libm::atan2(sin, cos).clamp(lower, upper);
        let at = |q: f64| angle_between(direction(aside, pitch.0), direction(0.0, q)).0;
        Radians(at(middle).min(at(lower)).min(at(upper)))
    }
}

fn direction(yaw: f64, pitch: f64) -> DVec3 {
    direction_from_yaw_pitch(Radians(yaw), Radians(pitch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::video::grid::cells::{CellBounds, probes};
    use crate::content::video::grid::tile_grid::Cut;
    use crate::view::random::Random;
    use crate::view::surface::Surface;

    fn grids() -> [TileGrid; 3] {
        let grid = |size, cut| TileGrid::new(Surface::equirect(size), cut, 3, 2).unwrap();
        [
            grid([1000, 500], Cut::Tile(100)),
            grid([512, 400], Cut::Grid([3, 3])),
            grid([512, 256], Cut::Grid([1, 2])),
        ]
    }

    #[test]
    fn a_cell_lies_between_the_directions_of_its_hull_and_within_its_radius() {
        let mut random = Random::new(4);
        for grid in grids() {
            for cell in grid.tiles_of(0) {
                let (sphere, bounds) = (SphereCell::new(&grid, cell), CellBounds::new(&grid, cell));
                for _ in 0..200 {
                    let normal = random.direction();
                    let is_missed = sphere.hull().iter().all(|it| normal.dot(*it) > 1e-9);
                    for probe in probes(&grid, cell) {
                        assert!(!is_missed || normal.dot(probe.direction) > 0.0, "{cell:?}");
                        let least = bounds.least_eccentricity(normal).0;
                        assert!(angle_between(normal, probe.direction).0 >= least - 1e-9);
                    }
                }
            }
        }
    }

    #[test]
    fn the_nearest_place_is_as_near_as_the_nearest_of_many() {
        let mut random = Random::new(9);
        for grid in grids() {
            let surface = &grid.surface;
            for cell in grid.tiles_of(0) {
                let (from, size) = (grid.origin(cell), grid.covered(cell));
                let places: Vec<DVec3> = (0..=40 * 41)
                    .map(|k| {
                        let step = [k % 41, (k / 41).min(40)];
                        let at =
                            |k: usize| f64::from(from[k]) + f64::from(size[k] * step[k]) / 40.0;
                        surface.direction(0, [at(0), at(1)])
                    })
                    .collect();
                let apart = CellBounds::new(&grid, cell).probe_spacing().0;
                for _ in 0..30 {
                    let towards = random.direction();
                    let found = SphereCell::new(&grid, cell).angle_to(towards).0;
                    let all = places.iter().map(|it| angle_between(towards, *it).0);
                    let nearest = all.fold(f64::MAX, f64::min);
                    assert!(found <= nearest + 1e-9, "{cell:?} {towards:?}");
                    assert!(found >= nearest - apart / 2.0, "{cell:?} {towards:?}");
                }
                for place in &places {
                    assert!(SphereCell::new(&grid, cell).angle_to(*place).0 < 1e-9);
                }
            }
        }
    }

    #[test]
    fn the_probe_nearest_to_the_gaze_is_that_of_all() {
        let mut random = Random::new(2);
        for grid in grids() {
            for cell in grid.tiles_of(0) {
                let bounds = CellBounds::new(&grid, cell);
                for _ in 0..50 {
                    let gaze = random.direction();
                    let found = bounds.nearest_probe(&grid, gaze).direction;
                    let all = probes(&grid, cell).map(|it| angle_between(gaze, it.direction).0);
                    let nearest = all.fold(f64::MAX, f64::min);
                    assert!((angle_between(gaze, found).0 - nearest).abs() < 1e-6);
                }
            }
        }
    }
}
