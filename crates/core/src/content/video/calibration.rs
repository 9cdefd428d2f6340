//! Which score does this content have for what is lost of it?
//!
//! While a pack is prepared its content is shown at several bounds to eyes that look at several
//! places, and the judge scores what they see. These scores lie in the pack and bring what
//! signatures predict to the judge's scale for this content
//! (docs/decisions/0028-packs-know-their-score.md).

use crate::content::policy::calibration::Expectation;
use crate::perception::visible_loss::{
    BEST_JOD, JOD_EXPONENT, SPACE_EXPONENT, jod_lost, quality_of_jod,
};
use crate::units::{Ppd, Radians};
use crate::view::eye_view::EyeView;
use crate::view::surface::{Projection, Screen, Surface};

/// Zones of eccentricity that the judge distinguishes.
pub const ZONES: usize = 3;
/// Borders between them, in degrees of eccentricity.
pub const ZONE_BORDERS_DEG: [f64; ZONES - 1] = [5.0, 20.0];
/// A bound changes from one zone's to the next one's within so many degrees about their border.
const JOINED_OVER_DEG: f64 = 2.0;
/// A zone may be so far below the target where the whole keeps it.
pub const ZONE_BELOW_JOD: f64 = 0.25;
/// The least that counts as lost: half of what scores are rounded to.
const LEAST_LOST_JOD: f64 = 0.005;

/// Less than this is lost by chance, in JOD.
const LEAST_TELLING_JOD: f64 = 0.05;
/// The curve goes up to where so many times less is lost than at the best that was found.
const MOST_BEYOND: f64 = 1.1;
/// Of what the judge has not seen, at most so many times what it found at the largest bound is
/// lost: a picture of the coarsest level alone, before anything else is loaded, loses no more.
const MOST_LOST_BEYOND: f64 = 2.0;
/// Below this score constants that fit most content say nothing.
const LEAST_KNOWN_JOD: f64 = 7.0;
/// Densities that are nearer to each other are the same.
const SAME_DENSITY: f64 = 0.02;

/// The zone of an eccentricity: 0 under 5°, 1 from 5° to 20°, 2 beyond.
#[must_use]
pub fn zone_of(eccentricity: Radians) -> usize {
    let degrees = eccentricity.to_degrees();
    ZONE_BORDERS_DEG.iter().filter(|&&it| degrees >= it).count()
}

/// The density that content is looked up at in a view: pixels per degree in the middle of the view;
/// of flat content those that the view would have where a screen of the usual distance shows it,
/// as it was judged there. How small a view shows content matters more than how near it is.
#[must_use]
pub fn density_of(surface: &Surface, view: &EyeView) -> Ppd {
    let ppd = view.as_seen().least_ppd();
    if surface.projection != Projection::Flat {
        return ppd;
    }
    let middle = surface.size.map(|side| f64::from(side) / 2.0);
    let usual = Surface::flat(surface.size, Screen::default());
    Ppd(ppd.0 * usual.ppd(middle).0 / surface.ppd(middle).0)
}

/// What a picture loses in each zone, as signatures predict it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ZoneLosses {
    /// Sums over places of pixels x loss^beta.
    pub sums: [f64; ZONES],
    /// Pixels in view.
    pub pixels: [f64; ZONES],
}

impl ZoneLosses {
    /// The predicted quality difference of the whole picture.
    #[must_use]
    pub fn whole(&self) -> f64 {
        pooled(self.sums.iter().sum(), self.pixels.iter().sum())
    }

    /// That of one zone, had the whole picture been like it; `None` where none of it is in view.
    #[must_use]
    pub fn zone(&self, zone: usize) -> Option<f64> {
        (self.pixels[zone] > 0.0).then(|| pooled(self.sums[zone], self.pixels[zone]))
    }

    /// Both, as those of one frame after the other.
    pub fn add(&mut self, other: &Self) {
        for zone in 0..ZONES {
            self.sums[zone] += other.sums[zone];
            self.pixels[zone] += other.pixels[zone];
        }
    }
}

