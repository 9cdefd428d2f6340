//! Does what skips probes in a picture give the level that all probes give?

use super::*;
use crate::content::video::grid::tile_grid::Cut;
use crate::perception::parameters::EyeState;
use crate::units::Seconds;
use crate::view::axes::Axes;
use crate::view::eye_view::Field;
use crate::view::random::Random;
use crate::view::surface::{Eye, Screen, Surface};

fn grids() -> [TileGrid; 4] {
    let flat = |size| Surface::flat(size, Screen::default());
    [
        TileGrid::new(Surface::cube(1024), Cut::Tile(128), 5, 2).unwrap(),
        TileGrid::new(flat([6000, 2500]), Cut::Tile(256), 5, 2).unwrap(),
        TileGrid::new(flat([1536, 1024]), Cut::Grid([8, 8]), 3, 4).unwrap(),
        TileGrid::new(Surface::equirect([2048, 1024]), Cut::Tile(128), 5, 2).unwrap(),
    ]
}

fn one_of(random: &mut Random, count: usize) -> usize {
    (random.unit() * count as f64) as usize % count
}

/// Views that fill, magnify, shrink, turn away from and miss the content.
fn views(surface: &Surface, random: &mut Random) -> Vec<EyeView> {
    let mut views: Vec<EyeView> = [1, 2, 5, 8]
        .map(|scale| EyeView::filling(surface, surface.size.map(|side| side / scale)))
        .into();
    for _ in 0..12 {
        let width = [200, 1280, 4000][one_of(random, 3)];
        let size = [width, width * 9 / 16];
        let mut between = |from: f64, to: f64| from + (to - from) * random.unit();
        let across = Field::across(Radians::from_degrees(between(2.0, 150.0)), size);
        let aside = between(-0.5, 0.5) * across.left;
        let field = Field {
            left: across.left + aside,
            right: across.right - aside,
            ..across
        };
        let turned = [between(-120.0, 120.0), between(-60.0, 60.0)];
        let [yaw, pitch] = turned.map(Radians::from_degrees);
        views.push(EyeView {
            position: Default::default(),
            axes: if between(0.0, 1.0) < 0.3 {
                Axes::FRONT
            } else {
                Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0))
            },
            field,
            size,
            eye: Eye::Left,
        });
    }
    views
}

fn glance(view: EyeView, gaze_in_content: DVec3, spread: f64) -> Glance {
    let gaze = GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0));
    Glance {
        gaze: GazeSample {
            gaze_in_content,
            spread: Radians::from_degrees(spread),
            ..gaze
        },
        view: Some(view),
        state: EyeState::Steady,
    }
}

#[test]
fn what_is_in_view_is_as_fine_as_its_finest_probe() {
    let mut random = Random::new(5);
    let (mut seen, mut unseen) = (0, 0);
    for grid in grids() {
        for view in views(&grid.surface, &mut random) {
            let selector = Rules::new(grid, PolicyConfig::new(Policy::Viewport));
            let sight = selector.sight(&view);
            for bounds in selector.cells.iter() {
                let reached = probes(&grid, bounds.cell)
                    .filter(|probe| sight.reaches(probe.direction))
                    .map(|probe| {
                        level_of_footprint(&grid, view.footprint(probe.ppd, probe.direction))
                    })
                    .min();
                let found = selector.shown_level(bounds, &view, &sight, 0);
                let expected = reached.unwrap_or(grid.coarsest());
                assert_eq!(found, expected, "{bounds:?} {view:?}");
                seen += u32::from(reached.is_some());
                unseen += u32::from(reached.is_none());
            }
        }
    }
    assert!(seen > 1000 && unseen > 1000, "{seen} {unseen}");
}

#[test]
fn in_a_window_a_cell_is_as_fine_as_its_finest_probe() {
    let mut random = Random::new(6);
    for grid in grids() {
        for mut view in views(&grid.surface, &mut random) {
            let field = view.field;
            let share = [0.1, 1.0, 1.7][one_of(&mut random, 3)];
            let borders = [field.left, field.right, field.up, field.down];
            view.field.at_eye = Some(borders.map(|tangent| tangent * share));
            for (disc, spread) in [(0.0, 0.0), (3.0, 0.5)] {
                let config = PolicyConfig {
                    acuity: [AcuityModel::LINEAR, AcuityModel::Watson][one_of(&mut random, 2)]
                        .clone(),
                    safety_disc: Radians::from_degrees(disc),
                    ..PolicyConfig::new(Policy::Acuity)
                };
                let selector = Rules::new(grid, config);
                let place = [0, 1].map(|k| random.unit() * f64::from(grid.surface.size[k]));
                let gaze = grid.surface.direction(0, place);
                let glance = glance(view, gaze, spread);
                let sight = selector.sight(&view);
                for bounds in selector.cells.iter() {
                    let finest = probes(&grid, bounds.cell)
                        .filter(|probe| sight.reaches(probe.direction))
                        .map(|probe| selector.allowed_level(&glance, &probe))
                        .min();
                    let found = selector.magnified_level(bounds, &glance);
                    let expected = finest.unwrap_or(grid.coarsest());
                    assert_eq!(found, expected, "{bounds:?} {glance:?}");
                }
            }
        }
    }
}

#[test]
fn what_a_window_magnifies_is_as_fine_as_the_eye_tells_to_its_borders() {
    let surface = Surface::flat([1280, 720], Screen::default());
    let grid = TileGrid::new(surface, Cut::Tile(128), 5, 2).unwrap();
    let config = PolicyConfig {
        margin: Radians::from_degrees(0.1),
        ..PolicyConfig::new(Policy::Acuity)
    };
    let selector = Rules::new(grid, config);
    // 33 pixels from the border between two columns of tiles, 88 pixels across.
    let tangent = |x: f64| (x / 640.0 - 1.0) * surface.tangents[0];
    let field = Field {
        left: -tangent(545.0),
        right: tangent(633.0),
        up: 0.02,
        down: 0.01,
        at_eye: Some([0.37, 0.37, 0.21, 0.21]),
    };
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field,
        size: [1088, 612],
        eye: Eye::Left,
    };
    let glance = glance(view, surface.direction(0, [549.0, 350.0]), 0.5);
    let levels = selector.select(&glance).levels;
    let beside = levels.level(&grid, grid.cell_at(0, [508.0, 350.0]));
    assert_eq!(beside, 0, "a coarse cell fades into what is looked at");
}
