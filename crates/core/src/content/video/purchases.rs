//! Which tiles does a budget buy, frame after frame?
//!
//! Tiles of a pyramid are units of one step; a finer tile wants the coarser one under it first,
//! unless what is held already shows that place as well. They are bought for what is shown now and
//! for the groups of frames that begin next, each for as long as it will be shown. What is not
//! shown in the end (four children hide their parent) is not bought.

use crate::content::demand::Offer;
use crate::content::policy::PolicyConfig;
use crate::content::video::calibration::{Scale, ZoneLosses};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::losses::{LossMeter, Losses};
use crate::content::video::rules::Selection;
use crate::content::video::units::VideoUnits;
use crate::content::video::worth::{Gains, Worth};
use crate::pack::unit::UnitId;
use crate::perception::glance::Glance;
use crate::perception::moment::Moment;
use std::collections::BTreeSet;

/// Weight of a frame of the next groups, where one of these counts 1: the eye may move by then.
const AHEAD: f64 = 0.7;

/// What is bought of a video under a policy that spends a budget, and what it is worth.
#[derive(Clone, Debug)]
pub(super) struct Purchases {
    grid: TileGrid,
    config: PolicyConfig,
    worth: Worth,
    /// Measures the score, where buying stops at one.
    meter: Option<LossMeter>,
    /// All tiles of the left eye but those of the coarsest level, coarsest first; each is bought
    /// together with the same tile of the right eye. Each is two steps: now, and in the groups that
    /// begin next.
    tiles: Vec<Tile>,
    /// Number of the first tile of each level, by level.
    first: Vec<u32>,
    /// The two units of each tile that were bought last.
    held: Vec<[Option<UnitId>; 2]>,
    /// The times that are bought for.
    horizons: Vec<Horizon>,
}

/// One time that is bought for.
#[derive(Clone, Debug)]
struct Horizon {
    frame: u32,
    /// What a gain there counts.
    weight: f64,
    gains: Gains,
    /// Through each view, where buying stops at a score.
    losses: Vec<Losses>,
    /// What brings these to scores, through each view.
    scales: Vec<Scale>,
    /// What is held for it and worth showing.
    shown: LevelMap,
    /// How far each view is from the score, with what this round would buy.
    goals: Vec<Goal>,
}

/// How far one time is from the score at which buying stops.
#[derive(Clone, Debug)]
struct Goal {
    levels: LevelMap,
    /// What is lost at these levels.
    lost: ZoneLosses,
}

impl Goal {
    fn new(losses: &Losses, shown: &LevelMap) -> Self {
        Self {
            levels: shown.clone(),
            lost: losses.of(shown),
        }
    }

    /// A tile is shown besides.
    fn add(&mut self, losses: &Losses, grid: &TileGrid, tile: Tile) {
        for cell in grid.cells_under(tile) {
            let (rank, was) = (grid.rank(cell) as usize, self.levels.level(grid, cell));
            if tile.level < was {
                let [less, more] = [tile.level, was].map(|level| losses.sum(rank, level));
                for (lost, (less, more)) in self.lost.sums.iter_mut().zip(less.iter().zip(more)) {
                    *lost += less - more;
                }
                self.levels.refine(grid, cell, tile.level);
            }
        }
    }
}

impl Purchases {
    /// Holds nothing but the coarsest level. The meter is for where buying stops at a score.
    pub(super) fn new(
        grid: TileGrid,
        config: PolicyConfig,
        worth: Worth,
        meter: Option<LossMeter>,
    ) -> Self {
        let finer = (0..grid.coarsest()).rev();
        let tiles: Vec<Tile> = finer
            .flat_map(|level| grid.tiles_of_left_eye(level))
            .collect();
        let mut first = vec![0; usize::from(grid.levels)];
        for (number, tile) in (0..).zip(&tiles) {
            if tile.x == 0 && tile.y == 0 && tile.face == 0 {
                first[usize::from(tile.level)] = number;
            }
        }
        Self {
            worth,
            meter,
            held: vec![[None; 2]; tiles.len()],
            horizons: Vec::new(),
            grid,
            config,
            tiles,
            first,
        }
    }

    /// For every step those that it needs first: the coarser tile under it, for the same time.
    pub(super) fn steps(&self) -> Vec<Vec<u32>> {
        let parent = |tile: &Tile| {
            let above = tile.level + 1;
            let tile = (above < self.grid.coarsest()).then(|| self.grid.tile_over(*tile, above));
            tile.map(|tile| self.first[usize::from(above)] + self.grid.rank(tile))
        };
        let of_tile = |tile: &Tile| {
            let parent = parent(tile);
            [0, 1].map(|which| parent.iter().map(|number| 2 * number + which).collect())
        };
        self.tiles.iter().flat_map(of_tile).collect()
    }

