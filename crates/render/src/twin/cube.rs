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

const TOUCHES_HIGH: u32 = 0x00f0_19d5;

fn touches_high(face: u32, k: u32, high: u32) -> bool {
    (TOUCHES_HIGH >> (face * 4 + k * 2 + high)) & 1 != 0
}

struct Neighbour {
    face: u32,
    place: Vec2,
}

fn neighbour(tiles: &TwinTiles, face: u32, place: Vec2, k: u32, high: bool) -> Neighbour {
    let axes = axes_of(face);
    let tangent = place * 2.0 / tiles.size() - 1.0;
    let across = if k == 1 { tangent.y } else { tangent.x };
    let along = if k == 1 {
        axes.right * tangent.x
    } else {
        axes.down * tangent.y
    };
    let side = if high { 1.0 } else { -1.0 };
    let outward = if k == 1 { axes.down } else { axes.right } * side;
    let depth = across * side - 1.0;
    let beside = cube_face(outward);
    let ray = outward + axes.forward * (1.0 - depth) + along;
    Neighbour {
        face: beside,
        place: place_of(tiles, tangent_of(&axes_of(beside), ray)),
    }
}

pub(super) fn widened_across(tiles: &TwinTiles, face: u32, place: Vec2, known: f32) -> f32 {
    let reach = tiles.params.growth * (tiles.params.coarsest_scale - known);
    let near_low = place.cmplt(Vec2::splat(reach));
    let near_high = (tiles.size() - place).cmplt(Vec2::splat(reach));
    let mut borders = u32::from(near_low.x)
        | u32::from(near_high.x) << 1
        | u32::from(near_low.y) << 2
        | u32::from(near_high.y) << 3;
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

pub(super) fn beyond_edges(face: u32, axis: &Axis, k: usize) -> Vec2 {
    let last = tap_at(
        axis,
        axis.last_segment,
        samples_in(axis, axis.last_segment) - 1,
    );
    let low_depth = tap_at(axis, 0, 0).centre;
    let high_depth = axis.size - last.centre;
    let touches = |high| touches_high(face, k as u32, high);
    let low = if touches(0) { high_depth } else { low_depth };
    let high = if touches(1) { high_depth } else { low_depth };
    Vec2::new(low, high)
}

pub(super) fn fetch_tap(
    tiles: &TwinTiles,
    plane: Plane,
    level: u32,
    face: u32,
    [x, y]: [Tap; 2],
) -> Vec2 {
    let mut parts = u32::from(x.beyond != 0) | u32::from(y.beyond != 0) << 1;
    let count = if parts == 3 { 3.0 } else { 1.0 };
    parts |= if parts == 0 || parts == 3 { 4 } else { 0 };
    let half = 0.5 * tiles.size();
    let beyond = half + (half + 0.5) * Vec2::new(x.beyond as f32, y.beyond as f32);
    let mut sum = Vec2::ZERO;
    while parts != 0 {
        let part = parts & (!parts + 1);
        parts ^= part;
        let mut at = Neighbour {
            face,
            place: Vec2::new(x.within, y.within),
        };
        if part != 4 {
            let over_x = part == 1;
            let place = if over_x {
                Vec2::new(beyond.x, y.centre)
            } else {
                Vec2::new(x.centre, beyond.y)
            };
            let high = if over_x { x.beyond } else { y.beyond } > 0;
            at = neighbour(tiles, face, place, u32::from(!over_x), high);
        }
        sum += fetch(tiles, plane, level, at.face, at.place);
    }
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_touching_borders_follows_from_the_axes() {
        for face in 0..6 {
            let axes = axes_of(face);
            for (k, axis) in [axes.right, axes.down].into_iter().enumerate() {
                for high in 0..2 {
                    let outward = if high == 1 { axis } else { -axis };
                    let beside = axes_of(cube_face(outward));
                    let back = axes.forward.dot(beside.right) + axes.forward.dot(beside.down);
                    assert_eq!(touches_high(face, k as u32, high), back > 0.0);
                }
            }
        }
    }
}
