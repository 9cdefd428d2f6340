//! What does an eye get from a scene, and what did that take?

use crate::commands::info::scene_info::BytesByKind;
use crate::commands::score::ScoreReport;
use crate::commands::simulate::moving::{Mover, route_of};
use crate::commands::simulate::options::{SimulateArgs, WrittenPictures};
use crate::commands::simulate::scene_errors::{Judge, JudgedFrame};
use crate::options::hold::pictures_in;
use crate::options::panels::PlayedPanel;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{self, WrongUsage};
use crate::report::picture_file::write_png;
use crate::run::optics::{as_seen, intermediate_pixels};
use crate::run::run_folder::{LOG, TABLE, picture_name};
use anyhow::bail;
use foveal_core::content::policy::{ImportanceSource, Policy, PolicyConfig};
use foveal_core::content::scene::demand::why_not;
use foveal_core::session::log::sha256_hex;
use foveal_core::units::{Seconds, counted};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::eye_view::Field;
use foveal_core::view::head_pose::HeadPose;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::route::Route;
use foveal_media::pack::scene_file::SceneFile;
use foveal_play::{Made, Player, PlayerOptions};
use foveal_render::DrawDevice;
use foveal_render::warp::PanelOptics;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Pixels of a view that is not given.
const VIEW: [u32; 2] = [1280, 800];
/// Default frame count of `--route still`, without a trace.
const FRAMES: u32 = 120;
/// Longest route of which all is played without being asked for: a slip in its times means years.
const MOST_UNASKED: Seconds = Seconds(3600.0);
/// Frames a second where no interval is given.
const RATE: f64 = 30.0;

/// What is said of a run that ends before `perceptual` can choose.
const ONLY_ROOTS: &str = "--frames 1: perceptual chooses by what of the frame before is hidden, so \
                          a first frame shows only the roots, the coarsest level; give --frames 2 \
                          or more, or --policy acuity";

/// What a run took.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SceneSummary {
    policy: &'static str,
    frames: usize,
    /// All bytes: head, pages of index and table, units.
    bytes: u64,
    /// Bytes of units that were fetched again, which these do not count.
    refetched_bytes: u64,
    /// Bytes until the first picture.
    first_picture_bytes: u64,
    /// Bytes until the fovea was within 1 % of full detail, and when; null where it never was, or
    /// nothing draws.
    bytes_to_fovea: Option<u64>,
    seconds_to_fovea: Option<f64>,
    /// The same error in the last frame, in the fovea and over the whole picture.
    error_fovea: Option<f64>,
    error_all: Option<f64>,
    /// Units on screen in the last frame, by level.
    units_by_level: Vec<u32>,
    bytes_by_kind: BytesByKind,
    /// Null where nothing draws.
    triangles_mean: Option<f64>,
    cpu_ms_per_frame: f64,
    choose_ms_per_frame: f64,
    gpu_bytes: u64,
    detail_share_mean: Option<f64>,
    damaged_units: u64,
    units_without_room: usize,
    log_sha256: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    score: Option<ScoreReport>,
    /// The panels that it was shown on, where there is a rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    panels: Option<Vec<PlayedPanel>>,
    /// Pixels of pictures between the units and the panels.
    #[serde(skip_serializing_if = "Option::is_none")]
    intermediate_pixels: Option<u64>,
}

/// A frame of the run.
struct Frame {
    time: Seconds,
    bytes: u64,
    report: Made,
    /// Triangles of what is drawn, in each place where it stands; `None` where nothing draws.
    triangles: Option<u64>,
    /// Share of the visible detail that was shown, hidden or not.
    detail_share: f64,
    judged: Option<JudgedFrame>,
}

