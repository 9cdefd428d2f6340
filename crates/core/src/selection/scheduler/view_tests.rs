//! Are several views served together, each as well as alone?

use super::Scheduler;
use crate::content::demand::{Chosen, Demand};
use crate::content::policy::{Policy, PolicyConfig};
use crate::content::scripted::{scripted_head, scripted_units};
use crate::content::video::demand::VideoDemand;
use crate::content::video::grid::level_map::LevelMap;
use crate::gaze::sample::{GazeSample, HeadPose};
use crate::perception::moment::Moment;
use crate::units::{Radians, Seconds};
use crate::view::eye_view::{EyeView, Field};
use crate::view::surface::{Eye, Screen, Surface};
use glam::DVec3;

/// All policies, with a score where a policy keeps one, and without.
fn configs() -> impl Iterator<Item = PolicyConfig> {
    let plain = Policy::ALL.map(PolicyConfig::new);
    let kept = [Policy::Acuity, Policy::Perceptual].map(|policy| PolicyConfig {
        target: Some(9.0),
        ..PolicyConfig::new(policy)
    });
    plain.into_iter().chain(kept)
}

fn surfaces() -> [Surface; 2] {
    let flat = Surface::flat([3840, 2160], Screen::default());
    [Surface::cube(1024), flat]
}

/// A view at a yaw in degrees that reaches so far to the left and to the right, in tangents.
fn view(yaw_deg: f64, [left, right]: [f64; 2]) -> EyeView {
    let head = HeadPose {
        yaw: Radians::from_degrees(yaw_deg),
        ..HeadPose::default()
    };
    EyeView {
        position: DVec3::ZERO,
        axes: head.axes(),
        field: Field::of([left, right, 0.9, 0.9]),
        size: [(500.0 * (left + right)) as u32, 900],
        eye: Eye::default(),
    }
}

fn looking(gaze_deg: f64, views: &[EyeView]) -> Moment {
    let yaw = Radians::from_degrees(gaze_deg);
    let gaze = GazeSample::at(Seconds(0.0), yaw, Radians::from_degrees(4.0));
    Moment::new(gaze, views.to_vec())
}

fn demand(surface: Surface, config: &PolicyConfig) -> VideoDemand {
    let grid = *scripted_head(surface).video().unwrap();
    VideoDemand::new(scripted_units(), grid, config.clone())
}

/// What is chosen for a moment by itself, and at which levels.
fn choose(surface: Surface, config: &PolicyConfig, moment: &Moment) -> (Chosen, LevelMap) {
    let demand = demand(surface, config);
    let chosen = Scheduler::new(config, vec![Box::new(demand)])
        .choose(&[0], moment, None)
        .remove(0);
    let grid = *scripted_head(surface).video().unwrap();
    let mut levels = LevelMap::filled(&grid, grid.coarsest());
    for tile in grid.tiles_of(0) {
        for level in 0..grid.coarsest() {
            let unit = scripted_units().unit(grid.tile_over(tile, level), 0);
            if chosen.units.contains(&unit) {
                levels.refine(&grid, tile, level);
            }
        }
    }
    (chosen, levels)
}

fn is_nowhere_coarser(one: &LevelMap, other: &LevelMap) -> bool {
    let mut cells = one.levels().iter().zip(other.levels());
    cells.all(|(one, other)| one <= other)
}

#[test]
fn two_views_are_nowhere_shown_coarser_than_either_alone() {
    let [left, right] = [view(-20.0, [0.9, 0.7]), view(25.0, [0.5, 0.8])];
    for surface in surfaces() {
        for config in configs() {
            let both = choose(surface, &config, &looking(3.0, &[left, right])).1;
            for alone in [left, right] {
                let alone = choose(surface, &config, &looking(3.0, &[alone])).1;
                assert!(is_nowhere_coarser(&both, &alone), "{:?}", config.policy);
            }
        }
    }
}

#[test]
fn one_view_twice_changes_nothing() {
    let view = view(10.0, [0.9, 0.7]);
    for surface in surfaces() {
        for config in configs() {
            let once = choose(surface, &config, &looking(3.0, &[view]));
            let twice = choose(surface, &config, &looking(3.0, &[view, view]));
            assert_eq!(once, twice, "{:?}", config.policy);
        }
    }
}

#[test]
fn one_view_twice_buys_the_same_within_a_budget() {
    let view = view(10.0, [0.9, 0.7]);
    for policy in [Policy::Uniform, Policy::Eccentricity, Policy::Perceptual] {
        let config = PolicyConfig::new(policy);
        let [once, twice] = [vec![view], vec![view, view]].map(|views| {
            let demand = demand(Surface::cube(1024), &config);
            let mut scheduler = Scheduler::new(&config, vec![Box::new(demand)]);
            let moment = looking(3.0, &views);
            let budget = Some(40_000);
            let frames = 0..4;
            let chosen = frames.map(|frame| scheduler.choose(&[frame], &moment, budget));
            chosen.collect::<Vec<_>>()
        });
        assert_eq!(once, twice, "{policy:?}");
    }
}

#[test]
fn two_eyes_are_shown_no_coarser_than_one_view_that_holds_what_both_see() {
    let [left, right] = [view(0.0, [1.0, 0.8]), view(0.0, [0.8, 1.0])];
    let union = view(0.0, [1.0, 1.0]);
    for config in configs().filter(|config| config.target.is_none()) {
        for gaze in [-30.0, 0.0, 12.0] {
            let surface = Surface::cube(1024);
            let both = choose(surface, &config, &looking(gaze, &[left, right])).1;
            let union = choose(surface, &config, &looking(gaze, &[union])).1;
            assert!(is_nowhere_coarser(&both, &union), "{:?}", config.policy);
        }
    }
}

#[test]
fn forty_eight_panels_around_a_viewer_are_all_served() {
    let panels: Vec<EyeView> = (0..48)
        .map(|k| view(f64::from(k) * 7.5 - 180.0, [0.07, 0.07]))
        .collect();
    let surface = Surface::cube(1024);
    let config = PolicyConfig::new(Policy::Viewport);
    let all = choose(surface, &config, &looking(0.0, &panels)).1;
    for panel in panels.iter().step_by(7) {
        let alone = choose(surface, &config, &looking(0.0, &[*panel])).1;
        assert!(is_nowhere_coarser(&all, &alone));
    }
    let grid = *scripted_head(surface).video().unwrap();
    let above = Surface::cube(1024)
        .locate(DVec3::Y)
        .map(|(face, place)| grid.cell_at(face, place));
    let above = above.map(|cell| all.level(&grid, cell));
    assert_eq!(above, Some(grid.coarsest()), "no viewer looks up");
}

#[test]
fn where_the_eye_is_changes_nothing_on_a_sphere() {
    let here = view(10.0, [0.9, 0.7]);
    let there = EyeView {
        position: DVec3::new(0.3, -1.6, 7.0),
        ..here
    };
    for config in configs() {
        let mut demand = demand(Surface::cube(1024), &config);
        if demand.buys(None) {
            continue;
        }
        let [first, second] = [here, there].map(|view| demand.needed(0, &looking(3.0, &[view])));
        assert_eq!(first, second, "{:?}", config.policy);
    }
}
