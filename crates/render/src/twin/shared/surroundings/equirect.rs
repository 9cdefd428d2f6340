//! What surrounds the one picture of the whole sphere? Twin of `shaders/shared/equirect.wgsl`.

use crate::twin::shared::lattice::{
    Axis, Bracket, Tap, axis_of, bracket, samples_in, tap_at, tap_of, weight_of,
};
use crate::twin::shared::mapping::arc_tangent;
use crate::twin::shared::screen::{SeenPlace, View};
use crate::twin::shared::tiles::{Plane, TwinTiles, cell_at, fetch, scale_of, shown_in};
use glam::{UVec2, Vec2, Vec2Swizzles, Vec3Swizzles};
use std::f32::consts::PI;

fn sine_of(share: f32) -> f32 {
    let x = PI * share.min(1.0 - share);
    let s = x * x;
    let high = -0.000_198_409 + s * (0.000_002_752_6 - s * 0.000_000_023_9);
    x + x * s * (-0.166_666_67 + s * (0.008_333_332 + s * high))
}

fn turns_of(along: Vec2, across: Vec2) -> Vec2 {
    let most = along.abs().max(across.abs()).max(Vec2::splat(1e-30));
    let low = arc_tangent(along.abs().min(across.abs()) / most);
    let steep = Vec2::select(across.abs().cmpgt(along.abs()), 0.5 * PI - low, low);
    let back = Vec2::select(along.cmplt(Vec2::ZERO), PI - steep, steep);
    Vec2::select(across.cmplt(Vec2::ZERO), -back, back)
}

fn closed(tiles: &TwinTiles, place: Vec2) -> Vec2 {
    let size = tiles.size();
    let over_pole = place.y < 0.0 || place.y > size.y;
    let folded = if place.y < 0.0 {
        -place.y
    } else {
        2.0 * size.y - place.y
    };
    let y = if over_pole { folded } else { place.y };
    let turned = place.x + if over_pole { 0.5 * size.x } else { 0.0 };
    let x = turned - (turned / size.x).floor() * size.x;
    Vec2::new(if x < size.x { x } else { 0.0 }, y)
}

pub(crate) fn seen_by(tiles: &TwinTiles, view: &View, pixel: Vec2) -> SeenPlace {
    let ray = view.content_from_pixel * pixel.extend(1.0);
    let across = view
        .content_from_pixel
        .x_axis
        .cross(view.content_from_pixel.y_axis);
    let away = ray.length();
    let level = ray.xz().length();
    let angles = turns_of(Vec2::new(-ray.z, level), Vec2::new(ray.x, ray.y));
    let share = 0.5 + angles * Vec2::new(0.5, -1.0) / PI;
    let pitch = PI * Vec2::new(2.0 * level / away, 1.0) / tiles.size();
    let footprint = (ray.dot(across).abs() / away).sqrt() / (away * pitch.x.max(pitch.y));
    SeenPlace {
        inside: true,
        face: view.first_face,
        place: closed(tiles, share * tiles.size()),
        footprint,
    }
}

pub(crate) fn seen_apart(tiles: &TwinTiles, place: Vec2, apart: Vec2) -> Vec2 {
    let share = (place.y / tiles.size().y).clamp(0.0, 1.0);
    Vec2::new(apart.x * sine_of(share), apart.y)
}

fn widened_row(
    tiles: &TwinTiles,
    face: u32,
    place: Vec2,
    [row, start, count]: [u32; 3],
    known: f32,
) -> f32 {
    let (size, cell) = (tiles.size(), Vec2::from(tiles.params.cell));
    let low_row = row as f32 * cell.y;
    let nearest = place.y.clamp(low_row, (low_row + cell.y).min(size.y));
    let level = (sine_of(place.y / size.y) * sine_of(nearest / size.y)).sqrt();
    let mut widest = known;
    for k in 0..count {
        let column = (start + k) % tiles.params.cells[0];
        let low = column as f32 * cell.x;
        let high = (low + cell.x).min(size.x);
        let from_middle = (place.x - 0.5 * (low + high)).abs();
        let around = from_middle.min(size.x - from_middle);
        let aside = (around - 0.5 * (high - low)).max(0.0);
        let chord = size.x / PI * sine_of(aside / size.x) * level;
        let away = Vec2::new(chord, place.y - nearest).length();
        let scale = scale_of(tiles, shown_in(tiles, face, UVec2::new(column, row)));
        widest = widest.max(scale - away / tiles.params.growth);
    }
    widest
}

pub(crate) fn widened_across(tiles: &TwinTiles, face: u32, place: Vec2, known: f32) -> f32 {
    let size = tiles.size();
    let reach = tiles.params.growth * (tiles.params.coarsest_scale - known);
    if reach <= 0.0 {
        return known;
    }
    let to_pole = place.y.min(size.y - place.y) - reach;
    let half_turn = 0.5 * size.x;
    let level = sine_of((to_pole / size.y).clamp(0.0, 0.5));
    let half = (0.5 * PI * reach / level.max(1e-6)).min(half_turn);
    let around = Vec2::new(half, reach);
    let low = place - around;
    let high = place + around;
    let from_cell = cell_at(tiles, low);
    let to_cell = cell_at(tiles, high);
    let within = low.cmpge(Vec2::ZERO).all() && high.cmplt(size).all() && half < half_turn;
    if within && from_cell == to_cell {
        return known;
    }
    let start = cell_at(tiles, closed(tiles, Vec2::new(low.x, place.y))).x;
    let count = ((2.0 * half / tiles.params.cell[0]) as u32 + 3).min(tiles.params.cells[0]);
    let mut widest = known;
    for row in from_cell.y..=to_cell.y {
        widest = widened_row(tiles, face, place, [row, start, count], widest);
    }
    widest
}

