//! Which trace does the table of an eye tracker hold, given the names of its columns?
//!
//! Cells are separated by tabs, semicolons or commas; decimals may have a comma where cells have
//! none between them; lines before the header say nothing. Time counts from the first row.

use crate::gaze::read::row::{TraceRow, degrees_of};
use crate::gaze::read::trace::{MAX_LINE_BYTES, Trace, TraceError};
use crate::units::{Seconds, one_line};
use glam::DVec3;
use thiserror::Error;

/// Lines in which the header is looked for.
const HEADER_LINES: usize = 200;
/// What may stand between cells, tried in this order.
const SEPARATORS: [char; 3] = ['\t', ';', ','];
/// Farthest that a gaze may be off the screen, in screens: farther away the eye is lost.
const MOST_SCREENS: f64 = 3.0;
/// Longest piece of a file that a message repeats, in characters.
const SHOWN: usize = 40;

/// Size and place of the screen that pixels lie on; the eye is before its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerScreen {
    /// Width and height in metres.
    pub size_m: [f64; 2],
    /// Width and height in pixels.
    pub size_px: [f64; 2],
    /// Distance from the eye in metres.
    pub distance_m: f64,
}

impl TrackerScreen {
    /// Unit direction from the eye to a place on the screen, in pixels from its upper left.
    #[must_use]
    pub fn direction(&self, [x, y]: [f64; 2]) -> DVec3 {
        let metres = |k: usize, at: f64| (at / self.size_px[k] - 0.5) * self.size_m[k];
        DVec3::new(metres(0, x), -metres(1, y), -self.distance_m).normalize()
    }
}

/// How a tracker's table is read.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackerForm {
    /// Names of the columns of time and of the gaze on the screen, to the right and down.
    pub columns: [String; 3],
    /// Seconds to a unit of the time.
    pub unit_s: f64,
    /// The screen.
    pub screen: TrackerScreen,
}

/// Why text is no table of a tracker.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TrackerError {
    /// No line names the columns.
    #[error(
        "no line of the first {HEADER_LINES} names {}; give the names as they stand in the file",
        one_line(&columns.join(", "))
    )]
    Header {
        /// What was looked for.
        columns: [String; 3],
    },
    /// A column is there twice.
    #[error(
        "line {line}: names column {} more than once; leave one of them",
        one_line(column)
    )]
    Twice {
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: String,
    },
    /// An invalid time.
    #[error("line {line}, column {column}: found \"{found}\", expected a time")]
    Time {
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What stands there, shortened.
        found: String,
    },
    /// Time goes back.
    #[error("line {line}, column {column}: time goes back; sort the rows, or cut the table there")]
    Backwards {
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: String,
    },
    /// Nothing that could be a gaze.
    #[error(
        "no row has a gaze on the screen in {}; are these the columns, and is this the screen?",
        columns.join(", ")
    )]
    Blind {
        /// The columns of the gaze.
        columns: [String; 2],
    },
    /// What no trace may have.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// Reads a table line by line, so that no caller needs to hold its text.
#[derive(Clone, Debug)]
pub struct TrackerReader {
    form: TrackerForm,
    lines: usize,
    /// What separates cells, and where the columns are.
    header: Option<(char, [usize; 3])>,
    /// The first time.
    start: Option<f64>,
    rows: Vec<TraceRow>,
}

impl TrackerReader {
    /// A reader of such tables.
    #[must_use]
    pub fn new(form: TrackerForm) -> Self {
        Self {
            form,
            lines: 0,
            header: None,
            start: None,
            rows: Vec::new(),
        }
    }

    /// Reads the next line. A row without a gaze is one of a lost eye; of rows of one time the
    /// first with a gaze counts.
    ///
    /// # Errors
    /// It is longer than [`MAX_LINE_BYTES`], has no time, or one before that of another row.
    pub fn line(&mut self, line: &[u8]) -> Result<(), TrackerError> {
        self.lines += 1;
        if line.len() > MAX_LINE_BYTES {
            return Err(TraceError::LongLine(self.lines).into());
        }
        let text = String::from_utf8_lossy(line);
        let text = text
            .trim_start_matches('\u{feff}')
            .trim_end_matches(['\r', '\n']);
        match self.header {
            _ if text.trim().is_empty() => Ok(()),
            Some(header) => self.row(text, header),
            None => self.look_for_header(text),
        }
    }

