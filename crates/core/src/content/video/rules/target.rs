//! Which levels keep a score?
//!
//! A rule has one free number: the visible loss that no cell may pass (`perceptual`), or the slope
//! by which acuity falls off (`acuity`). It is the largest at which the picture in view is expected
//! to keep the score, by the signatures of what is in view. Where a judge saw the content while it
//! was prepared, the bounds of the zones are to each other as it found them.

use crate::content::policy::calibration::{Expectation, slope_for};
use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::calibration::Scale;
use crate::content::video::glimpse::{Around, Finder, Glimpse};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::tile_grid::TileGrid;
use crate::content::video::losses::{LossMeter, Losses};
use crate::content::video::rules::known_acuity::KnownAcuity;
use crate::content::video::rules::steady::SteadySelector;
use crate::content::video::rules::still::{gaze_stays, head_room, is_turned_view, stays};
use crate::content::video::rules::{Occasion, Selection};
use crate::content::video::units::VideoUnits;
use crate::pack::unit::UnitId;
use crate::perception::acuity::AcuityModel;
use crate::perception::glance::Glance;
use crate::perception::visible_loss::BEST_JOD;
use crate::units::Radians;
use crate::view::axes::angle_between;

/// Steps of the bound for each doubling.
const BOUND_STEPS: f64 = 4.0;
/// Steps of the slope for each doubling: each costs a choice of every cell's level, and tiles are
/// too large to follow finer ones.
const SLOPE_STEPS: f64 = 2.0;
/// Share of what the target allows to lose that must be lost before another number is looked for:
/// what is good enough stays as it is.
const LEAST_LOST: f64 = 0.5;
/// A cell becomes coarser when it would lose less than this share of what it may lose.
const COARSER_BELOW: f64 = 0.7;
/// How far gaze and spread may go before a slope is searched for again, in degrees: the fovea's
/// radius. Levels follow the eye at every glance; only the slope waits.
const SLOPE_ANEW_DEG: f64 = 2.5;
/// How far the head may turn until then: a seventh of a view that is 100° wide is another.
const SLOPE_ANEW_HEAD_DEG: f64 = 15.0;
/// The least slope that is tried, over the one by which content of unknown texture keeps the score:
/// signatures know one content from another, and less of how the judge takes one.
const LEAST_SLOPE: f64 = 0.7;
/// Slopes that are tried.
const SLOPES: u32 = 8;
/// Where a judge saw the content: the least slope that is tried, steps for each doubling, and how
/// many.
const LEAST_JUDGED_SLOPE: f64 = 0.0015;
const JUDGED_SLOPE_STEPS: f64 = 4.0;
const JUDGED_SLOPES: u32 = 33;
/// So far may the expected score lie below the target, in JOD, where a judge saw the content: tiles
/// may be so large that the next finer choice lies far above.
const BELOW_TARGET_JOD: f64 = 0.1;
/// So far may what was chosen before lie from the target and stay, in JOD, where a judge saw the
/// content.
const STAYS_WITHIN_JOD: f64 = 0.1;
/// Bounds that are tried: this many steps below and above the loss of the target.
const BOUNDS: u32 = 40;
/// The same where a judge saw the content: tiles of even texture pass a bound almost together.
const JUDGED_BOUND_STEPS: f64 = 16.0;
const JUDGED_BOUNDS: u32 = 160;

/// Chooses levels for a score, frame after frame.
#[derive(Clone, Debug)]
pub struct TargetSelector {
    grid: TileGrid,
    config: PolicyConfig,
    target: f64,
    meter: LossMeter,
    /// Under `acuity`: the rule, whose slope follows.
    rule: Option<SteadySelector>,
    /// The losses that were found last.
    glimpse: Glimpse,
    before: Option<Chosen>,
}

