//! What surrounds a face of the cube? Twin of `shaders/shared/cube.wgsl`.

use crate::twin::shared::lattice::{
    Axis, Bracket, axis_of, bracket, samples_in, tap_at, tap_of, weight_of,
};
use crate::twin::shared::mapping::{place_on_face, tangent_on_face};
use crate::twin::shared::screen::{SeenPlace, View, display_footprint};
use crate::twin::shared::tiles::{Plane, TwinTiles, fetch};
use crate::twin::shared::widened::widened;
use foveal_core::view::surface::CUBE_FACES;
use glam::{Vec2, Vec3};

struct Axes {
    forward: Vec3,
    right: Vec3,
    down: Vec3,
}

fn side_of(tiles: &TwinTiles, face: u32) -> u32 {
    let faces = tiles.params.faces_of_an_eye;
    if face >= faces { face - faces } else { face }
}

fn has_beside(tiles: &TwinTiles, k: u32) -> bool {
    k == 0 || tiles.params.faces_of_an_eye == 6
}

fn axes_of(tiles: &TwinTiles, face: u32) -> Axes {
    let axes = CUBE_FACES[side_of(tiles, face) as usize];
    Axes {
        forward: axes.forward.as_vec3(),
        right: axes.right.as_vec3(),
        down: axes.down.as_vec3(),
    }
}

fn cube_face(ray: Vec3) -> u32 {
    let size = ray.abs();
    if size.z >= size.x && size.z >= size.y {
        return if ray.z < 0.0 { 0 } else { 2 };
    }
    if size.x >= size.y {
        return if ray.x > 0.0 { 1 } else { 3 };
    }
    if ray.y > 0.0 { 4 } else { 5 }
}

fn tangent_of(axes: &Axes, ray: Vec3) -> Vec2 {
    Vec2::new(ray.dot(axes.right), ray.dot(axes.down)) / ray.dot(axes.forward)
}

fn place_of(tiles: &TwinTiles, tangent: Vec2) -> Vec2 {
    (place_on_face(tiles, tangent) + 1.0) * 0.5 * tiles.size()
}

pub(crate) fn seen_by(tiles: &TwinTiles, view: &View, pixel: Vec2) -> SeenPlace {
    let ray = view.content_from_pixel * pixel.extend(1.0);
    let face = cube_face(ray);
    let axes = axes_of(tiles, face.min(tiles.params.faces_of_an_eye - 1));
    let place = place_of(tiles, tangent_of(&axes, ray));
    let right = place_of(
        tiles,
        tangent_of(&axes, ray + view.content_from_pixel.x_axis),
    );
    let down = place_of(
        tiles,
        tangent_of(&axes, ray + view.content_from_pixel.y_axis),
    );
    let footprint = display_footprint(right - place, down - place);
    SeenPlace {
        inside: face < tiles.params.faces_of_an_eye,
        face: view.first_face + face,
        place,
        footprint,
    }
}

const TOUCHES_HIGH: u32 = 0x00f0_19d5;

fn touches_high(tiles: &TwinTiles, face: u32, k: u32, high: u32) -> bool {
    (TOUCHES_HIGH >> (side_of(tiles, face) * 4 + k * 2 + high)) & 1 != 0
}

struct Neighbour {
    face: u32,
    place: Vec2,
    along: usize,
}

fn neighbour(tiles: &TwinTiles, face: u32, place: Vec2, k: u32, high: bool) -> Neighbour {
    let axes = axes_of(tiles, face);
    let on_face = place * 2.0 / tiles.size() - 1.0;
    let across = if k == 1 { on_face.y } else { on_face.x };
    let edge = if k == 1 { axes.right } else { axes.down };
    let along = if k == 1 { on_face.x } else { on_face.y };
    let side = if high { 1.0 } else { -1.0 };
    let outward = if k == 1 { axes.down } else { axes.right } * side;
    let depth = across * side - 1.0;
    let beside = cube_face(outward);
    let beside_axes = axes_of(tiles, beside);
    let ray = outward
        + axes.forward * tangent_on_face(tiles, 1.0 - depth)
        + edge * tangent_on_face(tiles, along);
    let runs_right = edge.dot(beside_axes.right).abs() > 0.5;
    let first = face - side_of(tiles, face);
    let place_beside = place_of(tiles, tangent_of(&beside_axes, ray));
    Neighbour {
        face: first + beside,
        place: place_beside,
        along: if runs_right { 0 } else { 1 },
    }
}

pub(crate) fn seen_apart(apart: Vec2) -> Vec2 {
    apart
}

pub(crate) fn widened_across(tiles: &TwinTiles, face: u32, place: Vec2, known: f32) -> f32 {
    let reach = tiles.params.growth * (tiles.params.coarsest_scale - known);
    let near_low = place.cmplt(Vec2::splat(reach));
    let near_high = (tiles.size() - place).cmplt(Vec2::splat(reach));
    let mut borders = u32::from(near_low.x)
        | u32::from(near_high.x) << 1
        | u32::from(near_low.y) << 2
        | u32::from(near_high.y) << 3;
    borders = if has_beside(tiles, 1) {
        borders
    } else {
        borders & 3
    };
    let mut widest = known;
    while borders != 0 {
        let border = borders & (!borders + 1);
        borders ^= border;
        let high = border & 10 != 0;
        let beside = neighbour(tiles, face, place, u32::from(border > 2), high);
        widest = widened(tiles, beside.face, beside.place, widest);
    }
    widest
}

