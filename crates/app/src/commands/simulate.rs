//! What does an eye get from a pack, and what did that take?

use crate::commands::scene;
use crate::commands::score::ScoreReport;
use crate::commands::simulate_expected::{expected_of, tell_expectation};
use crate::commands::simulate_length::{MOST_LIVE, Playing};
use crate::commands::simulate_options::SimulateArgs;
use crate::commands::simulate_pictures::PictureSinks;
use crate::commands::simulate_score::{Baseline, RunScoring};
use crate::gaze_source::{GazeSource, interrupted};
use crate::options::decoding::DeviceReport;
use crate::options::panels::{PlayedPanel, SAMPLES_ONE_VIEW, ShownRig, around_the_head};
use crate::options::policy::Switch;
use crate::options::renderer::{RendererName, open_device};
use crate::options::showing::EyeName;
use crate::report::output::{self, WrongUsage};
use crate::run::open_player::open_player;
use crate::run::optics::intermediate_pixels;
use crate::run::run_folder::{LOG, TABLE};
use anyhow::bail;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::description::Description;
use foveal_core::perception::visible_loss::{BEST_JOD, jod_lost};
use foveal_core::session::log::{SessionLogPart, sha256_hex};
use foveal_core::units::{Seconds, counted};
use foveal_core::view::axes::yaw_pitch_from_direction;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::head_pose::HeadPose;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::surface::{Projection, Surface};
use foveal_media::pack::pack::Pack;
use foveal_media::pack::pack_file::PackFile;
use foveal_play::{FrameReport, Player, PlayerOptions};
use foveal_render::{DrawDevice, TileStyle};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// How far below its target a score may be and still count as reached, in JOD.
const TARGET_WITHIN: f64 = 0.2;
/// A pixel as three 32-bit floats, which is what Kastner 2016 (table 5.4) counts shares of.
const FLOATS_BYTES: u64 = 12;
/// What a run took.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RunSummary {
    pub(crate) policy: String,
    /// The same where it was left to the content; null where it was named.
    pub(crate) policy_chosen: Option<&'static str>,
    pub(crate) frames: usize,
    pub(crate) pixels_share_mean: f64,
    pub(crate) pixels_share_max: f64,
    pub(crate) bytes: u64,
    /// Bytes of units that were fetched again.
    pub(crate) refetched_bytes: u64,
    pub(crate) decoded_megapixels: f64,
    pub(crate) decode_ms_mean: f64,
    pub(crate) decode_ms_p95: f64,
    pub(crate) late_frames: usize,
    /// Frames shown with a coarser tile in the place of one that was chosen.
    pub(crate) incomplete_frames: usize,
    pub(crate) wrong_frame_tiles: usize,
    pub(crate) damaged_tiles: usize,
    pub(crate) level_changes: u64,
    /// Null where it is not known where the eye looked.
    pub(crate) gaze_error_deg_mean: Option<f64>,
    /// Share of the detail that the eye could see that was shown; null for packs without
    /// signatures.
    pub(crate) detail_share_mean: Option<f64>,
    /// The score that levels were chosen for, in JOD; null without one.
    pub(crate) target: Option<f64>,
    /// The score against every finest tile that signatures predict, in JOD; null for packs
    /// without, and under a link.
    pub(crate) expected_jod: Option<f64>,
    /// Whether buying stopped because the target was reached; null without a link or a target.
    pub(crate) stopped_at_target: Option<bool>,
    /// Bytes that the link could have brought besides; null without one.
    pub(crate) unspent_bytes: Option<u64>,
    pub(crate) gpu_bytes: u64,
    /// The same over the finest level whole, as 8-bit 4:2:0, and as three 32-bit floats a pixel.
    pub(crate) gpu_share: f64,
    pub(crate) gpu_share_of_floats: f64,
    pub(crate) decoded_on: DeviceReport,
    pub(crate) log_sha256: String,
    /// How good it looked compared with the full picture, where asked for; on panels that of the
    /// lowest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) score: Option<ScoreReport>,
    /// The panels that it was shown on, where there is a rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) panels: Option<Vec<PlayedPanel>>,
    /// Pixels of pictures between the tiles and the panels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) intermediate_pixels: Option<u64>,
}

