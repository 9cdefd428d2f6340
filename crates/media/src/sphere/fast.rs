//! How does a sphere become a cube fast enough to prepare video by?
//!
//! The places that face samples look at, in 64ths of a source sample, are computed once for all
//! frames. A sample is then a widened cubic of at most eight by eight source samples out of a table
//! of weights. Towards the poles, where circles of latitude shrink, rows are halved along longitude
//! as often as that takes, so that eight samples always suffice; the cap round each pole is that of
//! the slow way ([`super::cap`]), which is also the oracle of the tests.

use super::cap::Cap;
use super::kernel::Kernel;
use super::plane::Plane;
use super::{BOTTOM, TOP};
use std::f64::consts::{FRAC_PI_2, PI};

/// Steps between two source samples.
const PHASES: usize = 64;
/// Steps of widening between 1 and 2.
const WIDTHS: usize = 16;
/// Samples under a kernel on one axis.
const TAPS: usize = 8;
/// Source samples before the place, the one at or left of it included.
const BEFORE: i64 = 4;
/// Weights sum up to this: 12 bits.
const ONE: i32 = 1 << 12;
/// Weights of a halving along longitude, in 32nds, as of [`crate::pyramid`].
const HALVING: [i32; 6] = [-1, 4, 13, 13, 4, -1];

type Weights = [i16; TAPS];

/// Cubic kernels by widening, then by phase.
pub(super) struct Cubic(Vec<Weights>);

impl Cubic {
    pub(super) fn new() -> Self {
        let mut table = Vec::with_capacity(WIDTHS * PHASES);
        for width in 0..WIDTHS {
            let stretch = 1.0 + width as f64 / WIDTHS as f64;
            for phase in 0..PHASES {
                let place = phase as f64 / PHASES as f64;
                let at = |tap: usize| (tap as f64 + 1.0 - BEFORE as f64 - place) / stretch;
                table.push(normalised(
                    [0, 1, 2, 3, 4, 5, 6, 7].map(|tap| catmull_rom(at(tap))),
                ));
            }
        }
        Self(table)
    }

    #[inline]
    fn at(&self, width: u8, place: i64) -> &Weights {
        &self.0[usize::from(width) * PHASES + (place & (PHASES as i64 - 1)) as usize]
    }
}

/// Interpolating cubic of Catmull and Rom, zero from 2 on.
fn catmull_rom(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        (1.5 * x - 2.5) * x * x + 1.0
    } else if x < 2.0 {
        ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0
    } else {
        0.0
    }
}

/// Fixed point whose sum is exactly [`ONE`].
fn normalised(weights: [f64; TAPS]) -> Weights {
    let sum: f64 = weights.iter().sum();
    let mut fixed = weights.map(|w| (w / sum * f64::from(ONE)).round() as i32);
    let largest = (0..TAPS).max_by_key(|tap| fixed[*tap]).unwrap_or_default();
    fixed[largest] += ONE - fixed.iter().sum::<i32>();
    fixed.map(|w| w as i16)
}

/// How often a row is halved for the poles, and the widening that is left.
#[derive(Clone, Copy, Default)]
struct Widening {
    halvings: u8,
    along: u8,
    down: u8,
}

/// Where the samples of one size of face look in planes of one size.
pub(super) struct Places {
    face: usize,
    width: usize,
    height: usize,
    cap_radius: f64,
    /// Of the front face's columns: 64ths of a source column, and the widening.
    columns: Vec<(i64, u8)>,
    /// Of its samples: 64ths of a source row, and the widening.
    rows: Vec<(i32, u8)>,
    /// Of the top face's samples, outside the cap: column and row.
    polar: Vec<[i32; 2]>,
    /// Of each row, counted from its pole.
    widenings: Vec<Widening>,
}

fn steps(place: f64) -> i64 {
    (place * PHASES as f64).round() as i64
}

fn width_index(stretch: f64) -> u8 {
    (((stretch - 1.0) * WIDTHS as f64).ceil()).clamp(0.0, WIDTHS as f64 - 1.0) as u8
}

