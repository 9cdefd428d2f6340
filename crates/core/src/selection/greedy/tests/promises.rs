//! What holds for every catalog and budget, however odd?

use super::super::{Misfit, Plan, Reach, Rule};
use super::*;
use proptest::prelude::*;

const RULES: [Rule; 3] = [
    Rule {
        reach: Reach::Hull,
        misfit: Misfit::Stop,
    },
    Rule {
        reach: Reach::Hull,
        misfit: Misfit::Skip,
    },
    Rule::PAPER,
];

fn odd_value() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -5.0..20.0,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(f64::NEG_INFINITY),
        1 => Just(0.0),
        1 => Just(5e-324),
        1 => Just(f64::MAX),
    ]
}

fn odd_step() -> impl Strategy<Value = Step> {
    let bytes = prop_oneof![8 => 1u32..100, 1 => Just(0u32), 1 => Just(u32::MAX)];
    (bytes, odd_value()).prop_map(|(bytes, value)| Step { bytes, value })
}

/// Up to 30 units with odd steps and, where the seed has it so, prerequisites.
fn odd_units() -> impl Strategy<Value = Vec<Made>> {
    let chain = prop_oneof![Just(Chain::Refining), Just(Chain::Replacing)];
    let unit = (chain, proptest::collection::vec(odd_step(), 1..6)).prop_map(|(chain, steps)| {
        let needed = vec![Vec::new(); steps.len()];
        Made {
            chain,
            steps,
            needed,
        }
    });
    let units = proptest::collection::vec(unit, 1..30);
    (units, 0u64..1_000, 0.0..0.5f64).prop_map(|(mut units, seed, share)| {
        add_prerequisites(&mut Random::new(seed), &mut units, share);
        units
    })
}

/// No choice without value; with prerequisites, which may be worthless, not all of them in sum.
fn is_worth_its_bytes(choices: &[Choice], has_prerequisites: bool) -> bool {
    if !has_prerequisites {
        return choices.iter().all(|choice| choice.value > 0.0);
    }
    let sum: f64 = choices.iter().map(|choice| choice.value).sum();
    let rounding: f64 = choices
        .iter()
        .map(|choice| choice.value.abs() * 1e-12)
        .sum();
    sum >= -rounding
}

proptest! {
    #[test]
    fn a_plan_is_within_its_budget_in_order_and_worth_its_bytes(
        units in odd_units(), budget in prop_oneof![0u64..3_000, Just(u64::MAX)],
    ) {
        let is_graph = units.iter().any(|unit| unit.needed.iter().any(|all| !all.is_empty()));
        for rule in RULES {
            let mut catalog = build(&units, rule);
            let plan = catalog.select(budget);
            follow(&catalog, &plan.choices, budget);
            prop_assert!(is_worth_its_bytes(&plan.choices, is_graph));
            let bytes = plan.choices.iter().map(|choice| choice.bytes);
            prop_assert_eq!(plan.bytes, bytes.sum::<u64>());
            prop_assert!(plan.value.is_finite());
            let visible = |unit| unit % 3 > 0;
            let uniform: Plan = catalog.uniform(budget, rule.misfit, visible).collect();
            follow(&catalog, &uniform.choices, budget);
        }
    }

    #[test]
    fn a_smaller_budget_buys_the_beginning_of_what_a_larger_one_buys(
        units in odd_units(), budgets in (0u64..3_000, 0u64..3_000),
    ) {
        let mut catalog = build(&units, RULES[0]);
        let small = catalog.select(budgets.0.min(budgets.1));
        let large = catalog.select(budgets.0.max(budgets.1));
        prop_assert_eq!(&small.choices[..], &large.choices[..small.choices.len()]);
    }

    #[test]
    fn more_bytes_are_never_worth_less(
        seed in 0u64..10_000, budget in 0u64..2_000, more in 0u64..200,
    ) {
        let mut random = Random::new(seed);
        let chains = [Chain::Refining, Chain::Replacing];
        let units: Vec<Made> =
            (0..60).map(|k| random_unit(&mut random, chains[k % 2], 100)).collect();
        for rule in &RULES[..2] {
            let mut catalog = build(&units, *rule);
            let (less, more) = (catalog.select(budget), catalog.select(budget + more));
            prop_assert!(more.value >= less.value - 1e-9, "{rule:?}");
        }
    }

    #[test]
    fn the_order_of_the_units_does_not_matter(
        seed in 0u64..10_000, budget in 0u64..2_000, share in 0.0..0.5f64,
    ) {
        let mut random = Random::new(seed);
        let mut units: Vec<Made> =
            (0..40).map(|_| random_unit(&mut random, Chain::Refining, 100)).collect();
        add_prerequisites(&mut random, &mut units, share);
        let last = units.len() as u32 - 1;
        let mut turned: Vec<Made> = units.iter().rev().cloned().collect();
        for needed in turned.iter_mut().flat_map(|unit| &mut unit.needed).flatten() {
            needed.unit = last - needed.unit;
        }
        for rule in RULES {
            let (mut one, mut other) = (build(&units, rule), build(&turned, rule));
            let (one_plan, other_plan) = (one.select(budget), other.select(budget));
            let levels = follow(&one, &one_plan.choices, budget);
            let mut turned_levels = follow(&other, &other_plan.choices, budget);
            turned_levels.reverse();
            prop_assert_eq!(levels, turned_levels);
        }
    }

    #[test]
    fn what_is_cached_does_not_show(
        units in odd_units(),
        changes in proptest::collection::vec((0usize..30, odd_value(), 0u8..6), 0..20),
        budget in 0u64..3_000,
    ) {
        for rule in RULES {
            let mut kept = build(&units, rule);
            let mut units = units.clone();
            let mut held: Vec<u8> = units.iter().map(|unit| unit.steps.len() as u8).collect();
            for (number, value, level) in &changes {
                let number = number % units.len();
                kept.select(budget);
                units[number].steps.iter_mut().for_each(|step| step.value = *value);
                held[number] = (*level).min(units[number].steps.len() as u8);
                kept.set_values(number as u32, &vec![*value; units[number].steps.len()]);
                kept.set_level(number as u32, held[number]);
            }
            let mut fresh = build(&units, rule);
            (0..).zip(&held).for_each(|(unit, level)| fresh.set_level(unit, *level));
            prop_assert_eq!(kept.select(budget), fresh.select(budget));
        }
    }
}

