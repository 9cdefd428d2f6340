//! Which units of meshes are there, and which must stay?

use crate::error::RenderError;
use crate::idle::IdleUnits;
use crate::meshes::bounds::{ClusterBounds, bounds_of};
use crate::scene::coming::Coming;
use foveal_core::content::mesh::cut::{MeshCut, PlacedUnit};
use foveal_core::content::mesh::payload::{MeshUnit, MeshVertex};
use foveal_core::pack::unit::UnitId;
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// What is known of a unit that is there, besides its clusters.
#[derive(Clone, Debug)]
pub(crate) struct UnitNote {
    /// Number of its object.
    pub(crate) object: u16,
    /// Its level, 0 the finest.
    pub(crate) level: u8,
    /// Where each of its clusters lies and faces, with all vertices in their places.
    bounds: Vec<ClusterBounds>,
    /// Whether vertices of it may be on their way.
    is_unsteady: bool,
    /// The clusters in whose place it is shown.
    replaces: Vec<(UnitId, u8)>,
    needs: Vec<UnitId>,
    /// How many units that are there need it.
    dependents: u32,
}

impl UnitNote {
    /// Where a cluster lies and faces: anywhere, while vertices are on their way.
    pub(crate) fn bounds(&self, cluster: usize) -> ClusterBounds {
        match self.is_unsteady {
            true => ClusterBounds::ANYWHERE,
            false => self.bounds[cluster],
        }
    }
}

/// What is otherwise since vertices moved.
#[derive(Debug, Default)]
pub(crate) struct Moved {
    /// Units of which new vertices are elsewhere.
    pub(crate) vertices: BTreeSet<UnitId>,
    /// Units whose bounds are others.
    pub(crate) bounds: Vec<UnitId>,
}

/// A cluster that is drawn.
#[derive(Clone, Copy)]
pub(crate) struct DrawnCluster<'a> {
    pub(crate) unit: UnitId,
    /// Its number in the unit.
    pub(crate) cluster: usize,
    pub(crate) note: &'a UnitNote,
    pub(crate) placed: &'a PlacedUnit,
    cut: &'a MeshCut,
}

impl DrawnCluster<'_> {
    /// A vertex as it is now, by its number in the cluster.
    pub(crate) fn vertex_now(&self, number: u32) -> MeshVertex {
        let vertices = &self.placed.clusters[self.cluster].vertices;
        let number = vertices[number as usize];
        self.cut.vertex_now(self.unit, self.placed, number)
    }
}

/// The units that are there.
#[derive(Default)]
pub(crate) struct MeshUnits {
    objects: usize,
    cut: MeshCut,
    notes: BTreeMap<UnitId, UnitNote>,
    /// Those of which vertices may be on their way.
    unsteady: BTreeSet<UnitId>,
    coarsest: u8,
    /// Which are not drawn and stay, and these.
    pub(crate) idle: IdleUnits<UnitId>,
    hidden: BTreeMap<UnitId, (UnitNote, PlacedUnit)>,
}

/// What became of units that are not to be drawn.
#[derive(Debug, Default)]
pub(crate) struct Undrawn {
    /// They stay.
    pub(crate) hidden: Vec<UnitId>,
    /// They are gone.
    pub(crate) gone: Vec<UnitId>,
}

impl MeshUnits {
    /// No unit of a scene of so many objects.
    pub(crate) fn new(objects: usize) -> Self {
        Self {
            objects,
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
        payload: &MeshUnit,
    ) -> Result<bool, RenderError> {
        let Coming { unit, needs, .. } = *coming;
        if self.notes.contains_key(&unit) {
            return Ok(false);
        }
        self.check(coming)?;
        let placed = self.cut.insert(unit, needs, payload)?;
        let named = payload.replaces.iter();
        let replaces = named.map(|it| (needs[usize::from(it.need)], it.part));
        let note = UnitNote {
            object: coming.object,
            level: coming.level,
            bounds: bounds_of(placed),
            is_unsteady: needs.iter().any(|need| self.unsteady.contains(need)),
            replaces: replaces.collect(),
            needs: needs.to_vec(),
            dependents: 0,
        };
        if note.is_unsteady {
            self.unsteady.insert(unit);
        }
        self.notes.insert(unit, note);
        self.coarsest = self.coarsest.max(coming.level);
        self.count(needs, |dependents| dependents + 1);
        Ok(true)
    }

    fn check(&self, coming: &Coming<'_>) -> Result<(), RenderError> {
        let misfit = |what: &str, found: String, expected: String| RenderError::Misfit {
            what: format!("unit {}, {what}", coming.unit.0),
            expected,
            found,
        };
        let object = usize::from(coming.object);
        if object >= self.objects {
            let expected = format!("less than {}", self.objects);
            return Err(misfit("object", object.to_string(), expected));
        }
        let fits = |need: &UnitId| {
            let note = self.notes.get(need);
            *need < coming.unit && note.is_some_and(|it| it.object == coming.object)
        };
        match coming.needs.iter().find(|need| !fits(need)) {
            None => Ok(()),
            Some(need) => {
                let expected = "an earlier unit of the same object that is there".to_owned();
                Err(misfit("prerequisite", need.0.to_string(), expected))
            }
        }
    }

    fn count(&mut self, needs: &[UnitId], change: impl Fn(u32) -> u32) {
        for need in needs {
            if let Some(note) = self.notes.get_mut(need) {
                note.dependents = change(note.dependents);
            }
        }
    }

    /// Takes a unit away that is drawn; `false` where it was not there.
    ///
    /// # Panics
    /// No other that is drawn may need it.
    pub(crate) fn remove(&mut self, unit: UnitId) -> bool {
        self.take(unit).is_some()
    }

    fn take(&mut self, unit: UnitId) -> Option<(UnitNote, PlacedUnit)> {
        let note = self.notes.remove(&unit)?;
        let dependents = note.dependents;
        assert_eq!(dependents, 0, "unit {} is still needed by others", unit.0);
        let placed = self.cut.remove(unit)?;
        self.unsteady.remove(&unit);
        self.count(&note.needs, |dependents| dependents - 1);
        Some((note, placed))
    }

    /// Draws only units that are wanted, what these need, and roots. Of the others those that are
    /// `staying` are kept, first what is to stay longest, each after those that it needs.
    pub(crate) fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) -> Undrawn {
        let mut undrawn = Undrawn::default();
        let stay: HashSet<UnitId> = staying.iter().copied().collect();
        let there: Vec<UnitId> = self.notes.keys().rev().copied().collect();
        for unit in there {
            // Those that need it have higher numbers: they are gone by now or stay.
            let note = &self.notes[&unit];
            if note.dependents > 0 || note.replaces.is_empty() || wanted.contains(&unit) {
                continue;
            }
            let taken = self.take(unit);
            match stay.contains(&unit) {
                true => {
                    self.hidden.extend(taken.map(|taken| (unit, taken)));
                    undrawn.hidden.push(unit);
                }
                false => undrawn.gone.push(unit),
            }
        }
        let leave = self.hidden.keys().filter(|unit| !stay.contains(*unit));
        let leave: Vec<UnitId> = leave.copied().collect();
        leave.iter().for_each(|unit| drop(self.hidden.remove(unit)));
        undrawn.gone.extend(leave);
        let staying = staying.iter().copied();
        let order = staying.filter(|unit| self.hidden.contains_key(unit));
        self.idle.set(order.collect());
        undrawn
    }

