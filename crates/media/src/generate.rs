//! Which moving pictures need no file?
//!
//! A [`GeneratedScene`] is full of fine detail in every direction, for trials and for measuring; a
//! numbered clip carries its frame number in every tile, for proving that the right frame is shown.
//! Both are the same on every machine, 8-bit BT.709 of limited range, chroma between luma samples.

mod colour;
mod gratings;
mod numbered;
mod objects;
mod pan;
pub mod placed;
mod ray;
pub mod text;
mod texture;
mod turn;
mod world;

#[cfg(test)]
mod tests;

use crate::parallel::in_parallel;
use colour::Rgb;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::CUBE_FACES;
pub use numbered::{numbered_tiles, read_number};
pub use pan::Pan;
use ray::Ray;
use std::f32::consts::{PI, TAU};
pub use turn::Turn;
use world::World;

/// Frames a second that scenes are drawn for.
pub const FRAMES_PER_SECOND: f32 = 30.0;

/// Half the width of a wide scene at unit distance: 100° across.
const WIDE_TANGENT: f32 = 1.1918;

/// How far a wide scene of the next number looks to the right, in radians: no two of a few dozen
/// look alike.
const SEED_TURN: f32 = 2.4;

/// Pairs of rows in one part of the work.
const PAIRS: usize = 4;

/// Columns that share a list of the objects near them.
const SEGMENT: usize = 64;

/// A generated clip of one size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GeneratedScene {
    size: [u32; 2],
    whole_sphere: bool,
    seed: u32,
}

impl GeneratedScene {
    /// A whole sphere in equirectangular pictures of `size` pixels.
    ///
    /// ```
    /// let frame = foveal_media::generate::GeneratedScene::panorama([64, 32]).frame(7);
    /// assert_eq!((frame.width, frame.height), (64, 32));
    /// ```
    #[must_use]
    pub fn panorama(size: [u32; 2]) -> Self {
        Self {
            size,
            whole_sphere: true,
            seed: 0,
        }
    }

    /// Flat pictures of `size` pixels: the same world, 100° across, slowly panned.
    #[must_use]
    pub fn wide(size: [u32; 2]) -> Self {
        Self {
            size,
            whole_sphere: false,
            seed: 0,
        }
    }

    /// The same kind of scene at another place and time, rougher or smoother: one of many, by
    /// number; 0 is the one without a number.
    #[must_use]
    pub fn with_seed(self, seed: u32) -> Self {
        Self { seed, ..self }
    }

    /// Frame `number`, drawn by all cores.
    #[must_use]
    pub fn frame(&self, number: u64) -> Picture {
        let seconds = seconds_of(number);
        let world = World::new(seconds, self.pixel(), self.seed);
        if self.whole_sphere {
            draw(self.size, &world, &Equirect::new(self.size))
        } else {
            let turn = self.seed as f32 * SEED_TURN;
            draw(
                self.size,
                &world,
                &Flat::new(self.size, turn + seconds * 0.04),
            )
        }
    }

    /// What a panorama shows in frame `number` on cube face `face` of `size` pixels on a side,
    /// drawn there at once instead of being resampled; by all cores.
    ///
    /// # Panics
    /// When there is no such face.
    #[must_use]
    pub fn cube_face(&self, number: u64, face: u32, size: u32) -> Picture {
        let axes = CUBE_FACES[face as usize];
        let to_f32 = |v: glam::DVec3| [v.x as f32, v.y as f32, v.z as f32];
        let lens = Face {
            axes: [axes.forward, axes.right, axes.down].map(to_f32),
            step: 2.0 / size as f32,
        };
        draw(
            [size; 2],
            &World::new(seconds_of(number), self.pixel(), self.seed),
            &lens,
        )
    }

    /// Width of a pixel in radians, where it is widest.
    fn pixel(&self) -> f32 {
        let [w, h] = self.size.map(|n| n as f32);
        if self.whole_sphere {
            (TAU / w).max(PI / h)
        } else {
            2.0 * WIDE_TANGENT / w
        }
    }
}

fn seconds_of(number: u64) -> f32 {
    (number as f64 / f64::from(FRAMES_PER_SECOND)) as f32
}

/// Where the pixels of a picture look.
trait Lens: Sync {
    fn ray(&self, x: usize, y: usize) -> Ray;
}

/// Sine and cosine of every column's yaw and every row's pitch.
struct Equirect {
    columns: Vec<[f32; 3]>,
    rows: Vec<[f32; 3]>,
    pixel: f32,
}

impl Equirect {
    fn new([w, h]: [u32; 2]) -> Self {
        let turn = |angle: f64| [libm::sin(angle), libm::cos(angle), angle].map(|k| k as f32);
        let half = std::f64::consts::PI;
        let yaw = |x: u32| turn(((f64::from(x) + 0.5) / f64::from(w) - 0.5) * 2.0 * half);
        let pitch = |y: u32| turn((0.5 - (f64::from(y) + 0.5) / f64::from(h)) * half);
        Self {
            columns: (0..w).map(yaw).collect(),
            rows: (0..h).map(pitch).collect(),
            pixel: (TAU / w as f32).max(PI / h as f32),
        }
    }
}

impl Lens for Equirect {
    #[inline]
    fn ray(&self, x: usize, y: usize) -> Ray {
        let [sin, cos, yaw] = self.columns[x];
        let [up, level, pitch] = self.rows[y];
        Ray {
            direction: [sin * level, up, -cos * level],
            yaw,
            pitch,
            pixel: self.pixel,
        }
    }
}

