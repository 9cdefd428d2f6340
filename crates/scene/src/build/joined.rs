//! Which number has each unit, where several graphs are one scene?

use super::built::BuiltUnit;
use foveal_core::pack::unit::UnitId;

/// The units of one graph, numbered by themselves: coarsest level first, roots at the coarsest.
pub(super) struct Graphed {
    pub(super) units: Vec<BuiltUnit>,
    /// Number of its levels.
    pub(super) levels: u8,
}

/// All units, coarsest level first, within a level graph by graph; and the number of levels. All
/// roots come first.
pub(super) fn joined(graphs: Vec<Graphed>) -> (Vec<BuiltUnit>, u8) {
    let levels = graphs.iter().map(|graph| graph.levels).max().unwrap_or(0);
    let mut order: Vec<(u8, usize, usize)> = Vec::new();
    for (number, graph) in graphs.iter().enumerate() {
        for (unit, about) in graph.units.iter().enumerate() {
            let is_root = about.row.needs.is_empty();
            let coarseness = if is_root { 0 } else { levels - 1 - about.level };
            order.push((coarseness, number, unit));
        }
    }
    order.sort_unstable();
    let numbers = graphs
        .iter()
        .map(|graph| vec![UnitId(0); graph.units.len()]);
    let mut number_of: Vec<Vec<UnitId>> = numbers.collect();
    for ((_, graph, unit), number) in order.iter().zip(0..) {
        number_of[*graph][*unit] = UnitId(number);
    }
    let units = graphs.into_iter().map(|graph| graph.units);
    let mut units: Vec<Vec<Option<BuiltUnit>>> = units
        .map(|all| all.into_iter().map(Some).collect())
        .collect();
    let taken = order.iter().filter_map(|(coarseness, graph, unit)| {
        let mut taken = units[*graph][*unit].take()?;
        taken.level = levels - 1 - coarseness;
        for need in &mut taken.row.needs {
            *need = number_of[*graph][need.0 as usize];
        }
        Some(taken)
    });
    (taken.collect(), levels)
}
