//! Which figures compare the policies, and how do they read as a table?

use crate::commands::demo::run::{FULL, PolicyRun, VIEWPORT};
use crate::commands::simulate::RunSummary;
use foveal_core::units::counted;
use serde::Serialize;
use std::fmt::Write as _;

/// Figures of one policy: what it took, and that over what the baselines took.
#[derive(Debug, Serialize)]
pub(super) struct PolicyFigures<'a> {
    #[serde(flatten)]
    summary: &'a RunSummary,
    pixels_of_full: f64,
    pixels_of_viewport: f64,
    decode_time_of_full: f64,
    decode_time_of_viewport: f64,
    bytes_of_full: f64,
    bytes_of_viewport: f64,
}

/// One row of the table: what, in which unit, and a cell a policy.
pub(super) struct FigureRow {
    pub(super) what: &'static str,
    pub(super) unit: &'static str,
    pub(super) cells: Vec<String>,
    /// Whether it begins another kind of figures.
    pub(super) opens_group: bool,
}

/// What is compared between policies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cost {
    Pixels,
    DecodeTime,
    Bytes,
}

fn cost(summary: &RunSummary, of: Cost) -> f64 {
    match of {
        Cost::Pixels => summary.pixels_share_mean,
        Cost::DecodeTime => summary.decode_ms_mean,
        Cost::Bytes => summary.bytes as f64,
    }
}

/// What run `index` costs over what run `baseline` costs.
pub(super) fn ratio(runs: &[PolicyRun], of: Cost, index: usize, baseline: usize) -> f64 {
    let [own, base] = [index, baseline].map(|run| cost(&runs[run].summary, of));
    if own == base {
        1.0
    } else {
        own / base.max(f64::MIN_POSITIVE)
    }
}

/// The figures of run `index`.
pub(super) fn figures(runs: &[PolicyRun], index: usize) -> PolicyFigures<'_> {
    let over = |of, baseline| ratio(runs, of, index, baseline);
    PolicyFigures {
        summary: &runs[index].summary,
        pixels_of_full: over(Cost::Pixels, FULL),
        pixels_of_viewport: over(Cost::Pixels, VIEWPORT),
        decode_time_of_full: over(Cost::DecodeTime, FULL),
        decode_time_of_viewport: over(Cost::DecodeTime, VIEWPORT),
        bytes_of_full: over(Cost::Bytes, FULL),
        bytes_of_viewport: over(Cost::Bytes, VIEWPORT),
    }
}

/// The rows of the table.
pub(super) fn rows(runs: &[PolicyRun]) -> Vec<FigureRow> {
    let row = |what, unit, cell: &dyn Fn(&RunSummary) -> String| FigureRow {
        what,
        unit,
        cells: runs.iter().map(|run| cell(&run.summary)).collect(),
        opens_group: false,
    };
    let over = |what, of, baseline| FigureRow {
        what,
        unit: "%",
        cells: (0..runs.len())
            .map(|index| format!("{:.1}", ratio(runs, of, index, baseline) * 100.0))
            .collect(),
        opens_group: of == Cost::Pixels && baseline == FULL,
    };
    let amount = |what, unit, value: &dyn Fn(&RunSummary) -> f64| {
        let values: Vec<f64> = runs.iter().map(|run| value(&run.summary)).collect();
        let decimals = decimals(&values);
        FigureRow {
            what,
            unit,
            cells: values.iter().map(|v| format!("{v:.decimals$}")).collect(),
            opens_group: false,
        }
    };
    let percent = |share: f64| format!("{:.2}", share * 100.0);
    vec![
        row("Pixels a frame, mean", "%", &|s| {
            percent(s.pixels_share_mean)
        }),
        row("Pixels a frame, most", "%", &|s| {
            percent(s.pixels_share_max)
        }),
        row("Score of the first frames", "JOD", &|s| {
            let jod = s.score.as_ref().map(|score| score.jod);
            jod.map_or("-".to_owned(), |jod| format!("{jod:.2}"))
        }),
        amount("Fetched", "MB", &|s| s.bytes as f64 / 1e6),
        amount("Decoded", "MPix", &|s| s.decoded_megapixels),
        amount("Decoding a frame, mean", "ms", &|s| s.decode_ms_mean),
        amount("Decoding a frame, 95th percentile", "ms", &|s| {
            s.decode_ms_p95
        }),
        row("Late frames", "", &|s| s.late_frames.to_string()),
        row("Incomplete frames", "", &|s| {
            s.incomplete_frames.to_string()
        }),
        amount("GPU memory", "MB", &|s| s.gpu_bytes as f64 / 1e6),
        over("Pixels, of full", Cost::Pixels, FULL),
        over("Pixels, of viewport", Cost::Pixels, VIEWPORT),
        over("Bytes, of full", Cost::Bytes, FULL),
        over("Decoding time, of full", Cost::DecodeTime, FULL),
        over("Decoding time, of viewport", Cost::DecodeTime, VIEWPORT),
    ]
}

/// Decimals that show three digits of the largest value, at most four.
fn decimals(values: &[f64]) -> usize {
    let largest = values.iter().copied().fold(0.0, f64::max).max(1e-9);
    (2.0 - largest.log10().floor()).clamp(0.0, 4.0) as usize
}

/// How many frames were played, in words.
pub(super) fn frames(runs: &[PolicyRun]) -> String {
    counted(runs.first().map_or(0, |run| run.reports.len()), "frame")
}

/// The table for a terminal.
pub(super) fn text(runs: &[PolicyRun]) -> String {
    let mut text = format!("{:<40}", "");
    for run in runs {
        let _ = write!(text, "{:>10}", run.summary.policy);
    }
    text.push('\n');
    for row in rows(runs) {
        let label = match row.unit {
            "" => row.what.to_owned(),
            unit => format!("{}, {unit}", row.what),
        };
        let _ = write!(text, "{label:<40}");
        for cell in row.cells {
            let _ = write!(text, "{cell:>10}");
        }
        text.push('\n');
    }
    text
}
