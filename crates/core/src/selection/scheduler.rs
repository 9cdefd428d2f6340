//! Which units does a viewer get, of all assets together and within one budget?
//!
//! Steps are taken by value per byte ([`super::greedy`]). What is bought and not shown in the end
//! is not bought, and what that saves is spent again.

#[cfg(test)]
mod tests;
#[cfg(test)]
mod view_tests;

use super::greedy::{Catalog, CatalogBuilder, Chain, Misfit, Rule, Rung, Step};
use crate::content::demand::{Chosen, Demand};
use crate::content::policy::{Policy, PolicyConfig};
use crate::perception::footprints::Measured;
use crate::perception::moment::Moment;
use crate::perception::parameters::Model;

/// Rounds in which what was saved is spent again.
const ROUNDS: u32 = 3;

/// Chooses units moment after moment under one policy, whichever it is.
#[derive(Debug)]
pub struct Scheduler {
    policy: Policy,
    demands: Vec<Box<dyn Demand>>,
    /// The steps of all demands, one after the other.
    catalog: Catalog,
    /// Number of the first step of each demand, and of all steps.
    first: Vec<u32>,
    /// Bytes that the last moment took.
    spent: u64,
}

impl Scheduler {
    /// Chooses for these demands, each of one asset of a scene, under the policy that they were
    /// made for.
    #[must_use]
    pub fn new(config: &PolicyConfig, demands: Vec<Box<dyn Demand>>) -> Self {
        let (catalog, first) = catalog_of(config, &demands);
        Self {
            policy: config.policy,
            demands,
            catalog,
            first,
            spent: 0,
        }
    }

    /// Bytes that the last moment took of the budget.
    #[must_use]
    pub fn spent(&self) -> u64 {
        self.spent
    }

    /// Whether what was bought last reaches the score that is asked for, so that more bytes would
    /// buy nothing.
    #[must_use]
    pub fn has_reached(&self) -> bool {
        self.demands.iter().all(|demand| demand.has_reached())
    }

    /// The lowest score that is expected of any asset, as [`Demand::expected_jod`] gives it.
    #[must_use]
    pub fn expected_jod(&self) -> Option<f64> {
        let jods = self
            .demands
            .iter()
            .filter_map(|demand| demand.expected_jod());
        jods.reduce(f64::min)
    }

    /// From now on this is known of the units of an asset by what was drawn.
    ///
    /// # Panics
    /// There must be such an asset.
    pub fn see(&mut self, asset: usize, measured: &Measured) {
        self.demands[asset].see(measured);
    }

    /// What to show of every asset, of the frame of each. `budget` is what can arrive for it, in
    /// bytes; `None` without limit.
    ///
    /// # Panics
    /// There must be a frame for every asset.
    pub fn choose(&mut self, frames: &[u32], moment: &Moment, budget: Option<u64>) -> Vec<Chosen> {
        assert_eq!(frames.len(), self.demands.len(), "a frame for every asset");
        self.spent = 0;
        let buys: Vec<bool> = self.demands.iter().map(|d| d.buys(budget)).collect();
        let each = |demands: &mut [Box<dyn Demand>], act: &mut dyn FnMut(&mut dyn Demand, u32)| {
            let buyers = demands.iter_mut().zip(frames).zip(&buys);
            let buyers = buyers.filter(|(_, buys)| **buys);
            buyers.for_each(|((demand, frame), _)| act(&mut **demand, *frame));
        };
        each(&mut self.demands, &mut |demand, frame| {
            demand.begin(frame, moment, budget);
        });
        for _ in 0..if buys.contains(&true) { ROUNDS } else { 0 } {
            let left = budget.map_or(u64::MAX, |budget| budget.saturating_sub(self.spent));
            let bought = self.buy(&buys, left);
            if bought == 0 {
                break;
            }
            self.spent += bought;
        }
        let chosen = self.demands.iter_mut().zip(frames).zip(buys);
        chosen
            .map(|((demand, frame), buys)| match buys {
                true => demand.bought(),
                false => demand.needed(*frame, moment),
            })
            .collect()
    }

    /// Buys for at most `budget` bytes and returns the bytes spent.
    fn buy(&mut self, buys: &[bool], budget: u64) -> u64 {
        let mut is_worth_it = vec![false; self.catalog.units() as usize];
        for (number, demand) in self.demands.iter_mut().enumerate() {
            if !buys[number] {
                continue;
            }
            for (at, offer) in (self.first[number]..).zip(demand.offers()) {
                is_worth_it[at as usize] = offer.value > 0.0;
                self.catalog.set_level(at, u8::from(!offer.is_held));
                self.catalog.set_bytes(at, &[offer.bytes]);
                self.catalog.set_values(at, &[offer.value]);
            }
        }
        let chosen = self.chosen(&is_worth_it, budget);
        let mut bytes = 0;
        for (number, demand) in self.demands.iter_mut().enumerate() {
            let own = self.first[number]..self.first[number + 1];
            let steps = chosen.iter().filter(|step| own.contains(step));
            let steps: Vec<u32> = steps.map(|step| step - own.start).collect();
            if buys[number] {
                bytes += demand.buy(&steps);
            }
        }
        bytes
    }

    /// The steps to buy, in the order in which they are worth their bytes.
    fn chosen(&mut self, is_worth_it: &[bool], budget: u64) -> Vec<u32> {
        let (first, demands) = (&self.first, &mut self.demands);
        let mut is_missed = |step: &u32| {
            let number = first.partition_point(|first| first <= step) - 1;
            demands[number].is_missed(step - first[number])
        };
        if self.policy == Policy::Uniform {
            let is_visible = |step: u32| is_worth_it[step as usize];
            let choices = self.catalog.uniform(budget, Misfit::Stop, is_visible);
            let steps = choices.map(|choice| choice.unit);
            return steps.filter(|step| is_missed(step)).collect();
        }
        let choices = self.catalog.choices(budget);
        let steps = choices.map(|choice| choice.unit);
        steps.filter(|step| is_missed(step)).collect()
    }
}

/// All steps of all demands, and where those of each begin.
fn catalog_of(config: &PolicyConfig, demands: &[Box<dyn Demand>]) -> (Catalog, Vec<u32>) {
    let unknown = Step {
        bytes: 0,
        value: 0.0,
    };
    let mut builder = CatalogBuilder::default();
    let mut first = vec![0];
    let mut next = 0;
    for demand in demands {
        let begin = next;
        for needs in demand.steps() {
            let rung = |step: u32| Rung {
                unit: step,
                level: 0,
            };
            let needs: Vec<Rung> = needs.into_iter().map(|need| rung(begin + need)).collect();
            if builder.add(Chain::Refining, &[unknown]).is_ok() && !needs.is_empty() {
                builder.require(rung(next), &needs);
            }
            next += 1;
        }
        first.push(next);
    }
    let rule = Rule {
        misfit: misfit_of(config),
        ..Rule::default()
    };
    match builder.build(rule) {
        Ok(catalog) => (catalog, first),
        Err(error) => panic!("steps that need each other in a circle: {error}"),
    }
}

/// What happens when the best step does not fit into what a frame may spend: the corrected greedy
/// stops and saves up for it, as what is left counts for the next frame; the published one (Chen et
/// al. 2022) goes on with the next and so spends what it would need
/// (docs/decisions/0004-what-does-not-fit-is-skipped.md).
fn misfit_of(config: &PolicyConfig) -> Misfit {
    match config.perception.model {
        Model::Paper => Misfit::Skip,
        Model::Default => Misfit::Stop,
    }
}
