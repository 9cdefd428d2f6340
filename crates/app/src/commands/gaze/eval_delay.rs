//! What is the best expectation of a gaze that was last seen some time ago?

use crate::commands::gaze::recordings::{PresetOptions, Recordings};
use crate::report::output::{self, out_of_range, write_out};
use crate::report::plot::{self, PlotLine, PlottedRun};
use anyhow::Context;
use clap::Args;
use foveal_eval::gaze::delay_protocol::{DELAYS_MS, DelayErrors, evaluate_delay};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Longest delay that may be asked for, in milliseconds.
const LONGEST_MS: f64 = 60_000.0;

#[derive(Clone, Debug, Args)]
pub(crate) struct EvalDelayArgs {
    #[command(flatten)]
    recordings: Recordings,
    /// Times since the gaze was last seen, in milliseconds, in steps of 10.
    #[arg(long, value_name = "MS,..", value_delimiter = ',', default_values_t = DELAYS_MS)]
    delays: Vec<f64>,
    #[command(flatten)]
    preset: PresetOptions,
    /// Draw the errors by delay into an SVG picture.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct DelayEvaluation {
    delays: Vec<DelayErrors>,
}

impl DelayEvaluation {
    fn text(&self) -> String {
        let mut text = format!("{:>6}{:>9}{:>9}{:>9}\n", "ms", "last", "head", "blend");
        for found in &self.delays {
            let _ = writeln!(
                text,
                "{:>6}{:>9.2}{:>9.2}{:>9.2}",
                found.delay_ms, found.last_mean_deg, found.head_mean_deg, found.blend_mean_deg
            );
        }
        text + "mean degrees\n"
    }

    /// Three lines over the delays, in their order.
    fn plot(&self) -> String {
        let mut sorted: Vec<&DelayErrors> = self.delays.iter().collect();
        sorted.sort_by(|a, b| a.delay_ms.total_cmp(&b.delay_ms));
        let of = |value: fn(&DelayErrors) -> f64| -> Vec<f64> {
            sorted.iter().map(|found| value(found)).collect()
        };
        let times = of(|found| found.delay_ms);
        let run = PlottedRun {
            times: &times,
            unit: "ms",
            moving: &[],
            pictured: None,
        };
        let line = |class, value| PlotLine {
            class,
            values: of(value),
        };
        let lines = [
            line("last", |found| found.last_mean_deg),
            line("head", |found| found.head_mean_deg),
            line("blend", |found| found.blend_mean_deg),
        ];
        plot::file(
            "mean error in degrees, by age of the last gaze",
            &run,
            &lines,
        )
    }
}

pub(crate) fn run(args: &EvalDelayArgs) -> anyhow::Result<()> {
    if let Some(wrong) = args.delays.iter().find(|&&ms| !is_delay(ms)) {
        let range = format!("multiples of 10 from 0 to {LONGEST_MS}");
        return Err(out_of_range("--delays", wrong, &range).into());
    }
    if let Some(path) = &args.plot {
        args.recordings.spared_by(path)?;
    }
    let recordings = args.recordings.read()?;
    let fits = args.preset.fits(&recordings)?;
    let delays = args.delays.iter().map(|&ms| {
        evaluate_delay(&recordings, &fits, ms)
            .with_context(|| format!("--delays {ms}: every recording is shorter; give less"))
    });
    let evaluation = DelayEvaluation {
        delays: delays.collect::<anyhow::Result<_>>()?,
    };
    if let Some(path) = &args.plot {
        write_out(path, evaluation.plot().as_bytes())?;
    }
    output::result(args.json, &evaluation, &evaluation.text())
}

fn is_delay(ms: f64) -> bool {
    (0.0..=LONGEST_MS).contains(&ms) && ms % 10.0 == 0.0
}
