//! How do the records of one sender become rows on one clock?

use crate::gaze::read::clock::SourceClock;
use crate::gaze::read::record::{GazeRecord, GazeSpace};
use crate::gaze::read::row::{TraceRow, degrees_of, direction_of, pose_of};
use crate::gaze::sample::HeadPose;
use crate::units::Seconds;

/// A sender of gazes that says nothing for this long, in seconds, has lost the eye: longer than
/// the steps of any tracker and the hiccups of a local network, shorter than most blinks matter.
const SILENCE_S: f64 = 0.25;

/// How long after the last gaze a loss is dated, in seconds, so that late records still count.
const LOSS_STEP_S: f64 = 1e-6;

/// The records of one sender so far: its clock, and what was last known of head and gaze.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeStream {
    clock: SourceClock,
    head_deg: Option<[f64; 3]>,
    gaze_deg: Option<[f64; 2]>,
    /// The newest row, and when it came by our clock.
    last: Option<(TraceRow, Seconds)>,
    late: u64,
}

impl GazeStream {
    /// The row of a record that arrived at `arrived` by our clock, which must not decrease.
    ///
    /// A gaze in the head's space is turned by the record's head, else the last known one, else a
    /// head that faces the content's forward. `None` for what is older than the newest row (it is
    /// counted, [`GazeStream::late`]) and for a head between gazes, which the next one carries.
    pub fn take(&mut self, record: &GazeRecord, arrived: Seconds) -> Option<TraceRow> {
        let Some(stamp) = self.clock.stamp(record.time, arrived) else {
            self.late += 1;
            return None;
        };
        self.head_deg = record.head_deg.or(self.head_deg);
        if record.is_head_only() && self.sees(arrived) {
            return None;
        }
        self.gaze_deg = match (record.gaze_deg, record.space) {
            (Some(gaze_deg), GazeSpace::Head) => Some(self.gaze_from_head(gaze_deg)),
            (gaze_deg, _) => gaze_deg.or(self.gaze_deg),
        };
        let row = TraceRow {
            time: stamp.time,
            received: stamp.received,
            gaze_deg: self.gaze_deg,
            valid: record.valid,
            spread_deg: record.spread_deg,
            head_deg: self.head_deg,
        };
        self.last = Some((row, arrived));
        Some(row)
    }

    /// A row that says the eye is lost, once, where its sender has been silent up to `now`.
    pub fn silence(&mut self, now: Seconds) -> Option<TraceRow> {
        let (last, arrived) = self.last.filter(|(last, _)| last.valid)?;
        if self.sees(now) {
            return None;
        }
        let time = Seconds(last.time.0 + LOSS_STEP_S);
        let row = TraceRow {
            time,
            received: Seconds(self.clock.now(now).0.max(time.0)),
            valid: false,
            head_deg: self.head_deg,
            ..last
        };
        self.last = Some((row, arrived));
        Some(row)
    }

    /// The time of rows at `ours` by our clock.
    #[must_use]
    pub fn now(&self, ours: Seconds) -> Seconds {
        self.clock.now(ours)
    }

    /// The sender's own time of a row at 0, once one came.
    #[must_use]
    pub fn start(&self) -> Option<Seconds> {
        self.clock.start()
    }

    /// How often the sender's clock restarted or leapt.
    #[must_use]
    pub fn anew(&self) -> u64 {
        self.clock.anew()
    }

    /// How many records were dated by their arrival, since the sender's clock leaps or stands.
    #[must_use]
    pub fn untimed(&self) -> u64 {
        self.clock.untimed()
    }

    /// How many records came too late to be used.
    #[must_use]
    pub fn late(&self) -> u64 {
        self.late
    }

    /// Whether a valid gaze came recently enough to still stand.
    fn sees(&self, now: Seconds) -> bool {
        self.last
            .is_some_and(|(last, arrived)| last.valid && now.0 - arrived.0 <= SILENCE_S)
    }

    fn gaze_from_head(&self, gaze_deg: [f64; 2]) -> [f64; 2] {
        let head = self.head_deg.map_or(HeadPose::default(), pose_of);
        degrees_of(head.content_from_head(direction_of(gaze_deg)))
    }
}

