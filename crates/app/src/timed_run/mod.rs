//! Under which conditions is playing timed?

mod eye;
mod run;

pub(crate) use run::Run;

use crate::canvas::{Drawing, Showing};
use crate::decoding::Decoding;
use crate::player::{Player, PlayerOptions};
use eye::JumpingEye;
use foveal_core::selection::policy::PolicyConfig;
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::{Eye, Projection, Screen, Surface};
use foveal_media::pack_file::PackFile;
use std::sync::Arc;

/// What 360° content is seen with: a headset of 22 pixels a degree.
const HEADSET_PIXELS: u32 = 2200;
const HEADSET_FIELD_DEG: f64 = 100.0;
/// Pixels across that are drawn of flat content.
const DRAWN_WIDTH: u32 = 1920;

/// What all runs of a comparison share.
pub(crate) struct Conditions<'a> {
    pub(crate) file: Arc<PackFile>,
    pub(crate) drawing: &'a Drawing,
    /// What flat content fills.
    pub(crate) screen: Screen,
    pub(crate) decoding: Decoding,
    pub(crate) seed: u64,
}

impl Conditions<'_> {
    /// A run under one policy; `paced` shows a frame when its time is over.
    pub(crate) fn run(&self, config: PolicyConfig, paced: bool) -> anyhow::Result<Run> {
        let about = self.file.pack().description();
        let surface = about.grid(self.screen).surface;
        let display = display(&surface);
        let options = PlayerOptions {
            config,
            view: display,
            screen: self.screen,
            drawing: self.drawing.clone(),
            showing: Showing::default(),
            bytes_per_s: f64::INFINITY,
            paced,
            judged: false,
            decoding: self.decoding,
        };
        let player = Player::new(Arc::clone(&self.file), options)?;
        let [w, h] = display.size;
        let width = w.min(DRAWN_WIDTH);
        let height = u64::from(h) * u64::from(width) / u64::from(w);
        let drawn = EyeView {
            size: [width, height.max(1) as u32],
            ..display
        };
        let eye = JumpingEye::new(surface, self.seed);
        Ok(Run::new(player, eye, drawn, about.frames))
    }
}

/// What levels are chosen for: a headset, or a screen that shows every pixel of the content.
fn display(surface: &Surface) -> EyeView {
    match surface.projection {
        Projection::Flat => EyeView::filling(surface, surface.size),
        Projection::Cube => {
            let size = [HEADSET_PIXELS; 2];
            EyeView {
                axes: Axes::FRONT,
                field: Field::across(Radians::from_degrees(HEADSET_FIELD_DEG), size),
                size,
                eye: Eye::default(),
            }
        }
    }
}