pub(crate) fn beside_edge(tiles: &TwinTiles, face: u32, place: Vec2) -> (u32, Vec2) {
    let beyond = (-place).max(place - tiles.size());
    let k = u32::from(beyond.y > beyond.x && has_beside(tiles, 1));
    let depth = if k == 1 { beyond.y } else { beyond.x };
    let mut beside = (face, place);
    if depth > 0.0 {
        let high = if k == 1 { place.y } else { place.x } > 0.0;
        let found = neighbour(tiles, face, place, k, high);
        beside = (found.face, found.place);
    }
    (
        beside.0,
        beside.1.clamp(Vec2::splat(0.5), tiles.size() - 0.5),
    )
}

pub(crate) fn beyond_edges(tiles: &TwinTiles, face: u32, axis: &Axis, k: usize) -> Vec2 {
    let last = tap_at(
        axis,
        axis.last_segment,
        samples_in(axis, axis.last_segment) - 1,
    );
    let low_depth = tap_at(axis, 0, 0).centre;
    let high_depth = axis.size - last.centre;
    let touches = |high| touches_high(tiles, face, k as u32, high);
    let low = if touches(0) { high_depth } else { low_depth };
    let high = if touches(1) { high_depth } else { low_depth };
    Vec2::new(low, high)
}

fn fetch_beside(
    tiles: &TwinTiles,
    plane: Plane,
    level: u32,
    beside: &Neighbour,
    high: bool,
) -> Vec2 {
    let axis = axis_of(tiles, plane, level, beside.along);
    let runs_right = beside.along == 0;
    let at = if runs_right {
        beside.place.x
    } else {
        beside.place.y
    };
    let between = bracket(&axis, at, Vec2::splat(axis.pitch));
    let tap = tap_of(&between, high).within;
    let place = if runs_right {
        Vec2::new(tap, beside.place.y)
    } else {
        Vec2::new(beside.place.x, tap)
    };
    fetch(tiles, plane, level, beside.face, place) * weight_of(&between, high)
}

pub(crate) fn corner_sample(
    tiles: &TwinTiles,
    corner: u32,
    (plane, level): (Plane, u32),
    face: u32,
    place: Vec2,
    [x, y]: [&Bracket; 2],
) -> Vec2 {
    let right = corner & 1 != 0;
    let below = corner & 2 != 0;
    let x_tap = tap_of(x, right);
    let y_tap = tap_of(y, below);
    let own = fetch(
        tiles,
        plane,
        level,
        face,
        Vec2::new(x_tap.within, y_tap.within),
    );
    let weight = Vec2::new(weight_of(x, right), weight_of(y, below));
    let over_x = x_tap.beyond != 0;
    let over_y = y_tap.beyond != 0 && has_beside(tiles, 1);
    if !over_x && !over_y {
        return own * (weight.x * weight.y);
    }
    let is_near_corner = (x.low.beyond != 0 || x.high.beyond != 0)
        && (y.low.beyond != 0 || y.high.beyond != 0)
        && has_beside(tiles, 1);
    let is_corner = over_x && over_y;
    let along = if is_near_corner {
        Vec2::new(x_tap.centre, y_tap.centre)
    } else {
        place
    };
    let half = 0.5 * tiles.size();
    let beyond = half + (half + 0.5) * Vec2::new(x_tap.beyond as f32, y_tap.beyond as f32);
    let mut part = if over_x { 0 } else { 2 };
    let mut end = if over_y { 4 } else { 2 };
    if !is_near_corner {
        part += u32::from(if over_x { below } else { right });
        end = part + 1;
    }
    let mut sum = if is_corner { own } else { Vec2::ZERO };
    while part < end {
        let is_x = part < 2;
        let at = if is_x {
            Vec2::new(beyond.x, along.y)
        } else {
            Vec2::new(along.x, beyond.y)
        };
        let high = if is_x { x_tap.beyond } else { y_tap.beyond } > 0;
        let beside = neighbour(tiles, face, at, u32::from(!is_x), high);
        sum += fetch_beside(tiles, plane, level, &beside, part & 1 != 0);
        part += 1;
    }
    if is_near_corner {
        return sum * (weight.x * weight.y / if is_corner { 3.0 } else { 1.0 });
    }
    sum * if over_x { weight.x } else { weight.y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};
    use foveal_core::view::picture::{Colour, Matrix};
    use foveal_core::view::surface::Surface;

    #[test]
    fn the_table_of_touching_borders_follows_from_the_axes_of_either_eye() {
        let surface = Surface::cube(64).for_two_eyes();
        let grid = TileGrid::new(surface, Cut::Tile(32), 2, 2).unwrap();
        let colour = Colour {
            matrix: Matrix::Bt709,
            full_range: true,
            chroma_left: false,
        };
        let tiles = TwinTiles::new(&grid, colour);
        for face in 0..12 {
            let axes = axes_of(&tiles, face);
            for (k, axis) in [axes.right, axes.down].into_iter().enumerate() {
                for high in 0..2 {
                    let outward = if high == 1 { axis } else { -axis };
                    let beside = axes_of(&tiles, cube_face(outward));
                    let back = axes.forward.dot(beside.right) + axes.forward.dot(beside.down);
                    assert_eq!(touches_high(&tiles, face, k as u32, high), back > 0.0);
                }
            }
        }
    }
}
