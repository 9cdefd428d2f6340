//! What must come together with a step?

use super::catalog::Rung;
use super::plan::Choice;
use super::progress::Progress;
use std::collections::{BTreeMap, BTreeSet};

/// Steps that one offer may bring together. What needs more is offered once enough of it has come
/// for its own worth: so a deep catalog from outside costs a bounded time a step.
const MOST_TOGETHER: usize = 1024;

/// A stage with everything missing below it.
#[derive(Clone, Debug, Default)]
pub(super) struct Closure {
    /// Steps in an order in which each finds its prerequisites met.
    pub(super) steps: Vec<Choice>,
    /// Units whose level decides what belongs to it.
    pub(super) units: BTreeSet<u32>,
    /// Whether it is all there; else it was larger than may be offered.
    pub(super) is_whole: bool,
}

impl Closure {
    pub(super) fn bytes(&self) -> u64 {
        self.steps.iter().map(|step| step.bytes).sum()
    }

    pub(super) fn value(&self) -> f64 {
        self.steps.iter().map(|step| step.value).sum()
    }
}

/// Everything that is missing to reach a stage. Costs some 100 ns a step.
pub(super) fn closure(progress: &Progress<'_>, goal: Rung) -> Closure {
    let mut closure = Closure::default();
    let mut planned: BTreeMap<u32, u8> = BTreeMap::new();
    let mut looked_at = 0;
    // Depth first: a stage stays below what it needs until all of that is planned.
    let mut open = vec![(goal, false)];
    while let Some((stage, is_ready)) = open.pop() {
        let Rung { unit, level } = stage;
        let from = planned.get(&unit).copied().unwrap_or(progress.level(unit));
        if from <= level {
            continue;
        }
        if is_ready {
            planned.insert(unit, level);
            append(&mut closure.steps, progress, stage, from);
            continue;
        }
        looked_at += 1;
        if looked_at > MOST_TOGETHER {
            return closure;
        }
        closure.units.insert(unit);
        open.push((stage, true));
        let needed = progress.catalog.prerequisites(stage);
        open.extend(needed.iter().map(|needed| (*needed, false)));
        open.push((
            Rung {
                unit,
                level: level + 1,
            },
            false,
        ));
    }
    closure.is_whole = true;
    closure
}

/// Adds the step from a level to a stage; one with the step before where that is the same unit's.
fn append(steps: &mut Vec<Choice>, progress: &Progress<'_>, stage: Rung, from: u8) {
    let Rung { unit, level } = stage;
    let joined = steps.pop_if(|last| last.unit == unit);
    let from = joined.map_or(from, |last| last.from);
    let curve = progress.catalog.curve(unit);
    let segment = curve.segment(from, level);
    let (bytes, value) = (segment.bytes, segment.value);
    steps.push(Choice {
        unit,
        from,
        level,
        bytes,
        value,
    });
}

#[cfg(test)]
mod tests {
    use super::super::{CatalogBuilder, Chain, Rule, Step};
    use super::*;

    fn stage(unit: u32, level: u8) -> Rung {
        Rung { unit, level }
    }

    #[test]
    fn what_is_needed_twice_comes_once_and_first() {
        let mut builder = CatalogBuilder::default();
        for unit in 0..4 {
            let step = Step {
                bytes: 10 + unit,
                value: 1.0,
            };
            builder.add(Chain::Refining, &[step; 2]).unwrap();
        }
        builder.require(stage(0, 0), &[stage(1, 1), stage(2, 1)]);
        builder.require(stage(1, 1), &[stage(3, 0)]);
        builder.require(stage(2, 1), &[stage(3, 1)]);
        let catalog = builder.build(Rule::default()).unwrap();
        let progress = Progress::new(&catalog, 0);
        let closure = closure(&progress, stage(0, 0));
        let mut reached = vec![2u8; 4];
        for step in &closure.steps {
            for level in step.level..step.from {
                let needed = catalog.prerequisites(stage(step.unit, level));
                assert!(needed.iter().all(|n| reached[n.unit as usize] <= n.level));
            }
            assert_eq!(reached[step.unit as usize], step.from);
            reached[step.unit as usize] = step.level;
        }
        assert!(closure.is_whole);
        assert_eq!(reached, [0, 1, 1, 0]);
        assert_eq!((closure.bytes(), closure.value()), (20 + 11 + 12 + 26, 6.0));
        assert_eq!(closure.units.into_iter().collect::<Vec<_>>(), [0, 1, 2, 3]);
    }

    #[test]
    fn a_closure_of_a_hundred_thousand_steps_is_given_up() {
        let mut builder = CatalogBuilder::default();
        for unit in 0..100_000 {
            builder
                .add(
                    Chain::Refining,
                    &[Step {
                        bytes: 1,
                        value: 0.0,
                    }],
                )
                .unwrap();
            if unit > 0 {
                builder.require(stage(unit, 0), &[stage(unit - 1, 0)]);
            }
        }
        let catalog = builder.build(Rule::default()).unwrap();
        let progress = Progress::new(&catalog, 0);
        let deep = closure(&progress, stage(99_999, 0));
        assert!(!deep.is_whole && deep.units.len() == MOST_TOGETHER);
        assert!(closure(&progress, stage(1023, 0)).is_whole);
    }
}
