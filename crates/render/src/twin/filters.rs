//! How much of a picture does a pixel take? Twin of `shaders/shared/filters.wgsl`.
//!
//! What a device's own anisotropic filter takes is its own affair: here it is never `by_device`.
//! The elliptical weighted average is here alone.

use super::reduce_source::{Light, reduced, srgb_code};
use super::shared::wgsl::mix;
use crate::image::RgbaImage;
use crate::warp::levels_of;
use crate::warp::params::WarpParams;
use glam::{Vec2, Vec3, Vec4};

/// A source with its coarser levels, in linear light.
pub struct TwinSource {
    levels: Vec<Light>,
}

pub(super) struct Taken {
    pub(super) at: Vec2,
    pub(super) right: Vec2,
    pub(super) down: Vec2,
    pub(super) low: Vec2,
    pub(super) high: Vec2,
}

#[derive(Clone, Copy)]
pub(super) struct Stretch {
    pub(super) major: f32,
    pub(super) minor: f32,
    pub(super) axis: Vec2,
}

pub(super) struct TakenProbes {
    pub(super) count: f32,
    pub(super) level: f32,
    pub(super) step: Vec2,
    pub(super) major: f32,
}

impl TwinSource {
    /// A source, with coarser levels where some panel minifies it.
    #[must_use]
    pub fn new(picture: &RgbaImage, has_levels: bool) -> Self {
        let mut levels = vec![Light::of(picture)];
        let count = if has_levels {
            levels_of(picture.size)
        } else {
            1
        };
        for level in 1..count as usize {
            let coarser = reduced(&levels[level - 1]);
            levels.push(Light::of(&coarser));
        }
        Self { levels }
    }

    /// How many levels it has.
    #[must_use]
    pub fn levels(&self) -> u32 {
        self.levels.len() as u32
    }

    /// The codes of a level.
    #[must_use]
    pub fn level(&self, level: usize) -> RgbaImage {
        let light = &self.levels[level];
        let mut image = RgbaImage::black(light.size);
        for y in 0..light.size[1] {
            for x in 0..light.size[0] {
                let colour = light.load(Vec2::new(x as f32, y as f32));
                image.set_pixel([x, y], srgb_code(colour));
            }
        }
        image
    }

    fn size(&self) -> Vec2 {
        self.levels[0].size()
    }
}

#[derive(Clone, Copy)]
struct Along {
    most: f32,
    beyond: f32,
}

pub(super) fn stretch_of(right: Vec2, down: Vec2) -> Stretch {
    let a = right.x * right.x + down.x * down.x;
    let b = right.x * right.y + down.x * down.y;
    let c = right.y * right.y + down.y * down.y;
    let root = (0.25 * (a - c) * (a - c) + b * b).sqrt();
    let major = (0.5 * (a + c) + root).max(1e-20).sqrt();
    let minor = (right.x * down.y - right.y * down.x).abs() / major;
    let mut axis = Vec2::X;
    if root > 1e-12 {
        let turn = 0.5 * (2.0 * b).atan2(a - c);
        axis = Vec2::new(turn.cos(), turn.sin());
    }
    Stretch { major, minor, axis }
}

pub(super) fn widened_by(taken: &Taken, line: Vec2) -> Taken {
    let right = taken.right;
    let down = taken.down;
    let a = right.x * right.x + down.x * down.x + line.x * line.x;
    let b = right.x * right.y + down.x * down.y + line.x * line.y;
    let c = right.y * right.y + down.y * down.y + line.y * line.y;
    let root = (0.25 * (a - c) * (a - c) + b * b).sqrt();
    let major = (0.5 * (a + c) + root).max(1e-20).sqrt();
    let areas = Vec3::new(
        right.x * down.y - right.y * down.x,
        right.x * line.y - right.y * line.x,
        down.x * line.y - down.y * line.x,
    );
    let turn = if root > 1e-12 {
        0.5 * (2.0 * b).atan2(a - c)
    } else {
        0.0
    };
    let axis = Vec2::new(turn.cos(), turn.sin());
    let across = Vec2::new(-axis.y, axis.x) * (areas.length() / major);
    Taken {
        at: taken.at,
        right: axis * major,
        down: across,
        low: taken.low,
        high: taken.high,
    }
}

