//! Which directions stand for a cell when its worth to an eye is added up?

use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::perception::glance::Glance;
use crate::units::{Cpd, Ppd, Radians};
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;
use crate::view::frustum::Frustum;
use core::f64::consts::FRAC_PI_2;
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// Places of a cell on each axis, for its worth.
const ACROSS: u32 = 3;
/// Places are at most this far apart where losses are summed up, in degrees: the fovea's radius;
/// there are at most so many on each axis.
pub(crate) const APART_DEG: f64 = 2.5;
const MOST_ACROSS: u32 = 12;

/// One place, standing for a part of its cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellPlace {
    pub(crate) direction: DVec3,
    /// Content pixels of the finest level per degree.
    pub(crate) ppd: Ppd,
    /// Solid angle of the part, in square degrees.
    pub(crate) area_deg2: f64,
}

/// A cell and its places.
#[derive(Clone, Debug)]
pub(crate) struct CellPlaces {
    pub(crate) cell: Tile,
    pub(crate) places: Vec<CellPlace>,
    /// A cone round all of them: its axis, and the sine of its half angle, of a quarter turn at
    /// most.
    cone: (DVec3, f64),
}

impl CellPlaces {
    /// Its places, as few as do.
    pub(crate) fn new(grid: &TileGrid, cell: Tile) -> Self {
        Self::with(grid, cell, ACROSS)
    }

    /// Its places, near to each other.
    pub(crate) fn dense(grid: &TileGrid, cell: Tile) -> Self {
        let side = grid.covered(cell).into_iter().max().unwrap_or(0);
        let middle = grid
            .surface
            .ppd(grid.surface.size.map(|side| f64::from(side) / 2.0));
        let across = f64::from(side) / middle.0 / APART_DEG;
        Self::with(
            grid,
            cell,
            (across.ceil() as u32).clamp(ACROSS, MOST_ACROSS),
        )
    }

    fn with(grid: &TileGrid, cell: Tile, across: u32) -> Self {
        let (from, size) = (grid.origin(cell), grid.covered(cell));
        let surface = &grid.surface;
        let at = |x: f64, y: f64| {
            let place = [
                f64::from(from[0]) + x * f64::from(size[0]),
                f64::from(from[1]) + y * f64::from(size[1]),
            ];
            let face = u32::from(cell.face);
            (
                surface.direction(face, place),
                surface.ppd(place),
                surface.shape(place),
            )
        };
        let share = 1.0 / f64::from(across * across);
        let pixels = f64::from(size[0]) * f64::from(size[1]);
        let middle = |step: u32| (f64::from(step) + 0.5) / f64::from(across);
        let places = (0..across * across).map(|k| {
            let (direction, ppd, shape) = at(middle(k % across), middle(k / across));
            // Away from the face's axis a pixel fills a smaller solid angle: cos³.
            let cos = surface.foreshortening(u32::from(cell.face), direction);
            let area_deg2 = pixels * share / (ppd.0 * ppd.0) * cos * shape;
            CellPlace {
                direction,
                ppd,
                area_deg2,
            }
        });
        let places: Vec<CellPlace> = places.collect();
        Self {
            cell,
            cone: cone_round(&places),
            places,
        }
    }
}

/// A cone that holds all places: its axis, and the sine of its half angle, of a quarter turn at
/// most.
fn cone_round(places: &[CellPlace]) -> (DVec3, f64) {
    let sum: DVec3 = places.iter().map(|place| place.direction).sum();
    let axis = sum.normalize_or(DVec3::NEG_Z);
    let angles = places
        .iter()
        .map(|place| angle_between(axis, place.direction).0);
    (axis, libm::sin(angles.fold(0.0, f64::max).min(FRAC_PI_2)))
}

/// All cells of a grid.
pub(crate) type Cells = Arc<[CellPlaces]>;

/// The places of all cells of one grid, made when first asked for: the same for all viewers.
#[derive(Debug, Default)]
pub struct SharedPlaces {
    few: OnceLock<Cells>,
    dense: OnceLock<Cells>,
}

impl SharedPlaces {
    /// As few places of each cell as do.
    pub(crate) fn few(&self, grid: &TileGrid) -> Cells {
        Arc::clone(self.few.get_or_init(|| {
            let cells = grid.tiles_of(0).map(|cell| CellPlaces::new(grid, cell));
            cells.collect()
        }))
    }

