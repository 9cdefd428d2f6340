//! What is said when a window was closed?

use super::viewer::Viewer;
use serde::Serialize;

/// What a session took.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    frames: u64,
    late_frames: u64,
    left_out_frames: u64,
    wrong_frame_tiles: u64,
    damaged_tiles: u64,
    damaged_frames: u64,
    lost_devices: u64,
    gpu_errors: u64,
    decoded_megapixels: f64,
    decode_ms: f64,
    gpu_bytes: u64,
    /// Greatest distance of picture and sound, in ms; null without sound.
    sound_ms_worst: Option<f64>,
}

impl Summary {
    pub(crate) fn new(viewer: &Viewer) -> Self {
        let figures = &viewer.figures;
        Self {
            frames: figures.frames,
            late_frames: figures.late_frames,
            left_out_frames: figures.left_out_frames,
            wrong_frame_tiles: figures.wrong_frame_tiles,
            damaged_tiles: figures.damaged_tiles,
            damaged_frames: figures.damaged_frames,
            lost_devices: figures.lost_devices,
            gpu_errors: figures.gpu_errors,
            decoded_megapixels: figures.decoded_pixels as f64 / 1e6,
            decode_ms: figures.decode_ms,
            gpu_bytes: figures.gpu_bytes,
            sound_ms_worst: viewer.worst_sound().map(|worst| worst.0 * 1e3),
        }
    }

    /// For people.
    pub(crate) fn text(&self) -> String {
        format!(
            "{} frames shown, {} with tiles that came late, {} left out\n\
             {} damaged tiles, {} damaged frames, {} lost devices",
            self.frames,
            self.late_frames,
            self.left_out_frames,
            self.damaged_tiles,
            self.damaged_frames,
            self.lost_devices,
        )
    }
}
