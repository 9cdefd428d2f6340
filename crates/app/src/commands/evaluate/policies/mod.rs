//! What does every policy take on one pack, and what is its score?
//!
//! No saving is reported without its score: all play the same frames over the same gaze, and one
//! judge compares what each shows with every finest tile, and with the video that the pack was made
//! from.

mod chart;
mod contenders;
mod equal_score;
mod measure;
mod play;
mod report;
mod tables;

use crate::commands::demo::machine::Machine;
use crate::commands::score::{ScoreConditions, display_named, display_of_view};
use crate::gaze_source::{GazeChoice, TrackerOptions, parse_gaze};
use crate::options::policy::ViewOptions;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{self, WrongUsage, out_of_range};
use crate::run::source_frames::SourceFrames;
use anyhow::{Context, bail};
use clap::Args;
use contenders::{Contender, Ladders, contenders};
use foveal_core::content::policy::asked::{SLOPES, TARGETS};
use foveal_core::units::counted;
use foveal_eval::score::{Mode, Viewing, constants as fit};
use foveal_media::SourceInfo;
use foveal_media::pack::pack_file::PackFile;
use measure::SpanFigures;
use play::Comparison;
use report::{PoliciesReport, PolicyRow, RowContext, compared};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Clone, Debug, Args)]
pub(crate) struct PoliciesArgs {
    /// The pack.
    pack: PathBuf,
    /// The video that the pack was made from: what is shown is judged against it too.
    #[arg(long, value_name = "FILE")]
    source: Option<PathBuf>,
    /// YAW,PITCH in degrees, center, scan, trace:FILE or head:FILE.
    #[arg(
        long,
        value_name = "G",
        default_value = "center",
        allow_hyphen_values = true
    )]
    #[arg(value_parser = parse_gaze)]
    gaze: GazeChoice,
    #[command(flatten)]
    tracker: TrackerOptions,
    /// desk, which is the view itself, or a display as of `foveal score --display`.
    #[arg(long, value_name = "NAME|FILE.toml", default_value = DESK)]
    display: String,
    /// Slopes of acuity, in degrees of a pixel a degree.
    #[arg(
        long,
        value_name = "SLOPE,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    #[arg(default_values_t = [0.044, 0.022, 0.011, 0.0075, 0.005])]
    slopes: Vec<f64>,
    /// Rates of the link of uniform, eccentricity and perceptual, in Mbit/s.
    #[arg(
        long,
        value_name = "RATE,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    #[arg(default_values_t = [1.0, 2.0, 4.0, 8.0])]
    rates: Vec<f64>,
    /// Scores in JOD that acuity, uniform, eccentricity and perceptual choose levels for.
    #[arg(
        long,
        value_name = "JOD,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    #[arg(default_values_t = [8.5, 9.0, 9.5, 9.75])]
    targets: Vec<f64>,
    /// Frames that are played, of which the first second counts as the start; 1 to 10000.
    #[arg(long, value_name = "N", default_value_t = 48)]
    frames: u32,
    #[command(flatten)]
    view: ViewOptions,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for policies.csv, policies.json and two plots; made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// The display that is the view itself.
const DESK: &str = "desk";
/// Scores at which policies are compared.
const EQUAL_SCORES: [f64; 2] = [9.0, 9.5];
/// Mbit/s that a link may have, as of `--link`.
const RATES: core::ops::RangeInclusive<f64> = 0.001..=1e5;

pub(super) fn run(args: &PoliciesArgs) -> anyhow::Result<()> {
    args.check()?;
    let args = &PoliciesArgs {
        gaze: args.tracker.read_as(&args.gaze)?,
        ..args.clone()
    };
    let own = (args.display != DESK).then(|| display_named("--display", &args.display));
    let own = own.transpose()?;
    let file = Arc::new(PackFile::open(&args.pack)?);
    let about = file.pack().description();
    let surface = about.grid(args.view.screen).surface;
    let view = args.view.eye_view(&surface)?;
    let frames = args.frames.min(about.frames);
    let display = own.unwrap_or_else(|| display_of_view(&view, surface.projection));
    let fps = (frames > 1).then(|| about.fps());
    let original = args.source.as_ref().map(|source| {
        let opened = SourceFrames::open(source, &file, args.view.screen);
        opened
            .map(|frames| frames.info().clone())
            .context("--source")
    });
    let original = original.transpose()?;
    let drawing = open_device(RendererName::Gpu).or_else(|_| open_device(RendererName::Cpu));
    let comparison = Comparison {
        source: args.source.as_deref(),
        view,
        screen: args.view.screen,
        drawing: drawing.context("pictures of a pack cannot be drawn")?,
        viewing: Viewing::new(display, view.size, fps, true, Mode::Compat)?,
        gaze: &args.gaze,
        seed: args.seed,
        spans: spans(frames, about.fps()).to_vec(),
        file: Arc::clone(&file),
    };
    let ladders = Ladders {
        slopes: &args.slopes,
        rates: &args.rates,
        targets: &args.targets,
    };
    let contenders = contenders(ladders, surface.projection);
    let policies = counted(contenders.len(), "way");
    output::say(&format!("{}: played in {policies}", args.pack.display()));
    let figures = comparison.play(&contenders)?;
    let report = args.report(&comparison, original.as_ref(), &contenders, &figures);
    args.write(&report)?;
    output::result(args.json, &report, &report.text())
}

