//! Which panels show what is played, in the place of one view?

use crate::commands::panels::rig_args::PlacementName;
use crate::options::showing::EyeName;
use crate::report::output::{WrongUsage, say};
use anyhow::bail;
use clap::Args;
use foveal_core::view::axes::Axes;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::panel::fit::{FitError, PlacementRule, SourceSize, place};
use foveal_core::view::panel::placement::Placement;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::panel::share::seen_part;
use foveal_core::view::slant::Slant;
use foveal_core::view::surface::{Eye, Screen};
use foveal_scene::rig::read_rig;
use serde::Serialize;
use std::path::PathBuf;

/// The displays before the eyes.
#[derive(Clone, Debug, Args)]
pub(crate) struct PanelsOptions {
    /// Show it on the panels of a rig, in the place of a view: TOML or JSON, as
    /// docs/formats/panels.md describes. They turn with the head, and together get what any of them
    /// shows.
    #[arg(long, value_name = "RIG", conflicts_with_all = ["view", "fov", "screen"])]
    pub(crate) panels: Option<PathBuf>,
    /// Where a flat pack lies before them, as `foveal panels fit` places a source: auto (the rig's
    /// screen where it has one, else plane), seed or plane.
    #[arg(
        long,
        value_enum,
        value_name = "HOW",
        requires = "panels",
        hide_possible_values = true
    )]
    placement: Option<PlacementName>,
}

/// The panels of a rig that show what is played.
pub(crate) struct ShownRig {
    pub(crate) panels: Vec<Panel>,
    /// Width and height of the screen that the rig says a source fills.
    screen: Option<[f64; 2]>,
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
    /// How good it looked compared with the full picture, where asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    jod: Option<f64>,
}

/// Why samples are not shown on panels.
pub(crate) const SAMPLES_ONE_VIEW: &str =
    "--policy sampled shows samples in one view; with --panels give another policy";

impl PanelsOptions {
    /// The panels that `eye` looks at, as the rig has them; `None` where there is no rig.
    pub(crate) fn read(&self, eye: EyeName) -> anyhow::Result<Option<ShownRig>> {
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
        Ok(Some(ShownRig {
            panels,
            screen: rig.screen,
        }))
    }

    /// The screen that flat content of a shape fills before the panels of a rig: `None` of what is
    /// not flat, which lies round the head.
    pub(crate) fn screen(
        &self,
        rig: &ShownRig,
        shape: Option<[u32; 2]>,
    ) -> anyhow::Result<Option<Screen>> {
        let Some(shape) = shape else {
            return match self.placement {
                None => Ok(None),
                Some(_) => bail!(WrongUsage(
                    "--placement lays flat packs, and this one lies round the head; leave it out"
                        .to_owned()
                )),
            };
        };
        let name = self.placement.unwrap_or(PlacementName::Auto);
        let rule = match (name, rig.screen) {
            (PlacementName::Auto, Some(size)) => PlacementRule::Screen(size),
            (PlacementName::Auto | PlacementName::Plane, _) => PlacementRule::Plane,
            (PlacementName::Seed, _) => PlacementRule::Seed,
            (PlacementName::Cylinder | PlacementName::Equirect, _) => bail!(WrongUsage(
                "--placement: tiles of a flat pack are drawn on a plane; give auto, seed or plane, \
                 or bend its source round the head by `foveal panels warp RIG FILE`"
                    .to_owned()
            )),
        };
        let panels: Vec<&Panel> = rig.panels.iter().collect();
        let placed = place(&panels, rule, SourceSize::Picture(shape));
        let (plane, _) = placed.map_err(|error| no_place(rule, &error))?;
        tell_part(&panels, &plane, shape);
        Ok(Some(screen_at(&plane)))
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

/// Says where panels see but a part of a picture, whose aspect is not theirs.
pub(crate) fn tell_part(panels: &[&Panel], placement: &Placement, size: [u32; 2]) {
    if let Some(part) = part_seen(seen_part(panels, placement), size) {
        say(&format!("the panels show only {part}"));
    }
}

/// In words the part of a picture that is seen, from edge to edge, where it is much less than all.
fn part_seen([left, right, top, bottom]: [f64; 4], size: [u32; 2]) -> Option<String> {
    /// Of the width or height.
    const MUCH_LESS: f64 = 0.8;
    /// How far from the middle what is seen is still there.
    const MIDDLE: f64 = 0.05;
    let [width, height] = [right - left, bottom - top];
    let (share, side, middle, beside) = match width < height {
        true => (width, "width", (left + right) / 2.0, ["left", "right"]),
        false => (height, "height", (top + bottom) / 2.0, ["upper", "lower"]),
    };
    if share >= MUCH_LESS || share <= 0.0 {
        return None;
    }
    let place = match middle - 0.5 {
        off if off.abs() <= MIDDLE => "middle",
        off if off < 0.0 => beside[0],
        _ => beside[1],
    };
    let aspect = f64::from(size[0]) * width / (f64::from(size[1]) * height);
    Some(format!(
        "the {place} band of the picture, {:.0} % of its {side}; a picture of about {aspect:.2}:1 \
         would fill them",
        100.0 * share
    ))
}

/// Why flat content has no place before panels.
fn no_place(rule: PlacementRule, error: &FitError) -> WrongUsage {
    let text = match (rule, error) {
        (PlacementRule::Seed, FitError::Beyond { works: "plane", .. }) => {
            format!("--panels: {error}")
        }
        (_, FitError::Beyond { panel, .. }) => format!(
            "--panels: no plane lies before all panels, of which {panel} looks farthest to the \
             side, and a flat pack lies on a plane; give a rig that looks ahead, or a pack of a \
             sphere"
        ),
        _ => format!("--panels: {error}"),
    };
    WrongUsage(text)
}

/// The screen that a plane is, at a distance of a metre.
fn screen_at(plane: &Placement) -> Screen {
    const METRES_AN_INCH: f64 = 0.0254;
    let half = plane.extent().map(|side| side / 2.0);
    let [left, across, up, along] = plane.window;
    let middle = [(across - left) / 2.0, (along - up) / 2.0];
    let is_ahead = plane.axes == Axes::FRONT && middle == [0.0; 2];
    Screen {
        diagonal_inches: 2.0 * half[0].hypot(half[1]) / METRES_AN_INCH,
        distance_m: 1.0,
        slant: (!is_ahead).then(|| Slant::new(plane.axes, middle)),
        filled: Some(half),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_picture_is_told_where_it_is_much_less_than_all() {
        let told = |part| part_seen(part, [1600, 900]).unwrap_or_default();
        assert_eq!(told([0.0, 1.0, 0.05, 0.95]), "");
        let band = told([0.0, 1.0, 0.4, 0.6]);
        assert!(band.contains("middle band"), "{band}");
        assert!(band.contains("20 % of its height"), "{band}");
        assert!(band.contains("8.89:1"), "{band}");
        assert!(told([0.0, 1.0, 0.0, 0.5]).contains("upper band"));
        assert!(told([0.7, 1.0, 0.0, 1.0]).contains("right band"));
        assert_eq!(told([1.0, 0.0, 1.0, 0.0]), "");
    }
}
