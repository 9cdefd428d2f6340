//! Which colour does a place show, from whatever tiles are resident? Twin of
//! `shaders/shared/picture.wgsl`, where the reconstruction is explained.

use super::colour::rgb_from_yuv;
use super::footprint::{level_of, shown_footprint};
use super::lattice::{Axis, Tap, axis_of, bracket};
use super::tiles::{
    Plane, Source, TwinTiles, first_texel, level_at, load, mip_of, offset_of, pitch_of,
    segment_start, source_at,
};
use super::{cube, mix, plane};
use foveal_core::view::surface::Projection;
use glam::{IVec2, Vec2, Vec3};

struct Footing {
    inside: bool,
    texel: IVec2,
    weight: Vec2,
}

fn footing(tiles: &TwinTiles, source: &Source, plane: Plane, level: u32, place: Vec2) -> Footing {
    let pitch = pitch_of(tiles, plane, level);
    let start = segment_start(tiles, place);
    let along = (place - start) / pitch - offset_of(tiles, plane, level);
    let sample = along.floor();
    let low = start + sample * pitch;
    let inside = low.cmpge(source.low).all() && (low + 2.0 * pitch).cmple(source.high).all();
    let texel = first_texel(tiles, source, plane, level, start) + sample.as_ivec2();
    Footing {
        inside,
        texel,
        weight: along - sample,
    }
}

fn view_inside(tiles: &TwinTiles, source: &Source, plane: Plane, level: u32, at: &Footing) -> Vec2 {
    let mip = mip_of(source, level);
    let a = load(tiles, source, plane, at.texel, mip);
    let b = load(tiles, source, plane, at.texel + IVec2::new(1, 0), mip);
    let c = load(tiles, source, plane, at.texel + IVec2::new(0, 1), mip);
    let d = load(tiles, source, plane, at.texel + IVec2::new(1, 1), mip);
    mix(mix(a, b, at.weight.x), mix(c, d, at.weight.x), at.weight.y)
}

fn view_across(tiles: &TwinTiles, plane: Plane, level: u32, face: u32, place: Vec2) -> Vec2 {
    let x_axis = axis_of(tiles, plane, level, 0);
    let y_axis = axis_of(tiles, plane, level, 1);
    let x = bracket(&x_axis, place.x, beyond_edges(tiles, face, &x_axis, 0));
    let y = bracket(&y_axis, place.y, beyond_edges(tiles, face, &y_axis, 1));
    let a = fetch_tap(tiles, plane, level, face, [x.low, y.low]);
    let b = fetch_tap(tiles, plane, level, face, [x.high, y.low]);
    let c = fetch_tap(tiles, plane, level, face, [x.low, y.high]);
    let d = fetch_tap(tiles, plane, level, face, [x.high, y.high]);
    mix(mix(a, b, x.weight), mix(c, d, x.weight), y.weight)
}

fn beyond_edges(tiles: &TwinTiles, face: u32, axis: &Axis, k: usize) -> Vec2 {
    match tiles.grid.surface.projection {
        Projection::Flat => plane::beyond_edges(axis),
        Projection::Cube => cube::beyond_edges(tiles, face, axis, k),
    }
}

fn fetch_tap(tiles: &TwinTiles, plane: Plane, level: u32, face: u32, taps: [Tap; 2]) -> Vec2 {
    match tiles.grid.surface.projection {
        Projection::Flat => plane::fetch_tap(tiles, plane, level, face, taps),
        Projection::Cube => cube::fetch_tap(tiles, plane, level, face, taps),
    }
}

fn level_view(tiles: &TwinTiles, level: u32, face: u32, place: Vec2, own: &Source) -> Vec3 {
    let mut source = *own;
    if level == tiles.params.coarsest && own.level != level {
        source = source_at(tiles, level, face, place);
    }
    let luma_at = footing(tiles, &source, Plane::Luma, level, place);
    let luma = if luma_at.inside {
        view_inside(tiles, &source, Plane::Luma, level, &luma_at)
    } else {
        view_across(tiles, Plane::Luma, level, face, place)
    };
    let chroma_at = footing(tiles, &source, Plane::Chroma, level, place);
    let chroma = if chroma_at.inside {
        view_inside(tiles, &source, Plane::Chroma, level, &chroma_at)
    } else {
        view_across(tiles, Plane::Chroma, level, face, place)
    };
    Vec3::new(luma.x, chroma.x, chroma.y)
}

pub(super) fn picture_at(tiles: &TwinTiles, face: u32, place: Vec2, display: f32) -> Vec3 {
    let own = source_at(tiles, level_at(tiles, face, place), face, place);
    let footprint = shown_footprint(tiles, face, place, display, tiles.level(own.level).scale);
    let shown = level_of(tiles, footprint);
    let mut level = shown.floor();
    let mut blend = shown - level;
    if blend > 1023.0 / 1024.0 {
        level += 1.0;
        blend = 0.0;
    }
    let mut yuv = level_view(tiles, level as u32, face, place, &own);
    if blend >= 1.0 / 1024.0 {
        let coarser = level_view(tiles, level as u32 + 1, face, place, &own);
        yuv = mix(yuv, coarser, blend);
    }
    rgb_from_yuv(tiles, yuv)
}
