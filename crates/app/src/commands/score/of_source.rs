//! What does an eye get from a pack, frame by frame, compared with the source's own view?

use crate::commands::score::conditions::GazeWords;
use crate::commands::score::engine::Frame;
use crate::commands::score::pack_frames::{
    LastGaze, Opening, display_of_view, picture_of, player_for,
};
use crate::gaze_source::{GazeSource, ViewerModel};
use crate::run::source_frames::SourceFrames;
use foveal_core::view::eye_view::EyeView;
use foveal_eval::score::display::Display;
use foveal_media::pack::pack_file::PackFile;
use foveal_play::FramePlayer;
use std::path::Path;
use std::sync::Arc;

/// A pack that is played for a viewer, and what the same views show of its source.
pub(super) struct PackOfSource {
    player: FramePlayer,
    gaze: GazeSource,
    source: SourceFrames,
    view: EyeView,
    frames: u32,
    fps: f64,
    next: u32,
    last_gaze: LastGaze,
}

impl PackOfSource {
    /// Refuses a source that is not the pack's. Plays `most` frames at most.
    pub(super) fn open(
        source: &Path,
        pack: &Path,
        opening: &Opening,
        (gaze, seed): (&GazeWords, u64),
        most: Option<u32>,
    ) -> anyhow::Result<Self> {
        let file = Arc::new(PackFile::open(pack)?);
        let about = file.pack().description();
        let frames = about.frames.min(most.unwrap_or(u32::MAX));
        let fps = about.fps();
        let surface = about.grid(opening.view.screen).surface;
        let view = opening.view.eye_view(&surface)?;
        let source = SourceFrames::open(source, &file, opening.view.screen)?;
        let choice = gaze.of_viewer()?;
        let player = player_for(file, opening, view)?;
        let length = player.time(frames - 1);
        Ok(Self {
            gaze: GazeSource::new(&choice, &surface, seed, length, &ViewerModel::default())?,
            source,
            view,
            frames,
            fps,
            next: 0,
            last_gaze: LastGaze::new(&view),
            player,
        })
    }

    pub(super) fn size(&self) -> [u32; 2] {
        self.view.size
    }

    pub(super) fn frames(&self) -> u32 {
        self.frames
    }

    /// Frames a second; none for a still.
    pub(super) fn fps(&self) -> Option<f64> {
        (self.frames > 1).then_some(self.fps)
    }

    /// The view as a display.
    pub(super) fn display(&self) -> Display {
        display_of_view(&self.view, self.player.grid().surface.projection)
    }

    /// The next frame; `None` after the last.
    pub(super) fn next(&mut self) -> anyhow::Result<Option<Frame>> {
        if self.next == self.frames {
            return Ok(None);
        }
        let look = self.gaze.look(self.player.time(self.next));
        let report = self.player.show(self.next, &look)?;
        let mut seen = self.source.seen(self.next, &[report.view])?;
        self.next += 1;
        let test = picture_of(&mut self.player, &report.view)?;
        Ok(seen.pop().map(|reference| Frame {
            reference,
            test,
            gaze_px: self.last_gaze.at(&report),
        }))
    }

    /// Says in how many frames the eye looked at nothing that is shown.
    pub(super) fn tell_unseen(&self) {
        self.last_gaze.tell_unseen();
    }
}
