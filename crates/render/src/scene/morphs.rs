//! Which units are on their way to their places, and since when?
//!
//! What a viewer would see change comes from the coarse surface in a fifth of a second; all else is
//! shown at once, and so is what is on its way when the eye jumps or closes.

use foveal_core::content::demand::Content;
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::showing::VisibleSteps;
use foveal_core::pack::unit::UnitId;
use foveal_core::units::Seconds;
use std::collections::BTreeMap;

/// How long a unit is on its way.
const WAY: Seconds = Seconds(0.2);
/// Most units that are on their way at once: some milliseconds a picture on one core.
const MOST: usize = 1024;

/// Units on their way to their places.
#[derive(Debug, Default)]
pub(crate) struct Morphs {
    begun: BTreeMap<UnitId, Seconds>,
    /// When the first unit came.
    first: Option<Seconds>,
}

impl Morphs {
    /// Whether any unit is on its way.
    pub(crate) fn is_any(&self) -> bool {
        !self.begun.is_empty()
    }

    /// A unit comes: on its way from `now` on, where the viewer sees that and there was a picture
    /// before, and where what it needs is on its way. Where too many are, all arrive.
    pub(crate) fn begin(
        &mut self,
        scene: &Scene,
        unit: UnitId,
        witness: &VisibleSteps,
        now: Seconds,
    ) {
        self.begun.remove(&unit);
        let is_first = *self.first.get_or_insert(now) == now;
        let is_root = scene.needs(unit).is_empty();
        if is_first || is_root {
            return;
        }
        let needs = scene.needs(unit);
        let is_on_moving = needs.iter().any(|need| self.begun.contains_key(need));
        if is_on_moving || witness.sees(scene, unit) {
            self.begun.insert(unit, now);
        }
        if self.begun.len() > MOST {
            self.begun.clear();
        }
    }

    /// Lets those arrive whose time is over at `now`, and all where the viewer does not see it.
    pub(crate) fn advance(&mut self, witness: &VisibleSteps, now: Seconds) {
        let is_under_way = |begun: &Seconds| now.0 - begun.0 < WAY.0;
        self.begun
            .retain(|_, begun| !witness.is_blind() && is_under_way(begun));
    }

    /// How much of its way each has gone at `now`, 0 to 1.
    pub(crate) fn shares(&self, now: Seconds) -> BTreeMap<UnitId, f64> {
        let share = |begun: &Seconds| ((now.0 - begun.0) / WAY.0).clamp(0.0, 1.0);
        let begun = self.begun.iter();
        begun.map(|(unit, begun)| (*unit, share(begun))).collect()
    }
}