pub(super) fn run(args: &SimulateArgs, file: &Arc<SceneFile>) -> anyhow::Result<()> {
    args.check_scene()?;
    let config = args.scene_config()?;
    let view = args.scene_view()?;
    let panels = args.panels_in_scene()?;
    let interval = args.interval.map_or(1.0 / RATE, |interval| interval.0);
    let route = route_of(&args.route)?;
    let known = args.frames_known(&route, interval)?;
    let drawing = args.device_for(&config)?;
    let link = args.watching.link();
    let options = args.scene_player_options(&config, &drawing, interval);
    let mounted: Vec<MountedPanel> = panels.iter().flatten().map(MountedPanel::of).collect();
    let mut player = Player::of_scene(file, options)?.through(mounted.clone());
    let length = Seconds(f64::from(known.unwrap_or_default()) * interval);
    let route = (route, file.scene().bounds());
    let viewer = args.watching.viewer()?;
    let mover = Mover::new(route, &args.gaze, args.seed, length, &viewer)?;
    let frames = known.map_or_else(|| frames_over(mover.gaze_lasts(), interval), Ok)?;
    let fps = (frames > 1).then_some(1.0 / interval);
    let mut judge = args.judge(file, (&view, &mounted), &drawing, fps)?;
    let mut mover = mover.through(view).on_panels(mounted);
    let folders = args.folders(panels.as_deref())?;
    let mut optics = as_seen(panels.as_deref().unwrap_or_default());
    if frames == 1 && player.first_is_blind() {
        output::say(ONLY_ROOTS);
    }
    let draws = !matches!(drawing, DrawDevice::Nothing);
    let bar = output::bar(Some(u64::from(frames)), output::Counting::Frames);
    let mut shown = Vec::new();
    for frame in 0..frames {
        let time = Seconds(f64::from(frame) * interval);
        let standing = mover.at(time, &config.perception);
        let report = player.stand(time, &standing.moment)?;
        let judged = judge.frame(&mut player, &standing, &report)?;
        // Errors are of one view.
        let judged = judged.filter(|_| panels.is_none());
        if frame == 0 && panels.is_some() {
            // Should it be interrupted, this says in which folders its pictures lie.
            output::write_whole(&args.out.join(LOG), player.log().as_bytes())?;
        }
        if args.pictures == WrittenPictures::Png && frame.is_multiple_of(args.every) {
            let pictures = (frame, args.heat_map, &mut optics);
            write_pictures(&mut player, &standing.moment.views, &folders, pictures)?;
        }
        let head = if frame == 0 { file.head_bytes() } else { 0 };
        shown.push(Frame {
            time: Seconds(time.0 + link.delay.0),
            bytes: head + report.new_bytes + report.page_bytes,
            report,
            triangles: draws.then(|| player.triangles_drawn()),
            detail_share: player.detail_share(&standing.moment).unwrap_or_default(),
            judged,
        });
        bar.inc(1);
    }
    bar.finish_and_clear();
    let scores = judge.scores(&args.gaze.as_judged())?;
    let of_frames = scores.as_ref().map(|scores| scores.lowest.per_frame());
    output::write_whole(&args.out.join(LOG), player.log().as_bytes())?;
    output::write_whole(&args.out.join(TABLE), csv(&shown, of_frames).as_bytes())?;
    let jods = scores.as_ref().map(|scores| scores.jods.as_slice());
    let summary = SceneSummary {
        intermediate_pixels: panels.as_deref().map(intermediate_pixels),
        panels: panels.map(|panels| PlayedPanel::all(&panels, jods)),
        score: scores.map(|scores| scores.lowest),
        ..summarise(config.policy, &shown, file, &mut player)
    };
    output::result(args.json, &summary, &summary.text(&args.out))
}

impl SimulateArgs {
    /// How a scene is played under a policy, with so many seconds between two pictures.
    fn scene_player_options(
        &self,
        config: &PolicyConfig,
        drawing: &DrawDevice,
        interval: f64,
    ) -> PlayerOptions {
        let budget = self.budget.map(|bytes| bytes as f64 / interval);
        PlayerOptions {
            bytes_per_s: budget.unwrap_or(self.watching.link().bytes_per_s),
            gpu_bytes: self.gpu_memory,
            ..PlayerOptions::new(config.clone(), drawing, output::say)
        }
    }

