//! In which order are the places of a square filled so that every beginning is evenly spread?
//!
//! Void and cluster: Ulichney 1993, *The void-and-cluster method for dither array generation*. A
//! point raises an energy round itself; the tightest cluster is where it is highest on a point, the
//! largest void where it is lowest off one. Below a tenth of the places Ulichney's Gaussian no
//! longer reaches from point to point, so it widens here with their spacing.

use crate::view::random::Random;

/// Places on a side of the square, which repeats in both directions.
pub const SIDE: usize = 128;
const PLACES: usize = SIDE * SIDE;
/// Points that the order is grown from, downwards and upwards: a tenth (Ulichney 1993).
const FIRST: usize = PLACES / 10;
/// Spread of a point's energy at that count, in places (Ulichney 1993).
const SIGMA: f64 = 1.5;

/// The rank of every place, row by row: a permutation. The places of rank below n are evenly
/// spread for every n. Depends on the seed alone; costs about a quarter of a second.
#[must_use]
pub fn blue_noise_ranks(seed: u64) -> Vec<u16> {
    let mut ranks = vec![0u16; PLACES];
    let first = relaxed(seed);
    let mut fewer = first.clone();
    let mut widened_at = FIRST;
    for left in (0..FIRST).rev() {
        if left < widened_at / 2 {
            widened_at = left;
            fewer.widen(SIGMA * (FIRST as f64 / left.max(1) as f64).sqrt());
        }
        let place = fewer.tightest_cluster();
        fewer.set(place, false);
        ranks[place] = left as u16;
    }
    let mut more = first;
    for count in FIRST..PLACES {
        let place = more.largest_void();
        more.set(place, true);
        ranks[place] = count as u16;
    }
    ranks
}

/// Seeded random points, moved from clusters into voids until none moves.
fn relaxed(seed: u64) -> Field {
    let mut random = Random::new(seed);
    let mut field = Field::new(SIGMA);
    let mut count = 0;
    while count < FIRST {
        let place = ((random.unit() * PLACES as f64) as usize).min(PLACES - 1);
        if !field.points[place] {
            field.set(place, true);
            count += 1;
        }
    }
    // Every move lowers the sum of the energies, so few are needed; the bound is for rounding.
    for _ in 0..8 * FIRST {
        let cluster = field.tightest_cluster();
        field.set(cluster, false);
        let void = field.largest_void();
        field.set(void, true);
        if void == cluster {
            break;
        }
    }
    field
}

/// Points on a torus and the energy that they make.
#[derive(Clone)]
struct Field {
    points: Vec<bool>,
    energy: Vec<f32>,
    /// Energy of a point at (0, 0).
    kernel: Vec<f32>,
}

impl Field {
    fn new(sigma: f64) -> Self {
        Self {
            points: vec![false; PLACES],
            energy: vec![0.0; PLACES],
            kernel: kernel(sigma),
        }
    }

    fn set(&mut self, place: usize, is_point: bool) {
        self.points[place] = is_point;
        self.raise(place, if is_point { 1.0 } else { -1.0 });
    }

    fn raise(&mut self, place: usize, by: f32) {
        let (x, y) = (place % SIDE, place / SIDE);
        for row in 0..SIDE {
            let from = (row + SIDE - y) % SIDE * SIDE;
            let kernel = &self.kernel[from..from + SIDE];
            let (before, after) = self.energy[row * SIDE..(row + 1) * SIDE].split_at_mut(x);
            let add = |(energy, kernel): (&mut f32, &f32)| *energy += by * kernel;
            after.iter_mut().zip(kernel).for_each(add);
            before.iter_mut().zip(&kernel[SIDE - x..]).for_each(add);
        }
    }

    fn widen(&mut self, sigma: f64) {
        self.kernel = kernel(sigma);
        self.energy.fill(0.0);
        let points: Vec<usize> = (0..PLACES).filter(|&place| self.points[place]).collect();
        points.into_iter().for_each(|place| self.raise(place, 1.0));
    }

    fn tightest_cluster(&self) -> usize {
        let points = (0..PLACES).filter(|&place| self.points[place]);
        let higher = |a: usize, b| {
            if self.energy[b] > self.energy[a] {
                b
            } else {
                a
            }
        };
        points.reduce(higher).unwrap_or(0)
    }

    fn largest_void(&self) -> usize {
        let free = (0..PLACES).filter(|&place| !self.points[place]);
        let lower = |a: usize, b| {
            if self.energy[b] < self.energy[a] {
                b
            } else {
                a
            }
        };
        free.reduce(lower).unwrap_or(0)
    }
}

fn kernel(sigma: f64) -> Vec<f32> {
    let reach = |k: usize| k.min(SIDE - k) as f64;
    let energy = |k: usize| {
        let (dx, dy) = (reach(k % SIDE), reach(k / SIDE));
        libm::exp(-(dx * dx + dy * dy) / (2.0 * sigma * sigma)) as f32
    };
    (0..PLACES).map(energy).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least distance between two places of rank below `count`, on the torus, in places.
    fn least_distance(ranks: &[u16], count: usize) -> f64 {
        let points: Vec<usize> = (0..PLACES)
            .filter(|&p| usize::from(ranks[p]) < count)
            .collect();
        assert_eq!(points.len(), count);
        let mut least = f64::MAX;
        for (k, a) in points.iter().enumerate() {
            for b in &points[..k] {
                let away = |a: usize, b: usize| a.abs_diff(b).min(SIDE - a.abs_diff(b)) as f64;
                let (dx, dy) = (away(a % SIDE, b % SIDE), away(a / SIDE, b / SIDE));
                least = least.min((dx * dx + dy * dy).sqrt());
            }
        }
        least
    }

    #[test]
    fn every_beginning_of_the_order_is_evenly_spread() {
        let ranks = blue_noise_ranks(1);
        let mut sorted = ranks.clone();
        sorted.sort_unstable();
        assert!((0..PLACES).all(|k| usize::from(sorted[k]) == k));
        for count in [4, 16, 60, 250, 1000, 1638, 3000] {
            // Random points come within a place of each other; a triangular lattice keeps 1.07.
            let spacing = (PLACES as f64 / count as f64).sqrt();
            let share = least_distance(&ranks, count) / spacing;
            assert!(share > 0.4, "{count}: {share}");
        }
    }

    #[test]
    fn a_seed_gives_one_order() {
        assert_eq!(blue_noise_ranks(3), blue_noise_ranks(3));
        assert_ne!(blue_noise_ranks(3), blue_noise_ranks(4));
    }
}
