//! How many pictures does a run have?

use crate::commands::simulate::options::SimulateArgs;
use crate::gaze_source::GazeSource;
use crate::options::hold::{STILL_HZ, pictures_in};
use crate::report::output::{self, WrongUsage, out_of_range};
use crate::run::shown_frames::ShownFrames;
use anyhow::bail;
use foveal_core::content::video::bytes::description::Description;
use foveal_core::units::{Seconds, counted};
use foveal_play::FramePlayer;

/// Most pictures of a run with a live gaze: over nine hours at 30 a second.
pub(crate) const MOST_LIVE: u32 = 1_000_000;

/// The pictures that are played.
pub(crate) struct Playing {
    pub(crate) shown: ShownFrames,
    /// How many; `None` for as long as a live gaze is not stopped.
    pub(crate) pictures: Option<u32>,
    /// Pictures a second.
    pub(crate) fps: f64,
}

impl Playing {
    /// Pictures a second, as a fraction.
    pub(crate) fn rate(&self, about: &Description) -> [u32; 2] {
        match about.is_still() {
            true => [(self.fps * 1000.0).round() as u32, 1000],
            false => about.frame_rate,
        }
    }
}

impl SimulateArgs {
    /// Checks that a pack has what is asked for, as far as that can be known without the gaze.
    pub(crate) fn check_length(&self, about: &Description) -> anyhow::Result<()> {
        if self.start >= about.frames {
            let range = format!("0 to {} in this pack", about.frames - 1);
            bail!(out_of_range("--start", self.start, &range));
        }
        if !about.is_still() {
            let frames = counted(about.frames, "frame");
            self.hold.refuse_for(&format!("a video of {frames}"))?;
            if self.interval.is_some() {
                bail!(WrongUsage(format!(
                    "--interval is for scenes and stills, and {} is a video",
                    self.pack.display()
                )));
            }
        }
        Ok(())
    }

    /// How long a video is played, which the times of a trace are compared with; 0 of a still
    /// that is shown for as long as its trace lasts.
    pub(crate) fn length(&self, about: &Description, player: &FramePlayer) -> Seconds {
        match about.is_still() {
            true => self.hold.hold.unwrap_or_default(),
            false => player.time(self.end(about.frames) - 1),
        }
    }

    /// The pictures to play of a pack; says so where they are fewer than asked for.
    pub(crate) fn playing(
        &self,
        about: &Description,
        gaze: &GazeSource,
    ) -> anyhow::Result<Playing> {
        let interval = self.interval.unwrap_or(Seconds(1.0 / STILL_HZ));
        let pictures = match (self.frames, self.hold.hold) {
            (None, None) if gaze.is_live() => None,
            (Some(asked), _) if about.is_still() || gaze.is_live() => Some(asked),
            (None, Some(hold)) => Some(pictures_in(hold, interval)?),
            _ if about.is_still() => Some(pictures_in(gaze.lasts(), interval)?),
            _ => Some(self.frames_there(about.frames)),
        };
        Ok(Playing {
            shown: ShownFrames::new(about.frames, self.start, interval),
            pictures,
            fps: match about.is_still() {
                true => 1.0 / interval.0,
                false => about.fps(),
            },
        })
    }

    /// The frame after the last that is played of a pack with so many.
    fn end(&self, there: u32) -> u32 {
        let asked = self.frames.unwrap_or(there - self.start);
        self.start.saturating_add(asked).min(there)
    }

    /// The number of frames to play of a video of so many.
    fn frames_there(&self, there: u32) -> u32 {
        let frames = self.end(there) - self.start;
        if self.frames.is_some_and(|asked| asked > frames) {
            let from = match self.start {
                0 => String::new(),
                start => format!(" from frame {start} on"),
            };
            output::say(&format!(
                "{}: has {}, so only {frames}{from} will be played",
                self.pack.display(),
                counted(there, "frame"),
            ));
        }
        frames
    }
}
