//! Which losses of a glance are known, and which are kept for the next choice?
//!
//! A loss is found when it is asked for: of most cells that of one level or two. It stays as long
//! as the glance and the group of frames are the same, so that a head that turns while its eye
//! stays adds only what comes into sight.

use crate::content::video::calibration::{ZONES, ZoneBounds, ZoneLosses, zone_of};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::places::{APART_DEG, CellPlace, Sighted};
use crate::content::video::grid::tile_grid::TileGrid;
use crate::content::video::losses::{
    LossMeter, Losses, MOST_OCTAVES, drawn_share, lost_octaves, octave_share,
};
use crate::content::video::units::VideoUnits;
use crate::pack::unit::UnitId;
use crate::perception::glance::Glance;
use crate::perception::measures::contrast::Signature;
use crate::perception::spread::SpreadTable;
use crate::perception::visible_loss::{LostOctave, SPACE_EXPONENT, Sensed};
use crate::units::Radians;
use core::ops::Range;

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
    seen: Seen,
}

/// What is seen and sensed of the cells in sight.
#[derive(Clone, Debug, Default)]
struct Seen {
    /// In the order of the grid: those of the right eye come second.
    cells: Vec<SeenCell>,
    places: Vec<SeenPlace>,
    sensed: Vec<SensedPlace>,
    signatures: Vec<Signature>,
}

/// What is sensed depends on this.
#[derive(Clone, Debug, PartialEq)]
struct Looked {
    glance: Glance,
    bounds: Option<ZoneBounds>,
}

/// What is seen of a cell: parts of [`Seen`].
#[derive(Clone, Copy, Debug, Default)]
struct SeenCell {
    in_view: bool,
    /// Log2 of the level-0 pixels on a side that a pixel of the display covers, at the least.
    footprint: f64,
    /// Its first place, and how many it has; none out of sight.
    first: usize,
    places: usize,
    /// Where what is sensed at its places begins, once that was asked for.
    sensed: Option<usize>,
    /// Where the signatures of its steps begin, finest first, once they were asked for.
    signatures: Option<usize>,
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

/// What losses are asked of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<'a> {
    /// Who looks, through which view.
    pub(super) glance: &'a Glance,
    /// How far a head may turn while the eye stays.
    pub(super) room: Radians,
    /// What no cell may lose, where each zone has its own bound.
    pub(super) bounds: Option<ZoneBounds>,
}

impl<'a> Around<'a> {
    /// What is in view, without bounds.
    fn only(glance: &'a Glance) -> Self {
        Self {
            glance,
            room: Radians(0.0),
            bounds: None,
        }
    }
}

impl LossMeter {
    /// The losses of one glance. Costs a few µs a cell in view.
    #[must_use]
    pub fn losses(
        &self,
        grid: &TileGrid,
        content: &dyn VideoUnits,
        frame: u32,
        glance: &Glance,
    ) -> Losses {
        let around = Around::only(glance);
        let mut glimpse = Glimpse::default();
        let mut losses = glimpse.look(self, grid, (content, frame), &around);
        losses.find_all();
        glimpse.into_losses()
    }

    /// What the picture of one glance loses at these levels. Costs less than its losses.
    #[must_use]
    pub fn lost(
        &self,
        grid: &TileGrid,
        (content, frame): (&dyn VideoUnits, u32),
        glance: &Glance,
        shown: &LevelMap,
    ) -> ZoneLosses {
        let mut glimpse = Glimpse::default();
        let mut losses = glimpse.look(self, grid, (content, frame), &Around::only(glance));
        losses.of(shown)
    }
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
            self.seen.forget_signatures();
        }
        let looked = Looked {
            glance: *around.glance,
            bounds: around.bounds,
        };
        let is_same = self.looked.as_ref() == Some(&looked);
        if !is_same {
            self.losses.clear(grid, looked.bounds.is_some());
            self.seen.clear(meter.cells.len());
            self.looked = Some(looked);
        }
        let spread = around.glance.gaze.spread;
        let known = self.spread.take().filter(|(of, _)| *of == spread);
        let known = known.unwrap_or_else(|| (spread, SpreadTable::new(spread)));
        let (_, spread) = self.spread.insert(known);
        let mut finder = Finder {
            losses: &mut self.losses,
            seen: &mut self.seen,
            spread,
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

    /// Keeps nothing but what a spread of the gaze makes of eccentricities.
    pub(super) fn forget(&mut self) {
        *self = Self {
            spread: self.spread.take(),
            ..Self::default()
        };
    }

    /// Keeps what was found, and no more: a viewer should hold little.
    pub(super) fn trim(&mut self) {
        self.seen.forget_signatures();
        self.seen.forget_sensed();
        self.seen.signatures.shrink_to_fit();
        self.seen.sensed.shrink_to_fit();
        self.seen.places.shrink_to_fit();
    }

    /// What was found.
    pub(super) fn into_losses(self) -> Losses {
        self.losses
    }
}