pub(super) fn probes_of(stretch: Stretch, most: f32, last: f32) -> TakenProbes {
    let major = stretch.major.max(1.0);
    let mut minor = stretch.minor.max(1.0);
    let wanted = 2.0 * major / minor - 1.0;
    let mut count = (wanted + 0.5).floor().min(most);
    if count < wanted {
        minor = 2.0 * major / (count + 1.0);
    }
    let mut level = minor.log2();
    if level > last {
        level = last;
        count = 1.0;
    }
    let mut step = Vec2::ZERO;
    if count > 1.0 {
        step = stretch.axis * (2.0 * (major - minor) / (count - 1.0));
    }
    TakenProbes {
        count,
        level,
        step,
        major,
    }
}

fn light_at(source: &TwinSource, taken: &Taken, at: Vec2, level: f32) -> Vec3 {
    let border = Vec2::splat(0.5 * level.exp2());
    let middle = 0.5 * (taken.low + taken.high);
    let low = (taken.low + border).min(middle);
    let inside = at.clamp(low, (taken.high - border).max(middle));
    sample_level(source, inside / source.size(), level)
}

/// WGSL's `textureSampleLevel`.
fn sample_level(source: &TwinSource, place: Vec2, level: f32) -> Vec3 {
    let last = source.levels.len() - 1;
    let level = level.clamp(0.0, last as f32);
    let low = level.floor() as usize;
    let finer = source.levels[low].sample(place);
    match level - low as f32 {
        0.0 => finer,
        part => mix(
            finer,
            source.levels[(low + 1).min(last)].sample(place),
            part,
        ),
    }
}

fn trilinear(source: &TwinSource, taken: &Taken) -> Vec3 {
    let step = taken.right.dot(taken.right).max(taken.down.dot(taken.down));
    let level = (0.5 * step.max(1e-20).log2()).max(0.0);
    light_at(source, taken, taken.at, level)
}

const UNDERSHOOT: f32 = -0.6;

fn keys(t: f32) -> Vec4 {
    let s = 1.0 - t;
    let outer = UNDERSHOOT * Vec2::new(t * s * s, s * t * t);
    let first = 1.0 + t * t * ((UNDERSHOOT + 2.0) * t - (UNDERSHOOT + 3.0));
    let second = 1.0 + s * s * ((UNDERSHOOT + 2.0) * s - (UNDERSHOOT + 3.0));
    Vec4::new(outer.x, first, second, outer.y)
}

fn bicubic(source: &TwinSource, taken: &Taken) -> Vec3 {
    let texel = (taken.at - 0.5).floor() + 0.5;
    let part = taken.at - texel;
    let wx = keys(part.x);
    let wy = keys(part.y);
    let x = Vec3::new(-1.0, wx.z / (wx.y + wx.z), 2.0) + texel.x;
    let y = Vec3::new(-1.0, wy.z / (wy.y + wy.z), 2.0) + texel.y;
    let weight_x = Vec3::new(wx.x, wx.y + wx.z, wx.w);
    let weight_y = Vec3::new(wy.x, wy.y + wy.z, wy.w);
    let mut sum = Vec3::ZERO;
    for row in 0..3 {
        for column in 0..3 {
            let weight = weight_x[column] * weight_y[row];
            sum += weight * light_at(source, taken, Vec2::new(x[column], y[row]), 0.0);
        }
    }
    sum.max(Vec3::ZERO)
}

fn anisotropic(source: &TwinSource, taken: &Taken, along: Along) -> Vec3 {
    let right = taken.right.length();
    let down = taken.down.length();
    let longest = right.max(down);
    let count = (longest / right.min(down).max(1e-10))
        .ceil()
        .clamp(1.0, along.most);
    let level = (longest / count).max(1e-10).log2().max(0.0);
    let longer = if right > down {
        taken.right
    } else {
        taken.down
    };
    let step = longer / (count + along.beyond);
    let mut sum = Vec3::ZERO;
    for k in 0..count as u32 {
        let n = k as f32 - 0.5 * (count - 1.0);
        sum += light_at(source, taken, taken.at + n * step, level);
    }
    sum / count
}

