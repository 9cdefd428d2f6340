//! What surrounds the one face of flat content? Twin of `shaders/shared/plane.wgsl`.

use crate::twin::shared::lattice::{Axis, Bracket, tap_of, weight_of};
use crate::twin::shared::screen::{SeenPlace, View, display_footprint};
use crate::twin::shared::tiles::{Plane, TwinTiles, fetch};
use glam::{Vec2, Vec3Swizzles};

pub(crate) fn seen_by(tiles: &TwinTiles, view: &View, pixel: Vec2) -> SeenPlace {
    let here = view.content_from_pixel * pixel.extend(1.0);
    let right = here + view.content_from_pixel.x_axis;
    let down = here + view.content_from_pixel.y_axis;
    let place = here.xy() / here.z;
    let inside = here.z > 0.0 && place.cmpge(Vec2::ZERO).all() && place.cmplt(tiles.size()).all();
    let footprint = display_footprint(right.xy() / right.z - place, down.xy() / down.z - place);
    SeenPlace {
        inside,
        face: view.first_face,
        place,
        footprint,
    }
}

pub(crate) fn seen_apart(apart: Vec2) -> Vec2 {
    apart
}

pub(crate) fn widened_across(known: f32) -> f32 {
    known
}

pub(crate) fn beyond_edges(axis: &Axis) -> Vec2 {
    Vec2::splat(axis.pitch)
}

pub(crate) fn beside_edge(tiles: &TwinTiles, face: u32, place: Vec2) -> (u32, Vec2) {
    (face, place.clamp(Vec2::splat(0.5), tiles.size() - 0.5))
}

pub(crate) fn corner_sample(
    tiles: &TwinTiles,
    corner: u32,
    plane: Plane,
    level: u32,
    face: u32,
    [x, y]: [&Bracket; 2],
) -> Vec2 {
    let right = corner & 1 != 0;
    let below = corner & 2 != 0;
    let within = Vec2::new(tap_of(x, right).within, tap_of(y, below).within);
    fetch(tiles, plane, level, face, within) * (weight_of(x, right) * weight_of(y, below))
}
