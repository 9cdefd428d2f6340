//! Which units of a scene does one viewer want?

use super::Scene;
use super::sight::{SeenError, Sight};
use crate::content::demand::{Chosen, Content, Demand, Offer, Record};
use crate::content::policy::{Policy, PolicyConfig};
use crate::pack::sha256_hex;
use crate::pack::unit::UnitId;
use crate::perception::acuity::AcuityModel;
use crate::perception::moment::Moment;
use std::sync::Arc;

/// Errors that cover less of the display, in pixels, are not seen.
const ERROR_PIXELS: f64 = 1.0;
/// Triangles with shorter sides on the display, in pixels, are not told apart from finer ones.
const SIDE_PIXELS: f64 = 0.25;

/// Why scenes are not chosen by a policy; `None` of those that they are chosen by.
///
/// ```
/// use foveal_core::content::policy::Policy;
/// use foveal_core::content::scene::demand::why_not;
/// assert_eq!(why_not(Policy::Acuity), None);
/// assert!(why_not(Policy::Grid).is_some());
/// ```
#[must_use]
pub const fn why_not(policy: Policy) -> Option<&'static str> {
    match policy {
        Policy::Full
        | Policy::Coarsest
        | Policy::Viewport
        | Policy::Acuity
        | Policy::Uniform
        | Policy::Eccentricity => None,
        Policy::Perceptual => {
            Some("what a step of a scene adds has not been measured in packs yet")
        }
        Policy::Grid | Policy::Distance | Policy::Sampled => {
            Some("it chooses tiles of a picture, and a scene has none")
        }
    }
}

/// What one viewer wants of a scene under one policy, and what it bought.
#[derive(Debug)]
pub struct SceneDemand {
    scene: Arc<Scene>,
    config: PolicyConfig,
    /// Number of roots: the first units, which are always wanted.
    roots: u32,
    /// What was bought, by unit.
    held: Vec<bool>,
    /// What each unit is worth at the moment that is bought for.
    values: Vec<f64>,
}

impl SceneDemand {
    /// What is wanted of a scene under a policy that [`why_not`] says nothing against.
    #[must_use]
    pub fn new(scene: Arc<Scene>, config: &PolicyConfig) -> Self {
        let units = scene.pack().len();
        Self {
            roots: scene.base(0).len() as u32,
            held: vec![false; units],
            values: vec![0.0; units],
            // No unit tells its texture: acuity at a slope that keeps the score for any.
            config: match config.policy {
                Policy::Acuity => config.without_signatures(),
                _ => config.clone(),
            },
            scene,
        }
    }

    fn sights(&self, moment: &Moment) -> Vec<Sight> {
        let sight = |glance| Sight::new(&glance, self.config.margin);
        moment.glances().map(sight).collect()
    }

    /// The largest of what `of` says of a unit as it is seen, over its places and all views.
    fn most(&self, unit: UnitId, sights: &[Sight], of: impl Fn(&SeenError) -> f64) -> f64 {
        let spends = self.config.policy.spends_a_budget();
        let stands = self.scene.stands(unit).iter();
        let seen = stands.flat_map(|stand| {
            // What a rule leaves coarse has too small an error; what is bought ends where triangles
            // cannot be told apart, by their shading either.
            let error = match spends {
                true => stand.error.max(stand.side * ERROR_PIXELS / SIDE_PIXELS),
                false => stand.error,
            };
            let seen = move |sight: &Sight| sight.seen(&stand.sphere, error);
            sights.iter().filter_map(seen)
        });
        seen.map(|seen| of(&seen)).fold(0.0, f64::max)
    }

    /// How much larger the error is that is shown without a unit than the policy allows.
    fn excess(&self, seen: &SeenError) -> f64 {
        let pixels = seen.error_pixels / ERROR_PIXELS;
        match self.config.policy {
            Policy::Acuity => {
                let allowed = smallest_angle_deg(&self.config.acuity, seen);
                pixels.min(seen.error.to_degrees() / allowed)
            }
            _ => pixels,
        }
    }

