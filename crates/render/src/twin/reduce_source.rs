//! What is a picture at about half its size? Twin of `shaders/reduce_source.wgsl`.

use super::filters::{Light, srgb_code};
use super::for_every_pixel;
use crate::image::RgbaImage;
use glam::{Vec2, Vec3};

fn kernel(distance: f32) -> f32 {
    let t = distance.abs();
    if t >= 2.0 {
        return 0.0;
    }
    if t < 1.0 {
        return 1.0 + t * t * (1.5 * t - 2.5);
    }
    2.0 + t * (-4.0 + t * (2.5 - 0.5 * t))
}

fn reduce_source(finer: &Light, position: Vec2) -> Vec3 {
    let size = finer.size();
    let ratio = size / (0.5 * size).floor().max(Vec2::ONE);
    let middle = position * ratio;
    let first = (middle - 2.0 * ratio).floor();
    let count = (4.0 * ratio).ceil() + 1.0;
    let mut sum = Vec3::ZERO;
    let mut weights = 0.0;
    for row in 0..count.y as u32 {
        let y = first.y + row as f32;
        let weight_y = kernel((y + 0.5 - middle.y) / ratio.y);
        for column in 0..count.x as u32 {
            let x = first.x + column as f32;
            let weight = weight_y * kernel((x + 0.5 - middle.x) / ratio.x);
            sum += weight * finer.load(Vec2::new(x, y));
            weights += weight;
        }
    }
    (sum / weights).clamp(Vec3::ZERO, Vec3::ONE)
}

/// The codes of the next level.
pub(super) fn reduced(finer: &Light) -> RgbaImage {
    let half = (0.5 * finer.size()).floor().max(Vec2::ONE);
    let mut image = RgbaImage::black(half.to_array().map(|side| side as u32));
    for_every_pixel(image.size, |at, position| {
        image.set_pixel(at, srgb_code(reduce_source(finer, position)));
    });
    image
}
