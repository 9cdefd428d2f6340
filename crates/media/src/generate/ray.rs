//! Along which line does a pixel of the generated world look?

use super::texture::visible;
use std::f32::consts::{FRAC_PI_2, PI};

/// In radians.
pub(super) const DEGREE: f32 = PI / 180.0;

/// A pixel's line of sight.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    /// Unit direction.
    pub(super) direction: [f32; 3],
    /// Radians to the right of forward.
    pub(super) yaw: f32,
    /// Radians above the horizon.
    pub(super) pitch: f32,
    /// Width of the pixel in radians.
    pub(super) pixel: f32,
}

/// The direction of a yaw and a pitch in degrees.
pub(super) fn toward(yaw: f32, pitch: f32) -> [f32; 3] {
    let (yaw, pitch) = (yaw * DEGREE, (pitch * DEGREE).clamp(-FRAC_PI_2, FRAC_PI_2));
    let level = libm::cosf(pitch);
    [
        libm::sinf(yaw) * level,
        libm::sinf(pitch),
        -libm::cosf(yaw) * level,
    ]
}

/// What is left of a wave of `frequency` cycles a radian.
pub(super) fn wave_left(frequency: f32, ray: &Ray) -> f32 {
    visible(frequency, ray.pixel)
}