/// The first second, and what stands for a policy: what follows, or all where nothing does.
fn spans(frames: u32, fps: f64) -> [Range<u32>; 2] {
    let second = fps.ceil() as u32;
    match frames > second {
        true => [0..second, second..frames],
        false => [0..frames, 0..frames],
    }
}

impl PoliciesArgs {
    fn check(&self) -> anyhow::Result<()> {
        if !(1..=10_000).contains(&self.frames) {
            bail!(out_of_range("--frames", self.frames, "1 to 10000"));
        }
        if let Some(slope) = self.slopes.iter().find(|of| !SLOPES.contains(*of)) {
            bail!(out_of_range("--slopes", slope, "0 to 1 degree a degree"));
        }
        if let Some(rate) = self.rates.iter().find(|of| !RATES.contains(*of)) {
            bail!(out_of_range("--rates", rate, "0.001 to 100000 Mbit/s"));
        }
        if let Some(target) = self.targets.iter().find(|of| !TARGETS.contains(*of)) {
            let range = "scores of 1 to 9.99 JOD; 10 is full";
            bail!(out_of_range("--targets", target, range));
        }
        if let GazeChoice::Live(sender) = &self.gaze {
            bail!(WrongUsage(format!(
                "--gaze {sender}: a live eye cannot look the same way twice; give center, scan, \
                 YAW,PITCH, trace:FILE or head:FILE"
            )));
        }
        Ok(())
    }

    fn report(
        &self,
        comparison: &Comparison<'_>,
        original: Option<&SourceInfo>,
        contenders: &[Contender],
        figures: &[Vec<SpanFigures>],
    ) -> PoliciesReport {
        let about = comparison.file.pack().description();
        let [start, rest] = [0, 1].map(|span| comparison.spans[span].len() as u32);
        let original_bytes = original.map_or(about.source.bytes, |original| original.bytes);
        let of = original.and_then(|original| original.frames);
        let of = of.unwrap_or_else(|| u64::from(about.frames)).max(1);
        let shown = RowContext {
            content: &about.source.name,
            display: match self.display == DESK {
                true => DESK,
                false => &comparison.viewing.display.name,
            },
            original_bytes: original_bytes as f64 * f64::from(rest) / of as f64,
        };
        let rows = contenders.iter().zip(figures);
        let rows = rows.map(|(contender, of)| PolicyRow::new(contender, shown, &of[0], &of[1]));
        let rows: Vec<PolicyRow> = rows.collect();
        PoliciesReport {
            machine: Machine::here(comparison.drawing.name().to_owned()),
            pack: self.pack.clone(),
            source: self.source.clone(),
            original_bytes,
            metric: fit::METRIC,
            version: fit::VERSION,
            mode: Mode::Compat,
            conditions: ScoreConditions::new(&comparison.viewing, Some(self.gaze.as_judged())),
            start_frames: start,
            frames: rest,
            played_frames: comparison.spans[1].end,
            at_equal_score: compared(&rows, &self.scores()),
            rows,
        }
    }

    /// The scores at which policies are compared, rising.
    fn scores(&self) -> Vec<f64> {
        let mut scores = [&EQUAL_SCORES[..], &self.targets].concat();
        scores.sort_by(f64::total_cmp);
        scores.dedup();
        scores
    }

    /// Writes the tables and the plots.
    fn write(&self, report: &PoliciesReport) -> anyhow::Result<()> {
        let out = &self.out;
        std::fs::create_dir_all(out)
            .with_context(|| format!("--out {}: the folder cannot be made", out.display()))?;
        let json = serde_json::to_string_pretty(report)?;
        let [bytes, pixels] = chart::charts(report);
        for (name, text) in [
            ("policies.json", json),
            ("policies.csv", report.csv()),
            ("score-over-bytes.svg", bytes),
            ("score-over-pixels.svg", pixels),
        ] {
            output::write_whole(&out.join(name), text.as_bytes())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_of_what_follows_the_first_second_where_something_does() {
        assert_eq!(spans(48, 24.0), [0..24, 24..48]);
        assert_eq!(spans(48, 23.976), [0..24, 24..48]);
        assert_eq!(spans(12, 25.0), [0..12, 0..12]);
        assert_eq!(spans(25, 25.0), [0..25, 0..25]);
    }
}
