//! What is said when a window was closed?

use crate::commands::view::window_player::WindowPlayer;
use crate::report::output;
use foveal_core::units::counted;
use serde::Serialize;

/// What a session took.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    frames: u64,
    late_frames: u64,
    incomplete_frames: u64,
    slow_draws: u64,
    left_out_frames: u64,
    wrong_frame_tiles: u64,
    damaged_tiles: u64,
    units_without_room: usize,
    damaged_frames: u64,
    lost_devices: u64,
    gpu_errors: u64,
    decoded_megapixels: f64,
    decode_ms: f64,
    draw_ms: f64,
    gpu_bytes: u64,
    /// Greatest distance of picture and sound, in ms, from two seconds after a beginning or a jump
    /// on; null without sound.
    sound_ms_max: Option<f64>,
    /// Its 95th percentile.
    sound_ms_p95: Option<f64>,
    /// Times that the sound device found too little to play.
    sound_gaps: u64,
    #[serde(skip)]
    has_tiles: bool,
}

impl Summary {
    pub(crate) fn new(player: &WindowPlayer) -> Self {
        let figures = player.live.session().figures();
        let drift = player.drift.worst_and_p95_ms();
        Self {
            frames: figures.frames,
            late_frames: figures.late_frames,
            incomplete_frames: figures.incomplete_frames,
            slow_draws: figures.slow_draws,
            left_out_frames: figures.left_out_frames,
            wrong_frame_tiles: figures.wrong_frame_units,
            damaged_tiles: figures.damaged_units,
            units_without_room: player.live.drawer().units_without_room(),
            damaged_frames: figures.damaged_frames,
            lost_devices: figures.lost_devices,
            gpu_errors: figures.gpu_errors,
            decoded_megapixels: figures.decoded_samples as f64 / 1e6,
            decode_ms: figures.decode_ms,
            draw_ms: figures.draw_s * 1e3,
            gpu_bytes: figures.gpu_bytes,
            sound_ms_max: drift.map(|[worst, _]| worst),
            sound_ms_p95: drift.map(|[_, p95]| p95),
            sound_gaps: player.sound_gaps(),
            has_tiles: player.facts().has_tiles,
        }
    }

    /// For people.
    pub(crate) fn text(&self) -> String {
        if !self.has_tiles {
            return format!(
                "{}{} on the GPU at the end, {}, {}",
                output::without_room(self.units_without_room),
                output::size(self.gpu_bytes),
                counted(self.damaged_tiles, "damaged unit"),
                counted(self.lost_devices, "lost device"),
            );
        }
        format!(
            "{} shown, {} late for decoding, {} for drawing, {} incomplete, {} left out\n\
             {}, {}, {}",
            counted(self.frames, "frame"),
            self.late_frames,
            self.slow_draws,
            self.incomplete_frames,
            self.left_out_frames,
            counted(self.damaged_tiles, "damaged tile"),
            counted(self.damaged_frames, "damaged frame"),
            counted(self.lost_devices, "lost device"),
        )
    }
}
