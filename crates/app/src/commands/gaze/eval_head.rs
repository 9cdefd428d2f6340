//! How true is gaze from head motion, ours and the published models'?

use crate::commands::gaze::recordings::{PresetOptions, Recordings};
use crate::report::output;
use clap::Args;
use foveal_eval::gaze::angle_statistics::AngleStatistics;
use foveal_eval::gaze::head_protocol::{ByPredictor, evaluate_head};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Clone, Debug, Args)]
pub(crate) struct EvalHeadArgs {
    #[command(flatten)]
    recordings: Recordings,
    #[command(flatten)]
    preset: PresetOptions,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct HeadEvaluation {
    predictors: ByPredictor<AngleStatistics>,
    recordings: Vec<RecordingMeans>,
}

/// Mean errors in one recording, in degrees.
#[derive(Debug, Serialize)]
struct RecordingMeans {
    file: String,
    centre_mean_deg: f64,
    sgaze_mean_deg: f64,
    foveal_mean_deg: f64,
}

impl HeadEvaluation {
    fn text(&self) -> String {
        let mut text = format!(
            "{:<9}{:>8}{:>8}{:>8}{:>8}{:>7}{:>7}{:>7}\n",
            "degrees", "mean", "median", "p90", "p95", "<=5", "<=10", "<=15"
        );
        for (name, errors) in self.predictors.each() {
            let _ = writeln!(
                text,
                "{name:<9}{:>8.2}{:>8.2}{:>8.2}{:>8.2}{:>6.0}%{:>6.0}%{:>6.0}%",
                errors.mean_deg,
                errors.median_deg,
                errors.p90_deg,
                errors.p95_deg,
                errors.within_5_deg_share * 100.0,
                errors.within_10_deg_share * 100.0,
                errors.within_15_deg_share * 100.0,
            );
        }
        let _ = writeln!(
            text,
            "\n{:>8}{:>8}{:>8}{:>8}  recording",
            "centre", "sgaze", "foveal", "ratio"
        );
        for one in &self.recordings {
            let _ = writeln!(
                text,
                "{:>8.2}{:>8.2}{:>8.2}{:>8.3}  {}",
                one.centre_mean_deg,
                one.sgaze_mean_deg,
                one.foveal_mean_deg,
                one.foveal_mean_deg / one.sgaze_mean_deg,
                one.file
            );
        }
        text
    }
}

pub(crate) fn run(args: &EvalHeadArgs) -> anyhow::Result<()> {
    let recordings = args.recordings.read()?;
    let report = evaluate_head(&recordings, &args.preset.fits(&recordings)?);
    let means = report.recordings.iter().zip(args.recordings.names());
    let evaluation = HeadEvaluation {
        predictors: report.pooled,
        recordings: means
            .map(|(means, file)| RecordingMeans {
                file,
                centre_mean_deg: means.centre,
                sgaze_mean_deg: means.sgaze,
                foveal_mean_deg: means.foveal,
            })
            .collect(),
    };
    output::result(args.json, &evaluation, &evaluation.text())
}
