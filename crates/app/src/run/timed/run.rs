//! How fast is a pack played under one policy, and is it in time?

use crate::run::timed::eye::{DWELL, JumpingEye};
use crate::run::timed::parts::FrameTimes;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::direction_at;
use foveal_core::view::eye_view::EyeView;
use foveal_media::tiles::decoders::DeviceUse;
use foveal_play::{FramePlayer, FrameReport};
use glam::DVec3;
use std::time::Instant;

/// Frames of a turn that are drawn: a software driver takes far longer for it than for all else.
const DRAWN_OF_TURN: u32 = 3;
/// Radius of the fovea in degrees.
const FOVEA_DEG: f64 = 2.5;
/// Directions in which the fovea's rim is probed.
const RIM: u32 = 12;

/// A player, its viewer, and what its frames took.
pub(crate) struct Run {
    player: FramePlayer,
    eye: JumpingEye,
    /// What the picture is drawn for, which may be smaller than what levels are chosen for.
    drawn: EyeView,
    frames_of_pack: u32,
    next: u32,
    /// What every frame took.
    pub(crate) frames: Vec<FrameTimes>,
    /// Of every turn, frames a second.
    pub(crate) decoding: Vec<f64>,
    pub(crate) end_to_end: Vec<f64>,
    pub(crate) shares: Vec<f64>,
    /// Frames whose time was over before they could be shown.
    pub(crate) late: u32,
    /// Frames shown with a coarser tile in the place of one that was chosen.
    pub(crate) incomplete: u32,
    /// Of every saccade, the frames until the fovea showed its level.
    pub(crate) to_fovea: Vec<u32>,
    waiting: Option<u32>,
}

impl Run {
    pub(crate) fn new(
        player: FramePlayer,
        eye: JumpingEye,
        drawn: EyeView,
        frames_of_pack: u32,
    ) -> Self {
        Self {
            player,
            eye,
            drawn,
            frames_of_pack,
            next: 0,
            frames: Vec::new(),
            decoding: Vec::new(),
            end_to_end: Vec::new(),
            shares: Vec::new(),
            late: 0,
            incomplete: 0,
            to_fovea: Vec::new(),
            waiting: None,
        }
    }

    /// Plays `frames` more, draws some of them, and notes the frames a second of choosing and
    /// decoding, and of all that a picture takes.
    pub(crate) fn turn(&mut self, frames: u32) -> anyhow::Result<()> {
        let first = self.frames.len();
        let (mut playing, mut drawing) = (0.0, 0.0);
        let every = frames.div_ceil(DRAWN_OF_TURN);
        for number in 0..frames {
            let begun = Instant::now();
            let mut report = self.frame()?;
            playing += begun.elapsed().as_secs_f64();
            let is_drawn = number.is_multiple_of(every);
            if is_drawn {
                let view = EyeView {
                    axes: report.view.axes,
                    ..self.drawn
                };
                self.player.draw(&view, &mut report)?;
                drawing += report.draw.as_secs_f64();
            }
            self.note(&report, is_drawn);
        }
        let drawn = frames.div_ceil(every);
        let frame = playing / f64::from(frames) + drawing / f64::from(drawn);
        let decoding: f64 = self.frames[first..].iter().map(FrameTimes::seconds).sum();
        self.decoding.push(f64::from(frames) / decoding);
        self.end_to_end.push(1.0 / frame);
        Ok(())
    }

    fn frame(&mut self) -> anyhow::Result<FrameReport> {
        // The clip loops, time does not.
        let frame = self.next % self.frames_of_pack;
        let length = self.player.time(self.frames_of_pack - 1).0;
        let nominal = length / f64::from((self.frames_of_pack - 1).max(1));
        let time = Seconds(f64::from(self.next) * nominal);
        self.next += 1;
        Ok(self.player.show(frame, &self.eye.next(time))?)
    }

    fn note(&mut self, report: &FrameReport, is_drawn: bool) {
        let jumped = (self.next - 1).is_multiple_of(DWELL);
        self.frames.push(FrameTimes::of(report, is_drawn, jumped));
        self.shares.push(report.share);
        self.late += u32::from(report.late);
        self.incomplete += u32::from(!report.missing.is_empty());
        if jumped {
            // A jump that never arrived took at least as long as it lasted.
            self.to_fovea.extend(self.waiting);
            self.waiting = Some(0);
        }
        if let Some(frames) = &mut self.waiting {
            *frames += 1;
            let gaze = report.gaze.gaze_in_content;
            if !meets_fovea(self.player.grid(), &report.missing, gaze) {
                self.to_fovea.extend(self.waiting.take());
            }
        }
    }

    /// Mean share of the pixels.
    pub(crate) fn share(&self) -> f64 {
        self.shares.iter().sum::<f64>() / self.shares.len().max(1) as f64
    }

    /// Frames until the fovea showed its level, of 95 of 100 saccades.
    pub(crate) fn to_fovea_p95(&self) -> u32 {
        let mut frames = self.to_fovea.clone();
        frames.sort_unstable();
        let p95 = (frames.len() * 95).div_ceil(100).max(1) - 1;
        frames.get(p95).copied().unwrap_or_default()
    }

    /// What a graphics device decoded so far.
    pub(crate) fn device_use(&self) -> DeviceUse {
        self.player.device_use()
    }

    pub(crate) fn gpu_bytes(&mut self) -> u64 {
        self.player.drawer().gpu_bytes()
    }
}

/// Whether one of the tiles lies in the disc of the fovea, probed at its centre and on two rings.
fn meets_fovea(grid: &TileGrid, tiles: &[Tile], gaze: DVec3) -> bool {
    let ring = |radius_deg: f64| {
        (0..RIM).map(move |k| {
            let bearing = Radians(f64::from(k) / f64::from(RIM) * std::f64::consts::TAU);
            direction_at(gaze, bearing, Radians::from_degrees(radius_deg))
        })
    };
    let places = std::iter::once(gaze)
        .chain(ring(FOVEA_DEG / 2.0))
        .chain(ring(FOVEA_DEG));
    let mut places = places.filter_map(|direction| grid.surface.locate(direction));
    places.any(|(face, place)| {
        let cell = grid.cell_at(face, place);
        tiles
            .iter()
            .any(|tile| grid.tile_over(cell, tile.level) == *tile)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::content::video::grid::tile_grid::Cut;
    use foveal_core::view::surface::Surface;

    #[test]
    fn a_tile_beside_the_gaze_is_in_the_fovea_and_one_far_away_is_not() -> anyhow::Result<()> {
        let grid = TileGrid::new(Surface::cube(4096), Cut::Tile(256), 5, 2)?;
        let at = |place| grid.cell_at(0, place);
        // The gaze is on the corner of four tiles; 2.5° are 89 pixels there.
        let near = [[2000.0, 2000.0], [2100.0, 2100.0]].map(at);
        let far = [[1700.0, 2000.0], [2400.0, 2100.0]].map(at);
        for tile in near {
            assert!(meets_fovea(&grid, &[tile], DVec3::NEG_Z));
        }
        assert!(!meets_fovea(&grid, &far, DVec3::NEG_Z));
        Ok(())
    }
}
