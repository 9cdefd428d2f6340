//! What should the shaders draw? The same passes on the CPU, statement for statement.
//!
//! Every file here and in `scene`, and in `shared` for those of `shaders/shared/`, is the twin of
//! the WGSL file of its name: same functions, same order, `f32`, and never optimised. [`TwinTiles`]
//! takes the place of the tables and textures, so that pictures can be made, and shaders be judged,
//! without a GPU.

mod blur_halve;
mod blur_radial;
mod fading;
mod filters;
pub(crate) mod halve_tiles;
mod interpolate_sparse;
mod overlay;
mod projected;
mod reconstruct_cube;
mod reconstruct_equirect;
mod reconstruct_plane;
mod reconstruct_textures;
mod reduce_source;
pub(crate) mod scene;
pub(crate) mod shared;
mod warp;

pub use filters::TwinSource;
pub use interpolate_sparse::TwinSamples;
pub use scene::TwinScene;
pub use shared::tiles::TwinTiles;

use crate::image::RgbaImage;
use crate::params::{BlurParams, Overlay, ViewParams};
use crate::tiles::blur::{FirstHalf, RadialBlur, half, halvings};
use crate::warp::params::WarpParams;
use crate::warp::{WarpPlan, WarpStyle};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Projection;
use glam::{Mat3, Vec2, Vec3, Vec4};
use shared::screen::View;
use shared::wgsl::code;

/// The picture that `view` shows of the resident tiles.
#[must_use]
pub fn reconstruct(tiles: &TwinTiles, view: &EyeView) -> RgbaImage {
    let params = params_of(tiles, view);
    let mut image = RgbaImage::black(view.size);
    for_every_pixel(view.size, |at, position| {
        let colour = match tiles.grid.surface.projection {
            Projection::Flat => reconstruct_plane::reconstruct_plane(tiles, &params, position),
            Projection::Cube => reconstruct_cube::reconstruct_cube(tiles, &params, position),
            Projection::Equirect => {
                reconstruct_equirect::reconstruct_equirect(tiles, &params, position)
            }
        };
        image.set_pixel(at, code(colour));
    });
    image
}

/// The picture that `view` shows of samples round the gaze, over the resident tiles.
#[must_use]
pub fn interpolate_sparse(tiles: &TwinTiles, samples: &TwinSamples, view: &EyeView) -> RgbaImage {
    let params = params_of(tiles, view);
    let mut image = RgbaImage::black(view.size);
    for_every_pixel(view.size, |at, position| {
        let colour = interpolate_sparse::interpolate_sparse(tiles, samples, &params, position);
        image.set_pixel(at, code(colour));
    });
    image
}

/// The picture that `view` shows when every level has a texture of its own.
#[must_use]
pub fn reconstruct_textures(tiles: &TwinTiles, view: &EyeView) -> RgbaImage {
    let params = params_of(tiles, view);
    let mut image = RgbaImage::black(view.size);
    for_every_pixel(view.size, |at, position| {
        let colour = reconstruct_textures::reconstruct_textures(tiles, &params, position);
        image.set_pixel(at, code(colour));
    });
    image
}

/// A picture that `view` shows, blurred outside the fovea. The blur is read from halves: the first
/// is `drawn_half`, what [`RadialBlur::half_view`] shows, or else made of the picture.
#[must_use]
pub fn blur_radial(
    picture: &RgbaImage,
    drawn_half: Option<RgbaImage>,
    view: &EyeView,
    blur: &RadialBlur,
) -> RgbaImage {
    let first = match drawn_half {
        Some(_) => FirstHalf::Drawn,
        None => FirstHalf::Halved,
    };
    let mut halves = vec![drawn_half.unwrap_or_else(|| halved(picture))];
    for _ in 1..halvings(picture.size) {
        halves.extend(halves.last().map(halved));
    }
    let params = BlurParams::new(view, blur, halves.len() as u32, first);
    let mut image = RgbaImage::black(picture.size);
    for_every_pixel(picture.size, |at, position| {
        let colour = blur_radial::blur_radial(&params, picture, &halves, position);
        image.set_pixel(at, code(colour));
    });
    image
}

fn halved(larger: &RgbaImage) -> RgbaImage {
    let mut image = RgbaImage::black(half(larger.size));
    for_every_pixel(image.size, |at, position| {
        image.set_pixel(at, code(blur_halve::blur_halve(larger, position)));
    });
    image
}

/// The picture with the levels, borders and gaze that `marks` asks for.
#[must_use]
pub fn heat_map(tiles: &TwinTiles, view: &EyeView, marks: &Overlay) -> RgbaImage {
    marked(tiles, view, marks, reconstruct(tiles, view))
}

/// A picture of `view` with the levels, borders and gaze that `marks` asks for over it.
#[must_use]
pub fn marked(
    tiles: &TwinTiles,
    view: &EyeView,
    marks: &Overlay,
    mut image: RgbaImage,
) -> RgbaImage {
    let params = params_of(tiles, view);
    for_every_pixel(view.size, |at, position| {
        let drawn = overlay::overlay(tiles, &params, marks, position);
        let [r, g, b, a] = image.pixel(at).map(|c| f32::from(c) / 255.0);
        let blended = drawn.truncate() * drawn.w + Vec3::new(r, g, b) * (1.0 - drawn.w);
        image.set_pixel(at, code(blended.extend(a)));
    });
    image
}

/// All panels of a plan, filled from a source.
#[must_use]
pub fn warp(source: &TwinSource, plan: &WarpPlan, style: &WarpStyle) -> RgbaImage {
    let params = WarpParams::new(plan.atlas, source.levels(), style)
        .blurred(plan.spread, style.filter.moment());
    filled(source, plan, &params)
}

/// The same by the elliptical weighted average of the finest level, in double precision: slow, and
/// what all filters are judged by.
#[must_use]
pub fn warp_by_ewa(source: &TwinSource, plan: &WarpPlan) -> RgbaImage {
    let params = WarpParams {
        filter_by: filters::EWA,
        ..WarpParams::new(plan.atlas, source.levels(), &WarpStyle::default())
    };
    let params = params.blurred(plan.spread, Some(filters::EWA_MOMENT));
    filled(source, plan, &params)
}

/// Where in the source the pixel of a panel looks, by the record that the pass reads; `None` where
/// it is black. Pixels are those that are sent, with centres at +0.5.
#[must_use]
pub fn warped_place(plan: &WarpPlan, panel: usize, pixel: [f32; 2]) -> Option<[f32; 2]> {
    let seen = warp::seen_by(plan, panel, pixel.into(), 0)?;
    Some(seen.taken.at.to_array())
}

fn filled(source: &TwinSource, plan: &WarpPlan, params: &WarpParams) -> RgbaImage {
    let mut image = RgbaImage::black(plan.atlas);
    for (index, panel) in plan.panels.iter().enumerate() {
        for_every_pixel(panel.size, |at, position| {
            let at = [0, 1].map(|k| at[k] + panel.origin[k]);
            let position = position + Vec2::from(panel.origin.map(|k| k as f32));
            let light = warp::warp((source, plan, params), index, position);
            image.set_pixel(at, reduce_source::srgb_code(light));
        });
    }
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
