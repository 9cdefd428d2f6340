//! How fast does foveated video play, against playing it whole?
//!
//! One pack, one pool of decoders, one gaze: `acuity`, `viewport` and `full` take turns in one run,
//! with the original file's own decoder beside them.

mod content;

use crate::commands::demo::machine::Machine;
use crate::options::decoding::{DecodingOptions, DeviceReport};
use crate::options::policy::{TargetChoice, parse_target, policy_parser};
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{self, WrongUsage, out_of_range};
use crate::run::timed::{Conditions, Run};
use anyhow::bail;
use clap::Args;
use content::{Generated, PackAndOriginal, WALL, cache};
use foveal_core::content::asked::SLOPES;
use foveal_core::content::policy::{DEFAULT_TARGET, Policy, PolicyConfig};
use foveal_core::perception::acuity::AcuityModel;
use foveal_core::units::counted;
use foveal_core::view::surface::Screen;
use foveal_media::VideoInput;
use foveal_media::pack::pack_file::PackFile;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

#[derive(Clone, Debug, Args)]
pub(crate) struct VideoArgs {
    /// The pack to play.
    #[arg(conflicts_with = "generate")]
    pack: Option<PathBuf>,
    /// Play a drawn clip instead, made on first use and kept.
    #[arg(long, value_enum)]
    generate: Option<Generated>,
    /// The file that the pack was made from, to be decoded beside it.
    #[arg(long, value_name = "FILE", requires = "pack")]
    original: Option<PathBuf>,
    /// Where drawn clips are kept (default: the user's folder for caches).
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// How the foveated frames are chosen: acuity or perceptual.
    #[arg(long, value_parser = policy_parser(), default_value = "acuity")]
    policy: Policy,
    /// The score in JOD that they are chosen for, 1 to 9.99, or none (default: 9.5).
    #[arg(long, value_name = "JOD|none", value_parser = parse_target)]
    #[arg(allow_hyphen_values = true, conflicts_with = "slope")]
    target: Option<TargetChoice>,
    /// acuity: degrees a degree by which the smallest pixel grows, in place of a target.
    #[arg(long, value_name = "SLOPE", allow_negative_numbers = true)]
    slope: Option<f64>,
    /// Foveated frames to play; 10 to 100000.
    #[arg(long, value_name = "N", default_value_t = 600)]
    frames: u32,
    /// What draws the pictures.
    #[arg(long, value_enum, default_value = "gpu")]
    renderer: RendererName,
    #[command(flatten)]
    decoding: DecodingOptions,
    /// Seed of the gaze.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Turns that every policy takes.
const TURNS: u32 = 10;
/// Of a turn's foveated frames, those that the setting of before, `viewport` and `full` play too:
/// the latter are slower.
const SHARE_OF_BEFORE: u32 = 2;
const SHARE_OF_VIEWPORT: u32 = 10;
const SHARE_OF_FULL: u32 = 20;
/// Frames of the original that are decoded, at most.
const ORIGINAL_FRAMES: u32 = 24;

/// Frames a second: the median of all turns, the slowest and the fastest.
#[derive(Clone, Copy, Debug, Serialize)]
struct Rate {
    median: f64,
    range: [f64; 2],
}

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    pack: String,
    size_px: [u32; 2],
    frames: u32,
    turns: u32,
    jobs: usize,
    /// Where the foveated frames were decoded.
    decoded_on: DeviceReport,
    /// Choosing and decoding, frames a second.
    foveated_fps: f64,
    viewport_fps: f64,
    full_fps: f64,
    original_fps: Option<f64>,
    /// `foveated_fps` over the others.
    ratio: f64,
    ratio_viewport: f64,
    ratio_original: Option<f64>,
    foveated: Rates,
    viewport: Rates,
    full: Rates,
    policy: &'static str,
    target: Option<f64>,
    slope: Option<f64>,
    /// Of the first frames against every finest tile, in JOD; null where nothing draws.
    score: Option<f64>,
    /// As versions chose that knew no score: acuity at a slope of 0.022, in the same run.
    before: Before,
    /// Foveated frames whose time was over before they could be shown.
    late_frames: u32,
    /// Foveated frames shown with a coarser tile in the place of one that was chosen.
    incomplete_frames: u32,
    frames_to_fovea_p95: u32,
    pixels_share_mean: f64,
    gpu_bytes: u64,
    /// Of the whole finest level as 8-bit 4:2:0.
    gpu_share: f64,
}

