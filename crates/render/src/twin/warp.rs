//! Which light does a pixel of a panel send? Twin of `shaders/warp.wgsl`.

use super::fading::light_shared;
use super::filters::{Taken, TwinSource, filtered, widened_by};
use super::projected::{Projected, projected};
use super::shared::wgsl::mix;
use crate::warp::WarpPlan;
use crate::warp::params::WarpParams;
use glam::{Mat3, UVec2, Vec2, Vec3, Vec4};

const UNLIT: f32 = 1e5;

pub(super) struct MovedPixel {
    pub(super) pixel: Vec2,
    right: Vec2,
    down: Vec2,
}

fn nodes_of(plan: &WarpPlan, index: usize) -> UVec2 {
    let cell = plan.panels[index].cell;
    (UVec2::from(plan.panels[index].size) + cell - 1) / cell + 1
}

fn node(plan: &WarpPlan, index: usize, at: UVec2, channel: u32) -> Vec2 {
    let nodes = nodes_of(plan, index);
    let k = plan.panels[index].grid + 2 * ((channel * nodes.y + at.y) * nodes.x + at.x);
    Vec2::new(
        f32::from_bits(plan.grids[k as usize]),
        f32::from_bits(plan.grids[k as usize + 1]),
    )
}

fn moved_by(plan: &WarpPlan, index: usize, pixel: Vec2, channel: u32) -> MovedPixel {
    if plan.panels[index].cell == 0 {
        return MovedPixel {
            pixel,
            right: Vec2::X,
            down: Vec2::Y,
        };
    }
    let cell = plan.panels[index].cell as f32;
    let most = nodes_of(plan, index).as_vec2() - 2.0;
    let low = (pixel / cell).floor().clamp(Vec2::ZERO, most);
    let part = pixel / cell - low;
    let at = low.as_uvec2();
    let a = node(plan, index, at, channel);
    let b = node(plan, index, at + UVec2::new(1, 0), channel);
    let c = node(plan, index, at + UVec2::new(0, 1), channel);
    let d = node(plan, index, at + UVec2::new(1, 1), channel);
    let by = mix(mix(a, b, part.x), mix(c, d, part.x), part.y);
    let right = mix(b - a, d - c, part.y) / cell;
    let down = mix(c - a, d - b, part.x) / cell;
    MovedPixel {
        pixel: pixel + by,
        right: Vec2::X + right,
        down: Vec2::Y + down,
    }
}

fn mapped(plan: &WarpPlan, index: usize, pixel: Vec2) -> Projected {
    let at = pixel.as_uvec2();
    let k = (plan.panels[index].grid + 3 * (at.y * plan.panels[index].size[0] + at.x)) as usize;
    let halves = |bits: u32| Vec2::new((bits >> 16) as f32, (bits & 0xffff) as f32);
    let steps = plan.grids[k + 2].to_le_bytes();
    let steps = steps.map(|byte| 4.0 * f32::from(byte.cast_signed().max(-127)) / 127.0);
    Projected {
        ahead: true,
        at: halves(plan.grids[k]) + halves(plan.grids[k + 1]) / 65_536.0,
        right: Vec2::new(steps[0], steps[2]),
        down: Vec2::new(steps[1], steps[3]),
    }
}

fn spread_by(plan: &WarpPlan, params: &WarpParams, index: usize, ray: Vec3) -> Vec3 {
    let sight = &plan.sights[plan.panels[index].sight as usize];
    let seen = matrix(&sight.world_from_source) * ray;
    let direction = seen.normalize();
    let ahead = Vec3::new(params.spread[0], -params.spread[1], 0.0);
    let onto = ahead.dot(direction) / (1.0 - direction.z).max(1e-6);
    let turned = ahead - onto * (direction - Vec3::Z);
    matrix(&sight.source_from_world) * (turned * seen.length())
}

fn matrix(columns: &[[f32; 4]; 3]) -> Mat3 {
    let [x, y, z] = columns.map(|it| Vec4::from(it).truncate());
    Mat3::from_cols(x, y, z)
}

