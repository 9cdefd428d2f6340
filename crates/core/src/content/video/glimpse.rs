//! What was found of the losses of one glance, and what of it holds for the next choice?
//!
//! A loss is found when it is asked for: of most cells that of one level or two. It stays as long
//! as the glance and the group of frames are the same; what the eye senses at a place outlasts the
//! group, and a head that turns while its eye stays adds only what comes into sight.

use crate::content::video::calibration::{ZONES, ZoneBounds, ZoneLosses, zone_of};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::places::{APART_DEG, CellPlace, Sighted};
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::losses::{
    Around, LossMeter, Losses, MOST_OCTAVES, drawn_share, lost_octaves, octave_share,
};
use crate::content::video::units::VideoUnits;
use crate::pack::unit::UnitId;
use crate::perception::glance::Glance;
use crate::perception::measures::contrast::Signature;
use crate::perception::spread::SpreadTable;
use crate::perception::visible_loss::{LostOctave, SPACE_EXPONENT, Sensed};
use crate::units::Radians;

/// Places of which it is kept what the eye senses there: 9 MB. A view of a 16K sphere has 4,000.
const MOST_SENSED: usize = 50_000;
/// A loss that was not asked for yet.
const UNKNOWN: f64 = f64::NAN;

/// Losses of one glance, as far as they were asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Glimpse {
    looked: Option<Looked>,
    /// A unit of the group, whose signatures are known: groups of coarser levels change with those
    /// of the finest.
    group: Option<UnitId>,
    spread: Option<(Radians, SpreadTable)>,
    losses: Losses,
    /// Cells in sight, in the order of the grid: those of the right eye come second.
    seen: Vec<Option<Box<SeenCell>>>,
    /// Places in sight so far.
    places: usize,
}

/// What is sensed depends on this.
#[derive(Clone, Debug, PartialEq)]
struct Looked {
    glance: Glance,
    bounds: Option<ZoneBounds>,
}

/// What is seen of a cell.
#[derive(Clone, Debug)]
struct SeenCell {
    in_view: bool,
    /// Log2 of the level-0 pixels on a side that a pixel of the display covers, at the least.
    footprint: f64,
    places: Vec<SeenPlace>,
    /// What is sensed at each place, once it was asked for, and whether it is kept.
    sensed: Vec<SensedPlace>,
    keeps_sensed: bool,
    /// Of the steps, finest first; empty where they were not asked for.
    signatures: Vec<Signature>,
}

#[derive(Clone, Copy, Debug)]
struct SeenPlace {
    place: CellPlace,
    pixels: f64,
    eccentricity: Radians,
}

#[derive(Clone, Copy, Debug)]
struct SensedPlace {
    octaves: [Sensed; MOST_OCTAVES],
    zone: usize,
    /// What a loss counts under the bound of the place.
    of_bound: f64,
}

impl Glimpse {
    /// The losses of one glance. What is known of them is kept here as far as it is the same.
    pub(super) fn look<'a>(
        &'a mut self,
        meter: &'a LossMeter,
        grid: &'a TileGrid,
        (content, frame): (&'a dyn VideoUnits, u32),
        around: &Around<'a>,
    ) -> Finder<'a> {
        let group = content.unit(grid.tile_at(0, 0), frame);
        let group = content.has_signatures().then_some(group);
        if self.group != group {
            self.group = group;
            self.losses.forget();
            let seen = self.seen.iter_mut().flatten();
            seen.for_each(|cell| cell.signatures.clear());
        }
        let looked = Looked {
            glance: *around.glance,
            bounds: around.bounds,
        };
        let is_same = self.looked.as_ref() == Some(&looked);
        if !is_same {
            let spread = self.spread.take();
            *self = Self {
                group,
                spread: spread.filter(|(spread, _)| *spread == looked.glance.gaze.spread),
                losses: Losses::unknown(grid, looked.bounds.is_some()),
                seen: vec![None; meter.cells.len()],
                looked: Some(looked),
                places: 0,
            };
        }
        let spread = around.glance.gaze.spread;
        let spread = self
            .spread
            .get_or_insert_with(|| (spread, SpreadTable::new(spread)));
        let mut finder = Finder {
            losses: &mut self.losses,
            seen: &mut self.seen,
            places: &mut self.places,
            spread: &spread.1,
            sighted: Sighted::new(around.glance),
            around: *around,
            meter,
            grid,
            content,
            frame,
        };
        finder.see(is_same);
        finder
    }

    /// What was found.
    pub(super) fn into_losses(self) -> Losses {
        self.losses
    }
}