/// What was chosen last, and for what.
#[derive(Clone, Debug)]
struct Chosen {
    glance: Glance,
    /// Room around its view for a head that turns.
    room: Radians,
    /// A unit of the group that it was chosen for.
    group: UnitId,
    step: u32,
    needed: LevelMap,
    /// Under `perceptual`: what was shown through other views while the eye stayed, once the head
    /// turned too far for one view to serve.
    floor: Option<LevelMap>,
}

impl TargetSelector {
    /// For a policy with a target; `None` where the policy has none, or no use for it.
    #[must_use]
    pub fn new(grid: &TileGrid, config: &PolicyConfig) -> Option<Self> {
        Self::with_meter(grid, config, || LossMeter::new(grid, &config.perception))
    }

    /// The same, with a meter for this grid and policy.
    pub(in crate::content::video) fn with_meter(
        grid: &TileGrid,
        config: &PolicyConfig,
        meter: impl FnOnce() -> LossMeter,
    ) -> Option<Self> {
        let target = config.target?;
        let rule = match config.policy {
            Policy::Perceptual => None,
            Policy::Acuity => Some(SteadySelector::new(*grid, config.clone())),
            _ => return None,
        };
        Some(Self {
            grid: *grid,
            target,
            meter: meter(),
            rule,
            glimpse: Glimpse::default(),
            config: config.clone(),
            before: None,
        })
    }

    /// The same, which showed nothing yet.
    #[must_use]
    pub(crate) fn without_memory(&self) -> Self {
        Self {
            rule: self.rule.as_ref().map(SteadySelector::without_memory),
            glimpse: Glimpse::default(),
            before: None,
            ..self.clone()
        }
    }

    /// From now on chooses from other content.
    pub(crate) fn forget_losses(&mut self) {
        self.glimpse = Glimpse::default();
    }

    /// The choice for one glance, after those before.
    pub fn select(&mut self, content: &dyn VideoUnits, frame: u32, glance: &Glance) -> Selection {
        let mut levels = self.needed(content, (frame, glance), &mut KnownAcuity::default());
        let tiles = levels.cover(&self.grid);
        Selection { levels, tiles }
    }

    /// The level that each cell then needs; what is found of the eye's acuity is kept for other
    /// views.
    pub(crate) fn needed(
        &mut self,
        content: &dyn VideoUnits,
        (frame, glance): (u32, &Glance),
        known: &mut KnownAcuity,
    ) -> LevelMap {
        let occasion = Occasion {
            content: Some(content),
            frame,
            glance,
        };
        let group = content.unit(self.grid.tile_at(0, 0), frame);
        let of_group = self.before.as_ref().filter(|before| before.group == group);
        let still = self.before.as_ref();
        let still = still.filter(|before| self.is_still(&before.glance, glance));
        // An eye that trembles is taken to look where it did before.
        let looked = still.map_or(*glance, |before| before.glance);
        let room = match self.config.steadiness.0 > 0.0 {
            true => head_room(&self.grid, &looked, glance),
            false => Radians(0.0),
        };
        let room = Radians(still.map_or(room.0, |before| room.0.max(before.room.0)));
        let floor = self.floor(glance);
        if let Some(before) = of_group {
            match &mut self.rule {
                Some(rule) if still.is_some() || keeps_slope(&before.glance, glance) => {
                    return rule.needed(&occasion, known);
                }
                None if still.is_some() && before.room == room => return before.needed.clone(),
                _ => {}
            }
        }
        let scale = content.scale(looked.view.as_ref());
        let bounds = match (&self.rule, self.config.bound) {
            (None, None) => scale.bounds(self.target),
            _ => None,
        };
        let around = Around {
            glance: &looked,
            room,
            bounds,
        };
        let mut glimpse = core::mem::take(&mut self.glimpse);
        let mut losses = glimpse.look(&self.meter, &self.grid, (content, frame), &around);
        let (step, mut needed) = match self.rule.take() {
            Some(mut rule) => {
                let step = self.slope(&rule, (&mut losses, &scale), &looked, known);
                rule.set_acuity(self.slope_at(&scale, step));
                let needed = rule.needed(&occasion, known);
                self.rule = Some(rule);
                (step, needed)
            }
            None => match (bounds, self.config.bound) {
                (_, Some(bound)) => (0, self.within(&mut losses, bound)),
                (_, None) => self.by_bound(&mut losses, &scale),
            },
        };
        self.keep(glimpse);
        floor.iter().for_each(|floor| needed.refine_to(floor));
        self.before = Some(Chosen {
            floor,
            glance: looked,
            room,
            group,
            step,
            needed: needed.clone(),
        });
        needed
    }

