//! How does one content play under each policy?

use crate::commands::demo::video::judging::{Scorer, judged_frames, pictures};
use crate::commands::demo::video::moment::PicturedMoment;
use crate::commands::demo::video::pictures::Pictures;
use crate::commands::demo::video::setup::PlaySetup;
use crate::commands::score::ScoreReport;
use crate::commands::simulate::session;
use crate::commands::simulate::summary::{RunSummary, csv, summarise};
use crate::gaze_source::GazeSource;
use crate::report::output::{self, Counting};
use crate::run::source_frames::SourceFrames;
use anyhow::Context;
use foveal_core::content::policy::Policy;
use foveal_play::{FramePlayer, FrameReport};
use foveal_render::DrawDevice;
use std::path::Path;

/// What is compared, baselines first: columns of tables, classes of the style sheet.
pub(crate) const COLUMNS: [&str; 3] = ["full", "viewport", "auto"];
/// Index in [`COLUMNS`] of what the others are judged by.
pub(crate) const FULL: usize = 0;
/// Index of what the industry ships.
pub(crate) const VIEWPORT: usize = 1;
/// Index of what is judged.
pub(crate) const FOVEATED: usize = 2;

/// One run under one policy.
pub(crate) struct PolicyRun {
    pub(crate) summary: RunSummary,
    /// Against the source.
    pub(crate) source_score: Option<ScoreReport>,
    pub(crate) reports: Vec<FrameReport>,
}

/// Content that was played under all policies.
pub(crate) struct Played {
    /// In the order of [`COLUMNS`].
    pub(crate) runs: Vec<PolicyRun>,
    /// Display time of every picture in seconds.
    pub(crate) times: Vec<f64>,
    pub(crate) moment: PicturedMoment,
    pub(crate) pictures: Pictures,
    /// Frames that were judged, or pictures of a still.
    pub(crate) judged: u32,
}

/// Plays content under every policy in this one run, then makes the pictures; logs go to folders
/// whose names begin with `name`.
pub(crate) fn play(
    setup: &PlaySetup<'_>,
    (out, name): (&Path, &str),
    budget: usize,
) -> anyhow::Result<Played> {
    let played = play_all(setup, name)?;
    let mut runs = Vec::new();
    for (run, column) in played.runs.into_iter().zip(COLUMNS) {
        runs.push(run.finish(&out.join(format!("{name}-{column}")))?);
    }
    runs[FOVEATED].summary.policy_chosen = Some(setup.chosen.name());
    let reports = &runs[FOVEATED].reports;
    let moment = PicturedMoment::choose(reports);
    output::say(&format!(
        "{name}: the pictures of frame {} are made",
        moment.frame
    ));
    let pictures = Pictures::take(setup, moment.frame, &reports[moment.frame as usize], budget)?;
    Ok(Played {
        times: played.times,
        judged: played.judged,
        runs,
        moment,
        pictures,
    })
}

/// All runs, and what they share.
struct PlayedRuns {
    runs: Vec<Run>,
    times: Vec<f64>,
    judged: u32,
}