    fn check_scene(&self) -> anyhow::Result<()> {
        self.check_counts()?;
        self.watching.presets.refuse_for_scene()?;
        let is_video = [
            (self.start > 0, "--start: a scene has no frames in time"),
            (self.paced, "--paced: a scene has no frames in time"),
            (
                self.heat_map && self.renderer == RendererName::None,
                "--heat-map: --renderer none draws nothing to mark; leave one of them out",
            ),
            (
                self.pictures == WrittenPictures::Video,
                "--pictures video: scenes are written as png, or none",
            ),
            (
                self.budget.is_some() && self.watching.link.is_some(),
                "--budget, --link: give one of them",
            ),
        ];
        match is_video.into_iter().find(|(is_given, _)| *is_given) {
            Some((_, why)) => bail!(WrongUsage(why.to_owned())),
            None => Ok(()),
        }
    }

    /// What draws, where it can do what the policy asks for.
    fn device_for(&self, config: &PolicyConfig) -> anyhow::Result<DrawDevice> {
        let drawing = open_device(self.renderer)?;
        let is_rendered = config.importance == ImportanceSource::Rendered;
        if is_rendered && !matches!(drawing, DrawDevice::Gpu(_)) {
            bail!(WrongUsage(format!(
                "--importance rendered: a GPU draws levels, and {} draws here; give --renderer gpu",
                drawing.name()
            )));
        }
        Ok(drawing)
    }

    /// What compares what is shown of a view, or on panels, with the whole scene.
    fn judge(
        &self,
        file: &Arc<SceneFile>,
        (view, panels): (&EyeView, &[MountedPanel]),
        drawing: &DrawDevice,
        fps: Option<f64>,
    ) -> anyhow::Result<Judge> {
        let ahead = MountedPanel::views_from(panels, &HeadPose::default(), Default::default());
        // Panels are only compared where their scores are asked for.
        let judging = match !panels.is_empty() && !self.scoring.is_asked() {
            true => &DrawDevice::Nothing,
            false => drawing,
        };
        let views = if panels.is_empty() {
            vec![*view]
        } else {
            ahead
        };
        Judge::open(&self.scoring, file, &views, judging, fps)
    }

    /// Frames that are made: as many as the route takes, by default; `None` before a
    /// viewer who stands still as long as their gaze is known.
    fn frames_known(&self, route: &Route, interval: f64) -> anyhow::Result<Option<u32>> {
        let Some(length) = route.length() else {
            let held = self
                .hold
                .hold
                .map(|hold| pictures_in(hold, Seconds(interval)));
            return Ok(self.frames.map(Ok).or(held).transpose()?);
        };
        self.hold
            .refuse_for("a route, which sets how long it lasts")?;
        if self.frames.is_some() {
            return Ok(self.frames);
        }
        let frames = (length.0 / interval).ceil().max(1.0);
        if length.0 > MOST_UNASKED.0 {
            bail!(WrongUsage(format!(
                "--route {}: ends after {} s, which is {frames} frames; of more than an hour \
                 --frames must say how many are played, or the times be shortened (t_s is in \
                 seconds)",
                self.route, length.0
            )));
        }
        Ok(Some(frames as u32))
    }