/// Figures of another setting beside the foveated ones.
#[derive(Clone, Copy, Debug, Serialize)]
struct Before {
    slope: f64,
    foveated_fps: f64,
    ratio: f64,
    pixels_share_mean: f64,
    gpu_bytes: u64,
    score: Option<f64>,
}

/// The slope that levels were chosen by before there was a target, in degrees a degree.
const SLOPE_BEFORE: f64 = 0.022;

/// What one policy reached.
#[derive(Clone, Copy, Debug, Serialize)]
struct Rates {
    decode_fps: Rate,
    /// Choosing, decoding, uploading and drawing.
    end_to_end_fps: Rate,
    /// Choosing alone, the median of all frames.
    choose_ms: f64,
}

pub(super) fn run(args: &VideoArgs) -> anyhow::Result<()> {
    if !(10..=100_000).contains(&args.frames) {
        bail!(out_of_range("--frames", args.frames, "10 to 100000"));
    }
    let config = args.config()?;
    let drawing = open_device(args.renderer)?;
    let content = args.content()?;
    let bench = Bench {
        config,
        conditions: Conditions {
            file: Arc::new(PackFile::open(&content.pack)?),
            drawing: &drawing,
            screen: args.generate.map_or_else(Screen::default, |_| WALL),
            decoding: args.decoding.decoding()?,
            seed: args.seed,
        },
    };
    let original = content.original.as_deref().map(original_fps).transpose()?;
    let runs = bench.play(args.frames)?;
    let report = bench.report(args.frames, original, runs)?;
    output::result(args.json, &report, &report.text())
}

impl VideoArgs {
    /// How the foveated frames are chosen.
    fn config(&self) -> anyhow::Result<PolicyConfig> {
        let policy = match self.policy {
            Policy::Acuity => Policy::Acuity,
            Policy::Perceptual if self.slope.is_none() => Policy::Perceptual,
            Policy::Perceptual => bail!(WrongUsage(
                "--slope is for --policy acuity; leave one of them out".to_owned()
            )),
            other => bail!(out_of_range(
                "--policy",
                other.name(),
                "acuity or perceptual"
            )),
        };
        let slope = self.slope.unwrap_or(SLOPE_BEFORE);
        if !SLOPES.contains(&slope) {
            bail!(out_of_range("--slope", slope, "0 to 1 degree a degree"));
        }
        let target = match (self.target, self.slope) {
            (Some(TargetChoice::Jod(jod)), _) => Some(jod),
            (Some(TargetChoice::None), _) | (None, Some(_)) => None,
            (None, None) => Some(DEFAULT_TARGET),
        };
        Ok(PolicyConfig {
            acuity: AcuityModel::linear(slope),
            target,
            ..PolicyConfig::new(policy)
        })
    }

    fn content(&self) -> anyhow::Result<PackAndOriginal> {
        match (&self.pack, self.generate) {
            (Some(pack), _) => Ok(PackAndOriginal {
                pack: pack.clone(),
                original: self.original.clone(),
            }),
            (None, Some(generated)) => generated.prepare(&cache(self.cache.as_deref())?),
            (None, None) => bail!(WrongUsage(
                "give a PACK, or --generate panorama-16k|wide-8k|wide-16k".to_owned()
            )),
        }
    }
}