impl Places {
    /// The places for planes like this one; `None` where rows cannot be halved as often as the
    /// poles need, or are too short.
    pub(super) fn new(plane: &Plane) -> Option<Self> {
        let (face, rows_per_step) = (plane.face, plane.rows_per_step());
        let density = plane.width as f64 / PI / face as f64;
        let widening = |row: usize| {
            let radius = libm::tan(((row as f64 + 0.5) * PI / plane.height as f64).min(1.5));
            let stretch = (density / radius.max(plane.cap_radius() * 0.9)).max(1.0);
            let halvings = stretch.log2().floor();
            Widening {
                halvings: halvings as u8,
                along: width_index(stretch / halvings.exp2()),
                down: width_index((rows_per_step / (1.0 + radius * radius)).max(1.0)),
            }
        };
        let widenings: Vec<Widening> = (0..plane.height).map(widening).collect();
        let most = widenings
            .iter()
            .map(|w| w.halvings)
            .max()
            .unwrap_or_default();
        let fits = plane.width.is_multiple_of(1 << most) && plane.width >> most >= 4 * TAPS;
        if !fits || plane.height < 4 * TAPS || density > 1.9 || rows_per_step > 1.9 {
            return None;
        }
        let tangents: Vec<f64> = (0..face).map(|i| plane.tangent(i)).collect();
        let column = |a: &f64| {
            let stretch = plane.yaw_stretch(*a);
            (steps(plane.column(libm::atan(*a))), width_index(stretch))
        };
        let row = |b: f64, a: f64| {
            let cos = 1.0 / (1.0 + a * a).sqrt();
            let slope = b * cos;
            let stretch = (rows_per_step * cos / (1.0 + slope * slope)).max(1.0);
            let place = steps(plane.row(FRAC_PI_2 + libm::atan(slope)));
            (place as i32, width_index(stretch))
        };
        let polar = |b: f64, a: f64| {
            let radius = (a * a + b * b).sqrt();
            let place = [
                plane.column(libm::atan2(a, b)),
                plane.row(libm::atan(radius)),
            ];
            place.map(|place| steps(place) as i32)
        };
        let each = |b: f64| tangents.iter().map(move |a| (b, *a));
        let pairs = || tangents.iter().flat_map(|b| each(*b));
        Some(Self {
            face,
            width: plane.width,
            height: plane.height,
            cap_radius: plane.cap_radius(),
            columns: tangents.iter().map(column).collect(),
            rows: pairs().map(|(b, a)| row(b, a)).collect(),
            polar: pairs().map(|(b, a)| polar(b, a)).collect(),
            widenings,
        })
    }
}

