//! How does one content play under each policy?

use crate::commands::demo::content::Prepared;
use crate::commands::demo::moment::PicturedMoment;
use crate::commands::demo::pictures::Pictures;
use crate::commands::demo::setup::{DemoConditions, PlaySetup};
use crate::commands::score::{DeviceName, Engine, ScoreReport, display_of_view, from_image};
use crate::commands::simulate::{RunSummary, csv, session, summarise};
use crate::gaze_source::{GazeChoice, GazeSource};
use crate::report::output::{self, Counting};
use anyhow::Context;
use foveal_core::content::policy::Policy;
use foveal_eval::score::{Mode, ScorePicture, Viewing};
use foveal_play::{FrameReport, Player};
use foveal_render::DrawDevice;
use std::path::Path;

/// What is compared, baselines first.
pub(super) const POLICIES: [Policy; 3] = [Policy::Full, Policy::Viewport, Policy::Perceptual];
/// Index in [`POLICIES`] of what the others are judged by.
pub(super) const FULL: usize = 0;
/// Index of what the industry ships.
pub(super) const VIEWPORT: usize = 1;
/// Index of what is judged.
pub(super) const FOVEATED: usize = 2;

/// Frames that are scored: drawing them all would take a software driver minutes.
pub(super) const SCORED: u32 = 16;

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
    pub(super) moment: PicturedMoment,
    pub(super) pictures: Pictures,
}

/// Plays content under every policy in this one run, then makes the pictures.
pub(super) fn play(
    content: Prepared,
    conditions: &DemoConditions<'_>,
    out: &Path,
    budget: usize,
) -> anyhow::Result<Played> {
    let setup = PlaySetup::new(content, conditions);
    let name = &setup.content.name;
    let mut runs = Vec::new();
    for run in play_all(&setup)? {
        let folder = out.join(format!("{name}-{}", run.policy.name()));
        runs.push(run.finish(&folder)?);
    }
    let times = runs[FOVEATED].reports.iter();
    let times = times.map(|report| report.session.time_s.0).collect();
    let moment = PicturedMoment::choose(&runs[FOVEATED].reports);
    output::say(&format!(
        "{name}: the pictures of frame {} are made",
        moment.frame
    ));
    let pictures = Pictures::take(
        &setup,
        &runs[FOVEATED].reports[moment.frame as usize],
        budget,
    )?;
    Ok(Played {
        content: setup.content,
        runs,
        times,
        moment,
        pictures,
    })
}

/// The judge of one run.
fn engine(setup: &PlaySetup<'_>, player: &Player) -> anyhow::Result<Option<(Engine, Viewing)>> {
    if matches!(setup.conditions.drawing, DrawDevice::Nothing) {
        return Ok(None);
    }
    let view = player.view();
    let display = display_of_view(&view, player.grid().surface.projection);
    let fps = setup.content.file.pack().description().fps();
    // A view that no display shows (a pixel a degree or fewer) has no score.
    let Ok(viewing) = Viewing::new(display, view.size, Some(fps), true, Mode::Compat) else {
        return Ok(None);
    };
    let engine = Engine::open(DeviceName::Cpu, &viewing, output::jobs(None)?)?;
    Ok(Some((engine, viewing)))
}

