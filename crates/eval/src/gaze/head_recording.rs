//! What did eyes and head do, by a recording of both?
//!
//! CSV at 100 Hz without time stamps: the columns of the recordings published with Hu et al. 2019
//! (SGaze), under the names below, in any order; other columns are ignored. Reading is bounded: a
//! line by [`MOST_LINE_BYTES`], a file by [`MOST_ROWS`].

use foveal_core::gaze::head_prediction::{GazeInHead, HeadMotion, SgazeMotion};
use foveal_core::units::Seconds;
use std::io::{BufRead, Read};
use thiserror::Error;

/// Rows per second.
pub const RATE_HZ: f64 = 100.0;
/// Longest line, in bytes.
pub const MOST_LINE_BYTES: usize = 4096;
/// Most rows of a recording: a day.
pub const MOST_ROWS: usize = 8_640_000;

/// The columns and the largest magnitude that each may have.
const COLUMNS: [(&str, f64); 9] = [
    ("gaze_x", 89.0),
    ("gaze_y", 89.0),
    ("head_vel_x", 1e5),
    ("head_vel_y", 1e5),
    ("head_acc_x", 1e7),
    ("head_acc_mean_x", 1e7),
    ("head_acc_mean_y", 1e7),
    ("head_vel_std_x", 1e5),
    ("head_vel_std_y", 1e5),
];

/// Eyes and head at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadRow {
    /// Where the eyes looked.
    pub gaze: GazeInHead,
    /// What the head did.
    pub head: SgazeMotion,
}

/// A recording of eyes and head, 100 rows a second; at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadRecording {
    rows: Vec<HeadRow>,
}

/// Why bytes are no recording of eyes and head.
#[derive(Debug, Error)]
pub enum HeadRecordingError {
    /// A column is missing.
    #[error("line 1: the header lacks {missing}; it must name {}", all_columns())]
    Header {
        /// The first missing column.
        missing: &'static str,
    },
    /// A value that is no number, not finite or too large.
    #[error("line {line}, column {column}: found \"{found}\", expected a number within ±{most}")]
    Value {
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// What stands there, shortened.
        found: String,
        /// Largest magnitude.
        most: f64,
    },
    /// A line of no sensible length.
    #[error("line {0}: longer than {MOST_LINE_BYTES} bytes; is this a text file?")]
    LongLine(usize),
    /// Nothing but a header.
    #[error("the recording has no rows; it needs at least one sample")]
    Empty,
    /// Too many rows.
    #[error("line {0}: more rows than are read; cut the recording")]
    TooLong(usize),
    /// The bytes cannot be had.
    #[error("line {0}: cannot be read: {1}")]
    Unreadable(usize, std::io::Error),
}

fn all_columns() -> String {
    COLUMNS.map(|(name, _)| name).join(", ")
}

impl HeadRecording {
    /// A recording of rows; `None` of no rows.
    #[must_use]
    pub fn new(rows: Vec<HeadRow>) -> Option<Self> {
        (!rows.is_empty()).then_some(Self { rows })
    }

    /// Reads a recording; row k is k hundredths of a second. Refuses missing columns and values
    /// that are not finite or beyond what a head or an eye can do.
    pub fn read(bytes: impl BufRead) -> Result<Self, HeadRecordingError> {
        let mut lines = Lines {
            bytes,
            line: Vec::new(),
            number: 0,
        };
        let header = lines.next_line()?.unwrap_or_default().to_owned();
        let names: Vec<&str> = header
            .trim_start_matches('\u{feff}')
            .split(',')
            .map(str::trim)
            .collect();
        let mut places = [0; COLUMNS.len()];
        for (place, (missing, _)) in places.iter_mut().zip(COLUMNS) {
            *place = names
                .iter()
                .position(|&name| name == missing)
                .ok_or(HeadRecordingError::Header { missing })?;
        }
        let mut rows = Vec::new();
        while let Some(line) = lines.next_line()? {
            if line.trim().is_empty() {
                continue;
            }
            let values = parse_row(line, &places).map_err(|bad| bad.at(lines.number))?;
            if rows.len() == MOST_ROWS {
                return Err(HeadRecordingError::TooLong(lines.number));
            }
            rows.push(row(rows.len(), values));
        }
        Self::new(rows).ok_or(HeadRecordingError::Empty)
    }

