//! Does each policy choose what it says?

use super::*;
use crate::content::video::grid::level_map::{histogram, pixels};
use crate::content::video::grid::tile_grid::Cut;
use crate::pack::unit::UnitId;
use crate::perception::measured::acuity::MeasuredAcuity;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::cues::Cues;
use crate::perception::parameters::EyeState;
use crate::units::Seconds;
use crate::view::axes::Axes;
use crate::view::eye_view::Field;
use crate::view::frustum::Frustum;
use crate::view::random::Random;
use crate::view::surface::{Eye, Screen, Surface};
use proptest::prelude::*;

/// An eye of every kind.
fn models() -> [AcuityModel; 4] {
    let measured = MeasuredAcuity::parse("ecc_deg,mar_arcmin\n0,1\n5,1.2\n6,7\n50,60\n");
    [
        AcuityModel::LINEAR,
        AcuityModel::Watson,
        AcuityModel::WatsonPaper,
        AcuityModel::Table(measured.unwrap()),
    ]
}

fn degrees(yaw: f64, pitch: f64) -> Glance {
    let gaze = GazeSample::at(
        Seconds(0.0),
        Radians::from_degrees(yaw),
        Radians::from_degrees(pitch),
    );
    Glance {
        gaze,
        view: None,
        state: EyeState::Steady,
    }
}

fn kastner_pixels(config: PolicyConfig, glance: &Glance) -> (u64, Vec<u32>) {
    let grid = TileGrid::new(Surface::cube(3000), Cut::Grid([4, 4]), 3, 4).unwrap();
    let tiles = Rules::new(grid, config).select(glance).tiles;
    (pixels(&grid, &tiles), histogram(&grid, &tiles))
}

fn cube_16k(config: PolicyConfig) -> Rules {
    let grid = TileGrid::new(Surface::cube(4096), Cut::Tile(256), 5, 2).unwrap();
    Rules::new(grid, config)
}

fn share(selector: &Rules, glance: &Glance) -> f64 {
    let tiles = selector.select(glance).tiles;
    pixels(selector.grid(), &tiles) as f64 / selector.grid().surface.pixels() as f64
}

fn shares(selector: &Rules) -> (f64, f64) {
    let mut random = Random::new(1);
    let all: Vec<f64> = (0..300)
        .map(|_| {
            let gaze_in_content = random.direction();
            let gaze = GazeSample {
                gaze_in_content,
                ..degrees(0.0, 0.0).gaze
            };
            share(
                selector,
                &Glance {
                    gaze,
                    view: None,
                    state: EyeState::Steady,
                },
            )
        })
        .collect();
    (
        all.iter().sum::<f64>() / 300.0,
        all.iter().copied().fold(0.0, f64::max),
    )
}

#[test]
fn the_grid_policy_counts_kastner_s_cells() {
    let grid = PolicyConfig::new(Policy::Grid);
    let inner = degrees(-10.0, 10.0);
    assert_eq!(
        kastner_pixels(grid.clone(), &inner),
        (1_037_435, vec![1, 8, 87])
    );
    let noisy = PolicyConfig {
        noisy_cells: 22,
        ..grid.clone()
    };
    assert_eq!(kastner_pixels(noisy, &inner), (1_766_405, vec![1, 30, 65]));
    assert_eq!(
        kastner_pixels(grid, &degrees(0.0, 0.0)),
        (2_850_848, vec![4, 12, 80])
    );
    let coarsest = PolicyConfig::new(Policy::Coarsest);
    assert_eq!(kastner_pixels(coarsest, &inner), (212_064, vec![0, 0, 96]));
}

#[test]
fn a_gaze_into_a_corner_of_the_cube_has_seven_middle_cells() {
    let single = PolicyConfig {
        edge_rule: EdgeRule::Single,
        ..PolicyConfig::new(Policy::Grid)
    };
    assert_eq!(
        kastner_pixels(single.clone(), &degrees(40.0, 30.0)).1,
        [1, 7, 88]
    );
    assert_eq!(kastner_pixels(single, &degrees(40.0, 10.0)).1, [1, 8, 87]);
}