/// Finds losses that are not known yet.
pub(super) struct Finder<'a> {
    losses: &'a mut Losses,
    seen: &'a mut [Option<Box<SeenCell>>],
    places: &'a mut usize,
    spread: &'a SpreadTable,
    sighted: Sighted<'a>,
    around: Around<'a>,
    meter: &'a LossMeter,
    grid: &'a TileGrid,
    content: &'a dyn VideoUnits,
    frame: u32,
}

impl Finder<'_> {
    /// Whether a cell may be shown at `level`; see [`Losses::is_within`].
    pub(super) fn is_within(&mut self, rank: usize, level: u8, most: f64) -> bool {
        self.find(rank, level);
        self.losses.is_within(rank, level, most)
    }

    /// Whether a cell is not in view: what is seen of it is how it fades into the picture, or what
    /// a turning head shows at its border, and for that it may be one level coarser than it might
    /// be in view.
    pub(super) fn is_beside(&self, rank: usize) -> bool {
        !self.losses.in_view[rank]
    }

    /// What a picture loses against the finest when its cells are shown at these levels.
    pub(super) fn of(&mut self, shown: &LevelMap) -> ZoneLosses {
        for (rank, level) in shown.levels().iter().enumerate() {
            if self.losses.in_view[rank] {
                self.find(rank, *level);
            }
        }
        self.losses.of(shown)
    }

    /// Finds the losses of all cells at all levels.
    pub(super) fn find_all(&mut self) {
        let cells = 0..self.losses.cells;
        let levels = 1..self.grid.levels;
        cells.for_each(|rank| levels.clone().for_each(|level| self.find(rank, level)));
    }

    /// Looks where the cells are; of the same glance only what is beside the view may be new.
    fn see(&mut self, is_same: bool) {
        let Around { glance, room, .. } = self.around;
        let near = Sighted::up_to(glance, Radians(border_of(self.grid).0 + room.0));
        for (number, cell) in self.meter.cells.iter().enumerate() {
            let before = self.seen[number].as_ref();
            if is_same && before.is_some_and(|before| before.in_view) {
                continue;
            }
            let mut places: Vec<&CellPlace> = match is_same {
                true => Vec::new(),
                false => self.sighted.places(cell).collect(),
            };
            let in_view = !places.is_empty();
            if !in_view {
                places.extend(near.places(cell));
            }
            if places.len() != before.map_or(0, |before| before.places.len()) {
                let seen = self.seen_cell(&places, in_view);
                *self.places += seen.places.len();
                self.seen[number] = Some(Box::new(seen));
                self.note(number);
            }
        }
    }

    fn seen_cell(&self, places: &[&CellPlace], in_view: bool) -> SeenCell {
        let footprints = places.iter().map(|place| self.sighted.footprint(place));
        let footprint = footprints.fold(f64::INFINITY, f64::min);
        let seen_place = |place: &&CellPlace| SeenPlace {
            place: **place,
            pixels: self.sighted.pixels(place),
            eccentricity: self.around.glance.eccentricity(place.direction),
        };
        SeenCell {
            in_view,
            footprint: libm::log2(footprint),
            places: places.iter().map(seen_place).collect(),
            sensed: Vec::new(),
            keeps_sensed: *self.places < MOST_SENSED,
            signatures: Vec::new(),
        }
    }

    /// Notes what is seen of a cell, whose losses are not known.
    fn note(&mut self, number: usize) {
        let cells = self.losses.cells;
        let rank = number % cells;
        let (mut pixels, mut in_view) = (0.0, false);
        for seen in self.seen.iter().skip(rank).step_by(cells).flatten() {
            in_view |= seen.in_view;
            seen.places.iter().for_each(|place| pixels += place.pixels);
        }
        self.losses.pixels[rank] = pixels;
        self.losses.in_view[rank] = in_view;
        let seen = self.seen[number].as_ref().filter(|seen| seen.in_view);
        for place in seen.iter().flat_map(|seen| &seen.places) {
            self.losses.shown[zone_of(place.eccentricity)] += place.pixels;
        }
        for level in 1..usize::from(self.grid.levels) {
            self.losses.sums[level * cells + rank] = [UNKNOWN; ZONES];
        }
    }

    /// Finds what a cell loses at a level, unless that is known.
    fn find(&mut self, rank: usize, level: u8) {
        let cells = self.losses.cells;
        let at = usize::from(level) * cells + rank;
        if !self.losses.sums[at][0].is_nan() {
            return;
        }
        let (mut sums, mut bounded) = ([0.0; ZONES], 0.0);
        for number in (rank..self.seen.len()).step_by(cells) {
            let Some(mut cell) = self.seen[number].take() else {
                continue;
            };
            if cell.signatures.is_empty() {
                cell.signatures = self.signatures(self.meter.cells[number].cell);
            }
            let sensed = match cell.sensed.is_empty() {
                true => self.sense(&cell),
                false => core::mem::take(&mut cell.sensed),
            };
            let lost = self.lost(&cell, &sensed, level);
            for (place, sensed) in cell.places.iter().zip(&sensed) {
                let seen = sensed.octaves.iter().zip(&lost);
                let seen: f64 = seen.map(|(sensed, lost)| sensed.difference(lost)).sum();
                if seen > 0.0 {
                    let loss = place.pixels * libm::pow(seen, SPACE_EXPONENT);
                    sums[sensed.zone] += loss;
                    bounded += loss * sensed.of_bound;
                }
            }
            if cell.keeps_sensed {
                cell.sensed = sensed;
            }
            self.seen[number] = Some(cell);
        }
        self.losses.sums[at] = sums;
        if let Some(it) = self.losses.bounded.get_mut(at) {
            *it = bounded;
        }
    }

    /// What the finer steps add to a cell, finest first.
    fn signatures(&self, cell: Tile) -> Vec<Signature> {
        let signature = |level| {
            let unit = self
                .content
                .unit(self.grid.tile_over(cell, level), self.frame);
            self.content.signature(unit).unwrap_or_default()
        };
        (0..self.grid.coarsest()).map(signature).collect()
    }

    /// What is sensed at the places of a cell.
    fn sense(&self, cell: &SeenCell) -> Vec<SensedPlace> {
        let of_place = |seen: &SeenPlace| {
            let effective = self.spread.effective(seen.eccentricity);
            let bound = self.around.bounds.map(|bounds| bounds.at(effective));
            let ppd = self.sighted.seen(&seen.place).ppd;
            let display = self.sighted.display_limit(&seen.place);
            SensedPlace {
                octaves: self.meter.sensed(effective, ppd, display),
                zone: zone_of(seen.eccentricity),
                of_bound: bound.map_or(0.0, |bound| libm::pow(bound, -SPACE_EXPONENT)),
            }
        };
        cell.places.iter().map(of_place).collect()
    }

    /// What a level of a cell loses of each octave that any of its places senses.
    fn lost(
        &self,
        cell: &SeenCell,
        sensed: &[SensedPlace],
        level: u8,
    ) -> [LostOctave; MOST_OCTAVES] {
        let steps = self.grid.ratio.trailing_zeros() as usize;
        let is_noisy = self.content.tells_of_noise();
        let drawn = |step, octave| match is_noisy {
            true => octave_share(octave, cell.footprint),
            false => drawn_share(step, cell.footprint, steps),
        };
        let is_sensed = |octave: usize| sensed.iter().any(|it| !it.octaves[octave].is_blind());
        let signatures = &cell.signatures[..usize::from(level)];
        lost_octaves(signatures, steps, drawn, core::array::from_fn(is_sensed))
    }
}

impl Losses {
    /// Losses of which nothing is known, of cells out of sight.
    fn unknown(grid: &TileGrid, has_bounds: bool) -> Self {
        let cells = grid.tiles_of_left_eye(0).count();
        let all = cells * usize::from(grid.levels);
        Self {
            cells,
            sums: vec![[0.0; ZONES]; all],
            bounded: vec![0.0; if has_bounds { all } else { 0 }],
            pixels: vec![0.0; cells],
            in_view: vec![false; cells],
            shown: [0.0; ZONES],
        }
    }

    /// Nothing is known any more of cells in sight.
    fn forget(&mut self) {
        let finer = self.sums.iter_mut().skip(self.cells);
        let in_sight = finer.zip(self.pixels.iter().cycle());
        for (sums, _) in in_sight.filter(|(_, pixels)| **pixels > 0.0) {
            *sums = [UNKNOWN; ZONES];
        }
    }
}

/// How far outside the view a cell is seen fading into it, or lies in view between its places.
fn border_of(grid: &TileGrid) -> Radians {
    Radians(grid.fade().0 + Radians::from_degrees(APART_DEG / 2.0).0)
}