/// One plane as the kernels read it: rows in 16 bits, whole and halved along longitude.
pub(super) struct Rows<'a> {
    places: &'a Places,
    /// By halvings, then by row; halved ones only of the rows that are read so.
    levels: Vec<Vec<Vec<i16>>>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(places: &'a Places, plane: &Plane) -> Self {
        let whole = |row| wrapped(plane.turn(row).iter().map(|s| i16::from(*s)).collect());
        let mut levels: Vec<Vec<Vec<i16>>> = vec![(0..plane.height).map(whole).collect()];
        let most = places
            .widenings
            .iter()
            .map(|w| w.halvings)
            .max()
            .unwrap_or_default();
        for level in 1..=most {
            let finer = &levels[usize::from(level) - 1];
            let halved = |row: usize| {
                // A kernel reads beside the row that it is at.
                let near = row.min(plane.height - 1 - row).saturating_sub(TAPS);
                let is_read = places.widenings[near].halvings >= level;
                if is_read {
                    halve(&finer[row])
                } else {
                    Vec::new()
                }
            };
            levels.push((0..plane.height).map(halved).collect());
        }
        Self { places, levels }
    }

    /// One row of a face.
    pub(super) fn fill(
        &self,
        cubic: &Cubic,
        (kernel, caps): (&Kernel, &[Cap; 2]),
        [face, y]: [usize; 2],
        out: &mut [u8],
    ) {
        match face {
            TOP | BOTTOM => self.fill_polar(cubic, (kernel, caps), [face, y], out),
            _ => self.fill_side(cubic, [face, y], out),
        }
    }

    fn fill_side(&self, cubic: &Cubic, [face, y]: [usize; 2], out: &mut [u8]) {
        let places = self.places;
        // A quarter turn is a whole number of 64ths for any width.
        let turned = (places.width * PHASES / 4 * face) as i64;
        let rows = &places.rows[y * places.face..][..places.face];
        for ((out, (row, down)), (column, along)) in out.iter_mut().zip(rows).zip(&places.columns) {
            let weights = [
                cubic.at(*along, column + turned),
                cubic.at(*down, i64::from(*row)),
            ];
            *out = self.sample(0, [column + turned, i64::from(*row)], weights);
        }
    }

    fn fill_polar(
        &self,
        cubic: &Cubic,
        (kernel, caps): (&Kernel, &[Cap; 2]),
        [face, y]: [usize; 2],
        out: &mut [u8],
    ) {
        let places = self.places;
        let is_top = face == TOP;
        // The bottom face is the top face of a sphere mirrored top to bottom.
        let like = if is_top { y } else { places.face - 1 - y };
        let tangent = |index: usize| (index as f64 + 0.5) * 2.0 / places.face as f64 - 1.0;
        let b = tangent(like);
        let polar = &places.polar[like * places.face..][..places.face];
        for (x, (out, [column, row])) in out.iter_mut().zip(polar).enumerate() {
            let a = tangent(x);
            if a * a + b * b < places.cap_radius * places.cap_radius {
                *out = caps[usize::from(!is_top)].at(kernel, a, b);
                continue;
            }
            let nearest = (row >> 6).clamp(0, places.height as i32 - 1) as usize;
            let Widening {
                halvings,
                along,
                down,
            } = places.widenings[nearest];
            // Samples lie at half integers of each level's own columns.
            let half = PHASES as i64 / 2;
            let column = ((i64::from(*column) + half) >> halvings) - half;
            let row = i64::from(*row);
            let row = if is_top {
                row
            } else {
                ((places.height as i64 - 1) << 6) - row
            };
            let weights = [cubic.at(along, column), cubic.at(down, row)];
            *out = self.sample(halvings, [column, row], weights);
        }
    }

    #[inline]
    fn sample(&self, level: u8, [column, row]: [i64; 2], [along, down]: [&Weights; 2]) -> u8 {
        let rows = &self.levels[usize::from(level)];
        let width = (self.places.width >> level) as i64;
        let first = ((column >> 6) + 1 - BEFORE).rem_euclid(width) as usize;
        let top = (row >> 6) + 1 - BEFORE;
        let last = self.places.height as i64 - 1;
        let mut sum = 0i32;
        for (tap, weight) in (top..).zip(down) {
            if *weight == 0 {
                continue;
            }
            let row = &rows[tap.clamp(0, last) as usize];
            // Four bits less, so that the products of the second pass fit.
            sum += ((dot(&row[first..first + TAPS], along) + 8) >> 4) * i32::from(*weight);
        }
        ((sum + (1 << 19)) >> 20).clamp(0, 255) as u8
    }
}

/// In pairs, as vector units multiply and add.
#[inline]
fn dot(samples: &[i16], weights: &Weights) -> i32 {
    let mut sums = [0i32; TAPS / 2];
    let (samples, _) = samples.as_chunks::<2>();
    let (weights, _) = weights.as_chunks::<2>();
    for (sum, (s, w)) in sums.iter_mut().zip(samples.iter().zip(weights)) {
        *sum = i32::from(s[0]) * i32::from(w[0]) + i32::from(s[1]) * i32::from(w[1]);
    }
    sums.iter().sum()
}

/// The row with what follows its end when it is closed to a turn.
fn wrapped(mut row: Vec<i16>) -> Vec<i16> {
    row.extend_from_within(..TAPS);
    row
}

/// Half of a wrapped row.
fn halve(row: &[i16]) -> Vec<i16> {
    let width = row.len() - TAPS;
    let at = |column: i64| i32::from(row[column.rem_euclid(width as i64) as usize]);
    let sample = |i: usize| {
        let taps = (2 * i as i64 - 2..).zip(HALVING);
        let sum: i32 = taps.map(|(column, tap)| tap * at(column)).sum();
        ((sum + 16) >> 5).clamp(0, 255) as i16
    };
    wrapped((0..width / 2).map(sample).collect())
}
