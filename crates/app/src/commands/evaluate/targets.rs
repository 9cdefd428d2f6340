//! Does what is chosen for a score keep it?
//!
//! Generated scenes of seeds 1 to 8 are what the table in core is fitted on; those of further seeds
//! and the inputs that are given say how the fit holds.

use crate::commands::evaluate::trial::Scratch;
use crate::commands::score::{DeviceName, Engine, display_of_view, from_image};
use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel};
use crate::options::policy::ViewOptions;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{self, Counting, out_of_range};
use crate::run::kept_pack::plan_of;
use crate::run::open_player::open_player;
use crate::run::scene_clip::write_scene;
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::content::policy::asked::{SLOPES, TARGETS};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::perception::acuity::AcuityModel;
use foveal_core::perception::visible_loss::{BEST_JOD, quality_of_jod};
use foveal_eval::score::{Mode, ScorePicture, Viewing};
use foveal_media::VideoInput;
use foveal_media::generate::GeneratedScene;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::prepare::{PrepareSettings, ProjectionChoice, prepare};
use foveal_play::{FrameOptions, FramePlayer, PlayerOptions};
use foveal_render::DrawDevice;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Clone, Debug, Args)]
pub(crate) struct TargetsArgs {
    /// Scenes are generated for the seeds 1 to this one; 8 for the fit alone, at most 99.
    #[arg(long, value_name = "N", default_value_t = 12)]
    seeds: u32,
    /// A video or a picture to check the fit on; may be given again.
    #[arg(long, value_name = "FILE")]
    input: Vec<PathBuf>,
    /// Scores to choose for.
    #[arg(long, value_name = "JOD,..", value_delimiter = ',')]
    #[arg(default_values_t = [8.5, 9.0, 9.5, 9.75])]
    targets: Vec<f64>,
    /// Slopes of acuity to judge, in degrees of a pixel a degree.
    #[arg(long, value_name = "SLOPE,..", value_delimiter = ',')]
    #[arg(default_values_t = [0.044, 0.022, 0.011, 0.0055, 0.00275])]
    slopes: Vec<f64>,
    /// Frames of each; 1 to 10000.
    #[arg(long, value_name = "N", default_value_t = 16)]
    frames: u32,
    #[command(flatten)]
    view: ViewOptions,
    /// Folder for the packs, which go away at the end (default: the system's for such).
    #[arg(long, value_name = "DIR")]
    scratch: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Seeds that the table is fitted on.
const FITTED: u32 = 8;
/// Pixels of the flat scenes, and of the spheres.
const WIDE: [u32; 2] = [960, 540];
const SPHERE: [u32; 2] = [2048, 1024];
/// Tiles of spheres, as small against their faces as those of usual ones.
const SPHERE_TILE: u32 = 128;

/// One content under one policy.
#[derive(Debug, Serialize)]
struct Row {
    content: String,
    /// Whether the table is fitted on it.
    fitted: bool,
    policy: &'static str,
    target: Option<f64>,
    slope: Option<f64>,
    /// Quality difference from signatures, and the score that is expected for it.
    told: f64,
    expected_jod: f64,
    jod: f64,
    /// The worst of its zones.
    jod_zone_min: f64,
    pixels_share_mean: f64,
    level_changes: u64,
}

#[derive(Debug, Serialize)]
struct Report {
    frames: u32,
    rows: Vec<Row>,
    /// Pairs of a score and the quality difference from signatures where the scenes that are
    /// fitted have it: chosen by signatures, and elsewise.
    told_by_loss: Vec<[f64; 2]>,
    told_elsewise: Vec<[f64; 2]>,
    /// The slope at which the scenes that are fitted have each target on average.
    slopes: Vec<[f64; 2]>,
}

pub(super) fn run(args: &TargetsArgs) -> anyhow::Result<()> {
    args.check()?;
    // What cannot be read is reported before an hour of other work.
    for input in &args.input {
        VideoInput::open(input)?;
    }
    let scratch = Scratch::new(args.scratch.as_deref())?;
    let drawing = open_device(RendererName::Gpu)?;
    let mut rows = Vec::new();
    for seed in 1..=args.seeds {
        let clip = scratch.0.join("scene.mkv");
        for (kind, size, scene, projection, tile) in [
            (
                "wide",
                WIDE,
                GeneratedScene::wide(WIDE),
                ProjectionChoice::Flat,
                None,
            ),
            (
                "sphere",
                SPHERE,
                GeneratedScene::panorama(SPHERE),
                ProjectionChoice::Equirect,
                Some(Cut::Tile(SPHERE_TILE)),
            ),
        ] {
            write_scene(&scene.with_seed(seed), size, args.frames, &clip)?;
            let settings = PrepareSettings {
                projection,
                cut: tile,
                ..args.settings()?
            };
            let file = prepared(&clip, &settings, &scratch)?;
            let content = args.content(file, format!("{kind}-{seed}"), seed <= FITTED, &drawing);
            rows.extend(content.judge(&args.policies())?);
        }
    }
    for input in &args.input {
        let name = input.file_name().unwrap_or_default().to_string_lossy();
        let file = prepared(input, &args.settings()?, &scratch)?;
        let content = args.content(file, name.into_owned(), false, &drawing);
        rows.extend(content.judge(&args.policies())?);
    }
    let report = Report {
        frames: args.frames,
        told_by_loss: args.told(&rows, Policy::Perceptual),
        told_elsewise: args.told(&rows, Policy::Acuity),
        slopes: args
            .targets
            .iter()
            .filter_map(|target| slope_at(&rows, *target))
            .collect(),
        rows,
    };
    output::result(args.json, &report, &report.text(&args.targets))
}

impl TargetsArgs {
    fn check(&self) -> anyhow::Result<()> {
        if !(1..=99).contains(&self.seeds) {
            bail!(out_of_range("--seeds", self.seeds, "1 to 99"));
        }
        if !(1..=10_000).contains(&self.frames) {
            bail!(out_of_range("--frames", self.frames, "1 to 10000"));
        }
        let wrong = |target: &&f64| !TARGETS.contains(*target);
        if let Some(target) = self.targets.iter().find(wrong) {
            bail!(out_of_range("--targets", target, "scores of 1 to 9.99"));
        }
        if let Some(slope) = self.slopes.iter().find(|slope| !SLOPES.contains(*slope)) {
            bail!(out_of_range("--slopes", slope, "0 to 1 degree a degree"));
        }
        Ok(())
    }

