//! Where on a face does an angle lie? Twin of `shaders/shared/mapping.wgsl`.

use super::tiles::TwinTiles;
use glam::Vec2;
use std::f32::consts::FRAC_PI_4;

const GNOMONIC: u32 = 0;

pub(crate) fn arc_tangent(x: Vec2) -> Vec2 {
    let s = x * x;
    let high = -0.075_289_64 + s * (0.042_909_614 + s * (-0.016_165_737 + s * 0.002_866_225_7));
    let middle = -0.142_089 + s * (0.106_562_64 + s * high);
    let low = -0.333_331_45 + s * (0.199_935_51 + s * middle);
    x + x * s * low
}

pub(crate) fn place_on_face(tiles: &TwinTiles, tangent: Vec2) -> Vec2 {
    if tiles.params.mapping == GNOMONIC {
        return tangent;
    }
    let steep = tangent.abs().cmpgt(Vec2::ONE);
    let x = Vec2::select(steep, 1.0 / tangent, tangent);
    let place = arc_tangent(x) / FRAC_PI_4;
    Vec2::select(steep, 2.0 * tangent.signum() - place, place)
}

pub(crate) fn tangent_on_face(tiles: &TwinTiles, place: f32) -> f32 {
    if tiles.params.mapping == GNOMONIC {
        return place;
    }
    let steep = place.abs() > 1.0;
    let x = FRAC_PI_4
        * if steep {
            2.0 * place.signum() - place
        } else {
            place
        };
    let s = x * x;
    let high = 0.024_565_09 + s * (0.002_900_525 + s * 0.009_516_809);
    let low = 0.333_331_4 + s * (0.133_392_4 + s * (0.053_374_06 + s * high));
    let tangent = x + x * s * low;
    if steep { 1.0 / tangent } else { tangent }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};
    use foveal_core::view::picture::{Colour, Matrix};
    use foveal_core::view::surface::{Mapping, Surface};

    #[test]
    fn places_and_tangents_are_those_of_core() {
        for mapping in [Mapping::Gnomonic, Mapping::EquiAngular] {
            let surface = Surface::cube(64).mapped(mapping);
            let grid = TileGrid::new(surface, Cut::Tile(16), 3, 2).unwrap();
            let colour = Colour {
                matrix: Matrix::Bt709,
                full_range: true,
                chroma_left: false,
            };
            let tiles = TwinTiles::new(&grid, colour);
            for step in -400..=400 {
                let place = step as f32 / 400.0 * 1.5;
                let tangent = tangent_on_face(&tiles, place);
                let exact = mapping.tangent(f64::from(place));
                assert!((f64::from(tangent) / exact - 1.0).abs() < 4e-7 || step == 0);
                let back = place_on_face(&tiles, Vec2::splat(tangent)).x;
                assert!((back - place).abs() < 4e-7, "{mapping:?} {place} {back}");
            }
        }
    }
}
