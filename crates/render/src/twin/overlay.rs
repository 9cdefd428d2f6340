//! Which level does each place show, and where is the gaze? Twin of `shaders/overlay.wgsl`.

use super::shared::footprint::{level_of, shown_footprint};
use super::shared::ramp::ramp;
use super::shared::screen::{SeenPlace, View};
use super::shared::tiles::{TwinTiles, cell_at, scale_of, shown_in, source_at};
use super::shared::{cube, equirect, plane};
use crate::params::Overlay;
use foveal_core::view::surface::Projection;
use glam::{Vec2, Vec3, Vec4};

fn line(away: f32, width: f32) -> f32 {
    (0.5 * width + 0.5 - away).clamp(0.0, 1.0)
}

fn to_border(tiles: &TwinTiles, seen: &SeenPlace) -> f32 {
    let shown = shown_in(tiles, seen.face, cell_at(tiles, seen.place));
    let tile = source_at(tiles, shown, seen.face, seen.place);
    let away = (seen.place - tile.low).min(tile.high - seen.place);
    let away = match tiles.grid.surface.projection {
        Projection::Flat => plane::seen_apart(away),
        Projection::Cube => cube::seen_apart(away),
        Projection::Equirect => equirect::seen_apart(tiles, seen.place, away),
    };
    away.x.min(away.y) / seen.footprint.max(1.0)
}

fn over(under: Vec4, colour: Vec3, cover: f32) -> Vec4 {
    let alpha = cover + under.w * (1.0 - cover);
    let sum = colour * cover + under.truncate() * under.w * (1.0 - cover);
    (sum / alpha.max(0.001)).extend(alpha)
}

pub(super) fn overlay(tiles: &TwinTiles, view: &View, marks: &Overlay, position: Vec2) -> Vec4 {
    let mut drawn = Vec4::ZERO;
    let seen = match tiles.grid.surface.projection {
        Projection::Flat => plane::seen_by(tiles, view, position),
        Projection::Cube => cube::seen_by(tiles, view, position),
        Projection::Equirect => equirect::seen_by(tiles, view, position),
    };
    if seen.inside {
        let own = scale_of(
            tiles,
            shown_in(tiles, seen.face, cell_at(tiles, seen.place)),
        );
        let footprint = shown_footprint(tiles, seen.face, seen.place, seen.footprint, own);
        let level = level_of(tiles, footprint) / (tiles.params.coarsest as f32).max(1.0);
        drawn = over(drawn, ramp(level), marks.heat);
        let border = line(to_border(tiles, &seen), 1.0) * marks.borders;
        drawn = over(drawn, Vec3::splat(0.05), border);
    }
    if marks.gaze_radius > 0.0 {
        let away = ((position - Vec2::from(marks.gaze)).length() - marks.gaze_radius).abs();
        drawn = over(drawn, Vec3::ZERO, line(away, 4.0) * 0.6);
        drawn = over(drawn, Vec3::ONE, line(away, 2.0));
    }
    drawn
}
