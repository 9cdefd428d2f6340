//! What is a picture at half its size? Twin of `shaders/blur_halve.wgsl`.

use super::shared::wgsl::{size_of_picture, texture_sample};
use crate::image::RgbaImage;
use glam::{Vec2, Vec4};

pub(super) fn blur_halve(larger: &RgbaImage, position: Vec2) -> Vec4 {
    let size = size_of_picture(larger);
    let middle = position * size / (0.5 * size).floor().max(Vec2::ONE);
    let mut sum = Vec4::ZERO;
    for corner in 0..4 {
        let beside = Vec2::new((corner & 1) as f32, (corner >> 1) as f32) * 1.5 - 0.75;
        sum += texture_sample(larger, (middle + beside) / size);
    }
    0.25 * sum
}
