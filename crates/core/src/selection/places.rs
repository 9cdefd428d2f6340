//! Which directions stand for a cell when its worth to an eye is added up?

use crate::asset::tile_grid::{Tile, TileGrid};
use crate::units::Ppd;
use glam::DVec3;

/// Places of a cell on each axis.
const ACROSS: u32 = 3;

/// One place, standing for a part of its cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) direction: DVec3,
    /// Content pixels of the finest level per degree.
    pub(super) ppd: Ppd,
    /// Solid angle of the part, in square degrees.
    pub(super) area_deg2: f64,
}

/// A cell and its places.
#[derive(Clone, Debug)]
pub(super) struct CellPlaces {
    pub(super) cell: Tile,
    pub(super) places: Vec<Place>,
}

impl CellPlaces {
    pub(super) fn new(grid: &TileGrid, cell: Tile) -> Self {
        let (from, size) = (grid.origin(cell), grid.covered(cell));
        let at = |x: f64, y: f64| {
            let place = [
                f64::from(from[0]) + x * f64::from(size[0]),
                f64::from(from[1]) + y * f64::from(size[1]),
            ];
            let face = u32::from(cell.face);
            (grid.surface.direction(face, place), grid.surface.ppd(place))
        };
        let forward = grid.surface.axes(u32::from(cell.face)).forward;
        let share = 1.0 / f64::from(ACROSS * ACROSS);
        let pixels = f64::from(size[0]) * f64::from(size[1]);
        let middle = |step: u32| (f64::from(step) + 0.5) / f64::from(ACROSS);
        let places = (0..ACROSS * ACROSS).map(|k| {
            let (direction, ppd) = at(middle(k % ACROSS), middle(k / ACROSS));
            // Away from the face's axis a pixel fills a smaller solid angle: cos³.
            let cos = direction.dot(forward);
            let area_deg2 = pixels * share / (ppd.0 * ppd.0) * cos;
            Place {
                direction,
                ppd,
                area_deg2,
            }
        });
        Self {
            cell,
            places: places.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::tile_grid::Cut;
    use crate::units::Radians;
    use crate::view::surface::{Screen, Surface};

    fn square_degrees(grid: &TileGrid) -> f64 {
        let cells = grid.tiles_of(0).map(|cell| CellPlaces::new(grid, cell));
        let places = cells.flat_map(|cell| cell.places);
        places.map(|place| place.area_deg2).sum()
    }

    #[test]
    fn the_places_of_a_sphere_cover_it() {
        let grid = TileGrid::new(Surface::cube(1024), Cut::Tile(128), 4, 2).unwrap();
        let sphere = 4.0 * core::f64::consts::PI * Radians(1.0).to_degrees().powi(2);
        assert!((square_degrees(&grid) / sphere - 1.0).abs() < 0.01);
    }

    #[test]
    fn the_places_of_a_screen_cover_its_field_of_view() {
        let surface = Surface::flat([1920, 1080], Screen::default());
        let grid = TileGrid::new(surface, Cut::Tile(128), 4, 2).unwrap();
        // Solid angle of a rectangle (2a x 2b at distance 1): 4 asin(ab / sqrt((1+a²)(1+b²))).
        let [a, b] = surface.tangents;
        let solid = 4.0 * (a * b / ((1.0 + a * a) * (1.0 + b * b)).sqrt()).asin();
        let expected = solid * Radians(1.0).to_degrees().powi(2);
        assert!((square_degrees(&grid) / expected - 1.0).abs() < 0.01);
    }
}
