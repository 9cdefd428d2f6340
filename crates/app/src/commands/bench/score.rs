//! What does it cost to score a frame?

use crate::commands::bench::processor_time::cpu_seconds;
use crate::commands::demo::machine::Machine;
use crate::commands::score::Companions;
use crate::report::output::{self, out_of_range};
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::units::counted;
use foveal_eval::score::clear::ClearJudge;
use foveal_eval::score::golden::Golden;
use foveal_eval::score::gpu::GpuJudge;
use foveal_eval::score::{Display, Judge, Mode, ScorePicture, Viewing};
use foveal_render::Gpu;
use serde::Serialize;
use std::time::Instant;

#[derive(Clone, Debug, Args)]
pub(crate) struct ScoreBenchArgs {
    /// Frames of each turn; 1 to 1000.
    #[arg(long, value_name = "N", default_value_t = 12)]
    frames: usize,
    /// Turns, besides one to warm up; 1 to 100.
    #[arg(long, value_name = "N", default_value_t = 5)]
    runs: usize,
    /// Threads; processor time of all is what counts.
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
    /// Leave out the clear text, which takes some seconds a frame.
    #[arg(long)]
    no_baseline: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Frames of the golden that is scored, round and round: 1920x1080 at 30 Hz, a moving gaze.
const CASE: &str = "G14";
/// Frames that the clear text is given.
const CLEAR_FRAMES: usize = 2;
/// After so many seconds a device that is slow, as software in its place, is given no more frames.
const MOST_GPU_SECONDS: f64 = 10.0;
/// But at least so many, one more to warm up.
const LEAST_GPU_FRAMES: usize = 3;

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    size_px: [u32; 2],
    fps: f64,
    jobs: usize,
    frames: usize,
    /// Processor seconds a frame, all threads; null where the system does not report it.
    cpu_s_per_frame: Option<Spread>,
    /// Seconds by the clock a frame.
    clock_s_per_frame: Spread,
    /// Processor seconds a frame of the companions that `foveal score` reports with it.
    companions_cpu_s_per_frame: Option<f64>,
    /// Processor seconds a frame of the clear text.
    clear_cpu_s_per_frame: Option<f64>,
    /// How many times longer the clear text takes.
    ratio: Option<f64>,
    gpu: Option<GpuRow>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Spread {
    median: f64,
    range: [f64; 2],
}

#[derive(Debug, Serialize)]
struct GpuRow {
    adapter: String,
    /// Milliseconds a frame by the adapter's time stamps; null where it has none.
    stamped_ms: Option<Spread>,
    /// Milliseconds a frame by the clock, upload and read-back included.
    clock_ms: Spread,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        Some(Self {
            median: *values.get(values.len() / 2)?,
            range: [*values.first()?, *values.last()?],
        })
    }
}

/// Pictures, made before anything is timed.
struct Content {
    viewing: Viewing,
    frames: Vec<([ScorePicture; 2], [f64; 2])>,
}

impl Content {
    fn of(golden: &Golden) -> anyhow::Result<Self> {
        let display = Display::named(golden.display).context("a named display")?;
        let frame = |n: u32| -> anyhow::Result<_> {
            Ok((golden.pictures(n)?, golden.gaze_at(n).unwrap_or_default()))
        };
        Ok(Self {
            viewing: Viewing::new(display, golden.size, golden.fps, true, Mode::Compat)?,
            frames: (0..golden.frames)
                .map(frame)
                .collect::<anyhow::Result<_>>()?,
        })
    }

    fn at(&self, n: usize) -> &([ScorePicture; 2], [f64; 2]) {
        &self.frames[n % self.frames.len()]
    }
}

pub(super) fn run(args: &ScoreBenchArgs) -> anyhow::Result<()> {
    if !(1..=1000).contains(&args.frames) {
        bail!(out_of_range("--frames", args.frames, "1 to 1000"));
    }
    if !(1..=100).contains(&args.runs) {
        bail!(out_of_range("--runs", args.runs, "1 to 100"));
    }
    let content = Content::of(Golden::named(CASE).context("a golden")?)?;
    let (cpu, clock) = fast_seconds(&content, args)?;
    let clear = if args.no_baseline {
        None
    } else {
        clear_seconds(&content)?
    };
    let gpu = gpu_row(&content, args)?;
    let adapter = gpu.as_ref().map_or("none", |row| row.adapter.as_str());
    let report = Report {
        machine: Machine::here(adapter.to_owned()),
        size_px: content.viewing.size,
        fps: content.viewing.fps.unwrap_or_default(),
        jobs: args.jobs,
        frames: args.frames * args.runs,
        cpu_s_per_frame: cpu,
        clock_s_per_frame: clock,
        companions_cpu_s_per_frame: companion_seconds(&content, args.frames)?,
        clear_cpu_s_per_frame: clear,
        ratio: clear.zip(cpu).map(|(clear, fast)| clear / fast.median),
        gpu,
    };
    output::result(args.json, &report, &text(&report))
}

