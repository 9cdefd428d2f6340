//! Which colour does a place show, from whatever tiles are resident? Twin of
//! `shaders/shared/picture.wgsl`, where the reconstruction is explained.

use super::colour::rgb_from_yuv;
use super::footprint::{level_of, shown_footprint};
use super::lattice::{Axis, axis_of, bracket};
use super::tiles::{
    Plane, SourceTile, TwinTiles, cell_at, fetch, first_texel, load, mip_of, offset_of, pitch_of,
    scale_of, segment_start, shown_in, source_at,
};
use super::wgsl::mix;
use super::{cube, equirect, plane};
use foveal_core::view::surface::Projection;
use glam::{IVec2, Vec2, Vec3, Vec4};

struct Footing {
    inside: bool,
    texel: IVec2,
    weight: Vec2,
}

fn footing(
    tiles: &TwinTiles,
    source: &SourceTile<'_>,
    plane: Plane,
    level: u32,
    place: Vec2,
) -> Footing {
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

fn view_inside(source: &SourceTile<'_>, plane: Plane, level: u32, at: &Footing) -> Vec2 {
    let mip = mip_of(source, level);
    let a = load(source, plane, at.texel, mip);
    let b = load(source, plane, at.texel + IVec2::new(1, 0), mip);
    let c = load(source, plane, at.texel + IVec2::new(0, 1), mip);
    let d = load(source, plane, at.texel + IVec2::new(1, 1), mip);
    mix(mix(a, b, at.weight.x), mix(c, d, at.weight.x), at.weight.y)
}

fn corner_across(
    tiles: &TwinTiles,
    corner: u32,
    plane: Plane,
    level: u32,
    face: u32,
    place: Vec2,
) -> Vec2 {
    let x_axis = axis_of(tiles, plane, level, 0);
    let y_axis = axis_of(tiles, plane, level, 1);
    let x = bracket(&x_axis, place.x, beyond_edges(tiles, face, &x_axis, 0));
    let y = bracket(&y_axis, place.y, beyond_edges(tiles, face, &y_axis, 1));
    let around = [&x, &y];
    match tiles.grid.surface.projection {
        Projection::Flat => plane::corner_sample(tiles, corner, plane, level, face, around),
        Projection::Cube => cube::corner_sample(tiles, corner, (plane, level), face, place, around),
        Projection::Equirect => {
            equirect::corner_sample(tiles, corner, (plane, level), face, place, around)
        }
    }
}

fn beyond_edges(tiles: &TwinTiles, face: u32, axis: &Axis, k: usize) -> Vec2 {
    match tiles.grid.surface.projection {
        Projection::Flat => plane::beyond_edges(axis),
        Projection::Cube => cube::beyond_edges(tiles, face, axis, k),
        Projection::Equirect => equirect::beyond_edges(axis, k),
    }
}

fn cubic_share(display: f32) -> f32 {
    (4.0 - 4.0 * display).clamp(0.0, 1.0)
}

fn cubic_weights(t: f32) -> Vec4 {
    let s = 1.0 - t;
    Vec4::new(
        -0.5 * t * s * s,
        1.0 + t * t * (1.5 * t - 2.5),
        1.0 + s * s * (1.5 * s - 2.5),
        -0.5 * s * t * t,
    )
}

fn beside_edge(tiles: &TwinTiles, face: u32, place: Vec2) -> (u32, Vec2) {
    match tiles.grid.surface.projection {
        Projection::Flat => plane::beside_edge(tiles, face, place),
        Projection::Cube => cube::beside_edge(tiles, face, place),
        Projection::Equirect => equirect::beside_edge(tiles, face, place),
    }
}

fn sample_across(tiles: &TwinTiles, face: u32, middle: Vec2) -> f32 {
    let (face, place) = beside_edge(tiles, face, middle);
    fetch(tiles, Plane::Luma, 0, face, place).x
}

fn cubic_row(own: &SourceTile<'_>, texel: IVec2, weights: Vec4) -> f32 {
    let a = load(own, Plane::Luma, texel + IVec2::new(-1, 0), 0).x;
    let b = load(own, Plane::Luma, texel, 0).x;
    let c = load(own, Plane::Luma, texel + IVec2::new(1, 0), 0).x;
    let d = load(own, Plane::Luma, texel + IVec2::new(2, 0), 0).x;
    Vec4::new(a, b, c, d).dot(weights)
}

fn cubic_luma(
    tiles: &TwinTiles,
    face: u32,
    place: Vec2,
    own: &SourceTile<'_>,
    at: &Footing,
    within: bool,
) -> f32 {
    let middle = (place - 0.5).floor() + 0.5;
    let share = if within { at.weight } else { place - middle };
    let x_weights = cubic_weights(share.x);
    let y_weights = cubic_weights(share.y);
    if within {
        let row = |row: usize| {
            let texel = at.texel + IVec2::new(0, row as i32 - 1);
            y_weights[row] * cubic_row(own, texel, x_weights)
        };
        return (0..4).map(row).sum();
    }
    let sample = |k: usize| {
        let step = Vec2::new((k & 3) as f32, (k >> 2) as f32) - 1.0;
        let weight = x_weights[k & 3] * y_weights[k >> 2];
        weight * sample_across(tiles, face, middle + step)
    };
    (0..16).map(sample).sum()
}

fn level_view(
    tiles: &TwinTiles,
    level: u32,
    face: u32,
    place: Vec2,
    own: &SourceTile<'_>,
    cubic: f32,
) -> Vec3 {
    let mut source = *own;
    if level == tiles.params.coarsest && own.level != level {
        source = source_at(tiles, level, face, place);
    }
    let luma_at = footing(tiles, &source, Plane::Luma, level, place);
    let chroma_at = footing(tiles, &source, Plane::Chroma, level, place);
    let mut luma = Vec2::ZERO;
    if luma_at.inside {
        luma = view_inside(&source, Plane::Luma, level, &luma_at);
    }
    let mut chroma = Vec2::ZERO;
    if chroma_at.inside {
        chroma = view_inside(&source, Plane::Chroma, level, &chroma_at);
    }
    let mut corner = if luma_at.inside { 4 } else { 0 };
    let end = if chroma_at.inside { 4 } else { 8 };
    while corner < end {
        let plane = if corner < 4 {
            Plane::Luma
        } else {
            Plane::Chroma
        };
        let sample = corner_across(tiles, corner, plane, level, face, place);
        match plane {
            Plane::Luma => luma += sample,
            Plane::Chroma => chroma += sample,
        }
        corner += 1;
    }
    if level == 0 && cubic > 0.0 {
        let low = (place - 0.5).floor() - 1.0;
        let within =
            own.level == 0 && low.cmpge(own.low).all() && (low + 4.0).cmple(own.high).all();
        let sharp = cubic_luma(tiles, face, place, own, &luma_at, within);
        luma.x = mix(luma.x, sharp, cubic);
    }
    Vec3::new(luma.x, chroma.x, chroma.y)
}

pub(crate) fn picture_at(tiles: &TwinTiles, face: u32, place: Vec2, display: f32) -> Vec3 {
    let own_shown = shown_in(tiles, face, cell_at(tiles, place));
    let own = source_at(tiles, own_shown, face, place);
    let footprint = shown_footprint(tiles, face, place, display, scale_of(tiles, own.level));
    let shown = level_of(tiles, footprint);
    let mut level = shown as u32;
    let mut blend = shown - level as f32;
    if blend > 1023.0 / 1024.0 {
        level += 1;
        blend = 0.0;
    }
    let end = level + if blend >= 1.0 / 1024.0 { 2 } else { 1 };
    let mut weight = if end == level + 2 { 1.0 - blend } else { 1.0 };
    let mut yuv = Vec3::ZERO;
    while level < end {
        yuv += level_view(tiles, level, face, place, &own, cubic_share(display)) * weight;
        weight = blend;
        level += 1;
    }
    rgb_from_yuv(tiles, yuv)
}
