//! What does a video take, prepared and played in one way?

use crate::options::policy_choice::policy_parser;
use crate::options::preset::SystemPreset;
use crate::report::output::{self, Counting, out_of_range};
use crate::run::kept_pack::plan_of;
use crate::run::timed::{Conditions, FrameTimes, Run, Way};
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::content::policy::Policy;
use foveal_core::view::surface::{Projection, Screen};
use foveal_media::pack::pack_file::PackFile;
use foveal_media::prepare::{PrepareSettings, prepare};
use foveal_media::tiles::decoders::DecoderChoice;
use foveal_play::Decoding;
use foveal_render::DrawDevice;
use serde::Serialize;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// What every experiment asks.
#[derive(Clone, Debug, Args)]
pub(super) struct TrialOptions {
    /// Whatever FFmpeg reads.
    pub(super) input: PathBuf,
    /// Frames that are prepared, and played round and round; 1 to 10000.
    #[arg(long, value_name = "N", default_value_t = 64)]
    pub(super) frames: u32,
    /// Frames that are played of every pack; 10 to 100000.
    #[arg(long, value_name = "N", default_value_t = 180)]
    play: u32,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// How the foveated frames are chosen (default: acuity, or the preset's).
    #[arg(long, value_parser = policy_parser())]
    policy: Option<Policy>,
    /// Seed of the gaze, which jumps every ninth frame to anywhere.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the packs, which go away at the end (default: the system's for such).
    #[arg(long, value_name = "DIR")]
    scratch: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// A folder that goes away with the value.
pub(super) struct Scratch(pub(super) PathBuf);

impl Scratch {
    /// An empty folder of this run's own, in `base` or where the system has such.
    pub(super) fn new(base: Option<&Path>) -> anyhow::Result<Self> {
        let base = base.map_or_else(std::env::temp_dir, Path::to_owned);
        let folder = base.join(format!("foveal-evaluate-{}", std::process::id()));
        leave_nothing_when_stopped(&folder)?;
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
        Ok(Self(folder))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // Nothing to be done about what cannot be removed.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Removes the folder when the user, or the system, ends the program.
fn leave_nothing_when_stopped(folder: &Path) -> anyhow::Result<()> {
    let folder = folder.to_owned();
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || {
            for signal in &mut signals {
                // Nothing to be done about what cannot be removed.
                let _ = std::fs::remove_dir_all(&folder);
                // Ends the program as if there were no handler.
                let _ = signal_hook::low_level::emulate_default_handler(signal);
            }
        })?;
    Ok(())
}

/// Packs on disk and how fast they play.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Trial {
    /// Frames that were prepared.
    #[serde(skip)]
    pub(super) frames: u32,
    pub(super) prepare_s: f64,
    /// Source pixels prepared a second, in millions.
    pub(super) prepare_mpix_per_s: f64,
    pub(super) bytes: u64,
    /// Finest level first.
    pub(super) bytes_per_level: Vec<u64>,
    /// What chose the foveated frames.
    pub(super) policy: &'static str,
    /// Mean share of the pixels of foveated frames, of those of the finest level.
    pub(super) pixels_share_mean: f64,
    /// Foveated frames a second, choosing and decoding: half of the frames are faster.
    pub(super) foveated_fps_median: f64,
    /// Of the frames on which the gaze jumped, one in twenty is slower.
    pub(super) foveated_saccade_fps_p5: f64,
    /// The same under `grid`, the rule of Kastner 2016 for panoramas.
    pub(super) grid_pixels_share_mean: f64,
    pub(super) grid_fps_median: f64,
    pub(super) grid_saccade_fps_p5: f64,
    /// Frames a second with every finest tile, and with the coarsest level alone.
    pub(super) full_fps: f64,
    pub(super) coarsest_fps: f64,
    pub(super) late_frames: u32,
    pub(super) incomplete_frames: u32,
}

/// Frames that are played of the baseline, which decodes everything.
const FULL_FRAMES: u32 = 9;

impl TrialOptions {
    /// Threads, once the numbers have been checked.
    pub(super) fn jobs(&self) -> anyhow::Result<usize> {
        if !(1..=10_000).contains(&self.frames) {
            bail!(out_of_range("--frames", self.frames, "1 to 10000"));
        }
        if !(10..=100_000).contains(&self.play) {
            bail!(out_of_range("--play", self.play, "10 to 100000"));
        }
        Ok(output::jobs(self.jobs)?)
    }

    /// An empty folder of this run's own.
    pub(super) fn scratch(&self) -> anyhow::Result<Scratch> {
        Scratch::new(self.scratch.as_deref())
    }

