//! Which steps does a budget buy, frame after frame?
//!
//! Tiles of a pyramid are units of one step; a finer tile wants the coarser one under it first,
//! unless what is held already shows that place as well. Steps are taken by value per byte
//! ([`super::greedy`]), for what is shown now and for the groups of frames that begin next, each
//! for as long as it will be shown. What is bought and not shown in the end (four children hide
//! their parent) is not bought.

use crate::content::calibration::Expectation;
use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::losses::{LossMeter, Losses};
use crate::content::video::rules::Selection;
use crate::content::video::units::Content;
use crate::content::video::worth::{Gains, Worth};
use crate::pack::unit::UnitId;
use crate::perception::moment::Moment;
use crate::perception::parameters::Model;
use crate::selection::greedy::{Catalog, CatalogBuilder, Chain, Choice, Misfit, Rule, Rung, Step};
use std::collections::BTreeSet;

/// Rounds in which what was saved is spent again.
const ROUNDS: u32 = 3;
/// What a frame of the next groups counts beside one of these: the eye may look elsewhere by then.
const AHEAD: f64 = 0.7;

/// Buys and shows units under a policy that spends a budget. Remembers what it bought.
#[derive(Clone, Debug)]
pub struct Refiner {
    grid: TileGrid,
    config: PolicyConfig,
    worth: Worth,
    /// Where buying stops at a score: tells it.
    meter: Option<LossMeter>,
    /// Two units a tile: now, and in the groups that begin next.
    catalog: Catalog,
    /// All tiles of the left eye but those of the coarsest level, coarsest first; each is bought
    /// together with the same tile of the right eye.
    tiles: Vec<Tile>,
    /// Number of the first tile of each level, by level.
    first: Vec<u32>,
    /// The two units of each tile that were bought last.
    held: Vec<[Option<UnitId>; 2]>,
    /// Bytes that the last frame took.
    spent: u64,
    /// The last frame reaches the target, and so do the next groups as far as they are bought for.
    reached: bool,
}

/// One time that is bought for.
struct Horizon {
    frame: u32,
    /// What a gain there counts.
    weight: f64,
    gains: Gains,
    losses: Option<Losses>,
    /// What is held for it and worth showing.
    shown: LevelMap,
}

/// How far one time is from the score at which buying stops.
struct Goal<'a> {
    losses: &'a Losses,
    levels: LevelMap,
    /// What is lost at these levels, summed over cells.
    lost: f64,
}

impl<'a> Goal<'a> {
    fn new(horizon: &'a Horizon) -> Option<Self> {
        let losses = horizon.losses.as_ref()?;
        let levels = horizon.shown.clone();
        let cells = levels.levels().iter().enumerate();
        let lost = cells.map(|(rank, level)| losses.sum(rank, *level)).sum();
        Some(Self {
            losses,
            levels,
            lost,
        })
    }

    fn is_reached(&self, expectation: Expectation, target: f64) -> bool {
        expectation.jod(self.losses.quality(self.lost)) >= target
    }

    /// A tile is shown besides.
    fn add(&mut self, grid: &TileGrid, tile: Tile) {
        for cell in grid.cells_under(tile) {
            let (rank, was) = (grid.rank(cell) as usize, self.levels.level(grid, cell));
            if tile.level < was {
                self.lost += self.losses.sum(rank, tile.level) - self.losses.sum(rank, was);
                self.levels.refine(grid, cell, tile.level);
            }
        }
    }
}