#[test]
fn only_units_whose_values_changed_are_rebuilt() {
    let mut random = Random::new(1);
    let units: Vec<Made> = (0..100)
        .map(|_| random_unit(&mut random, Chain::Refining, 100))
        .collect();
    let mut catalog = build(&units, Rule::default());
    assert_eq!(catalog.refresh(), 100);
    let values = |made: &Made| {
        made.steps
            .iter()
            .map(|step| step.value)
            .collect::<Vec<f64>>()
    };
    catalog.set_values(3, &values(&units[3]));
    assert_eq!(catalog.refresh(), 0);
    catalog.set_values(3, &vec![7.0; units[3].steps.len()]);
    catalog.set_values(3, &vec![8.0; units[3].steps.len()]);
    catalog.set_level(4, 0);
    assert_eq!(catalog.refresh(), 2);
}

#[test]
fn a_cancelled_selection_is_the_beginning_of_a_whole_one() {
    let mut random = Random::new(2);
    let mut units: Vec<Made> = (0..300)
        .map(|_| random_unit(&mut random, Chain::Refining, 100))
        .collect();
    add_prerequisites(&mut random, &mut units, 0.3);
    let mut catalog = build(&units, Rule::default());
    let whole = catalog.select(5_000).choices;
    assert!(whole.len() > 20);
    let begun: Vec<Choice> = catalog.choices(5_000).take(13).collect();
    assert_eq!(begun, whole[..13]);
    follow(&catalog, &begun, 5_000);
}

#[test]
fn equals_go_to_fewer_bytes_and_then_to_the_lower_number() {
    let unit = |bytes: u32| Made {
        chain: Chain::Refining,
        steps: vec![Step {
            bytes,
            value: f64::from(bytes),
        }],
        needed: vec![Vec::new()],
    };
    let units = [unit(30), unit(10), unit(20), unit(10)];
    let plan = build(&units, Rule::default()).select(100);
    let order: Vec<u32> = plan.choices.iter().map(|choice| choice.unit).collect();
    assert_eq!(order, [1, 3, 2, 0]);
}

#[test]
fn uniform_raises_what_is_visible_evenly_whatever_it_is_worth() {
    let unit = |levels: usize| Made {
        chain: Chain::Refining,
        steps: vec![
            Step {
                bytes: 10,
                value: -1.0
            };
            levels
        ],
        needed: vec![Vec::new(); levels],
    };
    let mut units = vec![unit(3), unit(3), unit(2), unit(3)];
    units[3].needed[2].push(Rung { unit: 1, level: 1 });
    let catalog = build(&units, Rule::default());
    let plan: Plan = catalog
        .uniform(65, Misfit::Stop, |unit| unit != 1)
        .collect();
    let order: Vec<(u32, u8)> = plan
        .choices
        .iter()
        .map(|choice| (choice.unit, choice.level))
        .collect();
    assert_eq!(order, [(0, 2), (1, 1), (3, 2), (0, 1), (2, 1)]);
    assert_eq!(plan.bytes, 60);
    let levels = follow(&catalog, &plan.choices, 65);
    assert_eq!(levels, [1, 1, 1, 2]);
}

#[test]
fn eccentricity_is_the_same_order_over_acuity_plus_pedestal() {
    // One value for every level of a unit, as no content distinguishes them.
    let acuity_and_pedestal = [12.0, 30.0, 4.0];
    let units: Vec<Made> = acuity_and_pedestal
        .iter()
        .map(|value| Made {
            chain: Chain::Refining,
            steps: [48, 24, 12]
                .map(|bytes| Step {
                    bytes,
                    value: *value,
                })
                .to_vec(),
            needed: vec![Vec::new(); 3],
        })
        .collect();
    let plan = build(&units, Rule::default()).select(1_000);
    let order: Vec<(u32, u8)> = plan
        .choices
        .iter()
        .map(|choice| (choice.unit, choice.level))
        .collect();
    // 30/12, 30/24, 12/12, 30/48, 12/24, 4/12, 12/48, 4/24, 4/48.
    let expected = [
        (1, 2),
        (1, 1),
        (0, 2),
        (1, 0),
        (0, 1),
        (2, 2),
        (0, 0),
        (2, 1),
        (2, 0),
    ];
    assert_eq!(order, expected);
}