pub(crate) fn run(args: &SimulateArgs) -> anyhow::Result<()> {
    let args = &args.with_table()?;
    let file = match Pack::open(&args.pack)? {
        Pack::Scene(file) => return scene::simulate::run(args, file),
        Pack::Video(file) => file,
    };
    args.check()?;
    let about = file.pack().description();
    let rig = args.panels.read(args.eye)?;
    let args = &args.with_preset(about.projection);
    let args = &args.on_rig(rig.as_ref(), about)?;
    let panels = rig.map(|rig| rig.panels);
    let (args, policy_chosen) = &args.for_content(&file)?;
    let config = args.config()?;
    let showing = args.showing(config.policy)?;
    args.check_length(about)?;
    let surface = about.grid(args.view.screen).surface;
    args.tell_of_eyes(surface.eyes);
    let mounted = panels.as_deref().map(around_the_head).unwrap_or_default();
    let (view, drawing) = (args.view.eye_view(&surface)?, open_device(args.renderer)?);
    let ahead = MountedPanel::views_from(&mounted, &HeadPose::default(), Default::default());
    args.scoring.check(&drawing)?;
    let options = PlayerOptions {
        style: showing,
        ..args.player_options(config, view, &drawing)?
    };
    let mut player = open_player(Arc::clone(&file), options)?.through(mounted);
    let length = args.length(about, &player);
    let viewer = args.watching.viewer()?;
    let mut gaze = GazeSource::new(&args.gaze, &surface, args.seed, length, &viewer)?;
    let playing = args.playing(about, &gaze)?;
    let mut scoring = args.scoring.open(&Baseline {
        file: &file,
        views: if ahead.is_empty() { vec![view] } else { ahead },
        screen: args.view.screen,
        drawing: &drawing,
        decoding: args.decoding.decoding()?,
        fps: (playing.pictures != Some(1)).then_some(playing.fps),
    })?;
    let mut pictures = PictureSinks::new(args, playing.rate(about), panels.as_deref())?;
    if panels.is_some() {
        begin_log(&player, &args.out)?;
    }
    let (sinks, judge) = (&mut pictures, &mut scoring);
    let reports = play(&mut player, &mut gaze, &playing, sinks, judge)?;
    pictures.finish()?;
    let session = session(&player, &reports).write();
    let policy = player.config().policy.name();
    let judged = |scoring: RunScoring| scoring.report(&args.gaze.as_judged());
    let scores = scoring.map(judged).transpose()?;
    let of_frames = scores.as_ref().map(|scores| scores.lowest.per_frame());
    output::write_whole(&args.out.join(LOG), session.as_bytes())?;
    output::write_whole(&args.out.join(TABLE), csv(&reports, of_frames).as_bytes())?;
    let jods = scores.as_ref().map(|scores| scores.jods.as_slice());
    tell_expectation(&player, &reports);
    let summary = RunSummary {
        policy_chosen: *policy_chosen,
        intermediate_pixels: panels.as_deref().map(intermediate_pixels),
        panels: panels.map(|panels| PlayedPanel::all(&panels, jods)),
        score: scores.map(|scores| scores.lowest),
        ..summarise(policy.to_owned(), &reports, &mut player, &session)
    };
    tell_outside(&reports, &surface);
    summary.tell_missed();
    output::result(args.json, &summary, &summary.text(&args.out))
}

/// Begins the log: should a run be interrupted, it says in which folders its pictures lie.
fn begin_log(player: &Player, out: &Path) -> anyhow::Result<()> {
    let begun = session(player, &[]).write();
    output::write_whole(&out.join(LOG), begun.as_bytes())
}

