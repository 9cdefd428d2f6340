//! What does a row of the report say, and how do ours and the baseline take turns?

use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::time::Instant;

/// The smallest and the largest of some runs.
type Range = [f64; 2];

/// One thing that was measured, ours and the baseline.
#[derive(Debug, Serialize)]
pub(super) struct BenchRow {
    /// Name of the file.
    content: String,
    what: String,
    /// Half of the runs were at most so.
    ours: f64,
    baseline: Option<f64>,
    /// Ours over the baseline.
    ratio: Option<f64>,
    unit: &'static str,
    /// What ours, or the ratio, should be.
    asked: Option<String>,
    runs: usize,
    spread: Spread,
    /// What else belongs to it.
    extra: BTreeMap<&'static str, f64>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Spread {
    ours: Range,
    baseline: Option<Range>,
}

/// What runs gave, in order.
#[derive(Debug, Default)]
pub(super) struct Turns {
    pub(super) ours: Vec<f64>,
    pub(super) baseline: Vec<f64>,
}

impl Turns {
    /// One number that is the same in each run, with its baseline.
    pub(super) fn once(ours: f64, baseline: Option<f64>) -> Self {
        Self {
            ours: vec![ours],
            baseline: baseline.into_iter().collect(),
        }
    }

    /// Runs both in turn, after one turn to warm up.
    pub(super) fn take(
        runs: usize,
        mut ours: impl FnMut() -> anyhow::Result<f64>,
        mut baseline: impl FnMut() -> anyhow::Result<f64>,
    ) -> anyhow::Result<Self> {
        let mut turns = Self::default();
        for turn in 0..=runs {
            let [ours, baseline] = [ours()?, baseline()?];
            if turn > 0 {
                turns.ours.push(ours);
                turns.baseline.push(baseline);
            }
        }
        Ok(turns)
    }

    /// The row of these runs.
    pub(super) fn row(
        self,
        content: &str,
        what: impl Into<String>,
        unit: &'static str,
    ) -> BenchRow {
        let runs = self.ours.len();
        let (ours, of_ours) = median(self.ours).unwrap_or_default();
        let baseline = median(self.baseline);
        BenchRow {
            content: content.to_owned(),
            what: what.into(),
            ours,
            baseline: baseline.map(|(median, _)| median),
            ratio: baseline
                .map(|(median, _)| ours / median)
                .filter(|ratio| ratio.is_finite()),
            unit,
            asked: None,
            runs,
            spread: Spread {
                ours: of_ours,
                baseline: baseline.map(|(_, range)| range),
            },
            extra: BTreeMap::new(),
        }
    }
}

impl BenchRow {
    /// The same with what is asked of it.
    pub(super) fn asked(mut self, asked: impl Into<String>) -> Self {
        self.asked = Some(asked.into());
        self
    }

    /// The same with another number.
    pub(super) fn with(mut self, name: &'static str, value: f64) -> Self {
        self.extra.insert(name, value);
        self
    }
}

fn median(mut values: Vec<f64>) -> Option<(f64, Range)> {
    values.sort_by(f64::total_cmp);
    let range = [*values.first()?, *values.last()?];
    Some((values[values.len() / 2], range))
}

/// Milliseconds of this thread that `work` takes, from repeating it for so long that a coarse clock
/// will do.
pub(super) fn thread_ms_each(mut work: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<f64> {
    const LEAST_MS: f64 = 300.0;
    let begun = Instant::now();
    let (before, _) = foveal_eval::timing::thread_ms(begun);
    let mut times = 0.0;
    loop {
        work()?;
        times += 1.0;
        if begun.elapsed().as_secs_f64() * 1e3 >= LEAST_MS {
            let (after, _) = foveal_eval::timing::thread_ms(begun);
            return Ok((after - before) / times);
        }
    }
}

/// The rows as a table.
pub(super) fn table(rows: &[BenchRow]) -> String {
    let head = ["", "ours", "baseline", "unit", "ratio", "asked"].map(str::to_owned);
    let told = rows.iter().map(|row| {
        let of = |median: f64, [least, most]: Range| match least == most {
            true => number(median),
            false => format!("{} ({}-{})", number(median), number(least), number(most)),
        };
        let baseline = row.baseline.zip(row.spread.baseline);
        [
            format!("{}: {}", row.content, row.what),
            of(row.ours, row.spread.ours),
            baseline.map_or("-".to_owned(), |(median, range)| of(median, range)),
            row.unit.to_owned(),
            row.ratio.map_or("-".to_owned(), number),
            row.asked.clone().unwrap_or("-".to_owned()),
        ]
    });
    let lines: Vec<[String; 6]> = std::iter::once(head).chain(told).collect();
    let width = |column: usize| lines.iter().map(|it| it[column].chars().count()).max();
    let widths: Vec<usize> = (0..6).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for (line, row) in lines
        .iter()
        .zip(std::iter::once(None).chain(rows.iter().map(Some)))
    {
        for (cell, width) in line.iter().zip(&widths) {
            let _ = write!(text, "{cell:width$}  ");
        }
        for (name, value) in row.iter().flat_map(|row| &row.extra) {
            let _ = write!(text, "{name} {} ", number(*value));
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text
}

/// A number in about three places.
fn number(value: f64) -> String {
    match value.abs() {
        size if size >= 100.0 || value.fract() == 0.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 0.1 => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}