    /// Looks at what to buy for: this frame and, where bytes are scarce, the first of the next
    /// groups.
    pub(super) fn begin(
        &mut self,
        content: &dyn VideoUnits,
        frame: u32,
        moment: &Moment,
        budget: Option<u64>,
    ) {
        let [now, next] = [Some(frame), content.next_group(frame)];
        let left = next.map_or(1, |next| next - frame);
        let length = next.and_then(|next| content.next_group(next).map(|end| end - next));
        let ahead = AHEAD * f64::from(length.unwrap_or(left));
        let times = [
            (now, f64::from(left)),
            (next.filter(|_| budget.is_some()), ahead),
        ];
        let known = times
            .into_iter()
            .filter_map(|(frame, weight)| Some((frame?, weight)));
        self.horizons = known
            .map(|(frame, weight)| {
                let through = |glance| self.through(content, frame, &glance);
                let views: Vec<(Gains, Option<Losses>)> = moment.glances().map(through).collect();
                let (gains, losses): (Vec<Gains>, Vec<Option<Losses>>) = views.into_iter().unzip();
                let gains = Gains::highest(gains);
                Horizon {
                    frame,
                    weight,
                    shown: self.shown(content, frame, &gains),
                    losses: losses.into_iter().flatten().collect(),
                    scales: moment
                        .glances()
                        .map(|glance| content.scale(glance.view.as_ref()))
                        .collect(),
                    gains,
                    goals: Vec::new(),
                }
            })
            .collect();
        self.begin_round();
    }

    /// What steps add and what is lost without them, through one view.
    fn through(
        &self,
        content: &dyn VideoUnits,
        frame: u32,
        glance: &Glance,
    ) -> (Gains, Option<Losses>) {
        let mut gains = self.worth.gains(&self.grid, content, frame, glance);
        let meter = self.meter.as_ref();
        let losses = meter.map(|meter| meter.losses(&self.grid, content, frame, glance));
        if let Some(losses) = &losses {
            gains.rise_where_lost(&self.grid, losses);
        }
        (gains, losses)
    }

    fn begin_round(&mut self) {
        for horizon in &mut self.horizons {
            let goals = horizon.losses.iter();
            let goals = goals.map(|losses| Goal::new(losses, &horizon.shown));
            horizon.goals = goals.collect();
        }
    }

    /// What every step costs and is worth, after what was bought so far.
    pub(super) fn offers(&self, content: &dyn VideoUnits) -> Vec<Offer> {
        let mut offers = vec![Offer::default(); 2 * self.tiles.len()];
        for (which, horizon) in self.horizons.iter().enumerate() {
            for (number, tile) in self.tiles.iter().enumerate() {
                let unit = content.unit(*tile, horizon.frame);
                let over = |tile| horizon.gains.over(&self.grid, tile, &horizon.shown);
                let gain: f64 = self.grid.for_every_eye(*tile).map(over).sum();
                offers[2 * number + which] = Offer {
                    is_held: self.holds(number, unit),
                    bytes: self.bytes(content, *tile, horizon.frame),
                    value: horizon.weight * gain,
                };
            }
        }
        offers
    }

    /// Whether a time is not at its score yet with the steps that were asked for before this one:
    /// what it reaches its score without is left out.
    pub(super) fn is_missed(&mut self, step: u32) -> bool {
        let (number, which) = (step as usize / 2, step as usize % 2);
        let horizon = self.horizons.get_mut(which);
        let is_missed = horizon
            .as_ref()
            .is_none_or(|horizon| !horizon.is_reached(&self.config));
        if let Some(horizon) = horizon.filter(|_| is_missed) {
            for (goal, losses) in horizon.goals.iter_mut().zip(&horizon.losses) {
                goal.add(losses, &self.grid, self.tiles[number]);
            }
        }
        is_missed
    }

    /// Buys those of the steps that will be seen, and returns their bytes.
    pub(super) fn buy(&mut self, content: &dyn VideoUnits, steps: &[u32]) -> u64 {
        let mut bytes = 0;
        for which in 0..self.horizons.len() {
            let horizon = &self.horizons[which];
            let frame = horizon.frame;
            let here = steps.iter().filter(|step| **step as usize % 2 == which);
            let numbers: Vec<usize> = here.map(|step| *step as usize / 2).collect();
            for number in self.needed(&numbers, &horizon.shown) {
                let unit = content.unit(self.tiles[number], frame);
                if !self.holds(number, unit) {
                    self.keep(content, number, unit);
                    bytes += u64::from(self.bytes(content, self.tiles[number], frame));
                }
            }
        }
        if bytes > 0 {
            for which in 0..self.horizons.len() {
                let Horizon { frame, gains, .. } = &self.horizons[which];
                self.horizons[which].shown = self.shown(content, *frame, gains);
            }
        }
        self.begin_round();
        bytes
    }

