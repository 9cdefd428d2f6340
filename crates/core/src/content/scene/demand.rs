//! Which units of a scene does one viewer want?

mod error_bounds;

use super::Scene;
use super::scene::Stand;
use super::sight::{SeenError, ViewOfScene};
use super::worth::SceneWorth;
use crate::content::demand::{Chosen, Content, Demand, Offer, Record};
use crate::content::policy::{Policy, PolicyConfig};
use crate::pack::sha256_hex;
use crate::pack::unit::UnitId;
use crate::perception::acuity::AcuityModel;
use crate::perception::footprints::Measured;
use crate::perception::moment::Moment;
use crate::units::Radians;
use error_bounds::{ErrorBounds, RoughError, is_above_one};
use std::sync::Arc;

/// Errors that cover less of the display, in pixels, are not seen.
const ERROR_PIXELS: f64 = 1.0;
/// Triangles with shorter sides on the display, in pixels, are not distinguished from finer ones.
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
        | Policy::Eccentricity
        | Policy::Perceptual => None,
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
    worth: SceneWorth,
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
            worth: SceneWorth::new(&scene, &config.perception),
            // The texture of units is unknown: acuity at a slope that keeps the score for any.
            config: match config.policy {
                Policy::Acuity => config.without_signatures(),
                _ => config.clone(),
            },
            scene,
        }
    }

    fn sights(&self, moment: &Moment) -> Vec<ViewOfScene> {
        let sight = |glance| ViewOfScene::new(&glance, self.config.margin);
        moment.glances().map(sight).collect()
    }

    /// The largest of what `of` says of a unit as it is seen, over its places and all views.
    fn most(&self, unit: UnitId, sights: &[ViewOfScene], of: impl Fn(&SeenError) -> f64) -> f64 {
        let spends = self.config.policy.spends_a_budget();
        let stands = self.scene.stands(unit).iter();
        let seen = stands.flat_map(|stand| {
            // What a rule leaves coarse has too small an error; what is bought ends where triangles
            // cannot be distinguished, not even by their shading.
            let error = match spends {
                true => stand.error.max(stand.side * ERROR_PIXELS / SIDE_PIXELS),
                false => stand.error,
            };
            let seen = move |sight: &ViewOfScene| sight.seen(&stand.sphere, error);
            sights.iter().filter_map(seen)
        });
        seen.map(|seen| of(&seen)).fold(0.0, f64::max)
    }

    /// How much larger the error is that is shown without a unit than the policy allows.
    fn excess(&self, seen: &SeenError) -> f64 {
        match self.config.policy {
            Policy::Acuity => acuity_excess(seen, &self.config.acuity),
            _ => seen.error_pixels / ERROR_PIXELS,
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
        let sights = self.sights(moment);
        self.closed(|unit| match self.config.policy {
            Policy::Full => true,
            Policy::Coarsest => false,
            _ => {
                let stands = self.scene.stands(unit);
                sights
                    .iter()
                    .any(|sight| stands.iter().any(|stand| self.exceeds(stand, sight)))
            }
        })
    }

    /// The roots, what is `wanted` by itself, and all that these need. What something else needs
    /// is not asked for.
    fn closed(&self, wanted_itself: impl Fn(UnitId) -> bool) -> Vec<bool> {
        let pack = self.scene.pack();
        let units = pack.len();
        let mut wanted = vec![false; units];
        wanted[..self.roots as usize].fill(true);
        for unit in (self.roots as usize..units).rev() {
            let is_wanted = wanted[unit] || wanted_itself(UnitId(unit as u32));
            if is_wanted {
                wanted[unit] = true;
                let needs = pack.rows()[unit].needs.iter();
                needs.for_each(|need| wanted[need.0 as usize] = true);
            }
        }
        wanted
    }

    /// Whether the error that is shown without a unit in one of its places is larger than the
    /// policy allows: [`Self::excess`] above 1, mostly without working it out.
    fn exceeds(&self, stand: &Stand, sight: &ViewOfScene) -> bool {
        let Stand { sphere, error, .. } = stand;
        if sight.is_surely_within(sphere, *error, ERROR_PIXELS) {
            return false;
        }
        let sure = match sight.look(sphere, *error) {
            ErrorBounds::Missed => return false,
            ErrorBounds::Seen(rough) => self.rough_excess(&rough, sight).and_then(is_above_one),
            ErrorBounds::Unsure => None,
        };
        sure.unwrap_or_else(|| {
            let seen = sight.seen(sphere, *error);
            seen.is_some_and(|seen| self.excess(&seen) > 1.0)
        })
    }

    /// The least and the largest that [`Self::excess`] may be; `None` where two eccentricities do
    /// not decide it in the eye's model.
    fn rough_excess(&self, rough: &RoughError, sight: &ViewOfScene) -> Option<[f64; 2]> {
        let pixels = rough.error.0 * sight.pixels / ERROR_PIXELS;
        match (self.config.policy, &self.config.acuity) {
            (Policy::Acuity, AcuityModel::Linear { slope, .. }) if *slope >= 0.0 => {
                let excess = |eccentricity| {
                    let allowed = smallest_angle_deg(&self.config.acuity, eccentricity);
                    pixels.min(rough.error.to_degrees() / allowed)
                };
                let [least, most] = rough.eccentricity;
                Some([excess(most), excess(least)])
            }
            (Policy::Acuity, _) => None,
            _ => Some([pixels; 2]),
        }
    }

    fn chosen(&self, is_chosen: &[bool]) -> Chosen {
        let units = (0..).map(UnitId).zip(is_chosen);
        let units: Vec<UnitId> = units.filter(|(_, is)| **is).map(|(unit, _)| unit).collect();
        let pack = self.scene.pack();
        let mut per_level = vec![0; usize::from(pack.coarsest()) + 1];
        for unit in &units {
            per_level[usize::from(pack.level_of(*unit))] += 1;
        }
        let samples = units.iter().map(|it| u64::from(pack.row(*it).samples));
        let places: Vec<u8> = units.iter().flat_map(|it| it.0.to_le_bytes()).collect();
        let record = Record {
            per_level,
            samples: samples.sum(),
            sha256: sha256_hex(&places),
        };
        Chosen { units, record }
    }
}

