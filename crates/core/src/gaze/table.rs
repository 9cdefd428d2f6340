//! What stands between two rows of a table?

/// The value at `at`, linear between rows of growing first column; the end rows hold beyond them.
pub(super) fn between(rows: &[(f64, f64)], at: f64) -> f64 {
    let after = rows.partition_point(|&(x, _)| x <= at);
    match (rows.get(after.wrapping_sub(1)), rows.get(after)) {
        (Some(&(x0, y0)), Some(&(x1, y1))) => y0 + (y1 - y0) * (at - x0) / (x1 - x0),
        (Some(&(_, y)), None) | (None, Some(&(_, y))) => y,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_met_and_joined_by_straight_lines() {
        let rows = [(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)];
        let found = [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0].map(|at| between(&rows, at));
        assert_eq!(found, [10.0, 10.0, 15.0, 20.0, 10.0, 0.0, 0.0]);
    }
}