fn feline(source: &TwinSource, taken: &Taken, probes: &TakenProbes) -> Vec3 {
    let mut sum = Vec3::ZERO;
    let mut weights = 0.0;
    let length = probes.step.length() / probes.major;
    for k in 0..probes.count as u32 {
        let n = k as f32 - 0.5 * (probes.count - 1.0);
        let weight = (-2.0 * n * n * length * length).exp();
        sum += weight * light_at(source, taken, taken.at + n * probes.step, probes.level);
        weights += weight;
    }
    sum / weights
}

const FIRST_MINIFIED: f32 = 1.0;
const ALL_MINIFIED: f32 = 1.5;

fn automatic(source: &TwinSource, taken: &Taken, stretch: Stretch, along: Along) -> Vec3 {
    let share =
        ((stretch.major - FIRST_MINIFIED) / (ALL_MINIFIED - FIRST_MINIFIED)).clamp(0.0, 1.0);
    let share = share * share * (3.0 - 2.0 * share);
    if share <= 0.0 {
        return bicubic(source, taken);
    }
    if share >= 1.0 {
        return anisotropic(source, taken, along);
    }
    mix(
        bicubic(source, taken),
        anisotropic(source, taken, along),
        share,
    )
}

/// What a texel more or less weighs within a pixel's ellipse, in double precision and on the
/// finest level: the elliptical weighted average of Greene and Heckbert 1986, section 4, and
/// Heckbert 1989, section 3.5, widened by one texel for the source's own pixels. The oracle of all
/// other filters.
fn ewa(source: &TwinSource, taken: &Taken) -> Vec3 {
    let [ux, vx] = taken.right.as_dvec2().to_array();
    let [uy, vy] = taken.down.as_dvec2().to_array();
    let a = vx * vx + vy * vy + 1.0;
    let b = -2.0 * (ux * vx + uy * vy);
    let c = ux * ux + uy * uy + 1.0;
    let f = a * c - b * b / 4.0;
    let at = taken.at.as_dvec2();
    let reach = [c.sqrt(), a.sqrt()];
    let [first, last] = [-1.0, 1.0].map(|sign| {
        let edge = |k: usize| (at[k] - 0.5 + sign * reach[k]).round() as i64;
        [edge(0), edge(1)]
    });
    let (mut sum, mut weights) = (glam::DVec3::ZERO, 0.0);
    for y in first[1]..=last[1] {
        for x in first[0]..=last[0] {
            let (du, dv) = (x as f64 + 0.5 - at.x, y as f64 + 0.5 - at.y);
            let q = (a * du * du + b * du * dv + c * dv * dv) / f;
            if q < 1.0 {
                let weight = (-2.0 * q).exp();
                let texel = Vec2::new(x as f32, y as f32);
                let inside = texel.clamp(taken.low, taken.high - 1.0);
                sum += source.levels[0].load(inside).as_dvec3() * weight;
                weights += weight;
            }
        }
    }
    (sum / weights).as_vec3()
}

/// Variance of what the elliptical weighted average takes, over the square of an ellipse's half
/// axis: of `exp(-2 r²)` over the unit disc.
pub(super) const EWA_MOMENT: f64 = 0.171_741;

/// Number of the elliptical weighted average, which no device draws.
pub(super) const EWA: u32 = 6;