fn pooled(sum: f64, pixels: f64) -> f64 {
    match pixels > 0.0 {
        true => libm::pow(sum.max(0.0) / pixels, 1.0 / SPACE_EXPONENT),
        false => 0.0,
    }
}

/// What the judge found of content at one bound, at one density, in one part of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationRow {
    /// How levels were chosen: by a bound of each cell's loss (`perceptual`), or otherwise
    /// (`acuity`).
    pub rule: Expectation,
    /// Pixels per degree in the middle of the view.
    pub ppd: f64,
    /// The zone; `None` for the whole picture.
    pub zone: Option<usize>,
    /// The visible loss that no cell passes; for `acuity` the loss of the whole picture.
    pub bound: f64,
    /// The quality difference that signatures predict for this part.
    pub loss: f64,
    /// Mean score over gazes and frames, in JOD.
    pub jod_mean: f64,
    /// Standard deviation over gazes.
    pub jod_sd: f64,
    /// Share of the finest level's pixels that were shown.
    pub pixels_share: f64,
    /// Bytes of the units that were shown, a second.
    pub bytes: u64,
}

/// All that the judge found of one content. Rows in [`order`](CalibrationRow::key).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Gazes that were sampled.
    pub gazes: u16,
    /// Frames that were judged at each.
    pub frames: u16,
    rows: Vec<CalibrationRow>,
}

impl CalibrationRow {
    /// By rule, density, part of the picture (the whole first), then rising bound.
    fn key(&self) -> (bool, f64, usize, f64) {
        let zone = self.zone.map_or(0, |zone| zone + 1);
        (
            self.rule == Expectation::Elsewise,
            self.ppd,
            zone,
            self.bound,
        )
    }

    /// Whether both are for the same rule, density and part.
    fn is_beside(&self, other: &Self) -> bool {
        self.rule == other.rule && self.ppd == other.ppd && self.zone == other.zone
    }
}

/// Why rows are no calibration.
pub type Refused = &'static str;

impl Calibration {
    /// These rows, in any order; refuses none, numbers out of range, a score that rises or a loss
    /// that falls while the bound rises, and a density without rows of the whole picture.
    pub fn new(gazes: u16, frames: u16, mut rows: Vec<CalibrationRow>) -> Result<Self, Refused> {
        rows.sort_by(|a, b| {
            let (a, b) = (a.key(), b.key());
            let order = a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
            order.then(a.2.cmp(&b.2)).then(a.3.total_cmp(&b.3))
        });
        if rows.is_empty() || gazes == 0 || frames == 0 {
            return Err("rows, gazes and frames");
        }
        for row in &rows {
            let lengths = [row.ppd, row.bound];
            let others = [row.loss, row.jod_sd, row.pixels_share];
            if !lengths.iter().all(|it| it.is_finite() && *it > 0.0)
                || !others.iter().all(|it| it.is_finite() && *it >= 0.0)
                || !(..=BEST_JOD).contains(&row.jod_mean)
                || row.zone.is_some_and(|zone| zone >= ZONES)
            {
                return Err("finite numbers in range");
            }
        }
        for pair in rows.windows(2) {
            if pair[0].is_beside(&pair[1])
                && (pair[0].bound >= pair[1].bound
                    || pair[0].jod_mean < pair[1].jod_mean
                    || pair[0].loss > pair[1].loss)
            {
                return Err("scores that fall and losses that rise with the bound");
            }
        }
        let all = Self {
            gazes,
            frames,
            rows,
        };
        let is_whole = |row: &CalibrationRow| {
            let of_whole = CalibrationRow { zone: None, ..*row };
            all.rows.iter().any(|it| it.is_beside(&of_whole))
        };
        match all.rows.iter().all(is_whole) {
            true => Ok(all),
            false => Err("rows of the whole picture at every density"),
        }
    }

    /// What was found.
    #[must_use]
    pub fn rows(&self) -> &[CalibrationRow] {
        &self.rows
    }

    /// The densities that one rule was judged at, rising.
    #[must_use]
    pub fn densities(&self, rule: Expectation) -> Vec<f64> {
        let of_rule = self.rows.iter().filter(|row| row.rule == rule);
        let mut all: Vec<f64> = of_rule.map(|row| row.ppd).collect();
        all.dedup();
        all
    }

