//! Does the score agree with the published package on pictures that come from formulas?

use crate::output::{self, WrongUsage};
use crate::picture_file::write_png;
use crate::score::{DeviceName, Engine};
use anyhow::{Context, bail};
use clap::Args;
use foveal_eval::score::gaze_trace::GazeTrace;
use foveal_eval::score::golden::Golden;
use foveal_eval::score::{Display, Mode, Score, Viewing};
use foveal_render::RgbaImage;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug, Args)]
pub(crate) struct GoldensArgs {
    /// Names of cases, as G9 (default: all).
    cases: Vec<String>,
    /// What computes.
    #[arg(long, value_enum, default_value = "cpu")]
    device: DeviceName,
    /// Write the pictures and traces too, and say how to score them.
    #[arg(long, value_name = "DIR")]
    write: Option<PathBuf>,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// How far a score may be off, JOD, on the CPU and on a GPU.
const TOLERANCES: [f64; 2] = [0.0005, 0.005];

#[derive(Debug, Serialize)]
struct Report {
    device: String,
    tolerance_jod: f64,
    worst_jod: f64,
    goldens: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    id: &'static str,
    jod: f64,
    published_jod: f64,
    /// Largest deviation of an energy from the published one, as a share.
    worst_energy: f64,
    /// How to repeat it, where the pictures were written.
    command: Option<String>,
}

pub(super) fn run(args: &GoldensArgs) -> anyhow::Result<()> {
    let goldens: Vec<&Golden> = if args.cases.is_empty() {
        Golden::all().iter().collect()
    } else {
        let named = args.cases.iter().map(|id| named(id));
        named.collect::<anyhow::Result<_>>()?
    };
    let mut report = Report {
        device: String::new(),
        tolerance_jod: match args.device {
            DeviceName::Cpu => TOLERANCES[0],
            DeviceName::Gpu => TOLERANCES[1],
        },
        worst_jod: 0.0,
        goldens: Vec::new(),
    };
    for golden in goldens {
        let (score, device) = score(golden, args)?;
        let folder = args.write.as_ref().map(|folder| folder.join(golden.id));
        let command = folder.map(|folder| write(golden, &folder)).transpose()?;
        report.worst_jod = report.worst_jod.max((score.jod - golden.jod).abs());
        report.device = device;
        report.goldens.push(Row {
            id: golden.id,
            jod: score.jod,
            published_jod: golden.jod,
            worst_energy: worst_energy(golden, &score),
            command,
        });
    }
    output::result(args.json, &report, &text(&report))?;
    if report.worst_jod > report.tolerance_jod {
        bail!("a score is off by {:.6} JOD", report.worst_jod);
    }
    Ok(())
}

fn named(id: &str) -> anyhow::Result<&'static Golden> {
    Golden::named(id).ok_or_else(|| {
        let ids: Vec<&str> = Golden::all().iter().map(|golden| golden.id).collect();
        WrongUsage(format!("{id}: no golden; give {}", ids.join(", "))).into()
    })
}

fn score(golden: &Golden, args: &GoldensArgs) -> anyhow::Result<(Score, String)> {
    let display = Display::named(golden.display).context("a named display")?;
    let foveated = golden.gaze_at(0).is_some();
    let viewing = Viewing::new(display, golden.size, golden.fps, foveated, Mode::Compat)?;
    let mut engine = Engine::open(args.device, &viewing, output::jobs(args.jobs)?)?;
    for frame in 0..golden.frames {
        let [reference, test] = golden.pictures(frame)?;
        engine.frame(&reference, &test, golden.gaze_at(frame).unwrap_or_default())?;
    }
    Ok((engine.score()?, engine.name()))
}

fn worst_energy(golden: &Golden, score: &Score) -> f64 {
    let sustained = score.bands.iter().map(|band| band.sustained);
    let transient = score.bands.iter().map(|band| band.transient);
    let pairs = sustained
        .zip(golden.sustained)
        .chain(transient.zip(golden.transient));
    pairs
        .map(|(found, published)| (found / published - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Writes the pictures of a case, and tells how to score them.
fn write(golden: &Golden, folder: &Path) -> anyhow::Result<String> {
    let folders = ["reference", "test"].map(|name| folder.join(name));
    for folder in &folders {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("--write {}: cannot be made", folder.display()))?;
    }
    for frame in 0..golden.frames {
        for (folder, rgb) in folders.iter().zip(golden.bytes(frame)) {
            let opaque = |rgb: &[u8]| [rgb[0], rgb[1], rgb[2], 255];
            let image = RgbaImage {
                size: golden.size,
                pixels: rgb.chunks_exact(3).flat_map(opaque).collect(),
            };
            write_png(&folder.join(format!("{frame:04}.png")), &image)?;
        }
    }
    let [reference, test] = folders.map(|folder| folder.display().to_string());
    let mut command = format!(
        "foveal score {reference} {test} --display {}",
        golden.display
    );
    if let Some(fps) = golden.fps {
        let _ = write!(command, " --fps {fps}");
    }
    let places = (0..golden.frames).map_while(|frame| golden.gaze_at(frame));
    if let Some(trace) = GazeTrace::of(places) {
        let file = folder.join("gaze.csv");
        output::write_whole(&file, trace.write().as_bytes())?;
        let _ = write!(command, " --gaze-trace {}", file.display());
    }
    Ok(command)
}

fn text(report: &Report) -> String {
    let mut text = format!("on {}\n", report.device);
    text += "case  published       here       off   worst energy\n";
    for row in &report.goldens {
        let off = row.jod - row.published_jod;
        let _ = writeln!(
            text,
            "{:5} {:9.5} {:10.5} {off:+9.5} {:12.5} %",
            row.id,
            row.published_jod,
            row.jod,
            row.worst_energy * 100.0
        );
    }
    for command in report.goldens.iter().filter_map(|row| row.command.as_ref()) {
        let _ = writeln!(text, "{command}");
    }
    text
}
