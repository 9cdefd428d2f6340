//! Which panels show what is played, in the place of one view?

use crate::options::showing::EyeName;
use crate::report::output::WrongUsage;
use anyhow::bail;
use clap::Args;
use foveal_core::view::panel::mounted::MountedPanel;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::surface::Eye;
use foveal_scene::rig::read_rig;
use serde::Serialize;
use std::path::PathBuf;

/// The displays before the eyes.
#[derive(Clone, Debug, Args)]
pub(crate) struct PanelsOptions {
    /// Show it on the panels of a rig, in the place of a view: TOML or JSON, as
    /// docs/formats/panels.md tells. They turn with the head, and together get what any of them
    /// shows.
    #[arg(long, value_name = "RIG", conflicts_with_all = ["view", "fov", "screen"])]
    pub(crate) panels: Option<PathBuf>,
}

/// A panel, as results name it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct NamedPanel {
    pub(crate) id: String,
    /// Whose it is: left, right or both.
    pub(crate) eye: &'static str,
}

impl PanelsOptions {
    /// The panels that `eye` looks at, as the rig has them; `None` where there is no rig.
    pub(crate) fn read(&self, eye: EyeName) -> anyhow::Result<Option<Vec<Panel>>> {
        let Some(path) = &self.panels else {
            return Ok(None);
        };
        let rig = read_rig(path)?;
        let asked = match eye {
            EyeName::Left => Some(Eye::Left),
            EyeName::Right => Some(Eye::Right),
            EyeName::Both => None,
        };
        let panels: Vec<Panel> = rig.seen_by(asked).into_iter().cloned().collect();
        if panels.is_empty() {
            let other = match eye {
                EyeName::Left => "right",
                _ => "left",
            };
            bail!(WrongUsage(format!(
                "{}: no panel is before the {} eye; give --eye {other}",
                path.display(),
                eye.name()
            )));
        }
        Ok(Some(panels))
    }
}

impl NamedPanel {
    pub(crate) fn of(panel: &Panel) -> Self {
        Self {
            id: panel.id.clone(),
            eye: match (panel.is_for_both, panel.view.eye) {
                (true, _) => "both",
                (false, Eye::Left) => "left",
                (false, Eye::Right) => "right",
            },
        }
    }
}

/// Panels for pictures on a surface around the head, which look the same from either eye.
pub(crate) fn around_the_head(panels: &[Panel]) -> Vec<MountedPanel> {
    let mounted = panels.iter().map(MountedPanel::of);
    mounted.map(MountedPanel::centred).collect()
}
