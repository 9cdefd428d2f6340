//! What does a decision cost: a gaze, the values of steps, a choice?

use crate::commands::bench::gpu::time_on_gpu;
use crate::commands::demo::machine::Machine;
use crate::report::output::{self, out_of_range};
use anyhow::bail;
use clap::Args;
use foveal_core::units::counted;
use foveal_eval::importance_bench::{Decision, ImportanceTimes, time_importance};
use foveal_eval::path_bench::{time_gaze_path, time_selection};
use foveal_eval::timing::{Clock, TimedRow};
use foveal_render::Gpu;
use serde::Serialize;
use std::fmt::Write;

const SIZE: [u32; 2] = [1920, 1080];

#[derive(Clone, Debug, Args)]
pub(crate) struct PerceptionBenchArgs {
    /// Runs of each way, besides one to warm up; 1 to 1000.
    #[arg(long, value_name = "N", default_value_t = 7)]
    runs: usize,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    importance: ImportanceTimes,
    /// One sample.
    gaze: TimedRow,
    /// One tick, by how much of the values is new.
    selection: Vec<TimedRow>,
}

pub(super) fn run(args: &PerceptionBenchArgs) -> anyhow::Result<()> {
    if !(1..=1000).contains(&args.runs) {
        bail!(out_of_range("--runs", args.runs, "1 to 1000"));
    }
    let mut importance = time_importance(SIZE, args.runs);
    // A machine without an adapter has one row less.
    let gpu = Gpu::open_blocking().ok();
    if let Some(gpu) = &gpu {
        let decision = Decision::generated(SIZE);
        importance
            .rows
            .push(time_on_gpu(gpu, &decision, args.runs)?);
    }
    let name = gpu.as_ref().map_or("none", Gpu::adapter_name);
    let report = Report {
        machine: Machine::here(name.to_owned()),
        importance,
        gaze: time_gaze_path(args.runs),
        selection: time_selection(args.runs)?,
    };
    output::result(args.json, &report, &text(&report))
}

fn text(report: &Report) -> String {
    let times = &report.importance;
    let mut text = report.machine.text();
    let ([w, h], levels, units) = (times.size_px, times.levels, times.units);
    let _ = writeln!(
        text,
        "\nimportance, {w}x{h}, {}, {}:",
        counted(levels, "level"),
        counted(units, "unit")
    );
    for row in &times.rows {
        write_row(&mut text, row);
    }
    let _ = writeln!(text, "ratio {:.1}\n", times.ratio);
    for row in core::iter::once(&report.gaze).chain(&report.selection) {
        write_row(&mut text, row);
    }
    text
}

fn write_row(text: &mut String, row: &TimedRow) {
    // Short times are given in microseconds.
    let (unit, scale) = if row.median_ms < 0.1 {
        ("µs", 1000.0)
    } else {
        ("ms", 1.0)
    };
    let [median, least, most] = [row.median_ms, row.range_ms[0], row.range_ms[1]];
    let clock = match row.clock {
        Clock::ThreadCpu => "thread CPU time",
        Clock::Gpu => "by the GPU's time stamps",
        Clock::Wall => "wall time",
    };
    let _ = writeln!(
        text,
        "{}: {:.2} {unit} ({:.2} to {:.2}, {}, {clock})",
        row.name,
        median * scale,
        least * scale,
        most * scale,
        counted(row.runs, "run")
    );
}
