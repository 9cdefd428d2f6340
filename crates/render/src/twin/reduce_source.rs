//! What is a picture at about half its size? Twin of `shaders/reduce_source.wgsl`.

use super::shared::wgsl::mix;
use crate::image::RgbaImage;
use glam::{Vec2, Vec3};

/// Linear light of a picture.
pub(super) struct Light {
    pub(super) size: [u32; 2],
    texels: Vec<Vec3>,
}

impl Light {
    pub(super) fn of(picture: &RgbaImage) -> Self {
        let decoded: Vec<f32> = (0..=255_u8)
            .map(|code| linear(f32::from(code) / 255.0))
            .collect();
        let texels = picture.pixels.chunks_exact(4).map(|rgba| {
            let channel = |k: usize| decoded[usize::from(rgba[k])];
            Vec3::new(channel(0), channel(1), channel(2))
        });
        Self {
            size: picture.size,
            texels: texels.collect(),
        }
    }

    pub(super) fn size(&self) -> Vec2 {
        Vec2::new(self.size[0] as f32, self.size[1] as f32)
    }

    /// WGSL's `textureLoad`, of the nearest texel inside.
    pub(super) fn load(&self, texel: Vec2) -> Vec3 {
        let inside = texel.clamp(Vec2::ZERO, self.size() - 1.0);
        let [x, y] = inside.to_array().map(|k| k as usize);
        self.texels[y * self.size[0] as usize + x]
    }

    /// WGSL's `textureSampleLevel` of one level, clamped to the edge.
    pub(super) fn sample(&self, place: Vec2) -> Vec3 {
        let at = place * self.size() - 0.5;
        let low = at.floor();
        let part = at - low;
        let texel = |x: f32, y: f32| self.load(low + Vec2::new(x, y));
        let above = mix(texel(0.0, 0.0), texel(1.0, 0.0), part.x);
        let below = mix(texel(0.0, 1.0), texel(1.0, 1.0), part.x);
        mix(above, below, part.y)
    }
}

/// Linear light of an sRGB code of 0 to 1; IEC 61966-2-1.
fn linear(code: f32) -> f32 {
    if code <= 0.04045 {
        code / 12.92
    } else {
        ((code + 0.055) / 1.055).powf(2.4)
    }
}

/// What an sRGB target makes of linear light.
pub(super) fn srgb_code(light: Vec3) -> [u8; 4] {
    let [r, g, b] = light.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(|k| {
        let code = if k <= 0.003_130_8 {
            12.92 * k
        } else {
            1.055 * k.powf(1.0 / 2.4) - 0.055
        };
        (code * 255.0 + 0.5) as u8
    });
    [r, g, b, 255]
}

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
    for y in 0..image.size[1] {
        for x in 0..image.size[0] {
            let position = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            image.set_pixel([x, y], srgb_code(reduce_source(finer, position)));
        }
    }
    image
}
