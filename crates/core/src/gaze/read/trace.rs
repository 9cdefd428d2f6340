//! What does a recorded gaze trace say?
//!
//! CSV with a header line: `t_s, yaw_deg, pitch_deg` and optionally `received_s`, `valid`,
//! `spread_deg`, `head_yaw_deg, head_pitch_deg, head_roll_deg`, in any order; other columns are
//! ignored. A trace of a head alone has no `yaw_deg, pitch_deg`. Normative: docs/formats/gaze.md.

use crate::gaze::loss::gaze_at;
use crate::gaze::read::row::{
    HEAD_PITCH, HEAD_ROLL, HEAD_YAW, PITCH, QUANTITIES, RECEIVED, SPREAD, T, TraceRow, VALID, YAW,
};
use crate::gaze::sample::GazeSample;
use crate::units::{Seconds, counted};
use thiserror::Error;

/// Most rows of a trace: two and a half hours at 1000 Hz, about 1.5 GB once read.
const MAX_ROWS: usize = 10_000_000;

/// Longest line of a trace in bytes.
pub const MAX_LINE_BYTES: usize = 65_536;

/// Longest piece of a file that a message repeats, in characters.
const SHOWN: usize = 40;

/// A recorded gaze, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    rows: Vec<TraceRow>,
    samples: Vec<GazeSample>,
    /// For each sample, the place of the newest valid one up to it.
    seen: Vec<Option<u32>>,
}

/// Why text is no trace.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TraceError {
    /// No header line.
    #[error("line 1: the header must name t_s, yaw_deg and pitch_deg; it lacks {0}")]
    Header(&'static str),
    /// A value that is no number, not finite, or out of range.
    #[error("line {line}, column {column}: found \"{found}\", expected {expected}")]
    Value {
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// What stands there.
        found: String,
        /// What should.
        expected: &'static str,
    },
    /// Time does not grow.
    #[error(
        "line {line}, column t_s: t_s is {found}, not after {before}; sort the rows by time and \
         keep one of each"
    )]
    Backwards {
        /// Line in the file, from 1.
        line: usize,
        /// Its time.
        found: String,
        /// The time of the row before.
        before: String,
    },
    /// More cells than the header has names.
    #[error(
        "line {line}: {} where the header names {expected}; is a comma decimal?",
        counted(.found, "cell")
    )]
    Cells {
        /// Line in the file, from 1.
        line: usize,
        /// Number of cells.
        found: usize,
        /// Number of names.
        expected: usize,
    },
    /// Nothing but a header.
    #[error("the trace has no rows; it needs at least one sample")]
    Empty,
    /// Too many rows.
    #[error("line {0}: more than {MAX_ROWS} rows; cut the trace")]
    TooLong(usize),
    /// A line that no row needs.
    #[error("line {0}: longer than {MAX_LINE_BYTES} bytes; is this a trace?")]
    LongLine(usize),
    /// Bytes that are no text.
    #[error("line {0}: not UTF-8 text; is this a trace?")]
    NotText(usize),
}

/// Reads a trace line by line, so that no caller needs to hold its text.
#[derive(Clone, Debug, Default)]
pub struct TraceReader {
    lines: usize,
    header: Option<[Option<usize>; QUANTITIES.len()]>,
    /// Number of names in the header.
    columns: usize,
    rows: Vec<TraceRow>,
}

