//! How much of the light does each of several panels give that show one direction? Twin of
//! `shaders/shared/fading.wgsl`.

use super::shared::wgsl::mix;
use crate::warp::WarpPlan;
use glam::{UVec2, Vec2, Vec3};

fn inside_edges(plan: &WarpPlan, blend: usize, direction: Vec3) -> Vec2 {
    let record = &plan.blends[blend];
    let scale = 2.0 / (1.0 + Vec3::from(record.chart_axis).dot(direction)).max(1e-6);
    let right = Vec3::from(record.chart_right).dot(direction);
    let down = Vec3::from(record.chart_down).dot(direction);
    let at = (Vec2::new(right, down) * scale - Vec2::from(record.low)) * record.per_step;
    let nodes = UVec2::from(record.nodes);
    if !(at.cmpge(Vec2::ZERO).all() && at.cmple((nodes - 1).as_vec2()).all()) {
        return Vec2::splat(-1.0);
    }
    let low = at.floor().min((nodes - 2).as_vec2());
    let part = at - low;
    let k = (record.field + low.y as u32 * nodes.x + low.x as u32) as usize;
    let field = |k: usize| Vec2::from(plan.fields[k]);
    let upper = mix(field(k), field(k + 1), part.x);
    let lower = mix(
        field(k + nodes.x as usize),
        field(k + nodes.x as usize + 1),
        part.x,
    );
    mix(upper, lower, part.y)
}

fn weight_of(plan: &WarpPlan, blend: usize, inside: Vec2) -> f32 {
    (inside.x * plan.blends[blend].sharpness).clamp(0.0, 1.0)
}

pub(super) fn light_shared(plan: &WarpPlan, blend: usize, direction: Vec3) -> Vec2 {
    let record = &plan.blends[blend];
    let own = weight_of(plan, blend, inside_edges(plan, blend, direction)).max(1e-6);
    let mut sum = own;
    let mut showing = 1.0;
    for k in record.first..record.first + record.count {
        let neighbour = plan.neighbours[k as usize] as usize;
        let inside = inside_edges(plan, neighbour, direction);
        let other = match inside.y > 0.0 {
            true => weight_of(plan, neighbour, inside),
            false => 0.0,
        };
        sum += other;
        showing += if other > 0.0 { 1.0 } else { 0.0 };
    }
    Vec2::new(own / sum, (record.most - showing).max(0.0))
}