/// Seconds a frame of the fast text: of processors, and by the clock.
fn fast_seconds(
    content: &Content,
    args: &ScoreBenchArgs,
) -> anyhow::Result<(Option<Spread>, Spread)> {
    let (mut cpu, mut clock) = (Vec::new(), Vec::new());
    let mut judge = Judge::new(&content.viewing, output::jobs(Some(args.jobs))?)?;
    for turn in 0..=args.runs {
        let begun = Instant::now();
        let spent = seconds_each(args.frames, |n| {
            let ([reference, test], gaze) = content.at(n);
            judge.frame(reference, test, *gaze)?;
            Ok(())
        })?;
        if turn > 0 {
            cpu.extend(spent);
            clock.push(begun.elapsed().as_secs_f64() / args.frames as f64);
        }
    }
    let clock = Spread::of(clock).context("a turn at least")?;
    Ok((Spread::of(cpu), clock))
}

/// Processor seconds that each of `frames` takes.
fn seconds_each(
    frames: usize,
    mut take: impl FnMut(usize) -> anyhow::Result<()>,
) -> anyhow::Result<Option<f64>> {
    let before = cpu_seconds();
    (0..frames).try_for_each(&mut take)?;
    let spent = cpu_seconds().zip(before);
    Ok(spent.map(|(after, before)| (after - before) / frames as f64))
}

/// Processor seconds a frame of the clear text.
fn clear_seconds(content: &Content) -> anyhow::Result<Option<f64>> {
    let mut judge = ClearJudge::new(&content.viewing);
    seconds_each(CLEAR_FRAMES, |n| {
        let ([reference, test], gaze) = content.at(n);
        judge.frame(reference, test, *gaze)?;
        Ok(())
    })
}

/// Processor seconds a frame of all that is reported besides the score.
fn companion_seconds(content: &Content, frames: usize) -> anyhow::Result<Option<f64>> {
    let mut companions = Companions::beside(&content.viewing)?;
    seconds_each(frames, |n| {
        let ([reference, test], gaze) = content.at(n);
        companions.frame(reference, test, *gaze)
    })
}

/// The same on the device, where this machine has one.
fn gpu_row(content: &Content, args: &ScoreBenchArgs) -> anyhow::Result<Option<GpuRow>> {
    let Ok(gpu) = Gpu::open_blocking() else {
        return Ok(None);
    };
    let mut judge = GpuJudge::new(&gpu.device, &gpu.queue, &content.viewing)?;
    let (mut stamped, mut clock) = (Vec::new(), Vec::new());
    let first = Instant::now();
    for n in 0..args.frames + 1 {
        if n > LEAST_GPU_FRAMES && first.elapsed().as_secs_f64() > MOST_GPU_SECONDS {
            break;
        }
        let ([reference, test], gaze) = content.at(n);
        let begun = Instant::now();
        judge.frame(reference, test, *gaze)?;
        if n > 0 {
            clock.push(begun.elapsed().as_secs_f64() * 1e3);
            stamped.extend(judge.gpu_time().map(|time| time.as_secs_f64() * 1e3));
        }
    }
    Ok(Some(GpuRow {
        adapter: gpu.adapter_name().to_owned(),
        stamped_ms: Spread::of(stamped),
        clock_ms: Spread::of(clock).context("a frame at least")?,
    }))
}

fn text(report: &Report) -> String {
    let mut text = report.machine.text();
    let [w, h] = report.size_px;
    text += &format!(
        "\nscoring {w}x{h} at {} Hz, foveated, moving gaze, {}, {}\n",
        report.fps,
        counted(report.frames, "frame"),
        counted(report.jobs, "thread")
    );
    let row = |spread: &Spread, unit: &str| {
        let [least, most] = spread.range;
        format!(
            "{:.3} {unit} a frame ({least:.3} to {most:.3})",
            spread.median
        )
    };
    if let Some(cpu) = &report.cpu_s_per_frame {
        text += &format!("processor time: {}\n", row(cpu, "s"));
    }
    text += &format!("by the clock:   {}\n", row(&report.clock_s_per_frame, "s"));
    if let Some(beside) = report.companions_cpu_s_per_frame {
        text += &format!("its companions: {beside:.3} s more a frame\n");
    }
    if let (Some(clear), Some(ratio)) = (report.clear_cpu_s_per_frame, report.ratio) {
        text += &format!("clear text:     {clear:.3} s a frame, {ratio:.1} times as long\n");
    }
    if let Some(gpu) = &report.gpu {
        let clock = row(&gpu.clock_ms, "ms");
        let stamped = gpu.stamped_ms.as_ref();
        let stamped = stamped.map_or("no time stamps".to_owned(), |spread| row(spread, "ms"));
        text += &format!("{}: {stamped}; by the clock {clock}\n", gpu.adapter);
    }
    text
}
