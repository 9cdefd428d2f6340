//! Under which conditions is playing timed?

mod eye;
mod parts;
mod run;

pub(crate) use parts::{FrameTimes, Parts, decodes_per_frame};
pub(crate) use run::Run;

use crate::commands::score::{DeviceName, Engine, display_of_view, from_image};
use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel as Viewer};
use crate::report::output;
use crate::run::open_player::open_player;
use eye::JumpingEye;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::calibration::density_of;
use foveal_core::units::{Ppd, Radians};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::{Eye, Projection, Screen, Surface};
use foveal_eval::score::{Mode, Viewing};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::Decoding;
use foveal_play::{FrameOptions, FramePlayer, PlayerOptions};
use foveal_render::{DrawDevice, Interpolation, TileStyle};
use std::sync::Arc;

/// What 360° content is seen with: a headset of 22 pixels a degree.
const HEADSET_PIXELS: u32 = 2200;
const HEADSET_FIELD_DEG: f64 = 100.0;
/// Pixels across that are drawn of flat content.
const DRAWN_WIDTH: u32 = 1920;

/// What all runs of a comparison share.
#[derive(Clone)]
pub(crate) struct Conditions<'a> {
    pub(crate) file: Arc<PackFile>,
    pub(crate) drawing: &'a DrawDevice,
    /// What flat content fills.
    pub(crate) screen: Screen,
    pub(crate) decoding: Decoding,
    pub(crate) seed: u64,
}

/// Frames that are scored.
const SCORED_FRAMES: u32 = 8;

/// How frames are chosen and drawn.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    pub(crate) config: PolicyConfig,
    /// How pixels between samples are filled, where samples are shown.
    pub(crate) interpolation: Interpolation,
}

impl Way {
    /// Under this policy, with the usual interpolation.
    pub(crate) fn of(config: PolicyConfig) -> Self {
        Self {
            config,
            interpolation: Interpolation::default(),
        }
    }

    /// Under a policy with its usual parameters.
    pub(crate) fn under(policy: Policy) -> Self {
        Self::of(PolicyConfig::new(policy))
    }
}

impl Conditions<'_> {
    fn player(&self, way: &Way, paced: bool) -> anyhow::Result<FramePlayer> {
        let surface = self.file.pack().description().grid(self.screen).surface;
        // A mask of samples is as large as the picture that it is drawn into.
        let view = match way.config.policy {
            Policy::Sampled => self.drawn(),
            _ => display(&surface),
        };
        let player = PlayerOptions::new(way.config.clone(), self.drawing, output::say);
        let options = FrameOptions {
            screen: self.screen,
            style: TileStyle {
                interpolation: way.interpolation,
                ..TileStyle::default()
            },
            paced,
            decoding: self.decoding,
            ..FrameOptions::new(player, view)
        };
        open_player(&self.file, options)
    }

    /// The density that the pack's calibration is looked up at.
    pub(crate) fn density(&self) -> Ppd {
        let surface = self.file.pack().description().grid(self.screen).surface;
        density_of(&surface, &display(&surface))
    }

    /// The picture that is drawn, which may be smaller than what levels are chosen for.
    fn drawn(&self) -> EyeView {
        let display = display(&self.file.pack().description().grid(self.screen).surface);
        let [w, h] = display.size;
        let width = w.min(DRAWN_WIDTH);
        let height = u64::from(h) * u64::from(width) / u64::from(w);
        EyeView {
            size: [width, height.max(1) as u32],
            ..display
        }
    }

    /// The score of the first frames, against every finest tile, in JOD, for an eye that rests
    /// ahead; `None` where nothing draws.
    pub(crate) fn score(&self, way: &Way) -> anyhow::Result<Option<f64>> {
        let mut shown = self.player(way, false)?;
        let mut full = self.player(&Way::under(Policy::Full), false)?;
        let about = self.file.pack().description();
        let (surface, view) = (about.grid(self.screen).surface, self.drawn());
        let display = display_of_view(&view, surface.projection);
        let viewing = Viewing::new(display, view.size, Some(about.fps()), true, Mode::Compat)?;
        let mut engine = Engine::open(DeviceName::Cpu, &viewing, self.decoding.jobs)?;
        let still = GazeChoice::At([0.0; 2]);
        let end = full.time(about.frames - 1);
        let mut gaze = GazeSource::new(&still, &surface, self.seed, end, &Viewer::default())?;
        for frame in 0..SCORED_FRAMES.min(about.frames) {
            let look = gaze.look(full.time(frame));
            let pictures = [&mut full, &mut shown].map(|player| {
                player.show(frame, &look)?;
                let picture = player.drawer().picture(&view, None)?;
                anyhow::Ok(picture)
            });
            let [reference, test] = pictures;
            let (Some(reference), Some(test)) = (reference?, test?) else {
                return Ok(None);
            };
            let middle = view.size.map(|side| f64::from(side / 2));
            engine.frame(&from_image(&reference)?, &from_image(&test)?, middle)?;
        }
        Ok(Some(engine.score()?.jod))
    }

    /// A run in one way; `paced` shows a frame when its time is over.
    pub(crate) fn run(&self, way: &Way, paced: bool) -> anyhow::Result<Run> {
        let about = self.file.pack().description();
        let surface = about.grid(self.screen).surface;
        let player = self.player(way, paced)?;
        let eye = JumpingEye::new(surface, self.seed);
        Ok(Run::new(player, eye, self.drawn(), about.frames))
    }
}

/// What levels are chosen for: a headset, or a screen that shows every pixel of the content.
fn display(surface: &Surface) -> EyeView {
    match surface.projection {
        Projection::Flat => EyeView::filling(surface, surface.size),
        Projection::Cube | Projection::Equirect => {
            let size = [HEADSET_PIXELS; 2];
            EyeView {
                position: Default::default(),
                axes: Axes::FRONT,
                field: Field::across(Radians::from_degrees(HEADSET_FIELD_DEG), size),
                size,
                eye: Eye::default(),
            }
        }
    }
}
