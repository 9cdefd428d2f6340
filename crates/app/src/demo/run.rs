//! How does one content play under each policy?

use super::FRAMES;
use super::content::Prepared;
use super::moment::Moment;
use super::pictures::Pictures;
use crate::canvas::RendererName;
use crate::gaze::{GazeChoice, GazeSource};
use crate::options::ViewOptions;
use crate::output::{self, Counting};
use crate::player::{FrameReport, Player, PlayerOptions};
use crate::simulate::{RunSummary, csv, default_jobs, session, summarise, write_text};
use anyhow::Context;
use foveal_core::selection::policy::{Policy, PolicyConfig};
use std::path::Path;
use std::sync::Arc;

/// What is compared, baselines first.
pub(super) const POLICIES: [Policy; 3] = [Policy::Full, Policy::Viewport, Policy::Acuity];
/// Index in [`POLICIES`] of what the others are judged by.
pub(super) const FULL: usize = 0;
/// Index of what the industry ships.
pub(super) const VIEWPORT: usize = 1;
/// Index of what is judged.
pub(super) const ACUITY: usize = 2;

/// How all content is played.
pub(super) struct Conditions<'a> {
    pub(super) view: &'a ViewOptions,
    pub(super) renderer: RendererName,
    pub(super) seed: u64,
}

/// One run under one policy.
pub(super) struct PolicyRun {
    pub(super) summary: RunSummary,
    pub(super) reports: Vec<FrameReport>,
}

/// Content that was played under all policies.
pub(super) struct Played {
    pub(super) content: Prepared,
    /// In the order of [`POLICIES`].
    pub(super) runs: Vec<PolicyRun>,
    /// Display time of every frame in seconds.
    pub(super) times: Vec<f64>,
    pub(super) moment: Moment,
    pub(super) pictures: Pictures,
}

/// Plays content under every policy, one after the other in this run, then makes the pictures.
pub(super) fn play(
    content: Prepared,
    conditions: &Conditions<'_>,
    out: &Path,
    budget: usize,
) -> anyhow::Result<Played> {
    let name = content.name.clone();
    let stage = Stage::new(content, conditions);
    let mut runs = Vec::new();
    for policy in POLICIES {
        let folder = out.join(format!("{name}-{}", word(policy)));
        runs.push(stage.play_under(policy, &folder)?);
    }
    let times = runs[ACUITY].reports.iter();
    let times = times.map(|report| report.session.time_s.0).collect();
    let moment = Moment::choose(&runs[ACUITY].reports);
    eprintln!("{name}: the pictures of frame {} are made", moment.frame);
    let pictures = Pictures::take(&stage, &runs[ACUITY].reports[moment.frame as usize], budget)?;
    Ok(Played {
        content: stage.content,
        runs,
        times,
        moment,
        pictures,
    })
}

/// A policy as users write it.
pub(super) fn word(policy: Policy) -> String {
    format!("{policy:?}").to_lowercase()
}

/// What every run of one content shares.
pub(super) struct Stage<'a> {
    content: Prepared,
    conditions: &'a Conditions<'a>,
    frames: u32,
}

impl<'a> Stage<'a> {
    fn new(content: Prepared, conditions: &'a Conditions<'a>) -> Self {
        let frames = content.file.pack().description().frames.min(FRAMES);
        Self {
            content,
            conditions,
            frames,
        }
    }

    /// A player at the first frame, and the gaze that all runs follow.
    pub(super) fn player(&self, policy: Policy) -> anyhow::Result<(Player, GazeSource)> {
        let view = self.conditions.view;
        let surface = self
            .content
            .file
            .pack()
            .description()
            .grid(view.screen)
            .surface;
        let options = PlayerOptions {
            config: PolicyConfig::new(policy),
            view: view.eye_view(&surface)?,
            screen: view.screen,
            renderer: self.conditions.renderer,
            paced: false,
            jobs: default_jobs(),
        };
        let player = Player::new(Arc::clone(&self.content.file), options)?;
        let length = player.time(self.frames - 1);
        let gaze = GazeSource::new(&GazeChoice::Scan, &surface, self.conditions.seed, length)?;
        Ok((player, gaze))
    }

    fn play_under(&self, policy: Policy, folder: &Path) -> anyhow::Result<PolicyRun> {
        let name = word(policy);
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
        eprintln!("{}: plays under {name}", self.content.name);
        let (mut player, mut gaze) = self.player(policy)?;
        let bar = output::bar(Some(u64::from(self.frames)), Counting::Frames);
        let mut reports = Vec::new();
        for frame in 0..self.frames {
            reports.push(player.play(frame, &mut gaze)?);
            bar.inc(1);
        }
        bar.finish_and_clear();
        let log = session(&player, &reports).write();
        write_text(&folder.join("session.jsonl"), &log)?;
        write_text(&folder.join("frames.csv"), &csv(&reports))?;
        let summary = summarise(name, &reports, player.canvas.gpu_bytes(), &log);
        Ok(PolicyRun { summary, reports })
    }
}