    /// Draws a unit again that stayed; `false` where it did not.
    pub(crate) fn show(&mut self, unit: UnitId) -> bool {
        let Some((note, placed)) = self.hidden.remove(&unit) else {
            return false;
        };
        self.idle.remove(unit);
        let note = UnitNote {
            is_unsteady: note.needs.iter().any(|it| self.unsteady.contains(it)),
            ..note
        };
        if note.is_unsteady {
            self.unsteady.insert(unit);
        }
        self.count(&note.needs, |dependents| dependents + 1);
        self.notes.insert(unit, note);
        self.cut.put_back(unit, placed);
        true
    }

    /// The next unit that stayed and gives way.
    pub(crate) fn give_way(&mut self) -> Option<UnitId> {
        let unit = self.idle.give_way()?;
        self.hidden.remove(&unit);
        Some(unit)
    }

    /// From now on the new vertices of these units have gone so much of their way from the coarse
    /// surface, 0 to 1, and all others are in their places.
    pub(crate) fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) -> Moved {
        let vertices = self.cut.morph(shares);
        let unsteady = self.cut.unsteady();
        let before = std::mem::replace(&mut self.unsteady, unsteady);
        let bounds: Vec<UnitId> = before
            .symmetric_difference(&self.unsteady)
            .copied()
            .collect();
        for unit in &bounds {
            if let Some(note) = self.notes.get_mut(unit) {
                note.is_unsteady = self.unsteady.contains(unit);
            }
        }
        Moved { vertices, bounds }
    }

    /// The new vertices of a unit as they are now, in their places where it is not drawn.
    pub(crate) fn new_vertices_now(&self, unit: UnitId) -> &[MeshVertex] {
        match self.hidden.get(&unit) {
            Some((_, placed)) => &placed.vertices[usize::from(placed.staying)..],
            None => self.cut.new_vertices_now(unit),
        }
    }

    /// The coarsest level that was ever there.
    pub(crate) fn coarsest(&self) -> u8 {
        self.coarsest
    }

    /// The units that are drawn, then those that are not, each after those that it needs: what is
    /// known of each, and its clusters.
    pub(crate) fn all(&self) -> impl Iterator<Item = (UnitId, &UnitNote, &PlacedUnit)> {
        let noted = |(unit, placed)| self.notes.get(&unit).map(|note| (unit, note, placed));
        let hidden = self.hidden.iter();
        let hidden = hidden.map(|(unit, (note, placed))| (*unit, note, placed));
        self.cut.units().filter_map(noted).chain(hidden)
    }

    /// Whether a unit is there and drawn.
    pub(crate) fn is_drawn(&self, unit: UnitId) -> bool {
        self.notes.contains_key(&unit)
    }

    /// The clusters of a unit that is there, drawn or not.
    pub(crate) fn unit(&self, unit: UnitId) -> Option<(&UnitNote, &PlacedUnit)> {
        if let Some((note, placed)) = self.hidden.get(&unit) {
            return Some((note, placed));
        }
        Some((self.notes.get(&unit)?, self.cut.unit(unit)?))
    }

    /// The clusters that are drawn, in order.
    pub(crate) fn drawn(&self) -> impl Iterator<Item = DrawnCluster<'_>> {
        let noted = |(unit, placed, cluster)| {
            self.notes.get(&unit).map(|note| DrawnCluster {
                unit,
                cluster,
                note,
                placed,
                cut: &self.cut,
            })
        };
        self.cut.drawn().filter_map(noted)
    }
}