#[test]
fn acuity_takes_the_share_of_a_16k_cube_that_the_reference_gives() {
    let disc = |radius| PolicyConfig {
        safety_disc: Radians::from_degrees(radius),
        ..PolicyConfig::new(Policy::Acuity)
    };
    for (radius, mean, most) in [(0.0, 0.010, 0.015), (2.5, 0.013, 0.02), (5.0, 0.018, 0.03)] {
        let (found_mean, found_most) = shares(&cube_16k(disc(radius)));
        assert!(
            found_mean <= mean && found_most <= most,
            "{radius}: {found_mean}"
        );
    }
}

#[test]
fn viewport_takes_what_is_in_view_at_the_density_of_the_display() {
    let selector = cube_16k(PolicyConfig::new(Policy::Viewport));
    let at = |size: u32| {
        let size = [size; 2];
        let field = Field::across(Radians::from_degrees(100.0), size);
        let view = Some(EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field,
            size,
            eye: Default::default(),
        });
        share(
            &selector,
            &Glance {
                view,
                ..degrees(0.0, 0.0)
            },
        )
    };
    let (source, quarter) = (at(1 << 20), at(1200));
    assert!((0.25..0.42).contains(&source), "{source}");
    assert!(quarter < 0.4 * source, "{quarter} of {source}");
}

#[test]
fn an_uncertain_gaze_takes_more() {
    let selector = cube_16k(PolicyConfig::new(Policy::Acuity));
    let sure = degrees(12.0, 7.0);
    let spread = Radians::from_degrees(5.0);
    let unsure = Glance {
        gaze: GazeSample {
            spread,
            ..sure.gaze
        },
        view: None,
        state: EyeState::Steady,
    };
    assert!(share(&selector, &unsure) > share(&selector, &sure));
}

#[test]
fn nothing_finer_than_the_display_shows_is_chosen() {
    let surface = Surface::flat([4096, 2048], Screen::default());
    let grid = TileGrid::new(surface, Cut::Tile(256), 5, 2).unwrap();
    let view = |scale: u32| {
        let size = [4096 / scale, 2048 / scale];
        Glance {
            view: Some(EyeView::filling(&surface, size)),
            ..degrees(3.0, 2.0)
        }
    };
    for policy in [Policy::Acuity, Policy::Viewport] {
        let selector = Rules::new(grid, PolicyConfig::new(policy));
        for (scale, finest) in [(1, 0), (2, 1), (4, 2), (8, 3)] {
            let levels = selector.select(&view(scale)).levels;
            let found = *levels.levels().iter().min().unwrap();
            assert!(found >= finest, "{policy:?} 1/{scale}: {found}");
            assert!(policy == Policy::Acuity || found == finest);
        }
    }
}

#[test]
fn a_view_is_sharp_to_its_borders_on_faces_of_any_size() {
    for face in [256, 512, 2048] {
        let grid = TileGrid::new(Surface::cube(face), Cut::Tile(128), 5, 2).unwrap();
        let selector = Rules::new(grid, PolicyConfig::new(Policy::Viewport));
        let size = [4 * face; 2];
        let field = Field::across(Radians::from_degrees(66.0), size);
        let view = EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field,
            size,
            eye: Eye::Left,
        };
        let view_of = Glance {
            view: Some(view),
            ..degrees(0.0, 0.0)
        };
        let levels = selector.select(&view_of).levels;
        let fade = grid.blend_pixels() * f64::from(grid.scale(grid.coarsest()) - 1);
        let beyond = (fade / f64::from(face) * 2.0).atan() * 0.9;
        for yaw in [-20.0, 0.0, 20.0] {
            // What is coarser this near would show within the view.
            let pitch = 33.0 + beyond.to_degrees();
            let above = degrees(yaw, pitch).gaze.gaze_in_content;
            let (at, place) = grid.surface.locate(above).unwrap();
            let level = levels.level(&grid, grid.cell_at(at, place));
            assert_eq!(level, 0, "{face}: {yaw}, {pitch}");
        }
    }
}

