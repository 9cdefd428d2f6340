//! What should the shaders draw? The same passes on the CPU, statement for statement.
//!
//! Every file here is the twin of the WGSL file of its name: same functions, same order, `f32`, and
//! never optimised. [`TwinTiles`] takes the place of the tables and textures, so that pictures can
//! be made, and shaders be judged, without a GPU.

mod colour;
mod cube;
mod footprint;
mod lattice;
mod overlay;
mod picture;
mod plane;
mod reconstruct_cube;
mod reconstruct_plane;
mod screen;
mod tiles;

pub use tiles::TwinTiles;

use crate::image::RgbaImage;
use crate::params::{Overlay, ViewParams};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Projection;
use glam::{Mat3, Vec2, Vec3, Vec4};
use screen::View;

/// The picture that `view` shows of the resident tiles.
#[must_use]
pub fn reconstruct(tiles: &TwinTiles, view: &EyeView) -> RgbaImage {
    let params = params_of(tiles, view);
    let mut image = RgbaImage::black(view.size);
    for_every_pixel(view.size, |at, position| {
        let colour = match tiles.grid.surface.projection {
            Projection::Flat => reconstruct_plane::reconstruct_plane(tiles, &params, position),
            Projection::Cube => reconstruct_cube::reconstruct_cube(tiles, &params, position),
        };
        image.set_pixel(at, code(colour));
    });
    image
}

/// The picture with the levels, borders and gaze that `marks` asks for.
#[must_use]
pub fn heat_map(tiles: &TwinTiles, view: &EyeView, marks: &Overlay) -> RgbaImage {
    let params = params_of(tiles, view);
    let mut image = reconstruct(tiles, view);
    for_every_pixel(view.size, |at, position| {
        let drawn = overlay::overlay(tiles, &params, marks, position);
        let [r, g, b, a] = image.pixel(at).map(|c| f32::from(c) / 255.0);
        let blended = drawn.truncate() * drawn.w + Vec3::new(r, g, b) * (1.0 - drawn.w);
        image.set_pixel(at, code(blended.extend(a)));
    });
    image
}

fn params_of(tiles: &TwinTiles, view: &EyeView) -> View {
    let params = ViewParams::new(view, &tiles.grid);
    let [x, y, z] = params.content_from_pixel;
    let column = |c: [f32; 4]| Vec4::from(c).truncate();
    View {
        content_from_pixel: Mat3::from_cols(column(x), column(y), column(z)),
        first_face: params.first_face,
    }
}

fn for_every_pixel(size: [u32; 2], mut draw: impl FnMut([u32; 2], Vec2)) {
    for y in 0..size[1] {
        for x in 0..size[0] {
            draw([x, y], Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        }
    }
}

/// What an rgba8 target makes of a colour.
fn code(colour: Vec4) -> [u8; 4] {
    (colour.clamp(Vec4::ZERO, Vec4::ONE) * 255.0)
        .to_array()
        .map(|c| (c + 0.5) as u8)
}

/// WGSL's `mix`.
fn mix<T>(a: T, b: T, t: f32) -> T
where
    T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    a * (1.0 - t) + b * t
}
