//! Which catalogs are sound?

use super::catalog::{Catalog, Rung, Step, counted};
use super::rule::{Chain, Rule};
use thiserror::Error;

/// Steps that a unit may have: levels are counted in a byte.
const MOST_STEPS: usize = 255;
/// Stages that a step may need.
const MOST_PREREQUISITES: usize = 16;
/// Units and steps of a catalog: both are counted in 32 bits.
const MOST_IN_ALL: usize = u32::MAX as usize;

/// Why a catalog cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CatalogError {
    /// A chain of levels that is too long.
    #[error("unit {unit} has {found} steps, at most {MOST_STEPS}: leave out levels")]
    TooManySteps {
        /// The unit's number.
        unit: u32,
        /// Its steps.
        found: usize,
    },
    /// More units or steps than can be counted.
    #[error("more than {MOST_IN_ALL} units or steps: divide the content into several catalogs")]
    TooMany,
    /// A prerequisite of, or on, a level that does not exist.
    #[error(
        "unit {unit}, level {level}: needs level {} of unit {}: {what}, correct the prerequisite",
        .needed.level, .needed.unit
    )]
    NoSuchStage {
        /// The unit that has the prerequisite.
        unit: u32,
        /// Its level that has the prerequisite.
        level: u8,
        /// What it is said to need.
        needed: Rung,
        /// Which of the two does not exist.
        what: &'static str,
    },
    /// More prerequisites than a step may have.
    #[error(
        "unit {unit}, level {level}: {found} prerequisites, at most {MOST_PREREQUISITES}: \
         keep the nearest"
    )]
    TooManyPrerequisites {
        /// The unit's number.
        unit: u32,
        /// The level that has them.
        level: u8,
        /// How many it has.
        found: usize,
    },
    /// A step that needs itself.
    #[error("unit {unit}, level {level}: needs itself in a cycle of prerequisites: break it")]
    Cycle {
        /// A unit on the cycle.
        unit: u32,
        /// Its level on the cycle.
        level: u8,
    },
}

/// Collects units, then makes a [`Catalog`] of them.
#[derive(Clone, Debug, Default)]
pub struct CatalogBuilder {
    chain: Vec<Chain>,
    count: Vec<u8>,
    steps: Vec<Step>,
    /// What needs what, in the order given.
    needs: Vec<(Rung, Rung)>,
}

impl CatalogBuilder {
    /// Adds a unit and returns its number; numbers count from 0. Its steps come finest first:
    /// `steps[l]` leads to level `l` from level `l + 1`. The coarsest level, which no step leads
    /// to, is held from the start.
    ///
    /// # Errors
    /// Too many units, or steps.
    pub fn add(&mut self, chain: Chain, steps: &[Step]) -> Result<u32, CatalogError> {
        let number = self.chain.len();
        if number >= MOST_IN_ALL || self.steps.len() + steps.len() > MOST_IN_ALL {
            return Err(CatalogError::TooMany);
        }
        let unit = number as u32;
        let found = steps.len();
        let count = u8::try_from(found).map_err(|_| CatalogError::TooManySteps { unit, found })?;
        self.chain.push(chain);
        self.count.push(count);
        self.steps.extend_from_slice(steps);
        Ok(unit)
    }

    /// Says what a unit's step to a level needs besides the coarser levels of the same unit; 16
    /// stages at most, of units that may be added later. What a whole unit needs, its coarsest step
    /// needs. Whether it makes sense, [`Self::build`] checks.
    pub fn require(&mut self, stage: Rung, needed: &[Rung]) {
        self.needs
            .extend(needed.iter().map(|needed| (stage, *needed)));
    }

