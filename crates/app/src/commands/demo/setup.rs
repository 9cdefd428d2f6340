//! How is one content set up to be played, the same for every policy?

use crate::commands::demo::content::{FRAMES, Prepared};
use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel};
use crate::options::policy::ViewOptions;
use crate::run::open_player::open_player;
use foveal_core::content::policy::{DEFAULT_TARGET, Policy, PolicyConfig};
use foveal_play::Decoding;
use foveal_play::{Player, PlayerOptions};
use foveal_render::{DrawDevice, TileStyle};
use std::sync::Arc;

/// How all content is played.
pub(super) struct DemoConditions<'a> {
    pub(super) view: &'a ViewOptions,
    pub(super) drawing: &'a DrawDevice,
    pub(super) seed: u64,
}

/// What every run of one content shares.
pub(super) struct PlaySetup<'a> {
    pub(super) content: Prepared,
    pub(super) conditions: &'a DemoConditions<'a>,
    /// How many frames are played.
    pub(super) frames: u32,
}

impl<'a> PlaySetup<'a> {
    pub(super) fn new(content: Prepared, conditions: &'a DemoConditions<'a>) -> Self {
        let frames = content.file.pack().description().frames.min(FRAMES);
        Self {
            content,
            conditions,
            frames,
        }
    }

    /// A player at the first frame, and the gaze that all runs follow.
    pub(super) fn player(&self, policy: Policy) -> anyhow::Result<(Player, GazeSource)> {
        let view = self.conditions.view;
        let surface = self
            .content
            .file
            .pack()
            .description()
            .grid(view.screen)
            .surface;
        let options = PlayerOptions {
            config: PolicyConfig {
                target: (policy == Policy::Perceptual).then_some(DEFAULT_TARGET),
                ..PolicyConfig::new(policy)
            },
            view: view.eye_view(&surface)?,
            screen: view.screen,
            drawing: self.conditions.drawing.clone(),
            style: TileStyle::default(),
            tell: crate::report::output::say,
            paced: false,
            judged: false,
            bytes_per_s: f64::INFINITY,
            decoding: Decoding::software(),
        };
        let player = open_player(Arc::clone(&self.content.file), options)?;
        let length = player.time(self.frames - 1);
        let gaze = GazeSource::new(
            &GazeChoice::Scan,
            &surface,
            self.conditions.seed,
            length,
            &ViewerModel::default(),
        )?;
        Ok((player, gaze))
    }
}
