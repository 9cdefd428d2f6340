//! Which cells touch a cell on the sphere?

use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::view::surface::Projection;

/// How far beyond its border a neighbour is looked for, in level-0 pixels: outwards so little that
/// no cell is stepped over, along the border enough to leave the corner.
const OUT: f64 = 1e-6;
const ALONG: f64 = 1e-3;

/// The cells that share an edge or a corner with `cell`, without itself: eight inside a face, fewer
/// at the border of flat content or of a face without a neighbour, and seven in the corner of a
/// cube face, where three faces meet. At a pole of an equirectangular picture, where all columns
/// meet, it is the whole row.
#[must_use]
pub(crate) fn neighbours(grid: &TileGrid, cell: Tile) -> Vec<Tile> {
    let from = grid.origin(cell).map(f64::from);
    let size = grid.covered(cell).map(f64::from);
    let mut found = Vec::with_capacity(8);
    found.extend(round_a_pole(grid, cell));
    for step in [
        [-1, -1],
        [0, -1],
        [1, -1],
        [-1, 0],
        [1, 0],
        [-1, 1],
        [0, 1],
        [1, 1],
    ] {
        for beyond in [[OUT, ALONG], [ALONG, OUT]] {
            let place = [0, 1].map(|k| match step[k] {
                -1 => from[k] - beyond[k],
                0 => from[k] + size[k] / 2.0,
                _ => from[k] + size[k] + beyond[k],
            });
            let next = cell_beyond(grid, cell.face, place);
            if let Some(next) = next.filter(|next| *next != cell && !found.contains(next)) {
                found.push(next);
            }
        }
    }
    found
}

/// The other cells of a row that touches a pole: all of them meet there.
fn round_a_pole(grid: &TileGrid, cell: Tile) -> impl Iterator<Item = Tile> + use<> {
    let [columns, rows] = grid.cells();
    let row = u32::from(cell.y);
    let meets = !grid.surface.is_of_planes() && (row == 0 || row + 1 == rows);
    let columns = if meets { 0..columns } else { 0..0 };
    let others = columns.map(move |x| Tile {
        x: x as u16,
        ..cell
    });
    others.filter(move |other| *other != cell)
}

/// The cell at a place that may lie beyond the border of its face.
fn cell_beyond(grid: &TileGrid, face: u8, place: [f64; 2]) -> Option<Tile> {
    let surface = &grid.surface;
    let place = surface.closed(place);
    let inside = (0..2).all(|k| place[k] >= 0.0 && place[k] < f64::from(surface.size[k]));
    if inside {
        return Some(grid.cell_at(u32::from(face), place));
    }
    if surface.projection == Projection::Flat {
        return None;
    }
    let (beside, place) = surface.locate(surface.direction(u32::from(face), place))?;
    // What is located is the left eye's.
    let first = u32::from(face) / surface.faces_of_an_eye() * surface.faces_of_an_eye();
    Some(grid.cell_at(first + beside, place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::video::grid::tile_grid::Cut;
    use crate::view::surface::{Screen, Surface};

    #[test]
    fn a_corner_of_the_cube_has_seven_neighbours_and_any_other_cell_eight() {
        let grid = TileGrid::new(Surface::cube(3000), Cut::Grid([4, 4]), 3, 4).unwrap();
        for cell in grid.tiles_of(0) {
            let corner = [cell.x, cell.y].iter().all(|&k| k == 0 || k == 3);
            assert_eq!(
                neighbours(&grid, cell).len(),
                if corner { 7 } else { 8 },
                "{cell:?}"
            );
        }
    }

    #[test]
    fn a_panorama_without_poles_closes_round_the_horizon_alone() {
        let panorama = Surface::cube(3000).without_poles().for_two_eyes();
        let grid = TileGrid::new(panorama, Cut::Grid([4, 4]), 3, 4).unwrap();
        for cell in grid.tiles_of(0) {
            let next = neighbours(&grid, cell);
            let at_rim = cell.y == 0 || cell.y == 3;
            assert_eq!(next.len(), if at_rim { 5 } else { 8 }, "{cell:?}");
            let same_eye = |other: &Tile| other.face / 4 == cell.face / 4;
            assert!(next.iter().all(same_eye), "{cell:?}");
        }
    }

    #[test]
    fn at_the_seam_of_a_sphere_columns_touch_and_at_its_poles_whole_rows() {
        let sphere = Surface::equirect([2048, 1024]).for_two_eyes();
        let grid = TileGrid::new(sphere, Cut::Tile(128), 4, 2).unwrap();
        assert_eq!(grid.cells(), [16, 8]);
        for cell in grid.tiles_of(0) {
            let next = neighbours(&grid, cell);
            // At a pole the other fifteen, and three of the row below.
            let expected = if [0, 7].contains(&cell.y) { 18 } else { 8 };
            assert_eq!(next.len(), expected, "{cell:?}");
            assert!(next.iter().all(|other| other.face == cell.face));
            let beside = Tile {
                x: (cell.x + 1) % 16,
                ..cell
            };
            assert!(next.contains(&beside), "{cell:?}");
        }
    }

    #[test]
    fn touching_is_mutual() {
        let flat = Surface::flat([1000, 600], Screen::default());
        let panorama = Surface::cube(640).without_poles().for_two_eyes();
        let sphere = Surface::equirect([1000, 600]);
        for surface in [Surface::cube(640), flat, panorama, sphere] {
            let grid = TileGrid::new(surface, Cut::Tile(128), 3, 2).unwrap();
            for cell in grid.tiles_of(0) {
                for next in neighbours(&grid, cell) {
                    assert!(neighbours(&grid, next).contains(&cell), "{cell:?} {next:?}");
                }
            }
        }
    }

    #[test]
    fn a_corner_of_flat_content_has_three_neighbours() {
        let flat = Surface::flat([1000, 600], Screen::default());
        let grid = TileGrid::new(flat, Cut::Tile(128), 3, 2).unwrap();
        assert_eq!(neighbours(&grid, grid.tile_at(0, 0)).len(), 3);
    }
}