    /// Places of each cell near to each other.
    pub(crate) fn dense(&self, grid: &TileGrid) -> Cells {
        Arc::clone(self.dense.get_or_init(|| {
            let cells = grid.tiles_of(0).map(|cell| CellPlaces::dense(grid, cell));
            cells.collect()
        }))
    }
}

/// What a view shows of places; without one, all of them.
pub(crate) struct Sighted<'a> {
    view: Option<(&'a EyeView, Frustum)>,
}

impl<'a> Sighted<'a> {
    /// What is in view; what is outside has no worth.
    pub(crate) fn new(glance: &'a Glance) -> Self {
        Self::up_to(glance, Radians(0.0))
    }

    /// What is in view, or at most a margin outside it.
    pub(crate) fn up_to(glance: &'a Glance, margin: Radians) -> Self {
        let view = glance.view.as_ref();
        Self {
            view: view.map(|view| (view, Frustum::new(view, margin))),
        }
    }

    /// Those of a cell's places that are in view.
    pub(crate) fn places<'b>(
        &'b self,
        cell: &'b CellPlaces,
    ) -> impl Iterator<Item = &'b CellPlace> {
        let in_view = |direction| match &self.view {
            Some((_, sight)) => sight.reaches(direction),
            None => true,
        };
        let (axis, sine) = cell.cone;
        let sight = self.view.as_ref().map(|(_, sight)| sight);
        let is_missed = sight.is_some_and(|it| it.is_surely_missed(axis, sine) == Some(true));
        let places = if is_missed { &[] } else { &cell.places[..] };
        places.iter().filter(move |place| in_view(place.direction))
    }

    /// Highest frequency that the display shows there.
    pub(crate) fn display_limit(&self, place: &CellPlace) -> Cpd {
        let ppd = self.view.as_ref().map_or(f64::INFINITY, |(view, _)| {
            let ppd = view.ppd_towards(place.direction);
            view.seen_ppd(ppd, place.direction).0
        });
        Cpd(ppd / 2.0)
    }

    /// Level-0 pixels on a side that one pixel of the display covers there; 1 without a display.
    pub(crate) fn footprint(&self, place: &CellPlace) -> f64 {
        let view = self.view.as_ref();
        view.map_or(1.0, |(view, _)| view.footprint(place.ppd, place.direction))
    }

    /// A place as it appears to the eye.
    pub(crate) fn seen(&self, place: &CellPlace) -> CellPlace {
        let Some((view, _)) = &self.view else {
            return *place;
        };
        let ppd = view.seen_ppd(place.ppd, place.direction);
        let closer = place.ppd.0 / ppd.0;
        CellPlace {
            ppd,
            area_deg2: place.area_deg2 * closer * closer,
            ..*place
        }
    }

    /// Pixels of the display that show a place; without one, its square degrees.
    pub(crate) fn pixels(&self, place: &CellPlace) -> f64 {
        let Some((view, _)) = &self.view else {
            return place.area_deg2;
        };
        let ppd = view.ppd_towards(place.direction).0;
        // Away from the view's axis a pixel fills a smaller solid angle: cos³, of which cos² is in
        // the density across the radius.
        let depth = place.direction.dot(view.axes.forward).max(1e-3);
        place.area_deg2 * ppd * ppd / depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::video::grid::tile_grid::Cut;
    use crate::units::Radians;
    use crate::view::surface::{Mapping, Screen, Surface};

    fn square_degrees(grid: &TileGrid) -> f64 {
        let cells = grid.tiles_of(0).map(|cell| CellPlaces::new(grid, cell));
        let places = cells.flat_map(|cell| cell.places);
        places.map(|place| place.area_deg2).sum()
    }

    #[test]
    fn the_places_of_a_sphere_cover_it() {
        let sphere = 4.0 * core::f64::consts::PI * Radians(1.0).to_degrees().powi(2);
        for mapping in [Mapping::Gnomonic, Mapping::EquiAngular] {
            let surface = Surface::cube(1024).mapped(mapping);
            let grid = TileGrid::new(surface, Cut::Tile(128), 4, 2).unwrap();
            assert!((square_degrees(&grid) / sphere - 1.0).abs() < 0.01);
        }
        for size in [[2048, 1024], [1500, 1000]] {
            let grid = TileGrid::new(Surface::equirect(size), Cut::Tile(128), 4, 2).unwrap();
            assert!((square_degrees(&grid) / sphere - 1.0).abs() < 0.01);
        }
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