    /// The scale of a view of this density, or of the nearest two that were judged; without a view
    /// that of the densest.
    #[must_use]
    pub fn at(&self, ppd: Option<Ppd>) -> Scale {
        let side = |rule| {
            let densities = self.densities(rule);
            let (Some(first), Some(last)) = (densities.first(), densities.last()) else {
                return Side::default();
            };
            let asked = ppd.map_or(*last, |ppd| ppd.0.clamp(*first, *last));
            let is_at = |density: &&f64| (asked / **density - 1.0).abs() < SAME_DENSITY;
            let asked = densities.iter().find(is_at).copied().unwrap_or(asked);
            let above = densities.iter().position(|it| *it >= asked);
            let above = above.unwrap_or(densities.len() - 1);
            let below = match densities[above] > asked {
                true => above - 1,
                false => above,
            };
            let [low, high] = [below, above].map(|at| densities[at]);
            Side {
                near: self.curves(rule, low),
                far: (high > low).then(|| self.curves(rule, high)),
                share: match high > low {
                    true => libm::log(asked / low) / libm::log(high / low),
                    false => 0.0,
                },
            }
        };
        Scale {
            by_loss: side(Expectation::ByLoss),
            elsewise: side(Expectation::Elsewise),
        }
    }

    /// Whether a view of this density lies between two that were judged.
    #[must_use]
    pub fn covers(&self, ppd: Ppd) -> bool {
        let of = |rule| self.densities(rule);
        let within = |all: Vec<f64>| match (all.first(), all.last()) {
            (Some(first), Some(last)) => (first * 0.99..=last * 1.01).contains(&ppd.0),
            _ => true,
        };
        [Expectation::ByLoss, Expectation::Elsewise]
            .into_iter()
            .map(of)
            .all(within)
    }

    fn curves(&self, rule: Expectation, ppd: f64) -> Curves {
        let of = |zone: Option<usize>| {
            let is_of =
                |row: &&CalibrationRow| row.rule == rule && row.ppd == ppd && row.zone == zone;
            self.rows.iter().filter(is_of).map(Point::of).collect()
        };
        Curves {
            whole: of(None),
            zones: [0, 1, 2].map(|zone| of(Some(zone))),
        }
    }

    /// The rule that shows fewer pixels at a score, and their share, at one density.
    #[must_use]
    pub fn cheaper(&self, target: f64, ppd: Option<Ppd>) -> Option<(Expectation, f64)> {
        let rules = [Expectation::ByLoss, Expectation::Elsewise];
        let shares = rules
            .into_iter()
            .filter_map(|rule| Some((rule, self.share_at(rule, target, ppd)?)));
        shares.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The share of the pixels that a rule takes for a score, at one density; `None` where it was
    /// not judged.
    #[must_use]
    pub fn share_at(&self, rule: Expectation, target: f64, ppd: Option<Ppd>) -> Option<f64> {
        let side = self.at(ppd);
        side.side(rule).between(|curves| curves.pixels_at(target))
    }
}

/// A point of a curve, in logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    bound: f64,
    loss: f64,
    lost_jod: f64,
    pixels: f64,
}

impl Point {
    fn of(row: &CalibrationRow) -> Self {
        let ln = |value: f64| libm::log(value.max(LEAST_LOST_JOD * LEAST_LOST_JOD));
        Self {
            bound: libm::log(row.bound),
            loss: ln(row.loss),
            lost_jod: libm::log((BEST_JOD - row.jod_mean).max(LEAST_LOST_JOD)),
            pixels: ln(row.pixels_share),
        }
    }
}

impl Point {
    /// Whether enough is lost to extrapolate what is lost beyond.
    fn tells(&self) -> bool {
        self.lost_jod > libm::log(LEAST_TELLING_JOD)
    }
}

/// Scores of each part of the picture, bounds rising.
#[derive(Clone, Debug, Default, PartialEq)]
struct Curves {
    whole: Vec<Point>,
    zones: [Vec<Point>; ZONES],
}

