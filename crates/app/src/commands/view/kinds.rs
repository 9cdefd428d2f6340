//! What of a window is different for video and for scenes?

use crate::commands::view::args::ViewArgs;
use crate::commands::view::opening::usable;
use crate::commands::view::ready::Ready;
use crate::options::policy::{PolicyOptions, check_thresholds};
use crate::options::showing::InterpolationName;
use crate::report::output::WrongUsage;
use anyhow::bail;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::demand::why_not;
use foveal_core::session::bounds::Bounds;
use foveal_core::units::Radians;
use foveal_core::view::navigation::Navigation;
use foveal_core::view::surface::Surface;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::scene_file::{SceneFile, is_scene_pack};
use foveal_play::LivePack;
use foveal_render::{DrawDevice, Drawer, RenderError, TileStyle};
use std::sync::Arc;

/// Pixels of a face of the sphere round the viewer that stands for a scene where nothing but
/// directions and a window's usual size come from it.
const AROUND: u32 = 1024;

/// Opens a pack of either kind.
pub(super) fn open_pack(args: &ViewArgs) -> anyhow::Result<LivePack> {
    if is_scene_pack(&args.pack) {
        return Ok(LivePack::Scene(Arc::new(SceneFile::open(&args.pack)?)));
    }
    let file = Arc::new(PackFile::open(&args.pack)?);
    let video = file.video(args.view.screen)?;
    Ok(LivePack::Video(file, video))
}

/// The policy that was asked for, or the usual one of this kind.
pub(super) fn policy_of(args: &ViewArgs, pack: &LivePack) -> PolicyOptions {
    let usual = match (args.demo, pack) {
        (false, _) => Policy::Viewport,
        (true, LivePack::Video(..)) => Policy::Perceptual,
        (true, LivePack::Scene(_)) => Policy::Eccentricity,
    };
    args.policy.under(args.policy.policy.unwrap_or(usual))
}

/// Says what is wrong with the options for this kind, before a window is there.
pub(super) fn check(args: &ViewArgs, pack: &LivePack) -> anyhow::Result<()> {
    let config = args.policy.config()?;
    match pack {
        LivePack::Video(file, _) => {
            check_thresholds(&config, &file.pack().description().grid(args.view.screen))
        }
        LivePack::Scene(_) => check_scene(args, config.policy),
    }
}

fn check_scene(args: &ViewArgs, policy: Policy) -> anyhow::Result<()> {
    if let Some(why) = why_not(policy) {
        let able = Policy::IN_TURN
            .into_iter()
            .filter(|it| why_not(*it).is_none());
        let able: Vec<&str> = able.map(Policy::name).collect();
        bail!(WrongUsage(format!(
            "--policy {} does not choose for scenes: {why}; give one of {}",
            policy.name(),
            able.join(", ")
        )));
    }
    let style = args.showing.showing(InterpolationName::Blended);
    let of_tiles = [
        (style.has_textures, "--reconstruction textures"),
        (args.showing.interpolation.is_some(), "--interpolation"),
        (style.blurs, "--blur on"),
    ];
    match of_tiles.iter().find(|(is_given, _)| *is_given) {
        Some((_, option)) => bail!(WrongUsage(format!(
            "{option} is for video, and this is a scene; leave it out"
        ))),
        None => Ok(()),
    }
}

impl Ready {
    /// Whether one flies through what is shown.
    pub(super) fn in_scene(&self) -> bool {
        matches!(self.pack, LivePack::Scene(_))
    }

    /// The surface that a picture lies on; round a scene one that nothing lies on.
    pub(super) fn surface(&self) -> Surface {
        match &self.pack {
            LivePack::Video(file, _) => {
                file.pack()
                    .description()
                    .grid(self.args.view.screen)
                    .surface
            }
            LivePack::Scene(_) => Surface::cube(AROUND),
        }
    }

    /// Where a viewer begins.
    pub(super) fn navigation(&self) -> anyhow::Result<Navigation> {
        let fov = self.args.view.fov()?;
        Ok(match &self.pack {
            LivePack::Video(file, _) => {
                let front = file.pack().description().front_deg;
                Navigation::new(self.surface(), fov).facing(Radians::from_degrees(front))
            }
            LivePack::Scene(file) => {
                let bounds = file.scene().bounds();
                Navigation::through((bounds.centre, bounds.radius), fov)
            }
        })
    }

    /// What chooses first.
    pub(super) fn config(&self) -> anyhow::Result<PolicyConfig> {
        let config = self.args.policy.config()?;
        match &self.pack {
            LivePack::Video(file, video) => usable(file, video, config, self.args.link),
            LivePack::Scene(_) => Ok(config),
        }
    }

    /// What a session keeps below.
    pub(super) fn bounds(&self) -> Bounds {
        let usual = Bounds::default();
        match &self.pack {
            LivePack::Video(..) => usual,
            LivePack::Scene(_) => Bounds {
                gpu: self.args.gpu_memory,
                ..usual
            },
        }
    }

    /// How tiles are shown at first.
    pub(super) fn style(&self, policy: Policy) -> TileStyle {
        TileStyle {
            samples: policy == Policy::Sampled,
            ..self.args.showing.showing(InterpolationName::Blended)
        }
    }

    /// What draws the pack, tiles like this.
    pub(super) fn drawer(
        &self,
        device: &DrawDevice,
        style: TileStyle,
    ) -> Result<Drawer, RenderError> {
        match &self.pack {
            LivePack::Video(_, video) => Drawer::new(device, video, style),
            LivePack::Scene(file) => Drawer::of_scene(device, file.scene(), self.args.gpu_memory),
        }
    }
}