/// Finds losses that are not known yet.
pub(super) struct Finder<'a> {
    losses: &'a mut Losses,
    seen: &'a mut Seen,
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

    /// Looks where the cells are; of the same glance only what is outside the view may be new.
    fn see(&mut self, is_same: bool) {
        let Around { glance, room, .. } = self.around;
        let near = Sighted::up_to(glance, Radians(border_of(self.grid).0 + room.0));
        let meter = self.meter;
        let mut places: Vec<&CellPlace> = Vec::new();
        for (number, cell) in meter.cells.iter().enumerate() {
            let before = self.seen.cells[number];
            if is_same && before.in_view {
                continue;
            }
            places.clear();
            if !is_same {
                places.extend(self.sighted.places(cell));
            }
            let in_view = !places.is_empty();
            if !in_view {
                places.extend(near.places(cell));
            }
            // Room only grows: as many places are the same ones.
            if places.len() != before.places {
                self.seen.cells[number] = self.seen_cell(&places, in_view);
                self.note(number);
            }
        }
    }

    fn seen_cell(&mut self, places: &[&CellPlace], in_view: bool) -> SeenCell {
        let footprints = places.iter().map(|place| self.sighted.footprint(place));
        let footprint = footprints.fold(f64::INFINITY, f64::min);
        let seen_place = |place: &&CellPlace| SeenPlace {
            place: **place,
            pixels: self.sighted.pixels(place),
            eccentricity: self.around.glance.eccentricity(place.direction),
        };
        let first = self.seen.places.len();
        self.seen.places.extend(places.iter().map(seen_place));
        SeenCell {
            in_view,
            footprint: libm::log2(footprint),
            first,
            places: places.len(),
            ..SeenCell::default()
        }
    }

    /// Notes what is seen of a cell, whose losses are not known.
    fn note(&mut self, number: usize) {
        let cells = self.losses.cells;
        let rank = number % cells;
        let (mut pixels, mut in_view) = (0.0, false);
        for cell in self.seen.cells.iter().skip(rank).step_by(cells) {
            in_view |= cell.in_view;
            let places = self.seen.places_of(cell).iter();
            places.for_each(|place| pixels += place.pixels);
        }
        self.losses.pixels[rank] = pixels;
        self.losses.in_view[rank] = in_view;
        let cell = &self.seen.cells[number];
        let places = cell.in_view.then(|| self.seen.places_of(cell));
        for place in places.unwrap_or_default() {
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
        for number in (rank..self.seen.cells.len()).step_by(cells) {
            let mut cell = self.seen.cells[number];
            let first = *cell.signatures.get_or_insert_with(|| self.read(number));
            let places = cell.first..cell.first + cell.places;
            let sensed = *cell.sensed.get_or_insert_with(|| self.sense(places));
            let sensed = &self.seen.sensed[sensed..][..cell.places];
            let signatures = &self.seen.signatures[first..][..usize::from(level)];
            let lost = self.lost(cell.footprint, signatures, sensed);
            for (place, sensed) in self.seen.places_of(&cell).iter().zip(sensed) {
                let seen = sensed.octaves.iter().zip(&lost);
                let seen: f64 = seen.map(|(sensed, lost)| sensed.difference(lost)).sum();
                if seen > 0.0 {
                    let loss = place.pixels * libm::pow(seen, SPACE_EXPONENT);
                    sums[sensed.zone] += loss;
                    bounded += loss * sensed.of_bound;
                }
            }
            if self.seen.sensed.len() > MOST_SENSED {
                self.seen.forget_sensed();
                cell.sensed = None;
            }
            self.seen.cells[number] = cell;
        }
        self.losses.sums[at] = sums;
        if let Some(it) = self.losses.bounded.get_mut(at) {
            *it = bounded;
        }
    }

    /// Reads what the finer steps add to a cell, and returns where it lies.
    fn read(&mut self, number: usize) -> usize {
        let cell = self.meter.cells[number].cell;
        let signature = |level| {
            let tile = self.grid.tile_over(cell, level);
            let unit = self.content.unit(tile, self.frame);
            self.content.signature(unit).unwrap_or_default()
        };
        let first = self.seen.signatures.len();
        let all = (0..self.grid.coarsest()).map(signature);
        self.seen.signatures.extend(all);
        first
    }

    /// Finds what is sensed at these places, and returns where it lies.
    fn sense(&mut self, places: Range<usize>) -> usize {
        // Few places lie between two zones, so that neighbours have the same bound.
        let mut last = ([f64::NAN; ZONES - 1], 0.0);
        let of_place = |seen: &SeenPlace| {
            let effective = self.spread.effective(seen.eccentricity);
            let passed = ZoneBounds::borders_passed(effective);
            if let Some(bounds) = self.around.bounds.filter(|_| last.0 != passed) {
                last = (passed, libm::pow(bounds.beyond(passed), -SPACE_EXPONENT));
            }
            let ppd = self.sighted.seen(&seen.place).ppd;
            let display = self.sighted.display_limit(&seen.place);
            SensedPlace {
                octaves: self.meter.sensed(effective, ppd, display),
                zone: zone_of(seen.eccentricity),
                of_bound: last.1,
            }
        };
        let first = self.seen.sensed.len();
        let places = self.seen.places[places].iter();
        self.seen.sensed.extend(places.map(of_place));
        first
    }

    /// What is lost without these steps of each octave that any place of a cell senses.
    fn lost(
        &self,
        footprint: f64,
        signatures: &[Signature],
        sensed: &[SensedPlace],
    ) -> [LostOctave; MOST_OCTAVES] {
        let steps = self.grid.ratio.trailing_zeros() as usize;
        let is_noisy = self.content.tells_of_noise();
        let drawn = |step, octave| match is_noisy {
            true => octave_share(octave, footprint),
            false => drawn_share(step, footprint, steps),
        };
        let is_sensed = |octave: usize| sensed.iter().any(|it| !it.octaves[octave].is_blind());
        lost_octaves(signatures, steps, drawn, core::array::from_fn(is_sensed))
    }
}

