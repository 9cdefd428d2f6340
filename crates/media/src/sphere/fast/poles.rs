//! How do the top and bottom faces get their samples, fast?
//!
//! Towards a pole circles of latitude shrink, so rows are halved along longitude as often as that
//! takes; then eight samples across and six down suffice. Rows are counted from the pole, so both
//! faces share their places. The cap at the pole is that of [`super::super::cap`], with its weights
//! computed once.

use super::super::cap::CapTable;
use super::super::kernel::Kernel;
use super::super::plane::Plane;
use super::super::{BOTTOM, Block, STRIP, TOP};
use super::cubic::{
    BEFORE, Cubic, INNER, PHASE_BITS, PHASES, TAPS, code_value, entry, steps, sum_inner_codes,
    width_index,
};
use std::f64::consts::PI;
use std::ops::Range;

/// Weights of a halving along longitude, in 32nds, as of [`crate::pyramid`].
const HALVING: [i16; 3] = [-1, 4, 13];

/// How often a row is halved for the poles, and the widening that is left.
#[derive(Clone, Copy, Default)]
struct Widening {
    halvings: u8,
    along: u8,
    down: u8,
}

/// Where the samples of the top face look.
pub(super) struct PolePlaces {
    face: usize,
    /// Column and row, in 64ths.
    places: Vec<[i32; 2]>,
    /// Of each row.
    widenings: Vec<Widening>,
    cap: CapTable,
}

impl PolePlaces {
    /// `None` where rows cannot be halved as often as the poles need, or are too short.
    pub(super) fn new(plane: &Plane, kernel: &Kernel) -> Option<Self> {
        let widenings: Vec<Widening> = (0..plane.height).map(|row| widening(plane, row)).collect();
        let most = widenings.first().map_or(0, |w| w.halvings);
        let fits = plane.width.is_multiple_of(1 << most) && plane.width >> most >= 4 * TAPS;
        if !fits || plane.height < 4 * TAPS {
            return None;
        }
        let tangents: Vec<f64> = (0..plane.face).map(|i| plane.tangent(i)).collect();
        let place = |a: f64, b: f64| {
            let radius = (a * a + b * b).sqrt();
            [
                steps(plane.column(libm::atan2(a, b))) as i32,
                steps(plane.row(libm::atan(radius))) as i32,
            ]
        };
        let places = tangents
            .iter()
            .flat_map(|b| tangents.iter().map(move |a| place(*a, *b)))
            .collect();
        let halvings = |row: usize| widenings[row].halvings;
        Some(Self {
            face: plane.face,
            places,
            cap: CapTable::new(plane, kernel, halvings),
            widenings,
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
        let places = &self.places[y * self.face..][..self.face];
        for (out, [column, row]) in out.iter_mut().zip(places) {
            let nearest = (row >> PHASE_BITS).clamp(0, self.widenings.len() as i32 - 1);
            let widening = self.widenings[nearest as usize];
            let place = [*column, *row].map(i64::from);
            *out = rows.sample(cubic, place, widening);
        }
        for (x, sample) in self.cap.row(y, &rows.around) {
            out[x] = sample;
        }
    }
}

fn widening(plane: &Plane, row: usize) -> Widening {
    let density = plane.width as f64 / PI / plane.face as f64;
    let radius = libm::tan(((row as f64 + 0.5) * PI / plane.height as f64).min(1.5));
    let stretch = (density / radius.max(plane.cap_radius() * 0.9)).max(1.0);
    let halvings = stretch.log2().floor();
    Widening {
        halvings: halvings as u8,
        along: width_index(stretch / halvings.exp2()),
        down: width_index((plane.rows_per_step() / (1.0 + radius * radius)).max(1.0)),
    }
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
        let most = places.widenings.first().map_or(0, |w| w.halvings);
        for level in 1..=most {
            let width = plane.width >> level;
            let read = places
                .widenings
                .partition_point(|widening| widening.halvings >= level);
            let mut rows = Vec::with_capacity((read + TAPS) * (width + TAPS));
            // A kernel reads beside the row that it is at.
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
    fn sample(&self, cubic: &Cubic, [column, row]: [i64; 2], widening: Widening) -> u8 {
        // Samples lie at half integers of each level's own columns.
        let half = PHASES / 2;
        let column = ((column + half) >> widening.halvings) - half;
        let width = (self.plane.width >> widening.halvings) as i64;
        let mut first = (column >> PHASE_BITS) - BEFORE;
        first += width * (i64::from(first < 0) - i64::from(first >= width));
        let top = (row >> PHASE_BITS) - BEFORE + 1;
        let last = self.plane.height as i64 - 1;
        let (samples, stride) = match widening.halvings.checked_sub(1) {
            None => self.plane.rows(),
            Some(halving) => (
                self.halved[usize::from(halving)].as_slice(),
                width as usize + TAPS,
            ),
        };
        let is_mirrored = !self.is_top && widening.halvings == 0;
        let rows = std::array::from_fn::<_, INNER, _>(|k| {
            let row = (top + k as i64).clamp(0, last);
            let row = if is_mirrored { last - row } else { row };
            let start = row as usize * stride + first as usize;
            let taps = samples.get(start..).and_then(<[u8]>::first_chunk);
            taps.unwrap_or(&[0; TAPS])
        });
        let sums = sum_inner_codes(rows, cubic.at(entry(row, widening.down)));
        code_value(sums, cubic.at(entry(column, widening.along)))
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
