//! Where does the source lie, and how many of its pixels are needed?

use super::rig_args::{RigArgs, source_size};
use crate::options::panels::tell_part;
use crate::report::output;
use clap::Args;
use foveal_core::view::axes::Axes;
use foveal_core::view::panel::fit::{SourceFit, SourceSize};
use foveal_core::view::panel::placement::SourceProjection;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::surface::Eye;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Clone, Debug, Args)]
pub(crate) struct FitArgs {
    #[command(flatten)]
    rig: RigArgs,
    /// Size of the source as 1600x1200, or a picture or video that has it; a free one if not given.
    #[arg(long, value_name = "WxH|FILE")]
    source: Option<String>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// A placed source, as results describe it.
#[derive(Debug, Serialize)]
pub(super) struct FitReport {
    placement: &'static str,
    /// Half the window at distance 1; null of a curved source.
    tan_x: Option<f64>,
    tan_y: Option<f64>,
    /// Where the plane is cut: z of the farthest corner.
    s_z: Option<f64>,
    half_width: Option<f64>,
    half_height: Option<f64>,
    axis: AxisReport,
    /// Left, right, up and down of the axis, outward: tangents, or radians.
    window: [f64; 4],
    need_megapixels: f64,
    need: [u32; 2],
    source: [u32; 2],
    seen_share: f64,
    map_error_px: f64,
    panels: Vec<PanelReport>,
}

#[derive(Debug, Serialize)]
struct AxisReport {
    yaw_deg: f64,
    pitch_deg: f64,
    roll_deg: f64,
}

impl AxisReport {
    fn of(axes: &Axes) -> Self {
        let [yaw_deg, pitch_deg, roll_deg] = axes.yaw_pitch_roll().map(|it| it.to_degrees());
        Self {
            yaw_deg,
            pitch_deg,
            roll_deg,
        }
    }
}

#[derive(Debug, Serialize)]
struct PanelReport {
    id: String,
    eye: &'static str,
    density: f64,
    sigma_min: f64,
    sigma_max: f64,
    filter: &'static str,
}

/// The eye that looks at a panel, by name.
fn eye_name(panel: &Panel) -> &'static str {
    match (panel.is_for_both, panel.view.eye) {
        (true, _) => "both",
        (false, Eye::Left) => "left",
        (false, Eye::Right) => "right",
    }
}

impl FitReport {
    pub(super) fn of(panels: &[&Panel], found: &SourceFit) -> Self {
        let placement = &found.placement;
        let is_plane = placement.projection == SourceProjection::Plane;
        let [x, y] = placement
            .extent()
            .map(|side| is_plane.then_some(side / 2.0));
        let at_depth = |half: Option<f64>| Some(half? * found.depth?.abs());
        let rows = panels
            .iter()
            .zip(&found.panels)
            .map(|(panel, row)| PanelReport {
                id: panel.id.clone(),
                eye: eye_name(panel),
                density: row.density,
                sigma_min: row.sigma_min,
                sigma_max: row.sigma_max,
                filter: row.filter.name(),
            });
        Self {
            placement: found.name,
            tan_x: x,
            tan_y: y,
            s_z: found.depth,
            half_width: at_depth(x),
            half_height: at_depth(y),
            axis: AxisReport::of(&placement.axes),
            window: placement.window,
            need_megapixels: found.need[0] * found.need[1] / 1e6,
            need: found.need.map(|side| (side - 1e-6).ceil() as u32),
            source: found.size,
            seen_share: found.seen_share,
            map_error_px: found.map_error,
            panels: rows.collect(),
        }
    }

    fn text(&self) -> String {
        let AxisReport {
            yaw_deg,
            pitch_deg,
            roll_deg,
        } = self.axis;
        // To the other side, rather than less than nothing to this one.
        let turned = |degrees: f64, [to, from]: [&str; 2]| {
            let shown = format!("{:.2}", degrees.abs());
            let is_to = degrees >= 0.0 || shown == "0.00";
            format!("{shown}° {}", if is_to { to } else { from })
        };
        let axis = [
            turned(yaw_deg, ["to the right", "to the left"]),
            turned(pitch_deg, ["up", "down"]),
            turned(roll_deg, ["clockwise", "counter-clockwise"]),
        ];
        let axis = axis.join(", ");
        let ([nw, nh], [w, h]) = (self.need, self.source);
        let mut text = format!(
            "{}: {:.2} megapixels needed, {nw}x{nh}\n\
             axis {axis}\n",
            self.placement, self.need_megapixels,
        );
        let [left, right, up, down] = self.window;
        let _ = match self.tan_x {
            Some(_) => writeln!(
                text,
                "tangents {left:.4} left, {right:.4} right, {up:.4} up, {down:.4} down"
            ),
            None => {
                let [left, right] = [left, right].map(f64::to_degrees);
                let rows = match self.placement {
                    "cylinder" => format!("tangents {up:.4} up, {down:.4} down"),
                    _ => {
                        let [up, down] = [up, down].map(f64::to_degrees);
                        format!("{up:.2}° up, {down:.2}° down")
                    }
                };
                writeln!(text, "azimuth {left:.2}° left, {right:.2}° right; {rows}")
            }
        };
        let _ = writeln!(
            text,
            "the panels show {:.1} % of the source",
            self.seen_share * 100.0
        );
        if self.map_error_px > 0.0 {
            let _ = writeln!(
                text,
                "maps are at most {:.4} source pixels off",
                self.map_error_px
            );
        }
        let _ = writeln!(
            text,
            "at {w}x{h}, source pixels for each of a panel, along a side: mean, least to most"
        );
        for panel in &self.panels {
            let _ = writeln!(
                text,
                "  {:<12} {:<5} {:.3}, {:.3} to {:.3}: {}",
                panel.id, panel.eye, panel.density, panel.sigma_min, panel.sigma_max, panel.filter,
            );
        }
        text
    }
}

pub(crate) fn run(args: &FitArgs) -> anyhow::Result<()> {
    let source = source_size(args.source.as_deref())?;
    let rig = args.rig.read()?;
    let panels = args.rig.panels(&rig);
    let found = args.rig.fit(&rig, &panels, source)?;
    if let SourceSize::Picture(size) = source {
        tell_part(&panels, &found.placement, size);
    }
    let report = FitReport::of(&panels, &found);
    output::result(args.json, &report, &report.text())
}
