//! Where might the eye look next, when only the picture is known?
//!
//! Cues of each tile and a bias towards the centre or the equator, as a weak prior for what to
//! fetch outside the region that gaze predicts. Never a gaze point: the most salient place is off
//! by 23° on the recordings of Hu et al. 2019, the centre of the view by 10°.

use crate::perception::luminance::linear_table;
use crate::perception::measures::cues::Cues;
use crate::view::axes::yaw_pitch_from_direction;
use crate::view::picture::{Colour, Picture};
use crate::view::surface::Projection;
use glam::DVec3;

/// Every how many pixels a tile is looked at, on each axis.
const STRIDE: usize = 4;

/// The cues of one tile over one group of frames, from its first and its last picture.
///
/// Looks at every fourth pixel on each axis: about 8 ns a pixel of the tile.
#[must_use]
pub fn cues_of(first: &Picture, last: &Picture, colour: Colour) -> Cues {
    let [width, height] = [first.width as usize, first.height as usize];
    let places = || {
        let rows = (STRIDE / 2..height.max(STRIDE / 2 + 1)).step_by(STRIDE);
        rows.flat_map(move |y| {
            (STRIDE / 2..width.max(STRIDE / 2 + 1))
                .step_by(STRIDE)
                .map(move |x| [x.min(width - 1), y.min(height - 1)])
        })
    };
    let rgb: Vec<[f64; 3]> = places().map(|place| rgb_at(first, colour, place)).collect();
    let linear = linear_table();
    let lab: Vec<[f64; 3]> = rgb.iter().map(|rgb| lab_from_rgb(*rgb, &linear)).collect();
    let count = rgb.len() as f64;
    let (rgb_mean, lab_mean) = (mean_of(&rgb), mean_of(&lab));
    let variance = rgb
        .iter()
        .map(|rgb| distance_squared(*rgb, rgb_mean) / 3.0)
        .sum::<f64>()
        / count;
    let colour = lab
        .iter()
        .map(|lab| distance_squared(*lab, lab_mean).sqrt());
    let change = places().map(|place| (luma(first, place) - luma(last, place)).abs());
    Cues {
        deviation: variance.sqrt(),
        edges: places().map(|place| gradient(first, place)).sum::<f64>() / count,
        colour: colour.sum::<f64>() / count,
        change: change.sum::<f64>() / count,
    }
}

fn mean_of(values: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|k| values.iter().map(|v| v[k]).sum::<f64>() / values.len() as f64)
}

fn distance_squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

fn luma(picture: &Picture, [x, y]: [usize; 2]) -> f64 {
    f64::from(picture.planes[0][y * picture.width as usize + x])
}

/// Length of the gradient of luma at a place, in code values a pixel (Sobel's operator over 8).
fn gradient(picture: &Picture, [x, y]: [usize; 2]) -> f64 {
    let (right, below) = (picture.width as usize - 1, picture.height as usize - 1);
    let at = |dx: isize, dy: isize| {
        let place = [
            x.saturating_add_signed(dx).min(right),
            y.saturating_add_signed(dy).min(below),
        ];
        luma(picture, place)
    };
    let across = |side: isize| at(side, -1) + 2.0 * at(side, 0) + at(side, 1);
    let down = |side: isize| at(-1, side) + 2.0 * at(0, side) + at(1, side);
    let (dx, dy) = ((across(1) - across(-1)) / 8.0, (down(1) - down(-1)) / 8.0);
    (dx * dx + dy * dy).sqrt()
}

/// Red, green and blue at a place of the luma plane, 0 to 255, gamma-coded.
fn rgb_at(picture: &Picture, colour: Colour, [x, y]: [usize; 2]) -> [f64; 3] {
    let chroma_width = picture.plane_size(1)[0] as usize;
    let chroma = |p: usize| f64::from(picture.planes[p][(y / 2) * chroma_width + x / 2]) - 128.0;
    let [kr, kb] = colour.matrix.luma_weights().map(f64::from);
    let code = luma(picture, [x, y]);
    let (luma, chroma_scale) = if colour.full_range {
        (code, 1.0)
    } else {
        ((code - 16.0) * 255.0 / 219.0, 255.0 / 224.0)
    };
    let [u, v] = [1, 2].map(|p| chroma(p) * chroma_scale);
    let red = luma + 2.0 * (1.0 - kr) * v;
    let blue = luma + 2.0 * (1.0 - kb) * u;
    let green = (luma - kr * red - kb * blue) / (1.0 - kr - kb);
    [red, green, blue].map(|value| value.clamp(0.0, 255.0))
}

