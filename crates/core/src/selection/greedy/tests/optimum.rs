//! How near does the greedy order come to the exact optimum?

use super::super::{Misfit, Plan, Reach, Rule};
use super::*;

/// Cumulative bytes and value of every level of a unit, coarsest first.
fn levels(unit: &Made) -> Vec<(usize, f64)> {
    let mut all = vec![(0, 0.0)];
    let (mut sum, mut value) = (0, 0.0);
    for step in unit.steps.iter().rev() {
        sum += step.bytes as usize;
        value += step.value;
        let bytes = match unit.chain {
            Chain::Refining => sum,
            Chain::Replacing => step.bytes as usize,
        };
        all.push((bytes, value));
    }
    all
}

/// Most value of one level for every unit under a budget: dynamic programme over bytes
/// (multiple-choice knapsack).
fn exact(units: &[Made], budget: usize) -> f64 {
    let mut best = vec![0.0f64; budget + 1];
    for unit in units {
        let levels = levels(unit);
        for left in (0..=budget).rev() {
            let fitting = levels.iter().filter(|(bytes, _)| *bytes <= left);
            best[left] = fitting
                .map(|(bytes, value)| best[left - bytes] + value)
                .fold(0.0, f64::max);
        }
    }
    best[budget]
}

/// Most value of any set of levels that meets all prerequisites: every set is tried.
fn brute_force(units: &[Made], budget: usize) -> f64 {
    let curves: Vec<Vec<(usize, f64)>> = units.iter().map(levels).collect();
    let mut taken = vec![0usize; units.len()];
    let mut best = 0.0f64;
    loop {
        let picked = || {
            curves
                .iter()
                .zip(&taken)
                .map(|(curve, taken)| curve[*taken])
        };
        if picked().map(|(bytes, _)| bytes).sum::<usize>() <= budget && is_closed(units, &taken) {
            best = best.max(picked().map(|(_, value)| value).sum());
        }
        let Some(next) = (0..units.len()).find(|k| taken[*k] + 1 < curves[*k].len()) else {
            return best;
        };
        taken[next] += 1;
        taken[..next].fill(0);
    }
}

fn is_closed(units: &[Made], taken: &[usize]) -> bool {
    let level = |unit: usize| units[unit].steps.len() - taken[unit];
    (0..units.len()).all(|unit| {
        let all = units[unit].needed[level(unit)..].iter().flatten();
        all.into_iter()
            .all(|needed| level(needed.unit as usize) <= usize::from(needed.level))
    })
}

fn greedy(units: &[Made], budget: usize, misfit: Misfit) -> Plan {
    let rule = Rule {
        reach: Reach::Hull,
        misfit,
    };
    let mut catalog = build(units, rule);
    let plan = catalog.select(budget as u64);
    follow(&catalog, &plan.choices, budget as u64);
    plan
}

/// Instances without any order between bytes and value, in which hulls skip many levels: harder
/// than content, whose finer steps cost more and are worth less.
fn without_order(seed: u64, chain: Chain, most: u32) -> Vec<Made> {
    let mut random = Random::new(seed);
    (0..200)
        .map(|_| random_unit(&mut random, chain, most))
        .collect()
}

/// Instances like content: every finer step costs more and is mostly worth less.
fn like_content(seed: u64) -> Vec<Made> {
    let mut random = Random::new(seed);
    let unit = |random: &mut Random| {
        let (mut bytes, mut gain) = (1.0 + 7.0 * random.unit(), 10.0 * random.unit());
        let mut steps = Vec::new();
        for _ in 0..4 {
            let value = gain * (0.5 + random.unit());
            steps.insert(
                0,
                Step {
                    bytes: bytes as u32,
                    value,
                },
            );
            bytes *= 1.5 + random.unit();
            gain *= 0.8;
        }
        Made {
            chain: Chain::Refining,
            needed: vec![Vec::new(); 4],
            steps,
        }
    };
    (0..200).map(|_| unit(&mut random)).collect()
}

fn instances() -> Vec<Vec<Made>> {
    let mut all = Vec::new();
    for seed in 0..40 {
        all.push(like_content(seed));
        for chain in [Chain::Refining, Chain::Replacing] {
            all.push(without_order(seed, chain, 20));
            all.push(without_order(seed, chain, 100));
        }
    }
    all
}