/// Says where the eye looks outside flat content.
fn tell_outside(reports: &[FrameReport], surface: &Surface) {
    if surface.projection != Projection::Flat || surface.slant.is_some() {
        return;
    }
    let is_outside = |report: &&FrameReport| {
        let at = report.gaze.gaze_in_content;
        let ahead = (-at.z).max(0.0);
        let beyond = |along: f64, k: usize| along.abs() > surface.tangents[k] * ahead;
        beyond(at.x, 0) || beyond(at.y, 1)
    };
    let outside = reports.iter().filter(is_outside).count();
    if outside > 0 {
        let reach = surface.tangents.map(|it| it.atan().to_degrees());
        output::say(&format!(
            "warning: in {outside} of {} the gaze lies outside the picture, which reaches {:.1}° \
             to each side and {:.1}° up and down",
            counted(reports.len(), "frame"),
            reach[0],
            reach[1]
        ));
    }
}

impl SimulateArgs {
    /// These options with the gaze of a tracker's table, where that is named.
    fn with_table(&self) -> anyhow::Result<Self> {
        Ok(Self {
            gaze: self.tracker.read_as(&self.gaze)?,
            ..self.clone()
        })
    }

    /// How a video is played under a policy in a view.
    fn player_options(
        &self,
        config: PolicyConfig,
        view: EyeView,
        drawing: &DrawDevice,
    ) -> anyhow::Result<PlayerOptions> {
        Ok(PlayerOptions {
            config,
            view,
            screen: self.view.screen,
            drawing: drawing.clone(),
            style: TileStyle::default(),
            paced: self.paced,
            judged: true,
            bytes_per_s: self.watching.link().bytes_per_s,
            tell: output::say,
            decoding: self.decoding.decoding()?,
        })
    }

    /// Says where it makes no difference whose picture is asked for.
    fn tell_of_eyes(&self, eyes: u8) {
        if eyes == 1 && self.eye != EyeName::Left && self.panels.panels.is_none() {
            output::say(&format!(
                "{}: has one picture for both eyes, so --eye {} shows that",
                self.pack.display(),
                self.eye.name()
            ));
        }
    }

    /// These options with those that a preset stands for.
    fn with_preset(&self, projection: Projection) -> Self {
        Self {
            policy: self.watching.presets.policy(&self.policy, projection),
            ..self.clone()
        }
    }

    /// These options with the rule that is cheaper for this content, where none was asked for; and
    /// its name.
    fn for_content(&self, file: &PackFile) -> anyhow::Result<(Self, Option<&'static str>)> {
        if self.watching.link.is_some() {
            return Ok((self.clone(), None));
        }
        let (policy, chosen) = self.policy.for_pack(file, &self.view)?;
        let with = Self {
            policy,
            ..self.clone()
        };
        Ok((with, chosen.map(Policy::name)))
    }

    /// These options with those that panels stand for.
    fn on_rig(&self, rig: Option<&ShownRig>, about: &Description) -> anyhow::Result<Self> {
        let mut with = self.clone();
        let Some(rig) = rig else {
            return Ok(with);
        };
        if self.policy.named() == Some(Policy::Sampled) {
            bail!(WrongUsage(SAMPLES_ONE_VIEW.to_owned()));
        }
        if let Some(screen) = self.panels.screen(rig, about.flat_shape())? {
            with.view.screen = screen;
        }
        if self.watching.link.is_none() {
            with.policy = self.policy.seen_by_many(&rig.panels);
            if with.policy.policy() != self.policy.policy() {
                output::say(
                    "the panels are seen by many eyes, so viewport is played; give --policy to \
                     choose for one",
                );
            }
        }
        Ok(with)
    }

