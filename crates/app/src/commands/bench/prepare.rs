//! How fast does a video become a pack, and how large is it compared with a slow encoder's file?

use crate::commands::bench::equal_quality::{SizeRow, sizes_at_equal_quality};
use crate::commands::bench::processor_time::cpu_seconds;
use crate::commands::demo::machine::Machine;
use crate::report::output;
use anyhow::Context;
use clap::{Args, ValueEnum};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::units::counted;
use foveal_core::view::picture::{Colour, Matrix};
use foveal_media::generate::{FRAMES_PER_SECOND, GeneratedScene};
use foveal_media::prepare::{PreparationPlan, PrepareSettings, ProjectionChoice, prepare};
use foveal_media::tiles::encode_settings::Speed;
use foveal_media::{ClipCodec, ClipFormat, ClipWriter, VideoInput};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is prepared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Generated {
    /// 7680x4320, flat.
    #[value(name = "wide-8k")]
    Wide8k,
    /// 7680x3840, equirectangular.
    #[value(name = "panorama-8k")]
    Panorama8k,
    /// 1920x1080, flat.
    #[value(name = "wide-2k")]
    Wide2k,
    /// 2048x1024, equirectangular.
    #[value(name = "panorama-2k")]
    Panorama2k,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct PrepareBenchArgs {
    /// A generated clip, by turns until all given ones are done.
    #[arg(long, value_enum, value_name = "NAME", default_values = ["wide-8k", "panorama-8k"])]
    generate: Vec<Generated>,
    /// A video file instead of generated clips.
    #[arg(long, value_name = "FILE", conflicts_with = "generate")]
    input: Option<PathBuf>,
    /// Frames of each clip.
    #[arg(long, value_name = "N", default_value_t = 16)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=600))]
    frames: u32,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// One way of preparing, by its name.
type Way = (&'static str, Codec, Speed);

const WAYS: [Way; 4] = [
    ("default", Codec::Vp9, Speed::Default),
    ("--fast", Codec::Vp9, Speed::Fast),
    ("--small", Codec::Vp9, Speed::Small),
    ("--codec jpeg", Codec::Jpeg, Speed::Default),
];

#[derive(Debug, Serialize)]
struct SpeedRow {
    content: String,
    way: &'static str,
    jobs: usize,
    /// Millions of pixels of the source a second, reading and writing included.
    prepare_mpix_per_s: f64,
    /// The same by the processor time of all threads; null where the system does not report it.
    prepare_mpix_per_cpu_s: Option<f64>,
    prepare_s: f64,
    prepare_cpu_s: Option<f64>,
    bytes: u64,
}

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    speed: Vec<SpeedRow>,
    sizes: Vec<SizeRow>,
}

pub(super) fn run(args: &PrepareBenchArgs) -> anyhow::Result<()> {
    let jobs = output::jobs(args.jobs)?;
    let folder = std::env::temp_dir().join(format!("foveal-bench-{}", std::process::id()));
    std::fs::create_dir(&folder)
        .with_context(|| format!("{}: cannot be made", folder.display()))?;
    let measured = measure(args, jobs, &folder);
    // What cannot be removed lies where the system cleans up.
    let _ = std::fs::remove_dir_all(&folder);
    let (speed, sizes) = measured?;
    let report = Report {
        machine: Machine::here("none".to_owned()),
        speed,
        sizes,
    };
    output::result(args.json, &report, &text(&report))
}

type Rows = (Vec<SpeedRow>, Vec<SizeRow>);

fn measure(args: &PrepareBenchArgs, jobs: usize, folder: &Path) -> anyhow::Result<Rows> {
    let (mut speed, mut sizes) = (Vec::new(), Vec::new());
    let clips: Vec<(String, PathBuf, ProjectionChoice)> = match &args.input {
        Some(file) => {
            // Reports are passed on, folders are nobody's business.
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            vec![(name.into_owned(), file.clone(), ProjectionChoice::Auto)]
        }
        None => {
            let write = |generated| write_clip(generated, args.frames, folder);
            args.generate
                .iter()
                .map(|g| write(*g))
                .collect::<anyhow::Result<_>>()?
        }
    };
    for (name, clip, projection) in clips {
        let settings_of = |way: Way| PrepareSettings {
            projection,
            codec: way.1,
            speed: way.2,
            jobs,
            most_frames: Some(args.frames),
            ..PrepareSettings::default()
        };
        // A clip is short compared with a video: what it takes to get memory from the system for
        // the first time is not timed.
        time_one(&name, &clip, &settings_of(WAYS[0]), WAYS[0].0, folder)?;
        for way in WAYS {
            let settings = settings_of(way);
            let row = time_one(&name, &clip, &settings, way.0, folder)?;
            output::say(&format!(
                "{name}, {}: {:.1} MPix/s",
                way.0, row.prepare_mpix_per_s
            ));
            speed.push(row);
        }
        output::say(&format!("{name}: sizes at equal quality"));
        sizes.extend(sizes_at_equal_quality(&name, &clip)?);
    }
    Ok((speed, sizes))
}

fn time_one(
    content: &str,
    clip: &Path,
    settings: &PrepareSettings,
    way: &'static str,
    folder: &Path,
) -> anyhow::Result<SpeedRow> {
    let info = VideoInput::open(clip)?.info().clone();
    let plan = PreparationPlan::new(clip, &info, settings)?;
    let out = folder.join("bench.foveal");
    let (begun, cpu_before) = (Instant::now(), cpu_seconds());
    let prepared = prepare(clip, &out, &plan, &mut |_| {})?;
    let (about, bytes) = (&prepared.description, prepared.bytes);
    let prepare_s = begun.elapsed().as_secs_f64();
    let prepare_cpu_s = cpu_seconds()
        .zip(cpu_before)
        .map(|(after, before)| after - before);
    let [w, h] = about.source.size.map(f64::from);
    let mpix = w * h * f64::from(about.frames) / 1e6;
    Ok(SpeedRow {
        content: content.to_owned(),
        way,
        jobs: settings.jobs,
        prepare_mpix_per_s: mpix / prepare_s,
        prepare_mpix_per_cpu_s: prepare_cpu_s.map(|cpu| mpix / cpu),
        prepare_s,
        prepare_cpu_s,
        bytes,
    })
}

/// Draws a clip into a file that reads fast.
fn write_clip(
    generated: Generated,
    frames: u32,
    folder: &Path,
) -> anyhow::Result<(String, PathBuf, ProjectionChoice)> {
    let (size, is_flat) = match generated {
        Generated::Wide8k => ([7680, 4320], true),
        Generated::Panorama8k => ([7680, 3840], false),
        Generated::Wide2k => ([1920, 1080], true),
        Generated::Panorama2k => ([2048, 1024], false),
    };
    let (scene, projection) = if is_flat {
        (GeneratedScene::wide(size), ProjectionChoice::Flat)
    } else {
        (GeneratedScene::panorama(size), ProjectionChoice::Equirect)
    };
    let name = generated
        .to_possible_value()
        .map_or(String::new(), |value| value.get_name().to_owned());
    let path = folder.join(format!("{name}.mkv"));
    let mut clip = ClipWriter::create(
        &path,
        &ClipFormat {
            codec: ClipCodec::H264(SOURCE_QUANTISER),
            size,
            frame_rate: [FRAMES_PER_SECOND as i32, 1],
            colour: Colour {
                matrix: Matrix::Bt709,
                full_range: false,
                chroma_left: false,
            },
        },
    )?;
    let bar = output::bar(Some(u64::from(frames)), output::Counting::Frames);
    for number in 0..u64::from(frames) {
        clip.push(&scene.frame(number))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    clip.finish()?;
    Ok((name, path, projection))
}

/// Quantiser of generated sources: visually lossless, as a camera's.
const SOURCE_QUANTISER: u8 = 18;

fn text(report: &Report) -> String {
    let mut text = report.machine.text();
    let _ = writeln!(
        text,
        "\nMPix/s of the source, by the clock and by processor time:"
    );
    for row in &report.speed {
        let cpu = row
            .prepare_mpix_per_cpu_s
            .map_or("-".to_owned(), |cpu| format!("{cpu:.1}"));
        let _ = writeln!(
            text,
            "{:14} {:14} {:6.1} {cpu:>6}   {:.1} MB, {}",
            row.content,
            row.way,
            row.prepare_mpix_per_s,
            row.bytes as f64 / 1e6,
            counted(row.jobs, "thread"),
        );
    }
    let _ = writeln!(text, "\nbytes at equal PSNR over libvpx good, cpu-used 4:");
    for row in &report.sizes {
        let _ = writeln!(
            text,
            "{:14} {:14} {} px: {:.2} at {:.1} dB",
            row.content, row.way, row.tile, row.bytes_over_reference, row.psnr_db
        );
    }
    text
}