    /// The quality difference from signatures for each target.
    fn told(&self, rows: &[Row], policy: Policy) -> Vec<[f64; 2]> {
        let of = |target: &f64| [*target, told_at(rows, policy.name(), *target)];
        self.targets.iter().map(of).collect()
    }

    /// The policies that are judged.
    fn policies(&self) -> Vec<PolicyConfig> {
        let for_target = |policy| {
            self.targets.iter().map(move |target| PolicyConfig {
                target: Some(*target),
                ..PolicyConfig::new(policy)
            })
        };
        let by_slope = self.slopes.iter().map(|slope| PolicyConfig {
            acuity: AcuityModel::linear(*slope),
            ..PolicyConfig::new(Policy::Acuity)
        });
        let chosen = for_target(Policy::Perceptual).chain(for_target(Policy::Acuity));
        chosen.chain(by_slope).collect()
    }

    fn settings(&self) -> anyhow::Result<PrepareSettings> {
        Ok(PrepareSettings {
            jobs: output::jobs(None)?,
            most_frames: Some(self.frames),
            sound: false,
            ..PrepareSettings::default()
        })
    }

    fn content<'a>(
        &'a self,
        file: PackFile,
        name: String,
        fitted: bool,
        drawing: &'a DrawDevice,
    ) -> Content<'a> {
        Content {
            file: Arc::new(file),
            name,
            fitted,
            view: &self.view,
            drawing,
        }
    }
}

