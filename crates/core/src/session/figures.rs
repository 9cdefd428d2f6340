//! What did a window or a page do so far, in numbers?

use crate::units::Seconds;
use std::collections::VecDeque;

/// How much of the past counts for rates, in seconds.
const WINDOW_S: f64 = 2.0;
/// Drawings that predict how long the next will take; the slowest of them is an exception.
const DRAWS: usize = 9;
/// What the longest of the first two drawings is multiplied by to predict how long the next may
/// take.
const FIRST_DRAWS: f64 = 1.5;
/// Longest time of drawing that is made up for by showing a later frame, in seconds.
pub const MOST_DRAW_S: f64 = 0.5;
/// Most frames that are remembered.
const MOST: usize = 1024;

/// How a frame came on screen.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameOutcome {
    /// Frames before it that never came, because it was due.
    pub left_out: u64,
    /// It came after its time.
    pub late: bool,
    /// A coarser unit stood in for one of its own.
    pub incomplete: bool,
}

/// What is counted while a window is open.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// When frames of the content were shown lately, and bytes uploaded by then.
    lately: VecDeque<(f64, u64)>,
    uploaded_bytes: u64,
    /// Smoothed time from asking for a frame's units until all were there, in ms.
    pub decode_ms: f64,
    /// Samples that decoders made.
    pub decoded_samples: u64,
    /// Frames of the content shown.
    pub frames: u64,
    /// Frames never shown, because the next was due.
    pub left_out_frames: u64,
    /// Frames shown after their time.
    pub late_frames: u64,
    /// Frames shown with a coarser unit in the place of one that was chosen.
    pub incomplete_frames: u64,
    /// Frames that took longer to draw than they last.
    pub slow_draws: u64,
    /// Time from choosing what is shown until it is drawn, in seconds, at most [`MOST_DRAW_S`]: the
    /// recent median.
    pub draw_s: f64,
    /// What that time stays below but now and then, in seconds.
    pub most_draw_s: f64,
    /// The latest of those times, oldest first.
    draws: VecDeque<f64>,
    /// Units that could not be decoded.
    pub damaged_units: u64,
    /// Frames whose coarsest level was damaged: the frame before stayed.
    pub damaged_frames: u64,
    /// Times that the graphics device was lost.
    pub lost_devices: u64,
    /// What the GPU's driver complained about.
    pub gpu_errors: u64,
    /// Units that were on screen with another frame than their own.
    pub wrong_frame_units: u64,
    /// Units on screen by level, finest first.
    pub histogram: Vec<u32>,
    /// Samples of those units over the samples of the finest level.
    pub share: f64,
    /// Bytes of GPU memory in use.
    pub gpu_bytes: u64,
    /// Bytes of units that were fetched, each time they were.
    pub fetched_bytes: u64,
    /// Those of them that had been fetched before, and had left the client's memory since.
    pub refetched_bytes: u64,
}

impl Figures {
    /// Samples were decoded.
    pub fn decoded(&mut self, samples: u64) {
        self.decoded_samples += samples;
    }

    /// So many bytes went to the GPU.
    pub fn uploaded(&mut self, bytes: u64) {
        self.uploaded_bytes += bytes;
    }

    /// All units of a frame were there after `seconds`.
    pub fn complete(&mut self, seconds: f64) {
        let ms = seconds * 1e3;
        self.decode_ms += (ms - self.decode_ms) * if self.frames < 2 { 1.0 } else { 0.1 };
    }

    /// What was to be shown was drawn `seconds` later; a frame lasts `period`. A slow drawing now
    /// and then, as the first ones are, says nothing of the next.
    pub fn drawn(&mut self, seconds: f64, period: Seconds) {
        if self.draws.len() == DRAWS {
            self.draws.pop_front();
        }
        self.draws.push_back(seconds.min(MOST_DRAW_S));
        let mut sorted: Vec<f64> = self.draws.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len() - 1;
        self.draw_s = sorted[last / 2];
        // The first ones have the processor for themselves, or wait for what is made once.
        self.most_draw_s = match last {
            0 | 1 => (sorted[last] * FIRST_DRAWS).min(MOST_DRAW_S),
            _ => sorted[last - 1],
        };
        self.slow_draws += u64::from(seconds > period.0);
    }

