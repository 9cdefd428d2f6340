//! What surrounds the one face of flat content? Twin of `shaders/shared/plane.wgsl`.

use super::lattice::{Axis, Tap};
use super::screen::{Seen, display_footprint};
use super::tiles::{Plane, TwinTiles, fetch};
use glam::{Mat3, Vec2, Vec3Swizzles};

pub(super) fn seen_by(tiles: &TwinTiles, content_from_pixel: &Mat3, pixel: Vec2) -> Seen {
    let here = *content_from_pixel * pixel.extend(1.0);
    let right = here + content_from_pixel.x_axis;
    let down = here + content_from_pixel.y_axis;
    let place = here.xy() / here.z;
    let inside = here.z > 0.0 && place.cmpge(Vec2::ZERO).all() && place.cmplt(tiles.size()).all();
    let footprint = display_footprint(right.xy() / right.z - place, down.xy() / down.z - place);
    Seen {
        inside,
        face: 0,
        place,
        footprint,
    }
}

pub(super) fn widened_across(known: f32) -> f32 {
    known
}

pub(super) fn beyond_edges(axis: &Axis) -> Vec2 {
    Vec2::splat(axis.pitch)
}

pub(super) fn fetch_tap(
    tiles: &TwinTiles,
    plane: Plane,
    level: u32,
    face: u32,
    [x, y]: [Tap; 2],
) -> Vec2 {
    fetch(tiles, plane, level, face, Vec2::new(x.within, y.within))
}
