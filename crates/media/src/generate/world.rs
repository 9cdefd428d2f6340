//! What colour does the generated world have in a direction?
//!
//! A valley under a sunset: sky with clouds, two ridges, a floor of lettered tiles, bands of
//! running text, zone plates and balloons. Everything is a function of direction and time, so the
//! world has no seam; everything fades where it is finer than a pixel. Colours are gamma-coded RGB
//! in 0..1.

use super::colour::{Rgb, mix, scaled};
use super::objects::{Balloon, ZonePlate, balloons, zone_plates};
use super::ray::{DEGREE, Ray};
use super::text::{self, ADVANCE, LINE};
use super::texture::{bars, byte_at, floor, fractal, noise, step, visible};
use std::f32::consts::TAU;

/// The world at one moment.
pub(super) struct World {
    seconds: f32,
    /// Tiles by which the floor is shifted, and clouds by as many hundredths.
    shift: f32,
    /// How rough stones, grain and rocks are, 1 as usual.
    rough: f32,
    ridges: [Vec<f32>; 2],
    plates: Vec<ZonePlate>,
    balloons: Vec<Balloon>,
}

/// The objects that a part of a picture may show.
pub(super) struct Near<'a> {
    plates: Vec<&'a ZonePlate>,
    balloons: Vec<&'a Balloon>,
}

/// Entries of a ridge's table around the horizon.
const RIDGE: usize = 8192;

/// Colours of floor tiles; dark letters on the first, fourth and sixth, light ones on the others.
const GLAZES: [Rgb; 6] = [
    [0.85, 0.76, 0.62],
    [0.72, 0.42, 0.30],
    [0.24, 0.42, 0.47],
    [0.80, 0.62, 0.34],
    [0.36, 0.30, 0.36],
    [0.64, 0.66, 0.52],
];

/// What floor tiles say.
const SIGNS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";

/// Stones on a side of a floor tile.
const STONES: f32 = 18.0;

/// Camera above the floor, in tiles.
const HEIGHT: f32 = 1.6;

/// A band of text around the world.
struct Line {
    /// Radians of its upper border above the horizon.
    top: f32,
    /// Radians a dot.
    dot: f32,
    /// Dots a second to the left.
    speed: f32,
    /// Dots around the world: a whole number of repetitions of the text, so that the turn closes.
    around: f32,
    text: &'static [u8],
}

/// By what worlds of neighbouring numbers differ: seconds, tiles of the floor, and the angle of the
/// sine that doubles or halves roughness.
const SEED_SECONDS: f32 = 41.0;
const SEED_TILES: f32 = 61.0;
const SEED_ROUGHNESS: f32 = 2.4;

/// Rows of text from the widest down: 3.2°, 1.6° and 0.8° a line above, the reverse below.
const LINES: [Line; 6] = [
    line(37.0, 0.36, 5.0, b"FOVEAL   DETAIL WHERE YOU LOOK   "),
    line(
        33.6,
        0.18,
        -8.0,
        b"THE EYE RESOLVES ONE DEGREE AT A TIME - THE REST IS MEMORY.  ",
    ),
    line(
        31.8,
        0.09,
        4.0,
        b"60 CYCLES PER DEGREE IN THE FOVEA: 2 CYCLES PER DEGREE AT 40 DEGREES.  \
          ABCDEFGHIJKLMNOPQRSTUVWXYZ 0123456789  ",
    ),
    line(
        -9.0,
        0.09,
        -4.0,
        b"SPHINX OF BLACK QUARTZ JUDGE MY VOW.  \
          PACK MY BOX WITH FIVE DOZEN LIQUOR JUGS.  0123456789  ",
    ),
    line(
        -10.0,
        0.18,
        8.0,
        b"HOW VEXINGLY QUICK DAFT ZEBRAS JUMP - 1234567890.  ",
    ),
    line(
        -11.8,
        0.36,
        -5.0,
        b"READ THIS LINE WITH THE CORNER OF YOUR EYE   ",
    ),
];