#[test]
fn flat_content_in_view_at_its_own_density_is_all_finest() {
    let surface = Surface::flat([1280, 720], Screen::default());
    let grid = TileGrid::new(surface, Cut::Tile(128), 5, 2).unwrap();
    let view = Some(EyeView::filling(&surface, surface.size));
    let selector = Rules::new(grid, PolicyConfig::new(Policy::Viewport));
    let levels = selector
        .select(&Glance {
            view,
            ..degrees(0.0, 0.0)
        })
        .levels;
    assert_eq!(levels, LevelMap::filled(&grid, 0));
}

#[test]
fn bounds_skip_no_cell_that_probing_would_refine() {
    for acuity in models() {
        let config = PolicyConfig {
            acuity,
            ..PolicyConfig::new(Policy::Acuity)
        };
        let grid = TileGrid::new(Surface::cube(1024), Cut::Tile(128), 5, 2).unwrap();
        let selector = Rules::new(grid, config);
        let glance = degrees(33.0, -21.0);
        for bounds in selector.cells.iter() {
            let probed = probes(&grid, bounds.cell)
                .map(|p| level_of_footprint(&grid, selector.acuity_footprint(&glance, &p)))
                .min();
            assert_eq!(Some(selector.acuity_level(bounds, &glance)), probed);
        }
    }
}

#[test]
fn what_is_chosen_for_one_eye_is_chosen_for_the_other_and_counts_twice() {
    let one = TileGrid::new(Surface::cube(1024), Cut::Tile(128), 4, 2).unwrap();
    let surface = one.surface.for_two_eyes();
    let both = TileGrid { surface, ..one };
    let field = Field::across(Radians::from_degrees(90.0), [640, 400]);
    let view = Some(EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field,
        size: [640, 400],
        eye: Default::default(),
    });
    for policy in [
        Policy::Full,
        Policy::Coarsest,
        Policy::Viewport,
        Policy::Grid,
        Policy::Acuity,
    ] {
        for edge_rule in [EdgeRule::Conservative, EdgeRule::Single] {
            let config = PolicyConfig {
                edge_rule,
                noisy_cells: 7,
                ..PolicyConfig::new(policy)
            };
            let glance = Glance {
                view,
                ..degrees(40.0, 31.0)
            };
            let mono = Rules::new(one, config.clone()).select(&glance);
            let stereo = Rules::new(both, config).select(&glance);
            assert_eq!(stereo.levels.levels(), mono.levels.levels());
            let twins = mono.tiles.iter().flat_map(|tile| both.for_every_eye(*tile));
            let mut twins: Vec<Tile> = twins.collect();
            twins.sort_by_key(|tile| (core::cmp::Reverse(tile.level), both.rank(*tile)));
            assert_eq!(stereo.tiles, twins, "{policy:?} {edge_rule:?}");
        }
    }
}

#[test]
fn nothing_is_selected_where_a_panorama_has_no_face() {
    let panorama = Surface::cube(1024).without_poles();
    let grid = TileGrid::new(panorama, Cut::Tile(128), 4, 2).unwrap();
    for policy in [Policy::Full, Policy::Grid, Policy::Acuity] {
        let selector = Rules::new(grid, PolicyConfig::new(policy));
        for pitch in [-90.0, -60.0, 0.0, 44.9, 60.0, 90.0] {
            let selection = selector.select(&degrees(10.0, pitch));
            assert!(selection.tiles.iter().all(|tile| tile.face < 4));
            let shown = pixels(&grid, &selection.tiles) as f64 / grid.surface.pixels() as f64;
            assert!(
                policy == Policy::Full || shown < 0.3,
                "{policy:?} {pitch}: {shown}"
            );
        }
    }
}

