//! Which colour does a pixel of a view get from samples round the gaze? Twin of
//! `shaders/interpolate_sparse.wgsl`.

use super::shared::colour::rgb_from_yuv;
use super::shared::picture::picture_at;
use super::shared::screen::View;
use super::shared::tiles::TwinTiles;
use super::shared::wgsl::mix;
use super::shared::{cube, equirect, plane};
use crate::params::SparseParams;
use crate::tiles::sparse::Interpolation;
use foveal_core::perception::samples::nearest_sample::NEIGHBOURS;
use foveal_core::perception::samples::sample_mask::SampleMask;
use foveal_core::view::surface::Projection;
use glam::{IVec2, UVec3, Vec2, Vec3, Vec4};

const REACH: f32 = 2.0;

/// A mask and the colours of its samples, in main memory.
#[derive(Clone, Debug)]
pub struct TwinSamples {
    mask: SampleMask,
    params: SparseParams,
    codes: Vec<u32>,
}

impl TwinSamples {
    /// A mask whose samples are still black.
    #[must_use]
    pub fn new(mask: SampleMask, interpolation: Interpolation) -> Self {
        Self {
            params: SparseParams::new(&mask, interpolation == Interpolation::Blended),
            codes: vec![0; mask.places.len()],
            mask,
        }
    }

    /// Shows these colours, one a sample, with the mask's top left pixel at `corner` of the view.
    ///
    /// # Panics
    /// There must be as many as the mask has samples.
    pub fn show(&mut self, corner: [i32; 2], codes: &[u32]) {
        self.params.corner = corner;
        self.codes.copy_from_slice(codes);
    }
}

fn colour_of(samples: &TwinSamples, sample: u32) -> Vec3 {
    let code = samples.codes[sample as usize];
    (UVec3::new(code, code >> 8, code >> 16) & UVec3::splat(255)).as_vec3() / 255.0
}

fn sample_place(samples: &TwinSamples, sample: u32) -> Vec2 {
    let [x, y] = samples.mask.places[sample as usize];
    Vec2::new(f32::from(x), f32::from(y))
}

fn spacing(samples: &TwinSamples, k: u32) -> f32 {
    samples.params.spacings[k as usize / 4][k as usize % 4]
}

fn reach_at(samples: &TwinSamples, pixel: Vec2) -> f32 {
    let centre = Vec2::splat((samples.params.side / 2) as f32);
    let radius = (pixel - centre).length() / samples.params.spacing_step;
    let k = (radius as u32).min(62);
    let part = (radius - k as f32).min(1.0);
    REACH * mix(spacing(samples, k), spacing(samples, k + 1), part)
}

fn sample_weight(away: f32, reach: f32) -> f32 {
    let share = (reach - away).max(0.0) / (reach * away);
    share * share
}

fn blended(samples: &TwinSamples, pixel: Vec2, own: u32) -> Vec3 {
    let colour = colour_of(samples, own);
    let away = (pixel - sample_place(samples, own)).length();
    if away == 0.0 {
        return colour;
    }
    let reach = reach_at(samples, pixel).max(1.5 * away);
    let mut total = sample_weight(away, reach);
    let mut sum = colour * total;
    for k in 0..NEIGHBOURS {
        let other = samples.mask.neighbours[own as usize][k];
        if other == own {
            break;
        }
        let weight = sample_weight((pixel - sample_place(samples, other)).length(), reach);
        total += weight;
        sum += colour_of(samples, other) * weight;
    }
    sum / total
}

pub(super) fn interpolate_sparse(
    tiles: &TwinTiles,
    samples: &TwinSamples,
    view: &View,
    position: Vec2,
) -> Vec4 {
    let seen = match tiles.grid.surface.projection {
        Projection::Flat => plane::seen_by(tiles, view, position),
        Projection::Cube => cube::seen_by(tiles, view, position),
        Projection::Equirect => equirect::seen_by(tiles, view, position),
    };
    if !seen.inside {
        return Vec4::new(0.0, 0.0, 0.0, 1.0);
    }
    let side = samples.params.side as i32;
    let pixel = position.floor().as_ivec2() - IVec2::from(samples.params.corner);
    if pixel.cmplt(IVec2::ZERO).any() || pixel.cmpge(IVec2::splat(side)).any() {
        return picture_at(tiles, seen.face, seen.place, seen.footprint).extend(1.0);
    }
    let own = samples.mask.nearest[(pixel.y * side + pixel.x) as usize];
    if samples.params.blends == 0 {
        return rgb_from_yuv(tiles, colour_of(samples, own)).extend(1.0);
    }
    rgb_from_yuv(tiles, blended(samples, pixel.as_vec2(), own)).extend(1.0)
}
