//! Which units are dense enough to be looked at now?
//!
//! Sorting all units costs more than the few thousand steps that a budget buys. So units come in
//! bands of density, the densest band first, and a band is opened only when what was offered
//! before is poorer than its upper end. The order of steps does not depend on where bands end.

/// Units in the first band, about: a budget of 2,000 steps rarely needs a second.
const FIRST_BAND: usize = 4096;
/// Each band is so many times as large as the one before.
const GROWTH: usize = 4;
/// Densities that are looked at to place the end of a band.
const SAMPLES: usize = 1024;

/// Which densities have been opened: those of at least `floor`.
#[derive(Clone, Debug)]
pub(super) struct Frontier {
    /// Densities as bit patterns, which for numbers from 0 on are in the same order.
    floor: u64,
    band: usize,
}

impl Frontier {
    /// Nothing is open yet.
    pub(super) fn new() -> Self {
        let floor = u64::MAX;
        Self {
            floor,
            band: FIRST_BAND,
        }
    }

    /// Whether every unit that is at least as dense has been opened.
    pub(super) fn covers(&self, density: f64) -> bool {
        density.to_bits() >= self.floor
    }

    /// Whether all units with a positive density have been opened.
    pub(super) fn is_exhausted(&self) -> bool {
        self.floor <= 1
    }

    /// Opens the next band and returns its units, in ascending number. Costs one pass over the
    /// densities.
    pub(super) fn open(&mut self, density: &[f64]) -> Vec<u32> {
        let ceiling = self.floor;
        self.floor = floor_of_band(density, ceiling, self.band);
        self.band = self.band.saturating_mul(GROWTH);
        let band = self.floor..ceiling;
        let numbered = (0..).zip(density);
        numbered
            .filter(|(_, density)| band.contains(&density.to_bits()))
            .map(|(unit, _)| unit)
            .collect()
    }
}

/// A density, as bits, below `ceiling` and above which about `size` units lie.
fn floor_of_band(density: &[f64], ceiling: u64, size: usize) -> u64 {
    let stride = density.len().div_ceil(SAMPLES).max(1);
    let sampled = density
        .iter()
        .step_by(stride)
        .map(|density| density.to_bits());
    let mut sample: Vec<u64> = sampled.filter(|bits| (1..ceiling).contains(bits)).collect();
    let place = size / stride;
    if place >= sample.len() {
        return 1;
    }
    let (_, floor, _) = sample.select_nth_unstable_by(place, |a, b| b.cmp(a));
    *floor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    fn bands(density: &[f64]) -> Vec<Vec<u32>> {
        let mut frontier = Frontier::new();
        let mut bands = Vec::new();
        while !frontier.is_exhausted() {
            bands.push(frontier.open(density));
        }
        bands
    }

    #[test]
    fn every_unit_of_some_density_is_opened_once_and_denser_bands_first() {
        let mut random = Random::new(3);
        let density: Vec<f64> = (0..50_000)
            .map(|unit| match unit % 100 {
                0 => f64::INFINITY,
                1 => 0.0,
                _ => random.unit() * random.unit(),
            })
            .collect();
        let bands = bands(&density);
        assert!(bands.len() > 1 && bands[0].len() < 10_000);
        let mut least = f64::INFINITY;
        for band in &bands {
            let of_band = || band.iter().map(|unit| density[*unit as usize]);
            assert!(of_band().all(|density| density <= least && density > 0.0));
            least = of_band().fold(least, f64::min);
        }
        let mut all: Vec<u32> = bands.concat();
        all.sort_unstable();
        let expected = (0..).zip(&density).filter(|(_, density)| **density > 0.0);
        assert_eq!(all, expected.map(|(unit, _)| unit).collect::<Vec<u32>>());
    }

    #[test]
    fn equal_densities_end_in_one_band() {
        assert_eq!(
            bands(&vec![1.0; 50_000]).iter().map(Vec::len).max(),
            Some(50_000)
        );
        assert_eq!(bands(&[]), vec![Vec::<u32>::new()]);
    }
}
