//! What surrounds a face of the cube? Twin of `shaders/shared/cube.wgsl`.

use super::footprint::widened;
use super::lattice::{Axis, Tap, samples_in, tap_at};
use super::screen::{Seen, display_footprint};
use super::tiles::{Plane, TwinTiles, fetch};
use foveal_core::view::surface::CUBE_FACES;
use glam::{Mat3, Vec2, Vec3};

struct Axes {
    forward: Vec3,
    right: Vec3,
    down: Vec3,
}

fn axes_of(face: u32) -> Axes {
    let axes = CUBE_FACES[face as usize];
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
    (tangent + 1.0) * 0.5 * tiles.size()
}

pub(super) fn seen_by(tiles: &TwinTiles, content_from_pixel: &Mat3, pixel: Vec2) -> Seen {
    let ray = *content_from_pixel * pixel.extend(1.0);
    let face = cube_face(ray);
    let axes = axes_of(face);
    let place = place_of(tiles, tangent_of(&axes, ray));
    let right = place_of(tiles, tangent_of(&axes, ray + content_from_pixel.x_axis));
    let down = place_of(tiles, tangent_of(&axes, ray + content_from_pixel.y_axis));
    Seen {
        inside: true,
        face,
        place,
        footprint: display_footprint(right - place, down - place),
    }
}

struct Neighbour {
    face: u32,
    place: Vec2,
    high: bool,
}

fn neighbour(tiles: &TwinTiles, face: u32, place: Vec2, k: usize, high: bool) -> Neighbour {
    let axes = axes_of(face);
    let tangent = place * 2.0 / tiles.size() - 1.0;
    let side = if high { 1.0 } else { -1.0 };
    let outward = if k == 1 { axes.down } else { axes.right } * side;
    let along = if k == 1 { axes.right } else { axes.down } * tangent[1 - k];
    let depth = tangent[k] * side - 1.0;
    let beside = cube_face(outward);
    let beside_axes = axes_of(beside);
    let ray = outward + axes.forward * (1.0 - depth) + along;
    let back = axes.forward.dot(beside_axes.right) + axes.forward.dot(beside_axes.down);
    Neighbour {
        face: beside,
        place: place_of(tiles, tangent_of(&beside_axes, ray)),
        high: back > 0.0,
    }
}

pub(super) fn widened_across(tiles: &TwinTiles, face: u32, place: Vec2, known: f32) -> f32 {
    let mut widest = known;
    for border in 0..4 {
        let k = border / 2;
        let high = border % 2 == 1;
        let depth = if high {
            tiles.size()[k] - place[k]
        } else {
            place[k]
        };
        if depth < tiles.params.growth * (tiles.params.coarsest_scale - widest) {
            let beside = neighbour(tiles, face, place, k, high);
            widest = widened(tiles, beside.face, beside.place, widest);
        }
    }
    widest
}

pub(super) fn beyond_edges(tiles: &TwinTiles, face: u32, axis: &Axis, k: usize) -> Vec2 {
    let count = samples_in(axis, axis.last_segment);
    let last = tap_at(axis, axis.last_segment, count - 1);
    let depth = Vec2::new(tap_at(axis, 0, 0).centre, axis.size - last.centre);
    let middle = 0.5 * tiles.size();
    let low = neighbour(tiles, face, middle, k, false).high;
    let high = neighbour(tiles, face, middle, k, true).high;
    Vec2::new(
        if low { depth.y } else { depth.x },
        if high { depth.y } else { depth.x },
    )
}

pub(super) fn fetch_tap(
    tiles: &TwinTiles,
    plane: Plane,
    level: u32,
    face: u32,
    [x, y]: [Tap; 2],
) -> Vec2 {
    let within = Vec2::new(x.within, y.within);
    if x.beyond == 0 && y.beyond == 0 {
        return fetch(tiles, plane, level, face, within);
    }
    let mut sum = Vec2::ZERO;
    let mut count = 0.0;
    if x.beyond != 0 {
        let edge = if x.beyond > 0 {
            tiles.size().x + 0.5
        } else {
            -0.5
        };
        let beside = neighbour(tiles, face, Vec2::new(edge, y.centre), 0, x.beyond > 0);
        sum += fetch(tiles, plane, level, beside.face, beside.place);
        count += 1.0;
    }
    if y.beyond != 0 {
        let edge = if y.beyond > 0 {
            tiles.size().y + 0.5
        } else {
            -0.5
        };
        let beside = neighbour(tiles, face, Vec2::new(x.centre, edge), 1, y.beyond > 0);
        sum += fetch(tiles, plane, level, beside.face, beside.place);
        count += 1.0;
    }
    if count > 1.5 {
        sum += fetch(tiles, plane, level, face, within);
        count += 1.0;
    }
    sum / count
}