    /// The rows, in the order of time.
    #[must_use]
    pub fn rows(&self) -> &[HeadRow] {
        &self.rows
    }
}

/// A value that cannot be, before its line is known.
struct BadValue {
    column: usize,
    found: String,
}

impl BadValue {
    fn at(self, line: usize) -> HeadRecordingError {
        let (column, most) = COLUMNS[self.column];
        HeadRecordingError::Value {
            line,
            column,
            found: self.found,
            most,
        }
    }
}

fn parse_row(line: &str, places: &[usize; 9]) -> Result<[f64; 9], BadValue> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let mut values = [0.0; 9];
    for (column, &place) in places.iter().enumerate() {
        let found = fields.get(place).copied().unwrap_or_default();
        values[column] = match found.parse::<f64>() {
            Ok(value) if value.abs() <= COLUMNS[column].1 => value,
            _ => {
                let found = found.chars().take(40).collect();
                return Err(BadValue { column, found });
            }
        };
    }
    Ok(values)
}

fn row(index: usize, values: [f64; 9]) -> HeadRow {
    let [gx, gy, vx, vy, ax, mean_ax, mean_ay, std_x, std_y] = values;
    HeadRow {
        gaze: GazeInHead {
            yaw_deg: gx,
            pitch_deg: gy,
        },
        head: SgazeMotion {
            motion: HeadMotion {
                time: Seconds(index as f64 / RATE_HZ),
                velocity_deg_s: [vx, vy],
                mean_acceleration_deg_s2: [mean_ax, mean_ay],
            },
            yaw_acceleration_deg_s2: ax,
            velocity_deviation_deg_s: [std_x, std_y],
            salient_deg: None,
        },
    }
}

/// Takes any bytes for a recording: the body of the fuzz target. Returns whether they were one.
///
/// # Panics
/// When what was read is no recording: no rows, or a number beyond what its column may hold.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    let Ok(recording) = HeadRecording::read(data) else {
        return false;
    };
    assert!(!recording.rows().is_empty(), "a recording has rows");
    for row in recording.rows() {
        let SgazeMotion {
            motion,
            yaw_acceleration_deg_s2,
            velocity_deviation_deg_s,
            ..
        } = row.head;
        let vectors = [
            row.gaze.degrees(),
            motion.velocity_deg_s,
            motion.mean_acceleration_deg_s2,
            velocity_deviation_deg_s,
            [yaw_acceleration_deg_s2, 0.0],
        ];
        let most = vectors.as_flattened().iter().all(|v| v.abs() <= 1e7);
        assert!(most && motion.time.0 >= 0.0, "{row:?}");
    }
    true
}