proptest! {
    #[test]
    fn the_safety_disc_is_always_finest(
        yaw in -180.0..180.0f64, pitch in -89.0..89.0f64, disc in 0.5..6.0f64,
    ) {
        let config = PolicyConfig {
            safety_disc: Radians::from_degrees(disc),
            ..PolicyConfig::new(Policy::Acuity)
        };
        let grid = TileGrid::new(Surface::cube(8192), Cut::Tile(512), 5, 2).unwrap();
        let selector = Rules::new(grid, config);
        let glance = degrees(yaw, pitch);
        let levels = selector.select(&glance).levels;
        for step in 0..24 {
            let direction = crate::view::axes::direction_at(
                glance.gaze.gaze_in_content,
                Radians(f64::from(step)),
                Radians::from_degrees(disc * 0.999),
            );
            let (face, place) = grid.surface.locate(direction).unwrap();
            prop_assert_eq!(levels.level(&grid, grid.cell_at(face, place)), 0);
        }
    }
}

/// Content whose every third cell is noisy.
#[derive(Debug)]
struct EveryThird;

impl VideoUnits for EveryThird {
    fn has_signatures(&self) -> bool {
        false
    }

    fn unit(&self, tile: Tile, _frame: u32) -> UnitId {
        UnitId(u32::from(tile.face) * 16 + u32::from(tile.y) * 4 + u32::from(tile.x))
    }

    fn next_group(&self, _frame: u32) -> Option<u32> {
        None
    }

    fn bytes(&self, _unit: UnitId) -> u32 {
        1
    }

    fn signature(&self, _unit: UnitId) -> Option<Signature> {
        None
    }

    fn cues(&self, unit: UnitId) -> Option<Cues> {
        Some(Cues {
            deviation: if unit.0.is_multiple_of(3) { 40.0 } else { 10.0 },
            ..Cues::default()
        })
    }
}

#[test]
fn cells_of_a_variance_above_the_threshold_are_promoted_and_no_others() {
    let grid = TileGrid::new(Surface::cube(3000), Cut::Grid([4, 4]), 3, 4).unwrap();
    let glance = degrees(-10.0, 10.0);
    let levels = |threshold| {
        let config = PolicyConfig {
            noise_threshold: threshold,
            ..PolicyConfig::new(Policy::Grid)
        };
        let selector = Rules::new(grid, config);
        selector.select_of(Some(&EveryThird), 0, &glance).levels
    };
    let plain = levels(None);
    // 40² = 1600 is the variance of the noisy cells, and not above itself.
    assert_eq!(levels(Some(1600.0)), plain);
    assert_eq!(levels(Some(0.0)).levels().iter().max(), Some(&1));
    let noisy = levels(Some(1599.0));
    for cell in grid.tiles_of(0) {
        let is_noisy = EveryThird.unit(cell, 0).0.is_multiple_of(3);
        let expected = plain.level(&grid, cell).min(if is_noisy { 1 } else { 2 });
        assert_eq!(noisy.level(&grid, cell), expected, "{cell:?}");
    }
}

#[test]
fn out_of_view_nothing_is_finer_than_the_coarsest_level() {
    let size = [1280, 720];
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(60.0), size),
        size,
        eye: Eye::Left,
    };
    let grid = TileGrid::new(Surface::cube(1024), Cut::Tile(64), 4, 2).unwrap();
    let config = PolicyConfig {
        thresholds: [20.0, 80.0, 180.0].map(Radians::from_degrees).to_vec(),
        ..PolicyConfig::new(Policy::Distance)
    };
    let selector = Rules::new(grid, config);
    let glance = degrees(25.0, 0.0);
    let blind = distance_levels(
        &grid,
        &selector.cells,
        &selector.thresholds,
        glance.gaze.gaze_in_content,
        Some(&view),
    );
    let all = selector.by_distance(&glance);
    let sight = Frustum::new(&view, Radians(0.0));
    let (mut kept, mut dropped) = (0, 0);
    for cell in grid.tiles_of(0) {
        let (seen, anywhere) = (blind.level(&grid, cell), all.level(&grid, cell));
        let visible = probes(&grid, cell).any(|probe| sight.reaches(probe.direction));
        if visible {
            assert_eq!(seen, anywhere, "{cell:?}");
            kept += 1;
        } else {
            assert!(seen == grid.coarsest() || seen == anywhere);
            dropped += u32::from(seen != anywhere);
        }
    }
    assert!(kept > 50 && dropped > 100, "{kept} {dropped}");
}