    /// The trace of all lines.
    ///
    /// # Errors
    /// No line named the columns, or no row had a gaze.
    pub fn finish(self) -> Result<Trace, TrackerError> {
        let [time, x, y] = self.form.columns;
        if self.header.is_none() {
            let columns = [time, x, y];
            return Err(TrackerError::Header { columns });
        }
        if !self.rows.iter().any(|row| row.valid) {
            return Err(TrackerError::Blind { columns: [x, y] });
        }
        Ok(Trace::from_rows(self.rows)?)
    }

    fn look_for_header(&mut self, text: &str) -> Result<(), TrackerError> {
        self.header = SEPARATORS.into_iter().find_map(|separator| {
            let names: Vec<&str> = cells(text, separator).collect();
            let place = |name: &String| names.iter().position(|found| found == name);
            let [time, x, y] = self.form.columns.each_ref().map(place);
            Some((separator, [time?, x?, y?]))
        });
        if let Some((separator, _)) = self.header {
            let is_twice = |name: &&String| {
                let same = cells(text, separator).filter(|it| *it == name.as_str());
                same.count() > 1
            };
            if let Some(column) = self.form.columns.iter().find(is_twice) {
                return Err(TrackerError::Twice {
                    line: self.lines,
                    column: column.clone(),
                });
            }
        }
        if self.header.is_none() && self.lines >= HEADER_LINES {
            let columns = self.form.columns.clone();
            return Err(TrackerError::Header { columns });
        }
        Ok(())
    }

    fn row(
        &mut self,
        text: &str,
        (separator, places): (char, [usize; 3]),
    ) -> Result<(), TrackerError> {
        let all: Vec<&str> = cells(text, separator).collect();
        let [time, x, y] = places.map(|place| all.get(place).copied().unwrap_or_default());
        let number = |cell: &str| number(cell, separator);
        let (line, column) = (self.lines, || self.form.columns[0].clone());
        let Some(seconds) = number(time).map(|time| time * self.form.unit_s) else {
            let found = time.chars().take(SHOWN).collect();
            let column = column();
            return Err(TrackerError::Time {
                line,
                column,
                found,
            });
        };
        let time = seconds - *self.start.get_or_insert(seconds);
        let gaze_deg = number(x)
            .zip(number(y))
            .and_then(|at| self.gaze([at.0, at.1]));
        let row = TraceRow {
            time: Seconds(time),
            received: Seconds(time),
            gaze_deg,
            valid: gaze_deg.is_some(),
            spread_deg: 0.0,
            head_deg: None,
        };
        match self.rows.last_mut() {
            Some(last) if time < last.time.0 => {
                let column = column();
                Err(TrackerError::Backwards { line, column })
            }
            Some(last) if time == last.time.0 => {
                if !last.valid {
                    *last = row;
                }
                Ok(())
            }
            _ => {
                self.rows.push(row);
                Ok(())
            }
        }
    }

    /// Yaw and pitch of a place on the screen, in degrees; `None` of a lost eye, which many
    /// trackers say to be at 0, 0, and of what lies far off the screen.
    fn gaze(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let screen = &self.form.screen;
        let is_near = |k: usize| (at[k] / screen.size_px[k] - 0.5).abs() <= MOST_SCREENS;
        let is_seen = at != [0.0; 2] && is_near(0) && is_near(1);
        is_seen.then(|| degrees_of(screen.direction(at)))
    }
}

/// The cells of a line, without quotation marks.
fn cells(text: &str, separator: char) -> impl Iterator<Item = &str> {
    let cells = text.split(separator);
    cells.map(|cell| cell.trim().trim_matches('"').trim())
}

/// A finite number, or nothing; with a decimal comma where none separates cells.
fn number(cell: &str, separator: char) -> Option<f64> {
    let parsed = match separator {
        ',' => cell.parse(),
        _ => cell.replace(',', ".").parse(),
    };
    parsed.ok().filter(|number: &f64| number.is_finite())
}