    /// How long nothing else is shown because a picture is drawn: 0 where that is not longer than
    /// the `period` of a frame, and else what most pictures stay below.
    #[must_use]
    pub fn slow_draw(&self, period: Seconds) -> Seconds {
        let slow = self.draw_s > period.0;
        Seconds(if slow { self.most_draw_s } else { 0.0 })
    }

    /// A frame of the content came on screen.
    pub fn shown(&mut self, now: Seconds, how: FrameOutcome) {
        self.frames += 1;
        self.left_out_frames += how.left_out;
        self.late_frames += u64::from(how.late);
        self.incomplete_frames += u64::from(how.incomplete);
        if self.lately.len() == MOST {
            self.lately.pop_front();
        }
        self.lately.push_back((now.0, self.uploaded_bytes));
    }

    /// Recent frames a second and megabytes a second.
    #[must_use]
    pub fn rates(&self, now: Seconds) -> [f64; 2] {
        let recent = |(at, _): &&(f64, u64)| now.0 - at <= WINDOW_S;
        let mut lately = self.lately.iter().filter(recent);
        let Some((first, bytes)) = lately.next() else {
            return [0.0; 2];
        };
        let passed = (now.0 - first).max(1e-3);
        let megabytes = (self.uploaded_bytes - bytes) as f64 / 1e6;
        [lately.count() as f64 / passed, megabytes / passed]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_takes_longer_to_draw_than_it_lasts_is_counted() {
        let mut figures = Figures::default();
        figures.drawn(0.03, Seconds(0.04));
        figures.drawn(0.05, Seconds(0.04));
        assert_eq!(figures.slow_draws, 1);
    }

    #[test]
    fn one_slow_drawing_changes_no_expectation() {
        let mut figures = Figures::default();
        for ms in [150, 12, 11, 13, 12, 400, 11, 12, 14, 12] {
            figures.drawn(f64::from(ms) / 1e3, Seconds(0.04));
        }
        assert_eq!([figures.draw_s, figures.most_draw_s], [0.012, 0.014]);
        (0..9).for_each(|_| figures.drawn(0.1, Seconds(0.04)));
        assert_eq!([figures.draw_s, figures.most_draw_s], [0.1, 0.1]);
    }

    #[test]
    fn the_first_drawings_are_expected_to_take_longer_and_fast_ones_hold_nothing_up() {
        let (mut figures, period) = (Figures::default(), Seconds(0.04));
        assert_eq!(figures.slow_draw(period), Seconds(0.0));
        let expected = [0.1, 0.2, 0.15, 0.16].map(|s| {
            figures.drawn(s, period);
            figures.slow_draw(period).0
        });
        let wanted: [f64; 4] = [0.15, 0.3, 0.15, 0.16];
        let near = expected
            .iter()
            .zip(wanted)
            .all(|(e, w)| (e - w).abs() < 1e-9);
        assert!(near, "{expected:?}");
        (0..9).for_each(|_| figures.drawn(0.01, period));
        assert_eq!(figures.slow_draw(period), Seconds(0.0));
    }

    #[test]
    fn rates_are_of_the_last_two_seconds() {
        let mut figures = Figures::default();
        for k in 0..300 {
            figures.shown(Seconds(f64::from(k) / 30.0), FrameOutcome::default());
        }
        let [fps, _] = figures.rates(Seconds(299.0 / 30.0));
        assert!((fps - 30.0).abs() < 0.6, "{fps}");
        assert_eq!(figures.rates(Seconds(100.0)), [0.0; 2]);
    }
}
