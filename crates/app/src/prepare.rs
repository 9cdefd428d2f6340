//! How does a person turn a video into a pack?

use crate::codec_options::CodecOptions;
use crate::info::PackInfo;
use crate::options::CutOptions;
use crate::output::{self, WrongUsage, out_of_range};
use crate::preset::SystemPreset;
use anyhow::{anyhow, bail};
use clap::{Args, ValueEnum};
use foveal_core::asset::pack::MAGIC;
use foveal_media::VideoInput;
use foveal_media::encode::Speed;
use foveal_media::pack_file::{PackFile, partial_path};
use foveal_media::prepare::{
    Event, Plan, PrepareError, PrepareSettings, ProjectionChoice, StereoChoice, prepare_resumable,
    rehearse,
};
use serde::Serialize;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProjectionName {
    Auto,
    Flat,
    Equirect,
    HalfEquirect,
    /// Faces in 3x2, 6x1 or 1x6, or in 4x1 without top and bottom.
    Cube,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StereoName {
    Auto,
    Mono,
    /// Side by side.
    Sbs,
    /// Top and bottom.
    Tb,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct PrepareVideoArgs {
    /// Whatever FFmpeg reads.
    input: PathBuf,
    /// The pack to write, with the ending .foveal.
    #[arg(long, value_name = "PACK")]
    out: Option<PathBuf>,
    /// How the picture surrounds the eye; auto goes by metadata, name and size, and says so.
    #[arg(long, value_enum, default_value = "auto")]
    projection: ProjectionName,
    /// Where the pictures of two eyes lie; auto goes by metadata and name, and says so.
    #[arg(long, value_enum, default_value = "auto")]
    stereo: StereoName,
    #[command(flatten)]
    cut: CutOptions,
    /// Cut as a published system does.
    #[arg(long, value_enum, value_name = "NAME")]
    preset: Option<SystemPreset>,
    #[command(flatten)]
    codec: CodecOptions,
    /// Leave the sound out.
    #[arg(long)]
    no_sound: bool,
    /// Twice as fast, larger files.
    #[arg(long, conflicts_with = "small")]
    fast: bool,
    /// Twice as slow, smaller files.
    #[arg(long)]
    small: bool,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Stop after this many frames.
    #[arg(long, value_name = "N")]
    frames: Option<u32>,
    /// Start afresh even if the same preparation was stopped before and could go on.
    #[arg(long)]
    no_resume: bool,
    /// Say what it would take in time and disk, and write nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What a dry run says.
#[derive(Debug, Serialize)]
struct Estimate {
    dry_run: bool,
    frames: Option<u64>,
    seconds: Option<f64>,
    bytes: Option<u64>,
    seconds_per_frame: f64,
    bytes_per_frame: f64,
    notes: Vec<String>,
}

/// Frames that a dry run codes: one group of the finest level.
const REHEARSED: u32 = 8;

pub(crate) fn run(args: &PrepareVideoArgs) -> anyhow::Result<()> {
    let info = VideoInput::open(&args.input)?.info().clone();
    let plan = Plan::new(&args.input, &info, &args.settings()?).map_err(|error| match error {
        PrepareError::Grid(error) => WrongUsage(error.to_string()).into(),
        error => anyhow::Error::from(error),
    })?;
    for note in &plan.notes {
        output::say(&format!("{}: {note}", args.input.display()));
    }
    if args.dry_run {
        return args.estimate(&plan);
    }
    let out = args
        .out
        .as_deref()
        .ok_or_else(|| WrongUsage("--out PACK is missing: where should the pack go?".to_owned()))?;
    refuse_to_overwrite_input(&args.input, out)?;
    refuse_to_overwrite_other_files(out)?;
    if out.extension().is_none_or(|ending| ending != "foveal") {
        output::say(&format!(
            "{}: a pack usually ends in .foveal",
            out.display()
        ));
    }
    let bar = output::bar(plan.frames, output::Counting::Frames);
    let mut has_begun = false;
    let mut tell = |event: Event| match event {
        Event::Begins(note) => output::say(&format!("{}: {note}", out.display())),
        Event::Progress(progress) => {
            has_begun = true;
            bar.set_position(u64::from(progress.frames));
        }
    };
    let begun = Instant::now();
    let prepared = prepare_resumable(&args.input, out, &plan, !args.no_resume, &mut tell);
    bar.finish_and_clear();
    let partial = partial_path(out);
    let prepared = prepared.map_err(|error| match has_begun && partial.exists() {
        true => anyhow!(
            "{}\n{} and its journal keep what is done: the same command goes on there, and \
             with a mended input it starts afresh",
            output::told(&error.into()),
            partial.display()
        ),
        false => error.into(),
    })?;
    for note in prepared.notes {
        output::say(&format!("{}: {note}", args.input.display()));
    }
    let seconds = begun.elapsed().as_secs_f64();
    let info = PackInfo::new(&PackFile::open(out)?)?;
    let text = format!("{}: {seconds:.1} s\n{}", out.display(), info.text());
    output::result(args.json, &info, &text)
}

impl PrepareVideoArgs {
    fn settings(&self) -> anyhow::Result<PrepareSettings> {
        if self.frames == Some(0) {
            bail!(out_of_range("--frames", 0, "at least 1"));
        }
        let given = || self.cut.clone();
        let cut = self
            .preset
            .map_or_else(given, |preset| preset.cut(&self.cut));
        Ok(PrepareSettings {
            projection: match self.projection {
                ProjectionName::Auto => ProjectionChoice::Auto,
                ProjectionName::Flat => ProjectionChoice::Flat,
                ProjectionName::Equirect => ProjectionChoice::Equirect,
                ProjectionName::HalfEquirect => ProjectionChoice::HalfEquirect,
                ProjectionName::Cube => ProjectionChoice::Cube,
            },
            stereo: match self.stereo {
                StereoName::Auto => StereoChoice::Auto,
                StereoName::Mono => StereoChoice::Mono,
                StereoName::Sbs => StereoChoice::SideBySide,
                StereoName::Tb => StereoChoice::TopBottom,
            },
            sound: !self.no_sound,
            cut: cut.asked(),
            levels: cut.levels,
            ratio: cut.ratio(),
            codec: self.codec.codec,
            quality: self.codec.quality()?,
            speed: match (self.fast, self.small) {
                (true, _) => Speed::Fast,
                (_, true) => Speed::Small,
                _ => Speed::Default,
            },
            jobs: output::jobs(self.jobs)?,
            most_frames: self.frames,
        })
    }

    fn estimate(&self, plan: &Plan) -> anyhow::Result<()> {
        let begun = Instant::now();
        let (rehearsed, bytes) = rehearse(&self.input, plan, REHEARSED)?;
        let seconds_per_frame = begun.elapsed().as_secs_f64() / f64::from(rehearsed);
        let bytes_per_frame = bytes as f64 / f64::from(rehearsed);
        let frames = match (plan.frames, self.frames) {
            (Some(known), Some(most)) => Some(known.min(u64::from(most))),
            (known, _) => known,
        };
        let estimate = Estimate {
            dry_run: true,
            frames,
            seconds: frames.map(|frames| frames as f64 * seconds_per_frame),
            bytes: frames.map(|frames| (frames as f64 * bytes_per_frame) as u64),
            seconds_per_frame,
            bytes_per_frame,
            notes: plan.notes.clone(),
        };
        let all = match (estimate.seconds, estimate.bytes) {
            (Some(seconds), Some(bytes)) => {
                format!(
                    "about {seconds:.0} s and {:.1} MB in all",
                    bytes as f64 / 1e6
                )
            }
            _ => "the number of frames is not known".to_owned(),
        };
        let text = format!(
            "{all}; {:.1} ms and {:.1} kB a frame by {rehearsed} frames (nothing written)",
            seconds_per_frame * 1e3,
            bytes_per_frame / 1e3,
        );
        output::result(self.json, &estimate, &text)
    }
}

/// A pack takes the place of a pack, not of anything else.
fn refuse_to_overwrite_other_files(out: &Path) -> anyhow::Result<()> {
    let mut begin = [0; MAGIC.len()];
    let there = std::fs::metadata(out).is_ok_and(|there| there.is_file() && there.len() > 0);
    let mut read = || File::open(out).and_then(|mut file| file.read_exact(&mut begin));
    if there && !(read().is_ok() && begin == MAGIC) {
        bail!(WrongUsage(format!(
            "--out {}: there is a file that is no pack; give another name, or remove it",
            out.display()
        )));
    }
    Ok(())
}

/// Writing the pack over its own source, or growing it there, would destroy the source.
fn refuse_to_overwrite_input(input: &Path, out: &Path) -> anyhow::Result<()> {
    let is_input = |path: &Path| match (input.canonicalize(), path.canonicalize()) {
        (Ok(input), Ok(path)) => input == path,
        _ => false,
    };
    if is_input(out) || is_input(&partial_path(out)) {
        bail!(
            "--out {} is the input itself, or grows where it lies; choose another name",
            out.display()
        );
    }
    Ok(())
}