/// Takes any bytes for a table: the body of the fuzz target. Returns whether they were one.
///
/// # Panics
/// When what was read is no trace.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    let mut reader = TrackerReader::new(TrackerForm {
        columns: ["t", "x", "y"].map(str::to_owned),
        unit_s: 1e-3,
        screen: TrackerScreen {
            size_m: [0.5, 0.3],
            size_px: [1000.0, 600.0],
            distance_m: 0.6,
        },
    });
    let read = data
        .split(|byte| *byte == b'\n')
        .all(|line| reader.line(line).is_ok());
    let Some(trace) = read.then(|| reader.finish().ok()).flatten() else {
        return false;
    };
    assert!(
        trace.rows().iter().any(|row| row.valid),
        "a table has a gaze"
    );
    assert!(Trace::parse(&trace.write()).is_ok_and(|again| again == trace));
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: TrackerScreen = TrackerScreen {
        size_m: [0.6, 0.3],
        size_px: [1200.0, 600.0],
        distance_m: 0.6,
    };

    fn read(names: [&str; 3], unit_s: f64, text: &str) -> Result<Trace, TrackerError> {
        let mut reader = TrackerReader::new(TrackerForm {
            columns: names.map(str::to_owned),
            unit_s,
            screen: SCREEN,
        });
        for line in text.lines() {
            reader.line(line.as_bytes())?;
        }
        reader.finish()
    }

    /// A gaze in the middle, one half a screen to the right, a lost one, and one up.
    fn expects(trace: &Trace) {
        let rows = trace.rows();
        let times: Vec<f64> = rows.iter().map(|row| row.time.0).collect();
        for (found, expected) in times.iter().zip([0.0, 0.01, 0.02, 0.03]) {
            assert!((found - expected).abs() < 1e-9, "{times:?}");
        }
        let to_the_right = 0.5_f64.atan().to_degrees();
        let up = 0.25_f64.atan().to_degrees();
        let expected = [
            Some([0.0, 0.0]),
            Some([to_the_right, 0.0]),
            None,
            Some([0.0, up]),
        ];
        for (row, expected) in rows.iter().zip(expected) {
            assert_eq!(row.valid, expected.is_some());
            let off = row
                .gaze_deg
                .zip(expected)
                .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
            assert!(off.unwrap_or_default() < 1e-9, "{row:?} {expected:?}");
        }
    }

    #[test]
    fn tables_of_trackers_are_read_as_they_are() {
        let tobii = "\u{feff}Recording timestamp\tGaze point X\tGaze point Y\tEye\n\
                     5000000\t600\t300\tB\n5010000\t1200\t300\tB\n5020000\t\t\t\n\
                     5020000\t\t\tmouse\n5030000\t600\t0\tB\n";
        expects(
            &read(
                ["Recording timestamp", "Gaze point X", "Gaze point Y"],
                1e-6,
                tobii,
            )
            .unwrap(),
        );
        let smi = "## converted\n## 1000\n\ntime;POR X;POR Y\r\n1,5;600,0;300\r\n1,51;1200;300\r\n\
                   1,52;0;0\r\n1,53;600;0\r\n";
        expects(&read(["time", "POR X", "POR Y"], 1.0, smi).unwrap());
        let eyelink = "y,\"x\",ms\n300,600,7\n300,1200,17\n.,.,27\n0,600,37\n";
        expects(&read(["ms", "x", "y"], 1e-3, eyelink).unwrap());
    }

    #[test]
    fn what_is_no_such_table_is_refused_by_its_place() {
        let error = |text| read(["t", "x", "y"], 1.0, text).unwrap_err().to_string();
        for (text, part) in [
            ("", "names t, x, y"),
            ("t,x\n0,1\n", "names t, x, y"),
            (
                "t,x,y,x\n0,1,2,3\n",
                "line 1: names column x more than once",
            ),
            (
                "t,x,y\n0,600,300\nsoon,600,300\n",
                "line 3, column t: found \"soon\"",
            ),
            (
                "t,x,y\n1,600,300\n0.5,600,300\n",
                "line 3, column t: time goes back",
            ),
            (
                "t,x,y\n0,nan,nan\n1,0,0\n2,1e9,5\n",
                "no row has a gaze on the screen in x, y",
            ),
        ] {
            assert!(error(text).contains(part), "{}", error(text));
        }
        let long = format!("t,x,y\n{}", "1".repeat(MAX_LINE_BYTES + 1));
        assert!(error(&long).starts_with("line 2: longer"));
    }

    #[test]
    fn a_generated_corpus_of_damaged_tables_never_panics() {
        let good = "t;x;y\n0;600;300\n5;610,5;300\n9;;\n";
        let mut random = crate::view::random::Random::new(3);
        let mut read = 0;
        for _ in 0..5000 {
            let mut bad = good.as_bytes().to_vec();
            for _ in 0..2 {
                let mut below = |count: usize| (random.unit() * count as f64) as usize;
                let place = below(bad.len());
                let damage = b"0123456789.,;-+eNaninf\t\n\xff";
                bad[place] = damage[below(damage.len())];
            }
            read += usize::from(parse_anything(&bad));
        }
        assert!((500..4900).contains(&read), "{read}");
    }
}
