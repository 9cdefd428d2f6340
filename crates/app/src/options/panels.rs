//! Which panels show what is played, in the place of one view?

use crate::options::showing::EyeName;
use crate::report::output::WrongUsage;
use anyhow::bail;
use clap::Args;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::panel::fit::{PlacementRule, SourceSize, fit};
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::surface::{Eye, Screen};
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

/// A panel that a pack was played on.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PlayedPanel {
    id: String,
    /// How good it looked beside the full picture, where somebody asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    jod: Option<f64>,
}

/// Why samples are not shown on panels.
pub(crate) const SAMPLES_ONE_VIEW: &str =
    "--policy sampled shows samples in one view; with --panels give another policy";

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

impl PlayedPanel {
    /// Panels with their scores, in the same order, where there are any.
    pub(crate) fn all(panels: &[Panel], jods: Option<&[f64]>) -> Vec<Self> {
        let one = |(at, panel): (usize, &Panel)| Self {
            id: panel.id.clone(),
            jod: jods.and_then(|jods| jods.get(at).copied()),
        };
        panels.iter().enumerate().map(one).collect()
    }

    /// All of them, for people.
    pub(crate) fn text(panels: &[Self]) -> String {
        let one = |panel: &Self| match panel.jod {
            Some(jod) => format!("{} {jod:.2} JOD", panel.id),
            None => panel.id.clone(),
        };
        let all: Vec<String> = panels.iter().map(one).collect();
        format!("panels: {}\n", all.join(", "))
    }
}

/// Panels for pictures on a surface around the head, which look the same from either eye.
pub(crate) fn around_the_head(panels: &[Panel]) -> Vec<MountedPanel> {
    let mounted = panels.iter().map(MountedPanel::of);
    mounted.map(MountedPanel::centred).collect()
}

/// The screen that flat content of a shape fills before panels: square to the head and centred, as
/// `foveal panels fit --placement seed` tells, at a distance of a metre.
pub(crate) fn screen_before(panels: &[Panel], shape: [u32; 2]) -> anyhow::Result<Screen> {
    const METRES_AN_INCH: f64 = 0.0254;
    let panels: Vec<&Panel> = panels.iter().collect();
    let found = fit(&panels, PlacementRule::Seed, SourceSize::Picture(shape));
    let Ok(found) = found else {
        bail!(WrongUsage(
            "--panels: a panel looks 90° or more to the side, and a flat pack lies on a plane \
             before the head; give a rig that looks ahead, or a pack of a sphere"
                .to_owned()
        ));
    };
    let [right, down] = found.placement.extent().map(|side| side / 2.0);
    Ok(Screen {
        diagonal_inches: 2.0 * right.hypot(down) / METRES_AN_INCH,
        distance_m: 1.0,
    })
}
