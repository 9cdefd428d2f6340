//! Which clusters of the units at hand are drawn, so that no hole and no crack shows?
//!
//! A cluster is drawn where its unit is there and the unit that refines it is not. No neighbour is
//! asked: whatever set of units is there, as long as each comes after its prerequisites, the
//! surface is as closed as its source. For the border of a group never moves when the group is
//! refined (Karis et al. 2021, "A deep dive into Nanite virtualized geometry").

use crate::content::mesh::morph::{Foot, feet};
use crate::content::mesh::payload::{MeshUnit, MeshVertex};
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

#[cfg(test)]
mod tests;

/// A cluster of a unit that is there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlacedCluster {
    /// The vertices by number in the unit.
    pub vertices: Vec<u16>,
    /// Triangles, by place in `vertices`.
    pub triangles: Vec<[u8; 3]>,
    /// The unit that refines it and is there: it is not drawn then.
    pub refined_by: Option<UnitId>,
}

/// The unit that a vertex came with, and its number among those that did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexOrigin {
    /// The unit.
    pub unit: UnitId,
    /// The number, from 0.
    pub number: u16,
}

/// A unit with all its vertices.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlacedUnit {
    /// The vertices that stay, then the new ones, each in its place.
    pub vertices: Vec<MeshVertex>,
    /// Number of vertices that stay.
    pub staying: u16,
    /// Which units those that stay came with.
    pub origins: Vec<VertexOrigin>,
    /// Its clusters.
    pub clusters: Vec<PlacedCluster>,
    /// Which clusters it is shown in place of.
    replaces: Vec<(UnitId, u8)>,
    /// Whether a new vertex is at the place of one that stays, as where attributes jump.
    stands_twice: bool,
}

/// The units of meshes that are there, and what of them is drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshCut {
    units: BTreeMap<UnitId, PlacedUnit>,
    /// Units whose new vertices are on their way.
    moving: BTreeMap<UnitId, Moving>,
}

/// The new vertices of a unit on their way.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Moving {
    feet: Vec<Option<Foot>>,
    /// As they are now.
    now: Vec<MeshVertex>,
}

impl MeshCut {
    /// Adds a unit that comes after its prerequisites `needs`.
    ///
    /// # Errors
    /// A prerequisite is not there, or the unit does not fit to them: nothing changed then.
    pub fn insert(
        &mut self,
        unit: UnitId,
        needs: &[UnitId],
        payload: &MeshUnit,
    ) -> Result<&PlacedUnit, PackError> {
        let placed = self.place(unit, needs, payload)?;
        Ok(self.put_back(unit, placed))
    }

    /// Adds what [`Self::remove`] took away, while all that it needs is there.
    pub fn put_back(&mut self, unit: UnitId, placed: PlacedUnit) -> &PlacedUnit {
        for (need, cluster) in &placed.replaces {
            if let Some(need) = self.units.get_mut(need) {
                need.clusters[usize::from(*cluster)].refined_by = Some(unit);
            }
        }
        self.units.entry(unit).insert_entry(placed).into_mut()
    }

