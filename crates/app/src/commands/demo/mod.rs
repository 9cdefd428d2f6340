//! What does Foveal save on a clip, and how does that look?
//!
//! Every content is prepared, played headless under `full`, `viewport` and `perceptual` over one
//! gaze, and shown in one page: pictures of a moment, plots over time, and a table of the same run.

mod atlas_sheet;
mod colours;
mod content;
mod facts;
mod figures;
pub(crate) mod machine;
mod moment;
mod pictures;
mod plots;
mod report;
mod run;
mod setup;

use crate::options::policy::ViewOptions;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output;
use anyhow::{Context, bail};
use clap::Args;
use figures::PolicyFigures;
use machine::Machine;
use run::{Played, play};
use serde::Serialize;
use setup::DemoConditions;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Bytes that the pictures of a report may have together, before they are written as text.
const PICTURE_BYTES: usize = 8_400_000;

#[derive(Clone, Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder for report.html, packs, session logs and figures; made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A video or a picture to play, flat or 360°; may be given again (default: a generated one).
    #[arg(long, value_name = "FILE")]
    input: Vec<PathBuf>,
    #[command(flatten)]
    view: ViewOptions,
    /// What draws the pictures.
    #[arg(long, value_enum, default_value = "gpu")]
    renderer: RendererName,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What the demo prints.
#[derive(Serialize)]
struct Summary<'a> {
    report: &'a Path,
    /// The command that serves the packs to a browser.
    serve: &'a str,
    machine: &'a Machine,
    contents: BTreeMap<&'a str, BTreeMap<&'a str, PolicyFigures<'a>>>,
}

pub(crate) fn run(args: &DemoArgs) -> anyhow::Result<()> {
    if args.renderer == RendererName::None {
        bail!("--renderer none draws no pictures for the report; give gpu or cpu");
    }
    let contents = content::contents(&args.input, &args.out)?;
    contents.iter().try_for_each(content::DemoContent::check)?;
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("--out {}: the folder cannot be made", args.out.display()))?;
    let drawing = open_device(args.renderer)?;
    let conditions = DemoConditions {
        view: &args.view,
        drawing: &drawing,
        seed: args.seed,
    };
    let budget = PICTURE_BYTES / contents.len();
    let mut played = Vec::new();
    for content in &contents {
        let prepared = content.prepare(&args.out)?;
        played.push(play(prepared, &conditions, &args.out, budget)?);
    }
    let machine = Machine::here(drawing.name().to_owned());
    let report = args.out.join("report.html");
    output::write_whole(
        &report,
        report::page(&played, &machine, args.seed).as_bytes(),
    )?;
    let serve = serve_command(&played);
    let summary = Summary {
        report: &report,
        serve: &serve,
        machine: &machine,
        contents: played.iter().map(by_policy).collect(),
    };
    let text = text(&played, &machine, &report);
    let text = format!("{text}\nin a browser: {serve}");
    output::result(args.json, &summary, &text)
}

fn by_policy(played: &Played) -> (&str, BTreeMap<&str, PolicyFigures<'_>>) {
    let runs = &played.runs;
    let figures = |index: usize| {
        let policy = runs[index].summary.policy.as_str();
        (policy, figures::figures(runs, index))
    };
    let all = (0..runs.len()).map(figures).collect();
    (&played.content.name, all)
}

/// How a user of this program serves what was prepared.
fn serve_command(played: &[Played]) -> String {
    let program = std::env::args().next().unwrap_or_default();
    let packs = played.iter().map(|one| one.content.file.path().display());
    let packs: Vec<String> = packs.map(|pack| format!("{pack}")).collect();
    format!("{program} serve {}", packs.join(" "))
}

fn text(played: &[Played], machine: &Machine, report: &Path) -> String {
    let mut text = machine.text();
    for one in played {
        let frames = figures::frames(&one.runs);
        text += &format!("\n\n{}, {frames}\n", one.content.name);
        text += figures::text(&one.runs).trim_end();
    }
    text + &format!("\n\n{}", report.display())
}
