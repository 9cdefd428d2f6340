//! What of a window is different for video and for scenes?

use crate::commands::view::ready::Ready;
use crate::commands::view::ready::opening::usable;
use crate::commands::view::window::panes::RigPanes;
use crate::options::panels::around_the_head;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::session::bounds::Bounds;
use foveal_core::units::Radians;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::navigation::Navigation;
use foveal_core::view::surface::Surface;
use foveal_play::LivePack;
use foveal_render::{DrawDevice, Drawer, RenderError, TileStyle};

/// Pixels of a face of the sphere round the viewer that stands for a scene where nothing but
/// directions and a window's usual size come from it.
const AROUND: u32 = 1024;

impl Ready {
    /// Whether one flies through what is shown.
    pub(in crate::commands::view) fn in_scene(&self) -> bool {
        matches!(self.pack, LivePack::Scene(_))
    }

    /// The surface that a picture lies on; round a scene one that nothing lies on.
    pub(in crate::commands::view) fn surface(&self) -> Surface {
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

    /// Where its panels lie in the window, where there are any.
    pub(in crate::commands::view) fn panes(&self) -> Option<RigPanes> {
        let panels = self.panels.as_ref()?;
        let mounted = match self.in_scene() {
            true => panels.iter().map(MountedPanel::of).collect(),
            false => around_the_head(panels),
        };
        let turns = self.surface().projection.surrounds();
        Some(RigPanes::new(panels, mounted, turns))
    }

    /// Where a viewer begins.
    pub(in crate::commands::view) fn navigation(&self) -> anyhow::Result<Navigation> {
        let fov = self.args.view.fov()?;
        Ok(match &self.pack {
            LivePack::Video(file, _) => {
                let front = file.pack().description().front_deg;
                Navigation::new(self.surface(), fov).facing(Radians::from_degrees(front))
            }
            LivePack::Scene(file) => {
                let scene = file.scene();
                let bounds = scene.bounds();
                Navigation::through((bounds.centre, bounds.radius), scene.rise(), fov)
            }
        })
    }

    /// What chooses first.
    pub(in crate::commands::view) fn config(&self) -> anyhow::Result<PolicyConfig> {
        let config = self.args.policy.config()?;
        match &self.pack {
            LivePack::Video(file, video) => usable(file, video, config, self.args.link),
            LivePack::Scene(_) => Ok(config),
        }
    }

    /// What a session keeps below.
    pub(in crate::commands::view) fn bounds(&self) -> Bounds {
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
    pub(in crate::commands::view) fn style(&self, policy: Policy) -> TileStyle {
        TileStyle {
            samples: policy == Policy::Sampled,
            ..self.args.showing.showing(self.args.presets.interpolation())
        }
    }

    /// What draws the pack, tiles like this.
    pub(in crate::commands::view) fn drawer(
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