impl Curves {
    /// The points of a zone, or where it was not seen those of the whole.
    fn zone(&self, zone: usize) -> &[Point] {
        match self.zones[zone].is_empty() {
            true => &self.whole,
            false => &self.zones[zone],
        }
    }

    /// Logarithm of the JOD that a zone loses at a predicted loss; beyond what was found of it, at
    /// least what the whole picture loses there.
    fn lost_at(&self, zone: usize, loss: f64) -> Option<f64> {
        let (lost, most) = self.lost_and_most(zone, loss)?;
        Some(lost.min(most))
    }

    /// Whether a zone loses more than anything that is known of it.
    fn is_beyond(&self, zone: usize, loss: f64) -> bool {
        self.lost_and_most(zone, loss)
            .is_some_and(|(lost, most)| lost > most)
    }

    /// What the curve of a zone says, and the most that it is believed.
    fn lost_and_most(&self, zone: usize, loss: f64) -> Option<(f64, f64)> {
        let loss = libm::log(loss.max(f64::MIN_POSITIVE));
        let of = |points: &[Point]| {
            let points: Vec<[f64; 2]> = points.iter().map(|it| [it.loss, it.lost_jod]).collect();
            along(&points, loss, JOD_EXPONENT)
        };
        let points = self.zone(zone);
        let points = match points.last() {
            Some(last) if loss > last.loss && !last.tells() => &self.whole,
            _ => points,
        };
        let most = points.last()?.lost_jod + libm::log(MOST_LOST_BEYOND);
        Some((of(points)?, most))
    }

    /// Logarithm of the bound at which a zone has a score, at most the largest that was judged, as
    /// all of it may become coarse beyond; of a zone that lost nothing, that of the whole picture.
    fn bound_at(&self, zone: usize, target: f64) -> Option<f64> {
        let of = |points: &[Point]| {
            let most = points.last()?.bound;
            let points: Vec<[f64; 2]> = points.iter().map(|it| [it.lost_jod, it.bound]).collect();
            let bound = along(&points, libm::log(BEST_JOD - target), 1.0 / JOD_EXPONENT)?;
            Some(bound.min(most))
        };
        let points = self.zone(zone);
        match points.last()?.tells() {
            true => of(points),
            false => of(&self.whole),
        }
    }

    /// Logarithm of the share of the pixels at which the whole has a score; `None` of one that is
    /// far above all that were found.
    fn pixels_at(&self, target: f64) -> Option<f64> {
        let best = self.whole.first()?.lost_jod;
        if libm::log(BEST_JOD - target) < best - libm::log(MOST_BEYOND) {
            return None;
        }
        let points = self.whole.iter();
        let points: Vec<[f64; 2]> = points.map(|it| [it.lost_jod, it.pixels]).collect();
        along(&points, libm::log(BEST_JOD - target), 0.0)
    }
}

/// The scores of one rule at a density, between those of two.
#[derive(Clone, Debug, Default, PartialEq)]
struct Side {
    near: Curves,
    far: Option<Curves>,
    share: f64,
}

impl Side {
    /// What is read from the curves as a logarithm, between the two densities.
    fn between(&self, read: impl Fn(&Curves) -> Option<f64>) -> Option<f64> {
        let near = read(&self.near)?;
        let far = match &self.far {
            Some(far) => read(far)?,
            None => near,
        };
        Some(libm::exp(near + (far - near) * self.share))
    }
}

/// From what signatures predict to the judge's scores, for one content at one density.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    by_loss: Side,
    elsewise: Side,
}

/// A score, and that of the worst zone in view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Of the whole picture, in JOD.
    pub jod: f64,
    /// Of the worst zone, had the whole picture been like it.
    pub worst_zone: f64,
    /// Whether no zone loses so much more than the judge has seen of this content that the scores
    /// are only upper bounds.
    pub is_known: bool,
}

impl Expected {
    /// The score that a target is compared with: no zone may be far below it.
    #[must_use]
    pub fn for_target(&self) -> f64 {
        self.jod.min(self.worst_zone + ZONE_BELOW_JOD)
    }
}