impl Seen {
    /// Nothing is in sight of so many cells.
    fn clear(&mut self, cells: usize) {
        self.cells.clear();
        self.cells.resize(cells, SeenCell::default());
        self.places.clear();
        self.sensed.clear();
        self.signatures.clear();
    }

    fn places_of(&self, cell: &SeenCell) -> &[SeenPlace] {
        &self.places[cell.first..][..cell.places]
    }

    fn forget_signatures(&mut self) {
        self.signatures.clear();
        let cells = self.cells.iter_mut();
        cells.for_each(|cell| cell.signatures = None);
    }

    fn forget_sensed(&mut self) {
        self.sensed.clear();
        self.cells.iter_mut().for_each(|cell| cell.sensed = None);
    }
}

impl Losses {
    /// All cells are out of sight.
    fn clear(&mut self, grid: &TileGrid, has_bounds: bool) {
        let cells = grid.tiles_of_left_eye(0).count();
        let all = cells * usize::from(grid.levels);
        self.cells = cells;
        self.sums.clear();
        self.sums.resize(all, [0.0; ZONES]);
        self.bounded.clear();
        self.bounded.resize(if has_bounds { all } else { 0 }, 0.0);
        self.pixels.clear();
        self.pixels.resize(cells, 0.0);
        self.in_view.clear();
        self.in_view.resize(cells, false);
        self.shown = [0.0; ZONES];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::policy::{Policy, PolicyConfig};
    use crate::content::video::grid::tile_grid::{Cut, Tile};
    use crate::content::video::units::UnknownUnits;
    use crate::gaze::sample::GazeSample;
    use crate::perception::measures::cues::Cues;
    use crate::perception::parameters::EyeState;
    use crate::units::Seconds;
    use crate::view::axes::Axes;
    use crate::view::eye_view::{EyeView, Field};
    use crate::view::random::Random;
    use crate::view::surface::{Eye, Surface};

    /// Content of which every unit adds something else; groups are a frame long.
    #[derive(Debug)]
    struct Mixed(UnknownUnits);

    impl VideoUnits for Mixed {
        fn has_signatures(&self) -> bool {
            true
        }

        fn unit(&self, tile: Tile, frame: u32) -> UnitId {
            UnitId(self.0.unit(tile, 0).0 | frame << 16)
        }

        fn next_group(&self, frame: u32) -> Option<u32> {
            Some(frame + 1)
        }

        fn bytes(&self, _: UnitId) -> u32 {
            1
        }

        fn signature(&self, unit: UnitId) -> Option<Signature> {
            let mut random = Random::new(u64::from(unit.0));
            let mut code = || (100.0 + 80.0 * random.unit()) as u8;
            Some(Signature::from_bytes(core::array::from_fn(|_| code())))
        }

        fn cues(&self, _: UnitId) -> Option<Cues> {
            None
        }
    }

    fn glance(random: &mut Random) -> Glance {
        let size = [900, 700];
        let turned = Radians(random.unit());
        let view = EyeView {
            position: Default::default(),
            axes: Axes::from_yaw_pitch_roll(turned, turned, turned),
            field: Field::across(Radians::from_degrees(80.0), size),
            size,
            eye: Eye::Left,
        };
        let yaw = Radians(turned.0 + 0.3 * random.unit());
        Glance {
            gaze: GazeSample::at(Seconds(0.0), yaw, turned),
            view: Some(view),
            state: EyeState::Steady,
        }
    }

    #[test]
    fn losses_found_bit_by_bit_over_many_frames_are_those_found_at_once() {
        let mut random = Random::new(7);
        for surface in [Surface::cube(512), Surface::cube(512).for_two_eyes()] {
            let grid = TileGrid::new(surface, Cut::Tile(64), 4, 2).unwrap();
            let content = Mixed(UnknownUnits::new(grid));
            let config = PolicyConfig::new(Policy::Perceptual);
            let meter = LossMeter::new(&grid, &config.perception);
            let (mut glance, mut room, mut frame) = (glance(&mut random), 0.0, 0);
            let mut kept = Glimpse::default();
            for step in 0..60_u32 {
                match step % 6 {
                    0 => (glance, room) = (self::glance(&mut random), 0.0),
                    3 => frame += 1,
                    _ => room += 0.1,
                }
                let zones = [0.5, 0.4, 0.8].map(|bound| bound + f64::from(step / 18 % 2));
                let around = Around {
                    glance: &glance,
                    room: Radians(room),
                    bounds: (step / 9 % 2 == 0).then_some(ZoneBounds(zones)),
                };
                let mut losses = kept.look(&meter, &grid, (&content, frame), &around);
                for _ in 0..100 {
                    let rank = random.unit() * losses.losses.cells as f64;
                    let level = 1.0 + random.unit() * 3.0;
                    let _ = losses.is_within(rank as usize, level as u8, 1.0);
                }
                let mut found = kept.clone();
                let looks = |glimpse: &mut Glimpse| {
                    let mut losses = glimpse.look(&meter, &grid, (&content, frame), &around);
                    losses.find_all();
                };
                let mut alone = Glimpse::default();
                looks(&mut found);
                looks(&mut alone);
                assert_eq!(found.losses, alone.losses, "{step}");
                assert!(found.losses.in_view.contains(&true));
            }
        }
    }

    #[test]
    fn what_is_sensed_of_a_large_picture_is_not_all_kept() {
        let grid = TileGrid::new(Surface::cube(5120), Cut::Tile(64), 4, 2).unwrap();
        let content = Mixed(UnknownUnits::new(grid));
        let config = PolicyConfig::new(Policy::Perceptual);
        let meter = LossMeter::new(&grid, &config.perception);
        let everywhere = Glance {
            view: None,
            ..glance(&mut Random::new(1))
        };
        let around = Around {
            glance: &everywhere,
            room: Radians(0.0),
            bounds: None,
        };
        let mut glimpse = Glimpse::default();
        let mut losses = glimpse.look(&meter, &grid, (&content, 0), &around);
        losses.find_all();
        assert!(glimpse.seen.places.len() > 6 * MOST_SENSED);
        assert!(glimpse.seen.sensed.len() <= MOST_SENSED);
    }
}
