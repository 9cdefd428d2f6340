//! Does the paper's rule choose what the paper's greedy chooses?
//!
//! An instance of our own in the shape of the published one: 722 units of four steps that cost 4,
//! 12, 24 and 48, a fifth to a third of them in view, a budget of 300.

use super::super::Rule;
use super::*;

const COSTS: [u32; 4] = [4, 12, 24, 48];
const BUDGET: u64 = 300;
const UNITS: usize = 722;
/// Weight of popping that the published decision was made with (between 2.443 and 2.763).
const LAMBDA: f64 = 2.5;

/// Value of each step, from the coarsest on: density of the eye's cells over the unit's pixels,
/// less what would pop.
fn values() -> Vec<[f64; 4]> {
    let mut random = Random::new(722);
    let unit = |random: &mut Random| {
        if random.unit() > 0.29 {
            return [0.0; 4];
        }
        let pixels = 95_500.0 * random.unit() * random.unit() * random.unit();
        let acuity = 18.0 * random.unit();
        [1.0, 1.6, 2.2, 2.8].map(|busy| {
            let popping = 2.0 * busy * random.unit();
            pixels * (acuity - LAMBDA * popping)
        })
    };
    (0..UNITS).map(|_| unit(&mut random)).collect()
}

/// The greedy of Chen et al. 2022, section 3, word for word: take the unit with the largest value
/// per byte that still fits; push its next level; repeat.
fn as_printed(values: &[[f64; 4]]) -> (Vec<usize>, u32) {
    let mut raised = vec![0usize; values.len()];
    let mut left = BUDGET as u32;
    loop {
        let mut best: Option<usize> = None;
        for unit in 0..values.len() {
            let next = raised[unit];
            if next == 4 || COSTS[next] > left {
                continue;
            }
            let weight = |unit: usize| values[unit][raised[unit]] / f64::from(COSTS[raised[unit]]);
            if best.is_none_or(|best| weight(unit) > weight(best)) {
                best = Some(unit);
            }
        }
        let Some(unit) = best else {
            return (raised, BUDGET as u32 - left);
        };
        left -= COSTS[raised[unit]];
        raised[unit] += 1;
    }
}

fn histogram(raised: &[usize]) -> [usize; 5] {
    let mut counts = [0; 5];
    raised.iter().for_each(|levels| counts[*levels] += 1);
    counts
}

#[test]
fn the_paper_rule_raises_every_unit_as_the_printed_greedy_does() {
    let values = values();
    let made: Vec<Made> = values
        .iter()
        .map(|values| Made {
            chain: Chain::Refining,
            steps: (0..4)
                .rev()
                .map(|k| Step {
                    bytes: COSTS[k],
                    value: values[k],
                })
                .collect(),
            needed: vec![Vec::new(); 4],
        })
        .collect();
    let mut catalog = build(&made, Rule::PAPER);
    let plan = catalog.select(BUDGET);
    let levels = follow(&catalog, &plan.choices, BUDGET);
    let raised: Vec<usize> = levels.iter().map(|level| 4 - usize::from(*level)).collect();
    let (expected, spent) = as_printed(&values);
    assert_eq!(raised, expected);
    assert_eq!((plan.bytes, spent), (BUDGET, BUDGET as u32));
    assert_eq!(histogram(&raised), [677, 37, 7, 1, 0]);
    assert!(plan.choices.iter().all(|choice| choice.value > 0.0));
}
