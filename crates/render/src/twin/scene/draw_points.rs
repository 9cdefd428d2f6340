//! Which colour has each pixel of the nearest point? Twin of `shaders/draw_points.wgsl`.

use super::draw_clusters::clip_from_view;
use crate::points::params::{CubeParams, NONE};
use crate::twin::shared::ramp::ramp;
use crate::twin::shared::raster::Corner;
use crate::twin::shared::scene::{SceneInView, times};
use crate::twin::shared::wgsl::mix;
use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::points::cut::ShownPoint;
use glam::{Vec2, Vec3, Vec4};

const HIGHEST: u32 = 15;
const COVERS: f32 = 0.75;

/// Cubes where they stand, and the view's pixels.
pub(super) struct CloudInView {
    pub(super) cubes: Vec<CubeParams>,
    pub(super) half_pixel: Vec2,
}

/// A square that is drawn for a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    pub(super) corners: [Corner; 4],
    pub(super) colour: Vec3,
    pub(super) refiner: u32,
}

fn octant_at(place: [u16; 3], bit: u32) -> usize {
    let far = place.map(|it| usize::from(it) >> bit & 1);
    far[0] | far[1] << 1 | far[2] << 2
}

// The finest cube that is there round a place of a cube, and which of its octants that is.
fn finest_at(cloud: &CloudInView, first: u32, place: [u16; 3]) -> (usize, usize) {
    let mut cube = first as usize;
    let mut octant = octant_at(place, HIGHEST);
    let mut bit = HIGHEST;
    while bit > 0 && cloud.cubes[cube].octants[octant] != NONE {
        cube = cloud.cubes[cube].octants[octant] as usize;
        octant = octant_at(place, bit - 1);
        bit -= 1;
    }
    (cube, octant)
}

fn place_in_view(cube: &CubeParams, place: [u16; 3]) -> Vec3 {
    let at = Vec3::from(place.map(f32::from)).extend(1.0);
    times(&cube.view_from_cube, at)
}

// Half a side of the square of a point, at its depth: at least half a pixel.
fn half_side(scene: &SceneInView, cloud: &CloudInView, spacing: f32, depth: f32) -> Vec2 {
    let [x, y, ..] = scene.params.clip_from_view;
    let seen = COVERS * spacing * Vec2::new(x, y).abs();
    seen.max(depth * cloud.half_pixel)
}

fn coloured(scene: &SceneInView, level: u32, code: Vec3) -> Vec3 {
    let of_level = ramp(level as f32 / scene.params.coarsest);
    mix(code, of_level, scene.params.tint)
}

/// Of a point of a cube, by that number.
pub(super) fn place_splat(
    scene: &SceneInView,
    cloud: &CloudInView,
    cube: u32,
    (point, of): (&ShownPoint, &Cloud),
) -> Splat {
    let (finest, octant) = finest_at(cloud, cube, point.place);
    let at = place_in_view(&cloud.cubes[cube as usize], point.place);
    let half = half_side(scene, cloud, cloud.cubes[finest].spacing, at.z);
    let corner = |corner: usize| {
        let side = Vec2::new((corner & 1) as f32, (corner >> 1) as f32) * 2.0 - 1.0;
        let off = side * half;
        Corner {
            position: clip_from_view(scene, at) + Vec4::new(off.x, off.y, 0.0, 0.0),
            place: at,
            ..Corner::default()
        }
    };
    let code = point
        .colour
        .map(|code| f32::from(of.shown_code(code)) / 255.0);
    Splat {
        corners: [0, 1, 2, 3].map(corner),
        colour: coloured(scene, cloud.cubes[finest].level, Vec3::from(code)),
        refiner: cloud.cubes[finest].refiners[octant],
    }
}

pub(super) fn draw_points(splat: &Splat) -> Vec4 {
    splat.colour.extend(1.0)
}

pub(super) fn draw_point_refiners(splat: &Splat) -> u32 {
    splat.refiner
}