    fn place(
        &self,
        unit: UnitId,
        needs: &[UnitId],
        payload: &MeshUnit,
    ) -> Result<PlacedUnit, PackError> {
        let wrong = |what: &str, found: String, expected: &str| {
            PackError::new(&format!("unit {}, {what}", unit.0), found, expected)
        };
        let mut vertices =
            Vec::with_capacity(usize::from(payload.staying) + payload.vertices.len());
        let mut origins = Vec::with_capacity(usize::from(payload.staying));
        let mut numbers = HashMap::new();
        let mut replaces = Vec::new();
        for replaced in &payload.replaces {
            let need = needs.get(usize::from(replaced.need)).copied();
            let there = need.and_then(|need| self.units.get(&need));
            let cluster = there.and_then(|it| it.clusters.get(usize::from(replaced.part)));
            let (Some(need), Some(there), Some(cluster)) = (need, there, cluster) else {
                let found = format!("cluster {} of {need:?}", replaced.part);
                return Err(wrong("replaces", found, "a cluster that is there"));
            };
            if cluster.refined_by.is_some_and(|by| by != unit) {
                let found = format!("cluster {} of {need:?}", replaced.part);
                return Err(wrong("replaces", found, "one that no other unit replaces"));
            }
            replaces.push((need, replaced.part));
            for number in &cluster.vertices {
                let vertex = there.vertices[usize::from(*number)];
                if numbers.insert(vertex, ()).is_none() {
                    vertices.push(vertex);
                    origins.push(there.origin(need, *number));
                }
            }
        }
        if vertices.len() != usize::from(payload.staying) {
            let expected = "as many as the replaced clusters have";
            return Err(wrong(
                "staying vertices",
                payload.staying.to_string(),
                expected,
            ));
        }
        let places: HashSet<_> = vertices.iter().map(|vertex| vertex.place).collect();
        let stands_twice = payload.vertices.iter().any(|it| places.contains(&it.place));
        vertices.extend(&payload.vertices);
        let clusters = payload.clusters.iter().map(|cluster| PlacedCluster {
            vertices: cluster.vertices.clone(),
            triangles: cluster.triangles.clone(),
            refined_by: None,
        });
        Ok(PlacedUnit {
            vertices,
            staying: payload.staying,
            origins,
            clusters: clusters.collect(),
            replaces,
            stands_twice,
        })
    }

    /// Takes a unit away, which no other that is there needs; what it replaced is drawn again.
    pub fn remove(&mut self, unit: UnitId) -> Option<PlacedUnit> {
        self.moving.remove(&unit);
        let removed = self.units.remove(&unit)?;
        for (need, cluster) in &removed.replaces {
            if let Some(need) = self.units.get_mut(need) {
                need.clusters[usize::from(*cluster)].refined_by = None;
            }
        }
        Some(removed)
    }

    /// A unit that is there.
    #[must_use]
    pub fn unit(&self, unit: UnitId) -> Option<&PlacedUnit> {
        self.units.get(&unit)
    }

    /// The units that are there, in order.
    pub fn units(&self) -> impl Iterator<Item = (UnitId, &PlacedUnit)> {
        self.units.iter().map(|(unit, placed)| (*unit, placed))
    }

    /// The clusters that are drawn, in order: the unit, the unit with its vertices, and the number
    /// of the cluster in it.
    pub fn drawn(&self) -> impl Iterator<Item = (UnitId, &PlacedUnit, usize)> {
        self.units().flat_map(|(unit, placed)| {
            let clusters = placed.clusters.iter().enumerate();
            let drawn = clusters.filter(|(_, cluster)| cluster.refined_by.is_none());
            drawn.map(move |(number, _)| (unit, placed, number))
        })
    }
}

