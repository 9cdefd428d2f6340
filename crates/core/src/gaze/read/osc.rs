//! Where does the eye look by the OSC messages of VR chat tools?
//!
//! Addresses, units and signs are VRChat's ("OSC Eye Tracking", docs.vrchat.com): angles in degrees
//! with pitch down and yaw to the right, vectors with x right, y up, z forward; and the avatar
//! parameters of VRCFaceTracking, in which 1 is 45°. All are measured from the head.

use crate::gaze::read::record::{GazeRecord, GazeSpace, RecordError, TRACKER_SPREAD_DEG, shown};
use crate::gaze::read::row::{degrees_of, direction_of};
use crate::units::Seconds;
use glam::DVec3;

/// Eyes more closed than this do not see: lids cover the pupil before they meet.
const CLOSED: f64 = 0.8;

/// The angle of an avatar parameter of 1, in degrees.
const PARAMETER_DEG: f64 = 45.0;

/// What the eye messages of one sender said so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EyeMessages {
    closed: bool,
    /// Avatar parameters of the left and the right eye: to the right, up.
    parameters: [[f64; 2]; 2],
}

impl EyeMessages {
    /// The record of a message that came at `time`; `None` for messages about other things, and
    /// where lids moved without the eye being lost. Refuses values that cannot be a direction.
    pub fn take(
        &mut self,
        address: &str,
        values: &[f64],
        time: Seconds,
    ) -> Result<Option<GazeRecord>, RecordError> {
        let wrong = |expected| RecordError::Message {
            address: shown(address),
            found: shown(&format!("{values:?}")),
            expected,
        };
        let gaze_in_head = match (address.strip_prefix("/tracking/eye/"), values) {
            (Some("EyesClosedAmount"), [amount]) if (0.0..=1.0).contains(amount) => {
                return Ok(self.blink(*amount, time));
            }
            (Some("EyesClosedAmount"), _) => return Err(wrong("one number from 0 to 1")),
            (Some(form), _) => match direction(form, values) {
                Some(found) => found.ok_or_else(|| wrong(expected(form)))?,
                None => return Ok(None),
            },
            (None, _) => match parameter(address) {
                Some((eyes, axis)) => self
                    .parameter(eyes, axis, values)
                    .ok_or_else(|| wrong("one number from -2 to 2"))?,
                None => return Ok(None),
            },
        };
        Ok(Some(self.record(Some(degrees_of(gaze_in_head)), time)))
    }

    fn blink(&mut self, amount: f64, time: Seconds) -> Option<GazeRecord> {
        let was = core::mem::replace(&mut self.closed, amount > CLOSED);
        (self.closed && !was).then(|| self.record(None, time))
    }

    fn parameter(&mut self, eyes: [bool; 2], axis: usize, values: &[f64]) -> Option<DVec3> {
        let [value] = values else { return None };
        if !(-2.0..=2.0).contains(value) {
            return None;
        }
        for eye in (0..2).filter(|eye| eyes[*eye]) {
            self.parameters[eye][axis] = *value;
        }
        let eyes = self.parameters;
        let gaze = eyes.map(|eye| direction_of(eye.map(|value| value * PARAMETER_DEG)));
        between(gaze)
    }

    fn record(&self, gaze_deg: Option<[f64; 2]>, time: Seconds) -> GazeRecord {
        GazeRecord {
            time,
            gaze_deg,
            valid: gaze_deg.is_some() && !self.closed,
            spread_deg: TRACKER_SPREAD_DEG,
            space: GazeSpace::Head,
            head_deg: None,
        }
    }
}

/// The direction of one of VRChat's forms: the outer `None` where it has another form, the inner
/// one where its values are no direction.
fn direction(form: &str, values: &[f64]) -> Option<Option<DVec3>> {
    Some(match (form, values) {
        ("CenterPitchYaw", [pitch, yaw]) => turned(*pitch, *yaw),
        ("CenterPitchYawDist", [pitch, yaw, _]) => turned(*pitch, *yaw),
        ("CenterVec" | "CenterVecFull", [x, y, z]) => along(*x, *y, *z),
        ("LeftRightPitchYaw", [left_pitch, left_yaw, right_pitch, right_yaw]) => both(
            turned(*left_pitch, *left_yaw),
            turned(*right_pitch, *right_yaw),
        ),
        ("LeftRightVec", [a, b, c, x, y, z]) => both(along(*a, *b, *c), along(*x, *y, *z)),
        _ if expected(form).is_empty() => return None,
        _ => None,
    })
}

/// What one of VRChat's forms holds; nothing for others.
fn expected(form: &str) -> &'static str {
    match form {
        "CenterPitchYaw" => "pitch and yaw in degrees",
        "CenterPitchYawDist" => "pitch and yaw in degrees and a distance",
        "CenterVec" | "CenterVecFull" => "x, y, z of a vector that is not 0",
        "LeftRightPitchYaw" => "pitch and yaw of the left eye, then of the right, in degrees",
        "LeftRightVec" => "x, y, z of the left eye, then of the right",
        _ => "",
    }
}