/// CIE 1976 L*a*b* under D65 of an sRGB colour, 0 to 255 (IEC 61966-2-1, ISO/CIE 11664-4), off by
/// 0.006 at most: light is taken to be straight between whole code values.
fn lab_from_rgb(rgb: [f64; 3], linear: &[f64; 256]) -> [f64; 3] {
    let [r, g, b] = rgb.map(|code| {
        let low = (code as usize).min(254);
        linear[low] + (linear[low + 1] - linear[low]) * (code - low as f64)
    });
    let xyz = [
        (0.412_4 * r + 0.357_6 * g + 0.180_5 * b) / 0.950_47,
        0.212_6 * r + 0.715_2 * g + 0.072_2 * b,
        (0.019_3 * r + 0.119_2 * g + 0.950_5 * b) / 1.088_83,
    ];
    let [x, y, z] = xyz.map(|t| {
        if t > 216.0 / 24_389.0 {
            f64::from(libm::cbrtf(t as f32))
        } else {
            (24_389.0 / 27.0 * t + 16.0) / 116.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Weights of deviation, edges, colour and change. Change weighs most: of the cheap cues it is the
/// strongest in moving pictures.
const WEIGHTS: [f64; 4] = [0.15, 0.2, 0.2, 0.45];
/// The values of the cues at which each counts half of what it can.
const HALVES: [f64; 4] = [30.0, 10.0, 15.0, 10.0];
/// Standard deviation of gaze round the equator of a sphere, in degrees of pitch, and round the
/// centre of a flat picture as a share of its half height and width.
const EQUATOR_DEG: f64 = 25.0;
const CENTRE: f64 = 0.5;
/// What is left of the bias far from the equator or the centre.
const FLOOR: f64 = 0.1;

/// How much a tile draws the eye, 0 to 1, by its cues and its place on the content.
///
/// `place` is its direction; flat content also needs its half size as tangents.
#[must_use]
pub fn saliency(cues: &Cues, projection: Projection, tangents: [f64; 2], place: DVec3) -> f64 {
    let values = [cues.deviation, cues.edges, cues.colour, cues.change];
    let drawn: f64 = (0..4)
        .map(|k| WEIGHTS[k] * values[k] / (values[k] + HALVES[k]))
        .sum();
    drawn * bias(projection, tangents, place)
}

/// Where eyes rest whatever is shown: near the equator of a sphere, near the centre of a picture.
fn bias(projection: Projection, tangents: [f64; 2], place: DVec3) -> f64 {
    let squared = match projection {
        Projection::Cube | Projection::Equirect => {
            let pitch = yaw_pitch_from_direction(place).1.to_degrees() / EQUATOR_DEG;
            pitch * pitch
        }
        Projection::Flat => {
            let depth = (-place.z).max(1e-6);
            let [x, y] = [place.x / depth / tangents[0], place.y / depth / tangents[1]];
            (x * x + y * y) / (CENTRE * CENTRE)
        }
    };
    FLOOR + (1.0 - FLOOR) * libm::exp(-squared / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::picture::Matrix;
    use crate::view::random::Random;

    const COLOUR: Colour = Colour {
        matrix: Matrix::Bt709,
        full_range: true,
        chroma_left: false,
    };

    fn noise(seed: u64, amplitude: f64) -> Picture {
        let mut random = Random::new(seed);
        let mut picture = Picture::filled(64, 48, [128; 3]);
        for sample in &mut picture.planes[0] {
            *sample = (128.0 + amplitude * (random.unit() - 0.5)) as u8;
        }
        picture
    }

    #[test]
    fn a_plain_tile_has_no_cues() {
        for size in [[64, 48], [1, 1], [3, 2]] {
            let plain = Picture::filled(size[0], size[1], [90, 120, 140]);
            let cues = cues_of(&plain, &plain, COLOUR);
            let most = cues
                .deviation
                .max(cues.edges)
                .max(cues.colour)
                .max(cues.change);
            assert!(most < 1e-6, "{cues:?}");
        }
    }

    #[test]
    fn each_cue_answers_to_what_it_is_named_for() {
        let (weak, strong) = (noise(1, 20.0), noise(1, 200.0));
        let (a, b) = (
            cues_of(&weak, &weak, COLOUR),
            cues_of(&strong, &strong, COLOUR),
        );
        assert!(b.deviation > 5.0 * a.deviation && b.edges > 5.0 * a.edges);
        assert!(b.change == 0.0 && cues_of(&strong, &weak, COLOUR).change > 20.0);
        let mut coloured = Picture::filled(64, 48, [128; 3]);
        coloured.planes[1][..16 * 24].fill(60);
        assert!(cues_of(&coloured, &coloured, COLOUR).colour > 10.0);
    }

    #[test]
    fn uniform_noise_has_the_deviation_of_its_distribution() {
        let cues = cues_of(&noise(7, 240.0), &noise(7, 240.0), COLOUR);
        let expected = 240.0 / 12f64.sqrt();
        assert!((cues.deviation / expected - 1.0).abs() < 0.1, "{cues:?}");
    }

    #[test]
    fn white_and_primaries_have_their_lab_values() {
        for (rgb, lab) in [
            ([255.0; 3], [100.0, 0.0, 0.0]),
            ([255.0, 0.0, 0.0], [53.24, 80.09, 67.20]),
            ([0.0, 0.0, 255.0], [32.30, 79.19, -107.86]),
            // Between code values, where straight lines are furthest off.
            ([6.5, 10.5, 77.946], [7.400, 26.436, -40.803]),
        ] {
            let found = lab_from_rgb(rgb, &linear_table());
            assert!(
                distance_squared(found, lab).sqrt() < 0.05,
                "{found:?}, not {lab:?}"
            );
        }
    }

    #[test]
    fn saliency_stays_within_0_and_1_and_falls_towards_the_poles() {
        let loud = Cues {
            deviation: 1e3,
            edges: 1e3,
            colour: 1e3,
            change: 1e3,
        };
        let at = |place| saliency(&loud, Projection::Cube, [1.0; 2], place);
        assert!(at(DVec3::NEG_Z) <= 1.0 && at(DVec3::Y) > 0.0);
        assert!(at(DVec3::NEG_Z) > 5.0 * at(DVec3::Y));
        assert_eq!(
            saliency(&Cues::default(), Projection::Cube, [1.0; 2], DVec3::X),
            0.0
        );
    }
}
