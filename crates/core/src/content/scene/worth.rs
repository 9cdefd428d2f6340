//! What is each unit of a scene worth to an eye, without drawing it?
//!
//! Signature x sensitivity x footprint: what the unit adds in each octave, how likely the eye sees
//! that octave there, and how much of the view it would refine, counted in what the eye resolves
//! (docs/decisions/0023-what-a-step-of-a-scene-is-worth.md). Footprints are
//! measured in what is drawn. A unit that would refine what is not drawn yet has a share of the
//! footprints of the units that it needs, by the areas of their spheres.

use super::Scene;
use super::scene::Stand;
use super::sight::{SeenExtent, ViewOfScene};
use super::unit_table::UnitRow;
use crate::pack::unit::UnitId;
use crate::perception::footprints::{Footprint, Footprints, Measured};
use crate::perception::moment::Moment;
use crate::perception::parameters::{Model, Parameters};
use crate::perception::step_worth::{DrawnFiner, LookedPlace, StepWorth};
use crate::units::Radians;

/// What a unit is worth, in a square degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Counted {
    /// Samples of the eye that see what it changes.
    SeenSamples,
    /// Visible error that it removes: what pictures of levels show.
    VisibleError,
}

/// Values the units of a scene for one viewer.
#[derive(Debug)]
pub(super) struct SceneWorth {
    parameters: Parameters,
    /// Steps of what is drawn without a filter, and of textures.
    of_sampled: StepWorth,
    of_filtered: StepWorth,
    /// For each unit the areas of the spheres of those that need it, in object space.
    needed_by: Vec<f64>,
    counts: Counted,
    /// What was measured last; `None` where nothing was.
    measured: Option<Measured>,
}

impl SceneWorth {
    /// The worth of the units of this scene to an eye with these parameters.
    pub(super) fn new(scene: &Scene, parameters: &Parameters) -> Self {
        let rows = scene.pack().rows();
        let mut needed_by = vec![0.0; rows.len()];
        for row in rows {
            for need in &row.needs {
                needed_by[need.0 as usize] += area(row);
            }
        }
        let parameters = parameters_of_morphs(parameters);
        Self {
            of_sampled: StepWorth::of_what_is_drawn(&parameters, DrawnFiner::Sampled),
            of_filtered: StepWorth::of_what_is_drawn(&parameters, DrawnFiner::Filtered),
            parameters,
            needed_by,
            counts: Counted::SeenSamples,
            measured: None,
        }
    }

    /// From now on this is known of units by what was drawn.
    pub(super) fn see(&mut self, measured: Measured) {
        self.measured = Some(measured);
    }

    /// What each unit is worth, as it is seen.
    pub(super) fn values(&self, scene: &Scene, sights: &[ViewOfScene]) -> Vec<f64> {
        let rows = scene.pack().rows();
        let mut values = vec![0.0; rows.len()];
        let extents = match &self.measured {
            Some(Measured::Worths(worths)) => {
                for (unit, worth) in worths {
                    if let Some(value) = values.get_mut(unit.0 as usize) {
                        *value = f64::from(*worth);
                    }
                }
                return values;
            }
            Some(Measured::Footprints(footprints)) => Some(self.extents(scene, footprints)),
            None => None,
        };
        for (unit, row) in (0..).map(UnitId).zip(rows) {
            let at = unit.0 as usize;
            // What is measured is which meshes are drawn: a page counts by its sphere.
            let measured = extents.as_ref().filter(|_| row.kind.facts().is_shape);
            let measured = measured.map(|it| it[at]);
            let is_hidden = measured.is_some_and(|it| it.area_deg2 <= 0.0);
            if row.needs.is_empty() || is_hidden {
                continue;
            }
            let seen = sights.iter().flat_map(|sight| {
                let value = |stand| self.value(row, stand, sight, measured);
                scene.stands(unit).iter().map(value)
            });
            values[at] = seen.fold(0.0, f64::max);
        }
        values
    }

