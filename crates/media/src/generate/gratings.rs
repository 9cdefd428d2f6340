//! Which light comes from a direction where the world is nothing but waves?

use super::colour::Rgb;
use super::ray::Ray;
use super::texture::step;
use foveal_core::view::random::Random;
use std::f64::consts::{PI, TAU};

/// Waves.
const COUNT: usize = 24;

/// Cycles a radian of the longest wave and of the shortest.
const CYCLES: [f64; 2] = [5.0, 240.0];

/// How far all waves together go from the mean at most, in linear light of 0 to 1.
const REACH: f64 = 0.48;

/// Plane waves over direction, of lengths spread evenly by their logarithm and of power 1/f.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Gratings {
    waves: Vec<Wave>,
}

#[derive(Clone, Debug, PartialEq)]
struct Wave {
    /// Cycles by unit of direction.
    vector: [f64; 3],
    cycles: f64,
    amplitude: f64,
    phase: f64,
}

impl Gratings {
    /// The waves of a seed.
    pub(super) fn new(seed: u32) -> Self {
        let mut random = Random::new(u64::from(seed));
        let cycles = |k: usize| {
            let share = k as f64 / (COUNT - 1) as f64;
            CYCLES[0] * libm::pow(CYCLES[1] / CYCLES[0], share)
        };
        let sum: f64 = (0..COUNT).map(|k| 1.0 / cycles(k).sqrt()).sum();
        let mut wave = |k| {
            let cycles = cycles(k);
            Wave {
                vector: (random.direction() * cycles).to_array(),
                cycles,
                amplitude: REACH / cycles.sqrt() / sum,
                phase: TAU * random.unit(),
            }
        };
        Self {
            waves: (0..COUNT).map(&mut wave).collect(),
        }
    }

    /// Gamma-coded colour of a direction, of what is not finer than the ray's pixel; moved on by as
    /// many cycles of every wave.
    pub(super) fn colour(&self, direction: [f64; 3], ray: &Ray, moved: f64) -> Rgb {
        let mut light = [0.5; 3];
        for wave in &self.waves {
            let left = 1.0 - step(0.4, 0.5, wave.cycles as f32 * ray.pixel);
            if left <= 0.0 {
                continue;
            }
            let [x, y, z] = wave.vector;
            let along = x * direction[0] + y * direction[1] + z * direction[2] + moved;
            for (k, channel) in light.iter_mut().enumerate() {
                let phase = wave.phase + k as f64 * PI / 3.0;
                *channel += f64::from(left) * wave.amplitude * libm::cos(TAU * along + phase);
            }
        }
        light.map(coded)
    }
}

/// The sRGB code of linear light; IEC 61966-2-1.
fn coded(light: f64) -> f32 {
    let code = if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * libm::pow(light, 1.0 / 2.4) - 0.055
    };
    code as f32
}
