//! What do coded tiles show, and what does each step from one level to the next add to it?
//!
//! Signatures are measured on what is decoded, against what the next coarser level decodes to, so
//! that what coding does to either is in them. A group of the coarsest level is longer than those
//! above it, which wait for it.

use crate::error::MediaError;
use crate::parallel::in_parallel;
use crate::tiles::decode::GroupDecoder;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::grid::tile_grid::TileGrid;
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::signature::{LumaPlane, StepMeter};
use foveal_core::view::picture::{Colour, Picture};
use std::collections::VecDeque;

/// The luma of those frames of a group that count.
pub(crate) type ShownGroup = Vec<Vec<u8>>;

/// What tiles show, as long as levels next to theirs need it.
pub(crate) struct DecodedGroups {
    grid: TileGrid,
    meter: StepMeter,
    codec: Codec,
    /// Frames in a full group of the finest level.
    finest_group: usize,
    /// Of each level, by rank of the tile, groups that are not measured yet, or that finer ones
    /// are not measured against yet.
    waiting: Vec<Vec<VecDeque<ShownGroup>>>,
}

impl DecodedGroups {
    pub(crate) fn new(grid: &TileGrid, colour: Colour, codec: Codec, groups: &[u32]) -> Self {
        let empty = |level| vec![VecDeque::new(); grid.tiles_in_level(level) as usize];
        Self {
            grid: *grid,
            meter: StepMeter::new(colour, grid.ratio),
            codec,
            finest_group: groups.first().map_or(1, |frames| *frames as usize),
            waiting: (0..grid.levels).map(empty).collect(),
        }
    }

    /// What a group shows that was coded from `pictures`: the first, every second and the last of
    /// as many frames as a group of the finest level has.
    pub(crate) fn decoded(
        &self,
        units: &[Vec<u8>],
        pictures: Vec<Picture>,
    ) -> Result<ShownGroup, MediaError> {
        let (Some(first), true) = (pictures.first(), self.grid.levels > 1) else {
            return Ok(Vec::new());
        };
        let size = [first.width, first.height];
        let last = pictures.len() - 1;
        let counts = |frame: usize| {
            let place = frame % self.finest_group;
            frame == last || place.is_multiple_of(2) || place + 1 == self.finest_group
        };
        // What can be coded here and not decoded counts as lossless.
        let decoder = match self.codec {
            Codec::Png => None,
            codec => GroupDecoder::new(codec, size).ok(),
        };
        let Some(mut decoder) = decoder else {
            let all = (0..).zip(pictures).filter(|(frame, _)| counts(*frame));
            return Ok(all
                .map(
                    |(
                        _,
                        Picture {
                            planes: [luma, ..], ..
                        },
                    )| luma,
                )
                .collect());
        };
        let mut shown = Vec::new();
        for (frame, unit) in units.iter().enumerate() {
            match counts(frame) {
                true => {
                    let (Picture { planes, .. }, _) = decoder.decode(unit, frame as i64)?;
                    let [luma, ..] = planes;
                    shown.push(luma);
                }
                false => decoder.skip(unit, frame as i64)?,
            }
        }
        Ok(shown)
    }

    /// Takes what the next group of a tile shows.
    pub(crate) fn push(&mut self, level: u8, rank: u32, group: ShownGroup) {
        self.waiting[usize::from(level)][rank as usize].push_back(group);
    }

    /// What the groups of the level above `level` add that a group of `level`, the last that came
    /// of each tile, lies under: in the order of their units. They are forgotten.
    pub(crate) fn measured(&mut self, level: u8, jobs: usize) -> Vec<Signature> {
        let Some(finer) = level.checked_sub(1) else {
            return Vec::new();
        };
        let tiles = &self.waiting[usize::from(finer)];
        let count = tiles.iter().map(VecDeque::len).max().unwrap_or(0);
        let all = (0..count).flat_map(|group| (0..tiles.len()).map(move |rank| (group, rank)));
        let all: Vec<(usize, usize)> = all.collect();
        let signatures = in_parallel(jobs, all.len(), |k| {
            let (group, rank) = all[k];
            self.step(finer, rank, group)
        });
        self.waiting[usize::from(finer)]
            .iter_mut()
            .for_each(VecDeque::clear);
        if level == self.grid.coarsest() {
            self.waiting[usize::from(level)]
                .iter_mut()
                .for_each(VecDeque::clear);
        }
        signatures
    }

    /// What one group adds, over the frames that count.
    fn step(&self, level: u8, rank: usize, group: usize) -> Signature {
        let groups = &self.waiting[usize::from(level)][rank];
        let (tile, grid) = (self.grid.tile_at(level, rank as u32), &self.grid);
        let under = grid.tile_over(tile, level + 1);
        let (origin, from) = (grid.origin(tile), grid.origin(under));
        let at = [0, 1].map(|k| (origin[k] - from[k]) / grid.scale(level));
        let (size, coarse_size) = (grid.tile_size(tile), grid.tile_size(under));
        let under = &self.waiting[usize::from(level) + 1][grid.rank(under) as usize];
        // Both end with the same frame; what of the coarser one came before was measured against.
        let from_group: usize = groups.iter().skip(group).map(Vec::len).sum();
        let all: usize = under.iter().map(Vec::len).sum();
        let under = under.iter().flatten().skip(all - from_group.min(all));
        let steps = groups.get(group).into_iter().flatten().zip(under);
        let signatures = steps.map(|(fine, coarse)| {
            let coarse = LumaPlane {
                codes: coarse,
                size: coarse_size,
            };
            self.meter
                .signature(coarse, LumaPlane { codes: fine, size }, at)
        });
        signatures.fold(Signature::default(), Signature::strongest)
    }
}
