//! What does a window begin with, of video and of a scene?

use super::opening::usable;
use crate::commands::view::ready::Ready;
use crate::options::showing::InterpolationName;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::session::bounds::Bounds;
use foveal_core::units::Radians;
use foveal_core::view::navigation::Navigation;
use foveal_play::LivePack;
use foveal_render::{DrawDevice, Drawer, RenderError, TileStyle};

impl Ready {
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