/// A line from its top and dot in degrees, with letters about as wide as high at its own pitch.
const fn line(top: f32, dot: f32, speed: f32, text: &'static [u8]) -> Line {
    let pitch = (top - 3.5 * dot) * DEGREE;
    let level = 1.0 - pitch * pitch / 2.0 + pitch * pitch * pitch * pitch / 24.0;
    let repeat = text.len() as f32 * ADVANCE;
    let times = (360.0 * level / dot / repeat + 0.5) as u32;
    assert!(times > 0, "a line is longer than its turn");
    Line {
        top: top * DEGREE,
        dot: dot * DEGREE,
        speed,
        around: repeat * times as f32,
        text,
    }
}

/// Upper and lower borders of the two bands that carry the lines, in radians.
const BANDS: [[f32; 2]; 2] = [
    [37.6 * DEGREE, 30.6 * DEGREE],
    [-8.6 * DEGREE, -15.6 * DEGREE],
];

impl World {
    /// The world `seconds` after its beginning, with zone plates as fine as `pixel` radians allow;
    /// one of many worlds, by `seed`.
    pub(super) fn new(seconds: f32, pixel: f32, seed: u32) -> Self {
        let number = seed as f32;
        let seconds = seconds + number * SEED_SECONDS;
        Self {
            seconds,
            shift: number * SEED_TILES,
            rough: libm::exp2f(libm::sinf(number * SEED_ROUGHNESS)),
            ridges: [ridge(3.0, 7.0, 3.5), ridge(5.0, 3.0, 1.2)],
            plates: zone_plates(seconds, pixel),
            balloons: balloons(seconds),
        }
    }