pub(crate) fn beside_edge(tiles: &TwinTiles, face: u32, place: Vec2) -> (u32, Vec2) {
    let place = closed(tiles, place);
    (face, place.clamp(Vec2::splat(0.5), tiles.size() - 0.5))
}

fn last_tap(axis: &Axis) -> Tap {
    let last = axis.last_segment;
    tap_at(axis, last, samples_in(axis, last) - 1)
}

pub(crate) fn beyond_edges(axis: &Axis, k: usize) -> Vec2 {
    let depths = Vec2::new(tap_at(axis, 0, 0).centre, axis.size - last_tap(axis).centre);
    if k == 1 { depths } else { depths.yx() }
}

pub(crate) fn corner_sample(
    tiles: &TwinTiles,
    corner: u32,
    (plane, level): (Plane, u32),
    face: u32,
    place: Vec2,
    [x, y]: [&Bracket; 2],
) -> Vec2 {
    let right = corner & 1 != 0;
    let below = corner & 2 != 0;
    let row = tap_of(y, below);
    let axis = axis_of(tiles, plane, level, 0);
    let half_turn = Vec2::new(0.5 * tiles.size().x, 0.0);
    let turned = closed(tiles, place + half_turn).x;
    let over_pole = bracket(&axis, turned, beyond_edges(&axis, 0));
    let along = if row.beyond != 0 { &over_pole } else { x };
    let column = tap_of(along, right);
    let within = match column.beyond {
        ..0 => last_tap(&axis).within,
        0 => column.within,
        _ => tap_at(&axis, 0, 0).within,
    };
    let weight = weight_of(along, right) * weight_of(y, below);
    fetch(tiles, plane, level, face, Vec2::new(within, row.within)) * weight
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};
    use foveal_core::units::Radians;
    use foveal_core::view::axes::Axes;
    use foveal_core::view::eye_view::{EyeView, Field};
    use foveal_core::view::picture::{Colour, Matrix};
    use foveal_core::view::surface::{Eye, Surface};

    fn tiles(size: [u32; 2]) -> TwinTiles {
        let grid = TileGrid::new(Surface::equirect(size), Cut::Tile(256), 5, 2).unwrap();
        let colour = Colour {
            matrix: Matrix::Bt709,
            full_range: true,
            chroma_left: false,
        };
        TwinTiles::new(&grid, colour)
    }

    #[test]
    fn places_and_sines_are_those_of_core() {
        for step in 0..=1000 {
            let share = step as f32 / 1000.0;
            let exact = (f64::from(share) * std::f64::consts::PI).sin();
            assert!((f64::from(sine_of(share)) - exact).abs() < 3e-7, "{share}");
        }
        for (size, turn) in [
            ([16_384, 8192], [179.0, 3.0]),
            ([16_384, 8192], [20.0, 88.0]),
            ([4096, 4096], [-60.0, -70.0]),
        ] {
            let tiles = tiles(size);
            let [yaw, pitch] = turn.map(Radians::from_degrees);
            let view = EyeView {
                position: Default::default(),
                axes: Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.3)),
                field: Field::across(Radians::from_degrees(60.0), [90, 60]),
                size: [90, 60],
                eye: Eye::Left,
            };
            let surface = &tiles.grid.surface;
            let params = View {
                content_from_pixel: view.content_from_pixel(surface).as_mat3(),
                first_face: 0,
            };
            for pixel in (0..90 * 60).map(|k| [k % 90, k / 90]) {
                let at = pixel.map(|k| f64::from(k) + 0.5);
                let seen = seen_by(&tiles, &params, Vec2::from(at.map(|k| k as f32)));
                let direction = view.ray(at).normalize();
                let (_, place) = surface.locate(direction).unwrap();
                // A step along a row near a pole is short.
                let level = direction.x.hypot(direction.z);
                let off = f64::from(seen.place.x) - place[0];
                let off = off.abs().min(f64::from(size[0]) - off.abs()) * level;
                assert!(off < 0.02, "{pixel:?}: {off}");
                assert!(
                    (f64::from(seen.place.y) - place[1]).abs() < 0.02,
                    "{pixel:?}"
                );
                let pixel_rad = 2.0 * (30f64).to_radians().tan() / 90.0;
                let depth = direction.dot(view.axes.forward);
                let exact = pixel_rad * depth.powf(1.5)
                    / Radians::from_degrees(1.0 / surface.ppd(place).0).0;
                assert!(
                    (f64::from(seen.footprint) / exact - 1.0).abs() < 1e-4,
                    "{pixel:?}"
                );
            }
        }
    }

    #[test]
    fn at_a_pole_the_picture_is_as_coarse_whatever_column_leads_there() {
        let mut tiles = tiles([4096, 2048]);
        let fine = tiles.grid.tile_at(0, 3);
        let [width, height] = tiles.grid.tile_size(fine);
        let picture = foveal_core::view::picture::Picture::filled(width, height, [90, 128, 128]);
        tiles.upload(fine, 0, &picture).unwrap();
        for depth in [0.0, 1e-3, 0.02] {
            let widest = |column: u32| {
                let place = Vec2::new(column as f32 * 16.0, depth);
                widened_across(&tiles, 0, place, 1.0)
            };
            let all: Vec<f32> = (0..256).map(widest).collect();
            let spread = all
                .iter()
                .fold(0.0f32, |most, it| most.max((it - all[0]).abs()));
            assert!(spread <= 1e-3 + depth * 4.0, "{depth}: {spread}");
            assert!(all[0] > 15.0, "the neighbouring columns are coarse");
        }
    }
}
