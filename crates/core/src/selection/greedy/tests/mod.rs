//! Is a selection as good as an exact one, and does it keep its promises?

mod optimum;
mod paper;
mod promises;

use super::{Catalog, CatalogBuilder, Chain, Choice, Rule, Rung, Step};
use crate::view::random::Random;

/// A unit of a test: its chain, its steps finest first, and what each needs.
#[derive(Clone, Debug)]
struct Made {
    chain: Chain,
    steps: Vec<Step>,
    needed: Vec<Vec<Rung>>,
}

fn build(units: &[Made], rule: Rule) -> Catalog {
    let mut builder = CatalogBuilder::default();
    for unit in units {
        builder.add(unit.chain, &unit.steps).unwrap();
    }
    for (number, unit) in (0..).zip(units) {
        for (level, needed) in (0..).zip(&unit.needed) {
            let stage = Rung {
                unit: number,
                level,
            };
            builder.require(stage, needed);
        }
    }
    builder.build(rule).unwrap()
}

fn whole(random: &mut Random, below: u32) -> u32 {
    (random.unit() * f64::from(below)) as u32
}

/// A chain of up to four steps: bytes up to `most`, values without order.
fn random_unit(random: &mut Random, chain: Chain, most: u32) -> Made {
    let steps: Vec<Step> = (0..1 + whole(random, 4))
        .map(|_| Step {
            bytes: 1 + whole(random, most),
            value: 10.0 * random.unit(),
        })
        .collect();
    let needed = vec![Vec::new(); steps.len()];
    Made {
        chain,
        steps,
        needed,
    }
}

/// Adds up to four prerequisites to some steps; only on units before, so there is no cycle.
fn add_prerequisites(random: &mut Random, units: &mut [Made], share: f64) {
    for number in 1..units.len() {
        for level in 0..units[number].steps.len() {
            while random.unit() < share && units[number].needed[level].len() < 4 {
                let unit = whole(random, number as u32);
                let other = units[unit as usize].steps.len() as u32;
                let needed = Rung {
                    unit,
                    level: whole(random, other) as u8,
                };
                units[number].needed[level].push(needed);
            }
        }
    }
}

/// Goes through the choices as a client would and fails where one breaks a promise.
fn follow(catalog: &Catalog, choices: &[Choice], budget: u64) -> Vec<u8> {
    let mut reached: Vec<u8> = (0..catalog.units())
        .map(|unit| catalog.level(unit))
        .collect();
    let mut spent = 0;
    for choice in choices {
        let unit = choice.unit;
        assert_eq!(reached[unit as usize], choice.from);
        assert!(choice.level < choice.from);
        for level in choice.level..choice.from {
            let needed = catalog.prerequisites(Rung { unit, level });
            assert!(
                needed
                    .iter()
                    .all(|needed| reached[needed.unit as usize] <= needed.level)
            );
        }
        reached[unit as usize] = choice.level;
        spent += choice.bytes;
        assert!(spent <= budget);
    }
    reached
}