/// All policies take turns, frame by frame and each first as often, so that other work on the
/// machine touches all alike.
fn play_all(setup: &PlaySetup<'_>, name: &str) -> anyhow::Result<PlayedRuns> {
    let policies = [Policy::Full, Policy::Viewport, setup.chosen];
    let runs = policies.into_iter().map(|policy| Run::start(setup, policy));
    let mut runs = runs.collect::<anyhow::Result<Vec<Run>>>()?;
    let mut judging = Judging::open(setup, &mut runs)?;
    let words = COLUMNS.join(", ");
    output::say(&format!(
        "{name}: plays under {words} (here {})",
        setup.chosen.name()
    ));
    let bar = output::bar(Some(u64::from(setup.pictures)), Counting::Frames);
    let mut times = Vec::new();
    for picture in 0..setup.pictures {
        let frame = setup.shown.frame(picture);
        let time = setup.shown.time(picture, &runs[FULL].player);
        times.push(time.0);
        for turn in 0..runs.len() {
            let run = &mut runs[(picture as usize + turn) % COLUMNS.len()];
            let look = run.gaze.look(time);
            run.reports.push(run.player.show(frame, &look)?);
        }
        if let Some(judging) = judging.as_mut().filter(|it| it.is_due(picture)) {
            judging.judge(&mut runs, frame)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(PlayedRuns {
        runs,
        times,
        judged: judging.map_or(0, |it| it.frames),
    })
}

/// Which pictures are judged, and by what.
struct Judging {
    source: SourceFrames,
    frames: u32,
    /// Pictures from one that is judged to the next.
    every: u32,
}

impl Judging {
    /// Opens the judges of all runs; `None` where nothing draws or no score is known.
    fn open(setup: &PlaySetup<'_>, runs: &mut [Run]) -> anyhow::Result<Option<Self>> {
        if matches!(setup.conditions.drawing, DrawDevice::Nothing) {
            return Ok(None);
        }
        let views = setup.views();
        let frames = judged_frames(&views).min(setup.pictures);
        let projection = runs[FULL].player.grid().surface.projection;
        for (at, run) in runs.iter_mut().enumerate() {
            let open = || Scorer::open(&views, projection, setup.judged_fps());
            if at != FULL {
                run.against_full = open()?;
            }
            if at != VIEWPORT {
                run.against_source = open()?;
            }
        }
        if runs[FOVEATED].against_full.is_none() {
            return Ok(None);
        }
        let content = setup.content;
        Ok(Some(Self {
            source: SourceFrames::planned(
                &content.source,
                &content.file,
                &content.plan,
                setup.conditions.view.screen,
                output::jobs(None)?,
            )?,
            frames,
            // A still is looked at all over; a film is judged as it moves.
            every: match setup.judged_fps() {
                None => setup.pictures / frames,
                Some(_) => 1,
            },
        }))
    }

    fn is_due(&self, picture: u32) -> bool {
        let first = self.every / 2;
        picture >= first
            && (picture - first).is_multiple_of(self.every)
            && (picture - first) / self.every < self.frames
    }

    /// Judges what was shown last of every run: against the first, which shows every finest tile,
    /// and against the source.
    fn judge(&mut self, runs: &mut [Run], frame: u32) -> anyhow::Result<()> {
        let Some(full) = runs[FULL].pictures()? else {
            return Ok(());
        };
        let views = runs[FULL].reports.last().map(|it| it.views.clone());
        let source = self.source.seen(frame, &views.unwrap_or_default())?;
        for (at, run) in runs.iter_mut().enumerate() {
            let own = match at {
                FULL => None,
                _ => run.pictures()?,
            };
            let test = own.as_ref().unwrap_or(&full);
            let Some(report) = run.reports.last() else {
                continue;
            };
            if let Some(scorer) = &mut run.against_full {
                scorer.frame(&full, test, report)?;
            }
            if let Some(scorer) = &mut run.against_source {
                scorer.frame(&source, test, report)?;
            }
        }
        Ok(())
    }
}

/// A run that goes on.
struct Run {
    player: FramePlayer,
    gaze: GazeSource,
    against_full: Option<Scorer>,
    against_source: Option<Scorer>,
    reports: Vec<FrameReport>,
}

impl Run {
    fn start(setup: &PlaySetup<'_>, policy: Policy) -> anyhow::Result<Self> {
        let (player, gaze) = setup.player(policy)?;
        Ok(Self {
            player,
            gaze,
            against_full: None,
            against_source: None,
            reports: Vec::new(),
        })
    }

    /// What its views show; `None` where nothing draws.
    fn pictures(&mut self) -> anyhow::Result<Option<Vec<foveal_eval::score::ScorePicture>>> {
        match self.reports.last() {
            Some(report) => pictures(&mut self.player, &report.views),
            None => Ok(None),
        }
    }

    /// Writes its log and its figures, and sums it up.
    fn finish(mut self, folder: &Path) -> anyhow::Result<PolicyRun> {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
        let reports = self.reports;
        let log = session(&self.player, &reports).write();
        output::write_whole(&folder.join("session.jsonl"), log.as_bytes())?;
        output::write_whole(&folder.join("frames.csv"), csv(&reports, None).as_bytes())?;
        let lowest = |scorer: Option<Scorer>| match scorer {
            Some(scorer) => scorer.lowest(),
            None => Ok(None),
        };
        let policy = self.player.config().policy.name().to_owned();
        let summary = RunSummary {
            score: lowest(self.against_full)?,
            ..summarise(policy, &reports, &mut self.player, &log)
        };
        Ok(PolicyRun {
            summary,
            source_score: lowest(self.against_source)?,
            reports,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::content::VideoContent;
    use super::super::pictures::ShownFrame;
    use super::super::setup::DemoConditions;
    use super::*;
    use crate::options::policy::ViewOptions;
    use crate::run::scene_clip::write_scene;
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
        let (size, clip) = ([640, 360], out.join("wide.mkv"));
        write_scene(&GeneratedScene::wide(size), size, 12, &clip)?;
        let content = VideoContent::file("wide".to_owned(), clip).prepare(&out, None)?;
        let conditions = DemoConditions {
            view: &Options::parse_from([""]).view,
            drawing: &DrawDevice::Nothing,
            seed: 4,
        };
        let setup = PlaySetup::new(&content, &conditions, Vec::new())?;
        let runs = play_all(&setup, "wide")?.runs;
        for picture in (0..setup.pictures).step_by(3) {
            let again = ShownFrame::at(&setup, setup.chosen, picture)?;
            let first = &runs[FOVEATED].reports[picture as usize].session;
            assert_eq!(again.report.session, *first, "picture {picture}");
        }
        std::fs::remove_dir_all(&out)?;
        Ok(())
    }
}
