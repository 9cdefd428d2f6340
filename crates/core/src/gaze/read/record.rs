//! What does one network record of a gaze say?
//!
//! A line of JSON, the one form in which any tracker can speak to Foveal. Normative text and test
//! vectors: docs/formats/gaze.md.

use crate::gaze::read::row::{
    HEAD_PITCH, HEAD_ROLL, HEAD_YAW, PITCH, QUANTITIES, Quantity, SPREAD, T, VALID, YAW,
};
use crate::units::Seconds;
use serde_json::{Map, Value};
use thiserror::Error;

/// Longest line that is read, in bytes, without its line end.
pub const MAX_RECORD_BYTES: usize = 4096;

/// Spread of a gaze whose sender says none, in degrees: what head-mounted trackers reach
/// (Schuetz and Fiehler 2022: 1.1° for the Vive Pro Eye).
pub const TRACKER_SPREAD_DEG: f64 = 1.0;

/// Longest piece of a sender's bytes that a message repeats, in characters.
const SHOWN: usize = 40;

/// The space that a record's gaze is measured in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GazeSpace {
    /// Yaw and pitch of the content's forward.
    #[default]
    Content,
    /// Yaw and pitch of where the head points.
    Head,
}

/// One record as it was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeRecord {
    /// When the eye looked there, by the sender's clock.
    pub time: Seconds,
    /// Yaw to the right and pitch up in degrees, in `space`; `None` only where it is not valid.
    pub gaze_deg: Option<[f64; 2]>,
    /// False while the eye is closed or lost, and where only the head is known.
    pub valid: bool,
    /// One standard deviation of the direction, in degrees.
    pub spread_deg: f64,
    /// What the gaze is measured from.
    pub space: GazeSpace,
    /// Yaw to the right, pitch up and clockwise roll of the head in the content's space, in
    /// degrees.
    pub head_deg: Option<[f64; 3]>,
}

/// Why bytes are no record.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RecordError {
    /// Longer than any record.
    #[error("a line of more than {MAX_RECORD_BYTES} bytes; a record is shorter")]
    TooLong,
    /// Not a JSON object.
    #[error("no JSON object: {0}")]
    NotJson(String),
    /// A field that must be there is not.
    #[error("field {field} is missing; {why}")]
    Missing {
        /// Name of the field.
        field: &'static str,
        /// When it must be there.
        why: &'static str,
    },
    /// A field that holds something else.
    #[error("field {field}: found {found}, expected {expected}")]
    Field {
        /// Name of the field.
        field: &'static str,
        /// What it holds.
        found: String,
        /// What it should.
        expected: &'static str,
    },
    /// An OSC message about eyes with values that cannot be.
    #[error("message {address}: found {found}, expected {expected}")]
    Message {
        /// The OSC address.
        address: String,
        /// The values.
        found: String,
        /// What they should be.
        expected: &'static str,
    },
}

impl GazeRecord {
    /// Reads one line (with or without its line end). Refuses more than [`MAX_RECORD_BYTES`],
    /// numbers out of range, half a direction; ignores fields it does not know.
    pub fn parse(line: &[u8]) -> Result<Self, RecordError> {
        let line = line.trim_ascii();
        if line.len() > MAX_RECORD_BYTES {
            return Err(RecordError::TooLong);
        }
        let fields: Map<String, Value> = serde_json::from_slice(line)
            .map_err(|error| RecordError::NotJson(shown(&error.to_string())))?;
        let fields = Fields(&fields);
        let gaze_deg = fields.pair([YAW, PITCH])?;
        let valid = fields.valid()?.unwrap_or(gaze_deg.is_some());
        let head_deg = match fields.pair([HEAD_YAW, HEAD_PITCH])? {
            Some([yaw, pitch]) => {
                let roll = fields.number(HEAD_ROLL)?.unwrap_or_default();
                Some([yaw, pitch, roll])
            }
            None => None,
        };
        if gaze_deg.is_none() && (valid || (head_deg.is_none() && !fields.has("valid"))) {
            return Err(RecordError::Missing {
                field: "yaw_deg",
                why: "a record has a gaze, a head, or \"valid\": false",
            });
        }
        Ok(Self {
            time: Seconds(fields.number(T)?.ok_or(RecordError::Missing {
                field: "t_s",
                why: "every record has the sender's time in seconds",
            })?),
            gaze_deg,
            valid,
            spread_deg: fields.number(SPREAD)?.unwrap_or(TRACKER_SPREAD_DEG),
            space: fields.space()?,
            head_deg,
        })
    }

    /// Whether the record speaks of nothing but the head.
    #[must_use]
    pub fn is_head_only(&self) -> bool {
        self.gaze_deg.is_none() && self.head_deg.is_some()
    }
}

struct Fields<'a>(&'a Map<String, Value>);

