//! How many odd edges has what is drawn, as units come?
//!
//! The border of a cluster is the set of its odd edges; what several clusters have together is the
//! symmetric difference of their borders. So a cluster that appears or goes turns the parity of
//! its border alone.

use super::edges::{Place, edge, has_area};
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::MeshVertex;
use foveal_core::content::scene::unit_table::UnitRow;
use std::collections::HashMap;

/// The borders of all clusters of a scene.
pub(super) struct Chains {
    /// For each unit its clusters.
    units: Vec<Vec<Chain>>,
    /// For each unit the clusters that it is shown in place of, by unit and number.
    replaces: Vec<Vec<(usize, usize)>>,
    /// The numbers of edges, by object and places.
    edges: HashMap<(u16, [Place; 2]), u32>,
}

/// The border of a cluster.
struct Chain {
    /// Its odd edges, by number.
    edges: Vec<u32>,
    /// The unit that refines it.
    refined_by: Option<usize>,
}

impl Chains {
    /// The borders of the clusters of a cut with all units.
    pub(super) fn new(cut: &MeshCut, rows: &[(u8, UnitRow)]) -> Self {
        let mut numbers = HashMap::new();
        let mut replaces = vec![Vec::new(); rows.len()];
        let mut units = Vec::with_capacity(rows.len());
        for ((unit, placed), (_, row)) in cut.units().zip(rows) {
            let of_unit = placed.clusters.iter().enumerate().map(|(cluster, it)| {
                let refined_by = it.refined_by.map(|by| by.0 as usize);
                if let Some(by) = refined_by {
                    replaces[by].push((unit.0 as usize, cluster));
                }
                let border = border(placed.triangles(cluster)).into_iter();
                let edges = border.map(|edge| {
                    let next = numbers.len() as u32;
                    *numbers.entry((row.object, edge)).or_insert(next)
                });
                Chain {
                    edges: edges.collect(),
                    refined_by,
                }
            });
            units.push(of_unit.collect());
        }
        Self {
            units,
            replaces,
            edges: numbers,
        }
    }

    /// Number of units.
    pub(super) fn units(&self) -> usize {
        self.units.len()
    }
}

/// The odd edges of triangles.
pub(super) fn border(triangles: impl Iterator<Item = [MeshVertex; 3]>) -> Vec<[Place; 2]> {
    let triangles = triangles
        .map(|it| it.map(|vertex| vertex.place))
        .filter(has_area);
    let edges = triangles.flat_map(|[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]);
    let mut edges: Vec<_> = edges.collect();
    edges.sort_unstable();
    let runs = edges.chunk_by(|a, b| a == b);
    let odd = runs.filter(|run| run.len() % 2 == 1);
    odd.map(|run| run[0]).collect()
}

/// Some units, and the parity of each edge of what is drawn of them.
pub(super) struct Parity<'a> {
    chains: &'a Chains,
    is_there: Vec<bool>,
    is_odd: Vec<bool>,
    odd: u64,
}

impl<'a> Parity<'a> {
    /// No unit is there.
    pub(super) fn new(chains: &'a Chains) -> Self {
        Self {
            chains,
            is_there: vec![false; chains.units.len()],
            is_odd: vec![false; chains.edges.len()],
            odd: 0,
        }
    }

    /// A unit that is not there comes.
    pub(super) fn insert(&mut self, unit: usize) {
        let chains = self.chains;
        for chain in &chains.units[unit] {
            if chain.refined_by.is_none_or(|by| !self.is_there[by]) {
                self.turn(chain);
            }
        }
        for (need, cluster) in &chains.replaces[unit] {
            if self.is_there[*need] {
                self.turn(&chains.units[*need][*cluster]);
            }
        }
        self.is_there[unit] = true;
    }

    fn turn(&mut self, chain: &Chain) {
        for edge in &chain.edges {
            let is_odd = &mut self.is_odd[*edge as usize];
            *is_odd = !*is_odd;
            match *is_odd {
                true => self.odd += 1,
                false => self.odd -= 1,
            }
        }
    }

    /// Whether a unit is there.
    pub(super) fn is_there(&self, unit: usize) -> bool {
        self.is_there[unit]
    }

    /// Whether a cluster is drawn.
    pub(super) fn is_drawn(&self, unit: usize, cluster: usize) -> bool {
        let refined_by = self.chains.units[unit][cluster].refined_by;
        self.is_there[unit] && refined_by.is_none_or(|by| !self.is_there[by])
    }

    /// Whether an edge of an object is odd.
    pub(super) fn is_odd(&self, edge: &(u16, [Place; 2])) -> bool {
        let number = self.chains.edges.get(edge);
        number.is_some_and(|it| self.is_odd[*it as usize])
    }

    /// Number of odd edges.
    pub(super) fn odd(&self) -> u64 {
        self.odd
    }

    /// Number of levels of which clusters are drawn.
    pub(super) fn levels(&self, rows: &[(u8, UnitRow)]) -> u32 {
        let mut levels = [false; 256];
        for (unit, (level, _)) in rows.iter().enumerate() {
            let clusters = 0..self.chains.units[unit].len();
            let is_drawn = clusters.into_iter().any(|it| self.is_drawn(unit, it));
            levels[usize::from(*level)] |= is_drawn;
        }
        levels.iter().map(|it| u32::from(*it)).sum()
    }
}
