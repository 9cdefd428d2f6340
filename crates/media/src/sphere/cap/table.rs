//! Which weights do the samples of a cap have, whatever the picture?
//!
//! Both poles and all frames share them. Samples are taken from rows that are halved along
//! longitude about as often as their spacing allows, so that few source samples count for each.

use super::{Cap, code_value, yaw_of};
use crate::sphere::kernel::{Kernel, REACH};
use crate::sphere::plane::Plane;

/// Columns of a halved row that a sample on a circle spans, at least.
const LEAST_RATIO: f64 = 2.0;

/// A cap of the top face as weighted sums of weighted sums.
pub(in crate::sphere) struct CapTable {
    circles: Vec<Ring>,
    /// First row and column of the face in the cap, and how many.
    start: usize,
    side: usize,
    /// Where in [`Self::weights`] each pixel's begin; one more than pixels.
    begins: Vec<usize>,
    /// Sample of the circles and its weight; of no pixel outside the cap.
    weights: Vec<(u32, f32)>,
}

/// The samples of one source row.
struct Ring {
    row: usize,
    /// How often the row is halved.
    halvings: u8,
    /// Of each sample: its first column.
    firsts: Vec<usize>,
    /// Weights of one sample after the other, equally many.
    weights: Vec<f32>,
}

impl CapTable {
    /// `halvings` says how often each row, counted from the pole, may be halved.
    pub(in crate::sphere) fn new(
        plane: &Plane,
        kernel: &Kernel,
        halvings: impl Fn(usize) -> u8,
    ) -> Self {
        let cap = Cap::without_values(plane);
        let mut number = 0;
        let mut starts = vec![0; plane.height];
        let mut circles = Vec::new();
        for circle in &cap.circles {
            starts[circle.row] = number;
            number += circle.samples.len() as u32;
            let most = (circle.ratio(plane.width) / LEAST_RATIO).log2().max(0.0);
            let halvings = halvings(circle.row).min(most as u8);
            let count = circle.samples.len();
            circles.push(Ring::new(plane, kernel, [circle.row, count], halvings));
        }
        let radius = (plane.cap_radius() * plane.samples_at_pole()).ceil() as usize + 1;
        let start = (plane.face / 2).saturating_sub(radius);
        let side = plane.face - 2 * start;
        let mut this = Self {
            circles,
            start,
            side,
            begins: vec![0],
            weights: Vec::new(),
        };
        for pixel in 0..side * side {
            let place = [pixel % side, pixel / side].map(|k| plane.tangent(start + k));
            let [a, b] = place;
            if a * a + b * b < plane.cap_radius() * plane.cap_radius() {
                let begin = this.weights.len();
                cap.each_weight(plane, kernel, place, |circle, k, weight| {
                    this.weights.push((starts[circle.row] + k as u32, weight));
                });
                let total: f32 = this.weights[begin..].iter().map(|(_, weight)| weight).sum();
                this.weights[begin..]
                    .iter_mut()
                    .for_each(|(_, weight)| *weight /= total);
            }
            this.begins.push(this.weights.len());
        }
        this
    }

    /// Code values of the circles' samples, out of one turn of rows: by halvings and number.
    pub(in crate::sphere) fn values<'a>(&self, row: impl Fn(u8, usize) -> &'a [u8]) -> Vec<f32> {
        let mut values = Vec::new();
        for circle in &self.circles {
            circle.add_values(row(circle.halvings, circle.row), &mut values);
        }
        values
    }

    /// The samples of one row of the face that lie in the cap, with their columns.
    pub(in crate::sphere) fn row<'a>(
        &'a self,
        y: usize,
        values: &'a [f32],
    ) -> impl Iterator<Item = (usize, u8)> {
        let is_in = (self.start..self.start + self.side).contains(&y);
        let columns = if is_in { 0..self.side } else { 0..0 };
        columns.filter_map(move |x| {
            let pixel = (y - self.start) * self.side + x;
            let weights = &self.weights[self.begins[pixel]..self.begins[pixel + 1]];
            let products = weights.iter().map(|(k, w)| values[*k as usize] * w);
            let is_in = !weights.is_empty();
            is_in.then(|| (self.start + x, code_value(products.sum())))
        })
    }
}

impl Ring {
    fn new(plane: &Plane, kernel: &Kernel, [row, count]: [usize; 2], halvings: u8) -> Self {
        let width = plane.width >> halvings;
        let ratio = (width as f64 / count as f64).max(1.0);
        let reach = REACH * ratio;
        let taps = (2.0 * reach) as usize + 1;
        let (mut firsts, mut weights) = (Vec::new(), Vec::new());
        for k in 0..count {
            // Samples lie at half integers of each level's own columns.
            let column = (plane.column(yaw_of(k, count)) + 0.5) / f64::from(1 << halvings) - 0.5;
            let first = (column - reach).ceil() as i64;
            firsts.push(first.rem_euclid(width as i64) as usize);
            let begin = weights.len();
            let weight = |tap: i64| kernel.at(((tap as f64 - column) / ratio) as f32);
            weights.extend((first..).take(taps).map(weight));
            let total: f32 = weights[begin..].iter().sum();
            weights[begin..].iter_mut().for_each(|w| *w /= total);
        }
        Self {
            row,
            halvings,
            firsts,
            weights,
        }
    }

    fn add_values(&self, turn: &[u8], out: &mut Vec<f32>) {
        let taps = self.weights.len() / self.firsts.len();
        for (first, weights) in self.firsts.iter().zip(self.weights.chunks_exact(taps)) {
            let (before, after) = turn.split_at(*first);
            let columns = after.iter().chain(before.iter()).cycle();
            out.push(
                weights
                    .iter()
                    .zip(columns)
                    .map(|(w, s)| w * f32::from(*s))
                    .sum(),
            );
        }
    }
}