pub(super) fn filtered(source: &TwinSource, params: &WarpParams, taken: &Taken) -> Vec3 {
    let stretch = stretch_of(taken.right, taken.down);
    let probes = probes_of(stretch, params.most_probes, params.last);
    let along = Along {
        most: params.most_probes,
        beyond: if params.blurs() { 0.0 } else { 1.0 },
    };
    let light = match params.filter_by {
        0 => light_at(source, taken, taken.at, 0.0),
        1 => trilinear(source, taken),
        2 => bicubic(source, taken),
        3 => anisotropic(source, taken, along),
        4 => feline(source, taken, &probes),
        EWA => ewa(source, taken),
        _ => automatic(source, taken, stretch, along),
    };
    if params.paints != 0 && probes.count > 1.0 {
        let warm = ((probes.count - 1.0) / 4.0).min(1.0);
        return mix(light, Vec3::new(1.0, 0.5 * (1.0 - warm), 0.0), 0.5);
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(probes: &TakenProbes) -> Vec<f32> {
        let length = probes.step.length() / probes.major;
        let all = (0..probes.count as u32).map(|k| {
            let n = k as f32 - 0.5 * (probes.count - 1.0);
            (-2.0 * n * n * length * length).exp()
        });
        let all: Vec<f32> = all.collect();
        let sum: f32 = all.iter().sum();
        all.iter().map(|it| it / sum).collect()
    }

    const WIDE: [[f32; 2]; 2] = [[5.196_152, -1.0], [3.0, 1.732_051]];
    const FINE: [[f32; 2]; 2] = [[3.2, 0.4], [0.3, 1.1]];
    const SHEARED: [[f32; 2]; 2] = [[3.401_235, 0.0], [0.657_321, 1.909_335]];

    #[test]
    fn feline_takes_the_samples_of_the_paper() {
        // Rows of the Jacobian, most samples, then count, level, step and the first weight.
        let cases = [
            (
                [[4.0, 0.0], [0.0, 1.0]],
                16.0,
                7.0,
                0.0,
                [1.0, 0.0],
                0.070_159,
            ),
            (
                [[1.0, 0.0], [0.0, 4.0]],
                16.0,
                7.0,
                0.0,
                [0.0, 1.0],
                0.070_159,
            ),
            (
                [[8.0, 0.0], [0.0, 1.0]],
                4.0,
                4.0,
                1.678_072,
                [3.2, 0.0],
                0.172_623,
            ),
            (WIDE, 16.0, 5.0, 1.0, [1.732_051, 1.0], 0.120_078),
            (
                FINE,
                16.0,
                5.0,
                0.118_749,
                [1.073_722, 0.161_453],
                0.120_078,
            ),
            (
                SHEARED,
                16.0,
                3.0,
                0.895_616,
                [1.571_624, 0.433_398],
                0.281_937,
            ),
            ([[0.5, 0.0], [0.0, 0.4]], 16.0, 1.0, 0.0, [0.0, 0.0], 1.0),
        ];
        for (rows, most, count, level, step, first) in cases {
            let by = glam::Mat2::from_cols_array_2d(&rows).transpose();
            let probes = probes_of(stretch_of(by.x_axis, by.y_axis), most, 12.0);
            assert_eq!(probes.count, count, "{rows:?}");
            assert!(
                (probes.level - level).abs() < 1e-5,
                "{rows:?}: {}",
                probes.level
            );
            assert!(
                (probes.step - Vec2::from(step)).length() < 1e-5,
                "{rows:?}: {}",
                probes.step
            );
            let found = weights(&probes);
            assert!((found[0] - first).abs() < 1e-5, "{rows:?}: {found:?}");
            assert!((found.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn every_filter_leaves_an_even_grey_as_it_is() {
        let mut picture = RgbaImage::black([40, 30]);
        picture
            .pixels
            .chunks_exact_mut(4)
            .for_each(|it| it.copy_from_slice(&[90, 140, 200, 255]));
        let source = TwinSource::new(&picture, true);
        let taken = Taken {
            at: Vec2::new(17.3, 12.8),
            right: Vec2::new(3.1, 0.4),
            down: Vec2::new(-0.2, 1.2),
            low: Vec2::ZERO,
            high: Vec2::new(40.0, 30.0),
        };
        for filter_by in 0..=EWA {
            let params = WarpParams {
                filter_by,
                last: (source.levels() - 1) as f32,
                most_probes: 16.0,
                ..WarpParams::default()
            };
            let light = filtered(&source, &params, &taken);
            assert_eq!(srgb_code(light), [90, 140, 200, 255], "{filter_by}");
        }
    }
}