fn largest_step(units: &[Made]) -> usize {
    let bytes = units
        .iter()
        .flat_map(|unit| &unit.steps)
        .map(|step| step.bytes);
    bytes.max().unwrap() as usize
}

#[test]
fn skipping_reaches_99_percent_of_the_optimum_from_ten_largest_steps_on() {
    for units in instances() {
        for times in [10, 25] {
            let budget = times * largest_step(&units);
            let (found, best) = (
                greedy(&units, budget, Misfit::Skip).value,
                exact(&units, budget),
            );
            assert!(found <= best * (1.0 + 1e-12));
            assert!(
                found >= 0.99 * best,
                "{found} of {best} with {budget} bytes"
            );
        }
    }
}

/// The greedy value with stops is that of the relaxed problem, in which steps may be divided, but
/// for the one step that did not fit.
#[test]
fn stopping_falls_short_of_the_optimum_by_less_than_the_step_that_did_not_fit() {
    for units in instances() {
        let ample = greedy(&units, usize::MAX / 2, Misfit::Stop);
        for times in [1, 3, 10] {
            let budget = times * largest_step(&units);
            let plan = greedy(&units, budget, Misfit::Stop);
            let best = exact(&units, budget);
            let taken = plan.choices.len();
            assert_eq!(plan.choices, ample.choices[..taken]);
            let misfit = ample.choices[taken];
            let share = (budget as u64 - plan.bytes) as f64 / misfit.bytes as f64;
            assert!((0.0..1.0).contains(&share));
            assert!(plan.value <= best * (1.0 + 1e-12));
            assert!(plan.value + share * misfit.value >= best * (1.0 - 1e-12));
        }
    }
}

#[test]
fn with_a_budget_for_all_the_greedy_is_exact() {
    for units in instances() {
        let all: usize = units.iter().flat_map(levels).map(|(bytes, _)| bytes).sum();
        let most: f64 = units
            .iter()
            .flat_map(|unit| &unit.steps)
            .map(|step| step.value)
            .sum();
        let found = greedy(&units, all, Misfit::Stop).value;
        assert!((found - most).abs() < 1e-9 * most);
    }
}

#[test]
fn small_graphs_of_prerequisites_come_within_five_percent_of_brute_force_on_average() {
    for (chain, budget) in [(Chain::Refining, 100), (Chain::Replacing, 45)] {
        let mut shares = Vec::new();
        for seed in 0..200 {
            let mut random = Random::new(seed);
            let mut units: Vec<Made> = (0..6)
                .map(|_| random_unit(&mut random, chain, 20))
                .collect();
            add_prerequisites(&mut random, &mut units, 0.4);
            let best = brute_force(&units, budget);
            let found = greedy(&units, budget, Misfit::Skip).value;
            assert!(found <= best * (1.0 + 1e-12));
            shares.push(found / best);
        }
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        let worst = shares.iter().copied().fold(1.0, f64::min);
        assert!(
            mean >= 0.95 && worst >= 0.6,
            "{chain:?}: mean {mean}, worst {worst}"
        );
    }
}

#[test]
fn a_worthless_prerequisite_is_paid_for_by_what_needs_it() {
    let unit = |bytes, value, needed: &[Rung]| Made {
        chain: Chain::Refining,
        steps: vec![Step { bytes, value }],
        needed: vec![needed.to_vec()],
    };
    let root = Rung { unit: 0, level: 0 };
    // 12 for 4 bytes together beats 2 a byte, and loses against 4 a byte.
    for (rival, order) in [(2.0, [0, 1, 2]), (4.0, [2, 0, 1])] {
        let units = [
            unit(3, -1.0, &[]),
            unit(1, 13.0, &[root]),
            unit(1, rival, &[]),
        ];
        let plan = greedy(&units, 5, Misfit::Stop);
        let chosen: Vec<u32> = plan.choices.iter().map(|choice| choice.unit).collect();
        assert_eq!(chosen, order);
        assert_eq!(brute_force(&units, 5), plan.value);
    }
    let dear = [unit(3, -20.0, &[]), unit(1, 13.0, &[root])];
    assert_eq!(greedy(&dear, 5, Misfit::Stop), Plan::default());
}
