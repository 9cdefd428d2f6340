//! Which units of clouds are there, and which must stay?

use crate::error::RenderError;
use crate::idle::IdleUnits;
use crate::scene::coming::{Coming, Refiners};
use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::points::cut::{PlacedPoints, PointCut};
use foveal_core::content::points::payload::PointUnit;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// What is known of a unit that is there, besides its points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CloudNote {
    /// Number of its object.
    pub(crate) object: u16,
    /// Its level, 0 the finest.
    pub(crate) level: u8,
}

/// The units of clouds that are there.
#[derive(Default)]
pub(crate) struct CloudUnits {
    clouds: Vec<Option<Cloud>>,
    cut: PointCut,
    notes: BTreeMap<UnitId, CloudNote>,
    refiners: Arc<Refiners>,
    coarsest: u8,
    /// Which are not drawn and stay, and these.
    pub(crate) idle: IdleUnits<UnitId>,
    hidden: BTreeMap<UnitId, (CloudNote, PlacedPoints)>,
}

impl CloudUnits {
    /// No unit of these objects.
    pub(crate) fn new(objects: &[SceneObject]) -> Self {
        Self {
            clouds: objects.iter().map(|it| it.shape.cloud().copied()).collect(),
            ..Self::default()
        }
    }

    /// Adds a unit; `false` where it was there already.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub(crate) fn insert(
        &mut self,
        coming: &Coming<'_>,
        payload: &PointUnit,
    ) -> Result<bool, RenderError> {
        let Coming { unit, object, .. } = *coming;
        let refines = coming.needs.first().copied().zip(coming.part);
        if self.notes.contains_key(&unit) {
            return Ok(false);
        }
        let misfit = |what: &str, found: String, expected: &str| RenderError::Misfit {
            what: format!("unit {}, {what}", unit.0),
            expected: expected.to_owned(),
            found,
        };
        let cloud = self.clouds.get(usize::from(object)).copied().flatten();
        let cloud = cloud.ok_or_else(|| misfit("object", object.to_string(), "a cloud"))?;
        if let Some((parent, _)) = refines {
            let there = self.notes.get(&parent);
            if there.is_none_or(|it| it.object != object) || parent >= unit {
                let expected = "an earlier unit of the same object that is there";
                return Err(misfit("prerequisite", parent.0.to_string(), expected));
            }
        }
        self.cut.insert(unit, refines, payload, &cloud)?;
        let note = CloudNote {
            object,
            level: coming.level,
        };
        self.notes.insert(unit, note);
        self.coarsest = self.coarsest.max(coming.level);
        Ok(true)
    }

    /// Takes a unit away that is drawn; returns the one whose colours changed by that.
    ///
    /// # Panics
    /// No other that is drawn may need it.
    pub(crate) fn remove(&mut self, unit: UnitId) -> Option<UnitId> {
        self.take(unit)?.1.parent()
    }

    fn take(&mut self, unit: UnitId) -> Option<(CloudNote, PlacedPoints)> {
        let there = self.cut.unit(unit)?;
        let is_needed = there.refined_by.iter().any(Option::is_some);
        assert!(!is_needed, "unit {} is still needed by others", unit.0);
        Some((self.notes.remove(&unit)?, self.cut.remove(unit)?))
    }

    /// Keeps a unit without drawing it; returns the one whose colours changed by that.
    pub(crate) fn hide(&mut self, unit: UnitId) -> Option<UnitId> {
        let (note, placed) = self.take(unit)?;
        let parent = placed.parent();
        self.hidden.insert(unit, (note, placed));
        parent
    }

    /// Draws a unit again that stayed; `false` where it did not.
    pub(crate) fn show(&mut self, unit: UnitId) -> bool {
        let Some((note, placed)) = self.hidden.remove(&unit) else {
            return false;
        };
        self.idle.remove(unit);
        self.notes.insert(unit, note);
        self.cut.put_back(unit, placed);
        true
    }

    /// From now on these stay, of those that are not drawn, first what is to stay longest. Returns
    /// the others, which are gone.
    pub(crate) fn set_idle(&mut self, staying: &[UnitId]) -> Vec<UnitId> {
        let stay: HashSet<UnitId> = staying.iter().copied().collect();
        let leave = self.hidden.keys().filter(|unit| !stay.contains(*unit));
        let leave: Vec<UnitId> = leave.copied().collect();
        leave.iter().for_each(|unit| drop(self.hidden.remove(unit)));
        let staying = staying.iter().copied();
        let order = staying.filter(|unit| self.hidden.contains_key(unit));
        self.idle.set(order.collect());
        leave
    }

    /// The next unit that stayed and gives way.
    pub(crate) fn give_way(&mut self) -> Option<UnitId> {
        let unit = self.idle.give_way()?;
        self.hidden.remove(&unit);
        Some(unit)
    }

    /// A unit that stays without being drawn.
    pub(crate) fn hidden(&self, unit: UnitId) -> Option<(CloudNote, &PlacedPoints)> {
        let (note, placed) = self.hidden.get(&unit)?;
        Some((*note, placed))
    }

    /// Which are to go so that only those stay that are wanted, what these need, and roots: each
    /// before what it refines.
    pub(crate) fn to_go(&self, wanted: &HashSet<UnitId>) -> Vec<UnitId> {
        let mut stays = HashSet::new();
        let mut gone = Vec::new();
        let there: Vec<_> = self.all().collect();
        for (unit, _, placed) in there.into_iter().rev() {
            // Those that need it have higher numbers.
            let parent = placed.parent();
            if parent.is_none() || stays.contains(&unit) || wanted.contains(&unit) {
                stays.extend(parent);
            } else {
                gone.push(unit);
            }
        }
        gone
    }

    /// From now on these are the units that would refine octants of others.
    pub(crate) fn set_refiners(&mut self, refiners: &Arc<Refiners>) {
        self.refiners = Arc::clone(refiners);
    }

    /// The unit that would refine an octant of another.
    pub(crate) fn refiner(&self, unit: UnitId, octant: u8) -> Option<UnitId> {
        self.refiners.get(&(unit, octant)).copied()
    }

    /// The cloud of an object.
    pub(crate) fn cloud(&self, object: u16) -> Option<&Cloud> {
        self.clouds.get(usize::from(object))?.as_ref()
    }

    /// The coarsest level that was ever there.
    pub(crate) fn coarsest(&self) -> u8 {
        self.coarsest
    }

    /// The units that are there, in order.
    pub(crate) fn all(
        &self,
    ) -> impl DoubleEndedIterator<Item = (UnitId, CloudNote, &PlacedPoints)> {
        let noted = |(unit, note): (&UnitId, &CloudNote)| {
            self.cut.unit(*unit).map(|placed| (*unit, *note, placed))
        };
        self.notes.iter().filter_map(noted)
    }

    /// A unit that is there.
    pub(crate) fn unit(&self, unit: UnitId) -> Option<(CloudNote, &PlacedPoints)> {
        Some((*self.notes.get(&unit)?, self.cut.unit(unit)?))
    }
}
