//! On which content is selection timed?
//!
//! The same for every machine, and for the benchmark as for the program.

use foveal_core::selection::greedy::{Catalog, CatalogBuilder, CatalogError, Chain, Rule, Step};
use foveal_core::view::random::Random;

/// Units of the large catalog.
pub const UNITS: u32 = 100_000;
/// Steps of each of its units.
pub const LEVELS: usize = 4;
/// Bytes that buy its best 2,000 steps, and hardly a step more.
pub const BUDGET_BYTES: u64 = 1_576_000;
/// The seed of its bytes and values.
const SEED: u64 = 7;
/// Bytes of a coarsest step, at least and at most.
const COARSEST_BYTES: [f64; 2] = [300.0, 2_500.0];

/// A catalog of 100,000 units with 4 steps, none held: bytes grow by about 2.5 from step to step,
/// and every unit is in view and worth something.
///
/// # Errors
/// None that these sizes can cause.
pub fn large_catalog(rule: Rule) -> Result<Catalog, CatalogError> {
    let mut random = Random::new(SEED);
    let mut builder = CatalogBuilder::default();
    for unit in 0..UNITS {
        let [least, most] = COARSEST_BYTES;
        let mut bytes = least + (most - least) * random.unit();
        let values = values_at(unit, 0);
        let mut steps = [Step {
            bytes: 0,
            value: 0.0,
        }; LEVELS];
        for (step, value) in steps.iter_mut().zip(values).rev() {
            *step = Step {
                bytes: bytes as u32,
                value,
            };
            bytes *= 1.5 + 2.0 * random.unit();
        }
        builder.add(Chain::Refining, &steps)?;
    }
    builder.build(rule)
}

/// Values of a unit's steps, finest first, `moment` gaze positions after the start: the unit's
/// share of the picture, times an acuity that falls with eccentricity, times a detail that falls
/// from step to step but not always.
#[must_use]
pub fn values_at(unit: u32, moment: u32) -> [f64; LEVELS] {
    let of_unit = u64::from(unit) << 32;
    let mut random = Random::new(SEED ^ of_unit);
    let area = 20.0 + 1_000.0 * random.unit();
    let mut random = Random::new(SEED ^ of_unit ^ u64::from(moment + 1));
    let eccentricity_deg = 60.0 * random.unit();
    let acuity = 1.0 / (1.0 + eccentricity_deg / 2.3);
    let mut gain = area * acuity;
    let mut values = [0.0; LEVELS];
    for value in values.iter_mut().rev() {
        // Now and then a step pops more than it shows.
        *value = gain * (random.unit() - 0.05);
        gain *= 0.8;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_budget_of_the_large_catalog_buys_about_two_thousand_steps() {
        let mut catalog = large_catalog(Rule::default()).unwrap();
        let plan = catalog.select(BUDGET_BYTES);
        assert!(
            (1_900..=2_100).contains(&plan.choices.len()),
            "{}",
            plan.choices.len()
        );
        assert!(plan.choices.iter().any(|step| step.from - step.level > 1));
        assert!(plan.bytes > BUDGET_BYTES * 99 / 100);
    }

    #[test]
    fn every_moment_has_values_of_its_own() {
        assert!((0..1_000).all(|unit| values_at(unit, 0) != values_at(unit, 1)));
    }
}