    /// The policy, where scenes are chosen by it.
    fn scene_config(&self) -> anyhow::Result<PolicyConfig> {
        let is_limited = self.is_limited();
        // All that is worth anything is all: it is a choice only where bytes are few.
        let usual = match is_limited {
            true => self.policy.policy(),
            false => self.policy.named().unwrap_or(Policy::Acuity),
        };
        let config = self.policy.config_of(usual)?;
        let name = config.policy.name();
        if let Some(why) = why_not(config.policy) {
            let others = Policy::ALL
                .into_iter()
                .filter(|policy| why_not(*policy).is_none());
            let others: Vec<&str> = others.map(Policy::name).collect();
            bail!(WrongUsage(format!(
                "--policy {name}: {why}; scenes are chosen by {}",
                others.join(", ")
            )));
        }
        self.policy.refuse_score_of_scene(config.policy)?;
        if is_limited && !config.policy.spends_a_budget() {
            bail!(WrongUsage(format!(
                "--link, --budget: {name} ignores the link; give --policy perceptual, \
                 eccentricity or uniform"
            )));
        }
        Ok(config)
    }

    /// The panels that it is shown on, where there is a rig.
    fn panels_in_scene(&self) -> anyhow::Result<Option<Vec<Panel>>> {
        let rig = self.panels.read(self.eye)?;
        if let Some(rig) = &rig {
            // Scenes lie where they are.
            self.panels.screen(rig, None)?;
        }
        Ok(rig.map(|rig| rig.panels))
    }

    /// The view, before anybody stands anywhere.
    fn scene_view(&self) -> anyhow::Result<EyeView> {
        let size = self.view.size_or(VIEW)?;
        Ok(EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::of_larger_side(self.view.fov()?, size),
            size,
            eye: Default::default(),
        })
    }
}

/// Frames before a viewer who stands still, whose gaze was recorded for so long, if at all.
fn frames_over(trace: Seconds, interval: f64) -> anyhow::Result<u32> {
    match trace.0 > 0.0 {
        true => Ok(pictures_in(trace, Seconds(interval))?),
        false => Ok(FRAMES),
    }
}

/// Draws and writes what every view shows, into its folder.
fn write_pictures(
    player: &mut Player,
    views: &[EyeView],
    folders: &[PathBuf],
    (frame, levels, optics): (u32, bool, &mut PanelOptics),
) -> anyhow::Result<()> {
    for (at, (view, folder)) in views.iter().zip(folders).enumerate() {
        let picture = player.picture(view, levels)?;
        let device = player.drawer().device().clone();
        let picture = picture.map(|image| optics.image(&device, at, image));
        if let Some(image) = picture.transpose()? {
            write_png(&folder.join(picture_name(frame)), &image)?;
        }
    }
    Ok(())
}

fn summarise(
    policy: Policy,
    frames: &[Frame],
    file: &SceneFile,
    player: &mut Player,
) -> SceneSummary {
    let count = frames.len().max(1) as f64;
    let bytes: Vec<u64> = frames
        .iter()
        .scan(0, |sum, frame| {
            *sum += frame.bytes;
            Some(*sum)
        })
        .collect();
    let is_there = |frame: &Frame| {
        let fovea = frame.judged.and_then(|judged| judged.fovea);
        fovea.is_some_and(|fovea| fovea <= 0.01)
    };
    let there = frames.iter().position(is_there);
    let last = frames.last();
    let judged = last.and_then(|frame| frame.judged);
    let mean = |of: &dyn Fn(&Frame) -> f64| frames.iter().map(of).sum::<f64>() / count;
    let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
    SceneSummary {
        policy: policy.name(),
        frames: frames.len(),
        bytes: bytes.last().copied().unwrap_or_default(),
        refetched_bytes: player.session().figures().refetched_bytes,
        first_picture_bytes: bytes.first().copied().unwrap_or_default(),
        bytes_to_fovea: there.map(|at| bytes[at]),
        seconds_to_fovea: there.map(|at| frames[at].time.0),
        error_fovea: judged.and_then(|it| it.fovea),
        error_all: judged.map(|it| it.all),
        units_by_level: last.map_or_else(Vec::new, |it| it.report.units_by_level.clone()),
        bytes_by_kind: BytesByKind::of(file, player.fetched()),
        triangles_mean: frames
            .iter()
            .map(|frame| frame.triangles)
            .sum::<Option<u64>>()
            .map(|sum| sum as f64 / count),
        cpu_ms_per_frame: mean(&|frame| ms(frame.report.total)),
        choose_ms_per_frame: mean(&|frame| ms(frame.report.choose)),
        gpu_bytes: player.drawer().gpu_bytes(),
        detail_share_mean: Some(mean(&|frame| frame.detail_share)),
        damaged_units: player.damaged_units(),
        units_without_room: player.drawer().units_without_room(),
        log_sha256: sha256_hex(player.log().as_bytes()),
        score: None,
        panels: None,
        intermediate_pixels: None,
    }
}

