//! How does another program's file become a rig file?

use super::rig_args::read_noting;
use crate::report::output::{self, WrongUsage};
use anyhow::Context;
use clap::Args;
use foveal_core::units::counted;
use foveal_scene::rig::{is_foreign, write_rig};
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug, Args)]
pub(crate) struct ImportArgs {
    /// MPCDI, zipped or not, or warp mesh.
    file: PathBuf,
    /// Rig file to write; maps of what is bent lie beside it.
    #[arg(long, value_name = "RIG.toml")]
    out: PathBuf,
    /// Where the eye is that sees the points in space of an MPCDI of profile a3 or sl: metres to
    /// the right of, above and behind their origin (default: there, where that is the ideal eye
    /// point).
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true)]
    eye_at: Option<[f64; 3]>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Reads `X,Y,Z`.
fn parse_place(text: &str) -> anyhow::Result<[f64; 3]> {
    let expected = "expected metres to the right, up and behind, as 0,1.7,2.5";
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|it| it.trim().parse()).collect();
    let found = numbers.ok().and_then(|all| <[f64; 3]>::try_from(all).ok());
    let found = found.filter(|all| all.iter().all(|it| it.abs() <= 1e6));
    found.context(expected)
}

#[derive(Debug, Serialize)]
struct ImportReport {
    panels: usize,
    /// That were written.
    files: Vec<String>,
}

pub(crate) fn run(args: &ImportArgs) -> anyhow::Result<()> {
    let wrong = |what: String| anyhow::Error::from(WrongUsage(what));
    if !is_foreign(&args.file) {
        let name = args.file.display();
        let what = format!("{name}: is no MPCDI or warp mesh by its ending");
        return Err(wrong(format!(
            "{what}; give one that ends in .mpcdi, .xml, .data, .mesh or .txt"
        )));
    }
    let ending = args.out.extension().and_then(|it| it.to_str());
    let stem = args.out.file_stem().and_then(|it| it.to_str());
    let (Some(stem), Some("toml")) = (stem, ending) else {
        let name = args.out.display();
        return Err(wrong(format!(
            "--out {name}: is no name of a rig file; end it in .toml"
        )));
    };
    if args.out.exists() {
        let name = args.out.display();
        return Err(wrong(format!(
            "--out {name}: something is there already; choose another name, or move it away"
        )));
    }
    let rig = read_noting(&args.file, args.eye_at)?;
    let files = write_rig(&rig, stem).map_err(anyhow::Error::msg)?;
    let folder = args.out.parent().unwrap_or(Path::new(""));
    if folder != Path::new("") {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: cannot be made a folder", folder.display()))?;
    }
    let mut names = Vec::new();
    // The rig file last: it names the others.
    for (name, bytes) in files.iter().rev() {
        let path = folder.join(name);
        output::write_whole(&path, bytes)?;
        names.insert(0, path.display().to_string());
    }
    let report = ImportReport {
        panels: rig.panels.len(),
        files: names,
    };
    let mut text = format!("{}\n", counted(report.panels, "panel"));
    for file in &report.files {
        text.push_str(file);
        text.push('\n');
    }
    output::result(args.json, &report, &text)
}
