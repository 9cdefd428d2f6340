//! Is the choice the same whether what was found before is kept or forgotten?

use super::*;
use crate::content::video::grid::tile_grid::{Cut, Tile};
use crate::gaze::sample::{GazeSample, HeadPose};
use crate::pack::unit::UnitId;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::cues::Cues;
use crate::units::{Radians, Seconds};
use crate::view::axes::{direction_at, yaw_pitch_from_direction};
use crate::view::eye_view::{EyeView, Field};
use crate::view::random::Random;
use crate::view::surface::{Eye, Screen, Surface};
use glam::DVec3;

const GROUP: u32 = 8;

/// Content of which every unit adds something else.
#[derive(Debug)]
struct Mixed(UnknownUnits);

impl VideoUnits for Mixed {
    fn has_signatures(&self) -> bool {
        true
    }

    fn tells_of_noise(&self) -> bool {
        true
    }

    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        let UnitId(first) = self.0.unit(tile, frame);
        UnitId(first | (frame / GROUP) << 16)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        Some((frame / GROUP + 1) * GROUP)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        1000 + unit.0 % 300
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

fn grids() -> [TileGrid; 3] {
    let flat = Surface::flat([1920, 1080], Screen::default());
    let cube = Surface::cube(1024);
    [
        TileGrid::new(cube, Cut::Tile(128), 4, 2).unwrap(),
        TileGrid::new(cube.for_two_eyes(), Cut::Tile(256), 3, 2).unwrap(),
        TileGrid::new(flat, Cut::Tile(128), 4, 2).unwrap(),
    ]
}

/// What a viewer does.
#[derive(Clone, Copy, Debug)]
enum Viewer {
    /// Looks anywhere in each frame.
    Jumps,
    /// Looks at a place for twenty frames with an eye that trembles, and turns the head.
    Turns,
    /// The same with an eye that is still, through three panels of two densities.
    Panels,
    /// The same through a picture for each eye.
    TwoEyes,
}

fn moment(
    grid: &TileGrid,
    viewer: Viewer,
    frame: u32,
    random: &mut Random,
    at: &mut DVec3,
) -> Moment {
    let stays = !matches!(viewer, Viewer::Jumps) && !frame.is_multiple_of(20);
    let is_flat = grid.faces() == 1;
    if !stays {
        let place = grid
            .surface
            .size
            .map(|side| random.unit() * f64::from(side));
        *at = match is_flat {
            true => grid.surface.direction(0, place),
            false => random.direction(),
        };
    }
    let trembles = Radians::from_degrees(match viewer {
        Viewer::Turns => 0.4 * random.unit(),
        _ => 0.0,
    });
    let gaze_in_content = direction_at(*at, Radians(6.0 * random.unit()), trembles);
    let (yaw, pitch) = yaw_pitch_from_direction(*at);
    let turned = Radians::from_degrees(6.0).0 * f64::from(frame % 20);
    let head = HeadPose {
        yaw: Radians(yaw.0 - 0.4 + turned),
        pitch,
        roll: Radians(0.1),
    };
    let size = [900, 700];
    let view = EyeView {
        position: DVec3::ZERO,
        axes: head.axes(),
        field: Field::across(Radians::from_degrees(80.0), size),
        size,
        eye: Eye::Left,
    };
    let view = match is_flat {
        true => EyeView::filling(&grid.surface, size),
        false => view,
    };
    let gaze = GazeSample {
        gaze_in_content,
        spread: Radians::from_degrees(0.5 * f64::from(frame / 40 % 2)),
        ..GazeSample::at(Seconds(f64::from(frame)), Radians(0.0), Radians(0.0))
    };
    Moment::new(gaze, views_of(viewer, view, &head))
}

fn views_of(viewer: Viewer, view: EyeView, head: &HeadPose) -> Vec<EyeView> {
    let aside = HeadPose {
        yaw: Radians(head.yaw.0 + 0.5),
        ..*head
    };
    let aside = EyeView {
        axes: aside.axes(),
        ..view
    };
    let denser = EyeView {
        size: [1000, 800],
        ..aside
    };
    let right = EyeView {
        eye: Eye::Right,
        ..view
    };
    match viewer {
        Viewer::Panels => vec![view, aside, denser],
        Viewer::TwoEyes => vec![view, right],
        _ => vec![view],
    }
}

fn configs() -> [PolicyConfig; 4] {
    let of = |policy, target| PolicyConfig {
        target,
        ..PolicyConfig::new(policy)
    };
    [
        of(Policy::Acuity, Some(9.0)),
        of(Policy::Perceptual, Some(9.0)),
        of(Policy::Acuity, None),
        PolicyConfig {
            steadiness: Radians(0.0),
            ..of(Policy::Perceptual, Some(9.5))
        },
    ]
}

#[test]
fn what_is_kept_between_frames_changes_no_choice() {
    use Viewer::{Jumps, Panels, Turns, TwoEyes};
    for grid in grids() {
        let content = Arc::new(Mixed(UnknownUnits::new(grid)));
        for (config, viewer) in configs()
            .iter()
            .flat_map(|config| [Jumps, Turns, Panels, TwoEyes].map(|viewer| (config, viewer)))
        {
            let mut keeps = VideoDemand::new(content.clone(), grid, config.clone());
            let mut forgets = keeps.clone();
            let (mut random, mut at) = (Random::new(3), DVec3::NEG_Z);
            let frames = match (viewer, grid.faces()) {
                (Jumps, 6) => 200,
                _ => 44,
            };
            for frame in 0..frames {
                let moment = moment(&grid, viewer, frame, &mut random, &mut at);
                forgets.known = KnownAcuity::default();
                forgets.rules.iter_mut().for_each(Rule::forget_losses);
                let found = keeps.needed(frame, &moment);
                let alone = forgets.needed(frame, &moment);
                assert_eq!(found, alone, "{viewer:?} {frame} {config:?}");
                assert_eq!(keeps.levels(), forgets.levels());
            }
            assert!(keeps.known.eyes() <= KnownAcuity::MOST_EYES);
        }
    }
}
