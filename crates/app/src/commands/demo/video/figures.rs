//! Which figures compare the policies?

use crate::commands::demo::page::part::FigureRow;
use crate::commands::demo::video::run::{COLUMNS, FULL, Played, PolicyRun, VIEWPORT};
use crate::commands::score::ScoreReport;
use crate::commands::simulate::summary::RunSummary;
use foveal_core::units::counted;
use serde::Serialize;
use std::collections::BTreeMap;

/// Figures of one policy: what it took, and that over what the baselines took.
#[derive(Debug, Serialize)]
pub(crate) struct PolicyFigures {
    #[serde(flatten)]
    summary: RunSummary,
    #[serde(skip_serializing_if = "Option::is_none")]
    source_score: Option<ScoreReport>,
    pixels_of_full: f64,
    pixels_of_viewport: f64,
    decode_time_of_full: f64,
    decode_time_of_viewport: f64,
    bytes_of_full: f64,
    bytes_of_viewport: f64,
}

/// What is compared between policies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cost {
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
pub(crate) fn ratio(runs: &[PolicyRun], of: Cost, index: usize, baseline: usize) -> f64 {
    let [own, base] = [index, baseline].map(|run| cost(&runs[run].summary, of));
    if own == base {
        1.0
    } else {
        own / base.max(f64::MIN_POSITIVE)
    }
}

/// The figures of all runs, by the names of [`COLUMNS`].
pub(crate) fn by_policy(played: Played) -> BTreeMap<&'static str, PolicyFigures> {
    let runs = played.runs;
    let ratios: Vec<[f64; 6]> = (0..runs.len())
        .map(|index| {
            let over = |of, baseline| ratio(&runs, of, index, baseline);
            [Cost::Pixels, Cost::DecodeTime, Cost::Bytes]
                .map(|of| [over(of, FULL), over(of, VIEWPORT)])
                .concat()
                .try_into()
                .unwrap_or_default()
        })
        .collect();
    let figures = |((run, column), ratios): ((PolicyRun, &'static str), [f64; 6])| {
        let figures = PolicyFigures {
            summary: run.summary,
            source_score: run.source_score,
            pixels_of_full: ratios[0],
            pixels_of_viewport: ratios[1],
            decode_time_of_full: ratios[2],
            decode_time_of_viewport: ratios[3],
            bytes_of_full: ratios[4],
            bytes_of_viewport: ratios[5],
        };
        (column, figures)
    };
    runs.into_iter()
        .zip(COLUMNS)
        .zip(ratios)
        .map(figures)
        .collect()
}

/// The rows of the table; pictures of a still are never late.
pub(crate) fn rows(runs: &[PolicyRun], is_still: bool) -> Vec<FigureRow> {
    let row = |what: &str, unit, cell: &dyn Fn(&PolicyRun) -> String| FigureRow {
        what: what.to_owned(),
        unit,
        cells: runs.iter().map(cell).collect(),
        opens_group: false,
    };
    let over = |what: &str, of, baseline| FigureRow {
        what: what.to_owned(),
        unit: "%",
        cells: (0..runs.len())
            .map(|index| format!("{:.1}", ratio(runs, of, index, baseline) * 100.0))
            .collect(),
        opens_group: of == Cost::Pixels && baseline == FULL,
    };
    let amount = |what: &str, unit, value: &dyn Fn(&RunSummary) -> f64| {
        let values: Vec<f64> = runs.iter().map(|run| value(&run.summary)).collect();
        let decimals = decimals(&values);
        FigureRow {
            what: what.to_owned(),
            unit,
            cells: values.iter().map(|v| format!("{v:.decimals$}")).collect(),
            opens_group: false,
        }
    };
    let percent = |share: f64| format!("{:.1}", share * 100.0);
    let mut rows = vec![
        row("Pixels a frame, mean", "%", &|it| {
            percent(it.summary.pixels_share_mean)
        }),
        row("Pixels a frame, most", "%", &|it| {
            percent(it.summary.pixels_share_max)
        }),
        row("Score against full", "JOD", &|it| {
            jod(it.summary.score.as_ref())
        }),
        row("Score against the source", "JOD", &|it| {
            jod(it.source_score.as_ref())
        }),
        amount("Fetched", "MB", &|s| s.bytes as f64 / 1e6),
        amount("Decoded", "MPix", &|s| s.decoded_megapixels),
        amount("Decoding a frame, mean", "ms", &|s| s.decode_ms_mean),
        amount("Decoding a frame, 95th percentile", "ms", &|s| {
            s.decode_ms_p95
        }),
        amount("GPU memory", "MB", &|s| s.gpu_bytes as f64 / 1e6),
    ];
    if !is_still {
        rows.push(row("Late frames", "", &|it| {
            it.summary.late_frames.to_string()
        }));
        rows.push(row("Incomplete frames", "", &|it| {
            it.summary.incomplete_frames.to_string()
        }));
    }
    rows.extend([
        over("Pixels, of full", Cost::Pixels, FULL),
        over("Pixels, of viewport", Cost::Pixels, VIEWPORT),
        over("Bytes, of full", Cost::Bytes, FULL),
        over("Bytes, of viewport", Cost::Bytes, VIEWPORT),
        over("Decoding time, of full", Cost::DecodeTime, FULL),
        over("Decoding time, of viewport", Cost::DecodeTime, VIEWPORT),
    ]);
    rows
}

/// A score as it is written; a dash where there is none.
pub(crate) fn jod(score: Option<&ScoreReport>) -> String {
    score.map_or("–".to_owned(), |score| format!("{:.2}", score.jod))
}

/// Decimals that show three digits of the largest value, at most four.
fn decimals(values: &[f64]) -> usize {
    let largest = values.iter().copied().fold(0.0, f64::max).max(1e-9);
    (2.0 - largest.log10().floor()).clamp(0.0, 4.0) as usize
}

/// How many pictures were played, in words.
pub(crate) fn frames(runs: &[PolicyRun]) -> String {
    counted(runs.first().map_or(0, |run| run.reports.len()), "frame")
}
