//! Which score does a pack's content have at which bound?
//!
//! The pack is played to eyes that look at several places, under both rules that choose for a
//! score, at several bounds, and judged against its own finest level. What is drawn comes from the
//! CPU twin, what is judged from the processor, and both are rounded, so that packs do not depend
//! on machine and threads.

mod glimpses;
mod measures;
mod searching;

pub(crate) use glimpses::sphere_width_deg;
pub(crate) use measures::CalibrationExtent;

use crate::commands::score::{display_of_view, picture_of};
use crate::report::output::{self, Counting};
use crate::run::in_parallel::in_parallel;
use crate::run::open_player::open_player;
use anyhow::Context;
use foveal_core::content::policy::calibration::Expectation;
use foveal_core::content::policy::{DEFAULT_TARGET, Policy, PolicyConfig};
use foveal_core::content::video::calibration::{Calibration, CalibrationRow};
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::perception::acuity::AcuityModel;
use foveal_eval::score::pooling::Pool;
use foveal_eval::score::{Judge, Mode, ScorePicture, Viewing};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::{Decoding, FrameOptions, FrameReport, PlayerOptions};
use foveal_render::DrawDevice;
use glimpses::{Density, Glimpse, glimpses_of};
use measures::FoundAtBound;
use searching::{Search, rows_of};
use std::path::Path;
use std::sync::Arc;

/// Steps of a progress bar for each density: drawing, and two rules.
const STEPS_OF_A_DENSITY: u64 = 3;

/// What was found, and what was not looked at.
pub(crate) struct Calibrated {
    pub(crate) calibration: Calibration,
    /// Gazes and frames of some densities, in words; empty if all were looked at.
    pub(crate) left_out: Option<String>,
}

/// A glimpse, and what the finest level shows in it.
struct Seen {
    glimpse: Glimpse,
    full: Vec<ScorePicture>,
}

/// Judges the content of a pack; `None` where it has no signatures to choose by, or is too small
/// for a score.
pub(crate) fn calibrate(
    pack: &Path,
    extent: CalibrationExtent,
    jobs: usize,
) -> anyhow::Result<Option<Calibrated>> {
    let file = Arc::new(PackFile::open(pack)?);
    if file.signatures()?.is_none() {
        return Ok(None);
    }
    let (densities, left_out) = glimpses_of(&file, extent)?;
    let steps = STEPS_OF_A_DENSITY * densities.len() as u64;
    let bar = output::bar(Some(steps), Counting::Steps);
    let found = in_parallel(jobs, &densities, |density| {
        let stage = Stage::new(&file, density, jobs)?;
        bar.inc(1);
        let by_loss = stage.rows(Expectation::ByLoss, extent)?;
        bar.inc(1);
        let elsewise = stage.rows(Expectation::Elsewise, extent)?;
        bar.inc(1);
        Ok((stage.frames(), [by_loss, elsewise].concat()))
    });
    bar.finish_and_clear();
    let found = found?;
    let frames = found.iter().map(|(frames, _)| *frames).max().unwrap_or(0);
    let rows: Vec<CalibrationRow> = found.into_iter().flat_map(|(_, rows)| rows).collect();
    if rows.is_empty() {
        return Ok(None);
    }
    let gazes = densities.iter().map(Density::gazes).max().unwrap_or(1);
    let calibration = Calibration::new(gazes as u16, frames as u16, rows);
    let calibration = calibration.map_err(|expected| anyhow::anyhow!("expected {expected}"))?;
    Ok(Some(Calibrated {
        calibration,
        left_out,
    }))
}

/// One density, with all that is compared there.
struct Stage<'a> {
    file: &'a Arc<PackFile>,
    density: &'a Density,
    viewing: Viewing,
    seen: Vec<Seen>,
    jobs: usize,
}

impl<'a> Stage<'a> {
    /// Draws what the finest level shows.
    fn new(file: &'a Arc<PackFile>, density: &'a Density, jobs: usize) -> anyhow::Result<Self> {
        let about = file.pack().description();
        let display = display_of_view(&density.view, about.projection);
        let fps = (density.frames > 1).then(|| about.fps());
        let viewing = Viewing::new(display, density.view.size, fps, true, Mode::Compat)?;
        let mut stage = Self {
            file,
            density,
            viewing,
            seen: Vec::new(),
            jobs,
        };
        let config = PolicyConfig::new(Policy::Full);
        let draw = |glimpse: &Glimpse| {
            let mut full = Vec::new();
            stage.play(&config, glimpse, &mut |picture, _| {
                full.push(picture);
                Ok(())
            })?;
            Ok(full)
        };
        let drawn = in_parallel(jobs, &density.glimpses, draw)?;
        let pairs = density.glimpses.iter().zip(drawn);
        stage.seen = pairs
            .map(|(glimpse, full)| Seen {
                glimpse: glimpse.clone(),
                full,
            })
            .collect();
        Ok(stage)
    }

