//! What does a recorded gaze trace say?
//!
//! CSV with a header line: `t_s, yaw_deg, pitch_deg` and optionally `valid`, `spread_deg`,
//! `head_yaw_deg, head_pitch_deg, head_roll_deg`, in any order; other columns are ignored.

use super::sample::{GazeSample, HeadPose};
use crate::units::{Radians, Seconds};
use thiserror::Error;

/// Growth of the spread while the eye is lost, in degrees per second: a gaze that is not seen for
/// a second is about as uncertain as one guessed from the head (7°).
const LOST_SPREAD_DEG_PER_S: f64 = 7.0;

/// Most rows of a trace: a day at 1000 Hz.
const MAX_ROWS: usize = 86_400_000;

/// A recorded gaze, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    samples: Vec<GazeSample>,
}

/// Why text is no trace.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TraceError {
    /// No header line.
    #[error("line 1: the header must name t_s, yaw_deg and pitch_deg; it lacks {0}")]
    Header(&'static str),
    /// A value that is no number, or not finite.
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
    #[error("line {line}: t_s is {found}, not after {before}; sort the rows by time")]
    Backwards {
        /// Line in the file, from 1.
        line: usize,
        /// Its time.
        found: String,
        /// The time of the row before.
        before: String,
    },
    /// Nothing but a header.
    #[error("the trace has no rows; it needs at least one sample")]
    Empty,
    /// Too long.
    #[error("line {0}: more rows than are read; cut the trace")]
    TooLong(usize),
}

/// The columns that are read; the first three must be there.
const COLUMNS: [&str; 8] = [
    "t_s",
    "yaw_deg",
    "pitch_deg",
    "valid",
    "spread_deg",
    "head_yaw_deg",
    "head_pitch_deg",
    "head_roll_deg",
];

impl Trace {
    /// Reads a trace. Refuses values that are not finite, time that does not grow, pitch beyond
    /// ±90°, a negative spread.
    pub fn parse(text: &str) -> Result<Self, TraceError> {
        let mut lines = text.lines().enumerate();
        let header: Vec<&str> = match lines.next() {
            Some((_, line)) => line
                .trim_start_matches('\u{feff}')
                .split(',')
                .map(str::trim)
                .collect(),
            None => return Err(TraceError::Header("t_s")),
        };
        let place = COLUMNS.map(|name| header.iter().position(|&found| found == name));
        if let Some(missing) = (0..3).find(|&k| place[k].is_none()) {
            return Err(TraceError::Header(COLUMNS[missing]));
        }
        let mut samples: Vec<GazeSample> = Vec::new();
        for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            if samples.len() == MAX_ROWS {
                return Err(TraceError::TooLong(number + 1));
            }
            let row = Row {
                line: number + 1,
                fields: line.split(',').map(str::trim).collect(),
                place,
            };
            let sample = row.sample(samples.last())?;
            samples.push(sample);
        }
        if samples.is_empty() {
            Err(TraceError::Empty)
        } else {
            Ok(Self { samples })
        }
    }

    /// The samples, in the order of time.
    #[must_use]
    pub fn samples(&self) -> &[GazeSample] {
        &self.samples
    }

    /// The newest sample at or before `time` (before the first: the first). While the eye is lost,
    /// the last valid direction with a spread that grows.
    #[must_use]
    pub fn at(&self, time: Seconds) -> GazeSample {
        let after = self.samples.partition_point(|sample| sample.time <= time);
        let now = self.samples[after.saturating_sub(1)];
        if now.valid {
            return now;
        }
        let seen = self.samples[..after]
            .iter()
            .rev()
            .find(|sample| sample.valid);
        let seen = *seen.unwrap_or(&now);
        let lost_s = (time.0 - seen.time.0).max(0.0);
        GazeSample {
            gaze_in_content: seen.gaze_in_content,
            spread: Radians(
                seen.spread.0 + Radians::from_degrees(LOST_SPREAD_DEG_PER_S).0 * lost_s,
            ),
            ..now
        }
    }
}

struct Row<'a> {
    line: usize,
    fields: Vec<&'a str>,
    place: [Option<usize>; 8],
}

impl Row<'_> {
    fn sample(&self, before: Option<&GazeSample>) -> Result<GazeSample, TraceError> {
        let time = self
            .number(0, f64::MIN, f64::MAX, "seconds")?
            .unwrap_or_default();
        if let Some(before) = before.filter(|before| time <= before.time.0) {
            return Err(TraceError::Backwards {
                line: self.line,
                found: time.to_string(),
                before: before.time.0.to_string(),
            });
        }
        let degrees = |column, most: f64| {
            let value = self.number(column, -most, most, "degrees")?;
            Ok(value.map(Radians::from_degrees))
        };
        let yaw = degrees(1, 36_000.0)?.unwrap_or_default();
        let pitch = degrees(2, 90.0)?.unwrap_or_default();
        let head = match (
            degrees(5, 36_000.0)?,
            degrees(6, 90.0)?,
            degrees(7, 36_000.0)?,
        ) {
            (Some(yaw), Some(pitch), roll) => Some(HeadPose {
                yaw,
                pitch,
                roll: roll.unwrap_or_default(),
            }),
            _ => None,
        };
        let valid = self
            .number(3, 0.0, 1.0, "0 or 1")?
            .is_none_or(|valid| valid > 0.5);
        let spread = self
            .number(4, 0.0, 180.0, "degrees from 0 to 180")?
            .unwrap_or_default();
        Ok(GazeSample {
            valid,
            spread: Radians::from_degrees(spread),
            head,
            ..GazeSample::at(Seconds(time), yaw, pitch)
        })
    }

    /// The finite number in a column; `None` where the trace has no such column.
    fn number(
        &self,
        column: usize,
        least: f64,
        most: f64,
        expected: &'static str,
    ) -> Result<Option<f64>, TraceError> {
        let Some(place) = self.place[column] else {
            return Ok(None);
        };
        let found = self.fields.get(place).copied().unwrap_or_default();
        match found.parse::<f64>() {
            Ok(value) if value.is_finite() && value >= least && value <= most => Ok(Some(value)),
            _ => Err(TraceError::Value {
                line: self.line,
                column: COLUMNS[column],
                found: found.to_owned(),
                expected,
            }),
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
    trace.at(middle).gaze_in_content.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::yaw_pitch_from_direction;

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
            ("1,0,0\n0.5,0,0\n", "line 3: t_s is 0.5, not after 1"),
            ("0,0\n", "line 2, column pitch_deg"),
            ("0,0,91\n", "line 2, column pitch_deg"),
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