    /// What a unit is worth to a viewer who sees it so, per policy that spends a budget.
    fn value(&self, seen: &SeenError) -> f64 {
        if seen.error_pixels < ERROR_PIXELS {
            return 0.0;
        }
        match self.config.policy {
            Policy::Eccentricity => {
                let parameters = &self.config.perception;
                let acuity = parameters.acuity_model().best_acuity(seen.eccentricity);
                (acuity.0 + parameters.pedestal) * seen.area_deg2
            }
            _ => seen.area_deg2,
        }
    }

    /// Which units a rule wants, with all that these need.
    fn wanted(&self, moment: &Moment) -> Vec<bool> {
        let units = self.scene.pack().len();
        let sights = self.sights(moment);
        let mut wanted = vec![false; units];
        for unit in (0..units as u32).rev().map(UnitId) {
            let is_wanted = unit.0 < self.roots
                || match self.config.policy {
                    Policy::Full => true,
                    Policy::Coarsest => false,
                    _ => self.most(unit, &sights, |seen| self.excess(seen)) > 1.0,
                };
            if is_wanted || wanted[unit.0 as usize] {
                wanted[unit.0 as usize] = true;
                let needs = self.scene.needs(unit).iter();
                needs.for_each(|need| wanted[need.0 as usize] = true);
            }
        }
        wanted
    }

    fn chosen(&self, is_chosen: &[bool]) -> Chosen {
        let units = (0..).map(UnitId).zip(is_chosen);
        let units: Vec<UnitId> = units.filter(|(_, is)| **is).map(|(unit, _)| unit).collect();
        let pack = self.scene.pack();
        let mut per_level = vec![0; usize::from(pack.coarsest()) + 1];
        for unit in &units {
            per_level[usize::from(pack.level_of(*unit))] += 1;
        }
        let samples = units.iter().map(|it| u64::from(pack.row(*it).triangles));
        let places: Vec<u8> = units.iter().flat_map(|it| it.0.to_le_bytes()).collect();
        let record = Record {
            per_level,
            samples: samples.sum(),
            sha256: sha256_hex(&places),
        };
        Chosen { units, record }
    }
}

/// The smallest angle that is told apart where a unit is seen best, in degrees.
fn smallest_angle_deg(acuity: &AcuityModel, seen: &SeenError) -> f64 {
    0.5 / acuity.best_acuity(seen.eccentricity).0
}

impl Demand for SceneDemand {
    fn needed(&mut self, _frame: u32, moment: &Moment) -> Chosen {
        self.chosen(&self.wanted(moment))
    }

    fn buys(&self, _budget: Option<u64>) -> bool {
        self.config.policy.spends_a_budget()
    }

    fn steps(&self) -> Vec<Vec<u32>> {
        if !self.config.policy.spends_a_budget() {
            return Vec::new();
        }
        // Unit n is step n less the roots, which are never bought.
        let pack = self.scene.pack();
        let finer = pack.units().skip(self.roots as usize);
        let needs = |unit| {
            let needs = self.scene.needs(unit).iter();
            needs
                .filter_map(|need| need.0.checked_sub(self.roots))
                .collect()
        };
        finer.map(needs).collect()
    }

    fn begin(&mut self, _frame: u32, moment: &Moment, _budget: Option<u64>) {
        let sights = self.sights(moment);
        for unit in self.roots..self.values.len() as u32 {
            let value = self.most(UnitId(unit), &sights, |seen| self.value(seen));
            self.values[unit as usize] = value;
        }
    }

    fn offers(&mut self) -> Vec<Offer> {
        let finer = self.roots as usize..self.held.len();
        let offer = |unit: usize| Offer {
            is_held: self.held[unit],
            bytes: self.scene.pack().entry(UnitId(unit as u32)).bytes,
            value: self.values[unit],
        };
        finer.map(offer).collect()
    }

    fn buy(&mut self, steps: &[u32]) -> u64 {
        let mut bytes = 0;
        for step in steps {
            let unit = step + self.roots;
            if !std::mem::replace(&mut self.held[unit as usize], true) {
                bytes += u64::from(self.scene.pack().entry(UnitId(unit)).bytes);
            }
        }
        bytes
    }

    fn bought(&mut self) -> Chosen {
        let roots = self.roots as usize;
        let is_chosen: Vec<bool> = (0..)
            .zip(&self.held)
            .map(|(n, is)| *is || n < roots)
            .collect();
        self.chosen(&is_chosen)
    }
}