impl TraceReader {
    /// Reads the next line, with or without its line end. Refuses values that are not finite or
    /// out of range, time that does not grow, lines longer than [`MAX_LINE_BYTES`].
    pub fn line(&mut self, line: &[u8]) -> Result<(), TraceError> {
        self.lines += 1;
        if line.len() > MAX_LINE_BYTES {
            return Err(TraceError::LongLine(self.lines));
        }
        let text = core::str::from_utf8(line).map_err(|_| TraceError::NotText(self.lines))?;
        let Some(place) = self.header else {
            self.header = Some(header(text)?);
            self.columns = text.split(',').count();
            return Ok(());
        };
        if text.trim().is_empty() {
            return Ok(());
        }
        if self.rows.len() == MAX_ROWS {
            return Err(TraceError::TooLong(self.lines));
        }
        let cells: Vec<&str> = text.split(',').map(str::trim).collect();
        if cells.iter().skip(self.columns).any(|cell| !cell.is_empty()) {
            return Err(TraceError::Cells {
                line: self.lines,
                found: cells.len(),
                expected: self.columns,
            });
        }
        let cells = Cells {
            line: self.lines,
            cells,
            place,
        };
        let row = cells.row(self.rows.last())?;
        self.rows.push(row);
        Ok(())
    }

    /// The trace of all lines.
    pub fn finish(self) -> Result<Trace, TraceError> {
        if self.header.is_none() {
            return Err(TraceError::Header(QUANTITIES[T].name));
        }
        Trace::new(self.rows)
    }
}

impl Trace {
    /// Reads a trace. Refuses what [`TraceReader::line`] refuses, and a trace without rows.
    pub fn parse(text: &str) -> Result<Self, TraceError> {
        let mut reader = TraceReader::default();
        for line in text.lines() {
            reader.line(line.as_bytes())?;
        }
        reader.finish()
    }

    /// The trace of rows that were not read from text.
    ///
    /// # Errors
    /// There are none, more than a trace may have, or times that do not grow.
    pub fn from_rows(rows: Vec<TraceRow>) -> Result<Self, TraceError> {
        if rows.len() > MAX_ROWS {
            return Err(TraceError::TooLong(MAX_ROWS + 2));
        }
        let mut pairs = rows.windows(2).zip(3..);
        let falls = pairs.find(|(pair, _)| pair[1].time <= pair[0].time);
        match falls {
            Some((pair, line)) => Err(TraceError::Backwards {
                line,
                found: pair[1].time.0.to_string(),
                before: pair[0].time.0.to_string(),
            }),
            None => Self::new(rows),
        }
    }

    /// The trace as text that reads back as the same rows, to the bit; all columns are written.
    #[must_use]
    pub fn write(&self) -> String {
        let mut text = TraceRow::header();
        self.rows.iter().for_each(|row| row.write(&mut text));
        text
    }

    /// The rows, in the order of time.
    #[must_use]
    pub fn rows(&self) -> &[TraceRow] {
        &self.rows
    }

    /// The samples, in the order of time.
    #[must_use]
    pub fn samples(&self) -> &[GazeSample] {
        &self.samples
    }

    /// The newest sample at or before `time` (before the first: the first). While the eye is lost,
    /// what stands in for it ([`gaze_at`]).
    #[must_use]
    pub fn at(&self, time: Seconds) -> GazeSample {
        let after = self.samples.partition_point(|sample| sample.time <= time);
        let newest = after.saturating_sub(1);
        let seen = self.seen[newest].map(|place| &self.samples[place as usize]);
        gaze_at(time, &self.samples[newest], seen)
    }

    fn new(rows: Vec<TraceRow>) -> Result<Self, TraceError> {
        if rows.is_empty() {
            return Err(TraceError::Empty);
        }
        let samples: Vec<GazeSample> = rows.iter().map(TraceRow::sample).collect();
        let mut newest = None;
        let seen = samples.iter().zip(0..).map(|(sample, place)| {
            newest = if sample.valid { Some(place) } else { newest };
            newest
        });
        Ok(Self {
            seen: seen.collect(),
            rows,
            samples,
        })
    }
}

/// Where the columns are. A trace has a gaze or a head.
fn header(line: &str) -> Result<[Option<usize>; QUANTITIES.len()], TraceError> {
    let line = line.trim_start_matches('\u{feff}');
    let names: Vec<&str> = line.split(',').map(str::trim).collect();
    let place = QUANTITIES.map(|quantity| names.iter().position(|&name| name == quantity.name));
    let lacks = |needed: &[usize]| needed.iter().copied().find(|&k| place[k].is_none());
    let head_alone = place[YAW].is_none() && place[PITCH].is_none();
    let missing = match lacks(&[T, HEAD_YAW, HEAD_PITCH]) {
        None if head_alone => None,
        _ => lacks(&[T, YAW, PITCH]),
    };
    missing.map_or(Ok(place), |k| Err(TraceError::Header(QUANTITIES[k].name)))
}