    /// Whether the last glance reaches the target, and so do the next groups as far as they are
    /// bought for.
    pub(super) fn has_reached(&self) -> bool {
        // A round begins with what is shown.
        let mut horizons = self.horizons.iter();
        !self.horizons.is_empty() && horizons.all(|horizon| horizon.is_reached(&self.config))
    }

    /// What to show of the frame that was looked at last.
    pub(super) fn selection(&self) -> Selection {
        let shown = self.horizons.first().map(|horizon| horizon.shown.clone());
        let coarsest = || LevelMap::filled(&self.grid, self.grid.coarsest());
        let levels = shown.unwrap_or_else(coarsest);
        let tiles = shown_tiles(&self.grid, &levels);
        Selection { levels, tiles }
    }

    fn number(&self, tile: Tile) -> usize {
        let tile = self.grid.for_left_eye(tile);
        (self.first[usize::from(tile.level)] + self.grid.rank(tile)) as usize
    }

    /// Bytes of the units that show a tile to every eye.
    fn bytes(&self, content: &dyn VideoUnits, tile: Tile, frame: u32) -> u32 {
        let units = self.grid.for_every_eye(tile);
        let bytes = units.map(|tile| content.bytes(content.unit(tile, frame)));
        bytes.fold(0, u32::saturating_add)
    }

    fn holds(&self, number: usize, unit: UnitId) -> bool {
        self.held[number].contains(&Some(unit))
    }

    /// Keeps a unit, and of the others of its tile the one that is bought for now, or else the
    /// latest: units of a level are numbered in the order of time.
    fn keep(&mut self, content: &dyn VideoUnits, number: usize, unit: UnitId) {
        let tile = self.tiles[number];
        let mut frames = self.horizons.iter().map(|horizon| horizon.frame);
        let held = &mut self.held[number];
        let other = frames.find_map(|frame| {
            let other = Some(content.unit(tile, frame));
            held.contains(&other).then_some(other)
        });
        *held = [Some(unit), other.unwrap_or(held[0].max(held[1]))];
    }

    /// The finest level that is held for each cell and worth showing there.
    fn shown(&self, content: &dyn VideoUnits, frame: u32, gains: &Gains) -> LevelMap {
        let shows = |(number, tile): (usize, &Tile)| {
            let gain = |tile| gains.of(&self.grid, tile);
            self.holds(number, content.unit(*tile, frame))
                && self.grid.for_every_eye(*tile).map(gain).sum::<f64>() > 0.0
        };
        let held: Vec<bool> = self.tiles.iter().enumerate().map(shows).collect();
        LevelMap::from_cells(&self.grid, |cell| {
            let levels = 0..self.grid.coarsest();
            let mut held_levels =
                levels.filter(|level| held[self.number(self.grid.tile_over(cell, *level))]);
            held_levels.next().unwrap_or(self.grid.coarsest())
        })
    }

    /// Those of the chosen tiles that will be seen.
    fn needed(&self, chosen: &[usize], shown: &LevelMap) -> Vec<usize> {
        let mut levels = shown.clone();
        for number in chosen {
            let tile = self.tiles[*number];
            for cell in self.grid.cells_under(tile) {
                levels.refine(&self.grid, cell, tile.level);
            }
        }
        let needed: BTreeSet<Tile> = shown_tiles(&self.grid, &levels).into_iter().collect();
        let chosen = chosen.iter().copied();
        chosen
            .filter(|number| needed.contains(&self.tiles[*number]))
            .collect()
    }
}

impl Horizon {
    /// Whether a score is asked for, and reached through every view with what this round would buy.
    fn is_reached(&self, config: &PolicyConfig) -> bool {
        let mut views = self.goals.iter().zip(&self.scales);
        let rule = config.policy.expectation();
        let reaches = |target: f64, (goal, scale): (&Goal, &Scale)| {
            scale.expected(rule, &goal.lost).for_target() >= target
        };
        let asked = config.target.filter(|_| !self.goals.is_empty());
        asked.is_some_and(|target| views.all(|view| reaches(target, view)))
    }
}

/// The tiles that show every cell at its level, and the whole coarsest level, coarsest first.
fn shown_tiles(grid: &TileGrid, levels: &LevelMap) -> Vec<Tile> {
    let finer = grid
        .tiles_of(0)
        .map(|cell| grid.tile_over(cell, levels.level(grid, cell)));
    let mut tiles: Vec<Tile> = grid.tiles_of(grid.coarsest()).chain(finer).collect();
    tiles.sort_by_key(|tile| (core::cmp::Reverse(tile.level), grid.rank(*tile)));
    tiles.dedup();
    tiles
}