    fn showing(&self, policy: Policy) -> anyhow::Result<TileStyle> {
        let has_textures = self.showing.has_textures();
        if has_textures && policy == Policy::Sampled {
            bail!(WrongUsage(
                "--reconstruction textures shows tiles, --policy sampled samples; give one of them"
                    .to_owned()
            ));
        }
        if has_textures && self.heat_map {
            bail!(WrongUsage(
                "--heat-map marks the tiles of --reconstruction atlas; give one of them".to_owned()
            ));
        }
        Ok(self.showing.showing(self.watching.presets.interpolation()))
    }

    /// Checks the options that need no pack.
    fn check(&self) -> anyhow::Result<()> {
        self.check_counts()?;
        let of_scenes = [
            (self.route != "still", "--route"),
            (self.budget.is_some(), "--budget"),
        ];
        if let Some((_, option)) = of_scenes.into_iter().find(|(is_given, _)| *is_given) {
            bail!(WrongUsage(format!(
                "{option} is for scenes, and {} is a video",
                self.pack.display()
            )));
        }
        if self.renderer == RendererName::None && (self.heat_map || self.showing.blur == Switch::On)
        {
            bail!(WrongUsage(
                "--renderer none draws nothing to blur or mark; leave --blur and --heat-map out"
                    .to_owned()
            ));
        }
        if self.watching.presets.system().is_none() {
            self.config()?;
        }
        Ok(())
    }

    /// The policy.
    fn config(&self) -> anyhow::Result<PolicyConfig> {
        let config = self.policy.config()?;
        if self.watching.link.is_some() && !config.policy.spends_a_budget() {
            bail!(WrongUsage(format!(
                "--link: {} ignores the link; give --policy uniform, eccentricity or perceptual",
                self.policy.policy().name()
            )));
        }
        Ok(config)
    }
}