struct Cells<'a> {
    line: usize,
    cells: Vec<&'a str>,
    place: [Option<usize>; QUANTITIES.len()],
}

impl Cells<'_> {
    fn row(&self, before: Option<&TraceRow>) -> Result<TraceRow, TraceError> {
        let time = self.number(T)?.ok_or_else(|| self.wrong(T))?;
        if let Some(before) = before.filter(|before| time <= before.time.0) {
            return Err(TraceError::Backwards {
                line: self.line,
                found: time.to_string(),
                before: before.time.0.to_string(),
            });
        }
        let gaze_deg = self.pair([YAW, PITCH])?;
        let valid = self.number(VALID)?.map(|valid| valid > 0.5);
        // Where the eye is said to be seen, by a column or by there being none, it has a direction.
        if gaze_deg.is_none() && self.place[YAW].is_some() && valid.unwrap_or(true) {
            return Err(self.wrong(YAW));
        }
        let head = self.pair([HEAD_YAW, HEAD_PITCH])?;
        let roll = self.number(HEAD_ROLL)?.unwrap_or_default();
        Ok(TraceRow {
            time: Seconds(time),
            received: Seconds(self.number(RECEIVED)?.unwrap_or(time)),
            gaze_deg,
            valid: gaze_deg.is_some() && valid.unwrap_or(true),
            spread_deg: self.number(SPREAD)?.unwrap_or_default(),
            head_deg: head.map(|[yaw, pitch]| [yaw, pitch, roll]),
        })
    }

    /// Two columns that only make sense together; `None` where a column is not there, or both
    /// cells are empty.
    fn pair(&self, columns: [usize; 2]) -> Result<Option<[f64; 2]>, TraceError> {
        if columns.iter().any(|&column| self.place[column].is_none()) {
            return Ok(None);
        }
        match columns.map(|column| self.number(column)) {
            [Ok(Some(a)), Ok(Some(b))] => Ok(Some([a, b])),
            [Ok(None), Ok(None)] => Ok(None),
            [Err(error), _] | [_, Err(error)] => Err(error),
            [Ok(None), _] => Err(self.wrong(columns[0])),
            [_, Ok(None)] => Err(self.wrong(columns[1])),
        }
    }

    /// The number in a column; `None` where the trace has no such column or the cell is empty.
    fn number(&self, column: usize) -> Result<Option<f64>, TraceError> {
        let cell = self.cell(column);
        if cell.is_empty() {
            return Ok(None);
        }
        let number = cell.parse::<f64>().ok();
        match number.filter(|number| QUANTITIES[column].holds(*number)) {
            Some(number) => Ok(Some(number)),
            None => Err(self.wrong(column)),
        }
    }

    fn cell(&self, column: usize) -> &str {
        let cell = self.place[column].and_then(|place| self.cells.get(place));
        cell.copied().unwrap_or_default()
    }

    fn wrong(&self, column: usize) -> TraceError {
        TraceError::Value {
            line: self.line,
            column: QUANTITIES[column].name,
            found: self.cell(column).chars().take(SHOWN).collect(),
            expected: QUANTITIES[column].expected,
        }
    }
}

