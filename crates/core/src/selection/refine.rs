//! Which steps does a budget buy, frame after frame?
//!
//! Tiles of a pyramid are units of one step; a finer tile wants the coarser one under it first,
//! unless what is held already shows that place as well. Steps are taken by value per byte
//! ([`super::greedy`]), for what is shown now and for the groups of frames that begin next, each
//! for as long as it will be shown. What is bought and not shown in the end (four children hide
//! their parent) is not bought.

use super::content::Content;
use super::greedy::{Catalog, CatalogBuilder, Chain, Misfit, Rule, Stage, Step};
use super::level_map::LevelMap;
use super::policy::{Moment, Policy, PolicyConfig, Selection};
use super::worth::{Gains, Worth};
use crate::asset::tile_grid::{Tile, TileGrid};
use crate::asset::unit::UnitId;
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
}

/// One time that is bought for.
struct Horizon {
    frame: u32,
    /// What a gain there counts.
    weight: f64,
    gains: Gains,
    /// What is held for it and worth showing.
    shown: LevelMap,
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
            held: vec![[None; 2]; tiles.len()],
            spent: 0,
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
                let gains = self.worth.gains(&self.grid, content, frame, moment);
                let shown = self.shown(content, frame, &gains);
                Horizon {
                    frame,
                    weight,
                    gains,
                    shown,
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
        let chosen = self.chosen(&worth_it, budget);
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
    fn chosen(&mut self, worth_it: &[bool], budget: u64) -> Vec<usize> {
        if self.config.policy == Policy::Uniform {
            let visible = |entry: u32| worth_it[entry as usize];
            let choices = self.catalog.uniform(budget, Misfit::Stop, visible);
            return choices.map(|choice| choice.unit as usize).collect();
        }
        let choices = self.catalog.choices(budget);
        choices.map(|choice| choice.unit as usize).collect()
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
            let needed = Stage {
                unit: 2 * (first[usize::from(above)] + grid.rank(parent)) + which,
                level: 0,
            };
            builder.require(Stage { unit, level: 0 }, &[needed]);
        }
    }
    let rule = Rule {
        misfit: config.misfit(),
        ..Rule::default()
    };
    match builder.build(rule) {
        Ok(catalog) => catalog,
        Err(error) => panic!("a pyramid is a catalog: {error}"),
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
mod tests {
    use super::*;
    use crate::asset::cues::Cues;
    use crate::asset::signature::{BandContrast, Signature};
    use crate::asset::tile_grid::Cut;
    use crate::gaze::sample::GazeSample;
    use crate::perception::parameters::{EyeState, Model, Parameters};
    use crate::selection::level_map::pixels;
    use crate::units::{Radians, Seconds};
    use crate::view::axes::{Axes, angle_between};
    use crate::view::eye_view::{EyeView, Field};
    use crate::view::surface::Surface;

    const FRAMES_IN_GROUP: u32 = 8;

    /// Busy everywhere; only one tile moves.
    struct Busy;

    impl Content for Busy {
        fn unit(&self, tile: Tile, frame: u32) -> UnitId {
            let place = u32::from(tile.face) << 12 | u32::from(tile.y) << 6 | u32::from(tile.x);
            UnitId(place | u32::from(tile.level) << 16 | (frame / FRAMES_IN_GROUP) << 20)
        }

        fn next_group(&self, frame: u32) -> Option<u32> {
            let next = (frame / FRAMES_IN_GROUP + 1) * FRAMES_IN_GROUP;
            (next < 4 * FRAMES_IN_GROUP).then_some(next)
        }

        fn bytes(&self, unit: UnitId) -> u32 {
            1000 + unit.0.wrapping_mul(2_654_435_761) % 500
        }

        fn signature(&self, _: UnitId) -> Option<Signature> {
            let band = |before, after| BandContrast {
                before,
                after,
                difference: after - before,
            };
            Some(Signature {
                bands: [band(0.01, 0.15), band(0.1, 0.12), band(0.1, 0.1)],
            })
        }

        fn cues(&self, unit: UnitId) -> Option<Cues> {
            let moves = unit.0 & 0xffff == 3 << 12;
            let change = if moves { 200.0 } else { 0.0 };
            Some(Cues {
                change,
                ..Cues::default()
            })
        }
    }

    fn grid() -> TileGrid {
        TileGrid::new(Surface::cube(1024), Cut::Tile(128), 4, 2).unwrap()
    }

    fn config(policy: Policy) -> PolicyConfig {
        PolicyConfig::new(policy)
    }

    fn moment(yaw_deg: f64) -> Moment {
        let size = [800, 500];
        Moment {
            gaze: GazeSample::at(Seconds(0.0), Radians::from_degrees(yaw_deg), Radians(0.0)),
            view: Some(EyeView {
                axes: Axes::FRONT,
                field: Field::across(Radians::from_degrees(100.0), size),
                size,
                eye: Default::default(),
            }),
            state: EyeState::Steady,
        }
    }

    const BUDGETED: [Policy; 3] = [Policy::Uniform, Policy::Eccentricity, Policy::Perceptual];

    fn first_frame(policy: Policy, budget: Option<u64>) -> (Refiner, Selection) {
        let mut refiner = Refiner::new(grid(), config(policy));
        let selection = refiner.refine(&Busy, 0, &moment(0.0), budget);
        (refiner, selection)
    }

    #[test]
    fn a_budget_is_never_passed_and_what_is_shown_was_paid() {
        for policy in BUDGETED {
            for budget in [0, 999, 5_000, 30_000, 200_000] {
                let (refiner, selection) = first_frame(policy, Some(budget));
                let finer = selection.tiles.iter().filter(|tile| tile.level < 3);
                let shown: u64 = finer
                    .map(|tile| u64::from(Busy.bytes(Busy.unit(*tile, 0))))
                    .sum();
                assert!(refiner.spent() <= budget, "{policy:?} {budget}");
                assert!(shown <= refiner.spent(), "{policy:?} {budget}");
            }
        }
    }

    #[test]
    fn more_bytes_are_never_worth_less() {
        for policy in BUDGETED {
            let mut before = 0.0;
            for budget in [0, 5_000, 20_000, 60_000, 200_000, u64::MAX] {
                let (refiner, selection) = first_frame(policy, Some(budget));
                let gains = refiner.worth.gains(&grid(), &Busy, 0, &moment(0.0));
                let share = gains.share(&grid(), &selection.levels);
                assert!(
                    share >= before - 1e-9,
                    "{policy:?} {budget}: {share} {before}"
                );
                before = share;
            }
            assert!(before > 0.999, "{policy:?}: {before}");
        }
    }

    #[test]
    fn what_is_bought_stays_and_a_steady_eye_gets_all_that_is_worth_it() {
        for policy in BUDGETED {
            let whole = first_frame(policy, None).1.levels;
            let mut refiner = Refiner::new(grid(), config(policy));
            let mut shown = LevelMap::filled(&grid(), 3);
            for _ in 0..60 {
                let levels = refiner.refine(&Busy, 3, &moment(0.0), Some(25_000)).levels;
                for (now, before) in levels.levels().iter().zip(shown.levels()) {
                    assert!(now <= before, "{policy:?}");
                }
                shown = levels;
            }
            assert_eq!(refiner.spent(), 0, "{policy:?}");
            assert_eq!(shown, whole, "{policy:?}");
        }
    }

    #[test]
    fn detail_goes_where_the_eye_looks() {
        for policy in [Policy::Eccentricity, Policy::Perceptual] {
            let selection = first_frame(policy, Some(40_000)).1;
            let level_at = |yaw: f64| {
                let gaze = moment(yaw).gaze.gaze_in_content;
                let (face, place) = grid().surface.locate(gaze).unwrap();
                selection.levels.level(&grid(), grid().cell_at(face, place))
            };
            assert!(level_at(1.0) < level_at(35.0), "{policy:?}");
            let behind = level_at(180.0);
            assert_eq!(behind, 3, "{policy:?}");
        }
    }

    #[test]
    fn a_steady_eye_keeps_its_detail_when_new_groups_begin() {
        for policy in BUDGETED {
            let mut refiner = Refiner::new(grid(), config(policy));
            let shares: Vec<f64> = (0..24)
                .map(|frame| {
                    let levels = refiner
                        .refine(&Busy, frame, &moment(0.0), Some(40_000))
                        .levels;
                    let gains = refiner.worth.gains(&grid(), &Busy, frame, &moment(0.0));
                    gains.share(&grid(), &levels)
                })
                .collect();
            assert!(shares[16] > 0.6 * shares[15], "{policy:?}: {shares:?}");
        }
    }

    #[test]
    fn uniform_raises_what_is_in_view_evenly() {
        let selection = first_frame(Policy::Uniform, Some(30_000)).1;
        let view = moment(0.0).view.unwrap();
        let grid = grid();
        let in_view = grid.tiles_of(0).filter(|cell| {
            angle_between(view.axes.forward, grid.centre(*cell)).to_degrees() < 30.0
        });
        let levels: Vec<u8> = in_view
            .map(|cell| selection.levels.level(&grid, cell))
            .collect();
        let (least, most) = (levels.iter().min().unwrap(), levels.iter().max().unwrap());
        assert!(most - least <= 1, "{levels:?}");
    }

    #[test]
    fn without_limit_an_eye_gets_less_than_everything_and_the_view_bounds_it() {
        let tiles = first_frame(Policy::Perceptual, None).1.tiles;
        let whole = LevelMap::filled(&grid(), 0).cover(&grid());
        assert!(pixels(&grid(), &tiles) * 2 < pixels(&grid(), &whole));
    }

    #[test]
    fn saliency_fetches_what_moves_outside_the_view_and_nothing_else_there() {
        let behind = |saliency| {
            let config = PolicyConfig {
                saliency,
                ..config(Policy::Perceptual)
            };
            let mut refiner = Refiner::new(grid(), config);
            let tiles = refiner.refine(&Busy, 0, &moment(0.0), None).tiles;
            let left = tiles
                .into_iter()
                .filter(|tile| tile.face == 3 && tile.level < 3);
            left.filter(|tile| grid().centre(*tile).x < -0.99).count()
        };
        assert_eq!(behind(false), 0);
        let moving = grid().tile_at(
            0,
            grid().rank(Tile {
                level: 0,
                face: 3,
                x: 0,
                y: 0,
            }),
        );
        let config = PolicyConfig {
            saliency: true,
            ..config(Policy::Perceptual)
        };
        let tiles = Refiner::new(grid(), config)
            .refine(&Busy, 0, &moment(0.0), None)
            .tiles;
        assert!(tiles.contains(&moving));
    }

    #[test]
    fn a_jumping_eye_is_prepared_for_anything_in_view() {
        let shares = [EyeState::Steady, EyeState::Jumping].map(|state| {
            let mut refiner = Refiner::new(grid(), config(Policy::Perceptual));
            let moment = Moment {
                state,
                ..moment(0.0)
            };
            let levels = refiner.refine(&Busy, 0, &moment, Some(45_000)).levels;
            let grid = grid();
            let cells = grid.tiles_of(0).filter(|cell| {
                angle_between(moment.gaze.gaze_in_content, grid.centre(*cell)).to_degrees() < 12.0
            });
            let finest: Vec<u8> = cells.map(|cell| levels.level(&grid, cell)).collect();
            finest.iter().map(|level| f64::from(*level)).sum::<f64>() / finest.len() as f64
        });
        assert!(shares[0] < shares[1], "{shares:?}");
    }

    #[test]
    fn both_eyes_are_bought_for_together_out_of_one_budget() {
        let surface = grid().surface.for_two_eyes();
        let both = TileGrid { surface, ..grid() };
        for policy in BUDGETED {
            let mut refiner = Refiner::new(both, config(policy));
            let selection = refiner.refine(&Busy, 0, &moment(20.0), Some(60_000));
            let finer = selection.tiles.iter().filter(|tile| tile.level < 3);
            let bytes = finer.map(|tile| u64::from(Busy.bytes(Busy.unit(*tile, 0))));
            assert!(bytes.sum::<u64>() <= refiner.spent() && refiner.spent() <= 60_000);
            assert!(
                selection.tiles.iter().any(|tile| tile.level < 3),
                "{policy:?}"
            );
            for tile in &selection.tiles {
                for twin in both.for_every_eye(*tile) {
                    assert!(selection.tiles.contains(&twin), "{policy:?} {twin:?}");
                }
            }
        }
    }

    #[test]
    fn nothing_is_bought_that_the_display_is_said_not_to_show() {
        let finest = |display_cpd| {
            let mut config = config(Policy::Perceptual);
            config.perception.set("display_cpd", display_cpd).unwrap();
            let mut refiner = Refiner::new(grid(), config);
            let levels = refiner.refine(&Busy, 0, &moment(0.0), None).levels;
            *levels.levels().iter().min().unwrap()
        };
        assert_eq!(finest(0.0), 0);
        assert!(finest(0.5) > 0);
    }

    #[test]
    fn the_published_model_also_chooses() {
        let paper = PolicyConfig {
            perception: Parameters::of(Model::Paper),
            ..config(Policy::Perceptual)
        };
        let mut refiner = Refiner::new(grid(), paper);
        let selection = refiner.refine(&Busy, 0, &moment(0.0), Some(50_000));
        assert!(refiner.spent() > 0 && selection.levels.levels().contains(&0));
    }
}