    /// What of the view each unit would refine.
    fn extents(&self, scene: &Scene, footprints: &Footprints) -> Vec<SeenExtent> {
        let rows = scene.pack().rows();
        let mut extents = vec![SeenExtent::default(); rows.len()];
        for footprint in footprints.list() {
            let Some(extent) = extents.get_mut(footprint.unit.0 as usize) else {
                continue;
            };
            let [least, mean] = footprint.eccentricities();
            *extent = SeenExtent {
                area_deg2: footprint.area_deg2(),
                least,
                mean,
            };
        }
        if self.counts == Counted::VisibleError {
            return extents;
        }
        // What a unit needs has lower numbers.
        for (at, row) in rows.iter().enumerate() {
            for need in row.needs.iter().map(|need| need.0 as usize) {
                let above = extents[need];
                let share = area(row) / self.needed_by[need];
                if above.area_deg2 > 0.0 && share > 0.0 {
                    extents[at] = with(extents[at], above, share);
                }
            }
        }
        extents
    }

    /// What a unit is worth in one of its places, through one view, which shows so much of it.
    fn value(
        &self,
        row: &UnitRow,
        stand: &Stand,
        sight: &ViewOfScene,
        measured: Option<SeenExtent>,
    ) -> f64 {
        let extent = measured.unwrap_or_else(|| sight.extent(&stand.sphere));
        if extent.area_deg2 <= 0.0 {
            return 0.0;
        }
        let pixel = stand.error / row.kind.facts().pixels_of_error;
        let ppd = sight.ppd_of(pixel, &stand.sphere);
        let display = sight.display_limit(&stand.sphere);
        let state = sight.glance.state;
        // Half of it about nearer than the mean, half about farther.
        let apart = (extent.mean.0 - extent.least.0) / 2.0;
        let gain = |eccentricity| {
            let place = LookedPlace::at(&self.parameters, Radians(eccentricity), display);
            let of_steps = match row.kind.facts().is_filtered {
                true => &self.of_filtered,
                false => &self.of_sampled,
            };
            let worth = match self.counts {
                Counted::SeenSamples => of_steps.seen_samples(&row.signature, ppd, &place, state),
                Counted::VisibleError => of_steps.gain(&row.signature, ppd, &place, state),
            };
            worth * extent.area_deg2
        };
        (gain(extent.mean.0 - apart) + gain(extent.mean.0 + apart)) / 2.0
    }
}

/// The same for steps that are morphed from what was there: nothing pops. The published model stays
/// as it is.
#[must_use]
pub fn parameters_of_morphs(parameters: &Parameters) -> Parameters {
    match parameters.model {
        Model::Default => Parameters {
            lambda: 0.0,
            lambda_suppressed: 0.0,
            ..parameters.clone()
        },
        Model::Paper => parameters.clone(),
    }
}

/// Visible error that each unit of a scene removes for a viewer, in thresholds times square
/// degrees: by signatures what [`importance`](crate::perception::importance) finds by pictures of
/// levels. `footprints` are those of every unit, measured where it is what would refine a level.
#[must_use]
pub fn visible_errors(scene: &Scene, moment: &Moment, footprints: &Footprints) -> Vec<f64> {
    let mut worth = SceneWorth::new(scene, &Parameters::default());
    worth.counts = Counted::VisibleError;
    worth.see(Measured::Footprints(footprints.clone()));
    let sight = |glance| ViewOfScene::new(&glance, Radians(0.0));
    let sights: Vec<ViewOfScene> = moment.glances().map(sight).collect();
    worth.values(scene, &sights)
}

/// How many decades of worth [`shares_of_worth`] distinguishes.
const DECADES: f64 = 3.0;
/// Share of what refines something that is worth as much as the most or more: slivers at edges are
/// measured too roughly to stand for it.
const MOST: f64 = 0.01;