/// Takes any bytes for a trace: the body of the fuzz target. Returns whether they were one.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    let Ok(text) = core::str::from_utf8(data) else {
        return false;
    };
    let Ok(trace) = Trace::parse(text) else {
        return false;
    };
    let samples = trace.samples();
    let middle = samples[samples.len() / 2].time;
    assert!(trace.at(middle).gaze_in_content.is_finite());
    assert!(Trace::parse(&trace.write()).is_ok_and(|again| again == trace));
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::yaw_pitch_from_direction;

    #[test]
    fn a_decimal_comma_is_refused_and_a_comma_at_the_end_is_not() {
        let head = "t_s,yaw_deg,pitch_deg\n";
        let error = Trace::parse(&format!("{head}0,1,2\n0,5,1,5,2,0\n")).unwrap_err();
        assert!(error.to_string().starts_with("line 3: 6 cells"), "{error}");
        assert!(Trace::parse(&format!("{head}0,1,2,\n")).is_ok());
    }

    #[test]
    fn columns_may_come_in_any_order_and_others_are_ignored() {
        let trace = Trace::parse("pitch_deg,note,t_s,yaw_deg\n5,x,0.0,-10\n6,,0.5,20\n").unwrap();
        let (yaw, pitch) = yaw_pitch_from_direction(trace.at(Seconds(0.6)).gaze_in_content);
        assert!((yaw.to_degrees() - 20.0).abs() < 1e-9 && (pitch.to_degrees() - 6.0).abs() < 1e-9);
    }

    #[test]
    fn a_sample_is_never_used_before_its_time() {
        let trace = Trace::parse("t_s,yaw_deg,pitch_deg\n1,10,0\n2,20,0\n").unwrap();
        let yaw = |t| {
            yaw_pitch_from_direction(trace.at(Seconds(t)).gaze_in_content)
                .0
                .to_degrees()
                .round()
        };
        assert_eq!(
            [0.0, 1.0, 1.99, 2.0, 9.0].map(yaw),
            [10.0, 10.0, 10.0, 20.0, 20.0]
        );
    }

    #[test]
    fn a_lost_eye_keeps_its_direction_and_grows_uncertain() {
        let text = "t_s,yaw_deg,pitch_deg,valid,spread_deg\n0,10,0,1,1\n0.5,0,0,0,1\n1,0,0,0,1\n";
        let trace = Trace::parse(text).unwrap();
        let lost = trace.at(Seconds(1.0));
        let (yaw, _) = yaw_pitch_from_direction(lost.gaze_in_content);
        assert!((yaw.to_degrees() - 10.0).abs() < 1e-9);
        assert!((lost.spread.to_degrees() - 8.0).abs() < 1e-9 && !lost.valid);
    }

    #[test]
    fn bad_rows_are_refused_with_their_line() {
        let head = "t_s,yaw_deg,pitch_deg\n";
        for (rows, part) in [
            ("0,NaN,0\n", "line 2, column yaw_deg"),
            ("0,0,0\n1,inf,0\n", "line 3, column yaw_deg"),
            (
                "1,0,0\n0.5,0,0\n",
                "line 3, column t_s: t_s is 0.5, not after 1",
            ),
            ("0,0\n", "line 2, column pitch_deg"),
            ("0,0,91\n", "line 2, column pitch_deg"),
            ("0,0,0\n0,0,0\n", "line 3, column t_s"),
            ("0,0,0\n1,,0\n", "line 3, column yaw_deg"),
            ("1e11,0,0\n", "line 2, column t_s"),
            ("", "no rows"),
        ] {
            let error = Trace::parse(&format!("{head}{rows}"))
                .unwrap_err()
                .to_string();
            assert!(error.contains(part), "{error}");
        }
        let error = Trace::parse("t_s,yaw\n0,0\n").unwrap_err().to_string();
        assert!(error.contains("lacks yaw_deg"), "{error}");
    }

    #[test]
    fn a_row_may_be_known_later_than_it_was_made() {
        let trace = Trace::parse("t_s,yaw_deg,pitch_deg,received_s\n0,1,2,0.25\n1,1,2,\n");
        let samples = trace.unwrap().samples().to_vec();
        assert_eq!(samples[0].received, Seconds(0.25));
        assert_eq!(samples[1].received, Seconds(1.0));
    }

    #[test]
    fn a_trace_of_a_head_alone_is_a_gaze_by_its_head() {
        let trace = Trace::parse("t_s,head_yaw_deg,head_pitch_deg\n0,10,5\n1,20,6\n").unwrap();
        let gaze = trace.at(Seconds(0.5));
        let (yaw, pitch) = yaw_pitch_from_direction(gaze.gaze_in_content);
        assert!((yaw.to_degrees() - 10.0).abs() < 1e-9 && (pitch.to_degrees() - 5.0).abs() < 1e-9);
        assert!(!gaze.valid && gaze.spread.to_degrees() > 5.0);
        let lacking = Trace::parse("t_s,head_yaw_deg\n0,10\n").unwrap_err();
        assert_eq!(lacking, TraceError::Header("yaw_deg"));
    }

    #[test]
    fn a_trace_that_is_written_and_read_again_is_the_same_to_the_bit() {
        let mut random = crate::view::random::Random::new(5);
        let mut text = "t_s,yaw_deg,pitch_deg,valid,spread_deg,head_yaw_deg,head_pitch_deg,\
                        head_roll_deg,received_s\n"
            .to_owned();
        let mut time = -3.7;
        for row in 0..2000 {
            time += random.unit() + 1e-9;
            let mut number = |most: f64| (random.unit() - 0.5) * 2.0 * most;
            let [yaw, pitch, spread] = [number(36_000.0), number(90.0), number(180.0).abs()];
            let head = [number(360.0), number(90.0), number(1e-300)];
            let head = head.map(|angle| {
                if row % 3 == 0 {
                    String::new()
                } else {
                    angle.to_string()
                }
            });
            let [head_yaw, head_pitch, head_roll] = head;
            let (gaze, valid) = match row % 7 {
                0 => (",".to_owned(), 0),
                _ => (format!("{yaw},{pitch}"), row % 2),
            };
            text += &format!(
                "{time},{gaze},{valid},{spread},{head_yaw},{head_pitch},{head_roll},{}\n",
                time + number(0.1)
            );
        }
        let trace = Trace::parse(&text).unwrap();
        let again = Trace::parse(&trace.write()).unwrap();
        let bits = |trace: &Trace| -> Vec<u64> {
            let of = |sample: &GazeSample| {
                let GazeSample {
                    time,
                    received,
                    gaze_in_content: at,
                    spread,
                    head,
                    ..
                } = *sample;
                let head = head.unwrap_or_default();
                [time.0, received.0, at.x, at.y, at.z, spread.0]
                    .into_iter()
                    .chain([head.yaw.0, head.pitch.0, head.roll.0])
                    .map(f64::to_bits)
            };
            trace.samples().iter().flat_map(of).collect()
        };
        assert_eq!(bits(&trace), bits(&again));
        assert_eq!(trace, again);
        assert_eq!(trace.write(), again.write());
    }

    #[test]
    fn a_line_without_end_and_bytes_that_are_no_text_are_refused_by_their_line() {
        let mut reader = TraceReader::default();
        reader.line(b"t_s,yaw_deg,pitch_deg\n").unwrap();
        let long = vec![b'1'; MAX_LINE_BYTES + 1];
        assert_eq!(reader.clone().line(&long), Err(TraceError::LongLine(2)));
        assert_eq!(reader.line(b"0,\xff,0"), Err(TraceError::NotText(2)));
    }

    #[test]
    fn a_generated_corpus_of_damaged_traces_never_panics() {
        let good = "t_s,yaw_deg,pitch_deg,valid,spread_deg\n0,1,2,1,0.5\n0.1,1,2,0,0.5\n";
        let mut state = 7u64;
        for _ in 0..5000 {
            let mut bad = good.as_bytes().to_vec();
            for _ in 0..3 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let place = (state >> 33) as usize % bad.len();
                bad[place] = b"0123456789.,-+eNaninf\n\xff"[(state >> 20) as usize % 22];
            }
            let _ = parse_anything(&bad);
        }
    }
}
