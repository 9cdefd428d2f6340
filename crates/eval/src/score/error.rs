//! Why can two pictures not be scored?

use thiserror::Error;

/// What is wrong with what was handed in; the caller, who knows the file, puts its name first.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScoreError {
    /// A number or a word that cannot be.
    #[error("{field} is {found}; give {expected}")]
    Field {
        /// Which one.
        field: &'static str,
        /// What it is.
        found: String,
        /// What it may be.
        expected: String,
    },
    /// A picture of another size than the first.
    #[error(
        "{}x{} pixels where {}x{} are expected; bring both to one size",
        found[0], found[1], expected[0], expected[1]
    )]
    Size {
        /// Columns and rows.
        found: [u32; 2],
        /// Columns and rows of the others.
        expected: [u32; 2],
    },
    /// A sample that is no number, or outside of what a display shows.
    #[error(
        "the sample of column {}, row {}, channel {channel} is {found}; expected 0 to 1",
        place[0], place[1]
    )]
    Sample {
        /// Column and row from 0.
        place: [u32; 2],
        /// 0 is red, 1 green, 2 blue.
        channel: usize,
        /// The sample.
        found: f32,
    },
    /// A line of a gaze trace.
    #[error("line {line}, column {column}: found \"{found}\", expected {expected}")]
    Row {
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// What stands there, shortened.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// A graphics device that cannot do it, or did not.
    #[error("{0}; give --device cpu")]
    Device(String),
}

impl ScoreError {
    /// The error for a `field` that is `found`.
    pub(crate) fn field(
        field: &'static str,
        found: impl ToString,
        expected: impl ToString,
    ) -> Self {
        Self::Field {
            field,
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }
}