/// Lines of bounded length.
struct Lines<R> {
    bytes: R,
    line: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    /// The next line; `None` after the last. Bytes that are no UTF-8 become replacement marks,
    /// which no number contains.
    fn next_line(&mut self) -> Result<Option<&str>, HeadRecordingError> {
        self.number += 1;
        self.line.clear();
        let most = MOST_LINE_BYTES as u64 + 1;
        let read = (&mut self.bytes)
            .take(most)
            .read_until(b'\n', &mut self.line)
            .map_err(|error| HeadRecordingError::Unreadable(self.number, error))?;
        if read > MOST_LINE_BYTES {
            return Err(HeadRecordingError::LongLine(self.number));
        }
        if let Err(error) = core::str::from_utf8(&self.line) {
            self.line.truncate(error.valid_up_to());
            self.line.extend_from_slice("\u{fffd}".as_bytes());
        }
        Ok((read > 0).then(|| core::str::from_utf8(&self.line).unwrap_or_default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "gaze_x,gaze_y,head_vel_x,head_vel_y,head_acc_x,head_acc_mean_x,\
                          head_acc_mean_y,head_vel_std_x,head_vel_std_y\n";

    fn error(text: &str) -> String {
        HeadRecording::read(text.as_bytes())
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn columns_may_come_in_any_order_and_others_are_ignored() {
        let names: Vec<&str> = HEADER.trim().split(',').rev().collect();
        let text = format!("note,{}\nhi,9,8,7,6,5,4,3,2,1\n", names.join(","));
        let recording = HeadRecording::read(text.as_bytes()).unwrap();
        let HeadRow { gaze, head } = recording.rows()[0];
        assert_eq!(gaze.degrees(), [1.0, 2.0]);
        assert_eq!(head.motion.velocity_deg_s, [3.0, 4.0]);
        assert_eq!(head.yaw_acceleration_deg_s2, 5.0);
        assert_eq!(head.motion.mean_acceleration_deg_s2, [6.0, 7.0]);
        assert_eq!(head.velocity_deviation_deg_s, [8.0, 9.0]);
    }

    #[test]
    fn rows_are_a_hundredth_of_a_second_apart() {
        let text = format!("{HEADER}{}", "1,2,3,4,5,6,7,8,9\n".repeat(3));
        let recording = HeadRecording::read(text.as_bytes()).unwrap();
        let times = [0, 1, 2].map(|k| recording.rows()[k].head.motion.time.0);
        assert_eq!(times, [0.0, 0.01, 0.02]);
    }

    #[test]
    fn missing_columns_and_bad_values_are_named() {
        assert!(error("").contains("lacks gaze_x"));
        assert!(error("gaze_x,gaze_y\n1,2\n").contains("lacks head_vel_x"));
        assert!(error(HEADER).contains("no rows"));
        for (row, place) in [
            (
                "NaN,2,3,4,5,6,7,8,9",
                "line 2, column gaze_x: found \"NaN\"",
            ),
            ("1,2,inf,4,5,6,7,8,9", "line 2, column head_vel_x"),
            ("1,95,3,4,5,6,7,8,9", "line 2, column gaze_y: found \"95\""),
            (
                "1,2,3,4,5,6,7,8",
                "line 2, column head_vel_std_y: found \"\"",
            ),
        ] {
            let found = error(&format!("{HEADER}{row}\n"));
            assert!(found.contains(place), "{found}");
        }
        let later = format!("{HEADER}1,2,3,4,5,6,7,8,9\n\n1,2,3,4,x,6,7,8,9\n");
        assert!(error(&later).contains("line 4, column head_acc_x"));
    }

    #[test]
    fn an_endless_line_is_refused_after_a_bounded_part_of_it() {
        let endless = std::io::BufReader::new(std::io::repeat(b'1'));
        let found = HeadRecording::read(endless).unwrap_err().to_string();
        assert!(found.contains("line 1: longer than 4096 bytes"), "{found}");
        let long = format!("{HEADER}1,2,3,4,5,6,7,8,{}\n", "9".repeat(5000));
        assert!(error(&long).contains("line 2: longer"));
    }

    #[test]
    fn a_generated_corpus_of_damaged_recordings_never_panics() {
        let good = format!("{HEADER}{}", "1.5,-2,3,4,5,6,7,8,9\n".repeat(2));
        let mut random = foveal_core::view::random::Random::new(7);
        let mut refused = 0;
        assert!(parse_anything(good.as_bytes()));
        for _ in 0..5000 {
            let mut bad = good.as_bytes().to_vec();
            for _ in 0..3 {
                let mut below = |count: usize| (random.unit() * count as f64) as usize;
                let place = below(bad.len());
                let damage = b"0123456789.,-+eNaninf\n\xff";
                bad[place] = damage[below(damage.len())];
            }
            refused += usize::from(!parse_anything(&bad));
        }
        assert!((2500..5000).contains(&refused), "{refused}");
    }

    #[test]
    fn bytes_that_are_no_text_are_no_numbers() {
        let mut bytes = HEADER.as_bytes().to_vec();
        bytes.extend_from_slice(b"1,2,\xff3,4,5,6,7,8,9\n");
        let found = HeadRecording::read(bytes.as_slice())
            .unwrap_err()
            .to_string();
        assert!(found.contains("line 2, column head_vel_x"), "{found}");
    }
}