impl Refiner {
    /// A chooser that holds nothing but the coarsest level.
    #[must_use]
    pub fn new(grid: TileGrid, config: PolicyConfig) -> Self {
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
            catalog: catalog_of(&grid, &tiles, &first, &config),
            worth: Worth::new(&grid, &config),
            meter: config
                .target
                .map(|_| LossMeter::new(&grid, &config.perception)),
            held: vec![[None; 2]; tiles.len()],
            spent: 0,
            reached: false,
            grid,
            config,
            tiles,
            first,
        }
    }

    /// Bytes that the last frame took.
    #[must_use]
    pub fn spent(&self) -> u64 {
        self.spent
    }

    /// Whether the last frame reaches the target, so that more bytes would buy nothing.
    #[must_use]
    pub fn has_reached(&self) -> bool {
        self.reached
    }

    /// Buys what `budget` bytes allow (`None`: whatever is worth anything) and says what to show
    /// of `frame`.
    pub fn refine(
        &mut self,
        content: &dyn Content,
        frame: u32,
        moment: &Moment,
        budget: Option<u64>,
    ) -> Selection {
        let mut horizons = self.horizons(content, frame, moment, budget);
        self.spent = 0;
        for _ in 0..ROUNDS {
            let left = budget.map_or(u64::MAX, |budget| budget.saturating_sub(self.spent));
            let bought = self.buy(content, &horizons, left);
            if bought == 0 {
                break;
            }
            self.spent += bought;
            for horizon in &mut horizons {
                horizon.shown = self.shown(content, horizon.frame, &horizon.gains);
            }
        }
        let expectation = self.config.policy.expectation();
        self.reached = self.config.target.is_some_and(|target| {
            let mut goals = horizons.iter().filter_map(Goal::new);
            goals.all(|goal| goal.is_reached(expectation, target))
        });
        let levels = horizons.swap_remove(0).shown;
        let tiles = shown_tiles(&self.grid, &levels);
        Selection { levels, tiles }
    }

    /// What to buy for: this frame and, where bytes are scarce, the first of the next groups.
    fn horizons(
        &self,
        content: &dyn Content,
        frame: u32,
        moment: &Moment,
        budget: Option<u64>,
    ) -> Vec<Horizon> {
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
        known
            .map(|(frame, weight)| {
                let mut gains = self.worth.gains(&self.grid, content, frame, moment);
                let meter = self.meter.as_ref();
                let losses = meter.map(|meter| meter.losses(&self.grid, content, frame, moment));
                if let Some(losses) = &losses {
                    gains.rise_where_lost(&self.grid, losses);
                }
                Horizon {
                    frame,
                    weight,
                    shown: self.shown(content, frame, &gains),
                    losses,
                    gains,
                }
            })
            .collect()
    }

    fn number(&self, tile: Tile) -> usize {
        let tile = self.grid.for_left_eye(tile);
        (self.first[usize::from(tile.level)] + self.grid.rank(tile)) as usize
    }

    /// Bytes of the units that show a tile to every eye.
    fn bytes(&self, content: &dyn Content, tile: Tile, frame: u32) -> u32 {
        let units = self.grid.for_every_eye(tile);
        let bytes = units.map(|tile| content.bytes(content.unit(tile, frame)));
        bytes.fold(0, u32::saturating_add)
    }

    fn holds(&self, number: usize, unit: UnitId) -> bool {
        self.held[number].contains(&Some(unit))
    }

    /// Keeps a unit, and of the others of its tile the latest: units of a level are numbered in
    /// the order of time.
    fn keep(&mut self, number: usize, unit: UnitId) {
        let held = &mut self.held[number];
        *held = [Some(unit), held[0].max(held[1])];
    }

    /// The finest level that is held for each cell and worth showing there.
    fn shown(&self, content: &dyn Content, frame: u32, gains: &Gains) -> LevelMap {
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

    /// Buys for at most `budget` bytes and returns the bytes spent.
    fn buy(&mut self, content: &dyn Content, horizons: &[Horizon], budget: u64) -> u64 {
        let count = self.tiles.len();
        let mut worth_it = vec![false; 2 * count];
        for (which, horizon) in horizons.iter().enumerate() {
            for number in 0..count {
                let tile = self.tiles[number];
                let unit = content.unit(tile, horizon.frame);
                let over = |tile| horizon.gains.over(&self.grid, tile, &horizon.shown);
                let gain: f64 = self.grid.for_every_eye(tile).map(over).sum();
                let value = horizon.weight * gain;
                let bytes = self.bytes(content, tile, horizon.frame);
                let entry = 2 * number + which;
                worth_it[entry] = value > 0.0;
                let at = entry as u32;
                self.catalog
                    .set_level(at, u8::from(!self.holds(number, unit)));
                self.catalog.set_bytes(at, &[bytes]);
                self.catalog.set_values(at, &[value]);
            }
        }
        let chosen = self.chosen(&worth_it, horizons, budget);
        let mut bytes = 0;
        for (which, horizon) in horizons.iter().enumerate() {
            let here = chosen.iter().filter(|entry| **entry % 2 == which);
            let numbers: Vec<usize> = here.map(|entry| entry / 2).collect();
            for number in self.needed(&numbers, &horizon.shown) {
                let unit = content.unit(self.tiles[number], horizon.frame);
                if !self.holds(number, unit) {
                    self.keep(number, unit);
                    bytes += u64::from(self.bytes(content, self.tiles[number], horizon.frame));
                }
            }
        }
        bytes
    }

    /// Entries of the catalog to buy.
    fn chosen(&mut self, worth_it: &[bool], horizons: &[Horizon], budget: u64) -> Vec<usize> {
        let mut goals: Vec<Option<Goal<'_>>> = horizons.iter().map(Goal::new).collect();
        let (grid, tiles, target) = (self.grid, &self.tiles, self.config.target);
        let expectation = self.config.policy.expectation();
        // What a horizon reaches its score without is left out.
        let mut is_missed = |choice: &Choice| {
            let entry = choice.unit as usize;
            let goal = goals.get_mut(entry % 2).and_then(Option::as_mut);
            let (Some(goal), Some(target)) = (goal, target) else {
                return true;
            };
            let missed = !goal.is_reached(expectation, target);
            if missed {
                goal.add(&grid, tiles[entry / 2]);
            }
            missed
        };
        let entry = |choice: Choice| is_missed(&choice).then_some(choice.unit as usize);
        if self.config.policy == Policy::Uniform {
            let visible = |entry: u32| worth_it[entry as usize];
            let choices = self.catalog.uniform(budget, Misfit::Stop, visible);
            return choices.filter_map(entry).collect();
        }
        self.catalog.choices(budget).filter_map(entry).collect()
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

/// One unit a tile, twice: each wants the coarser tile under it.
fn catalog_of(grid: &TileGrid, tiles: &[Tile], first: &[u32], config: &PolicyConfig) -> Catalog {
    let mut builder = CatalogBuilder::default();
    for (tile, which) in tiles.iter().flat_map(|tile| [(tile, 0), (tile, 1)]) {
        let unknown = Step {
            bytes: 0,
            value: 0.0,
        };
        let unit = builder.add(Chain::Refining, &[unknown]);
        let above = tile.level + 1;
        if let (Ok(unit), true) = (unit, above < grid.coarsest()) {
            let parent = grid.tile_over(*tile, above);
            let needed = Rung {
                unit: 2 * (first[usize::from(above)] + grid.rank(parent)) + which,
                level: 0,
            };
            builder.require(Rung { unit, level: 0 }, &[needed]);
        }
    }
    let rule = Rule {
        misfit: misfit_of(config),
        ..Rule::default()
    };
    match builder.build(rule) {
        Ok(catalog) => catalog,
        Err(error) => panic!("a pyramid is a catalog: {error}"),
    }
}

/// What happens when the best step does not fit into what a frame may spend: the corrected greedy
/// stops and saves up for it, as what is left counts for the next frame; the published one (Chen et
/// al. 2022) goes on with the next and so spends what it would need
/// (docs/decisions/0004-what-does-not-fit-is-skipped.md).
fn misfit_of(config: &PolicyConfig) -> Misfit {
    match config.perception.model {
        Model::Paper => Misfit::Skip,
        Model::Default => Misfit::Stop,
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

#[cfg(test)]
mod tests;
