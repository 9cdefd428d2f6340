//! What floats in the generated world?

use super::colour::{Rgb, mix};
use super::ray::{DEGREE, Ray, toward, wave_left};
use super::texture::{bars, step};
use std::f32::consts::TAU;

/// A disc with rings that grow finer outward: every spatial frequency up to the pixel's in one
/// look.
pub(super) struct ZonePlate {
    centre: [f32; 3],
    radius: f32,
    /// Cosine beyond which nothing of the plate is seen.
    limit: f32,
    /// Cycles a radian at the rim.
    finest: f32,
    /// Cycles by which the rings have moved.
    moved: f32,
    ink: Rgb,
}

/// A striped balloon.
pub(super) struct Balloon {
    centre: [f32; 3],
    right: [f32; 3],
    up: [f32; 3],
    radius: f32,
    limit: f32,
    turned: f32,
    paints: [Rgb; 2],
}

/// Eight zone plates: six around, one at each pole, drifting.
pub(super) fn zone_plates(seconds: f32, pixel: f32) -> Vec<ZonePlate> {
    const INKS: [Rgb; 4] = [
        [0.05, 0.10, 0.28],
        [0.36, 0.06, 0.12],
        [0.03, 0.25, 0.22],
        [0.10, 0.08, 0.10],
    ];
    let places = [
        (-8.0, 20.0, 6.5),
        (52.0, 22.0, 5.5),
        (112.0, 19.0, 6.5),
        (172.0, 21.5, 6.0),
        (-128.0, 20.0, 6.5),
        (-68.0, 22.0, 5.5),
        (30.0, 90.0, 12.0),
        (0.0, -90.0, 14.0),
    ];
    let plate = |(k, (yaw, pitch, radius)): (usize, (f32, f32, f32))| {
        let sway = libm::sinf(seconds * 0.7 + k as f32) * 1.5;
        let radius = radius * DEGREE;
        ZonePlate {
            centre: toward(yaw + seconds * 1.2, pitch + sway),
            radius,
            limit: libm::cosf(radius * 1.1),
            finest: 0.36 / pixel,
            moved: seconds * if k % 2 == 0 { 0.8 } else { -0.8 },
            ink: INKS[k % 4],
        }
    };
    places.into_iter().enumerate().map(plate).collect()
}

/// Eleven balloons on their way around the world.
pub(super) fn balloons(seconds: f32) -> Vec<Balloon> {
    const PAINTS: [[Rgb; 2]; 5] = [
        [[0.92, 0.22, 0.18], [0.99, 0.86, 0.55]],
        [[0.10, 0.45, 0.62], [0.93, 0.95, 0.92]],
        [[0.98, 0.66, 0.12], [0.55, 0.12, 0.32]],
        [[0.22, 0.55, 0.32], [0.96, 0.92, 0.60]],
        [[0.46, 0.24, 0.58], [0.98, 0.62, 0.52]],
    ];
    let balloon = |k: usize| {
        let turn = k as f32 * 137.5;
        let pitch = [
            48.0, 13.0, 62.0, -24.0, 26.0, 45.0, 10.0, 56.0, -32.0, 42.0, 16.0,
        ][k];
        let radius = [5.5, 3.2, 6.5, 4.5, 3.0, 4.0, 2.4, 3.6, 6.0, 5.0, 2.8][k] * DEGREE;
        let speed = 1.5 + (k % 4) as f32 * 0.8;
        let yaw = turn - 40.0 + seconds * speed;
        let pitch = pitch + 1.5 * libm::sinf(seconds * 0.5 + turn);
        Balloon {
            centre: toward(yaw, pitch),
            right: toward(yaw + 90.0, 0.0),
            up: toward(yaw + 180.0, 90.0 - pitch),
            radius,
            limit: libm::cosf(radius * 1.9),
            turned: seconds * (0.4 + 0.1 * (k % 3) as f32),
            paints: PAINTS[k % 5],
        }
    };
    (0..11).map(balloon).collect()
}

/// Whether cones around two directions, given by the cosines of their half angles, may meet.
fn cones_meet(a: [f32; 3], cos_a: f32, b: [f32; 3], cos_b: f32) -> bool {
    let together = libm::acosf(cos_a.clamp(-1.0, 1.0)) + libm::acosf(cos_b.clamp(-1.0, 1.0));
    angle(a, b) <= together + 0.01
}

/// Scalar product.
#[inline]
pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Angle between two unit directions, exact for small angles.
fn angle(a: [f32; 3], b: [f32; 3]) -> f32 {
    let between = [0, 1, 2].map(|k| a[k] - b[k]);
    2.0 * libm::asinf((0.5 * dot(between, between).sqrt()).min(1.0))
}

