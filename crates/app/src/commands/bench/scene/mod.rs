//! What does a scene cost, compared with other programs on the same mesh?
//!
//! Each row measures one thing, ours and its baseline in turn in one run.

mod building;
mod bytes;
mod choosing;
mod conditions;
mod degenerate;
mod drawing;
mod fovea;
mod memory;
mod place;
mod points;
mod row;
mod subject;
mod worth;

use crate::commands::demo::machine::Machine;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{self, WrongUsage, out_of_range};
use anyhow::{Context, bail};
use clap::Args;
use conditions::BenchConditions;
use foveal_render::DrawDevice;
use row::BenchRow;
use serde::Serialize;
use std::path::{Path, PathBuf};
use subject::Subject;

#[derive(Clone, Debug, Args)]
pub(crate) struct SceneBenchArgs {
    /// 3D files, or packs of scenes: for these, what takes the source is left out (default: a drawn
    /// torus of 262,144 triangles).
    #[arg(value_name = "FILE|PACK")]
    inputs: Vec<PathBuf>,
    /// Rows to measure, by number or name: closed, bytes, build, decode, choose, triangles,
    /// selection, first-picture, worth, fovea, memory, points, degenerate (default: all, as far as
    /// the scene has what they measure).
    #[arg(long, value_name = "ROW,..", value_delimiter = ',')]
    only: Vec<String>,
    /// Turns of what is timed; 1 to 100.
    #[arg(long, value_name = "N", default_value_t = 3)]
    runs: usize,
    /// Leave out the fovea, which takes some minutes, and what degenerates.
    #[arg(long)]
    fast: bool,
    /// What draws the pictures.
    #[arg(long, value_enum, default_value = "gpu")]
    renderer: RendererName,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What `--fast` leaves out.
const SLOW: [&str; 2] = ["fovea", "degenerate"];

type Measure = fn(&Subject, &BenchConditions) -> anyhow::Result<Vec<BenchRow>>;

/// A row, or a few of one kind.
struct Measured {
    name: &'static str,
    measure: Measure,
    /// Whether pictures are drawn for it.
    draws: bool,
    /// Whether it is about triangles.
    of_triangles: bool,
}

/// All rows; they are numbered from 1.
const ROWS: [Measured; 13] = [
    of_triangles(without_pictures("closed", bytes::closed)),
    of_triangles(without_pictures("bytes", bytes::of_leaves)),
    of_triangles(without_pictures("build", building::build)),
    of_triangles(without_pictures("decode", building::decode)),
    of_triangles(without_pictures("choose", choosing::choose)),
    of_triangles(with_pictures("triangles", drawing::triangles)),
    without_pictures("selection", choosing::select),
    without_pictures("first-picture", bytes::first_picture),
    with_pictures("worth", worth::worth),
    with_pictures("fovea", fovea::bytes_to_fovea),
    with_pictures("memory", memory::memory),
    with_pictures("points", points::points),
    without_pictures("degenerate", degenerate::degenerate),
];

const fn of_triangles(measured: Measured) -> Measured {
    Measured {
        of_triangles: true,
        ..measured
    }
}

const fn without_pictures(name: &'static str, measure: Measure) -> Measured {
    Measured {
        name,
        measure,
        draws: false,
        of_triangles: false,
    }
}

const fn with_pictures(name: &'static str, measure: Measure) -> Measured {
    Measured {
        name,
        measure,
        draws: true,
        of_triangles: false,
    }
}

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    rows: Vec<BenchRow>,
}

pub(super) fn run(args: &SceneBenchArgs) -> anyhow::Result<()> {
    if !(1..=100).contains(&args.runs) {
        bail!(out_of_range("--runs", args.runs, "1 to 100"));
    }
    let asked = args.rows()?;
    let draws = asked.iter().any(|it| it.draws);
    let conditions = BenchConditions {
        runs: args.runs,
        drawing: if draws {
            open_device(args.renderer)?
        } else {
            DrawDevice::Nothing
        },
    };
    let folder = std::env::temp_dir().join(format!("foveal-bench-scene-{}", std::process::id()));
    std::fs::create_dir(&folder)
        .with_context(|| format!("{}: cannot be made", folder.display()))?;
    let measured = args.measure(&asked, &conditions, &folder);
    // What cannot be removed lies where the system cleans up.
    let _ = std::fs::remove_dir_all(&folder);
    let report = Report {
        rows: measured?,
        machine: Machine::here(conditions.drawing.name().to_owned()),
    };
    output::result(args.json, &report, &text(&report))
}

impl SceneBenchArgs {
    /// The rows that are asked for.
    fn rows(&self) -> anyhow::Result<Vec<&'static Measured>> {
        let is = |asked: &String, number: usize| {
            ROWS[number].name == asked || asked.parse() == Ok(number + 1)
        };
        let unknown = |asked: &&String| !(0..ROWS.len()).any(|number| is(asked, number));
        if let Some(asked) = self.only.iter().find(unknown) {
            let names: Vec<&str> = ROWS.iter().map(|it| it.name).collect();
            bail!(WrongUsage(format!(
                "--only {asked}: there is no such row; give 1 to {} or {}",
                ROWS.len(),
                names.join(", ")
            )));
        }
        let is_asked = |number: usize| match self.only.is_empty() {
            true => !(self.fast && SLOW.contains(&ROWS[number].name)),
            false => self.only.iter().any(|asked| is(asked, number)),
        };
        let numbers = (0..ROWS.len()).filter(|number| is_asked(*number));
        Ok(numbers.map(|number| &ROWS[number]).collect())
    }

    fn measure(
        &self,
        asked: &[&Measured],
        conditions: &BenchConditions,
        folder: &Path,
    ) -> anyhow::Result<Vec<BenchRow>> {
        let subjects: Vec<Option<&Path>> = match self.inputs.is_empty() {
            true => vec![None],
            false => self.inputs.iter().map(|it| Some(it.as_path())).collect(),
        };
        let mut rows = Vec::new();
        for (number, input) in subjects.into_iter().enumerate() {
            let subject = Subject::prepare(input, &folder.join(format!("{number}.foveal")))?;
            let has_triangles = subject.leaves() > 0.0;
            for measured in asked.iter().filter(|it| has_triangles || !it.of_triangles) {
                output::say(&format!("{}: {}", subject.name, measured.name));
                rows.extend((measured.measure)(&subject, conditions)?);
            }
        }
        if rows.is_empty() {
            bail!(WrongUsage(
                "--only: none of these rows is about what was given; `points` is about clouds, \
                 `triangles`, `build` and the like about meshes"
                    .to_owned()
            ));
        }
        Ok(rows)
    }
}

fn text(report: &Report) -> String {
    let mut text = report.machine.text() + "\n\n";
    text += &row::table(&report.rows);
    text
}