    /// Keeps what was found; not under `acuity`, where a glance is rarely measured twice.
    fn keep(&mut self, mut glimpse: Glimpse) {
        match self.rule {
            Some(_) => glimpse.forget(),
            None => glimpse.trim(),
        }
        self.glimpse = glimpse;
    }

    /// What is kept in addition to what is chosen while the eye stays and the head turns far. The
    /// rule of `acuity` has its own.
    fn floor(&self, glance: &Glance) -> Option<LevelMap> {
        let was = self.before.as_ref().filter(|_| self.rule.is_none())?;
        let slack = self.config.steadiness;
        match gaze_stays(&self.grid, &was.glance, glance, slack) {
            true if self.is_still(&was.glance, glance) => was.floor.clone(),
            true => Some(was.needed.covered(&self.grid)),
            false => None,
        }
    }

    /// Whether what was chosen still serves.
    fn is_still(&self, before: &Glance, glance: &Glance) -> bool {
        stays(&self.grid, before, glance, self.config.steadiness)
    }

    /// The slope by which acuity falls off.
    fn slope(
        &self,
        rule: &SteadySelector,
        (losses, scale): (&mut Finder<'_>, &Scale),
        glance: &Glance,
        known: &mut KnownAcuity,
    ) -> u32 {
        let mut exact = rule.exact().clone();
        let occasion = Occasion {
            content: None,
            frame: 0,
            glance,
        };
        let slopes = match scale.is_measured(Expectation::Elsewise) {
            true => JUDGED_SLOPES,
            false => SLOPES,
        };
        self.nearest((slopes, scale.is_measured(Expectation::Elsewise)), |step| {
            exact.set_acuity(self.slope_at(scale, step));
            let mut levels = exact.levels_of(&occasion, known, |_| true);
            let _ = levels.cover(&self.grid);
            let expected = scale.expected(Expectation::Elsewise, &losses.of(&levels));
            expected.for_target()
        })
    }

    fn slope_at(&self, scale: &Scale, step: u32) -> AcuityModel {
        if !scale.is_measured(Expectation::Elsewise) {
            return slope_of(self.target, step);
        }
        let times = libm::exp2(f64::from(step) / JUDGED_SLOPE_STEPS);
        AcuityModel::linear(LEAST_JUDGED_SLOPE * times)
    }

    /// Every cell takes the coarsest level whose loss stays within a bound; where a judge saw the
    /// content, within so many times the bound that it found for the cell's zone.
    fn by_bound(&self, losses: &mut Finder<'_>, scale: &Scale) -> (u32, LevelMap) {
        let is_measured = scale.is_measured(Expectation::ByLoss);
        let bound = |step| match is_measured {
            true => libm::exp2((f64::from(step) - f64::from(JUDGED_BOUNDS)) / JUDGED_BOUND_STEPS),
            false => bound_of(self.target, step),
        };
        let bounds = match is_measured {
            true => JUDGED_BOUNDS,
            false => BOUNDS,
        };
        // What stays finer than a bound needs counts too where the expectation is that exact.
        let before = self.before.as_ref().filter(|_| is_measured);
        let before = before.map(|before| before.needed.covered(&self.grid));
        let step = self.nearest((2 * bounds, is_measured), |step| {
            let mut levels = self.bounded(losses, bound(step), before.as_ref());
            let _ = levels.cover(&self.grid);
            let expected = scale.expected(Expectation::ByLoss, &losses.of(&levels));
            expected.for_target()
        });
        (step, self.within(losses, bound(step)))
    }

    /// Levels within a bound, after what was shown before.
    fn within(&self, losses: &mut Finder<'_>, bound: f64) -> LevelMap {
        let before = self.before.as_ref();
        let before = before.map(|before| before.needed.covered(&self.grid));
        self.bounded(losses, bound, before.as_ref())
    }

    /// Levels within a bound; a cell that was finer becomes coarser only when that is clearly
    /// enough.
    fn bounded(&self, losses: &mut Finder<'_>, bound: f64, before: Option<&LevelMap>) -> LevelMap {
        let coarsest = self.grid.coarsest();
        let [most, clearly] = [bound, bound * COARSER_BELOW].map(Losses::of_pixel);
        let mut allowed = |rank: usize, most: f64| {
            let mut levels = (1..=coarsest).rev();
            let within = levels.find(|level| losses.is_within(rank, *level, most));
            let more = u8::from(losses.is_beside(rank));
            coarsest.min(within.unwrap_or(0) + more)
        };
        LevelMap::from_cells(&self.grid, |cell| {
            let rank = self.grid.rank(cell) as usize;
            let level = allowed(rank, most);
            match before.map(|before| before.level(&self.grid, cell)) {
                Some(was) if was < level => was.max(allowed(rank, clearly)),
                _ => level,
            }
        })
    }

    /// The largest of `count` steps at which the score is expected to be kept, or where
    /// expectations are measured the next one if its score is nearer to the target; that of before
    /// as long as it is good enough.
    fn nearest(
        &self,
        (count, is_measured): (u32, bool),
        mut expected: impl FnMut(u32) -> f64,
    ) -> u32 {
        let least = match is_measured {
            true => self.target - BELOW_TARGET_JOD,
            false => self.target,
        };
        if let Some(before) = &self.before {
            let still = expected(before.step);
            let stays = match is_measured {
                true => self.target - STAYS_WITHIN_JOD..=self.target + STAYS_WITHIN_JOD,
                false => least..=BEST_JOD - LEAST_LOST * (BEST_JOD - self.target),
            };
            if stays.contains(&still) {
                return before.step;
            }
        }
        let (mut enough, mut too_far) = (0, count);
        let (mut kept, mut missed) = (f64::INFINITY, f64::NEG_INFINITY);
        while too_far - enough > 1 {
            let middle = enough.midpoint(too_far);
            let score = expected(middle);
            if score >= self.target {
                (enough, kept) = (middle, score);
            } else {
                (too_far, missed) = (middle, score);
            }
        }
        match missed >= least && self.target - missed < kept - self.target {
            true => too_far,
            false => enough,
        }
    }
}

/// Whether eye and head are still so near to where a slope was found that it serves.
fn keeps_slope(before: &Glance, glance: &Glance) -> bool {
    let [was, is] = [before, glance].map(|glance| &glance.gaze);
    let moved = angle_between(was.gaze_in_content, is.gaze_in_content);
    is_turned_view(before, glance, Radians::from_degrees(SLOPE_ANEW_HEAD_DEG))
        && moved.to_degrees() <= SLOPE_ANEW_DEG
        && Radians((was.spread.0 - is.spread.0).abs()).to_degrees() <= SLOPE_ANEW_DEG
}

fn slope_of(target: f64, step: u32) -> AcuityModel {
    let times = LEAST_SLOPE * libm::exp2(f64::from(step) / SLOPE_STEPS);
    AcuityModel::linear(slope_for(target) * times)
}

fn bound_of(target: f64, step: u32) -> f64 {
    let steps = f64::from(step) - f64::from(BOUNDS);
    Expectation::ByLoss.told(target) * libm::exp2(steps / BOUND_STEPS)
}

#[cfg(test)]
mod tests;
