//! How do the top and bottom faces get their samples, fast?
//!
//! Towards a pole circles of latitude shrink, so rows are halved along longitude as often as that
//! takes; then eight samples across and six down suffice. Rows are counted from the pole, so both
//! faces share their places. The cap at the pole is that of [`super::super::cap`], with its weights
//! computed once.

use super::super::block::{BOTTOM, Block, STRIP, TOP};
use super::super::cap::table::CapTable;
use super::super::kernel::Kernel;
use super::super::plane::Plane;
use super::cubic::{
    BEFORE, Cubic, INNER, PHASE_BITS, PHASES, TAPS, code_value, entry, steps, sum_inner_codes,
    width_index,
};
use std::f64::consts::PI;
use std::ops::Range;

/// Weights of a halving along longitude, in 32nds, as of [`crate::prepare::pyramid`].
const HALVING: [i16; 3] = [-1, 4, 13];

/// Where a sample looks, and how wide its kernel is.
#[derive(Clone, Copy)]
struct Look {
    /// Column and row, in 64ths.
    place: [i32; 2],
    /// Widening along a row that is halved as its row number asks for, and across rows.
    along: u8,
    down: u8,
}

/// Where the samples of the top face look.
pub(super) struct PolePlaces {
    face: usize,
    looks: Vec<Look>,
    /// How often each row is halved.
    halvings: Vec<u8>,
    cap: CapTable,
}

impl PolePlaces {
    /// `None` where rows cannot be halved as often as the poles need, or are too short.
    pub(super) fn new(plane: &Plane, kernel: &Kernel) -> Option<Self> {
        let halvings: Vec<u8> = (0..plane.height).map(|row| halvings(plane, row)).collect();
        let most = halvings.first().copied().unwrap_or(0);
        let fits = plane.width.is_multiple_of(1 << most) && plane.width >> most >= 4 * TAPS;
        if !fits || plane.height < 4 * TAPS {
            return None;
        }
        let tangents: Vec<f64> = (0..plane.face).map(|i| plane.tangent(i)).collect();
        let look = |a: f64, b: f64| {
            let radius = (a * a + b * b).sqrt();
            let place = [
                steps(plane.column(libm::atan2(a, b))) as i32,
                steps(plane.row(libm::atan(radius))) as i32,
            ];
            let halved = halvings[nearest(place[1], plane.height)];
            let [away, round] = plane.pole_slopes([a, b]);
            // Within the cap nothing is read so.
            let along = plane.columns_per_step() * round / radius.max(plane.cap_radius() * 0.9);
            let down = plane.rows_per_step() * away / (1.0 + radius * radius);
            Look {
                place,
                along: width_index(along / f64::from(1 << halved)),
                down: width_index(down),
            }
        };
        let row_of = |b: &f64| tangents.iter().map(|a| look(*a, *b)).collect::<Vec<_>>();
        Some(Self {
            face: plane.face,
            looks: tangents.iter().flat_map(row_of).collect(),
            cap: CapTable::new(plane, kernel, |row| halvings[row]),
            halvings,
        })
    }

    /// Rows of the face that parts of the work take.
    pub(super) fn strips(&self) -> impl Iterator<Item = Range<usize>> {
        let face = self.face;
        (0..face)
            .step_by(STRIP)
            .map(move |start| start..(start + STRIP).min(face))
    }

    /// Rows of the top face, or those of the bottom face that are like them.
    pub(super) fn block(&self, cubic: &Cubic, rows: &PoleRows, strip: Range<usize>) -> Block {
        let mut samples = vec![0; strip.len() * self.face];
        for (k, out) in samples.chunks_exact_mut(self.face).enumerate() {
            let like = if rows.is_top {
                strip.start + k
            } else {
                // The bottom face is the top face of a sphere mirrored top to bottom.
                strip.end - 1 - k
            };
            self.fill(cubic, rows, like, out);
        }
        let (face, y) = match rows.is_top {
            true => (TOP, strip.start),
            false => (BOTTOM, self.face - strip.end),
        };
        Block {
            face,
            at: [0, y],
            width: self.face,
            samples,
        }
    }

    fn fill(&self, cubic: &Cubic, rows: &PoleRows, y: usize, out: &mut [u8]) {
        let looks = &self.looks[y * self.face..][..self.face];
        for (out, look) in out.iter_mut().zip(looks) {
            let halvings = self.halvings[nearest(look.place[1], self.halvings.len())];
            *out = rows.sample(cubic, look, halvings);
        }
        for (x, sample) in self.cap.row(y, &rows.around) {
            out[x] = sample;
        }
    }
}

/// How often a row may be halved along longitude: so that its samples are still as near to each
/// other as those of the face.
fn halvings(plane: &Plane, row: usize) -> u8 {
    let radius = libm::tan(((row as f64 + 0.5) * PI / plane.height as f64).min(1.5));
    let [_, round] = plane.pole_slopes([radius, 0.0]);
    let stretch = plane.columns_per_step() * round / radius.max(plane.cap_radius() * 0.9);
    stretch.max(1.0).log2().floor() as u8
}

