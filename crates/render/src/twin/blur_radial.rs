//! How does a picture look when it is blurred as far as the eye is blind to detail? Twin of
//! `shaders/blur_radial.wgsl`.

use super::mix;
use crate::image::RgbaImage;
use crate::params::BlurParams;
use glam::{Mat3, Vec2, Vec3, Vec4};

const READING_VARIANCE: f32 = 0.666_666_7;

fn variance_at(blur: &BlurParams, ray: Vec3, chord: f32) -> f32 {
    let eccentricity = 2.0 * (0.5 * chord).min(1.0).asin();
    let far = ray.length();
    let pixel_angle = blur.pitch / (far * far.sqrt());
    let sigma = blur.growth * (eccentricity - blur.fovea) / pixel_angle;
    sigma * sigma
}

pub(super) fn blur_radial(
    blur: &BlurParams,
    picture: &RgbaImage,
    halves: &[RgbaImage],
    position: Vec2,
) -> Vec4 {
    let sharp = texture_load(picture, position.floor());
    let [x, y, z] = blur
        .ray_from_pixel
        .map(|column| Vec4::from(column).truncate());
    let ray = Mat3::from_cols(x, y, z) * position.extend(1.0);
    let chord = (ray.normalize() - Vec3::from(blur.gaze)).length();
    if chord <= blur.fovea_chord {
        return sharp;
    }
    let variance = variance_at(blur, ray, chord);
    let level = 0.5 * ((variance + 1.0 - blur.first) / 0.416_666_7).log2() - 1.0;
    let place = position / size_of_picture(picture);
    let soft = texture_sample_level(halves, place, level.clamp(0.0, blur.last));
    mix(
        sharp,
        soft,
        (variance / (blur.first + READING_VARIANCE)).min(1.0),
    )
}

/// WGSL's `textureDimensions`.
pub(super) fn size_of_picture(picture: &RgbaImage) -> Vec2 {
    let [columns, rows] = picture.size;
    Vec2::new(columns as f32, rows as f32)
}

/// WGSL's `textureLoad`, of the nearest texel inside.
fn texture_load(picture: &RgbaImage, texel: Vec2) -> Vec4 {
    let inside = texel.clamp(Vec2::ZERO, size_of_picture(picture) - 1.0);
    let [x, y] = inside.to_array().map(|k| k as u32);
    Vec4::from(picture.pixel([x, y]).map(|c| f32::from(c) / 255.0))
}

/// WGSL's `textureSampleLevel` of one level, clamped to the edge.
pub(super) fn texture_sample(picture: &RgbaImage, place: Vec2) -> Vec4 {
    let at = place * size_of_picture(picture) - 0.5;
    let low = at.floor();
    let part = at - low;
    let texel = |x: f32, y: f32| texture_load(picture, low + Vec2::new(x, y));
    let above = mix(texel(0.0, 0.0), texel(1.0, 0.0), part.x);
    let below = mix(texel(0.0, 1.0), texel(1.0, 1.0), part.x);
    mix(above, below, part.y)
}

/// WGSL's `textureSampleLevel` between two levels.
fn texture_sample_level(levels: &[RgbaImage], place: Vec2, level: f32) -> Vec4 {
    let low = level.floor();
    let finer = texture_sample(&levels[low as usize], place);
    let coarser = levels.get(low as usize + 1);
    coarser.map_or(finer, |coarser| {
        mix(finer, texture_sample(coarser, place), level - low)
    })
}
