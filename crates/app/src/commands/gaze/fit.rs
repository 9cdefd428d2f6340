//! Which preset follows a viewer's own recordings?

use crate::commands::gaze::recordings::Recordings;
use crate::report::output::{self, write_out};
use anyhow::bail;
use clap::Args;
use foveal_core::gaze::head_prediction::saturating::{AxisCurve, HeadGazePreset};
use foveal_core::units::counted;
use foveal_eval::gaze::head_fit::fit_head;
use foveal_eval::gaze::head_protocol::evaluate_head;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
pub(crate) struct FitHeadArgs {
    #[command(flatten)]
    recordings: Recordings,
    /// The preset to write; `gaze eval head --preset` reads it.
    #[arg(long, value_name = "PRESET.toml")]
    out: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct HeadFitted {
    file: String,
    samples: usize,
    preset: HeadGazePreset,
    /// Mean error on the same recordings, in degrees.
    mean_deg: f64,
    /// Of Hu et al. 2019 on them.
    sgaze_mean_deg: f64,
    /// Mean gaze of the recordings, to the right and up.
    mean_gaze_deg: [f64; 2],
}

impl HeadFitted {
    fn text(&self) -> String {
        let mut text = format!("{}, from {}\n", self.file, counted(self.samples, "sample"));
        for (axis, curve) in [("yaw", &self.preset.yaw), ("pitch", &self.preset.pitch)] {
            let _ = write!(text, "{axis:<6}");
            for ((name, _), value) in AxisCurve::RANGES.iter().zip(curve.parameters()) {
                let _ = write!(text, " {name} {value:.3}");
            }
            text.push('\n');
        }
        let _ = writeln!(
            text,
            "mean error on them {:.2} degrees (sgaze {:.2}), spread {:.2}",
            self.mean_deg, self.sgaze_mean_deg, self.preset.spread_deg
        );
        text
    }
}

/// Fewest samples, at 100 Hz, that a preset is fitted on.
const LEAST_SAMPLES: usize = 1000;

pub(crate) fn run(args: &FitHeadArgs) -> anyhow::Result<()> {
    args.recordings.spared_by(&args.out)?;
    let recordings = args.recordings.read()?;
    let samples: usize = recordings.iter().map(|one| one.rows().len()).sum();
    if samples < LEAST_SAMPLES {
        bail!(
            "--data holds {} of eyes and head; give at least {LEAST_SAMPLES} (ten seconds): fewer \
             say nothing of how a gaze follows a head",
            counted(samples, "sample")
        );
    }
    let fit = fit_head(&recordings.iter().collect::<Vec<_>>());
    let errors = evaluate_head(&recordings, &vec![fit.clone(); recordings.len()]).pooled;
    write_out(&args.out, toml::to_string(&fit.preset)?.as_bytes())?;
    let fitted = HeadFitted {
        file: args.out.display().to_string(),
        samples,
        mean_deg: errors.foveal.mean_deg,
        sgaze_mean_deg: errors.sgaze.mean_deg,
        mean_gaze_deg: fit.mean.degrees(),
        preset: fit.preset,
    };
    output::result(args.json, &fitted, &fitted.text())
}
