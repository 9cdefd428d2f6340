//! Is a budget spent on what is worth it, and never passed?

use super::*;
use crate::content::scripted::{scripted_demand, scripted_head};
use crate::content::video::demand::VideoDemand;
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::level_map::pixels;
use crate::content::video::grid::tile_grid::Cut;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::losses::LossMeter;
use crate::content::video::rules::Selection;
use crate::content::video::units::VideoUnits;
use crate::content::video::worth::Worth;
use crate::gaze::sample::GazeSample;
use crate::pack::unit::UnitId;
use crate::perception::glance::Glance;
use crate::perception::measures::contrast::{BandContrast, Signature};
use crate::perception::measures::cues::Cues;
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::units::{Radians, Seconds};
use crate::view::axes::{Axes, angle_between};
use crate::view::eye_view::{EyeView, Field};
use crate::view::surface::Surface;
use std::sync::Arc;

const FRAMES_IN_GROUP: u32 = 8;

/// Busy everywhere; only one tile moves.
#[derive(Clone, Copy, Debug)]
struct Busy;

impl VideoUnits for Busy {
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

    fn has_signatures(&self) -> bool {
        true
    }

    fn signature(&self, _: UnitId) -> Option<Signature> {
        let band = |before, after| BandContrast {
            before,
            after,
            difference: after - before,
            norm: 2.0 * (after - before),
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

/// The tile of a unit of [`Busy`].
fn tile_of(UnitId(unit): UnitId) -> Tile {
    Tile {
        level: (unit >> 16 & 0xf) as u8,
        face: (unit >> 12 & 0xf) as u8,
        x: (unit & 0x3f) as u16,
        y: (unit >> 6 & 0x3f) as u16,
    }
}

/// A scheduler of one video, and what it worths steps by.
struct Refiner {
    scheduler: Scheduler,
    grid: TileGrid,
    worth: Worth,
}

impl Refiner {
    fn new(grid: TileGrid, config: PolicyConfig) -> Self {
        let demand = VideoDemand::new(Arc::new(Busy), grid, config.clone());
        Self {
            worth: Worth::new(&grid, &config),
            scheduler: Scheduler::new(&config, vec![Box::new(demand)]),
            grid,
        }
    }

    fn spent(&self) -> u64 {
        self.scheduler.spent()
    }

    fn refine(&mut self, _: &Busy, frame: u32, moment: &Moment, budget: Option<u64>) -> Selection {
        let chosen = self.scheduler.choose(&[frame], moment, budget).remove(0);
        let tiles: Vec<Tile> = chosen.units.into_iter().map(tile_of).collect();
        let mut levels = LevelMap::filled(&self.grid, self.grid.coarsest());
        for tile in &tiles {
            for cell in self.grid.cells_under(*tile) {
                levels.refine(&self.grid, cell, tile.level);
            }
        }
        Selection { levels, tiles }
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
    let gaze = GazeSample::at(Seconds(0.0), Radians::from_degrees(yaw_deg), Radians(0.0));
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(100.0), size),
        size,
        eye: Default::default(),
    };
    Moment::new(gaze, vec![view])
}

fn glance() -> Glance {
    moment(0.0).glances().next().unwrap()
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
fn within_a_budget_buying_stops_at_the_target() {
    for policy in BUDGETED {
        let bought = |target| {
            let config = PolicyConfig {
                target,
                ..config(policy)
            };
            let mut refiner = Refiner::new(grid(), config);
            let selection = refiner.refine(&Busy, 0, &moment(0.0), Some(10_000_000));
            (refiner.spent(), selection.levels)
        };
        let (all, _) = bought(None);
        let (some, levels) = bought(Some(9.0));
        assert!(some < all, "{policy:?}: {some} of {all}");
        let meter = LossMeter::new(&grid(), &config(policy).perception);
        let losses = meter.losses(&grid(), &Busy, 0, &glance());
        let jod = policy.expectation().jod(losses.pooled(&levels));
        assert!(jod >= 9.0, "{policy:?}: {jod}");
    }
}

#[test]
fn more_bytes_are_never_worth_less() {
    for policy in BUDGETED {
        let mut before = 0.0;
        for budget in [0, 5_000, 20_000, 60_000, 200_000, u64::MAX] {
            let (refiner, selection) = first_frame(policy, Some(budget));
            let gains = refiner.worth.gains(&grid(), &Busy, 0, &glance());
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
                let gains = refiner.worth.gains(&grid(), &Busy, frame, &glance());
                gains.share(&grid(), &levels)
            })
            .collect();
        assert!(shares[16] > 0.6 * shares[15], "{policy:?}: {shares:?}");
    }
}

#[test]
fn uniform_raises_what_is_in_view_evenly() {
    let selection = first_frame(Policy::Uniform, Some(30_000)).1;
    let view = moment(0.0).views[0];
    let grid = grid();
    let in_view = grid
        .tiles_of(0)
        .filter(|cell| angle_between(view.axes.forward, grid.centre(*cell)).to_degrees() < 30.0);
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

#[test]
fn what_was_bought_for_a_group_is_kept_while_it_is_shown_in_every_round() {
    let head = scripted_head(Surface::cube(1024));
    let config = config(Policy::Perceptual);
    let mut scheduler = Scheduler::new(&config, vec![scripted_demand(&head, &config)]);
    let rounds = (0..4).flat_map(|_| 0..32);
    let mut before = 0;
    for (step, frame) in rounds.enumerate() {
        let chosen = scheduler.choose(&[frame], &moment(0.0), Some(9_000));
        let samples = chosen[0].record.samples;
        let goes_on = step > 0 && frame % 8 > 0;
        assert!(
            !goes_on || samples >= before,
            "{before} to {samples} at step {step}"
        );
        before = samples;
    }
}