/// A place in the source, and the ray that led there.
pub(super) struct SeenTexel {
    pub(super) taken: Taken,
    ray: Vec3,
}

/// Where in the source a pixel as sent looks; `None` where it is black.
pub(super) fn seen_by(
    plan: &WarpPlan,
    index: usize,
    pixel: Vec2,
    channel: u32,
) -> Option<SeenTexel> {
    let moved = moved_by(plan, index, pixel, channel);
    let panel = &plan.panels[index];
    let m = Mat3::from_cols(panel.right.into(), panel.down.into(), panel.corner.into());
    let ray = m * moved.pixel.extend(1.0);
    let seen = if panel.projection == 4 {
        mapped(plan, index, pixel)
    } else {
        let (right, down) = (m * moved.right.extend(0.0), m * moved.down.extend(0.0));
        projected(panel.projection, ray, right, down)
    };
    let scale = Vec2::from(panel.scale);
    let at = seen.at * scale + Vec2::from(panel.offset);
    let low = Vec2::from(panel.low);
    let high = Vec2::from(panel.high);
    let is_lit = moved.pixel.x.abs() < UNLIT;
    let inside = seen.ahead && is_lit && at.cmpge(low).all() && at.cmple(high).all();
    let taken = Taken {
        at,
        right: seen.right * scale,
        down: seen.down * scale,
        low,
        high,
    };
    inside.then_some(SeenTexel { taken, ray })
}

fn seen_light(
    (source, plan, params): (&TwinSource, &WarpPlan, &WarpParams),
    index: usize,
    pixel: Vec2,
    channel: u32,
) -> Vec3 {
    let Some(SeenTexel { taken, ray }) = seen_by(plan, index, pixel, channel) else {
        return Vec3::ZERO;
    };
    if params.blurs() {
        let panel = &plan.panels[index];
        let spread = spread_by(plan, params, index, ray);
        let line = projected(panel.projection, ray, spread, Vec3::ZERO).right;
        let taken = widened_by(&taken, line * Vec2::from(panel.scale));
        return filtered(source, params, &taken);
    }
    filtered(source, params, &taken)
}

fn share_of(plan: &WarpPlan, index: usize, pixel: Vec2) -> Vec2 {
    let black = plan.panels[index].black;
    if plan.panels[index].blend == 0 {
        return Vec2::new(1.0, black);
    }
    let blend = plan.panels[index].blend as usize - 1;
    let record = &plan.blends[blend];
    let m = Mat3::from_cols(
        record.right.into(),
        record.down.into(),
        record.corner.into(),
    );
    let green = (plan.panels[index].channels - 1).min(1);
    let direction = (m * moved_by(plan, index, pixel, green).pixel.extend(1.0)).normalize();
    let shared_light = light_shared(plan, blend, direction);
    Vec2::new(shared_light.x, black * shared_light.y)
}

fn kept_by(plan: &WarpPlan, index: usize, pixel: Vec2) -> f32 {
    if plan.panels[index].alpha == 0 {
        return 1.0;
    }
    let at = pixel.as_uvec2();
    let k = at.y * plan.panels[index].size[0] + at.x;
    let pair = plan.grids[(plan.panels[index].alpha - 1 + k / 2) as usize];
    ((pair >> (16 * (k & 1))) & 0xffff) as f32 / 65_535.0
}

pub(super) fn warp(
    (source, plan, params): (&TwinSource, &WarpPlan, &WarpParams),
    index: usize,
    position: Vec2,
) -> Vec3 {
    let pixel = position - UVec2::from(plan.panels[index].origin).as_vec2();
    let from = (source, plan, params);
    let mut light = seen_light(from, index, pixel, 0);
    if plan.panels[index].channels == 3 {
        light.y = seen_light(from, index, pixel, 1).y;
        light.z = seen_light(from, index, pixel, 2).z;
    }
    let share = share_of(plan, index, pixel);
    let kept = share.x * kept_by(plan, index, pixel);
    let sent = (light * Vec3::from(plan.panels[index].gain) * kept).clamp(Vec3::ZERO, Vec3::ONE);
    Vec3::splat(share.y) + (1.0 - share.y) * sent
}
