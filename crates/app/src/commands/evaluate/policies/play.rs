//! How are many policies played over one gaze, and judged against one full picture?

use crate::commands::evaluate::policies::contenders::Contender;
use crate::commands::evaluate::policies::measure::{Measure, Reference, SpanFigures};
use crate::commands::score::{LastGaze, picture_of};
use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel};
use crate::report::output::{self, Counting};
use crate::run::open_player::open_player;
use crate::run::source_frames::SourceFrames;
use anyhow::Context;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Screen;
use foveal_eval::score::Viewing;
use foveal_media::pack::pack_file::PackFile;
use foveal_play::{FrameOptions, FramePlayer, FrameReport, PlayerOptions};
use foveal_render::DrawDevice;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Policies that are played side by side: a judge of 1920x1080 at 60 Hz holds 0.4 GB.
const AT_ONCE: usize = 8;

/// What all policies share.
pub(super) struct Comparison<'a> {
    pub(super) file: Arc<PackFile>,
    /// What it was made from.
    pub(super) source: Option<&'a Path>,
    pub(super) view: EyeView,
    pub(super) screen: Screen,
    pub(super) drawing: DrawDevice,
    pub(super) viewing: Viewing,
    pub(super) gaze: &'a GazeChoice,
    pub(super) seed: u64,
    /// Frames that figures are of; the last one ends where playing does.
    pub(super) spans: Vec<Range<u32>>,
}

/// A policy that is being played.
struct Run {
    player: FramePlayer,
    measure: Measure,
}

impl Comparison<'_> {
    /// The figures of every span of every contender.
    pub(super) fn play(&self, contenders: &[Contender]) -> anyhow::Result<Vec<Vec<SpanFigures>>> {
        let frames = self.spans.iter().map(|span| span.end).max().unwrap_or(0);
        let turns = contenders.len().div_ceil(AT_ONCE) as u64;
        let bar = output::bar(Some(u64::from(frames) * turns), Counting::Frames);
        let mut all = Vec::new();
        for turn in contenders.chunks(AT_ONCE) {
            all.extend(self.turn(turn, frames, &mut || bar.inc(1))?);
        }
        bar.finish_and_clear();
        Ok(all)
    }

    /// Plays some of them frame by frame, each first as often, so that other work on the machine
    /// touches all alike.
    fn turn(
        &self,
        contenders: &[Contender],
        frames: u32,
        played: &mut dyn FnMut(),
    ) -> anyhow::Result<Vec<Vec<SpanFigures>>> {
        let mut full = self.player(PolicyConfig::new(Policy::Full), f64::INFINITY)?;
        let open = |source| SourceFrames::open(source, &self.file, self.screen);
        let mut source = self.source.map(open).transpose()?;
        let runs = contenders.iter().map(|contender| self.run(contender));
        let mut runs = runs.collect::<anyhow::Result<Vec<Run>>>()?;
        let mut gaze = GazeSource::new(
            self.gaze,
            &full.grid().surface,
            self.seed,
            full.time(frames - 1),
            &ViewerModel::default(),
        )?;
        let mut last_gaze = LastGaze::new(&self.view);
        for frame in 0..frames {
            let look = gaze.look(full.time(frame));
            let whole = full.show(frame, &look)?;
            let of_source = source
                .as_mut()
                .map(|source| source.seen(frame, &[whole.view]));
            let reference = Reference {
                full: picture_of(&mut full, &whole.view)?,
                source: of_source.transpose()?.and_then(|mut seen| seen.pop()),
                gaze_px: last_gaze.at(&whole),
            };
            let count = runs.len();
            for turn in 0..count {
                let Run { player, measure } = &mut runs[(frame as usize + turn) % count];
                let report: FrameReport = player.show(frame, &look)?;
                measure.took(&self.file, &report, &whole);
                let test = picture_of(player, &report.view)?;
                measure.looked(frame, &reference, &test)?;
            }
            played();
        }
        let figures = |run: &Run| run.measure.figures().context("no frame was played");
        runs.iter().map(figures).collect()
    }

    fn run(&self, contender: &Contender) -> anyhow::Result<Run> {
        let has_source = self.source.is_some();
        let jobs = output::jobs(None)?;
        let config = contender.config.clone();
        Ok(Run {
            player: self.player(config, contender.bytes_per_s())?,
            measure: Measure::new(&self.spans, &self.viewing, has_source, jobs)?,
        })
    }

    fn player(&self, config: PolicyConfig, bytes_per_s: f64) -> anyhow::Result<FramePlayer> {
        let player = PlayerOptions {
            bytes_per_s,
            ..PlayerOptions::new(config, &self.drawing, output::say)
        };
        let options = FrameOptions {
            screen: self.screen,
            ..FrameOptions::new(player, self.view)
        };
        open_player(&self.file, options)
    }
}