/// The pack of a clip, until the next one is prepared.
fn prepared(
    clip: &Path,
    settings: &PrepareSettings,
    scratch: &Scratch,
) -> anyhow::Result<PackFile> {
    let pack = scratch.0.join("trial.foveal");
    if pack.exists() {
        std::fs::remove_file(&pack)
            .with_context(|| format!("{}: cannot be removed", pack.display()))?;
    }
    prepare(clip, &pack, &plan_of(clip, settings)?, &mut |_| {})?;
    Ok(PackFile::open(&pack)?)
}

/// A pack, and what shows it.
struct Content<'a> {
    file: Arc<PackFile>,
    name: String,
    fitted: bool,
    view: &'a ViewOptions,
    drawing: &'a DrawDevice,
}

/// One policy that is judged.
struct Trial {
    config: PolicyConfig,
    player: FramePlayer,
    engine: Engine,
    loss: f64,
    share: f64,
    level_changes: u64,
}

impl Content<'_> {
    fn player(&self, config: PolicyConfig) -> anyhow::Result<FramePlayer> {
        let surface = self
            .file
            .pack()
            .description()
            .grid(self.view.screen)
            .surface;
        let player = PlayerOptions::new(config, self.drawing, output::say);
        let options = FrameOptions {
            screen: self.view.screen,
            judged: true,
            ..FrameOptions::new(player, self.view.eye_view(&surface)?)
        };
        open_player(&self.file, options)
    }

    /// All policies frame by frame, against every finest tile; the gaze rests ahead.
    fn judge(&self, policies: &[PolicyConfig]) -> anyhow::Result<Vec<Row>> {
        output::say(&format!("{}: is judged", self.name));
        let about = self.file.pack().description();
        let surface = about.grid(self.view.screen).surface;
        let view = self.view.eye_view(&surface)?;
        let display = display_of_view(&view, surface.projection);
        let fps = (about.frames > 1).then(|| about.fps());
        let viewing = Viewing::new(display, view.size, fps, true, Mode::Compat)?;
        let jobs = output::jobs(None)?;
        let trial = |config: &PolicyConfig| {
            Ok(Trial {
                config: config.clone(),
                player: self.player(config.clone())?,
                engine: Engine::open(DeviceName::Cpu, &viewing, jobs)?,
                loss: 0.0,
                share: 0.0,
                level_changes: 0,
            })
        };
        let trials: anyhow::Result<Vec<Trial>> = policies.iter().map(trial).collect();
        let mut trials = trials?;
        let mut full = self.player(PolicyConfig::new(Policy::Full))?;
        let mut gaze = GazeSource::new(
            &GazeChoice::At([0.0; 2]),
            &surface,
            1,
            full.time(about.frames - 1),
            &ViewerModel::default(),
        )?;
        let bar = output::bar(Some(u64::from(about.frames)), Counting::Frames);
        for frame in 0..about.frames {
            let look = gaze.look(full.time(frame));
            full.show(frame, &look)?;
            let reference = picture(&mut full)?;
            for trial in &mut trials {
                let report = trial.player.show(frame, &look)?;
                let test = picture(&mut trial.player)?;
                let place = view.size.map(|side| f64::from(side / 2));
                trial.engine.frame(&reference, &test, place)?;
                trial.loss += report.expected.map_or(0.0, |it| it.losses.whole());
                trial.share += report.share;
                trial.level_changes += report.level_changes;
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        let frames = f64::from(about.frames);
        trials
            .iter()
            .map(|trial| trial.row(&self.name, self.fitted, frames))
            .collect()
    }
}

fn picture(player: &mut FramePlayer) -> anyhow::Result<ScorePicture> {
    let view = player.view();
    match player.drawer().picture(&view, None)? {
        Some(image) => from_image(&image),
        None => bail!("nothing draws the pictures to score"),
    }
}

impl Trial {
    fn row(&self, content: &str, fitted: bool, frames: f64) -> anyhow::Result<Row> {
        let score = self.engine.score()?;
        let slope = match self.config.acuity {
            AcuityModel::Linear { slope, .. } if self.config.target.is_none() => Some(slope),
            _ => None,
        };
        let zones = score
            .zones
            .as_ref()
            .map(|zones| [zones.under_5_deg, zones.from_5_to_20_deg, zones.over_20_deg]);
        let zones = zones.into_iter().flatten().flatten().map(|zone| zone.jod);
        Ok(Row {
            content: content.to_owned(),
            fitted,
            policy: self.config.policy.name(),
            target: self.config.target,
            slope,
            told: self.loss / frames,
            expected_jod: self.config.policy.expectation().jod(self.loss / frames),
            jod: score.jod,
            jod_zone_min: zones.fold(BEST_JOD, f64::min),
            pixels_share_mean: self.share / frames,
            level_changes: self.level_changes,
        })
    }
}

/// How far around a score rows count, in natural logarithms of quality differences.
const AROUND: f64 = 0.5;

/// The quality difference from signatures where the judge finds `target`: the line through the
/// logarithms of the fitted rows around it.
fn told_at(rows: &[Row], policy: &str, target: f64) -> f64 {
    let counted = rows
        .iter()
        .filter(|row| row.fitted && row.policy == policy && row.jod < BEST_JOD && row.told > 0.0);
    let at = quality_of_jod(target).ln();
    let points = counted.map(|row| {
        let x = quality_of_jod(row.jod).ln() - at;
        [x, row.told.ln(), (-0.5 * (x / AROUND).powi(2)).exp()]
    });
    let points: Vec<[f64; 3]> = points.collect();
    let sum = |of: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(|p| p[2] * of(p)).sum::<f64>();
    let weight = sum(&|_| 1.0);
    let [x, y] = [0, 1].map(|k| sum(&|p| p[k]) / weight);
    let slope = sum(&|p| (p[0] - x) * (p[1] - y)) / sum(&|p| (p[0] - x).powi(2));
    (y - slope * x).exp()
}

/// A target, and the slope at which the mean of the fitted scenes has it, between those judged.
fn slope_at(rows: &[Row], target: f64) -> Option<[f64; 2]> {
    let mut slopes: Vec<f64> = rows.iter().filter_map(|row| row.slope).collect();
    slopes.sort_by(f64::total_cmp);
    slopes.dedup();
    let means: Vec<[f64; 2]> = slopes
        .iter()
        .map(|slope| {
            let of = rows
                .iter()
                .filter(|row| row.fitted && row.slope == Some(*slope));
            [*slope, mean(of.map(|row| row.jod))]
        })
        .collect();
    means.windows(2).find_map(|pair| {
        let [[fine, high], [coarse, low]] = [pair[0], pair[1]];
        (low..=high).contains(&target).then(|| {
            let share = (target - high) / (low - high);
            [target, fine * (coarse / fine).powf(share)]
        })
    })
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

impl Report {
    fn text(&self, targets: &[f64]) -> String {
        let mut text = format!(
            "{:<11} {:>6} | {:>22} | {:>22}\n",
            "policy", "target", "fitted: mean (from, to)", "others: mean (from, to)"
        );
        for policy in ["perceptual", "acuity"] {
            for target in targets {
                let cell = |fitted| {
                    let of = self.rows.iter().filter(|row| {
                        row.policy == policy && row.target == Some(*target) && row.fitted == fitted
                    });
                    let scores: Vec<f64> = of.map(|row| row.jod).collect();
                    if scores.is_empty() {
                        return "-".to_owned();
                    }
                    let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
                    let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    format!("{:.2} ({least:.2}, {most:.2})", mean(scores.into_iter()))
                };
                text += &format!(
                    "{policy:<11} {target:>6} | {:>22} | {:>22}\n",
                    cell(true),
                    cell(false)
                );
            }
        }
        for (policy, pairs) in [
            ("perceptual", &self.told_by_loss),
            ("acuity", &self.told_elsewise),
        ] {
            for [target, told] in pairs {
                text += &format!("{policy} {target}: signatures predict a loss of {told:.1}\n");
            }
        }
        for [target, slope] in &self.slopes {
            text += &format!("acuity without signatures: {target} at a slope of {slope:.5}\n");
        }
        text
    }
}