/// Plays the frames, with a live source until the user stops it.
fn play(
    player: &mut Player,
    gaze: &mut GazeSource,
    playing: &Playing,
    pictures: &mut PictureSinks<'_>,
    scoring: &mut Option<RunScoring>,
) -> anyhow::Result<Vec<FrameReport>> {
    let stop = gaze.is_live().then(interrupted).transpose()?;
    let stopped = || {
        stop.as_ref()
            .is_some_and(|stop| stop.load(Ordering::Relaxed))
    };
    let bar = output::bar(playing.pictures.map(u64::from), output::Counting::Frames);
    let shown = &playing.shown;
    let first = shown.time(0, player);
    player.begin_at(shown.frame(0));
    let mut reports = Vec::new();
    let begun = Instant::now();
    for picture in 0..playing.pictures.unwrap_or(MOST_LIVE) {
        let time = shown.time(picture, player);
        if gaze.is_live() {
            sleep_until(begun + Duration::from_secs_f64((time.0 - first.0).max(0.0)));
        }
        if stopped() && !reports.is_empty() {
            break;
        }
        let look = gaze.look(time);
        let report = player.show(shown.frame(picture), &look)?;
        if let Some(scoring) = scoring {
            scoring.frame(player, &look, &report)?;
        }
        pictures.frame(player, picture, &report)?;
        reports.push(report.without_tiles());
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(reports)
}

fn sleep_until(due: Instant) {
    std::thread::sleep(due.saturating_duration_since(Instant::now()));
}

/// The log of a run.
pub(crate) fn session(player: &Player, reports: &[FrameReport]) -> SessionLogPart {
    SessionLogPart {
        head: player.session_head(),
        frames: reports
            .iter()
            .map(|report| report.session.clone())
            .collect(),
    }
}

/// Sums up a run.
pub(crate) fn summarise(
    policy: String,
    reports: &[FrameReport],
    player: &mut Player,
    session: &str,
) -> RunSummary {
    let count = reports.len().max(1) as f64;
    let mut decode_ms: Vec<f64> = reports
        .iter()
        .map(|r| r.decode.as_secs_f64() * 1e3)
        .collect();
    decode_ms.sort_by(f64::total_cmp);
    let p95 = (decode_ms.len() * 95).div_ceil(100).max(1) - 1;
    let (surface, gpu_bytes) = (player.grid().surface, player.drawer().gpu_bytes());
    let gpu_share_of = |bytes: u64| gpu_bytes as f64 / bytes as f64;
    let detail = reports.iter().map(|r| r.detail_share).sum::<Option<f64>>();
    let quality = expected_of(reports);
    RunSummary {
        policy,
        policy_chosen: None,
        frames: reports.len(),
        pixels_share_mean: reports.iter().map(|r| r.share).sum::<f64>() / count,
        pixels_share_max: reports.iter().map(|r| r.share).fold(0.0, f64::max),
        bytes: reports.iter().map(|r| r.new_bytes).sum(),
        refetched_bytes: player.refetched_bytes(),
        decoded_megapixels: reports.iter().map(|r| r.decoded_pixels).sum::<u64>() as f64 / 1e6,
        decode_ms_mean: decode_ms.iter().sum::<f64>() / count,
        decode_ms_p95: decode_ms.get(p95).copied().unwrap_or_default(),
        late_frames: reports.iter().filter(|r| r.late).count(),
        incomplete_frames: reports.iter().filter(|r| !r.missing.is_empty()).count(),
        wrong_frame_tiles: reports.iter().map(|r| r.wrong_frame_tiles).sum(),
        damaged_tiles: reports.iter().map(|r| r.failed_tiles).sum(),
        level_changes: reports.iter().map(|r| r.level_changes).sum(),
        gaze_error_deg_mean: mean_of_known(reports.iter().map(|r| r.gaze_error_deg)),
        detail_share_mean: detail.map(|sum| sum / count),
        target: player.config().target,
        expected_jod: quality
            .filter(|_| player.knows_score())
            .map(|sum| BEST_JOD - jod_lost(sum / count)),
        stopped_at_target: player.stopped_at_target(),
        unspent_bytes: unspent(reports, player),
        gpu_bytes,
        gpu_share: gpu_share_of(surface.bytes_of_planes()),
        gpu_share_of_floats: gpu_share_of(surface.pixels() * FLOATS_BYTES),
        decoded_on: DeviceReport::new(player.device_use()),
        log_sha256: sha256_hex(session.as_bytes()),
        score: None,
        panels: None,
        intermediate_pixels: None,
    }
}

/// Bytes that a link brings in the time of a run and that nothing was fetched for.
fn unspent(reports: &[FrameReport], player: &Player) -> Option<u64> {
    let [first, last] = [reports.first()?, reports.last()?].map(|report| report.session.time_s.0);
    let period = player.length().0 / player.frames().max(1) as f64;
    let brought = player.bytes_in(Seconds(last - first + period))?;
    let fetched: u64 = reports.iter().map(|report| report.new_bytes).sum();
    Some((brought - fetched as f64).max(0.0) as u64)
}

/// The mean of what is known; `None` where nothing is.
fn mean_of_known(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let known: Vec<f64> = values.flatten().collect();
    (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
}

impl RunSummary {
    /// Says where the target is not reached, by the score where there is one.
    fn tell_missed(&self) {
        let Some(target) = self.target else { return };
        let scored = self.score.as_ref().map(|it| ("score", it.jod));
        let expected = self.expected_jod.map(|jod| ("expected score", jod));
        let Some((what, jod)) = scored.or(expected) else {
            return;
        };
        if jod < target - TARGET_WITHIN {
            let more = match self.unspent_bytes {
                Some(_) => "a faster --link brings more",
                None if self.policy == Policy::Acuity.name() => "--policy perceptual can show more",
                None => "a higher --target shows more",
            };
            output::say(&format!(
                "warning: --target {target} is missed: the {what} is {jod:.2} JOD; {more}"
            ));
        }
    }

    fn text(&self, out: &Path) -> String {
        format!(
            "{} under {}{}: {:.2} % of the pixels of the finest level (most {:.2} %), {:.2} MB \
             fetched, {:.1} MPix decoded\n\
             decoding {:.1} ms a frame (95th percentile {:.1}), {}, {}, {}, {}, \
             {:.2} MB on the GPU\n\
             {}{}{}{}{}{}{}{}{}written to {}",
            counted(self.frames, "frame"),
            self.policy,
            self.policy_chosen.map_or("", |_| " (chosen by auto)"),
            self.pixels_share_mean * 100.0,
            self.pixels_share_max * 100.0,
            self.bytes as f64 / 1e6,
            self.decoded_megapixels,
            self.decode_ms_mean,
            self.decode_ms_p95,
            counted(self.late_frames, "late frame"),
            counted(self.incomplete_frames, "incomplete frame"),
            counted(self.damaged_tiles, "damaged tile"),
            counted(self.level_changes, "level change"),
            self.gpu_bytes as f64 / 1e6,
            output::refetched(self.refetched_bytes),
            self.detail_share_mean
                .map_or(String::new(), |share| format!(
                    "{:.1} % of the detail that the eye could see\n",
                    share * 100.0,
                )),
            match self.pixels_share_max > 1.0 {
                true =>
                    "(more than 100 %: tiles of coarser levels count too, and of sampled views \
                         every sample, also where the view has more pixels than the video)\n",
                false => "",
            },
            self.gaze_error_deg_mean
                .filter(|error| *error > 0.0)
                .map_or(String::new(), |error| format!(
                    "mean error of the expected gaze: {error:.2}°\n"
                )),
            match (self.target, self.expected_jod) {
                (Some(target), Some(jod)) =>
                    format!("target {target} JOD, expected {jod:.2} JOD\n"),
                _ => String::new(),
            },
            match (self.stopped_at_target, self.unspent_bytes) {
                (Some(true), Some(bytes)) => format!(
                    "buying stopped at the target; {} of the link were not used\n",
                    output::size(bytes)
                ),
                _ => String::new(),
            },
            self.decoded_on.text(),
            self.score.as_ref().map_or(String::new(), ScoreReport::text),
            self.panels
                .as_deref()
                .map_or(String::new(), PlayedPanel::text),
            out.display(),
        )
    }
}

/// The figures of a run as CSV, one line a frame, with the score of each where there is one
/// (docs/formats/results.md).
pub(crate) fn csv(reports: &[FrameReport], jods: Option<&[f64]>) -> String {
    let mut text = "frame,time_s,gaze_yaw_deg,gaze_pitch_deg,head_yaw_deg,head_pitch_deg,tiles,\
                    pixels,share,decoded_pixels,new_bytes,decode_ms,upload_ms,late,missing_tiles,\
                    level_changes,gaze_error_deg,detail_share,jod\n"
        .to_owned();
    let known = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6}"));
    for (number, report) in reports.iter().enumerate() {
        let (yaw, pitch) = yaw_pitch_from_direction(report.gaze.gaze_in_content);
        let head = report.session.head;
        let _ = writeln!(
            text,
            "{},{:.6},{:.4},{:.4},{:.4},{:.4},{},{},{:.6},{},{},{:.3},{:.3},{},{},{},{},{},{}",
            report.session.frame,
            report.session.time_s.0,
            yaw.to_degrees(),
            pitch.to_degrees(),
            head.yaw.to_degrees(),
            head.pitch.to_degrees(),
            report.histogram.iter().sum::<u32>(),
            report.pixels,
            report.share,
            report.decoded_pixels,
            report.new_bytes,
            report.decode.as_secs_f64() * 1e3,
            report.upload.as_secs_f64() * 1e3,
            u8::from(report.late),
            report.missing.len(),
            report.level_changes,
            known(report.gaze_error_deg),
            known(report.detail_share),
            known(jods.and_then(|jods| jods.get(number)).copied()),
        );
    }
    text
}