/// A face of the cube, or any rectangle at unit distance that is as high as wide.
struct Face {
    axes: [[f32; 3]; 3],
    step: f32,
}

impl Lens for Face {
    #[inline]
    fn ray(&self, x: usize, y: usize) -> Ray {
        let [a, b] = [x, y].map(|k| (k as f32 + 0.5) * self.step - 1.0);
        ray_on_plane(&self.axes, [a, b], self.step)
    }
}

/// A flat picture: a rectangle ahead of a camera that pans.
struct Flat {
    axes: [[f32; 3]; 3],
    half: [f32; 2],
    step: f32,
}

impl Flat {
    fn new([w, h]: [u32; 2], yaw: f32) -> Self {
        let step = 2.0 * WIDE_TANGENT / w as f32;
        let (sin, cos) = (libm::sinf(yaw), libm::cosf(yaw));
        Self {
            axes: [[sin, 0.0, -cos], [cos, 0.0, sin], [0.0, -1.0, 0.0]],
            half: [w, h].map(|n| n as f32 / 2.0),
            step,
        }
    }
}

impl Lens for Flat {
    #[inline]
    fn ray(&self, x: usize, y: usize) -> Ray {
        let a = (x as f32 + 0.5 - self.half[0]) * self.step;
        let b = (y as f32 + 0.5 - self.half[1]) * self.step;
        ray_on_plane(&self.axes, [a, b], self.step)
    }
}

/// The line of sight through a place of a plane at unit distance with pixels of `step`.
#[inline]
fn ray_on_plane([forward, right, down]: &[[f32; 3]; 3], [a, b]: [f32; 2], step: f32) -> Ray {
    let scale = 1.0 / (1.0 + a * a + b * b).sqrt();
    let direction = [0, 1, 2].map(|k| (forward[k] + right[k] * a + down[k] * b) * scale);
    let [x, y, z] = direction;
    Ray {
        direction,
        yaw: libm::atan2f(x, -z),
        pitch: libm::asinf(y.clamp(-1.0, 1.0)),
        pixel: step * scale,
    }
}

/// Draws a picture pair of rows by pair of rows, chroma as the mean of four pixels.
fn draw(size: [u32; 2], world: &World, lens: &impl Lens) -> Picture {
    let [w, h] = size.map(|n| n as usize);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let bands = in_parallel(cores, h.div_ceil(2 * PAIRS), |band| {
        let rows = band * 2 * PAIRS..((band + 1) * 2 * PAIRS).min(h);
        let mut planes = [Vec::new(), Vec::new(), Vec::new()];
        for top in rows.step_by(2) {
            draw_pair(
                world,
                lens,
                [top, (top + 1).min(h - 1)],
                w,
                top + 1 < h,
                &mut planes,
            );
        }
        planes
    });
    let planes = [0, 1, 2].map(|p: usize| {
        bands
            .iter()
            .flat_map(|planes| &planes[p])
            .copied()
            .collect()
    });
    Picture {
        width: size[0],
        height: size[1],
        planes,
    }
}

/// Appends two rows of luma (one when the last row has no partner) and one of chroma.
fn draw_pair(
    world: &World,
    lens: &impl Lens,
    rows: [usize; 2],
    width: usize,
    both: bool,
    [luma, u, v]: &mut [Vec<u8>; 3],
) {
    let [mut upper, mut lower] = [Vec::with_capacity(width), Vec::with_capacity(width)];
    for start in (0..width).step_by(SEGMENT) {
        let columns = start..(start + SEGMENT).min(width);
        let middle = lens
            .ray(columns.start.midpoint(columns.end), rows[0])
            .direction;
        let corner = |x: usize, y: usize| objects::dot(middle, lens.ray(x, y).direction);
        let corners = rows.map(|y| corner(columns.start, y).min(corner(columns.end - 1, y)));
        let near = world.near(middle, corners[0].min(corners[1]));
        upper.extend(
            columns
                .clone()
                .map(|x| world.colour(&lens.ray(x, rows[0]), &near)),
        );
        lower.extend(columns.map(|x| world.colour(&lens.ray(x, rows[1]), &near)));
    }
    luma.extend(upper.iter().map(luma_of));
    if both {
        luma.extend(lower.iter().map(luma_of));
    }
    for (upper, lower) in upper.chunks(2).zip(lower.chunks(2)) {
        let count = (upper.len() + lower.len()) as f32;
        let mean = [0, 1, 2].map(|k| upper.iter().chain(lower).map(|c| c[k]).sum::<f32>() / count);
        let [blue, red] = chroma_of(mean);
        u.push(blue);
        v.push(red);
    }
}

/// Luma of BT.709 in 16..=235.
#[inline]
fn luma_of([r, g, b]: &Rgb) -> u8 {
    let clamped = |k: &f32| k.clamp(0.0, 1.0);
    let y = 0.2126 * clamped(r) + 0.7152 * clamped(g) + 0.0722 * clamped(b);
    (16.5 + 219.0 * y) as u8
}

/// Chroma of BT.709 in 16..=240: blue, then red difference.
#[inline]
fn chroma_of(rgb: Rgb) -> [u8; 2] {
    let [r, g, b] = rgb.map(|k| k.clamp(0.0, 1.0));
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let code = |difference: f32| (128.5 + 224.0 * difference) as u8;
    [code((b - y) / 1.8556), code((r - y) / 1.5748)]
}
