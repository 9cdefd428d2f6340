//! What does Foveal save on films, spheres, scans and panels, and how does that look?
//!
//! Every content is prepared, played headless over one gaze, and shown as a part of one page:
//! cards, pictures of a moment, a plot over time, and a table of the same run.

mod clip;
pub(crate) mod machine;
mod mesh;
mod page;
mod panels;
mod scene;
mod sphere;
mod subjects;
mod video;

use crate::commands::prepare::video::CalibrateName;
use crate::options::policy::ViewOptions;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{self, WrongUsage};
use anyhow::{Context, bail};
use clap::Args;
use machine::Machine;
use mesh::SceneFigures;
use page::part::ReportPart;
use page::report;
use scene::watched::watch;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use subjects::{DemoSubject, subjects};
use video::content::Prepared;
use video::figures::{self, PolicyFigures};
use video::run::play;
use video::setup::{DemoConditions, PlaySetup};

/// Bytes that the pictures of one part may have together, before they are written as text.
const PICTURE_BYTES: usize = 2_600_000;

#[derive(Clone, Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder for report.html, packs, session logs and figures; made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A film, a photo, a mesh or a cloud in place of what the demo draws; may be given again.
    #[arg(long, value_name = "FILE")]
    input: Vec<PathBuf>,
    /// The clip of the first part (default: a generated one).
    #[arg(long, value_name = "FILE", conflicts_with = "input")]
    clip: Option<PathBuf>,
    /// The rig whose left panels show spheres (default: one of twelve).
    #[arg(long, value_name = "RIG")]
    panels: Option<PathBuf>,
    /// Judge films and pictures once more for what auto chooses by, as prepare does: about 20 s
    /// each.
    #[arg(long, value_enum, default_value = "usual")]
    calibrate: CalibrateName,
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

/// Figures by content and policy.
type Figures<F> = BTreeMap<String, BTreeMap<&'static str, F>>;

/// What the demo prints.
#[derive(Serialize)]
struct Summary<'a> {
    report: &'a Path,
    /// The command that serves the packs to a browser.
    serve: &'a str,
    machine: &'a Machine,
    contents: Figures<PolicyFigures>,
    panels: Figures<PolicyFigures>,
    scenes: Figures<SceneFigures>,
}

/// What was shown so far.
#[derive(Default)]
struct Shown {
    parts: Vec<ReportPart>,
    packs: Vec<PathBuf>,
    contents: Figures<PolicyFigures>,
    panels: Figures<PolicyFigures>,
    scenes: Figures<SceneFigures>,
}

pub(crate) fn run(args: &DemoArgs) -> anyhow::Result<()> {
    if args.renderer == RendererName::None {
        bail!(WrongUsage(
            "--renderer none draws no pictures for the report; give gpu or cpu".to_owned()
        ));
    }
    let subjects = subjects(&args.input, args.clip.as_deref(), &args.out)?;
    subjects.iter().try_for_each(DemoSubject::check)?;
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("--out {}: the folder cannot be made", args.out.display()))?;
    let drawing = open_device(args.renderer)?;
    let conditions = DemoConditions {
        view: &args.view,
        drawing: &drawing,
        seed: args.seed,
    };
    let (mut shown, mut spheres) = (Shown::default(), Vec::new());
    for subject in &subjects {
        let begun = Instant::now();
        match subject {
            DemoSubject::Video(video) => {
                let content = video.prepare(&args.out, args.calibrate.extent())?;
                args.video(&content, &conditions, (&mut shown, begun))?;
                let about = content.file.pack().description();
                if about.projection.surrounds() {
                    spheres.push(content);
                }
            }
            DemoSubject::Scene(scene) => {
                let scene = scene.prepare(&args.out)?;
                let runs = watch(&scene, &drawing, args.view.view)?;
                mesh::write_logs(&scene, &runs, &args.out)?;
                shown.add(mesh::part(&scene, &runs), begun);
                shown.packs.push(scene.file.path().to_owned());
                let name = scene.content.name.clone();
                shown.scenes.insert(name, mesh::by_policy(&runs));
            }
        }
    }
    for sphere in &spheres {
        args.on_panels(sphere, &conditions, &mut shown)?;
    }
    args.finish(shown, &Machine::here(drawing.name().to_owned()))
}

impl DemoArgs {
    /// Plays a film or a picture in one view.
    fn video(
        &self,
        content: &Prepared,
        conditions: &DemoConditions<'_>,
        (shown, begun): (&mut Shown, Instant),
    ) -> anyhow::Result<()> {
        let setup = PlaySetup::new(content, conditions, Vec::new())?;
        let played = play(&setup, (&self.out, &content.name), PICTURE_BYTES)?;
        let about = content.file.pack().description();
        let part = match about.projection.surrounds() {
            true => sphere::part(&setup, &played),
            false => clip::part(&setup, &played),
        };
        shown.add(part, begun);
        shown.packs.push(content.file.path().to_owned());
        let figures = figures::by_policy(played);
        shown.contents.insert(content.name.clone(), figures);
        Ok(())
    }

    /// Plays a sphere on panels.
    fn on_panels(
        &self,
        content: &Prepared,
        conditions: &DemoConditions<'_>,
        shown: &mut Shown,
    ) -> anyhow::Result<()> {
        let begun = Instant::now();
        let panels = panels::panels(self.panels.as_deref(), &self.out)?;
        let setup = PlaySetup::new(content, conditions, panels)?;
        let name = format!("{}-panels", content.name);
        let played = play(&setup, (&self.out, &name), PICTURE_BYTES)?;
        shown.add(panels::part(&setup, &played)?, begun);
        let figures = figures::by_policy(played);
        shown.panels.insert(content.name.clone(), figures);
        Ok(())
    }

    /// Writes the page and says what it shows.
    fn finish(&self, shown: Shown, machine: &Machine) -> anyhow::Result<()> {
        let report = self.out.join("report.html");
        let page = report::page(&shown.parts, machine, self.seed);
        output::write_whole(&report, page.as_bytes())?;
        let serve = serve_command(&shown.packs);
        let mut text = machine.text();
        for part in &shown.parts {
            text += &format!("\n\n{}", part.text().trim_end());
        }
        let text = format!("{text}\n\n{}\nin a browser: {serve}", report.display());
        let summary = Summary {
            report: &report,
            serve: &serve,
            machine,
            contents: shown.contents,
            panels: shown.panels,
            scenes: shown.scenes,
        };
        output::result(self.json, &summary, &text)
    }
}

impl Shown {
    /// Adds a part that was begun at a time.
    fn add(&mut self, part: ReportPart, begun: Instant) {
        self.parts.push(ReportPart {
            took_s: begun.elapsed().as_secs_f64(),
            ..part
        });
    }
}

/// How a user of this program serves what was prepared.
fn serve_command(packs: &[PathBuf]) -> String {
    let program = std::env::args().next().unwrap_or_default();
    let packs: Vec<String> = packs.iter().map(|it| it.display().to_string()).collect();
    format!("{program} serve {}", packs.join(" "))
}
