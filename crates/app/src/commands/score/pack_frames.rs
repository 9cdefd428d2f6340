//! What does an eye get from a pack under a policy, frame by frame?

use crate::commands::score::picture::from_image;
use crate::options::policy::{PolicyOptions, ViewOptions};
use crate::options::renderer::{RendererName, open_device};
use crate::report::output;
use crate::run::open_player::open_player;
use anyhow::{Context, bail};
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::tracker::Prediction;
use foveal_core::units::{Radians, counted};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Projection;
use foveal_eval::score::ScorePicture;
use foveal_eval::score::display::{Display, Photometry};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::WatchedFrame;
use foveal_play::{Decoding, PlayerOptions};
use foveal_play::{FrameOptions, FramePlayer, FrameReport};
use foveal_render::DrawDevice;
use std::path::Path;
use std::sync::Arc;

/// How packs are played.
pub(super) struct Opening {
    pub(super) policy: PolicyOptions,
    pub(super) view: ViewOptions,
    pub(super) jobs: Option<usize>,
    /// Whether no gaze was given.
    pub(super) needs_gaze: bool,
}

/// A pack that is played for an eye that looks at a place of its view; the head keeps still.
pub(super) struct PackFrames {
    player: FramePlayer,
    view: EyeView,
    frames: u32,
    fps: f64,
    next: u32,
}

impl PackFrames {
    pub(super) fn open(path: &Path, opening: &Opening) -> anyhow::Result<Self> {
        let file = Arc::new(PackFile::open(path)?);
        let about = file.pack().description();
        let (frames, fps) = (about.frames, about.fps());
        let surface = about.grid(opening.view.screen).surface;
        let view = opening.view.eye_view(&surface)?;
        Ok(Self {
            player: player_for(file, opening, view)?,
            view,
            frames,
            fps,
            next: 0,
        })
    }

    pub(super) fn size(&self) -> [u32; 2] {
        self.view.size
    }

    pub(super) fn frames(&self) -> u32 {
        self.frames
    }

    pub(super) fn fps(&self) -> f64 {
        self.fps
    }

    pub(super) fn is_over(&self) -> bool {
        self.next == self.frames
    }

    /// The view as a display.
    pub(super) fn display(&self) -> Display {
        display_of_view(&self.view, self.player.grid().surface.projection)
    }

    /// The next frame, chosen and drawn for an eye that looks at a pixel of the view.
    pub(super) fn next(&mut self, gaze_px: [f64; 2]) -> anyhow::Result<ScorePicture> {
        let time = self.player.time(self.next);
        let ray = self.view.ray(gaze_px.map(|pixel| pixel + 0.5));
        let gaze = GazeSample {
            time,
            received: time,
            // Far outside the view the square of a ray is no finite number.
            gaze_in_content: (ray / ray.abs().max_element()).normalize(),
            valid: true,
            spread: Radians(0.0),
            head: None,
        };
        let head = HeadPose::default();
        let look = WatchedFrame {
            gaze,
            gaze_is_known: true,
            head,
            expected: Prediction {
                gaze,
                event: EyeEvent::Fixation,
                since_saccade: None,
            },
            head_expected: head,
        };
        let report = self.player.show(self.next, &look)?;
        self.next += 1;
        picture_of(&mut self.player, &report.view)
    }
}

/// What plays a pack to be judged: every frame is waited for, with no link before it.
pub(super) fn player_for(
    file: Arc<PackFile>,
    opening: &Opening,
    view: EyeView,
) -> anyhow::Result<FramePlayer> {
    let player = PlayerOptions::new(opening.policy.config()?, &drawing()?, output::say);
    let options = FrameOptions {
        screen: opening.view.screen,
        decoding: Decoding::on(output::jobs(opening.jobs)?),
        ..FrameOptions::new(player, view)
    };
    open_player(&file, options)
}

/// What a player shows in a view.
pub(crate) fn picture_of(player: &mut FramePlayer, view: &EyeView) -> anyhow::Result<ScorePicture> {
    match player.drawer().picture(view, None)? {
        Some(image) => from_image(&image),
        None => bail!("nothing draws the pictures to score; give --renderer gpu or cpu"),
    }
}

/// Where in its view an eye looks: a gaze outside it or behind closed lids stays where it was last
/// seen.
pub(crate) struct LastGaze {
    gaze_px: [f64; 2],
    /// Frames in which the eye looked at nothing that is shown.
    unseen: usize,
}

impl LastGaze {
    /// At first in the middle.
    pub(crate) fn new(view: &EyeView) -> Self {
        Self {
            gaze_px: view.size.map(|side| f64::from(side / 2)),
            unseen: 0,
        }
    }

    /// Its place in a frame, 0 the middle of the first pixel.
    pub(crate) fn at(&mut self, report: &FrameReport) -> [f64; 2] {
        self.in_view(&report.view, &report.gaze)
    }

    /// Its place in a picture of a view.
    pub(crate) fn in_view(&mut self, view: &EyeView, gaze: &GazeSample) -> [f64; 2] {
        let place = view.place(gaze.gaze_in_content);
        match place.filter(|_| gaze.valid) {
            Some(place) => self.gaze_px = place.map(|at| at - 0.5),
            None => self.unseen += 1,
        }
        self.gaze_px
    }

    /// Says how often it was not seen.
    pub(crate) fn tell_unseen(&self) {
        if self.unseen > 0 {
            output::say(&format!(
                "the gaze was not seen in {}, scored for the last gaze that was",
                counted(self.unseen, "frame")
            ));
        }
    }
}

/// The GPU, or the CPU twin where there is none.
fn drawing() -> anyhow::Result<DrawDevice> {
    open_device(RendererName::Gpu)
        .or_else(|_| open_device(RendererName::Cpu))
        .context("pictures of a pack cannot be drawn")
}

/// What fills the same angles as a view, pixel for pixel: a desk screen for flat content, a headset
/// for a sphere.
pub(crate) fn display_of_view(view: &EyeView, projection: Projection) -> Display {
    let field = view.as_seen().field;
    let extent = [field.left + field.right, field.up + field.down];
    let light = match projection {
        Projection::Flat => Photometry::DESK,
        Projection::Cube | Projection::Equirect => Photometry::HEADSET,
    };
    Display::of("view", view.size, extent, light)
}