impl ZonePlate {
    /// Whether some of it may lie in a cone around `axis` of the cosine `within`.
    pub(super) fn meets(&self, axis: [f32; 3], within: f32) -> bool {
        cones_meet(self.centre, self.limit, axis, within)
    }

    /// The plate over what lies behind it.
    #[inline]
    pub(super) fn over(&self, behind: Rgb, ray: &Ray) -> Rgb {
        if dot(self.centre, ray.direction) < self.limit {
            return behind;
        }
        let from_centre = angle(self.centre, ray.direction);
        let covered = |radius: f32| ((radius - from_centre) / ray.pixel + 0.5).clamp(0.0, 1.0);
        // Frequency grows linearly from the centre, so phase with the square.
        let frequency = self.finest * from_centre / self.radius;
        let cycles = 0.5 * frequency * from_centre - self.moved;
        let wave = libm::cosf(TAU * (cycles - cycles.floor())) * wave_left(frequency, ray);
        let rings = mix(self.ink, [0.98, 0.96, 0.90], 0.5 + 0.5 * wave);
        let rimmed = mix(behind, [0.98, 0.80, 0.45], covered(self.radius * 1.06));
        mix(rimmed, rings, covered(self.radius))
    }
}

impl Balloon {
    /// Whether some of it may lie in a cone around `axis` of the cosine `within`.
    pub(super) fn meets(&self, axis: [f32; 3], within: f32) -> bool {
        cones_meet(self.centre, self.limit, axis, within)
    }

    /// The balloon over what lies behind it.
    #[inline]
    pub(super) fn over(&self, behind: Rgb, ray: &Ray) -> Rgb {
        let depth = dot(self.centre, ray.direction);
        if depth < self.limit {
            return behind;
        }
        let scale = 1.0 / (depth * self.radius);
        let x = dot(self.right, ray.direction) * scale;
        let y = dot(self.up, ray.direction) * scale;
        let pixel = ray.pixel / self.radius;
        let colour = self.basket_over(behind, x, y, pixel);
        // Below its equator the envelope narrows to a mouth.
        let narrowed = if y < 0.0 { 1.0 + 0.30 * y * y } else { 1.0 };
        let (x, y) = (x * narrowed, if y < 0.0 { y * 0.84 } else { y });
        let radius = (x * x + y * y).sqrt();
        let covered = ((1.0 - radius) / pixel + 0.5).clamp(0.0, 1.0);
        if covered <= 0.0 {
            return colour;
        }
        let front = (1.0 - radius * radius).max(0.0).sqrt();
        let level = (1.0 - y * y).max(1e-4).sqrt();
        let around = libm::asinf((x / level).clamp(-1.0, 1.0)) + self.turned;
        let stretch = pixel / front.max(0.08);
        let gore = bars(around * 16.0 / TAU, 0.5, stretch * 16.0 / TAU);
        let seam = bars(around * 64.0 / TAU, 0.12, stretch * 64.0 / TAU);
        let hoop = bars(y * 9.0, 0.10, pixel * 9.0);
        let belt = step(0.16 + pixel, 0.16, (y - 0.05).abs());
        let mut paint = mix(self.paints[0], self.paints[1], gore);
        paint = mix(paint, self.paints[1].map(|k| 0.35 * k), 0.9 * belt);
        let check = bars(around * 48.0 / TAU, 0.5, stretch * 48.0 / TAU);
        paint = mix(
            paint,
            self.paints[1],
            belt * check * step(0.11 + pixel, 0.11, (y - 0.05).abs()),
        );
        let light = (0.62 + 0.30 * front + 0.22 * y - 0.14 * x) * (1.0 - 0.22 * seam.max(hoop));
        mix(colour, paint.map(|k| (k * light).min(1.0)), covered)
    }

    /// Basket and ropes under the envelope.
    fn basket_over(&self, behind: Rgb, x: f32, y: f32, pixel: f32) -> Rgb {
        let edge = |k: f32| (k / pixel + 0.5).clamp(0.0, 1.0);
        let basket = edge(0.16 - x.abs()) * edge(0.12 - (y + 1.62).abs());
        let weave = bars(x * 20.0, 0.5, pixel * 20.0) * bars(y * 20.0, 0.5, pixel * 20.0);
        let rope_x = 0.15 + (y + 1.5) * 0.35;
        let rope = edge(0.012 - (x.abs() - rope_x).abs()) * edge(0.28 - (y + 1.28).abs());
        let roped = mix(behind, [0.20, 0.14, 0.12], 0.8 * rope.min(0.024 / pixel));
        mix(
            roped,
            mix([0.42, 0.26, 0.15], [0.66, 0.45, 0.26], weave),
            basket,
        )
    }
}
