//! Is the surface closed, whichever units are there?
//!
//! By parity: a collapse of an edge keeps the parity of how many triangles have each edge, and so
//! does whatever cut of units whose borders fit. Where they do not, edges have a triangle on one
//! side only.

mod edges;
mod eyes;
mod morphing;
mod parity;
#[cfg(test)]
mod tests;

pub use edges::odd_edges;
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::MeshUnit;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::random::Random;
use morphing::{odd_while_moving, random_shares};
use parity::{Chains, Parity};

/// How often a foveated cut with fewer than three levels is tried again by another eye.
const TRIES: u32 = 32;

/// Which cuts are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutTrial {
    /// Number of foveated cuts, each by another eye; each is checked as it stands, and while some
    /// of its units come from the surface that they are shown in place of.
    pub cuts: u32,
    /// Number of random orders of arrival, each checked after every unit once all roots are there.
    pub orders: u32,
    /// What the eyes and orders are drawn from.
    pub seed: u64,
    /// The negative control: random sets and orders of units without their prerequisites, which
    /// must show cracks. A cluster of a unit that is there is drawn unless the unit that refines
    /// it is there; where its vertices are is known from elsewhere.
    pub ignore_prerequisites: bool,
}

/// What came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutReport {
    /// Odd edges when all units are there: those of the source.
    pub source_odd_edges: u64,
    /// Most odd edges of any cut, also while vertices of it are on their way to their places, and
    /// on the way of any order.
    pub odd_edges_max: u64,
    /// Number of foveated cuts.
    pub cuts: u32,
    /// Number of orders of arrival.
    pub orders: u32,
    /// Fewest levels that any foveated cut drew clusters of; 0 without cuts.
    pub levels_in_cut_min: u32,
}

/// Counts odd edges of many cuts of a scene, given the level and row of each unit.
///
/// Each unit is decoded once. A hundred cuts and two hundred orders of a mesh with a quarter of a
/// million triangles take a few seconds.
///
/// # Errors
/// A payload is not there, or does not fit to those it needs.
pub fn check_cuts<E: From<PackError>>(
    rows: &[(u8, UnitRow)],
    payload_of: &mut dyn FnMut(UnitId) -> Result<MeshUnit, E>,
    trial: &CutTrial,
) -> Result<CutReport, E> {
    let mut cut = MeshCut::default();
    for ((_, row), number) in rows.iter().zip(0..) {
        let payload = payload_of(UnitId(number))?;
        cut.insert(UnitId(number), &row.needs, &payload)?;
    }
    let chains = Chains::new(&cut, rows);
    let mut random = Random::new(trial.seed);
    let mut report = CutReport {
        cuts: trial.cuts,
        orders: trial.orders,
        ..Default::default()
    };
    let mut all = Parity::new(&chains);
    (0..rows.len()).for_each(|unit| all.insert(unit));
    report.source_odd_edges = all.odd();
    report.odd_edges_max = all.odd();
    let levels = (0..trial.cuts).map(|_| {
        let parity = match trial.ignore_prerequisites {
            true => any_set(&chains, &mut random),
            false => foveated(&chains, rows, &mut random),
        };
        let while_moving = match trial.ignore_prerequisites {
            true => 0,
            false => {
                let shares = random_shares(rows, &parity, &mut random);
                odd_while_moving(&mut cut, rows, &parity, &shares)
            }
        };
        let odd = parity.odd().max(while_moving);
        report.odd_edges_max = report.odd_edges_max.max(odd);
        parity.levels(rows)
    });
    report.levels_in_cut_min = levels.min().unwrap_or(0);
    let roots = rows.iter().filter(|(_, row)| row.needs.is_empty()).count();
    for _ in 0..trial.orders {
        let order = match trial.ignore_prerequisites {
            true => shuffled(rows.len(), &mut random),
            false => order(rows, &mut random),
        };
        let mut parity = Parity::new(&chains);
        let mut roots_to_come = roots;
        for unit in order {
            parity.insert(unit);
            roots_to_come -= usize::from(rows[unit].1.needs.is_empty());
            if roots_to_come == 0 {
                report.odd_edges_max = report.odd_edges_max.max(parity.odd());
            }
        }
    }
    Ok(report)
}

/// A cut as an eye somewhere needs it, with at least three levels where there are as many.
fn foveated<'a>(chains: &'a Chains, rows: &[(u8, UnitRow)], random: &mut Random) -> Parity<'a> {
    let mut best = Parity::new(chains);
    for _ in 0..TRIES {
        let scores = eyes::scores(rows, random);
        let chosen = eyes::closed_above(rows, &scores, random);
        let mut parity = Parity::new(chains);
        chosen.into_iter().for_each(|unit| parity.insert(unit));
        if parity.levels(rows) >= best.levels(rows) {
            best = parity;
        }
        if best.levels(rows) >= 3 {
            break;
        }
    }
    best
}

/// A random set of units.
fn any_set<'a>(chains: &'a Chains, random: &mut Random) -> Parity<'a> {
    let mut parity = Parity::new(chains);
    let part = random.unit();
    for unit in 0..chains.units() {
        if random.unit() < part {
            parity.insert(unit);
        }
    }
    parity
}

/// A random order in which each unit comes after those that it needs, and all roots come first.
fn order(rows: &[(u8, UnitRow)], random: &mut Random) -> Vec<usize> {
    let mut waits: Vec<usize> = rows.iter().map(|(_, row)| row.needs.len()).collect();
    let mut needed_by = vec![Vec::new(); rows.len()];
    for (unit, (_, row)) in rows.iter().enumerate() {
        for need in &row.needs {
            needed_by[need.0 as usize].push(unit);
        }
    }
    let free = |unit: usize, waits: &mut Vec<usize>, ready: &mut Vec<usize>| {
        for next in &needed_by[unit] {
            waits[*next] -= 1;
            if waits[*next] == 0 {
                ready.push(*next);
            }
        }
    };
    let roots: Vec<usize> = (0..rows.len()).filter(|unit| waits[*unit] == 0).collect();
    let mut order = Vec::with_capacity(rows.len());
    let mut ready = Vec::new();
    let drawn = shuffled(roots.len(), random);
    let roots = drawn.into_iter().map(|root| roots[root]);
    for root in roots {
        order.push(root);
        free(root, &mut waits, &mut ready);
    }
    while !ready.is_empty() {
        let unit = ready.swap_remove(below(ready.len(), random));
        order.push(unit);
        free(unit, &mut waits, &mut ready);
    }
    order
}

fn shuffled(count: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for place in (1..count).rev() {
        order.swap(place, below(place + 1, random));
    }
    order
}

/// A number from 0 to below `count`.
fn below(count: usize, random: &mut Random) -> usize {
    (random.unit() * count as f64) as usize
}