    /// The objects that may be seen within a cone around a direction, of the cosine `within`.
    pub(super) fn near(&self, axis: [f32; 3], within: f32) -> Near<'_> {
        Near {
            plates: self
                .plates
                .iter()
                .filter(|plate| plate.meets(axis, within))
                .collect(),
            balloons: self
                .balloons
                .iter()
                .filter(|balloon| balloon.meets(axis, within))
                .collect(),
        }
    }

    /// Colour in a direction of the cone that `near` was made for.
    pub(super) fn colour(&self, ray: &Ray, near: &Near) -> Rgb {
        let mut colour = if ray.pitch > 0.0 {
            self.sky(ray)
        } else {
            self.floor(ray)
        };
        if ray.pitch > -0.01 && ray.pitch < 14.0 * DEGREE {
            colour = self.with_ridges(colour, ray);
        }
        for (band, lines) in BANDS.iter().zip(LINES.chunks_exact(LINES.len() / 2)) {
            if ray.pitch < band[0] + ray.pixel && ray.pitch > band[1] - ray.pixel {
                colour = self.with_band(colour, ray, *band, lines);
            }
        }
        for plate in &near.plates {
            colour = plate.over(colour, ray);
        }
        for balloon in &near.balloons {
            colour = balloon.over(colour, ray);
        }
        colour
    }

    fn sky(&self, ray: &Ray) -> Rgb {
        let [x, y, z] = ray.direction;
        let low = mix([1.0, 0.66, 0.42], [0.93, 0.52, 0.50], step(0.0, 0.16, y));
        let high = mix([0.36, 0.42, 0.68], [0.07, 0.14, 0.36], step(0.3, 1.0, y));
        let mut sky = mix(low, high, step(0.02, 0.5, y));
        // The sun stands at yaw 25°, 9° up; its glow reddens what is near.
        let near = x * 0.417 + y * 0.156 - z * 0.895;
        if near > 0.6 {
            let glow = (near - 0.6) * 2.5;
            sky = mix(sky, [1.0, 0.82, 0.55], 0.75 * glow * glow * glow);
            sky = mix(
                sky,
                [1.0, 0.97, 0.86],
                step(0.99905 - ray.pixel * 0.04, 0.9991, near),
            );
        }
        sky = mix(sky, [0.95, 0.96, 1.0], stars(ray) * step(0.35, 0.7, y));
        // Clouds lie on a plane that the horizon bends down to, so they never end abruptly.
        let depth = 1.0 / (y + 0.12);
        let (u, v) = (
            x * depth * 1.6 + self.seconds * 0.02,
            z * depth * 1.6 + self.shift * 0.01,
        );
        let reach = 1.6 * depth * (1.0 + (x * x + z * z) * depth * depth).sqrt();
        let cloud = fractal(u, v, ray.pixel * reach);
        let cover = step(-0.1, 0.45, cloud);
        let light = mix(
            [0.98, 0.86, 0.78],
            [0.55, 0.50, 0.62],
            step(0.0, 0.6, cloud) * 0.8,
        );
        let light = mix([1.0, 0.72, 0.55], light, step(0.1, 0.5, y));
        mix(sky, light, cover * 0.85 * step(0.0, 0.12, y))
    }

    fn floor(&self, ray: &Ray) -> Rgb {
        let [x, y, z] = ray.direction;
        let depth = HEIGHT / -y.min(-1e-3);
        let (u, v) = (x * depth + self.seconds * 0.15, z * depth + self.shift);
        let reach =
            |k: f32| ray.pixel * depth * (1.0 + (k * depth / HEIGHT) * (k * depth / HEIGHT)).sqrt();
        let [along, across] = [reach(x), reach(z)];
        let footprint = along.max(across);
        let (column, row) = (floor(u), floor(v));
        let chance = byte_at(column, row);
        let glaze = GLAZES[usize::from(chance) % 6];
        let ink = if matches!(chance % 6, 0 | 3 | 5) {
            0.35
        } else {
            1.9
        };
        let near = 1.0 - step(0.1, 0.3, footprint);
        let mut tile = glaze;
        if near > 0.0 {
            let sign = SIGNS[usize::from(byte_at(row, column)) % SIGNS.len()];
            // A letter of 5 by 7 dots in the middle of 11 by 11.
            let dot_x = (u - column as f32 - 0.5) * 11.0 + 2.5;
            let dot_y = (v - row as f32 - 0.5) * 11.0 + 3.5;
            let inked = near * text::letter(sign, dot_x, dot_y, footprint * 11.0);
            let dyed = scaled(glaze, ink).map(|k| k.min(0.96));
            tile = mix(glaze, dyed, inked * 0.85);
        }
        // Far tiles are finer than a pixel: their mean.
        let tile = mix(tile, [0.6, 0.53, 0.43], step(0.35, 1.0, footprint));
        // Each tile is a mosaic of 18 by 18 stones, each a little lighter or darker.
        let (stone_u, stone_v) = (u * STONES, v * STONES);
        let stone = f32::from(byte_at(floor(stone_u) * 7, floor(stone_v) * 5)) / 255.0 - 0.5;
        let seen = visible(0.6 * STONES, footprint);
        let gap = if footprint * STONES > 8.0 {
            0.19
        } else {
            joints([stone_u, stone_v], 0.10, [along * STONES, across * STONES])
        };
        let tile = scaled(
            tile,
            (1.0 + 0.22 * self.rough * stone * seen) * (1.0 - 0.35 * gap),
        );
        let joint = joints([u, v], 0.05, [along, across]);
        let grain = 1.0 + 0.30 * self.rough * fractal(u * 3.0, v * 3.0, footprint * 3.0);
        let lit = scaled(mix(tile, [0.20, 0.17, 0.18], joint * 0.9), grain);
        mix(lit, [0.86, 0.60, 0.50], 0.85 * step(0.30, 0.0, -y))
    }

    fn with_ridges(&self, mut colour: Rgb, ray: &Ray) -> Rgb {
        let looks = [
            ([0.55, 0.42, 0.52], [0.86, 0.60, 0.50], 40.0),
            ([0.22, 0.24, 0.30], [0.60, 0.45, 0.42], 90.0),
        ];
        for (ridge, (peak, foot, rough)) in self.ridges.iter().zip(looks) {
            let place = (ray.yaw / TAU + 1.0) * RIDGE as f32;
            let entry = floor(place);
            let [near, next] = [entry, entry + 1].map(|k| ridge[k as usize % RIDGE]);
            let height = near + (next - near) * (place - entry as f32);
            let covered = ((height - ray.pitch) / ray.pixel + 0.5).clamp(0.0, 1.0);
            if covered > 0.0 {
                let [x, y, z] = ray.direction;
                // Slopes are seen from the side: noise over bearing, which wraps, and height.
                let (u, v) = ((x - z * 0.3) * rough, (y * 1.6 + z * 0.7) * rough);
                let rock = 1.0 + 0.55 * self.rough * fractal(u, v, ray.pixel * rough * 1.6);
                let slope = mix(foot, scaled(peak, rock), step(0.0, 0.06, ray.pitch));
                colour = mix(colour, slope, covered * step(-0.01, 0.0, ray.pitch));
            }
        }
        colour
    }

    fn with_band(&self, behind: Rgb, ray: &Ray, [top, bottom]: [f32; 2], lines: &[Line]) -> Rgb {
        let edge = |k: f32| (k / ray.pixel + 0.5).clamp(0.0, 1.0);
        let inside = edge(top - ray.pitch) * edge(ray.pitch - bottom);
        let mut colour = mix(behind, [0.04, 0.05, 0.09], 0.72 * inside);
        for border in [top, bottom] {
            let rule = edge(0.0016 - (ray.pitch - border).abs());
            colour = mix(colour, [0.98, 0.80, 0.45], rule * 0.9);
        }
        for line in lines {
            let y = (line.top - ray.pitch) / line.dot;
            if !(-1.0..LINE).contains(&y) {
                continue;
            }
            let x = (ray.yaw / TAU + 0.5) * line.around + self.seconds * line.speed;
            let inked = text::line(line.text, x, y, ray.pixel / line.dot);
            colour = mix(colour, [0.99, 0.95, 0.84], inked * 0.95);
        }
        colour
    }
}

