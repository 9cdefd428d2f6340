//! How is a run logged whose view or policy changed on the way?
//!
//! As several sessions, one after the other: each begins with a head, whose line differs
//! from the lines of frames, and is selected again by itself.

use crate::session::log::{DemandOf, SessionError, SessionLogPart};

/// What the line of a head begins with.
const HEAD: &str = "{\"foveal_session\":";

/// The sessions of a run, in order; at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionLog {
    /// Each under one view and one policy.
    pub parts: Vec<SessionLogPart>,
}

impl SessionLog {
    /// Reads a log; refuses what [`SessionLogPart::parse`] refuses, with the line in the file.
    ///
    /// ```
    /// use foveal_core::session::log_of_parts::SessionLog;
    /// assert!(SessionLog::parse("").is_err());
    /// ```
    pub fn parse(text: &str) -> Result<Self, SessionError> {
        let mut parts = Vec::new();
        let (mut rest, mut before) = (text, 0);
        loop {
            let mut heads = rest.match_indices(HEAD).map(|(at, _)| at);
            let next = heads.find(|&at| at > 0 && rest.as_bytes()[at - 1] == b'\n');
            let (part, after) = rest.split_at(next.unwrap_or(rest.len()));
            parts.push(SessionLogPart::parse(part).map_err(|error| moved(error, before))?);
            before += part.lines().count();
            if after.is_empty() {
                return Ok(Self { parts });
            }
            rest = after;
        }
    }

    /// The log as text.
    #[must_use]
    pub fn write(&self) -> String {
        self.parts.iter().map(SessionLogPart::write).collect()
    }

    /// Whether replaying takes the content.
    #[must_use]
    pub fn needs_content(&self) -> bool {
        self.parts.iter().any(SessionLogPart::needs_content)
    }

    /// The same run selected again from what was given; see [`SessionLogPart::replay`].
    #[must_use]
    pub fn replay(&self, demand_of: DemandOf<'_>) -> Self {
        let parts = self.parts.iter().map(|part| part.replay(demand_of));
        Self {
            parts: parts.collect(),
        }
    }
}

/// An error with its line counted from the start of the file.
fn moved(error: SessionError, before: usize) -> SessionError {
    match error {
        SessionError::Line { line, why } => SessionError::Line {
            line: line + before,
            why,
        },
        SessionError::Version { line, found } => SessionError::Version {
            line: line + before,
            found,
        },
        SessionError::Empty => SessionError::Empty,
    }
}

/// Takes any bytes for a session log: the body of the fuzz target. Returns whether they were one.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    let Ok(text) = core::str::from_utf8(data) else {
        return false;
    };
    SessionLog::parse(text).is_ok_and(|log| SessionLog::parse(&log.write()).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::policy::{Policy, PolicyConfig};
    use crate::content::scripted::scripted_head;
    use crate::content::video::demand::VideoDemand;
    use crate::gaze::sample::GazeSample;
    use crate::perception::moment::Moment;
    use crate::selection::scheduler::Scheduler;
    use crate::session::log::{SessionFrame, SessionHead};
    use crate::session::scripted::scripted_sessions;
    use crate::units::{Radians, Seconds};
    use crate::view::axes::Axes;
    use crate::view::eye_view::{EyeView, Field};
    use crate::view::surface::Surface;

    /// Frames under one policy in a window whose picture shows `tangent` to each side.
    fn part(policy: Policy, tangent: f64) -> SessionLogPart {
        let head = scripted_head(Surface::cube(2048));
        let config = PolicyConfig::new(policy);
        let field = Field {
            at_eye: Some([0.4; 4]),
            ..Field::symmetric([tangent; 2])
        };
        let view = EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field,
            size: [800, 800],
            eye: Default::default(),
        };
        let mut scheduler = Scheduler::new(
            &config,
            vec![Box::new(VideoDemand::of_head(&head, &config))],
        );
        let frames = (0..5).map(|frame| {
            let yaw = Radians::from_degrees(f64::from(frame) * 3.0);
            let gaze = GazeSample::at(Seconds(f64::from(frame)), yaw, Radians(0.0));
            let moment = Moment {
                behind_sound: Some(Seconds(0.004)),
                ..Moment::new(gaze, vec![view])
            };
            let chosen = scheduler.choose(&[frame], &moment, None);
            SessionFrame::new(frame, &moment, None, &chosen[0].record)
        });
        SessionLogPart {
            frames: frames.collect(),
            head: SessionHead::new("made", head, config, &[view]),
        }
    }

    #[test]
    fn a_run_that_was_zoomed_and_given_another_policy_replays_to_the_same_text() {
        let log = SessionLog {
            parts: vec![
                part(Policy::Viewport, 1.0),
                part(Policy::Viewport, 0.01),
                part(Policy::Acuity, 1.0),
            ],
        };
        let text = log.write();
        let read = SessionLog::parse(&text).unwrap();
        assert_eq!(read, log);
        let again = read.replay(&|_, head, config| Box::new(VideoDemand::of_head(head, config)));
        assert_eq!(again.write(), text);
    }

    #[test]
    fn a_damaged_line_of_a_later_part_is_named_by_its_place_in_the_file() {
        let log = SessionLog {
            parts: vec![part(Policy::Viewport, 1.0), part(Policy::Acuity, 1.0)],
        };
        let text = log.write();
        let at = text.rfind("\"frame\":4").unwrap();
        let damaged = format!("{}x{}", &text[..at + 8], &text[at + 9..]);
        let error = SessionLog::parse(&damaged).unwrap_err().to_string();
        assert!(error.starts_with("line 12"), "{error}");
    }

    #[test]
    fn another_version_in_a_later_head_is_named_by_its_place_in_the_file() {
        let log = SessionLog {
            parts: vec![part(Policy::Viewport, 1.0), part(Policy::Acuity, 1.0)],
        };
        let text = log.write();
        let at = text.rfind(HEAD).unwrap() + HEAD.len();
        let other = format!("{}7{}", &text[..at], &text[at + 1..]);
        let error = SessionLog::parse(&other).unwrap_err().to_string();
        assert_eq!(error, "line 7, foveal_session: found 7, expected 1");
    }

    #[test]
    fn a_window_zoomed_between_the_probes_of_a_cell_is_shown_at_its_finest() {
        for policy in [Policy::Viewport, Policy::Acuity] {
            let zoomed = part(policy, 1e-3);
            assert!(
                zoomed.frames[0].per_level[0] > 0,
                "{:?}",
                zoomed.frames[0].per_level
            );
        }
    }

    #[test]
    fn a_generated_corpus_of_damaged_logs_never_panics() {
        let good = scripted_sessions()[1].write();
        let good = &good[..good.len().min(4000)];
        let mut state = 3u64;
        for _ in 0..3000 {
            let mut bad = good.as_bytes().to_vec();
            for _ in 0..3 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let place = (state >> 33) as usize % bad.len().min(700);
                bad[place] = b"0123456789.,-+e\"{}[]:\xff"[(state >> 20) as usize % 22];
            }
            let _ = parse_anything(&bad);
        }
    }
}