/// All policies take turns, frame by frame and each first as often, so that other work on the
/// machine touches all alike.
fn play_all(setup: &PlaySetup<'_>) -> anyhow::Result<Vec<Run>> {
    let start = |policy| {
        let (player, gaze) = setup.player(policy)?;
        Ok(Run {
            policy,
            engine: engine(setup, &player)?,
            player,
            gaze,
            reports: Vec::new(),
        })
    };
    let runs = POLICIES.into_iter().map(start);
    let mut runs = runs.collect::<anyhow::Result<Vec<Run>>>()?;
    let words = POLICIES.map(Policy::name).join(", ");
    output::say(&format!("{}: plays under {words}", setup.content.name));
    let bar = output::bar(Some(u64::from(setup.frames)), Counting::Frames);
    for frame in 0..setup.frames {
        for turn in 0..runs.len() {
            let run = &mut runs[(frame as usize + turn) % POLICIES.len()];
            run.reports.push({
                let look = run.gaze.look(run.player.time(frame));
                run.player.show(frame, &look)?
            });
        }
        if frame < SCORED {
            score(&mut runs)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(runs)
}

/// Scores what was shown last of every run against the first, which shows every finest tile.
fn score(runs: &mut [Run]) -> anyhow::Result<()> {
    let Some(reference) = runs[FULL].picture()? else {
        return Ok(());
    };
    for run in runs {
        let Some(test) = run.picture()? else {
            continue;
        };
        let Some(report) = run.reports.last() else {
            continue;
        };
        // A gaze outside the view counts at its middle.
        let middle = report.view.size.map(|side| f64::from(side / 2));
        let place = report.view.place(report.gaze.gaze_in_content);
        let gaze_px = place.map_or(middle, |place| place.map(|at| at - 0.5));
        if let Some((engine, _)) = &mut run.engine {
            engine.frame(&reference, &test, gaze_px)?;
        }
    }
    Ok(())
}

/// A run that goes on.
struct Run {
    policy: Policy,
    engine: Option<(Engine, Viewing)>,
    player: Player,
    gaze: GazeSource,
    reports: Vec<FrameReport>,
}

impl Run {
    /// What it shows; `None` where nothing draws.
    fn picture(&mut self) -> anyhow::Result<Option<ScorePicture>> {
        let Some(report) = self.reports.last() else {
            return Ok(None);
        };
        let picture = self.player.drawer().picture(&report.view, None)?;
        picture.as_ref().map(from_image).transpose()
    }

    /// Writes its log and its figures, and sums it up.
    fn finish(mut self, folder: &Path) -> anyhow::Result<PolicyRun> {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
        let reports = self.reports;
        let log = session(&self.player, &reports).write();
        output::write_whole(&folder.join("session.jsonl"), log.as_bytes())?;
        output::write_whole(&folder.join("frames.csv"), csv(&reports, None).as_bytes())?;
        let name = self.policy.name().to_owned();
        let score = self.engine.map(|(engine, viewing)| {
            let gaze = Some(GazeChoice::Scan.as_judged());
            anyhow::Ok(ScoreReport::judged(
                &viewing,
                Mode::Compat,
                gaze,
                engine.score()?,
            ))
        });
        let summary = RunSummary {
            score: score.transpose()?,
            ..summarise(name, &reports, &mut self.player, &log)
        };
        Ok(PolicyRun { summary, reports })
    }
}

#[cfg(test)]
mod tests {
    use super::super::content::DemoContent;
    use super::super::pictures::ShownFrame;
    use super::*;
    use crate::options::policy::ViewOptions;
    use clap::Parser;
    use foveal_media::generate::GeneratedScene;

    #[derive(Debug, Parser)]
    struct Options {
        #[command(flatten)]
        view: ViewOptions,
    }

    #[test]
    fn a_frame_that_is_played_to_again_is_chosen_as_in_the_run() -> anyhow::Result<()> {
        let out = std::env::temp_dir().join(format!("foveal-again-{}", std::process::id()));
        std::fs::create_dir_all(&out)?;
        let size = [640, 360];
        let content = DemoContent::generated("wide", size, GeneratedScene::wide(size), &out);
        let conditions = DemoConditions {
            view: &Options::parse_from([""]).view,
            drawing: &DrawDevice::Nothing,
            seed: 4,
        };
        let setup = PlaySetup::new(content.prepare(&out)?, &conditions);
        let runs = play_all(&setup)?;
        for frame in (0..setup.frames).step_by(3) {
            let again = ShownFrame::at(&setup, Policy::Perceptual, frame)?
                .report
                .session;
            let first = &runs[FOVEATED].reports[frame as usize].session;
            assert_eq!(again, *first, "frame {frame}");
        }
        std::fs::remove_dir_all(&out)?;
        Ok(())
    }
}