/// For each unit that refines what is drawn, by its number, what a viewer gains of it in a square
/// degree: 1 where that is the most of all, or as much as in the best hundredth of what they
/// refine, down to 0 where it is a thousandth of that or less, by logarithms. -1 for units that
/// do not refine it. `footprints` are those of what is drawn. Takes some microseconds for each
/// unit.
#[must_use]
pub fn shares_of_worth(
    scene: &Scene,
    parameters: &Parameters,
    moment: &Moment,
    footprints: &Footprints,
) -> Vec<f32> {
    let mut worth = SceneWorth::new(scene, parameters);
    worth.see(Measured::Footprints(footprints.clone()));
    let sight = |glance| ViewOfScene::new(&glance, Radians(0.0));
    let sights: Vec<ViewOfScene> = moment.glances().map(sight).collect();
    let values = worth.values(scene, &sights);
    let density = |footprint: &Footprint| {
        let value = values.get(footprint.unit.0 as usize).copied();
        value.unwrap_or_default() / footprint.area_deg2()
    };
    let mut best: Vec<(f64, f64)> = footprints
        .list()
        .iter()
        .map(|it| (density(it), it.area_deg2()))
        .collect();
    best.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let mut left = MOST * best.iter().map(|it| it.1).sum::<f64>();
    let reached = best.iter().find(|(_, area)| {
        left -= area;
        left <= 0.0
    });
    let most = reached.map_or(0.0, |it| it.0);
    let mut shares = vec![-1.0; values.len()];
    for footprint in footprints.list() {
        let density = density(footprint);
        if let Some(share) = shares.get_mut(footprint.unit.0 as usize) {
            let decades = match density > 0.0 && most > 0.0 {
                true => libm::log10(density / most),
                false => -DECADES,
            };
            *share = (1.0 + decades / DECADES).clamp(0.0, 1.0) as f32;
        }
    }
    shares
}

/// Share of the detail that an eye can see of a scene, hidden or not, that these units show: of
/// what all are worth. 1 where none is worth anything. Takes some microseconds for each unit.
#[must_use]
pub fn detail_share(scene: &Scene, moment: &Moment, shows: impl Fn(UnitId) -> bool) -> f64 {
    let worth = SceneWorth::new(scene, &Parameters::default());
    let sight = |glance| ViewOfScene::new(&glance, Radians(0.0));
    let sights: Vec<ViewOfScene> = moment.glances().map(sight).collect();
    let values = worth.values(scene, &sights);
    let all: f64 = values.iter().sum();
    let units = (0..).map(UnitId).zip(&values);
    let shown: f64 = units.filter(|(unit, _)| shows(*unit)).map(|it| it.1).sum();
    if all > 0.0 { shown / all } else { 1.0 }
}

/// An extent and a share of another.
fn with(extent: SeenExtent, other: SeenExtent, share: f64) -> SeenExtent {
    let added = share * other.area_deg2;
    let area_deg2 = extent.area_deg2 + added;
    let mean = (extent.mean.0 * extent.area_deg2 + other.mean.0 * added) / area_deg2;
    let least = match extent.area_deg2 > 0.0 {
        true => extent.least.0.min(other.least.0),
        false => other.least.0,
    };
    SeenExtent {
        area_deg2,
        least: Radians(least),
        mean: Radians(mean),
    }
}