impl SceneSummary {
    /// Triangles of a frame; nothing of a cloud, which has none.
    fn triangles_told(&self) -> String {
        match self.triangles_mean.filter(|mean| *mean > 0.0) {
            Some(mean) => format!("{mean:.0} triangles and "),
            None => String::new(),
        }
    }

    fn text(&self, out: &Path) -> String {
        let mut text = format!(
            "{} under {}: {} ({} until the first picture), {}{:.1} ms of processor time a frame, \
             {} on the GPU\n",
            counted(self.frames, "frame"),
            self.policy,
            output::size(self.bytes),
            output::size(self.first_picture_bytes),
            self.triangles_told(),
            self.cpu_ms_per_frame,
            output::size(self.gpu_bytes),
        );
        if let (Some(fovea), Some(all)) = (self.error_fovea, self.error_all) {
            let _ = writeln!(
                text,
                "luminance differs from full detail at the end by {:.2} % in the fovea and by \
                 {:.2} % in the whole picture (root mean square)",
                100.0 * fovea,
                100.0 * all
            );
        }
        if let (Some(bytes), Some(seconds)) = (self.bytes_to_fovea, self.seconds_to_fovea) {
            let bytes = output::size(bytes);
            let _ = writeln!(
                text,
                "the fovea was within 1 % after {bytes}, {seconds:.2} s"
            );
        }
        text += &output::refetched(self.refetched_bytes);
        if self.damaged_units > 0 {
            let _ = writeln!(
                text,
                "{}, also in what it is compared with; `foveal verify` lists all damage",
                counted(self.damaged_units, "damaged unit")
            );
        }
        text += &output::without_room(self.units_without_room);
        if let Some(score) = &self.score {
            text += &score.text();
            if self.policy != Policy::Acuity.name() {
                text += "no target: the score of a scene is not known while levels are chosen, \
                         so --target does not apply\n";
            }
        }
        if let Some(panels) = &self.panels {
            text += &PlayedPanel::text(panels);
        }
        let _ = write!(text, "written to {}", out.display());
        text
    }
}

/// The figures of a run as CSV, one line a frame, with the score of each where there is one
/// (docs/formats/results.md).
fn csv(frames: &[Frame], jods: Option<&[f64]>) -> String {
    let mut text = "frame,t_s,bytes,units,triangles,choose_ms,cpu_ms,detail_share,error_fovea,\
                    error_all,jod\n"
        .to_owned();
    for (number, frame) in frames.iter().enumerate() {
        let report = &frame.report;
        let [fovea, all] = match frame.judged {
            Some(judged) => [
                judged.fovea.map_or_else(String::new, |it| it.to_string()),
                judged.all.to_string(),
            ],
            None => Default::default(),
        };
        let jod = jods.and_then(|jods| jods.get(number));
        let jod = jod.map_or_else(String::new, |jod| format!("{jod:.6}"));
        let _ = writeln!(
            text,
            "{number},{},{},{},{},{:.3},{:.3},{},{fovea},{all},{jod}",
            frame.time.0,
            frame.bytes,
            report.units_by_level.iter().sum::<u32>(),
            frame
                .triangles
                .map_or_else(String::new, |it| it.to_string()),
            report.choose.as_secs_f64() * 1e3,
            report.total.as_secs_f64() * 1e3,
            frame.detail_share,
        );
    }
    text
}
