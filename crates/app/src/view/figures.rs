//! What did the window do so far, in numbers?

use foveal_core::asset::picture::Picture;
use foveal_core::units::Seconds;
use std::collections::VecDeque;

/// How much of the past counts for rates, in seconds.
const WINDOW_S: f64 = 2.0;
/// Most frames that are remembered.
const MOST: usize = 1024;

/// What is counted while a window is open.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figures {
    /// When frames of the content were shown lately, and bytes uploaded by then.
    lately: VecDeque<(f64, u64)>,
    uploaded_bytes: u64,
    /// Smoothed time from asking for a frame's tiles until all were there, in ms.
    pub(crate) decode_ms: f64,
    pub(crate) decoded_pixels: u64,
    /// Frames of the content shown.
    pub(crate) frames: u64,
    /// Frames never shown, because the next was due.
    pub(crate) left_out_frames: u64,
    /// Frames shown with a coarser level standing in for tiles that were late.
    pub(crate) late_frames: u64,
    pub(crate) damaged_tiles: u64,
    /// Frames whose coarsest level was damaged: the frame before stayed.
    pub(crate) damaged_frames: u64,
    pub(crate) lost_devices: u64,
    /// What the GPU's driver complained about.
    pub(crate) gpu_errors: u64,
    pub(crate) wrong_frame_tiles: u64,
    /// Tiles on screen by level, finest first.
    pub(crate) histogram: Vec<u32>,
    /// Pixels of those tiles over the pixels of the finest level.
    pub(crate) share: f64,
    pub(crate) gpu_bytes: u64,
}

impl Figures {
    pub(crate) fn decoded(&mut self, pixels: u64) {
        self.decoded_pixels += pixels;
    }

    pub(crate) fn uploaded(&mut self, picture: &Picture) {
        let [w, h] = [picture.width, picture.height].map(u64::from);
        self.uploaded_bytes += w * h + 2 * w.div_ceil(2) * h.div_ceil(2);
    }

    /// All tiles of a frame were there after `seconds`.
    pub(crate) fn complete(&mut self, seconds: f64) {
        let ms = seconds * 1e3;
        self.decode_ms += (ms - self.decode_ms) * if self.frames < 2 { 1.0 } else { 0.1 };
    }

    /// A frame of the content came on screen.
    pub(crate) fn shown(&mut self, now: Seconds, left_out: u64, late: bool) {
        self.frames += 1;
        self.left_out_frames += left_out;
        self.late_frames += u64::from(late);
        if self.lately.len() == MOST {
            self.lately.pop_front();
        }
        self.lately.push_back((now.0, self.uploaded_bytes));
    }

    /// Frames a second and megabytes a second of late.
    pub(crate) fn rates(&mut self, now: Seconds) -> [f64; 2] {
        let old = |lately: &VecDeque<(f64, u64)>| {
            lately.front().is_some_and(|(at, _)| now.0 - at > WINDOW_S)
        };
        while old(&self.lately) {
            self.lately.pop_front();
        }
        let Some((first, bytes)) = self.lately.front() else {
            return [0.0; 2];
        };
        let passed = (now.0 - first).max(1e-3);
        let megabytes = (self.uploaded_bytes - bytes) as f64 / 1e6;
        [(self.lately.len() - 1) as f64 / passed, megabytes / passed]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_of_the_last_two_seconds() {
        let mut figures = Figures::default();
        for k in 0..300 {
            figures.shown(Seconds(f64::from(k) / 30.0), 0, false);
        }
        let [fps, _] = figures.rates(Seconds(299.0 / 30.0));
        assert!((fps - 30.0).abs() < 0.6, "{fps}");
        assert_eq!(figures.rates(Seconds(100.0)), [0.0; 2]);
    }
}
