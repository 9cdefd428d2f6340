//! Does the score agree with the published package on pictures that come from formulas?

use crate::commands::score::{DeviceName, Engine, read_picture};
use crate::report::output::{self, WrongUsage};
use crate::report::picture_file::write_png;
use anyhow::{Context, anyhow, bail};
use clap::Args;
use foveal_eval::score::companion::{Companion, CompanionJudge};
use foveal_eval::score::gaze_trace::GazeTrace;
use foveal_eval::score::golden::Golden;
use foveal_eval::score::picture::Samples;
use foveal_eval::score::{Display, Mode, Score, ScorePicture, Viewing};
use foveal_render::RgbaImage;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug, Args)]
pub(crate) struct GoldensArgs {
    /// Names of cases, as G9 (default: all that there are pictures for).
    cases: Vec<String>,
    /// The photograph that G5 and G6 are about: astronaut of scikit-image.
    #[arg(long, value_name = "FILE.png")]
    photo: Option<PathBuf>,
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
/// How far the PSNR of the photograph may be off, decibels: its published digits.
const PSNR_TOLERANCE_DB: f64 = 0.0006;

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

/// A case, and where its pictures come from.
struct Case<'a> {
    golden: &'static Golden,
    /// Red, green and blue of its reference, if that is a photograph.
    photo: Option<&'a [u8]>,
}

impl Case<'_> {
    fn pictures(&self, frame: u32) -> anyhow::Result<[ScorePicture; 2]> {
        Ok(match self.photo {
            Some(photo) => self.golden.pictures_of(photo.to_vec())?,
            None => self.golden.pictures(frame)?,
        })
    }

    fn viewing(&self) -> anyhow::Result<Viewing> {
        let golden = self.golden;
        let display = Display::named(golden.display).context("a named display")?;
        let foveated = golden.gaze_at(0).is_some();
        Ok(Viewing::new(
            display,
            golden.size,
            golden.fps,
            foveated,
            Mode::Compat,
        )?)
    }
}

pub(super) fn run(args: &GoldensArgs) -> anyhow::Result<()> {
    let photo = args.photo.as_deref().map(read_photo).transpose()?;
    let mut report = Report {
        device: String::new(),
        tolerance_jod: match args.device {
            DeviceName::Cpu => TOLERANCES[0],
            DeviceName::Gpu => TOLERANCES[1],
        },
        worst_jod: 0.0,
        goldens: Vec::new(),
    };
    for case in cases(args, photo.as_deref())? {
        let golden = case.golden;
        let (score, device) = score(&case, args)?;
        let folder = args.write.as_ref().map(|folder| folder.join(golden.id));
        let command = folder.map(|folder| write(&case, &folder)).transpose()?;
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
    if report.worst_jod <= report.tolerance_jod {
        return output::result(args.json, &report, &text(&report));
    }
    let error = anyhow!(
        "a score is off by {:.6} JOD; give another --device, or report this with the machine",
        report.worst_jod
    );
    output::result_that_fails(args.json, &report, &text(&report), error)
}

/// The cases that were named, or else all that there are pictures for.
fn cases<'a>(args: &GoldensArgs, photo: Option<&'a [u8]>) -> anyhow::Result<Vec<Case<'a>>> {
    let drawn = Golden::all().iter().map(|golden| Case {
        golden,
        photo: None,
    });
    let photographed = Golden::of_photograph()
        .iter()
        .map(|golden| Case { golden, photo });
    if args.cases.is_empty() {
        let photographed = photographed.filter(|case| case.photo.is_some());
        return Ok(drawn.chain(photographed).collect());
    }
    let mut all: Vec<Case<'_>> = drawn.chain(photographed).collect();
    all.sort_by_key(|case| (case.golden.id.len(), case.golden.id));
    if let Some(id) = args
        .cases
        .iter()
        .find(|id| all.iter().all(|case| case.golden.id != id.as_str()))
    {
        let ids: Vec<&str> = all.iter().map(|case| case.golden.id).collect();
        bail!(WrongUsage(format!(
            "{id}: no golden; give {}",
            ids.join(", ")
        )));
    }
    all.retain(|case| args.cases.iter().any(|id| id == case.golden.id));
    let needs = |case: &&Case<'_>| is_photographed(case.golden) && case.photo.is_none();
    if let Some(case) = all.iter().find(needs) {
        bail!(WrongUsage(format!(
            "{}: its picture is a photograph; give --photo FILE.png, astronaut of scikit-image",
            case.golden.id
        )));
    }
    Ok(all)
}

fn is_photographed(golden: &Golden) -> bool {
    let mut photographed = Golden::of_photograph().iter();
    photographed.any(|other| other.id == golden.id)
}

/// Red, green and blue of the photograph, which its PSNR identifies.
fn read_photo(path: &Path) -> anyhow::Result<Vec<u8>> {
    let picture = read_picture(path)?;
    let golden = &Golden::of_photograph()[0];
    let other = |what: String| {
        let name = path.display();
        format!("--photo {name}: {what}; give astronaut of scikit-image, 512x512, unchanged")
    };
    let Samples::Bits8(photo) = picture.samples() else {
        bail!(other("has 16 bits a sample".to_owned()));
    };
    if picture.size() != golden.size {
        let [w, h] = picture.size();
        bail!(other(format!("has {w}x{h} pixels")));
    }
    let case = Case {
        golden,
        photo: Some(photo),
    };
    let [reference, test] = case.pictures(0)?;
    let mut judge = CompanionJudge::new(Companion::Psnr, &case.viewing()?)?;
    let found = judge.frame(&reference, &test, [0.0; 2])?;
    if (found - golden.psnr_db).abs() > PSNR_TOLERANCE_DB {
        bail!(other("is another picture".to_owned()));
    }
    Ok(photo.clone())
}

fn score(case: &Case<'_>, args: &GoldensArgs) -> anyhow::Result<(Score, String)> {
    let golden = case.golden;
    let mut engine = Engine::open(args.device, &case.viewing()?, output::jobs(args.jobs)?)?;
    for frame in 0..golden.frames {
        let [reference, test] = case.pictures(frame)?;
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

/// Writes the pictures of a case, and says how to score them.
fn write(case: &Case<'_>, folder: &Path) -> anyhow::Result<String> {
    let golden = case.golden;
    let folders = ["reference", "test"].map(|name| folder.join(name));
    for folder in &folders {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("--write {}: cannot be made", folder.display()))?;
    }
    for frame in 0..golden.frames {
        for (folder, picture) in folders.iter().zip(case.pictures(frame)?) {
            let Samples::Bits8(rgb) = picture.samples() else {
                bail!("{}: is no picture of 8 bits", golden.id);
            };
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
