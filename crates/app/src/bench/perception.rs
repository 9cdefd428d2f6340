//! What does it cost to weigh the steps of a decision?

use super::BenchArgs;
use super::gpu::time_on_gpu;
use crate::demo::machine::Machine;
use crate::output::{self, out_of_range};
use anyhow::bail;
use foveal_eval::importance_bench::{Decision, ImportanceTimes, TimedRow, time_importance};
use foveal_render::Gpu;
use serde::Serialize;
use std::fmt::Write;

const SIZE: [u32; 2] = [1920, 1080];

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    importance: ImportanceTimes,
}

pub(super) fn run(args: &BenchArgs) -> anyhow::Result<()> {
    if !(5..=1000).contains(&args.runs) {
        bail!(out_of_range("--runs", args.runs, "5 to 1000"));
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
    };
    output::result(args.json, &report, &text(&report))
}

fn text(report: &Report) -> String {
    let times = &report.importance;
    let mut text = report.machine.text();
    let ([w, h], levels, units) = (times.size, times.levels, times.units);
    let _ = writeln!(
        text,
        "\nimportance, {w}x{h}, {levels} levels, {units} units:"
    );
    for row in &times.rows {
        let TimedRow {
            name,
            median_ms,
            range_ms: [least, most],
            runs,
        } = row;
        let _ = writeln!(
            text,
            "{name}: {median_ms:.1} ms ({least:.1} to {most:.1}, {runs} runs)"
        );
    }
    let _ = writeln!(text, "ratio {:.1}", times.ratio);
    text
}
