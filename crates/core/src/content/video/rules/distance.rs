//! How far is each part of the picture from the gaze, and which level does that distance give?
//!
//! Kastner 2016, framework 1 (section 4.1.3): "the selection of mip-map levels is based on a
//! thresholding in distance to the center of the acuity mask", and tiles out of view are not read.
//! The text prints no thresholds; [`acuity_thresholds`] takes them from the eye's model.

use crate::content::video::grid::cells::{CellBounds, probes};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::sphere_cell::SphereCell;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::perception::acuity::AcuityModel;
use crate::units::Radians;
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;
use crate::view::frustum::Frustum;
use glam::DVec3;

/// Halvings of the half circle that a threshold is searched in: to 1e-9 of a degree.
const HALVINGS: u32 = 38;

/// Angle by which rounding may move a place, in radians: borders count as inside.
const ROUNDING: f64 = 1e-9;

/// For every level but the coarsest the distance up to which it is wanted: beyond the n-th angle a
/// texel of level n + 1 is no wider than the eye's minimum angle of resolution, at the density that
/// the surface has straight ahead. Rises with the level.
#[must_use]
pub fn acuity_thresholds(grid: &TileGrid, eye: &AcuityModel) -> Vec<Radians> {
    let middle = grid.surface.size.map(|side| f64::from(side) / 2.0);
    let ppd = grid.surface.ppd(middle).0;
    let suits = |level: u8, eccentricity: Radians| {
        let resolved_deg = 0.5 / eye.best_acuity(eccentricity).0;
        f64::from(grid.scale(level)) / ppd <= resolved_deg
    };
    let threshold = |level: u8| {
        let (mut near, mut far) = (0.0, core::f64::consts::PI);
        if suits(level, Radians(near)) {
            return Radians(near);
        }
        for _ in 0..HALVINGS {
            let middle = (near + far) / 2.0;
            if suits(level, Radians(middle)) {
                far = middle;
            } else {
                near = middle;
            }
        }
        Radians(far)
    };
    (1..grid.levels).map(threshold).collect()
}

/// The level of every cell by its distance to the gaze: as many levels coarser than the finest as
/// there are `thresholds` (rising) below it, the coarsest beyond the last of them and, where a view
/// is given, out of view.
pub(crate) fn distance_levels(
    grid: &TileGrid,
    cells: &[CellBounds],
    thresholds: &[Radians],
    gaze: DVec3,
    view: Option<&EyeView>,
) -> LevelMap {
    let coarsest = grid.coarsest();
    let farthest = thresholds.last().map_or(0.0, |limit| limit.0) + ROUNDING;
    let mut cells = cells.iter();
    LevelMap::from_cells(grid, |cell| {
        let may_matter = cells.next().is_none_or(|bounds| {
            bounds.least_eccentricity(gaze).0 <= farthest
                && view.is_none_or(|view| is_seen(grid, bounds, view, gaze))
        });
        if !may_matter {
            return coarsest;
        }
        let away = distance_to_cell(grid, cell, gaze);
        let passed = thresholds
            .iter()
            .filter(|limit| away.0 > limit.0 + ROUNDING)
            .count();
        if passed == thresholds.len() {
            return coarsest;
        }
        u8::try_from(passed).unwrap_or(coarsest).min(coarsest)
    })
}

/// Whether any place of a cell may be in view: a probe is, or lies no farther outside the view than
/// the next probe.
fn is_seen(grid: &TileGrid, bounds: &CellBounds, view: &EyeView, gaze: DVec3) -> bool {
    let sight = Frustum::new(view, bounds.probe_spacing());
    let mut places = probes(grid, bounds.cell);
    (!bounds.is_beyond(&sight) && places.any(|probe| sight.reaches(probe.direction)))
        || angle_to_cell(grid, bounds.cell, gaze).0 <= ROUNDING
}

/// Angle between a direction and the nearest place of a cell, on the sphere; 0 inside.
fn distance_to_cell(grid: &TileGrid, cell: Tile, direction: DVec3) -> Radians {
    let ahead = angle_to_cell(grid, cell, direction);
    let around = probes(grid, cell).map(|probe| angle_between(direction, probe.direction));
    around.fold(
        ahead,
        |least, angle| if angle < least { angle } else { least },
    )
}

