//! How does a picture look when it is blurred as far as the eye is blind to detail? Twin of
//! `shaders/blur_radial.wgsl`.

use super::shared::wgsl::{mix, size_of_picture, texture_load, texture_sample_level};
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