    /// Prepares the input, plays it and removes the pack again.
    pub(super) fn trial(
        &self,
        settings: &PrepareSettings,
        system: Option<SystemPreset>,
        scratch: &Scratch,
    ) -> anyhow::Result<Trial> {
        let pack = scratch.0.join("trial.foveal");
        let plan = plan_of(&self.input, settings)?;
        let bar = output::bar(Some(u64::from(self.frames)), Counting::Frames);
        let begun = Instant::now();
        let prepared = prepare(&self.input, &pack, &plan, &mut |progress| {
            bar.set_position(u64::from(progress.frames));
        });
        bar.finish_and_clear();
        let prepared = prepared?;
        let prepare_s = begun.elapsed().as_secs_f64();
        let about = &prepared.description;
        let [width, height] = about.source.size.map(f64::from);
        let pixels = width * height * f64::from(about.frames);
        let played = self.play(&pack, &self.way(system, about.projection));
        std::fs::remove_file(&pack)
            .with_context(|| format!("{}: cannot be removed", pack.display()))?;
        Ok(Trial {
            prepare_s,
            prepare_mpix_per_s: pixels / prepare_s / 1e6,
            bytes: prepared.bytes,
            frames: about.frames,
            ..played?
        })
    }

    /// How the foveated frames are chosen.
    fn way(&self, system: Option<SystemPreset>, projection: Projection) -> Way {
        match (self.policy, system) {
            (Some(policy), _) => Way::under(policy),
            (None, Some(system)) => system.way(projection),
            (None, None) => Way::under(Policy::Acuity),
        }
    }

    fn play(&self, pack: &Path, way: &Way) -> anyhow::Result<Trial> {
        let conditions = Conditions {
            file: Arc::new(PackFile::open(pack)?),
            drawing: &DrawDevice::Nothing,
            screen: Screen::default(),
            decoding: Decoding {
                jobs: self.jobs()?,
                choice: DecoderChoice::Software,
            },
            seed: self.seed,
        };
        let run = |way: &Way, frames| -> anyhow::Result<Run> {
            let mut run = conditions.run(way, false)?;
            run.turn(frames)?;
            Ok(run)
        };
        let foveated = run(way, self.play)?;
        let grid = run(&Way::under(Policy::Grid), self.play)?;
        Ok(Trial {
            policy: way.config.policy.name(),
            frames: 0,
            prepare_s: 0.0,
            prepare_mpix_per_s: 0.0,
            bytes: 0,
            bytes_per_level: bytes_per_level(&conditions.file),
            pixels_share_mean: foveated.share(),
            foveated_fps_median: median_fps(&foveated),
            foveated_saccade_fps_p5: saccade_fps(&foveated),
            grid_pixels_share_mean: grid.share(),
            grid_fps_median: median_fps(&grid),
            grid_saccade_fps_p5: saccade_fps(&grid),
            full_fps: run(&Way::under(Policy::Full), FULL_FRAMES.min(self.play))?.decoding[0],
            coarsest_fps: run(&Way::under(Policy::Coarsest), self.play)?.decoding[0],
            late_frames: foveated.late,
            incomplete_frames: foveated.incomplete,
        })
    }
}

fn bytes_per_level(file: &PackFile) -> Vec<u64> {
    let pack = file.pack();
    let mut bytes = vec![0; usize::from(pack.grid().levels)];
    for unit in pack.units() {
        bytes[usize::from(pack.tile_of(unit).level)] += u64::from(pack.entry(unit).bytes);
    }
    bytes
}

/// Frames a second that half of the frames of a run reach.
fn median_fps(run: &Run) -> f64 {
    fps_at(50, run.frames.iter().map(FrameTimes::seconds))
}

/// Frames a second that all but one in twenty of those reach on which the gaze jumped.
fn saccade_fps(run: &Run) -> f64 {
    let jumps = run.frames.iter().filter(|frame| frame.jumped);
    fps_at(5, jumps.map(FrameTimes::seconds))
}

/// Frames a second that all but `percent` of a hundred frames reach.
fn fps_at(percent: usize, seconds: impl Iterator<Item = f64>) -> f64 {
    let mut rates: Vec<f64> = seconds.map(|seconds| 1.0 / seconds).collect();
    rates.sort_by(f64::total_cmp);
    rates
        .get(rates.len() * percent / 100)
        .copied()
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_frame_in_twenty_is_slower_than_the_fifth_percentile() {
        let seconds = (1..=100).map(|k| 1.0 / f64::from(k));
        assert_eq!(fps_at(5, seconds.clone()), 6.0);
        assert_eq!(fps_at(50, seconds), 51.0);
        assert_eq!(fps_at(50, std::iter::empty()), 0.0);
    }
}