impl Fields<'_> {
    /// A field's value; `null` counts as absent.
    fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name).filter(|value| !value.is_null())
    }

    fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    fn number(&self, which: usize) -> Result<Option<f64>, RecordError> {
        let quantity: &Quantity = &QUANTITIES[which];
        let Some(value) = self.get(quantity.name) else {
            return Ok(None);
        };
        let number = value.as_f64().filter(|number| quantity.holds(*number));
        number.map(Some).ok_or_else(|| RecordError::Field {
            field: quantity.name,
            found: shown(&value.to_string()),
            expected: quantity.expected,
        })
    }

    /// Two fields that only make sense together.
    fn pair(&self, [first, second]: [usize; 2]) -> Result<Option<[f64; 2]>, RecordError> {
        let missing = |which: usize| RecordError::Missing {
            field: QUANTITIES[which].name,
            why: "a direction is yaw and pitch",
        };
        match (self.number(first)?, self.number(second)?) {
            (Some(a), Some(b)) => Ok(Some([a, b])),
            (None, None) => Ok(None),
            (Some(_), None) => Err(missing(second)),
            (None, Some(_)) => Err(missing(first)),
        }
    }

    fn valid(&self) -> Result<Option<bool>, RecordError> {
        match self.get(QUANTITIES[VALID].name) {
            Some(Value::Bool(valid)) => Ok(Some(*valid)),
            _ => Ok(self.number(VALID)?.map(|valid| valid > 0.5)),
        }
    }

    fn space(&self) -> Result<GazeSpace, RecordError> {
        let Some(space) = self.get("space") else {
            return Ok(GazeSpace::Content);
        };
        match space.as_str() {
            Some("content") => Ok(GazeSpace::Content),
            Some("head") => Ok(GazeSpace::Head),
            _ => Err(RecordError::Field {
                field: "space",
                found: shown(&space.to_string()),
                expected: "\"content\" or \"head\"",
            }),
        }
    }
}

/// The beginning of what a sender sent, for a message.
pub(super) fn shown(found: &str) -> String {
    found.chars().take(SHOWN).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<GazeRecord, String> {
        GazeRecord::parse(line.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_record_says_what_its_fields_say_and_unknown_ones_are_ignored() {
        let line = r#"{"t_s":12.5,"yaw_deg":-10.25,"pitch_deg":3,"valid":true,"spread_deg":0.5,
            "space":"head","head_yaw_deg":30,"head_pitch_deg":-2,"pupil":{"mm":[3.1,3.2]}}"#;
        let expected = GazeRecord {
            time: Seconds(12.5),
            gaze_deg: Some([-10.25, 3.0]),
            valid: true,
            spread_deg: 0.5,
            space: GazeSpace::Head,
            head_deg: Some([30.0, -2.0, 0.0]),
        };
        assert_eq!(parse(line), Ok(expected));
    }

    #[test]
    fn what_is_left_out_has_a_default() {
        let gaze = parse(r#"{"t_s":0,"yaw_deg":1,"pitch_deg":2}"#).unwrap();
        assert!(gaze.valid && gaze.space == GazeSpace::Content && gaze.head_deg.is_none());
        assert_eq!(gaze.spread_deg, TRACKER_SPREAD_DEG);
        let head = parse(r#"{"t_s":0,"head_yaw_deg":1,"head_pitch_deg":2}"#).unwrap();
        assert!(!head.valid && head.is_head_only());
        let lost = parse(r#"{"t_s":0,"valid":0}"#).unwrap();
        assert!(!lost.valid && !lost.is_head_only());
    }

    #[test]
    fn what_cannot_be_is_refused_by_the_name_of_its_field() {
        for (line, part) in [
            (
                r#"{"t_s":0,"yaw_deg":1,"pitch_deg":91}"#,
                "pitch_deg: found 91",
            ),
            (r#"{"t_s":0,"yaw_deg":"1","pitch_deg":9}"#, "yaw_deg"),
            (r#"{"t_s":0,"yaw_deg":1}"#, "pitch_deg is missing"),
            (r#"{"yaw_deg":1,"pitch_deg":2}"#, "t_s is missing"),
            (r#"{"t_s":1e300,"yaw_deg":1,"pitch_deg":2}"#, "t_s"),
            (
                r#"{"t_s":0,"yaw_deg":1,"pitch_deg":2,"spread_deg":-1}"#,
                "spread_deg",
            ),
            (
                r#"{"t_s":0,"yaw_deg":1,"pitch_deg":2,"valid":"yes"}"#,
                "valid",
            ),
            (
                r#"{"t_s":0,"yaw_deg":1,"pitch_deg":2,"space":"moon"}"#,
                "space",
            ),
            (
                r#"{"t_s":0,"yaw_deg":1,"pitch_deg":2,"head_yaw_deg":2}"#,
                "head_pitch_deg",
            ),
            (r#"{"t_s":0,"valid":true}"#, "yaw_deg is missing"),
            (r#"{"t_s":0}"#, "yaw_deg is missing"),
            (r#"{"t_s":0,"yaw_deg":NaN,"pitch_deg":2}"#, "no JSON object"),
            (
                r#"{"t_s":0,"yaw_deg":1e999,"pitch_deg":2}"#,
                "no JSON object",
            ),
            ("[1,2]", "no JSON object"),
            ("", "no JSON object"),
        ] {
            let error = parse(line).unwrap_err();
            assert!(error.contains(part), "{line}: {error}");
        }
        let long = format!(r#"{{"t_s":0,"note":"{}"}}"#, "x".repeat(5000));
        assert!(parse(&long).unwrap_err().contains("4096"));
        let deep = format!(r#"{{"t_s":0,"valid":0,"x":{}}}"#, "[".repeat(4000));
        assert!(parse(&deep).unwrap_err().contains("no JSON object"));
    }
}
