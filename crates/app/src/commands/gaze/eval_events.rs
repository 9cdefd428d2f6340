//! `foveal gaze eval saccade|landing|filter`: how true is what is said of eye events?

use crate::commands::gaze::labelled_file::read_recording;
use crate::gaze_source::parse_tracker_screen;
use crate::report::output;
use clap::Args;
use foveal_eval::gaze::filter::judge_filter;
use foveal_eval::gaze::labelled::LabelScreen;
use foveal_eval::gaze::landing::{LandingReport, judge_landings};
use foveal_eval::gaze::recording::Recording;
use foveal_eval::gaze::saccade::{SaccadeReport, SaccadeScore, judge_saccades};
use foveal_eval::gaze::synthetic::{SyntheticConfig, synthetic_recording};
use std::fmt::Write;
use std::path::PathBuf;

/// What is judged.
#[derive(Debug, Args)]
pub(crate) struct EventArgs {
    /// Labelled recordings: CSV with x_deg, y_deg, valid, event (1000 Hz), or trial, fs_hz, i,
    /// x_px, y_px and a coder_NAME per coder. Without any, synthetic ones.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    data: Vec<PathBuf>,
    /// Size, pixels and distance of the screen that pixels lie on.
    #[arg(long, value_name = "WxHm,WxH,Dm", value_parser = parse_tracker_screen)]
    screen: Option<LabelScreen>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Rate, noise and pursuit of the synthetic recordings.
const SYNTHETIC: [(f64, f64, f64); 4] = [
    (1000.0, 0.02, 0.0),
    (500.0, 0.03, 0.0),
    (500.0, 0.05, 15.0),
    (500.0, 0.08, 30.0),
];

impl EventArgs {
    fn recordings(&self) -> anyhow::Result<Vec<Recording>> {
        if self.data.is_empty() {
            let make = |(rate_hz, noise_rms_deg, pursuit_deg_per_s)| {
                synthetic_recording(&SyntheticConfig {
                    rate_hz,
                    noise_rms_deg,
                    pursuit_deg_per_s,
                    ..SyntheticConfig::default()
                })
            };
            return Ok(SYNTHETIC.into_iter().map(make).collect());
        }
        self.data
            .iter()
            .map(|path| read_recording(path, self.screen.as_ref()))
            .collect()
    }
}

/// Runs the protocol for saccades.
pub(crate) fn saccade(args: &EventArgs) -> anyhow::Result<()> {
    let report = judge_saccades(&args.recordings()?);
    output::result(args.json, &report, &saccade_table(&report))
}

/// Runs the protocol for landings.
pub(crate) fn landing(args: &EventArgs) -> anyhow::Result<()> {
    let report = judge_landings(&args.recordings()?);
    output::result(args.json, &report, &landing_table(&report))
}

/// Runs the protocol for the filter.
pub(crate) fn filter(args: &EventArgs) -> anyhow::Result<()> {
    let report = judge_filter(&args.recordings()?);
    let lag = report
        .extra_lag_samples
        .map_or("-".to_owned(), |lag| lag.to_string());
    let verdict = if report.conforms { "yes" } else { "no" };
    let text = format!(
        "1 € filter as published (to 1e-12)     {verdict}\n\
         most it delays a saccade, in samples   {lag}\n"
    );
    output::result(args.json, &report, &text)
}

fn saccade_table(report: &SaccadeReport) -> String {
    let mut text = format!(
        "{:<52} {:>6} {:>6} {:>8} {:>8} {:>9}\n",
        "saccades", "kappa", "F1", "lag ms", "p90 ms", "false/min"
    );
    let mut row = |name: &str, score: &SaccadeScore| {
        let _ = writeln!(
            text,
            "{name:<52} {:>6} {:>6} {:>8} {:>8} {:>9}",
            number(score.kappa, 3),
            number(score.event_f1, 3),
            number(score.onset_lag_ms_median, 1),
            number(score.onset_lag_ms_p90, 1),
            number(score.false_events_per_minute, 1),
        );
    };
    for file in &report.by_file {
        row(&file.file, &file.score);
        for coder in file.by_coder.iter().filter(|_| file.by_coder.len() > 1) {
            row(&format!("  coder {}", coder.coder), &coder.score);
        }
    }
    row("all", &report.score);
    row("all, baseline: faster than 180 deg/s", &report.baseline_180);
    for (name, score) in [
        ("Engbert & Kliegl 2003", &report.baseline_engbert_kliegl),
        ("I-VT, 30 deg/s over 20 ms", &report.baseline_ivt_30),
    ] {
        row(&format!("all, baseline: {name} (offline)"), score);
    }
    text
}

fn landing_table(report: &LandingReport) -> String {
    let mut text = "after detection   predicted landing   current sample   saccades\n".to_owned();
    for score in &report.after_ms {
        let _ = writeln!(
            text,
            "{:>12} ms {:>15} deg {:>12} deg {:>10}",
            score.ms,
            number(score.predicted_deg, 2),
            number(score.current_deg, 2),
            score.saccades
        );
    }
    text
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
}
