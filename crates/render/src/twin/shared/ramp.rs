//! Which colour stands for a level? Twin of `shaders/shared/ramp.wgsl`.

use super::wgsl::mix;
use glam::Vec3;

pub(crate) fn ramp(at: f32) -> Vec3 {
    let red = Vec3::new(0.843, 0.098, 0.110);
    let orange = Vec3::new(0.992, 0.682, 0.380);
    let yellow = Vec3::new(1.0, 1.0, 0.749);
    let sky = Vec3::new(0.671, 0.851, 0.914);
    let blue = Vec3::new(0.173, 0.482, 0.714);
    let x = at.clamp(0.0, 1.0) * 4.0;
    let warm = mix(
        mix(red, orange, x.clamp(0.0, 1.0)),
        yellow,
        (x - 1.0).clamp(0.0, 1.0),
    );
    mix(
        mix(warm, sky, (x - 2.0).clamp(0.0, 1.0)),
        blue,
        (x - 3.0).clamp(0.0, 1.0),
    )
}