/// What is compared.
struct Bench<'a> {
    /// How the foveated frames are chosen.
    config: PolicyConfig,
    conditions: Conditions<'a>,
}

/// What takes turns.
struct Runs {
    foveated: Run,
    before: Run,
    viewport: Run,
    full: Run,
}

impl Bench<'_> {
    fn run(&self, policy: Policy) -> anyhow::Result<Run> {
        // Nobody sees the baselines, which must decode whatever they take.
        self.conditions.run(PolicyConfig::new(policy), false)
    }

    fn before() -> PolicyConfig {
        PolicyConfig {
            acuity: AcuityModel::linear(SLOPE_BEFORE),
            ..PolicyConfig::new(Policy::Acuity)
        }
    }

    /// All policies take turns, so that other work on the machine touches all alike.
    fn play(&self, frames: u32) -> anyhow::Result<Runs> {
        let mut runs = Runs {
            foveated: self.conditions.run(self.config.clone(), true)?,
            before: self.conditions.run(Self::before(), true)?,
            viewport: self.run(Policy::Viewport)?,
            full: self.run(Policy::Full)?,
        };
        let turn = frames.div_ceil(TURNS);
        let bar = output::bar(Some(u64::from(frames)), output::Counting::Frames);
        for _ in 0..TURNS {
            runs.foveated.turn(turn)?;
            runs.before.turn(turn.div_ceil(SHARE_OF_BEFORE))?;
            runs.viewport.turn(turn.div_ceil(SHARE_OF_VIEWPORT))?;
            runs.full.turn(turn.div_ceil(SHARE_OF_FULL))?;
            bar.inc(u64::from(turn));
        }
        bar.finish_and_clear();
        Ok(runs)
    }

    fn report(&self, frames: u32, original_fps: Option<f64>, runs: Runs) -> anyhow::Result<Report> {
        let Runs {
            mut foveated,
            mut before,
            viewport,
            full,
        } = runs;
        let gpu_bytes = foveated.gpu_bytes();
        foveated.to_fovea.sort_unstable();
        let p95 = (foveated.to_fovea.len() * 95).div_ceil(100).max(1) - 1;
        let conditions = &self.conditions;
        let about = conditions.file.pack().description();
        let pixels = about.grid(conditions.screen).surface.pixels();
        let ratio_of = |run: &Run, other: &Run| {
            let pairs = run.decoding.iter().zip(&other.decoding);
            Rate::of(&pairs.map(|(a, b)| a / b).collect::<Vec<f64>>()).median
        };
        let ratio_to = |other: &Run| ratio_of(&foveated, other);
        let fps = |run: &Run| Rate::of(&run.decoding).median;
        let before = Before {
            slope: SLOPE_BEFORE,
            foveated_fps: fps(&before),
            ratio: ratio_of(&before, &full),
            pixels_share_mean: before.share(),
            gpu_bytes: before.gpu_bytes(),
            score: conditions.score(&Self::before())?,
        };
        Ok(Report {
            policy: self.config.policy.name(),
            target: self.config.target,
            slope: match self.config.acuity {
                AcuityModel::Linear { slope, .. } if self.config.target.is_none() => Some(slope),
                _ => None,
            },
            score: conditions.score(&self.config)?,
            before,
            machine: Machine::here(conditions.drawing.name().to_owned()),
            pack: name_of(conditions.file.path()),
            size_px: about.source.size,
            frames: frames.div_ceil(TURNS) * TURNS,
            turns: TURNS,
            jobs: conditions.decoding.jobs,
            decoded_on: DeviceReport::new(foveated.device_use()),
            foveated_fps: fps(&foveated),
            viewport_fps: fps(&viewport),
            full_fps: fps(&full),
            original_fps,
            ratio: ratio_to(&full),
            ratio_viewport: ratio_to(&viewport),
            ratio_original: original_fps.map(|original| fps(&foveated) / original),
            late_frames: foveated.late,
            incomplete_frames: foveated.incomplete,
            frames_to_fovea_p95: foveated.to_fovea.get(p95).copied().unwrap_or_default(),
            pixels_share_mean: foveated.share(),
            gpu_bytes,
            gpu_share: gpu_bytes as f64 / (pixels as f64 * 1.5),
            foveated: Rates::of(&foveated),
            viewport: Rates::of(&viewport),
            full: Rates::of(&full),
        })
    }
}

