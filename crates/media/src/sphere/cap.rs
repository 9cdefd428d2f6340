//! What does a face show around a pole?
//!
//! Each source row near the pole is resampled to about 0.6 face samples of spacing along its
//! circle; then every sample counts by its place on the face and the area it stands for. So a row
//! beyond the pole counts where it lies, on the other side.

pub(super) mod table;

use super::kernel::{Kernel, REACH};
use super::plane::Plane;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Spacing of samples along a circle, in face samples.
const SPACING: f64 = 0.6;

/// Corrections of the areas of the first two circles: the midpoint rule over `r g(r)` from r = 0 is
/// h²/24 g(0) too large, and g(0) is (9 g(h/2) - g(3h/2)) / 8 for an even g.
const POLE_RULE: [f64; 2] = [1.0 - 9.0 / 8.0 / 12.0, 1.0 + 1.0 / 8.0 / 36.0];

/// The samples around one pole.
pub(super) struct Cap {
    circles: Vec<Circle>,
    /// Half the width of the kernel, in face samples.
    reach: f32,
    /// Tangents to face samples at the pole.
    scale: f64,
    /// How much longer a face sample is at the rim than at the pole, in tangents.
    slack: f64,
}

/// The samples of one source row, counter-clockwise or clockwise as the face sees them.
struct Circle {
    /// Row of the source, counted from the pole.
    row: usize,
    /// In face samples as they are at the pole.
    radius: f32,
    samples: Vec<Sample>,
}

/// One place of a circle.
struct Sample {
    /// Face samples from the pole.
    place: [f32; 2],
    /// Face samples squared that it stands for.
    area: f32,
    /// Code value.
    value: f32,
}

impl Cap {
    /// The samples around the upper (0) or lower (1) pole, in the orientation of the top face:
    /// `super::poles` mirrors the bottom face.
    pub(super) fn new(plane: &Plane, kernel: &Kernel, pole: usize) -> Self {
        let mut this = Self::without_values(plane);
        for circle in &mut this.circles {
            let row = if pole == 0 {
                circle.row
            } else {
                plane.height - 1 - circle.row
            };
            let turn = plane.turn(row);
            let ratio = circle.ratio(plane.width);
            let count = circle.samples.len();
            for (k, sample) in circle.samples.iter_mut().enumerate() {
                let column = plane.column(yaw_of(k, count));
                sample.value = around_turn(turn, kernel, column, ratio);
            }
        }
        this
    }

    /// The places of the samples, all of code value 0.
    fn without_values(plane: &Plane) -> Self {
        let scale = plane.samples_at_pole();
        let stretch = plane.pole_stretch();
        let reach = REACH * stretch;
        let slack = plane.slope(plane.cap_radius() + 2.0 * reach / scale) / plane.slope(0.0);
        let rim = plane.cap_radius() * scale + reach * std::f64::consts::SQRT_2 * slack;
        let step = PI / plane.height as f64;
        let mut circles = Vec::new();
        for row in 0..plane.height {
            // The one row of the smallest plane lies at 90°, where a face has no place for it.
            let from_pole = (row as f64 + 0.5) * step;
            let angle = if row == 0 {
                from_pole.min(1.4)
            } else {
                from_pole
            };
            let radius = libm::tan(angle) * scale;
            if row > 0 && (radius > rim || angle >= FRAC_PI_2) {
                break;
            }
            let cos = libm::cos(angle);
            let correction = POLE_RULE.get(row).unwrap_or(&1.0);
            let depth = step / (cos * cos) * scale * correction;
            circles.push(Circle::new(plane, row, [radius, depth], stretch));
        }
        Self {
            circles,
            reach: reach as f32,
            scale,
            slack,
        }
    }

    /// Code value at a place of the tangent plane, within the cap.
    pub(super) fn at(&self, plane: &Plane, kernel: &Kernel, a: f64, b: f64) -> u8 {
        let [mut sum, mut total] = [0.0f32; 2];
        self.each_weight(plane, kernel, [a, b], |circle, k, weight| {
            sum += weight * circle.samples[k].value;
            total += weight;
        });
        code_value(sum / total)
    }

    /// Lists each sample that counts at a place of the tangent plane, and how much.
    fn each_weight(
        &self,
        plane: &Plane,
        kernel: &Kernel,
        [a, b]: [f64; 2],
        mut tell: impl FnMut(&Circle, usize, f32),
    ) {
        let [x, y] = [a, b].map(|tangent| plane.samples_from_middle(tangent) as f32);
        let stretch = self.reach / REACH as f32;
        let far = self.reach * std::f32::consts::SQRT_2 * self.slack as f32;
        let radius = ((a * a + b * b).sqrt() * self.scale) as f32;
        let near = |circle: &&Circle| (circle.radius - radius).abs() <= far;
        for circle in self.circles.iter().filter(near) {
            for (k, sample) in circle.samples.iter().enumerate() {
                let [u, v] = sample.place;
                let [dx, dy] = [(u - x).abs(), (v - y).abs()];
                if dx < self.reach && dy < self.reach {
                    let weight = kernel.at(dx / stretch) * kernel.at(dy / stretch);
                    tell(circle, k, weight * sample.area);
                }
            }
        }
    }
}

impl Circle {
    fn new(plane: &Plane, row: usize, [radius, depth]: [f64; 2], stretch: f64) -> Self {
        let around = TAU * radius;
        let most = plane.width.max(16);
        let count = ((around / (SPACING * stretch)).ceil() as usize).clamp(16, most);
        let area = around / count as f64 * depth;
        let samples = (0..count).map(|k| {
            let yaw = yaw_of(k, count);
            let tangents = [libm::sin(yaw), libm::cos(yaw)]
                .map(|along| along * radius / plane.samples_at_pole());
            let slopes = tangents.map(|tangent| plane.slope(tangent) / plane.slope(0.0));
            Sample {
                place: tangents.map(|tangent| plane.samples_from_middle(tangent) as f32),
                area: (area / (slopes[0] * slopes[1])) as f32,
                value: 0.0,
            }
        });
        Self {
            row,
            radius: radius as f32,
            samples: samples.collect(),
        }
    }

    /// Columns a sample where a turn has `width`, at least one.
    fn ratio(&self, width: usize) -> f64 {
        (width as f64 / self.samples.len() as f64).max(1.0)
    }
}

fn yaw_of(k: usize, count: usize) -> f64 {
    TAU * k as f64 / count as f64
}

#[inline]
fn code_value(value: f32) -> u8 {
    (value + 0.5).clamp(0.0, 255.0) as u8
}

/// Filtered value at a fractional column of a turn, `ratio` columns wide a unit of the kernel.
fn around_turn(turn: &[u8], kernel: &Kernel, column: f64, ratio: f64) -> f32 {
    let reach = REACH * ratio;
    let first = (column - reach).ceil() as i64;
    let last = (column + reach).floor() as i64;
    let [mut sum, mut total] = [0.0f32; 2];
    for tap in first..=last {
        let weight = kernel.at(((tap as f64 - column) / ratio) as f32);
        sum += weight * f32::from(turn[tap.rem_euclid(turn.len() as i64) as usize]);
        total += weight;
    }
    sum / total
}
