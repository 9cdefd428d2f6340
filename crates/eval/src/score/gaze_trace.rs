//! Where in the picture did the eye look, frame by frame?
//!
//! CSV with a header that names `frame`, `x_px` and `y_px` in any order; one row a frame, in the
//! order of frames. Pixels count from the middle of the first one, to the right and down, and may
//! lie outside of the picture; other columns are ignored.

use super::error::ScoreError;

/// Most rows: a day at 120 frames a second.
const MOST_ROWS: usize = 10_368_000;
/// The columns.
const COLUMNS: [&str; 3] = ["frame", "x_px", "y_px"];
/// Longest piece of a file that is shown in a message, characters.
const SHOWN: usize = 24;

/// Places in a picture by frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GazeTrace {
    /// Rises strictly by frame; one at least.
    rows: Vec<(u32, [f64; 2])>,
}

impl GazeTrace {
    /// Reads a trace.
    ///
    /// # Errors
    /// Names line, column, what stands there and what should.
    pub fn parse(text: &str) -> Result<Self, ScoreError> {
        let mut lines = (1..).zip(text.trim_start_matches('\u{feff}').lines());
        let header = lines.next().map_or("", |(_, line)| line);
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let mut places = [0; 3];
        for (place, column) in places.iter_mut().zip(COLUMNS) {
            let found = names.iter().position(|name| *name == column);
            let expected = format!("a header with {}", COLUMNS.join(","));
            *place = found.ok_or_else(|| row_error(1, column, header, expected))?;
        }
        let mut rows: Vec<(u32, [f64; 2])> = Vec::new();
        for (line, text) in lines.filter(|(_, text)| !text.trim().is_empty()) {
            let row = parse_row(line, text, places)?;
            if let Some((before, _)) = rows.last().filter(|(before, _)| *before >= row.0) {
                let expected = format!("a frame after {before}");
                return Err(row_error(line, COLUMNS[0], &row.0.to_string(), expected));
            }
            if rows.len() == MOST_ROWS {
                let expected = format!("at most {MOST_ROWS} rows");
                return Err(row_error(line, COLUMNS[0], text, expected));
            }
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(row_error(2, COLUMNS[0], "", "a row for every frame"));
        }
        Ok(Self { rows })
    }

    /// Where the eye looked in a frame; `None` where there is no row.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<[f64; 2]> {
        let row = self.rows.binary_search_by_key(&frame, |(frame, _)| *frame);
        row.ok().map(|row| self.rows[row].1)
    }

    /// The frames that it covers.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.rows.len()
    }

    /// The trace as CSV.
    #[must_use]
    pub fn write(&self) -> String {
        use std::fmt::Write as _;
        let mut text = COLUMNS.join(",") + "\n";
        for (frame, [x, y]) in &self.rows {
            let _ = writeln!(text, "{frame},{x},{y}");
        }
        text
    }

    /// A trace of places, from frame 0 on; `None` of none.
    #[must_use]
    pub fn of(places: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        let rows: Vec<(u32, [f64; 2])> = (0..).zip(places).collect();
        (!rows.is_empty()).then_some(Self { rows })
    }
}

fn parse_row(line: usize, text: &str, places: [usize; 3]) -> Result<(u32, [f64; 2]), ScoreError> {
    let values: Vec<&str> = text.split(',').map(str::trim).collect();
    let of = |k: usize| values.get(places[k]).copied().unwrap_or_default();
    let frame = of(0)
        .parse()
        .map_err(|_| row_error(line, COLUMNS[0], of(0), "a frame's number from 0"))?;
    let place = |k: usize| {
        let found = of(k).parse().ok().filter(|place: &f64| place.is_finite());
        found.ok_or_else(|| row_error(line, COLUMNS[k], of(k), "a finite number of pixels"))
    };
    Ok((frame, [place(1)?, place(2)?]))
}

fn row_error(
    line: usize,
    column: &'static str,
    found: &str,
    expected: impl Into<String>,
) -> ScoreError {
    ScoreError::Row {
        line,
        column,
        found: found.chars().take(SHOWN).collect(),
        expected: expected.into(),
    }
}

/// Reads any bytes as a trace, for tests and fuzzing: what is read can be written and read again.
///
/// # Panics
/// When it cannot.
pub fn parse_anything(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    if let Ok(trace) = GazeTrace::parse(text) {
        let again = GazeTrace::parse(&trace.write());
        assert_eq!(again.as_ref(), Ok(&trace), "a trace that was written");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_trace_tells_the_place_of_every_frame_that_it_has() {
        let text = "x_px,frame,note,y_px\r\n1.5,0,a,2\r\n\r\n-3,4,b,1e2\r\n";
        let trace = GazeTrace::parse(text).unwrap();
        assert_eq!(trace.at(0), Some([1.5, 2.0]));
        assert_eq!(trace.at(4), Some([-3.0, 100.0]));
        assert_eq!(trace.at(1), None);
        assert_eq!(trace.frames(), 2);
    }

    #[test]
    fn what_is_no_trace_is_refused_by_line_and_column() {
        for (text, words) in [
            ("", ["line 1, column frame", "a header"]),
            ("frame,x_px\n0,1\n", ["line 1, column y_px", "a header"]),
            ("frame,x_px,y_px\n", ["line 2", "a row for every frame"]),
            (
                "frame,x_px,y_px\n0,1\n",
                ["line 2, column y_px", "a finite number"],
            ),
            (
                "frame,x_px,y_px\n0,nan,1\n",
                ["line 2, column x_px", "\"nan\""],
            ),
            (
                "frame,x_px,y_px\n0,1,inf\n",
                ["line 2, column y_px", "\"inf\""],
            ),
            (
                "frame,x_px,y_px\n-1,1,1\n",
                ["line 2, column frame", "from 0"],
            ),
            (
                "frame,x_px,y_px\n1,1,1\n1,1,1\n",
                ["line 3, column frame", "after 1"],
            ),
        ] {
            let message = GazeTrace::parse(text).unwrap_err().to_string();
            assert!(
                words.iter().all(|word| message.contains(word)),
                "{text:?}: {message}"
            );
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            parse_anything(&bytes);
        }

        #[test]
        fn damaged_traces_do_not_make_it_panic(
            rows in proptest::collection::vec((0..9_u32, -1e7..1e7_f64, any::<f64>()), 0..6),
            at in any::<prop::sample::Index>(),
            with in any::<u8>(),
        ) {
            let mut text = "frame,x_px,y_px\n".to_owned();
            for (frame, x, y) in rows {
                text += &format!("{frame},{x},{y}\n");
            }
            let mut bytes = text.into_bytes();
            let at = at.index(bytes.len());
            parse_anything(&bytes);
            bytes[at] = with;
            parse_anything(&bytes);
        }
    }
}
