//! Which level pictures and units are judged?

use super::Seeded;
use foveal_core::perception::importance::NO_UNIT;
use foveal_core::perception::measures::pyramid::{doubled, half_size, halved};
use foveal_render::RgbaImage;

/// How pictures are filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Content {
    /// Every channel of every pixel by itself.
    Random,
    /// As much contrast in every octave, as natural pictures have.
    Natural,
    /// Squares of three pixels, black and white.
    Checker,
}

/// One channel, 0 to 255.
fn channel(content: Content, size: [u32; 2], random: &mut Seeded) -> Vec<f64> {
    let count = (size[0] * size[1]) as usize;
    match content {
        Content::Random => (0..count).map(|_| f64::from(random.below(256))).collect(),
        Content::Checker => (0..count as u32)
            .map(|i| f64::from((i % size[0] / 3 + i / size[0] / 3) % 2) * 255.0)
            .collect(),
        Content::Natural => {
            let mut sizes = vec![size];
            while sizes[sizes.len() - 1] != [1, 1] {
                sizes.push(half_size(sizes[sizes.len() - 1]));
            }
            let mut codes = vec![128.0];
            for pair in sizes.windows(2).rev() {
                codes = doubled(&codes, pair[1], pair[0]);
                for code in &mut codes {
                    *code += f64::from(random.below(2001)) / 1000.0 * 22.0 - 22.0;
                }
            }
            codes
        }
    }
}

/// The finest picture, then coarser ones at the same size.
pub fn levels(content: Content, size: [u32; 2], count: usize) -> Vec<RgbaImage> {
    let mut random = Seeded(count as u64 + 11);
    let channels = [0, 1, 2].map(|_| channel(content, size, &mut random));
    let level = |octaves: usize| {
        let planes = channels.clone().map(|plane| softened(plane, size, octaves));
        let code = |k: usize, i: usize| planes[k][i].clamp(0.0, 255.0) as u8;
        let pixels = (0..planes[0].len()).flat_map(|i| [code(0, i), code(1, i), code(2, i), 255]);
        RgbaImage {
            size,
            pixels: pixels.collect(),
        }
    };
    (0..count).map(level).collect()
}

fn softened(mut plane: Vec<f64>, size: [u32; 2], octaves: usize) -> Vec<f64> {
    let mut sizes = vec![size];
    for octave in 0..octaves {
        let (coarse, coarse_size) = halved(&plane, sizes[octave]);
        plane = coarse;
        sizes.push(coarse_size);
    }
    for pair in sizes.windows(2).rev() {
        plane = doubled(&plane, pair[1], pair[0]);
    }
    plane
}

/// Units of 1 to `side`² pixels, scattered, and every seventh of none.
pub fn scattered(size: [u32; 2], side: u32) -> (Vec<u32>, usize) {
    let across = size[0].div_ceil(side);
    let units = across * size[1].div_ceil(side);
    let ids = (0..size[0] * size[1]).map(|i| {
        let unit = i / size[0] / side * across + i % size[0] / side;
        if unit % 7 == 3 { NO_UNIT } else { unit }
    });
    (ids.collect(), units as usize)
}