fn turned(pitch_down: f64, yaw: f64) -> Option<DVec3> {
    let fits = pitch_down.abs() <= 90.0 && yaw.abs() <= 180.0;
    fits.then(|| direction_of([yaw, -pitch_down]))
}

fn along(x: f64, y: f64, z: f64) -> Option<DVec3> {
    DVec3::new(x, y, -z).try_normalize()
}

fn both(left: Option<DVec3>, right: Option<DVec3>) -> Option<DVec3> {
    between([left?, right?])
}

/// Where two eyes look together.
fn between([left, right]: [DVec3; 2]) -> Option<DVec3> {
    (left + right).try_normalize()
}

/// Which eyes (left, right) and which axis (0 to the right, 1 up) an avatar parameter gives.
fn parameter(address: &str) -> Option<([bool; 2], usize)> {
    let name = address.strip_prefix("/avatar/parameters/")?;
    let name = name.strip_prefix("FT/").unwrap_or(name);
    Some(match name.strip_prefix("v2/").unwrap_or(name) {
        "EyeX" | "EyesX" => ([true, true], 0),
        "EyeY" | "EyesY" => ([true, true], 1),
        "EyeLeftX" | "LeftEyeX" => ([true, false], 0),
        "EyeLeftY" | "LeftEyeY" => ([true, false], 1),
        "EyeRightX" | "RightEyeX" => ([false, true], 0),
        "EyeRightY" | "RightEyeY" => ([false, true], 1),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gaze(address: &str, values: &[f64]) -> [f64; 2] {
        let mut messages = EyeMessages::default();
        let record = messages.take(address, values, Seconds(1.0)).unwrap();
        record.unwrap().gaze_deg.unwrap()
    }

    #[test]
    fn every_form_of_one_gaze_says_the_same() {
        // VRChat's own example: about 15° up and 20° to the right, 0.5 m away, eyes 64 mm apart.
        let expected = [20.128, 15.252];
        for (form, values) in [
            ("CenterPitchYaw", &[-15.252, 20.128][..]),
            ("CenterPitchYawDist", &[-15.252, 20.128, 0.503]),
            ("CenterVec", &[0.332, 0.263, 0.905]),
            ("CenterVecFull", &[0.167, 0.132, 0.455]),
            ("LeftRightPitchYaw", &[-15.252, 23.628, -15.252, 16.628]),
        ] {
            let found = gaze(&format!("/tracking/eye/{form}"), values);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 0.1, "{form}: {found}");
            }
        }
    }

    #[test]
    fn avatar_parameters_add_up_to_a_gaze() {
        let mut messages = EyeMessages::default();
        let mut take = |address: &str, value: f64| {
            let address = format!("/avatar/parameters/{address}");
            let record = messages.take(&address, &[value], Seconds(0.0)).unwrap();
            record.map(|record| record.gaze_deg.unwrap().map(f64::round))
        };
        assert_eq!(take("v2/EyeX", 0.2), Some([9.0, 0.0]));
        assert_eq!(take("FT/v2/EyeY", -0.4), Some([9.0, -18.0]));
        assert_eq!(take("v2/EyeLeftX", 0.4).unwrap()[0], 14.0);
        assert_eq!(take("v2/JawOpen", 0.4), None);
    }

    #[test]
    fn closed_lids_lose_the_eye_until_they_open() {
        let mut messages = EyeMessages::default();
        let mut take = |form: &str, values: &[f64]| {
            let address = format!("/tracking/eye/{form}");
            let record = messages.take(&address, values, Seconds(0.0)).unwrap();
            record.map(|record| record.valid)
        };
        assert_eq!(take("EyesClosedAmount", &[0.3]), None);
        assert_eq!(take("CenterPitchYaw", &[0.0, 0.0]), Some(true));
        assert_eq!(take("EyesClosedAmount", &[1.0]), Some(false));
        assert_eq!(take("EyesClosedAmount", &[1.0]), None);
        assert_eq!(take("CenterPitchYaw", &[0.0, 0.0]), Some(false));
        assert_eq!(take("EyesClosedAmount", &[0.0]), None);
        assert_eq!(take("CenterPitchYaw", &[0.0, 0.0]), Some(true));
    }

    #[test]
    fn values_that_are_no_direction_are_refused_by_their_address() {
        for (form, values) in [
            ("CenterPitchYaw", &[f64::NAN, 0.0][..]),
            ("CenterPitchYaw", &[0.0]),
            ("CenterPitchYaw", &[91.0, 0.0]),
            ("CenterVec", &[0.0, 0.0, 0.0]),
            ("CenterVec", &[f64::INFINITY, 0.0, 0.0]),
            ("LeftRightVec", &[1.0, 2.0, 3.0]),
            ("EyesClosedAmount", &[7.0]),
        ] {
            let address = format!("/tracking/eye/{form}");
            let mut messages = EyeMessages::default();
            let error = messages.take(&address, values, Seconds(0.0)).unwrap_err();
            assert!(error.to_string().contains(form), "{error}");
        }
    }
}