/// Angle between a direction and the nearest place of a cell in the plane of its face, seen from
/// ahead of that face; 0 inside, borders included, and half a turn from the side or behind.
/// Of an equirectangular picture, the nearest place on the sphere.
pub(crate) fn angle_to_cell(grid: &TileGrid, cell: Tile, direction: DVec3) -> Radians {
    let surface = &grid.surface;
    if !surface.is_of_planes() {
        return SphereCell::new(grid, cell).angle_to(direction);
    }
    let axes = surface.axes(u32::from(cell.face));
    let depth = direction.dot(axes.forward);
    if depth <= 1e-9 {
        return Radians(core::f64::consts::PI);
    }
    let tangent = [
        direction.dot(axes.right) / depth,
        direction.dot(axes.down) / depth,
    ];
    let (from, size) = (grid.origin(cell), grid.covered(cell));
    let place = surface.place(tangent);
    let nearest = [0, 1].map(|k| place[k].clamp(f64::from(from[k]), f64::from(from[k] + size[k])));
    angle_between(direction, surface.direction(u32::from(cell.face), nearest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::video::grid::tile_grid::Cut;
    use crate::units::Radians;
    use crate::view::random::Random;
    use crate::view::surface::{Screen, Surface};

    fn grids() -> [TileGrid; 2] {
        let flat = Surface::flat([7680, 4320], Screen::default());
        [
            TileGrid::new(flat, Cut::Grid([4, 4]), 3, 4).unwrap(),
            TileGrid::new(Surface::cube(1024), Cut::Tile(128), 4, 2).unwrap(),
        ]
    }

    fn levels(grid: &TileGrid, thresholds: &[Radians], gaze: DVec3) -> LevelMap {
        let cells: Vec<CellBounds> = grid.tiles_of(0).map(|c| CellBounds::new(grid, c)).collect();
        distance_levels(grid, &cells, thresholds, gaze, None)
    }

    #[test]
    fn thresholds_of_the_eye_rise_and_are_where_the_next_level_is_fine_enough() {
        for grid in grids() {
            let thresholds = acuity_thresholds(&grid, &AcuityModel::LINEAR);
            assert_eq!(thresholds.len(), usize::from(grid.coarsest()));
            assert!(thresholds.windows(2).all(|pair| pair[0] <= pair[1]));
        }
        // An 8K picture 47.7° wide has 151.6 pixels a degree straight ahead: 16 of them are
        // 1/60° + 0.022 · e at e = 4.04°.
        let [wide, _] = grids();
        let middle = wide.surface.size.map(|s| f64::from(s) / 2.0);
        let expected = (16.0 / wide.surface.ppd(middle).0 - 1.0 / 60.0) / 0.022;
        let found = acuity_thresholds(&wide, &AcuityModel::LINEAR)[1].to_degrees();
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }

    #[test]
    fn a_cell_is_as_near_as_its_nearest_place() {
        let mut random = Random::new(5);
        for grid in grids() {
            for _ in 0..200 {
                let [w, h] = grid.surface.size.map(f64::from);
                let face = (random.unit() * f64::from(grid.faces())) as u32;
                let gaze = grid
                    .surface
                    .direction(face, [w * random.unit(), h * random.unit()]);
                for cell in grid.tiles_of(0) {
                    let away = distance_to_cell(&grid, cell, gaze);
                    let [x, y] = grid.origin(cell).map(f64::from);
                    let [columns, rows] = grid.covered(cell).map(f64::from);
                    let place = [x + columns * random.unit(), y + rows * random.unit()];
                    let inside = grid.surface.direction(u32::from(cell.face), place);
                    let slack = CellBounds::new(&grid, cell).probe_spacing();
                    let angle = angle_between(gaze, inside);
                    assert!(away.0 <= angle.0 + slack.0, "{cell:?} {away:?} {angle:?}");
                }
            }
        }
    }

    #[test]
    fn levels_never_become_finer_with_distance() {
        let degrees = [3.0, 11.0].map(Radians::from_degrees);
        for grid in grids() {
            let gaze = grid.surface.direction(0, [300.0, 200.0]);
            let map = levels(&grid, &degrees, gaze);
            let mut cells: Vec<(f64, u8)> = grid
                .tiles_of(0)
                .map(|cell| {
                    let away = distance_to_cell(&grid, cell, gaze);
                    (away.to_degrees(), map.level(&grid, cell))
                })
                .collect();
            cells.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert!(cells.windows(2).all(|pair| pair[0].1 <= pair[1].1));
            assert!(cells[0].0 < 1e-6 && cells[0].1 == 0, "{:?}", cells[0]);
            for (away, level) in cells {
                let expected = match away {
                    a if a <= 3.0 => 0,
                    a if a <= 11.0 => 1,
                    _ => grid.coarsest(),
                };
                assert_eq!(level, expected, "{away}°");
            }
        }
    }
}
