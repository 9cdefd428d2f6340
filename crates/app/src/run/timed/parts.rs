//! Where does the time of a frame go?

use foveal_play::FrameReport;
use serde::Serialize;
use std::time::Duration;

/// What one frame took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameTimes {
    pub(crate) choose: Duration,
    pub(crate) decode: Duration,
    upload: Duration,
    /// Of frames that were drawn.
    draw: Option<Duration>,
    wait: Duration,
    decodes: u32,
    /// Whether the eye had just jumped.
    pub(crate) jumped: bool,
}

impl FrameTimes {
    pub(crate) fn of(report: &FrameReport, is_drawn: bool, jumped: bool) -> Self {
        Self {
            choose: report.choose,
            decode: report.decode,
            upload: report.upload,
            draw: is_drawn.then_some(report.draw),
            wait: report.wait,
            decodes: report.decodes,
            jumped,
        }
    }

    /// Seconds of choosing and decoding.
    pub(crate) fn seconds(&self) -> f64 {
        (self.choose + self.decode).as_secs_f64()
    }
}

/// A part of the time of all frames, in milliseconds; `None` where no frame has it.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct FramePart {
    pub(crate) ms_mean: Option<f64>,
    ms_median: Option<f64>,
    /// Of the frames in which the gaze jumped.
    jump_ms_mean: Option<f64>,
}

impl FramePart {
    fn of(frames: &[FrameTimes], part: impl Fn(&FrameTimes) -> Option<Duration>) -> Self {
        let ms = |frame: &FrameTimes| part(frame).map(|time| time.as_secs_f64() * 1e3);
        let mut all: Vec<f64> = frames.iter().filter_map(ms).collect();
        let jumps = frames.iter().filter(|frame| frame.jumped);
        let jumps: Vec<f64> = jumps.filter_map(ms).collect();
        all.sort_by(f64::total_cmp);
        Self {
            ms_mean: mean(&all),
            ms_median: all.get(all.len() / 2).copied(),
            jump_ms_mean: mean(&jumps),
        }
    }

    fn text(self, name: &str) -> String {
        let ms = |time: Option<f64>| time.map_or("-".to_owned(), |ms| format!("{ms:.2}"));
        let Self {
            ms_mean,
            ms_median,
            jump_ms_mean,
        } = self;
        let [mean, median, jump] = [ms_mean, ms_median, jump_ms_mean].map(ms);
        format!("{name} {mean} ({median}; {jump})")
    }
}

/// Where the time of all frames but the first went, with which everything begins.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Parts {
    choose: FramePart,
    pub(crate) decode: FramePart,
    upload: FramePart,
    /// Until the picture is done, without reading it back; of some frames.
    draw: FramePart,
    /// What the others leave of the frame's time.
    wait: FramePart,
}

impl Parts {
    pub(crate) fn of(frames: &[FrameTimes]) -> Self {
        let frames = frames.get(1..).unwrap_or_default();
        Self {
            choose: FramePart::of(frames, |it| Some(it.choose)),
            decode: FramePart::of(frames, |it| Some(it.decode)),
            upload: FramePart::of(frames, |it| Some(it.upload)),
            draw: FramePart::of(frames, |it| it.draw),
            wait: FramePart::of(frames, |it| Some(it.wait)),
        }
    }

    /// For people.
    pub(crate) fn text(self) -> String {
        let parts = [
            ("choose", self.choose),
            ("decode", self.decode),
            ("upload", self.upload),
            ("draw", self.draw),
            ("wait", self.wait),
        ];
        parts.map(|(name, part)| part.text(name)).join(", ")
    }
}

/// Pictures of tiles decoded for a frame, on average.
pub(crate) fn decodes_per_frame(frames: &[FrameTimes]) -> f64 {
    let decodes: Vec<f64> = frames.iter().map(|it| f64::from(it.decodes)).collect();
    mean(&decodes).unwrap_or_default()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_of_the_frames_that_have_it_and_jumps_stand_apart() {
        let frame = |ms, drawn: Option<u64>, jumped| FrameTimes {
            choose: Duration::from_millis(ms),
            decode: Duration::ZERO,
            upload: Duration::ZERO,
            draw: drawn.map(Duration::from_millis),
            wait: Duration::ZERO,
            decodes: ms as u32,
            jumped,
        };
        // The first frame counts in no part.
        let frames = [
            frame(900, Some(900), true),
            frame(1, None, false),
            frame(2, Some(5), false),
            frame(9, None, true),
        ];
        let Parts { choose, draw, .. } = Parts::of(&frames);
        assert_eq!(choose.ms_mean, Some(4.0));
        assert_eq!(choose.ms_median, Some(2.0));
        assert_eq!(choose.jump_ms_mean, Some(9.0));
        assert_eq!(draw.ms_mean, Some(5.0));
        assert_eq!(draw.jump_ms_mean, None);
        assert_eq!(Parts::of(&[]).choose.ms_median, None);
        assert_eq!(decodes_per_frame(&frames[1..]), 4.0);
    }
}