/// Vertices on their way.
impl MeshCut {
    /// From now on the new vertices of these units have gone so much of their way from the coarse
    /// surface, 0 to 1, and all others are in their places, but for those at the place of one that
    /// is on its way. Returns the units of which vertices moved.
    ///
    /// Whatever the shares are, the surface is as closed as it is when all are 1: vertices at one
    /// place move together, and those on the border of a unit's triangles stay.
    ///
    /// Takes some ten microseconds for each unit of a hundred new vertices, and for the first time
    /// some hundred.
    pub fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) -> BTreeSet<UnitId> {
        let mut moved: BTreeSet<UnitId> = self.moving.keys().copied().collect();
        let mut shares = shares.clone();
        // What has arrived goes with what it stands on, where another vertex stands at its place.
        for unit in self.refining(shares.keys().copied()) {
            if self.units.get(&unit).is_some_and(|it| it.stands_twice) {
                shares.entry(unit).or_insert(1.0);
            }
        }
        self.moving.retain(|unit, _| shares.contains_key(unit));
        // Units come after those on which they stand, which have moved by then.
        for (unit, share) in &shares {
            let Some(placed) = self.units.get(unit) else {
                continue;
            };
            let moving = self.moving.remove(unit);
            let feet = moving.map_or_else(|| self.feet(placed), |moving| moving.feet);
            let new = &placed.vertices[usize::from(placed.staying)..];
            let now = new.iter().zip(&feet).map(|(vertex, foot)| match foot {
                Some(foot) => {
                    let corner = |it| self.vertex_now(*unit, placed, it).place;
                    foot.at(foot.corners.map(corner), vertex, *share)
                }
                None => *vertex,
            });
            let now = now.collect();
            moved.insert(*unit);
            self.moving.insert(*unit, Moving { feet, now });
        }
        moved
    }

    /// Where the new vertices of a unit start.
    fn feet(&self, placed: &PlacedUnit) -> Vec<Option<Foot>> {
        let staying = usize::from(placed.staying);
        let numbered = placed.vertices.iter().zip(0..).take(staying);
        let numbers: HashMap<&MeshVertex, u16> = numbered.collect();
        let replaced = placed.replaces.iter();
        let triangles = replaced.filter_map(|(need, cluster)| {
            let need = self.units.get(need)?;
            Some(need.triangles(usize::from(*cluster)))
        });
        let numbered = |triangle: [MeshVertex; 3]| {
            let [a, b, c] = triangle.map(|it| numbers.get(&it).copied());
            Some([a?, b?, c?])
        };
        let coarse: Vec<_> = triangles.flatten().filter_map(numbered).collect();
        feet(&placed.vertices, staying, &coarse)
    }

    /// A vertex of a unit that is there, by its number, as it is now.
    ///
    /// # Panics
    /// There must be such a vertex.
    #[must_use]
    pub fn vertex_now(&self, unit: UnitId, placed: &PlacedUnit, number: u16) -> MeshVertex {
        let VertexOrigin { unit, number: own } = placed.origin(unit, number);
        match self.moving.get(&unit) {
            Some(moving) => moving.now[usize::from(own)],
            None => placed.vertices[usize::from(number)],
        }
    }

    /// The new vertices of a unit as they are now; none of a unit that is not there.
    #[must_use]
    pub fn new_vertices_now(&self, unit: UnitId) -> &[MeshVertex] {
        match (self.moving.get(&unit), self.units.get(&unit)) {
            (Some(moving), _) => &moving.now,
            (None, Some(placed)) => &placed.vertices[usize::from(placed.staying)..],
            (None, None) => &[],
        }
    }

    /// The triangles of a cluster of a unit that is there, by their vertices as they are now.
    ///
    /// # Panics
    /// There must be such a cluster.
    pub fn triangles_now(
        &self,
        unit: UnitId,
        placed: &PlacedUnit,
        cluster: usize,
    ) -> impl Iterator<Item = [MeshVertex; 3]> {
        let cluster = &placed.clusters[cluster];
        let vertex = move |corner: u8| {
            let number = cluster.vertices[usize::from(corner)];
            self.vertex_now(unit, placed, number)
        };
        cluster.triangles.iter().map(move |it| it.map(vertex))
    }

    /// The units of which vertices are on their way, and all that refine these.
    #[must_use]
    pub fn unsteady(&self) -> BTreeSet<UnitId> {
        self.refining(self.moving.keys().copied())
    }

    /// These units, and all that refine them.
    fn refining(&self, units: impl Iterator<Item = UnitId>) -> BTreeSet<UnitId> {
        let mut all = BTreeSet::new();
        let mut next: Vec<UnitId> = units.collect();
        while let Some(unit) = next.pop() {
            if all.insert(unit) {
                let clusters = self.units.get(&unit).map_or(&[][..], |it| &it.clusters);
                next.extend(clusters.iter().filter_map(|cluster| cluster.refined_by));
            }
        }
        all
    }
}

impl PlacedUnit {
    /// Which unit a vertex of this `unit` came with.
    fn origin(&self, unit: UnitId, number: u16) -> VertexOrigin {
        let own = VertexOrigin {
            unit,
            number: number.saturating_sub(self.staying),
        };
        self.origins
            .get(usize::from(number))
            .copied()
            .unwrap_or(own)
    }

    /// The triangles of one of its clusters, by their vertices.
    ///
    /// # Panics
    /// There must be such a cluster.
    pub fn triangles(&self, cluster: usize) -> impl Iterator<Item = [MeshVertex; 3]> {
        let cluster = &self.clusters[cluster];
        let vertex = |corner: u8| {
            let number = cluster.vertices[usize::from(corner)];
            self.vertices[usize::from(number)]
        };
        cluster.triangles.iter().map(move |it| it.map(vertex))
    }
}
