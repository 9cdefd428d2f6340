//! Which rows of numbers does a table of measurements hold?
//!
//! CSV with a header line; columns in any order, others ignored; empty lines and lines that begin
//! with # say nothing.

use thiserror::Error;

/// Most rows of a table.
pub const MOST_ROWS: usize = 4096;
/// Longest piece of a table that a message repeats, in characters.
const SHOWN: usize = 40;

/// Why text or numbers are no table of measurements.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MeasuredError {
    /// A column is missing.
    #[error("line 1: the header lacks {missing}; it must name {all}")]
    Header {
        /// The first that is missing.
        missing: &'static str,
        /// All of them.
        all: &'static str,
    },
    /// A column is there twice, or in two units.
    #[error("line 1: the header names {names} more than once; leave one of them")]
    Twice {
        /// The names that it has.
        names: String,
    },
    /// A cell that is no number, not finite or out of range.
    #[error("line {line}, column {column}: found \"{found}\", expected {expected}")]
    Value {
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// What stands there, shortened.
        found: String,
        /// What should.
        expected: &'static str,
    },
    /// More rows than are read.
    #[error("line {line}: more than {MOST_ROWS} rows; leave some out")]
    TooLong {
        /// Line in the file, from 1.
        line: usize,
    },
    /// Rows that make no function of what they are measured at.
    #[error("{0}")]
    Rows(String),
}

/// What a column holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    /// Names that it may have, each with how many of its units are one of the range.
    pub(super) names: &'static [(&'static str, f64)],
    /// Least and most.
    pub(super) range: [f64; 2],
    /// The range, for messages.
    pub(super) expected: &'static str,
}

impl Column {
    /// Whether it may hold a number.
    pub(super) fn holds(&self, value: f64) -> bool {
        value >= self.range[0] && value <= self.range[1]
    }
}

/// The rows of a table, in the order of the columns and in their units; `all` names these for
/// messages.
pub(super) fn rows<const N: usize>(
    text: &str,
    columns: [Column; N],
    all: &'static str,
) -> Result<Vec<[f64; N]>, MeasuredError> {
    let lines = (1..).zip(text.trim_start_matches('\u{feff}').lines());
    let mut lines = lines.filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let header = lines.next().map_or("", |(_, line)| line);
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let mut places = [(0, "", 1.0); N];
    for (place, column) in places.iter_mut().zip(columns) {
        let of_column = names.iter().enumerate().filter_map(|(at, found)| {
            let (name, units) = column.names.iter().find(|(name, _)| name == found)?;
            Some((at, *name, *units))
        });
        let all_found: Vec<(usize, &str, f64)> = of_column.collect();
        if all_found.len() > 1 {
            let names = all_found.iter().map(|(_, name, _)| *name);
            let names = names.collect::<Vec<_>>().join(" and ");
            return Err(MeasuredError::Twice { names });
        }
        let found = all_found.first().copied();
        let missing = column.names.first().map_or("", |(name, _)| name);
        *place = found.ok_or(MeasuredError::Header { missing, all })?;
    }
    let mut rows = Vec::new();
    for (line, text) in lines {
        if rows.len() == MOST_ROWS {
            return Err(MeasuredError::TooLong { line });
        }
        let cells: Vec<&str> = text.split(',').map(str::trim).collect();
        let mut row = [0.0; N];
        for ((value, (at, name, units)), column) in row.iter_mut().zip(places).zip(columns) {
            let cell = cells.get(at).copied().unwrap_or_default();
            let number = cell.parse::<f64>().ok().map(|number| number / units);
            *value = number
                .filter(|number| column.holds(*number))
                .ok_or_else(|| MeasuredError::Value {
                    line,
                    column: name,
                    found: cell.chars().take(SHOWN).collect(),
                    expected: column.expected,
                })?;
        }
        rows.push(row);
    }
    Ok(rows)
}
