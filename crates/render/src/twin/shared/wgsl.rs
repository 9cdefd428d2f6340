//! What do the functions of WGSL itself give, as far as the passes call them?

use crate::image::RgbaImage;
use glam::{Vec2, Vec4};

/// WGSL's `mix`.
pub(crate) fn mix<T>(a: T, b: T, t: f32) -> T
where
    T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    a * (1.0 - t) + b * t
}

/// WGSL's `textureDimensions`.
pub(crate) fn size_of_picture(picture: &RgbaImage) -> Vec2 {
    let [columns, rows] = picture.size;
    Vec2::new(columns as f32, rows as f32)
}

/// WGSL's `textureLoad`, of the nearest texel inside.
pub(crate) fn texture_load(picture: &RgbaImage, texel: Vec2) -> Vec4 {
    let inside = texel.clamp(Vec2::ZERO, size_of_picture(picture) - 1.0);
    let [x, y] = inside.to_array().map(|k| k as u32);
    Vec4::from(picture.pixel([x, y]).map(|c| f32::from(c) / 255.0))
}

/// WGSL's `textureSampleLevel` of one level, clamped to the edge.
pub(crate) fn texture_sample(picture: &RgbaImage, place: Vec2) -> Vec4 {
    let at = place * size_of_picture(picture) - 0.5;
    let low = at.floor();
    let part = at - low;
    let texel = |x: f32, y: f32| texture_load(picture, low + Vec2::new(x, y));
    let above = mix(texel(0.0, 0.0), texel(1.0, 0.0), part.x);
    let below = mix(texel(0.0, 1.0), texel(1.0, 1.0), part.x);
    mix(above, below, part.y)
}

/// WGSL's `textureSampleLevel` between two levels.
pub(crate) fn texture_sample_level(levels: &[RgbaImage], place: Vec2, level: f32) -> Vec4 {
    let low = level.floor();
    let finer = texture_sample(&levels[low as usize], place);
    let coarser = levels.get(low as usize + 1);
    coarser.map_or(finer, |coarser| {
        mix(finer, texture_sample(coarser, place), level - low)
    })
}

/// What an rgba8 target makes of a colour.
pub(crate) fn code(colour: Vec4) -> [u8; 4] {
    (colour.clamp(Vec4::ZERO, Vec4::ONE) * 255.0)
        .to_array()
        .map(|c| (c + 0.5) as u8)
}
