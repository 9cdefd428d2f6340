//! How is one content set up to be played, the same for every policy?

use crate::commands::demo::video::content::{FRAMES, Prepared};
use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel};
use crate::options::policy::ViewOptions;
use crate::options::policy_of_pack::cheaper_policy;
use crate::report::output;
use crate::run::open_player::open_player;
use crate::run::shown_frames::ShownFrames;
use foveal_core::content::policy::{DEFAULT_TARGET, Policy, PolicyConfig};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::surface::Surface;
use foveal_play::{FrameOptions, FramePlayer, PlayerOptions};
use foveal_render::DrawDevice;

/// Pictures of a still, and how many are shown a second: two seconds, six fixations.
const STILL_PICTURES: u32 = 24;
const STILL_HZ: f64 = 12.0;
/// Pixels per degree ahead of a headset's view, and its height over its width.
const HEADSET_PPD: f64 = 22.0;
const HEADSET_SHAPE: f64 = 0.625;

/// How all content is played.
pub(crate) struct DemoConditions<'a> {
    pub(crate) view: &'a ViewOptions,
    pub(crate) drawing: &'a DrawDevice,
    pub(crate) seed: u64,
}

impl DemoConditions<'_> {
    /// What shows content on a surface: a headset's view of a sphere, where none was asked for.
    fn view_of(&self, surface: &Surface) -> anyhow::Result<EyeView> {
        let mut view = self.view.clone();
        if surface.projection.surrounds() && view.view.is_none() {
            let ahead = Radians(1.0).to_degrees() * HEADSET_PPD;
            let width = 2.0 * (view.fov()?.0 / 2.0).tan() * ahead;
            view.view = Some([width, width * HEADSET_SHAPE].map(|side| side.round() as u32));
        }
        view.eye_view(surface)
    }
}

/// What every run of one content shares.
pub(crate) struct PlaySetup<'a> {
    pub(crate) content: &'a Prepared,
    pub(crate) conditions: &'a DemoConditions<'a>,
    /// What shows it in the place of one view, if anything.
    pub(crate) panels: Vec<MountedPanel>,
    /// What `auto` chose.
    pub(crate) chosen: Policy,
    /// How many pictures are played.
    pub(crate) pictures: u32,
    pub(crate) shown: ShownFrames,
    view: EyeView,
}

impl<'a> PlaySetup<'a> {
    /// In one view, or on panels where there are any.
    pub(crate) fn new(
        content: &'a Prepared,
        conditions: &'a DemoConditions<'a>,
        panels: Vec<MountedPanel>,
    ) -> anyhow::Result<Self> {
        let about = content.file.pack().description();
        let surface = about.grid(conditions.view.screen).surface;
        let view = match panels.first() {
            Some(first) => first.turned(&Default::default()),
            None => conditions.view_of(&surface)?,
        };
        let chosen = cheaper_policy(&content.file, (&surface, &view), Some(DEFAULT_TARGET));
        Ok(Self {
            content,
            conditions,
            panels,
            view,
            chosen: chosen.unwrap_or(Policy::Perceptual),
            pictures: match about.is_still() {
                true => STILL_PICTURES,
                false => about.frames.min(FRAMES),
            },
            shown: ShownFrames::new(about.frames, 0, Seconds(1.0 / STILL_HZ)),
        })
    }

    /// What shows it, while the head looks ahead.
    pub(crate) fn views(&self) -> Vec<EyeView> {
        match self.panels.as_slice() {
            [] => vec![self.view],
            panels => MountedPanel::views(panels, &Default::default(), Default::default()),
        }
    }

    /// Pictures a second; `None` of a still, whose pictures are judged one by one.
    pub(crate) fn judged_fps(&self) -> Option<f64> {
        let about = self.content.file.pack().description();
        (!about.is_still()).then(|| about.fps())
    }

    /// A player at the first frame, and the gaze that all runs follow.
    pub(crate) fn player(&self, policy: Policy) -> anyhow::Result<(FramePlayer, GazeSource)> {
        let player = self.player_on(policy, self.panels.clone())?;
        let surface = player.grid().surface;
        let length = self.shown.time(self.pictures - 1, &player);
        let gaze = GazeSource::new(
            &GazeChoice::Scan,
            &surface,
            self.conditions.seed,
            length,
            &ViewerModel::default(),
        )?;
        Ok((player, gaze))
    }

    /// A player whose content is shown on these panels, or in the view where there are none.
    pub(crate) fn player_on(
        &self,
        policy: Policy,
        panels: Vec<MountedPanel>,
    ) -> anyhow::Result<FramePlayer> {
        let config = PolicyConfig {
            target: policy.has_target().then_some(DEFAULT_TARGET),
            ..PolicyConfig::new(policy)
        };
        let player = PlayerOptions::new(config, self.conditions.drawing, output::say);
        let options = FrameOptions {
            screen: self.conditions.view.screen,
            ..FrameOptions::new(player, self.view)
        };
        let player = open_player(&self.content.file, options)?;
        Ok(player.through(panels))
    }
}