    /// Frames of the longest glimpse.
    fn frames(&self) -> usize {
        let frames = self.seen.iter().map(|seen| seen.full.len());
        frames.max().unwrap_or(0)
    }

    /// The scores of one rule at the bounds that are looked for.
    fn rows(
        &self,
        rule: Expectation,
        extent: CalibrationExtent,
    ) -> anyhow::Result<Vec<CalibrationRow>> {
        let mut search = Search::new(rule, extent);
        while let Some(value) = search.next() {
            let found = self.at(&config_of(rule, value))?;
            search.learn(value, found);
        }
        Ok(rows_of(rule, self.density.ppd(), search.found()))
    }

    /// What the judge finds under this policy.
    fn at(&self, config: &PolicyConfig) -> anyhow::Result<FoundAtBound> {
        let judged = in_parallel(self.jobs, &self.seen, |seen| self.judged(config, seen))?;
        let mut found = FoundAtBound::default();
        for one in judged {
            found.jods.extend(one.jods);
            for (all, of_one) in found.zones.iter_mut().zip(one.zones) {
                all.extend(of_one);
            }
            found.losses.add(&one.losses);
            found.shares.extend(one.shares);
            found.bytes.extend(one.bytes);
        }
        Ok(found)
    }

    fn judged(&self, config: &PolicyConfig, seen: &Seen) -> anyhow::Result<FoundAtBound> {
        let mut judge = Judge::new(&self.viewing, 1)?;
        let (mut pool, mut found) = (Pool::default(), FoundAtBound::default());
        let (mut share, mut bytes) = (0.0, 0.0);
        let mut full = seen.full.iter();
        self.play(config, &seen.glimpse, &mut |picture, report| {
            let reference = full.next().context("a picture too many")?;
            pool.add(&judge.frame(reference, &picture, seen.glimpse.gaze_px)?);
            if let Some(expected) = report.expected {
                found.losses.add(&expected.losses);
            }
            share += report.share;
            bytes += self.bytes_of(report.session.frame, &report.tiles);
            Ok(())
        })?;
        let score = pool.score(&[]).context("nothing was judged")?;
        let count = seen.full.len().max(1) as f64;
        found.jods.push(score.jod);
        if let Some(zones) = score.zones {
            let all = [zones.under_5_deg, zones.from_5_to_20_deg, zones.over_20_deg];
            for (zone, of_zone) in found.zones.iter_mut().zip(all) {
                zone.extend(of_zone.map(|zone| zone.jod));
            }
        }
        found.shares.push(share / count);
        found.bytes.push(bytes / count);
        Ok(found)
    }

    /// Shows the frames of a glimpse under a policy.
    fn play(
        &self,
        config: &PolicyConfig,
        glimpse: &Glimpse,
        take: &mut dyn FnMut(ScorePicture, &FrameReport) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let player = PlayerOptions::new(config.clone(), &DrawDevice::Twin, output::say);
        let options = FrameOptions {
            judged: config.policy != Policy::Full,
            decoding: Decoding::on(1),
            ..FrameOptions::new(player, self.density.view)
        };
        let mut player = open_player(self.file, options)?;
        player.begin_at(glimpse.frames.start);
        for frame in glimpse.frames.clone() {
            let look = glimpse.look(player.time(frame));
            let report = player.show(frame, &look)?;
            let picture = picture_of(&mut player, &report.view)?;
            take(picture, &report)?;
        }
        Ok(())
    }

    /// Bytes of these tiles that one frame takes: of each unit its share of the frames.
    fn bytes_of(&self, frame: u32, tiles: &[Tile]) -> f64 {
        let pack = self.file.pack();
        let bytes = tiles.iter().map(|tile| {
            let unit = pack.unit(*tile, frame);
            f64::from(pack.entry(unit).bytes) / pack.frames_of(unit).len().max(1) as f64
        });
        bytes.sum()
    }
}

/// What is played to find the score at one value: of the bound, or of the slope.
fn config_of(rule: Expectation, value: f64) -> PolicyConfig {
    match rule {
        Expectation::ByLoss => PolicyConfig {
            bound: Some(value),
            target: Some(DEFAULT_TARGET),
            ..PolicyConfig::new(Policy::Perceptual)
        },
        Expectation::Elsewise => PolicyConfig {
            acuity: AcuityModel::linear(value),
            ..PolicyConfig::new(Policy::Acuity)
        },
    }
}