/// Coverage of a grid of joints `width` of a cell wide.
fn joints([u, v]: [f32; 2], width: f32, [along, across]: [f32; 2]) -> f32 {
    1.0 - (1.0 - bars(u, width, along)) * (1.0 - bars(v, width, across))
}

/// Brightness of the stars in the upper sky: one in each cell of a plane overhead, of many sizes.
fn stars(ray: &Ray) -> f32 {
    let [x, y, z] = ray.direction;
    if y < 0.35 {
        return 0.0;
    }
    let (u, v) = (x / y * 90.0, z / y * 90.0);
    let (column, row) = (floor(u), floor(v));
    let [size, place] = [byte_at(column, row), byte_at(row, column + 71)];
    let (du, dv) = (
        u - column as f32 - 0.25 - f32::from(place & 15) / 32.0,
        v - row as f32 - 0.25 - f32::from(place >> 4) / 32.0,
    );
    let pixel = ray.pixel * 90.0 / y;
    let size = f32::from(size) / 255.0;
    let radius = 0.02 + 0.10 * size * size * size;
    // A star smaller than a pixel keeps its light.
    let drawn = radius.max(0.7 * pixel);
    let light = (radius / drawn) * (radius / drawn);
    let inside = (drawn - (du * du + dv * dv).sqrt()) / pixel + 0.5;
    (light * inside.clamp(0.0, 1.0)).min(1.0) * (1.0 - step(0.25, 0.5, drawn))
}

/// Heights of a ridge in radians around the horizon, continuous over the turn.
fn ridge(seed: f32, highest: f32, lowest: f32) -> Vec<f32> {
    let height = |entry: usize| {
        let yaw = entry as f32 / RIDGE as f32 * TAU;
        let (x, y) = (
            libm::sinf(yaw) * 2.2 + seed * 9.1,
            libm::cosf(yaw) * 2.2 - seed * 4.7,
        );
        let form = noise(x, y) + 0.45 * fractal(x * 2.0, y * 2.0, 0.0);
        (lowest + (highest - lowest) * form.clamp(0.0, 1.3)) * DEGREE
    };
    (0..RIDGE).map(height).collect()
}