/// The row at or above a place in 64ths.
fn nearest(row: i32, height: usize) -> usize {
    (row >> PHASE_BITS).clamp(0, height as i32 - 1) as usize
}

/// The rows round one pole of one plane: whole, and halved along longitude where they are read so.
pub(super) struct PoleRows<'a> {
    plane: &'a Plane,
    is_top: bool,
    /// Of each halving, rows from the pole on, each with what follows its end.
    halved: Vec<Vec<u8>>,
    /// Code values of the samples around the pole.
    around: Vec<f32>,
}

impl<'a> PoleRows<'a> {
    pub(super) fn new(places: &PolePlaces, plane: &'a Plane, is_top: bool) -> Self {
        let mut this = Self {
            plane,
            is_top,
            halved: Vec::new(),
            around: Vec::new(),
        };
        let most = places.halvings.first().copied().unwrap_or(0);
        for level in 1..=most {
            let width = plane.width >> level;
            let read = places
                .halvings
                .partition_point(|halvings| *halvings >= level);
            let mut rows = Vec::with_capacity((read + TAPS) * (width + TAPS));
            // A kernel reads rows next to the one that it is at.
            for row in 0..(read + TAPS / 2).min(plane.height) {
                halve(this.row(level - 1, row), &mut rows);
            }
            this.halved.push(rows);
        }
        let around = |level: u8, row: usize| this.row(level, row);
        this.around = places.cap.values(around);
        this
    }

    /// One turn of a row.
    fn row(&self, level: u8, row: usize) -> &[u8] {
        let width = self.plane.width >> level;
        match level.checked_sub(1) {
            None => self.plane.turn(self.row_of_plane(row)),
            Some(halving) => &self.halved[usize::from(halving)][row * (width + TAPS)..][..width],
        }
    }

    #[inline]
    fn row_of_plane(&self, row: usize) -> usize {
        if self.is_top {
            row
        } else {
            self.plane.height - 1 - row
        }
    }

    #[inline]
    fn sample(&self, cubic: &Cubic, look: &Look, halvings: u8) -> u8 {
        let [column, row] = look.place.map(i64::from);
        // Samples lie at half integers of each level's own columns.
        let half = PHASES / 2;
        let column = ((column + half) >> halvings) - half;
        let width = (self.plane.width >> halvings) as i64;
        let mut first = (column >> PHASE_BITS) - BEFORE;
        first += width * (i64::from(first < 0) - i64::from(first >= width));
        let top = (row >> PHASE_BITS) - BEFORE + 1;
        let last = self.plane.height as i64 - 1;
        let (samples, stride) = match halvings.checked_sub(1) {
            None => self.plane.rows(),
            Some(halving) => (
                self.halved[usize::from(halving)].as_slice(),
                width as usize + TAPS,
            ),
        };
        let is_mirrored = !self.is_top && halvings == 0;
        let rows = std::array::from_fn::<_, INNER, _>(|k| {
            let row = (top + k as i64).clamp(0, last);
            let row = if is_mirrored { last - row } else { row };
            let start = row as usize * stride + first as usize;
            let taps = samples.get(start..).and_then(<[u8]>::first_chunk);
            taps.unwrap_or(&[0; TAPS])
        });
        let sums = sum_inner_codes(rows, cubic.at(entry(row, look.down)));
        code_value(sums, cubic.at(entry(column, look.along)))
    }
}

/// Appends half of a turn, and what follows its end.
fn halve(turn: &[u8], out: &mut Vec<u8>) {
    let width = turn.len();
    let half = width / 2;
    let at = |column: usize| i16::from(turn[column % width]);
    let (mut even, mut odd) = (Vec::with_capacity(half + 2), Vec::with_capacity(half + 2));
    let (pairs, _) = turn.as_chunks::<2>();
    even.push(at(width - 2));
    odd.push(at(width - 1));
    even.extend(pairs.iter().map(|pair| i16::from(pair[0])));
    odd.extend(pairs.iter().map(|pair| i16::from(pair[1])));
    even.extend([at(0), at(2)]);
    odd.extend([at(1), at(3)]);
    let start = out.len();
    let (e0, e1, e2) = (&even[..half], &even[1..][..half], &even[2..][..half]);
    let (o0, o1, o2) = (&odd[..half], &odd[1..][..half], &odd[2..][..half]);
    let [outer, inner, middle] = HALVING;
    out.extend((0..half).map(|x| {
        let sum = outer * (e0[x] + o2[x]) + inner * (o0[x] + e2[x]) + middle * (e1[x] + o1[x]);
        ((sum + 16) >> 5).clamp(0, 255) as u8
    }));
    out.extend_from_within(start..start + TAPS);
}
