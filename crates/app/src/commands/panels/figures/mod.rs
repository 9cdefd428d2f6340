//! What does a rig look like, where does its source lie, and what does each pixel take of it?

mod drawings;
mod drawn_rig;
mod legend;
mod maps;
mod svg;

use super::rig_args::{RigArgs, source_size};
use crate::report::output;
use crate::report::picture_file::write_png;
use anyhow::Context;
use clap::Args;
use drawn_rig::DrawnRig;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
pub(crate) struct FiguresArgs {
    #[command(flatten)]
    rig: RigArgs,
    /// Size of the source as 1600x1200, or a picture or video that has it; as needed if not given.
    #[arg(long, value_name = "WxH|FILE")]
    source: Option<String>,
    /// Folder for the figures.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct FiguresReport {
    placement: &'static str,
    /// That were written.
    files: Vec<String>,
}

pub(crate) fn run(args: &FiguresArgs) -> anyhow::Result<()> {
    let source = source_size(args.source.as_deref())?;
    let rig = args.rig.read()?;
    let panels = args.rig.panels(&rig);
    let found = args.rig.fit(&rig, &panels, source)?;
    let drawn = DrawnRig {
        panels: &panels,
        found: &found,
    };
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("{}: cannot be made a folder", args.out.display()))?;
    let mut files = Vec::new();
    let mut told = |name: &str| {
        let path = args.out.join(name);
        files.push(path.display().to_string());
        path
    };
    for (name, svg) in [
        ("panels.svg", drawings::panels(&drawn)),
        ("above.svg", drawings::above(&drawn)),
        ("source.svg", drawings::source(&drawn)),
        ("lines.svg", drawings::lines(&drawn)),
    ] {
        output::write_out(&told(name), svg.as_bytes())?;
    }
    for (name, picture) in [
        ("grid.png", maps::grid(&drawn)),
        ("magnification.png", maps::magnification(&drawn)),
        ("probes.png", maps::probes(&drawn)),
        ("filters.png", maps::filters(&drawn)),
    ] {
        write_png(&told(name), &picture)?;
    }
    let report = FiguresReport {
        placement: found.name,
        files,
    };
    let mut text = format!("source: {}\n", report.placement);
    for file in &report.files {
        text.push_str(file);
        text.push('\n');
    }
    output::result(args.json, &report, &text)
}
