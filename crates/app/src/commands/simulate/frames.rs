//! What does an eye get from a video, frame by frame?

use crate::commands::simulate::expected::tell_expectation;
use crate::commands::simulate::length::{MOST_LIVE, Playing};
use crate::commands::simulate::options::SimulateArgs;
use crate::commands::simulate::pictures::PictureSinks;
use crate::commands::simulate::scoring::{Baseline, RunScoring};
use crate::commands::simulate::summary::{RunSummary, csv, summarise};
use crate::gaze_source::{GazeSource, interrupted};
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
use foveal_core::session::log::SessionLogPart;
use foveal_core::units::counted;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::head_pose::HeadPose;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::surface::{Projection, Surface};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::{FrameOptions, FramePlayer, FrameReport, PlayerOptions};
use foveal_render::{DrawDevice, TileStyle};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

pub(super) fn run(args: &SimulateArgs, file: &Arc<PackFile>) -> anyhow::Result<()> {
    args.check()?;
    let about = file.pack().description();
    let rig = args.panels.read(args.eye)?;
    let args = &args.with_preset(about.projection);
    let args = &args.on_rig(rig.as_ref(), about)?;
    let panels = rig.map(|rig| rig.panels);
    let (args, policy_chosen) = &args.for_content(file)?;
    let config = args.config()?;
    let showing = args.showing(config.policy)?;
    args.check_length(about)?;
    let surface = about.grid(args.view.screen).surface;
    args.tell_of_eyes(surface.eyes);
    let mounted = panels.as_deref().map(around_the_head).unwrap_or_default();
    let (view, drawing) = (args.view.eye_view(&surface)?, open_device(args.renderer)?);
    let ahead = MountedPanel::views_from(&mounted, &HeadPose::default(), Default::default());
    args.scoring.check(&drawing)?;
    let options = FrameOptions {
        style: showing,
        ..args.player_options(config, view, &drawing)?
    };
    let mut player = open_player(file, options)?.through(mounted);
    let length = args.length(about, &player);
    let viewer = args.watching.viewer()?;
    let mut gaze = GazeSource::new(&args.gaze, &surface, args.seed, length, &viewer)?;
    let playing = args.playing(about, &gaze)?;
    let mut scoring = args.scoring.open(&Baseline {
        file,
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
fn begin_log(player: &FramePlayer, out: &Path) -> anyhow::Result<()> {
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
    /// How a video is played under a policy in a view.
    fn player_options(
        &self,
        config: PolicyConfig,
        view: EyeView,
        drawing: &DrawDevice,
    ) -> anyhow::Result<FrameOptions> {
        let player = PlayerOptions {
            bytes_per_s: self.watching.link().bytes_per_s,
            ..PlayerOptions::new(config, drawing, output::say)
        };
        Ok(FrameOptions {
            screen: self.view.screen,
            paced: self.paced,
            judged: true,
            decoding: self.decoding.decoding()?,
            ..FrameOptions::new(player, view)
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
    player: &mut FramePlayer,
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
pub(crate) fn session(player: &FramePlayer, reports: &[FrameReport]) -> SessionLogPart {
    SessionLogPart {
        head: player.session_head(),
        frames: reports
            .iter()
            .map(|report| report.session.clone())
            .collect(),
    }
}
