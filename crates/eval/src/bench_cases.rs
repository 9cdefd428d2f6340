//! On which content is selection timed?
//!
//! The same for every machine, and for the benchmark as for the program.

use foveal_core::selection::greedy::{
    Catalog, CatalogBuilder, CatalogError, Chain, Rule, Rung, Step,
};
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

/// Bytes that buy about the best 2,000 steps of the catalog of a scene.
pub const SCENE_BUDGET_BYTES: u64 = 1_800_000;
/// Bytes of a unit of a scene, at least and at most.
const SCENE_BYTES: [f64; 2] = [600.0, 1_200.0];

/// A catalog as a scene has it: 100,000 units of one step, each of which, but for the first, needs
/// two coarser ones, where `needs` says so.
///
/// # Errors
/// None that these sizes can cause.
pub fn scene_catalog(rule: Rule, needs: bool) -> Result<Catalog, CatalogError> {
    let mut random = Random::new(SEED);
    let mut builder = CatalogBuilder::default();
    for unit in 0..UNITS {
        let [least, most] = SCENE_BYTES;
        let step = Step {
            bytes: (least + (most - least) * random.unit()) as u32,
            value: scene_value_at(unit, 0),
        };
        builder.add(Chain::Refining, &[step])?;
        let Some(before) = unit.checked_sub(1).filter(|_| needs) else {
            continue;
        };
        // Each level has twice the units of the one before; a group lies over two groups of it.
        let over = [before / 2, (before / 2).saturating_sub(1)];
        let over = over.map(|unit| Rung { unit, level: 0 });
        let distinct = 1 + usize::from(over[0] != over[1]);
        builder.require(Rung { unit, level: 0 }, &over[..distinct]);
    }
    builder.build(rule)
}

/// What a unit of a scene is worth, `moment` gaze positions after the start: what it covers, half
/// of a coarser one's, times an acuity that falls with the distance from a gaze that lies
/// elsewhere in each moment.
#[must_use]
pub fn scene_value_at(unit: u32, moment: u32) -> f64 {
    let level = (unit + 1).ilog2();
    let first = (1u64 << level) - 1;
    let place = (u64::from(unit) - first) as f64 / (first + 1) as f64;
    let gaze = Random::new(SEED ^ u64::from(moment)).unit();
    let eccentricity_deg = 60.0 * (place - gaze).abs();
    let area = 3_000.0 / (first + 1) as f64;
    area / (1.0 + eccentricity_deg / 2.3)
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
    fn what_a_scene_needs_comes_first_and_the_budget_buys_about_two_thousand_steps() {
        let mut catalog = scene_catalog(Rule::default(), true).unwrap();
        let plan = catalog.select(SCENE_BUDGET_BYTES);
        let steps = plan.choices.len();
        assert!((1_900..=2_100).contains(&steps), "{steps}");
        let mut there = std::collections::HashSet::new();
        for choice in &plan.choices {
            let before = choice.unit.checked_sub(1).map(|it| it / 2);
            assert!(before.is_none_or(|it| there.contains(&it)), "{choice:?}");
            there.insert(choice.unit);
        }
    }

    #[test]
    fn every_moment_has_values_of_its_own() {
        assert!((0..1_000).all(|unit| values_at(unit, 0) != values_at(unit, 1)));
    }
}