/// Area of a disc of a unit's sphere.
fn area(row: &UnitRow) -> f64 {
    let radius = f64::from(row.radius);
    core::f64::consts::PI * radius * radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::scene::scripted::scripted_scene;
    use crate::gaze::sample::GazeSample;
    use crate::perception::glance::Glance;
    use crate::perception::parameters::EyeState;
    use crate::units::Seconds;
    use crate::view::axes::Axes;
    use crate::view::eye_view::{EyeView, Field};
    use glam::DVec3;

    fn sight(scene: &Scene) -> ViewOfScene {
        let bounds = scene.bounds();
        let view = EyeView {
            position: bounds.centre + DVec3::Z * 2.0 * bounds.radius,
            axes: Axes::FRONT,
            field: Field::symmetric([1.0, 0.6]),
            size: [1000, 600],
            eye: Default::default(),
        };
        let glance = Glance {
            gaze: GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0)),
            view: Some(view),
            state: EyeState::Steady,
        };
        ViewOfScene::new(&glance, Radians(0.1))
    }

    fn footprint(unit: u32, least: u32) -> Footprint {
        Footprint {
            unit: UnitId(unit),
            area: 2048,
            least,
            mean: least + 8,
        }
    }

    #[test]
    fn what_nothing_shows_is_worth_nothing_and_what_is_near_the_gaze_is_worth_more() {
        let scene = scripted_scene().unwrap();
        let mut worth = SceneWorth::new(&scene, &Parameters::default());
        // Detail of several cycles a degree.
        let last = scene.pack().len() - 1;
        let of = |worth: &SceneWorth| worth.values(&scene, &[sight(&scene)]);
        assert!(of(&worth).iter().any(|it| *it > 0.0));
        worth.see(Measured::default());
        assert!(of(&worth).iter().all(|it| *it == 0.0));
        let mut at = |least| {
            worth.see(Measured::Footprints(Footprints::new(vec![footprint(
                last as u32,
                least,
            )])));
            of(&worth)[last]
        };
        let found = [0, 320, 640].map(&mut at);
        assert!(found.is_sorted_by(|a, b| a > b), "{found:?}");
    }

    #[test]
    fn of_what_is_drawn_the_worth_is_told_for_each_square_degree_and_most_near_the_gaze() {
        let scene = scripted_scene().unwrap();
        let units = scene.pack().len();
        let bounds = scene.bounds();
        let size = [1000, 600];
        let view = EyeView {
            position: bounds.centre + DVec3::Z * 2.0 * bounds.radius,
            axes: Axes::FRONT,
            field: Field::symmetric([1.0, 0.6]),
            size,
            eye: Default::default(),
        };
        let gaze = GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0));
        let moment = Moment::new(gaze, vec![view]);
        let last = units as u32 - 1;
        let shares = |footprints: Vec<Footprint>| {
            let seen = Footprints::new(footprints);
            shares_of_worth(&scene, &Parameters::default(), &moment, &seen)
        };
        let none = shares(Vec::new());
        assert!(none.len() == units && none.iter().all(|it| *it == -1.0));
        let [near, far] = [footprint(last, 0), footprint(last - 1, 500)];
        let both = shares(vec![far, near]);
        let [of_far, of_near] = [units - 2, units - 1].map(|at| both[at]);
        assert!(
            of_near == 1.0 && (0.0..0.9).contains(&of_far),
            "{of_near} {of_far}"
        );
        assert_eq!(both.iter().filter(|it| **it >= 0.0).count(), 2);
        // A sliver with a large gain changes nothing next to it.
        let sliver = Footprint {
            unit: UnitId(last - 2),
            area: 1,
            least: 0,
            mean: 0,
        };
        let beside = shares(vec![far, near, sliver]);
        assert!(beside[units - 2] == of_far && beside[units - 1] == of_near);
        // Of a larger part of the view no more is gained in a square degree.
        let wide = Footprint {
            area: 8 * far.area,
            ..far
        };
        let other = shares(vec![wide, near]);
        assert!((other[units - 2] - of_far).abs() < 1e-6);
    }

    #[test]
    fn units_that_refine_what_is_not_drawn_share_what_it_would_refine() {
        let scene = scripted_scene().unwrap();
        let worth = SceneWorth::new(&scene, &Parameters::default());
        let rows = scene.pack().rows();
        let first = rows.iter().position(|row| !row.needs.is_empty()).unwrap();
        let seen = Footprints::new(vec![footprint(first as u32, 16)]);
        let extents = worth.extents(&scene, &seen);
        let needs_first = |row: &&UnitRow| row.needs == [UnitId(first as u32)];
        let children = rows
            .iter()
            .zip(&extents)
            .filter(|(row, _)| needs_first(row));
        let shares: f64 = children.map(|(_, extent)| extent.area_deg2).sum();
        assert!((shares - extents[first].area_deg2).abs() < 1e-9, "{shares}");
    }
}
