//! What does one row of a trace say, and how is it written?
//!
//! Angles stay in the degrees they were written in, so that a row that is read and written again
//! is the same to the bit. [`TraceRow::sample`] is what the rest of the program works with.

use crate::gaze::sample::{GazeSample, HeadPose};
use crate::units::{Radians, Seconds};
use crate::view::axes::direction_from_yaw_pitch;
use core::fmt::Write as _;
use glam::DVec3;

/// One quantity of a trace or of a network record: its name and what it may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    /// Name of the column or field.
    pub(super) name: &'static str,
    least: f64,
    most: f64,
    /// What is expected, for messages.
    pub(super) expected: &'static str,
}

impl Quantity {
    /// Whether a number is finite and within the range.
    pub(super) fn holds(&self, value: f64) -> bool {
        value >= self.least && value <= self.most
    }

    const fn new(name: &'static str, [least, most]: [f64; 2], expected: &'static str) -> Self {
        Self {
            name,
            least,
            most,
            expected,
        }
    }
}

const TIME: [f64; 2] = [-1e10, 1e10];
const SECONDS: &str = "seconds from -1e10 to 1e10";
const TURN: [f64; 2] = [-36_000.0, 36_000.0];
const TURNS: &str = "degrees from -36000 to 36000";
const ELEVATION: [f64; 2] = [-90.0, 90.0];
const ELEVATIONS: &str = "degrees from -90 to 90";

pub(super) const T: usize = 0;
pub(super) const RECEIVED: usize = 1;
pub(super) const YAW: usize = 2;
pub(super) const PITCH: usize = 3;
pub(super) const VALID: usize = 4;
pub(super) const SPREAD: usize = 5;
pub(super) const HEAD_YAW: usize = 6;
pub(super) const HEAD_PITCH: usize = 7;
pub(super) const HEAD_ROLL: usize = 8;

/// Every quantity, in the order in which columns are written.
pub(super) const QUANTITIES: [Quantity; 9] = [
    Quantity::new("t_s", TIME, SECONDS),
    Quantity::new("received_s", TIME, SECONDS),
    Quantity::new("yaw_deg", TURN, TURNS),
    Quantity::new("pitch_deg", ELEVATION, ELEVATIONS),
    Quantity::new("valid", [0.0, 1.0], "0 or 1"),
    Quantity::new("spread_deg", [0.0, 180.0], "degrees from 0 to 180"),
    Quantity::new("head_yaw_deg", TURN, TURNS),
    Quantity::new("head_pitch_deg", ELEVATION, ELEVATIONS),
    Quantity::new("head_roll_deg", TURN, TURNS),
];

/// One row of a trace, in the content's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceRow {
    /// When the eye looked there, by the clock of the source.
    pub time: Seconds,
    /// When that was known here, by the same clock.
    pub received: Seconds,
    /// Yaw to the right and pitch up, in degrees; `None` only where the row is not valid.
    pub gaze_deg: Option<[f64; 2]>,
    /// False while the eye is closed or lost, and where only the head is known.
    pub valid: bool,
    /// One standard deviation of the direction, in degrees.
    pub spread_deg: f64,
    /// Yaw to the right, pitch up and clockwise roll of the head, in degrees.
    pub head_deg: Option<[f64; 3]>,
}

impl TraceRow {
    /// The header line of what [`TraceRow::write`] writes, with its line end.
    #[must_use]
    pub fn header() -> String {
        let names = QUANTITIES.map(|quantity| quantity.name);
        format!("{}\n", names.join(","))
    }

    /// Appends the row as a line of CSV: the shortest digits that read back as the same numbers,
    /// nothing where nothing is known.
    pub fn write(&self, text: &mut String) {
        let gaze = self.gaze_deg.map_or([None; 2], |gaze| gaze.map(Some));
        let head = self.head_deg.map_or([None; 3], |head| head.map(Some));
        // Writing to a string cannot fail.
        let _ = write!(text, "{},{}", self.time.0, self.received.0);
        append(text, &gaze);
        let _ = write!(text, ",{},{}", u8::from(self.valid), self.spread_deg);
        append(text, &head);
        text.push('\n');
    }

    /// The row of a sample; its angles are those of the sample's directions, in degrees.
    #[must_use]
    pub fn of(sample: &GazeSample) -> Self {
        Self {
            time: sample.time,
            received: sample.received,
            gaze_deg: Some(degrees_of(sample.gaze_in_content)),
            valid: sample.valid,
            spread_deg: sample.spread.to_degrees().clamp(0.0, 180.0),
            head_deg: sample.head.map(|head| {
                let HeadPose { yaw, pitch, roll } = head;
                [yaw, pitch, roll].map(Radians::to_degrees)
            }),
        }
    }

    /// The row as a sample. Without a gaze the direction is the head's forward, without a head
    /// too the content's, and the sample is not valid.
    #[must_use]
    pub fn sample(&self) -> GazeSample {
        let head = self.head_deg.map(pose_of);
        let gaze_in_content = match (self.gaze_deg, head) {
            (Some(gaze_deg), _) => direction_of(gaze_deg),
            (None, Some(head)) => head.axes().forward,
            (None, None) => DVec3::NEG_Z,
        };
        GazeSample {
            time: self.time,
            received: self.received,
            gaze_in_content,
            valid: self.valid && self.gaze_deg.is_some(),
            spread: Radians::from_degrees(self.spread_deg),
            head,
        }
    }
}

/// Yaw and pitch in degrees of a direction; pitch stays within what a row may hold.
pub(super) fn degrees_of(direction: DVec3) -> [f64; 2] {
    let (yaw, pitch) = crate::view::axes::yaw_pitch_from_direction(direction);
    [yaw.to_degrees(), pitch.to_degrees().clamp(-90.0, 90.0)]
}

/// The direction of a yaw and pitch in degrees.
pub(super) fn direction_of([yaw, pitch]: [f64; 2]) -> DVec3 {
    direction_from_yaw_pitch(Radians::from_degrees(yaw), Radians::from_degrees(pitch))
}

/// The pose of a head's yaw, pitch and roll in degrees.
pub(super) fn pose_of(head_deg: [f64; 3]) -> HeadPose {
    let [yaw, pitch, roll] = head_deg.map(Radians::from_degrees);
    HeadPose { yaw, pitch, roll }
}

fn append(text: &mut String, numbers: &[Option<f64>]) {
    for number in numbers {
        text.push(',');
        if let Some(number) = number {
            let _ = write!(text, "{number}");
        }
    }
}
