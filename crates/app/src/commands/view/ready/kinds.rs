//! What of a window is different for video and for scenes?

use crate::commands::view::ready::Ready;
use crate::commands::view::ready::opening::usable;
use crate::commands::view::window::panes::RigPanes;
use crate::options::panels::around_the_head;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::session::bounds::Bounds;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::navigation::Navigation;
use foveal_core::view::surface::Surface;
use foveal_render::{DrawDevice, Drawer, RenderError, TileStyle};

/// Pixels of a face of the sphere round the viewer that stands for a scene where nothing but
/// directions and a window's usual size come from it.
const AROUND: u32 = 1024;

impl Ready {
    /// The surface that a picture lies on; round a scene one that nothing lies on.
    pub(in crate::commands::view) fn surface(&self) -> Surface {
        match self.opened.video() {
            Some(video) => video.grid().surface,
            None => Surface::cube(AROUND),
        }
    }

    /// Where its panels lie in the window, where there are any.
    pub(in crate::commands::view) fn panes(&self) -> Option<RigPanes> {
        let panels = self.panels.as_ref()?;
        let mounted = match self.opened.facts().is_entered {
            true => panels.iter().map(MountedPanel::of).collect(),
            false => around_the_head(panels),
        };
        let turns = self.surface().projection.surrounds();
        Some(RigPanes::new(panels, mounted, turns))
    }

    /// Where a viewer begins.
    pub(in crate::commands::view) fn navigation(&self) -> anyhow::Result<Navigation> {
        Ok(self.opened.navigation(self.args.view.fov()?))
    }

    /// What chooses first.
    pub(in crate::commands::view) fn config(&self) -> anyhow::Result<PolicyConfig> {
        let config = self.args.policy.config()?;
        let has = self.opened.content().has();
        usable(self.pack.path(), has, config, self.args.link)
    }

    /// What a session keeps below.
    pub(in crate::commands::view) fn bounds(&self) -> Bounds {
        let usual = Bounds::default();
        match self.opened.facts().has_tiles {
            true => usual,
            false => Bounds {
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
        Drawer::of_opened(device, &self.opened, style, self.args.gpu_memory)
    }
}