/// Reports are passed on, folders are nobody's business.
fn name_of(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Frames a second that the original file's own decoder gives, on all cores.
fn original_fps(path: &Path) -> anyhow::Result<f64> {
    let mut video = VideoInput::open(path)?;
    let begun = Instant::now();
    let mut frames = 0;
    while frames < ORIGINAL_FRAMES && video.next_frame()?.is_some() {
        frames += 1;
    }
    Ok(f64::from(frames) / begun.elapsed().as_secs_f64())
}

impl Rate {
    fn of(rates: &[f64]) -> Self {
        let mut sorted = rates.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |place: usize| sorted.get(place).copied().unwrap_or_default();
        Self {
            median: at(sorted.len() / 2),
            range: [at(0), at(sorted.len().saturating_sub(1))],
        }
    }
}

impl Rates {
    fn of(run: &Run) -> Self {
        Self {
            decode_fps: Rate::of(&run.decoding),
            end_to_end_fps: Rate::of(&run.end_to_end),
            choose_ms: Rate::of(&run.choosing_ms).median,
        }
    }
}

impl Report {
    fn text(&self) -> String {
        let mut text = self.machine.text();
        let [w, h] = self.size_px;
        text += &format!(
            "\n{}, from {w}x{h}; {}, medians of {} (slowest to fastest):\n",
            self.pack,
            counted(self.jobs, "decoding thread"),
            counted(self.turns, "turn")
        );
        let rows = [
            ("foveated", self.foveated),
            ("viewport", self.viewport),
            ("full", self.full),
        ];
        for (name, rates) in rows {
            let of = |rate: Rate| {
                let [slowest, fastest] = rate.range;
                format!("{:.1} ({slowest:.1} to {fastest:.1})", rate.median)
            };
            text += &format!(
                "{name}: {} frames/s decoded, {} drawn, {:.2} ms to choose\n",
                of(rates.decode_fps),
                of(rates.end_to_end_fps),
                rates.choose_ms
            );
        }
        text += &match (self.original_fps, self.ratio_original) {
            (Some(fps), Some(ratio)) => {
                format!("original file: {fps:.1} frames/s, foveated is {ratio:.1} times that\n")
            }
            _ => "original file: not compared; give it with --original FILE\n".to_owned(),
        };
        let told = |score: Option<f64>| score.map_or("-".to_owned(), |jod| format!("{jod:.2} JOD"));
        text += &format!(
            "foveated under {}: {}; before, at a slope of {}: {}, {:.1} frames/s, {:.1} times \
             full, {:.2} % of the pixels\n",
            self.policy,
            told(self.score),
            self.before.slope,
            told(self.before.score),
            self.before.foveated_fps,
            self.before.ratio,
            self.before.pixels_share_mean * 100.0,
        );
        text + &format!(
            "foveated is {:.1} times full and {:.1} times viewport; {:.2} % of the pixels\n\
             {}, {}, fovea sharp {} after a saccade \
             (95th percentile), {:.2} MB on the GPU ({:.2} % of the whole)",
            self.ratio,
            self.ratio_viewport,
            self.pixels_share_mean * 100.0,
            counted(self.late_frames, "late frame"),
            counted(self.incomplete_frames, "incomplete frame"),
            counted(self.frames_to_fovea_p95, "frame"),
            self.gpu_bytes as f64 / 1e6,
            self.gpu_share * 100.0
        )
    }
}
