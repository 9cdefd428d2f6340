//! Which clusters of the units at hand are drawn, so that no hole and no crack shows?
//!
//! A cluster is drawn where its unit is there and the unit that refines it is not. No neighbour is
//! asked: whatever set of units is there, as long as each comes after its prerequisites, the
//! surface is as closed as its source. For the border of a group never moves when the group is
//! refined (Karis et al. 2021, "A deep dive into Nanite virtualized geometry").

use crate::content::mesh::payload::{MeshUnit, MeshVertex};
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use std::collections::{BTreeMap, HashMap};

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

/// A unit with all its vertices.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlacedUnit {
    /// The vertices that stay, then the new ones.
    pub vertices: Vec<MeshVertex>,
    /// Number of vertices that stay.
    pub staying: u16,
    /// Its clusters.
    pub clusters: Vec<PlacedCluster>,
    /// Which clusters it is shown in place of.
    replaces: Vec<(UnitId, u8)>,
}

/// The units of meshes that are there, and what of them is drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshCut {
    units: BTreeMap<UnitId, PlacedUnit>,
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
        says: &MeshUnit,
    ) -> Result<&PlacedUnit, PackError> {
        let placed = self.place(unit, needs, says)?;
        for (need, cluster) in &placed.replaces {
            if let Some(need) = self.units.get_mut(need) {
                need.clusters[usize::from(*cluster)].refined_by = Some(unit);
            }
        }
        Ok(self.units.entry(unit).insert_entry(placed).into_mut())
    }

    fn place(
        &self,
        unit: UnitId,
        needs: &[UnitId],
        says: &MeshUnit,
    ) -> Result<PlacedUnit, PackError> {
        let wrong = |what: &str, found: String, expected: &str| {
            PackError::new(&format!("unit {}, {what}", unit.0), found, expected)
        };
        let mut vertices = Vec::with_capacity(usize::from(says.staying) + says.vertices.len());
        let mut numbers = HashMap::new();
        let mut replaces = Vec::new();
        for replaced in &says.replaces {
            let need = needs.get(usize::from(replaced.need)).copied();
            let there = need.and_then(|need| self.units.get(&need));
            let cluster = there.and_then(|it| it.clusters.get(usize::from(replaced.cluster)));
            let (Some(need), Some(there), Some(cluster)) = (need, there, cluster) else {
                let found = format!("cluster {} of {need:?}", replaced.cluster);
                return Err(wrong("replaces", found, "a cluster that is there"));
            };
            if cluster.refined_by.is_some_and(|by| by != unit) {
                let found = format!("cluster {} of {need:?}", replaced.cluster);
                return Err(wrong("replaces", found, "one that no other unit replaces"));
            }
            replaces.push((need, replaced.cluster));
            for vertex in &cluster.vertices {
                let vertex = there.vertices[usize::from(*vertex)];
                if numbers.insert(vertex, ()).is_none() {
                    vertices.push(vertex);
                }
            }
        }
        if vertices.len() != usize::from(says.staying) {
            let expected = "as many as the replaced clusters have";
            return Err(wrong(
                "staying vertices",
                says.staying.to_string(),
                expected,
            ));
        }
        vertices.extend(&says.vertices);
        let clusters = says.clusters.iter().map(|cluster| PlacedCluster {
            vertices: cluster.vertices.clone(),
            triangles: cluster.triangles.clone(),
            refined_by: None,
        });
        Ok(PlacedUnit {
            vertices,
            staying: says.staying,
            clusters: clusters.collect(),
            replaces,
        })
    }

    /// Takes a unit away, which no other that is there needs; what it replaced is drawn again.
    pub fn remove(&mut self, unit: UnitId) {
        let removed = self.units.remove(&unit);
        for (need, cluster) in removed.into_iter().flat_map(|it| it.replaces) {
            if let Some(need) = self.units.get_mut(&need) {
                need.clusters[usize::from(cluster)].refined_by = None;
            }
        }
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

impl PlacedUnit {
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
