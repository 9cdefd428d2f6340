//! Do several views together get what each of them asks for, and no more?

use super::*;
use crate::content::demand::Demand;
use crate::content::head::ContentHead;
use crate::content::video::demand::VideoDemand;
use crate::content::video::grid::level_map::{histogram, pixels};
use crate::content::video::grid::tile_grid::Cut;
use crate::perception::moment::Moment;
use crate::units::Seconds;
use crate::view::axes::yaw_pitch_from_direction;
use crate::view::head_pose::HeadPose;
use crate::view::mounted::MountedPanel;
use crate::view::panel::rig::Panel;
use crate::view::panel::tests::sets::{six, three, twelve};
use crate::view::random::Random;
use crate::view::surface::{Mapping, Surface};

fn cube_16k() -> TileGrid {
    let surface = Surface::cube(4096).mapped(Mapping::EquiAngular);
    TileGrid::new(surface, Cut::Tile(256), 5, 2).unwrap()
}

fn mounted(panels: &[Panel]) -> Vec<MountedPanel> {
    panels.iter().map(MountedPanel::of).collect()
}

/// The panels of the left eye and their twins.
fn both_eyes(left: &[Panel]) -> Vec<MountedPanel> {
    let twins = left.iter().map(Panel::mirrored);
    mounted(&left.iter().cloned().chain(twins).collect::<Vec<_>>())
}

/// What is seen through panels whose head is turned so that its forward meets a gaze.
fn moment(panels: &[MountedPanel], gaze_in_content: DVec3) -> Moment {
    let (yaw, pitch) = yaw_pitch_from_direction(gaze_in_content);
    let head = HeadPose {
        yaw,
        pitch,
        roll: Radians(0.1),
    };
    let gaze = GazeSample {
        gaze_in_content,
        ..GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0))
    };
    Moment::new(gaze, MountedPanel::views_from(panels, &head, DVec3::ZERO))
}

/// The level of every cell before tiles cover it.
fn levels(config: &PolicyConfig, moment: &Moment) -> Vec<LevelMap> {
    let rules = Rules::new(cube_16k(), config.clone());
    let mut known = KnownAcuity::default();
    let through = |glance: Glance| {
        let occasion = Occasion {
            content: None,
            frame: 0,
            glance: &glance,
        };
        rules.levels_of(&occasion, &mut known, |_| true)
    };
    moment.glances().map(through).collect()
}

fn configs() -> [PolicyConfig; 5] {
    let acuity = |degrees| PolicyConfig {
        safety_disc: Radians::from_degrees(degrees),
        ..PolicyConfig::new(Policy::Acuity)
    };
    [
        acuity(0.0),
        acuity(3.0),
        PolicyConfig {
            acuity: AcuityModel::Watson,
            ..acuity(0.0)
        },
        PolicyConfig::new(Policy::Viewport),
        PolicyConfig::new(Policy::Distance),
    ]
}

#[test]
fn a_cell_gets_the_finest_level_that_any_panel_asks_for() {
    let mut random = Random::new(9);
    for config in configs() {
        let panels = both_eyes(&six());
        let moment = moment(&panels, random.direction());
        let grid = cube_16k();
        let alone = moment.views.iter().map(|view| {
            let alone = Moment {
                views: vec![*view],
                ..moment.clone()
            };
            // With nothing known from other panels.
            levels(&config, &alone).remove(0)
        });
        let mut finest = LevelMap::filled(&grid, grid.coarsest());
        for (own, together) in alone.zip(levels(&config, &moment)) {
            assert_eq!(own, together, "{config:?}");
            finest.refine_to(&own);
        }
        let tiles = finest.cover(&grid);
        let head = ContentHead::of_video(grid);
        let config = PolicyConfig {
            steadiness: Radians(0.0),
            together: true,
            ..config
        };
        let mut demand = VideoDemand::of_head(&head, &config);
        let chosen = demand.needed(0, &moment).record;
        assert_eq!(demand.levels(), Some(&finest), "{config:?}");
        assert_eq!(chosen.per_level, histogram(&grid, &tiles));
        assert_eq!(chosen.samples, pixels(&grid, &tiles));
    }
}

