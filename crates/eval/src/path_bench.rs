//! What do a gaze sample and a choice among many units cost, besides weighing them?

use crate::bench_cases::{BUDGET_BYTES, LEVELS, UNITS, large_catalog, values_at};
use crate::gaze::synthetic::{SyntheticConfig, synthetic_recording};
use crate::timing::{TimedRow, timed_parts};
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::gaze::tracker::GazeTracker;
use foveal_core::selection::greedy::{CatalogError, Rule};
use foveal_core::units::Seconds;
use std::hint::black_box;

/// Ahead of a sample for which the gaze is predicted.
const AHEAD: Seconds = Seconds(0.03);
/// Times that a trace is followed in one run: long enough for a coarse clock.
const REPEATS: usize = 20;
/// Ticks of one run.
const TICKS: usize = 20;

/// Times one sample of a synthetic eye at 500 Hz: taken, and the gaze predicted 30 ms on.
#[must_use]
pub fn time_gaze_path(runs: usize) -> TimedRow {
    let config = SyntheticConfig {
        rate_hz: 500.0,
        seconds: 10.0,
        ..SyntheticConfig::default()
    };
    let samples = synthetic_recording(&config).trials.remove(0).samples;
    let name = "gaze sample at 500 Hz, taken and predicted from";
    timed_parts(name, runs, REPEATS * samples.len(), || {
        for _ in 0..REPEATS {
            let mut tracker = GazeTracker::new(HeadGazePreset::search());
            for sample in &samples {
                tracker.push(sample);
                black_box(tracker.predict(Seconds(sample.time.0 + AHEAD.0)));
            }
        }
    })
}

/// Times a tick of 100,000 units x 4 levels with a budget of 2,000 steps: new values of all units,
/// or of 1 % of them, then the selection.
///
/// # Errors
/// None that these sizes can cause.
pub fn time_selection(runs: usize) -> Result<Vec<TimedRow>, CatalogError> {
    let mut catalog = large_catalog(Rule::default())?;
    let cases = [("all values new", 1), ("1 % of the values new", 100)];
    let rows = cases.map(|(name, every)| {
        let moments = [1, 2].map(|moment| {
            let units = (0..UNITS).step_by(every);
            let values = units.map(|unit| (unit, values_at(unit, moment)));
            values.collect::<Vec<(u32, [f64; LEVELS])>>()
        });
        let name = format!("selection, 100,000 units x 4 levels, 2,000 steps, {name}");
        timed_parts(&name, runs, TICKS, || {
            for tick in 0..TICKS {
                for (unit, values) in &moments[tick % 2] {
                    catalog.set_values(*unit, values);
                }
                black_box(catalog.select(BUDGET_BYTES));
            }
        })
    });
    Ok(rows.into())
}
