//! Is a cut closed while vertices are on their way?

use super::edges::Place;
use super::parity::{Parity, border};
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::random::Random;
use std::collections::{BTreeMap, HashSet};

/// About how many units are on their way at once.
const MOVING: f64 = 64.0;

/// Some random units of those that are there, at random parts of their way.
pub(super) fn random_shares(
    rows: &[(u8, UnitRow)],
    parity: &Parity<'_>,
    random: &mut Random,
) -> BTreeMap<UnitId, f64> {
    let may_move = |unit: &usize| parity.is_there(*unit) && !rows[*unit].1.needs.is_empty();
    let units: Vec<usize> = (0..rows.len()).filter(may_move).collect();
    let part = MOVING / units.len().max(1) as f64;
    let mut shares = BTreeMap::new();
    for unit in units {
        if random.unit() < part {
            shares.insert(UnitId(unit as u32), random.unit());
        }
    }
    shares
}

/// Number of odd edges of what is drawn of the units of `parity` while some of them, also below
/// others, are on their way; `cut` has all units, each in its place before and after.
///
/// Only clusters with vertices on their way are counted again: what the others have is in `parity`.
pub(super) fn odd_while_moving(
    cut: &mut MeshCut,
    rows: &[(u8, UnitRow)],
    parity: &Parity<'_>,
    shares: &BTreeMap<UnitId, f64>,
) -> u64 {
    cut.morph(shares);
    // Edges whose parity is another than with all vertices in their places.
    let mut turned: HashSet<(u16, [Place; 2])> = HashSet::new();
    for unit in cut.unsteady() {
        let Some(placed) = cut.unit(unit) else {
            continue;
        };
        let number = unit.0 as usize;
        let object = rows[number].1.object;
        for cluster in (0..placed.clusters.len()).filter(|it| parity.is_drawn(number, *it)) {
            let before = border(placed.triangles(cluster));
            let now = border(cut.triangles_now(unit, placed, cluster));
            for edge in before.into_iter().chain(now) {
                if !turned.insert((object, edge)) {
                    turned.remove(&(object, edge));
                }
            }
        }
    }
    cut.morph(&BTreeMap::new());
    let was_odd = |edge: &&(u16, [Place; 2])| parity.is_odd(edge);
    let gone = turned.iter().filter(was_odd).count() as u64;
    parity.odd() + turned.len() as u64 - 2 * gone
}