#[test]
fn what_skips_cells_and_probes_gives_the_levels_that_all_probes_give() {
    let (mut random, grid) = (Random::new(4), cube_16k());
    for (degrees, panels) in [(0.0, mounted(&six())), (4.0, mounted(&three()[..1]))] {
        let config = PolicyConfig {
            safety_disc: Radians::from_degrees(degrees),
            ..PolicyConfig::new(Policy::Acuity)
        };
        let rules = Rules::new(grid, config.clone());
        let moment = moment(&panels, random.direction());
        let found = levels(&config, &moment);
        for (levels, glance) in found.iter().zip(moment.glances()) {
            let view = glance.view.unwrap();
            let sight = rules.sight(&view);
            for (rank, bounds) in rules.cells.iter().enumerate() {
                let all = || probes(&grid, bounds.cell);
                let resolved = all()
                    .map(|probe| rules.allowed_level(&glance, &probe))
                    .min();
                let seen = all().filter(|probe| sight.reaches(probe.direction));
                let shown = seen.map(|probe| rules.level_shown(&view, &probe)).min();
                let nearest = bounds.least_eccentricity(glance.gaze.gaze_in_content);
                let disc = rules.disc_footprint(nearest, bounds.least_ppd());
                let exempt = level_of_footprint(&grid, disc);
                let shown = shown.unwrap_or(grid.coarsest()).min(exempt);
                assert_eq!(
                    levels.levels()[rank],
                    resolved.unwrap().max(shown),
                    "{bounds:?}"
                );
            }
        }
    }
}

#[test]
fn the_eye_is_asked_once_for_all_panels_of_a_density() {
    let rules = Rules::new(cube_16k(), PolicyConfig::new(Policy::Acuity));
    let mut other = three();
    other[1].view.size = [400, 300];
    for (panels, densities) in [(mounted(&three()), 1), (mounted(&other), 2)] {
        let mut known = KnownAcuity::default();
        for glance in moment(&panels, DVec3::NEG_Z).glances() {
            let occasion = Occasion {
                content: None,
                frame: 0,
                glance: &glance,
            };
            let _ = rules.levels_of(&occasion, &mut known, |_| true);
        }
        assert_eq!(known.eyes(), densities);
    }
}

#[test]
fn a_second_eye_adds_a_twentieth_of_the_tiles_at_most() {
    let config = PolicyConfig {
        steadiness: Radians(0.0),
        together: true,
        ..PolicyConfig::new(Policy::Acuity)
    };
    let mut demand = VideoDemand::of_head(&ContentHead::of_video(cube_16k()), &config);
    for left in [three(), six(), twelve()] {
        let mut random = Random::new(1);
        let (mut of_one, mut of_both) = (0, 0);
        for _ in 0..30 {
            let gaze = random.direction();
            let mut tiles = |panels: &[MountedPanel]| {
                let chosen = demand.needed(0, &moment(panels, gaze)).record;
                chosen.per_level.iter().sum::<u32>()
            };
            of_one += tiles(&mounted(&left));
            of_both += tiles(&both_eyes(&left));
        }
        assert!(of_one <= of_both && f64::from(of_both) <= 1.05 * f64::from(of_one));
    }
}

#[test]
fn panels_turned_one_way_and_the_head_back_show_the_same() {
    let head = HeadPose {
        yaw: Radians(0.7),
        pitch: Radians(-0.4),
        roll: Radians(0.2),
    };
    for panel in mounted(&twelve()) {
        let back = |v: [f64; 3]| head.head_from_content(DVec3::from_array(v)).to_array();
        let there = MountedPanel {
            right: back(panel.right),
            down: back(panel.down),
            forward: back(panel.forward),
            position: back(panel.position),
            ..panel.clone()
        };
        let (own, turned) = (panel.turned(&HeadPose::default()), there.turned(&head));
        for place in [[0.5, 0.5], [400.0, 300.0], [799.5, 10.5]] {
            assert!((own.ray(place) - turned.ray(place)).length() < 1e-12);
        }
        assert!(there.fault().is_none());
    }
}