/// How much larger an error is than a pixel, or than what can be resolved at its eccentricity: the
/// less of both.
pub(super) fn acuity_excess(seen: &SeenError, acuity: &AcuityModel) -> f64 {
    let allowed = smallest_angle_deg(acuity, seen.eccentricity);
    let pixels = seen.error_pixels / ERROR_PIXELS;
    pixels.min(seen.error.to_degrees() / allowed)
}

/// The smallest angle that can be resolved at an eccentricity, in degrees.
fn smallest_angle_deg(acuity: &AcuityModel, eccentricity: Radians) -> f64 {
    0.5 / acuity.best_acuity(eccentricity).0
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

    fn see(&mut self, measured: &Measured) {
        self.worth.see(measured.clone());
    }

    fn begin(&mut self, _frame: u32, moment: &Moment, _budget: Option<u64>) {
        let sights = self.sights(moment);
        if self.config.policy == Policy::Perceptual {
            self.values = self.worth.values(&self.scene, &sights);
            return;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::scene::scripted::scripted_scene;
    use crate::gaze::sample::GazeSample;
    use crate::perception::measured::acuity::MeasuredAcuity;
    use crate::units::Seconds;
    use crate::view::axes::Axes;
    use crate::view::eye_view::{EyeView, Field};
    use crate::view::random::Random;
    use glam::DVec3;

    /// Through one or two views, near and far, narrow and wide, magnified and not, of a sure gaze
    /// and of one that is not.
    fn any_moment(random: &mut Random) -> Moment {
        let mut any = || random.unit() * 2.0 - 1.0;
        let size = [200 + (any().abs() * 4000.0) as u32, 700];
        let mut field = Field::across(Radians::from_degrees(95.0 + 75.0 * any()), size);
        if any() > 0.7 {
            field.at_eye = Some([0.4, 0.4, 0.3, 0.3]);
        }
        let axes = Axes::from_yaw_pitch_roll(Radians(3.0 * any()), Radians(any()), Radians(any()));
        let view = EyeView {
            position: DVec3::new(any(), any(), any()) * 6.0 * any().abs(),
            axes,
            field,
            size,
            eye: Default::default(),
        };
        let gaze = GazeSample {
            gaze_in_content: axes.at([any() * 0.8, any() * 0.6]).normalize(),
            spread: Radians((any() * 0.1).max(0.0)),
            ..GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0))
        };
        let beside = EyeView {
            position: view.position + DVec3::X * 0.06,
            ..view
        };
        let views = [vec![view], vec![view, beside], Vec::new()];
        Moment::new(gaze, views[(any().abs() * 2.2) as usize].clone())
    }

    #[test]
    fn what_is_chosen_by_rough_looks_is_what_is_chosen_by_working_all_out() {
        let scene = Arc::new(scripted_scene().unwrap());
        let mut random = Random::new(11);
        let (mut chosen, mut left) = (0, 0);
        let measured = "ecc_deg,mar_arcmin\n0,1\n5,1.2\n6,7\n50,60\n";
        let measured = MeasuredAcuity::parse(measured).unwrap();
        for round in 0..900 {
            let policy = [Policy::Acuity, Policy::Viewport][round % 2];
            let acuity = [
                AcuityModel::LINEAR,
                AcuityModel::linear(0.0),
                AcuityModel::Watson,
                AcuityModel::Table(measured.clone()),
            ];
            let config = PolicyConfig {
                acuity: acuity[round / 2 % 4].clone(),
                ..PolicyConfig::new(policy)
            };
            let demand = SceneDemand::new(Arc::clone(&scene), &config);
            let moment = any_moment(&mut random);
            let sights = demand.sights(&moment);
            let plain =
                demand.closed(|unit| demand.most(unit, &sights, |seen| demand.excess(seen)) > 1.0);
            assert_eq!(demand.wanted(&moment), plain, "{config:?} {moment:?}");
            chosen += plain.iter().filter(|is| **is).count();
            left += plain.iter().filter(|is| !**is).count();
        }
        assert!(chosen > 10_000 && left > 10_000, "{chosen} {left}");
    }
}
