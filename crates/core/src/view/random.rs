//! Which numbers and directions does a seed give?

use glam::DVec3;

/// A seeded generator of numbers in [0, 1): PCG-XSH-RR 64/32 (O'Neill 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The generator of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_add(0x9e37_79b9_7f4a_7c15));
        random.unit();
        random
    }

    /// The next number, uniform in [0, 1), a multiple of 2^-32.
    pub fn unit(&mut self) -> f64 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((old >> 18) ^ old) >> 27) as u32;
        f64::from(mixed.rotate_right((old >> 59) as u32)) / 4_294_967_296.0
    }

    /// A direction, uniform on the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let y = 2.0 * self.unit() - 1.0;
        let around = 2.0 * core::f64::consts::PI * self.unit();
        let level = (1.0 - y * y).max(0.0).sqrt();
        DVec3::new(level * libm::cos(around), y, level * libm::sin(around))
    }
}