impl Scale {
    /// The scale of content that no judge saw, from the constants in
    /// [`calibration`](crate::content::policy::calibration).
    #[must_use]
    pub fn usual() -> Self {
        Self::default()
    }

    /// Whether a judge saw the content under a rule.
    #[must_use]
    pub fn is_measured(&self, rule: Expectation) -> bool {
        !self.side(rule).near.whole.is_empty()
    }

    fn side(&self, rule: Expectation) -> &Side {
        match rule {
            Expectation::ByLoss => &self.by_loss,
            Expectation::Elsewise => &self.elsewise,
        }
    }

    /// The score that is expected of these losses.
    #[must_use]
    pub fn expected(&self, rule: Expectation, losses: &ZoneLosses) -> Expected {
        if !self.is_measured(rule) {
            let jod = rule.jod(losses.whole());
            return Expected {
                jod,
                worst_zone: jod,
                is_known: jod >= LEAST_KNOWN_JOD,
            };
        }
        let side = self.side(rule);
        let all: f64 = losses.pixels.iter().sum();
        let (mut sum, mut worst_zone, mut is_known) = (0.0, BEST_JOD, true);
        for zone in 0..ZONES {
            let Some(loss) = losses.zone(zone) else {
                continue;
            };
            let lost = side.between(|curves| curves.lost_at(zone, loss));
            let jod = BEST_JOD - lost.unwrap_or(0.0);
            worst_zone = worst_zone.min(jod);
            is_known &= !side.near.is_beyond(zone, loss);
            let share = losses.pixels[zone] / all;
            sum += share * libm::pow(quality_of_jod(jod), SPACE_EXPONENT);
        }
        Expected {
            jod: BEST_JOD - jod_lost(libm::pow(sum, 1.0 / SPACE_EXPONENT)),
            worst_zone,
            is_known,
        }
    }

    /// The bounds of each zone at which cells keep a score; `None` where no judge saw the content.
    #[must_use]
    pub fn bounds(&self, target: f64) -> Option<ZoneBounds> {
        let bound = |zone| self.by_loss.between(|curves| curves.bound_at(zone, target));
        self.is_measured(Expectation::ByLoss).then_some(())?;
        Some(ZoneBounds([bound(0)?, bound(1)?, bound(2)?]))
    }
}

/// The visible loss that no cell may pass, by zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZoneBounds(pub [f64; ZONES]);

impl ZoneBounds {
    /// The bound at an eccentricity: from one zone to the next without a step, along logarithms.
    #[must_use]
    pub fn at(&self, eccentricity: Radians) -> f64 {
        self.beyond(Self::borders_passed(eccentricity))
    }

    /// How far an eccentricity lies on the way across each border, 0 to 1: all that its bound
    /// depends on.
    #[must_use]
    pub(super) fn borders_passed(eccentricity: Radians) -> [f64; ZONES - 1] {
        let degrees = eccentricity.to_degrees();
        ZONE_BORDERS_DEG.map(|border| ((degrees - border) / JOINED_OVER_DEG + 0.5).clamp(0.0, 1.0))
    }

    /// The bound so far beyond the borders.
    #[must_use]
    pub(super) fn beyond(&self, passed: [f64; ZONES - 1]) -> f64 {
        let mut ln = libm::log(self.0[0]);
        for (passed, pair) in passed.iter().zip(self.0.windows(2)) {
            ln += passed * libm::log(pair[1] / pair[0]);
        }
        libm::exp(ln)
    }
}

/// The polyline through points whose x rise, and beyond its ends a line of this slope; `None`
/// without points. Of points of the same x the last counts.
fn along(points: &[[f64; 2]], x: f64, slope: f64) -> Option<f64> {
    let ([x0, y0], [x1, y1]) = (*points.first()?, *points.last()?);
    if x < x0 {
        return Some(y0 + (x - x0) * slope);
    }
    if x >= x1 {
        return Some(y1 + (x - x1) * slope);
    }
    let above = points.partition_point(|point| point[0] <= x);
    let ([xa, ya], [xb, yb]) = (points[above - 1], points[above]);
    Some(ya + (yb - ya) * (x - xa) / (xb - xa))
}

#[cfg(test)]
mod tests;
