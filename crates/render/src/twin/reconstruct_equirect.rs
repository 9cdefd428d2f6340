//! Which colour does a pixel of a view into an equirectangular picture get? Twin of
//! `shaders/reconstruct_equirect.wgsl`.

use super::shared::equirect::seen_by;
use super::shared::picture::picture_at;
use super::shared::screen::View;
use super::shared::tiles::TwinTiles;
use glam::{Vec2, Vec4};

pub(super) fn reconstruct_equirect(tiles: &TwinTiles, view: &View, position: Vec2) -> Vec4 {
    let seen = seen_by(tiles, view, position);
    picture_at(tiles, seen.face, seen.place, seen.footprint).extend(1.0)
}
