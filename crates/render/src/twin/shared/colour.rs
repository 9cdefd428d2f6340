//! Which red, green and blue do Y, U and V make? Twin of `shaders/shared/colour.wgsl`.

use super::tiles::TwinTiles;
use glam::{Vec3, Vec4};

pub(crate) fn rgb_from_yuv(tiles: &TwinTiles, yuv: Vec3) -> Vec3 {
    let code = yuv.extend(1.0);
    let red = Vec4::from(tiles.params.rgb_from_yuv[0]).dot(code);
    let green = Vec4::from(tiles.params.rgb_from_yuv[1]).dot(code);
    let blue = Vec4::from(tiles.params.rgb_from_yuv[2]).dot(code);
    Vec3::new(red, green, blue).clamp(Vec3::ZERO, Vec3::ONE)
}
