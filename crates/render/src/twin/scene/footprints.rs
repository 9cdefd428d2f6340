//! How much of the view would each unit refine, and how far from the gaze? Twin of
//! `shaders/footprints.wgsl`.

use crate::scene::footprints::{FootprintSums, GazedParams, MOST_ANGLE};
use crate::twin::shared::wgsl::mix;
use glam::{Vec2, Vec3};

const PARTS_OF_RADIAN: f32 = 916.732_5;

fn ray_of(gazed: &GazedParams, place: Vec2) -> Vec3 {
    let [left, right, up, down] = gazed.field;
    Vec3::new(mix(-left, right, place.x), mix(-up, down, place.y), 1.0)
}

/// Of one pixel of an image of units.
pub(super) fn footprints(
    gazed: &GazedParams,
    pixel: [u32; 2],
    size: [u32; 2],
    sums: &mut FootprintSums,
) {
    let place = Vec2::new(pixel[0] as f32 + 0.5, pixel[1] as f32 + 0.5);
    let ray = ray_of(gazed, place / Vec2::new(size[0] as f32, size[1] as f32));
    let reach = ray.length();
    let gaze = Vec3::from(gazed.gaze);
    let angle = ray.cross(gaze).length().atan2(ray.dot(gaze));
    let parts = ((angle * PARTS_OF_RADIAN + 0.5) as u32).min(MOST_ANGLE);
    sums[0] += (64.0 / (reach * reach * reach) + 0.5) as u32;
    sums[1] += 1;
    sums[2] += parts;
    sums[3] = sums[3].max(MOST_ANGLE - parts);
}