/// Takes any bytes for the lines of a sender: the body of the fuzz target. Returns how many rows
/// came of them, each of which is finite, later than the one before and survives being written.
#[must_use]
pub fn stream_anything(data: &[u8]) -> usize {
    let mut stream = GazeStream::default();
    let mut rows: Vec<TraceRow> = Vec::new();
    for (number, line) in data.split(|byte| *byte == b'\n').enumerate() {
        let arrived = Seconds(number as f64 * 0.01);
        let Ok(record) = GazeRecord::parse(line) else {
            continue;
        };
        if let Some(row) = stream.take(&record, arrived) {
            assert!(row.sample().gaze_in_content.is_finite(), "{row:?}");
            assert!(row.received >= row.time, "{row:?}");
            assert!(rows.last().is_none_or(|last| last.time < row.time));
            rows.push(row);
        }
    }
    let mut text = TraceRow::header();
    rows.iter().for_each(|row| row.write(&mut text));
    let read = crate::gaze::read::trace::Trace::parse(&text);
    assert!(rows.is_empty() || read.is_ok_and(|read| read.rows() == rows));
    rows.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    fn take(stream: &mut GazeStream, line: &str, arrived: f64) -> Option<TraceRow> {
        stream.take(
            &GazeRecord::parse(line.as_bytes()).unwrap(),
            Seconds(arrived),
        )
    }

    #[test]
    fn a_gaze_in_the_head_turns_with_the_head_that_was_last_known() {
        let mut stream = GazeStream::default();
        let head = r#"{"t_s":0,"head_yaw_deg":30,"head_pitch_deg":0}"#;
        assert!(!take(&mut stream, head, 0.0).unwrap().valid);
        let gaze = r#"{"t_s":0.1,"yaw_deg":10,"pitch_deg":5,"space":"head"}"#;
        let row = take(&mut stream, gaze, 0.1).unwrap();
        let [yaw, pitch] = row.gaze_deg.unwrap();
        assert!((yaw - 40.0).abs() < 1e-9 && (pitch - 5.0).abs() < 1e-9);
        // A head between two gazes waits for the second of them.
        let head = r#"{"t_s":0.2,"head_yaw_deg":0,"head_pitch_deg":20,"head_roll_deg":90}"#;
        assert_eq!(take(&mut stream, head, 0.2), None);
        let gaze = r#"{"t_s":0.3,"yaw_deg":0,"pitch_deg":10,"space":"head"}"#;
        let [yaw, pitch] = take(&mut stream, gaze, 0.3).unwrap().gaze_deg.unwrap();
        // A head tilted clockwise by 90° has its up to the right.
        assert!(yaw > 10.0 && pitch < 20.0, "{yaw} {pitch}");
    }

    #[test]
    fn a_sender_that_stops_loses_the_eye_once_and_may_come_back() {
        let mut stream = GazeStream::default();
        let gaze = |t: f64| format!(r#"{{"t_s":{t},"yaw_deg":1,"pitch_deg":2}}"#);
        take(&mut stream, &gaze(5.0), 100.0).unwrap();
        assert_eq!(stream.silence(Seconds(100.2)), None);
        let lost = stream.silence(Seconds(100.4)).unwrap();
        assert!(!lost.valid && lost.time.0 < 1e-3 && (lost.received.0 - 0.4).abs() < 1e-9);
        assert_eq!(stream.silence(Seconds(101.0)), None);
        assert!(take(&mut stream, &gaze(5.01), 101.0).unwrap().valid);
    }

    #[test]
    fn a_head_goes_on_speaking_when_the_gaze_has_stopped() {
        let mut stream = GazeStream::default();
        take(&mut stream, r#"{"t_s":0,"yaw_deg":1,"pitch_deg":2}"#, 0.0).unwrap();
        let head = |t: f64| format!(r#"{{"t_s":{t},"head_yaw_deg":7,"head_pitch_deg":0}}"#);
        assert_eq!(take(&mut stream, &head(0.1), 0.1), None);
        let row = take(&mut stream, &head(0.5), 0.5).unwrap();
        assert!(!row.valid && row.gaze_deg == Some([1.0, 2.0]));
        assert_eq!(row.head_deg, Some([7.0, 0.0, 0.0]));
    }

    #[test]
    fn the_test_vectors_of_the_format_hold() {
        let text = include_str!("../../../../../docs/formats/gaze.md");
        let vectors = text.lines().filter_map(|line| line.split_once(" => "));
        let mut count = 0;
        for (sent, expected) in vectors {
            count += 1;
            let mut found = String::new();
            match GazeRecord::parse(sent.as_bytes()) {
                Ok(record) => {
                    let row = GazeStream::default().take(&record, Seconds(3.0));
                    row.unwrap().write(&mut found);
                    assert_eq!(found.trim_end(), expected, "{sent}");
                }
                Err(error) => assert!(error.to_string().starts_with(expected), "{error}"),
            }
        }
        assert_eq!(count, 13);
    }

    #[test]
    fn a_generated_corpus_of_damaged_records_never_panics() {
        let good = concat!(
            r#"{"t_s":0.5,"yaw_deg":1,"pitch_deg":2,"valid":true,"space":"head"}"#,
            "\n",
            r#"{"t_s":0.6,"head_yaw_deg":170,"head_pitch_deg":-9e1,"spread_deg":3}"#,
            "\n",
            r#"{"t_s":17.5,"yaw_deg":-1,"pitch_deg":90,"space":"content"}"#,
            "\n",
        );
        assert_eq!(stream_anything(good.as_bytes()), 2);
        let (mut random, mut rows) = (Random::new(1), 0);
        let letters = b"0123456789.,-+e{}:\"nul tfasyd_\n\xff";
        for _ in 0..5000 {
            let mut bad = good.as_bytes().to_vec();
            for _ in 0..3 {
                let place = (random.unit() * bad.len() as f64) as usize;
                bad[place] = letters[(random.unit() * letters.len() as f64) as usize];
            }
            rows += stream_anything(&bad);
        }
        assert!(rows > 1000, "{rows}: the corpus is too damaged to try much");
    }
}