    /// The catalog, with nothing but coarsest levels held. Costs 30 ns a step.
    ///
    /// # Errors
    /// A prerequisite that does not exist, more of them than 16, or a cycle.
    pub fn build(mut self, rule: Rule) -> Result<Catalog, CatalogError> {
        // Stable: the order in which a step's prerequisites were given stays.
        self.needs.sort_by_key(|(stage, _)| *stage);
        self.check_stages()?;
        let units = self.chain.len();
        let mut first = Vec::with_capacity(units + 1);
        first.push(0);
        let ends = self.count.iter().scan(0u32, |end, count| {
            *end += u32::from(*count);
            Some(*end)
        });
        first.extend(ends);
        let (first_needed, needed) = self.needed(&first);
        let is_cheap = self.chain.contains(&Chain::Replacing);
        let least = self.steps.iter().map(|step| step.bytes).min();
        let catalog = Catalog {
            rule,
            first,
            chain: self.chain,
            held: self.count,
            bytes: self.steps.iter().map(|step| step.bytes).collect(),
            value: self.steps.iter().map(|step| counted(step.value)).collect(),
            first_needed,
            needed,
            // Where levels replace each other a step costs a difference, however small.
            least_bytes: least.filter(|_| !is_cheap).unwrap_or(0),
            density: vec![0.0; units],
            is_stale: vec![true; units],
            stale: (0..units as u32).collect(),
        };
        check_cycles(&catalog)?;
        Ok(catalog)
    }

    fn check_stages(&self) -> Result<(), CatalogError> {
        for of_step in self.needs.chunk_by(|a, b| a.0 == b.0) {
            let Rung { unit, level } = of_step[0].0;
            let needed = of_step[0].1;
            let fault = |needed, what| CatalogError::NoSuchStage {
                unit,
                level,
                needed,
                what,
            };
            if self
                .count
                .get(unit as usize)
                .is_none_or(|count| level >= *count)
            {
                return Err(fault(needed, "no step leads to the level that needs it"));
            }
            let found = of_step.len();
            if found > MOST_PREREQUISITES {
                return Err(CatalogError::TooManyPrerequisites { unit, level, found });
            }
            for (_, needed) in of_step {
                match self.count.get(needed.unit as usize) {
                    None => return Err(fault(*needed, "there is no such unit")),
                    Some(count) if needed.level > *count => {
                        return Err(fault(*needed, "it has no such level"));
                    }
                    Some(_) => {}
                }
            }
        }
        Ok(())
    }

    /// Prerequisites by step: where those of each begin, and all of them.
    fn needed(&self, first: &[u32]) -> (Vec<u32>, Vec<Rung>) {
        if self.needs.is_empty() {
            return Default::default();
        }
        let mut starts = vec![0u32; self.steps.len() + 1];
        for (stage, _) in &self.needs {
            starts[(first[stage.unit as usize] + u32::from(stage.level)) as usize + 1] += 1;
        }
        for step in 0..self.steps.len() {
            starts[step + 1] += starts[step];
        }
        (
            starts,
            self.needs.iter().map(|(_, needed)| *needed).collect(),
        )
    }
}

/// How far the search for cycles has got with a step.
#[derive(Clone, Copy, PartialEq)]
enum Seen {
    Never,
    OnTheWay,
    Done,
}

/// Depth first along what steps need: meeting a step that is on the way means a cycle.
fn check_cycles(catalog: &Catalog) -> Result<(), CatalogError> {
    if catalog.needed.is_empty() {
        return Ok(());
    }
    let mut seen = vec![Seen::Never; catalog.bytes.len()];
    for unit in 0..catalog.units() {
        for level in (0..catalog.coarsest(unit)).rev() {
            follow(catalog, Rung { unit, level }, &mut seen)?;
        }
    }
    Ok(())
}