/// A window of 1280x720 on a sphere whose picture fills `at_eye` times its own angles at the eye.
fn window(field: f64, at_eye: Option<f64>, yaw: f64) -> Glance {
    let size = [1280, 720];
    let own = Field::across(Radians::from_degrees(field), size);
    let seen = at_eye.map(|share| [own.left, own.right, own.up, own.down].map(|t| t * share));
    Glance {
        view: Some(EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field {
                at_eye: seen,
                ..own
            },
            size,
            eye: Eye::Left,
        }),
        ..degrees(yaw, 0.0)
    }
}

#[test]
fn a_window_that_fills_the_angles_of_its_content_shows_what_any_view_of_it_shows() {
    let selector = cube_16k(PolicyConfig::new(Policy::Acuity));
    for yaw in [0.0, 20.0, -35.0] {
        let plain = selector.select(&window(90.0, None, yaw)).levels;
        let same = selector.select(&window(90.0, Some(1.0), yaw)).levels;
        let view = window(90.0, None, yaw).view.unwrap();
        let (grid, sight) = (selector.grid(), Frustum::new(&view, Radians(0.0)));
        for cell in grid.tiles_of(0) {
            if sight.reaches(grid.centre(cell)) {
                assert_eq!(plain.level(grid, cell), same.level(grid, cell), "{cell:?}");
            }
        }
    }
}

#[test]
fn what_is_shown_smaller_is_nearer_to_the_gaze_and_what_is_not_shown_is_coarsest() {
    let selector = cube_16k(PolicyConfig::new(Policy::Acuity));
    let grid = selector.grid();
    let small = window(90.0, Some(0.2), 0.0);
    let whole = window(90.0, Some(1.0), 0.0);
    let eccentricity = |glance: &Glance| {
        let aside = crate::view::axes::direction_from_yaw_pitch(Radians(0.5), Radians(0.0));
        glance.eccentricity(aside).to_degrees()
    };
    assert!((eccentricity(&whole) - Radians(0.5).to_degrees()).abs() < 1e-9);
    assert!(eccentricity(&small) < 0.25 * eccentricity(&whole));
    let levels = selector.select(&small).levels;
    let behind = grid.cell_at(2, [2000.0, 2000.0]);
    assert_eq!(levels.level(grid, behind), grid.coarsest());
    assert_eq!(small.eccentricity(-Axes::FRONT.forward).to_degrees(), 180.0);
}

#[test]
fn what_skips_probes_gives_the_level_that_all_probes_give() {
    let flat = Surface::flat([6000, 2500], Screen::default());
    let grids = [
        TileGrid::new(Surface::cube(4096), Cut::Tile(256), 5, 2).unwrap(),
        TileGrid::new(flat, Cut::Tile(128), 5, 2).unwrap(),
    ];
    let mut random = Random::new(11);
    for (grid, acuity) in grids
        .into_iter()
        .flat_map(|grid| models().map(|model| (grid, model)))
    {
        for (disc, spread, headset) in [(0.0, 0.0, false), (2.5, 0.5, true), (0.0, 2.0, true)] {
            let config = PolicyConfig {
                acuity: acuity.clone(),
                safety_disc: Radians::from_degrees(disc),
                ..PolicyConfig::new(Policy::Acuity)
            };
            let selector = Rules::new(grid, config);
            let place = [0, 1].map(|k| random.unit() * f64::from(grid.surface.size[k]));
            let mut glance = window(100.0, None, 0.0);
            glance.view = glance.view.filter(|_| headset);
            glance.gaze.gaze_in_content = grid.surface.direction(0, place);
            glance.gaze.spread = Radians::from_degrees(spread);
            for bounds in selector.cells.iter() {
                let all = probes(&grid, bounds.cell);
                let finest = all
                    .map(|probe| selector.allowed_level(&glance, &probe))
                    .min();
                let found = selector.acuity_level(bounds, &glance);
                assert_eq!(Some(found), finest, "{acuity:?} {bounds:?} {glance:?}");
            }
        }
    }
}
