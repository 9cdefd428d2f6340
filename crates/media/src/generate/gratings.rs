//! Which light comes from a direction where the world is nothing but waves?

use super::colour::Rgb;
use super::ray::Ray;
use super::texture::step;
use foveal_core::view::random::Random;
use std::f64::consts::TAU;

/// Waves.
const COUNT: usize = 24;

/// Cycles a radian of the longest wave and of the shortest.
const CYCLES: [f64; 2] = [5.0, 240.0];

/// Root mean square of all waves together, in linear light of 0 to 1; what goes beyond is cut.
const RMS: f64 = 0.17;

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
        let power: f64 = (0..COUNT).map(|k| 0.5 / cycles(k)).sum();
        let mut wave = |k| {
            let cycles = cycles(k);
            Wave {
                vector: (random.direction() * cycles).to_array(),
                cycles,
                amplitude: RMS / (cycles * power).sqrt(),
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
            let [x, y, z] = wave.vector;
            let along = x * direction[0] + y * direction[1] + z * direction[2];
            // A wave that runs away from the eye is long across.
            let across = (wave.cycles * wave.cycles - along * along).max(0.0).sqrt();
            let left = 1.0 - step(0.45, 0.5, across as f32 * ray.pixel);
            if left <= 0.0 {
                continue;
            }
            let turn = TAU * (along + moved) + wave.phase;
            let (sin, cos) = libm::sincos(turn);
            // Colours are a sixth of a turn apart.
            let height = f64::from(left) * wave.amplitude;
            let [half, third] = [0.5, 0.75_f64.sqrt()];
            light[0] += height * cos;
            light[1] += height * (half * cos - third * sin);
            light[2] += height * (-half * cos - third * sin);
        }
        light.map(coded)
    }
}

/// The sRGB code of linear light; IEC 61966-2-1.
fn coded(light: f64) -> f32 {
    let light = light.clamp(0.0, 1.0);
    let code = if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * libm::pow(light, 1.0 / 2.4) - 0.055
    };
    code as f32
}