fn follow(catalog: &Catalog, start: Rung, seen: &mut [Seen]) -> Result<(), CatalogError> {
    let place = |stage: Rung| catalog.steps(stage.unit).start + usize::from(stage.level);
    let mut way = vec![(start, 0)];
    while let Some((stage, next)) = way.pop() {
        if next == 0 && seen[place(stage)] == Seen::Done {
            continue;
        }
        if next == 0 && seen[place(stage)] == Seen::OnTheWay {
            let Rung { unit, level } = stage;
            return Err(CatalogError::Cycle { unit, level });
        }
        seen[place(stage)] = Seen::OnTheWay;
        match requirement(catalog, stage, next) {
            None => seen[place(stage)] = Seen::Done,
            Some(needed) => {
                way.push((stage, next + 1));
                if needed.level < catalog.coarsest(needed.unit) {
                    way.push((needed, 0));
                }
            }
        }
    }
    Ok(())
}

/// What a step needs, counted from 0: first the next coarser level of its unit.
fn requirement(catalog: &Catalog, stage: Rung, number: usize) -> Option<Rung> {
    if number == 0 {
        let level = stage.level + 1;
        return Some(Rung { level, ..stage });
    }
    catalog.prerequisites(stage).get(number - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(unit: u32, level: u8) -> Rung {
        Rung { unit, level }
    }

    /// Three units of two steps, and what they need of each other.
    fn built(needs: &[(Rung, Rung)]) -> Result<Catalog, CatalogError> {
        let mut builder = CatalogBuilder::default();
        for _ in 0..3 {
            let step = Step {
                bytes: 1,
                value: 1.0,
            };
            builder.add(Chain::Refining, &[step; 2]).unwrap();
        }
        needs
            .iter()
            .for_each(|(stage, needed)| builder.require(*stage, &[*needed]));
        builder.build(Rule::default())
    }

    #[test]
    fn a_cycle_is_refused_with_a_unit_on_it() {
        let ring = [
            (stage(0, 0), stage(1, 0)),
            (stage(1, 1), stage(2, 1)),
            (stage(2, 1), stage(1, 0)),
        ];
        let error = built(&ring).unwrap_err();
        assert!(
            matches!(error, CatalogError::Cycle { unit: 1 | 2, .. }),
            "{error}"
        );
        assert!(error.to_string().contains("needs itself in a cycle"));
        assert!(built(&ring[..2]).is_ok());
        let itself = built(&[(stage(2, 1), stage(2, 0))]).unwrap_err();
        assert!(
            matches!(itself, CatalogError::Cycle { unit: 2, .. }),
            "{itself}"
        );
    }

    #[test]
    fn units_may_need_each_other_level_by_level() {
        let ladder = [
            (stage(0, 0), stage(1, 1)),
            (stage(1, 1), stage(0, 1)),
            (stage(1, 0), stage(0, 0)),
            (stage(2, 0), stage(2, 1)),
            (stage(2, 1), stage(1, 2)),
        ];
        assert!(built(&ladder).is_ok());
    }

    #[test]
    fn a_prerequisite_that_does_not_exist_is_refused_with_its_place() {
        let message = |of, needed| built(&[(of, needed)]).unwrap_err().to_string();
        let text = message(stage(0, 1), stage(9, 0));
        assert!(text.starts_with("unit 0, level 1: needs level 0 of unit 9: there is no such"));
        assert!(message(stage(0, 1), stage(1, 3)).contains("it has no such level"));
        assert!(message(stage(0, 2), stage(1, 0)).contains("no step leads to the level"));
        assert!(message(stage(7, 0), stage(1, 0)).contains("no step leads to the level"));
    }

    #[test]
    fn seventeen_prerequisites_and_256_steps_are_refused() {
        let seventeen = [(stage(0, 1), stage(1, 1)); 17];
        let error = built(&seventeen).unwrap_err();
        let expected = CatalogError::TooManyPrerequisites {
            unit: 0,
            level: 1,
            found: 17,
        };
        assert_eq!(error, expected);
        let step = Step {
            bytes: 1,
            value: 1.0,
        };
        let long = CatalogBuilder::default().add(Chain::Refining, &[step; 256]);
        assert_eq!(
            long,
            Err(CatalogError::TooManySteps {
                unit: 0,
                found: 256
            })
        );
    }
}
