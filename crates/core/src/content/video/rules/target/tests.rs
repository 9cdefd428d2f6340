//! Do levels keep the score that they are chosen for, no finer than that and no less steady?

use super::*;
use crate::content::video::calibration::{Calibration, CalibrationRow};
use crate::content::video::grid::tile_grid::{Cut, Tile};
use crate::content::video::rules::Rules;
use crate::gaze::sample::GazeSample;
use crate::perception::measures::contrast::{BandContrast, Signature};
use crate::perception::measures::cues::Cues;
use crate::perception::parameters::EyeState;
use crate::perception::visible_loss::jod_lost;
use crate::units::Seconds;
use crate::view::axes::Axes;
use crate::view::eye_view::{EyeView, Field};
use crate::view::frustum::Frustum;
use crate::view::surface::{Screen, Surface};

/// Content whose steps add what a function says, the same everywhere.
struct Texture<F>(F);

impl<F> core::fmt::Debug for Texture<F> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Texture")
    }
}

impl<F: Fn(u8, u32) -> f64 + Send + Sync> VideoUnits for Texture<F> {
    fn has_signatures(&self) -> bool {
        true
    }

    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        let place = u32::from(tile.face) << 12 | u32::from(tile.y) << 6 | u32::from(tile.x);
        UnitId(place | u32::from(tile.level) << 16 | (frame / 8) << 20)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        Some((frame / 8 + 1) * 8)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        1000 + unit.0 % 300
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        let contrast = self.0((unit.0 >> 16 & 15) as u8, unit.0 & 0xffff);
        let band = BandContrast {
            before: 0.0,
            after: contrast,
            difference: contrast,
            norm: 2.0 * contrast,
        };
        Some(Signature {
            bands: [band, BandContrast::default(), BandContrast::default()],
        })
    }

    fn cues(&self, _: UnitId) -> Option<Cues> {
        None
    }
}

/// As busy in every octave everywhere.
fn busy(_: u8, _: u32) -> f64 {
    0.1
}

fn screen() -> TileGrid {
    let surface = Surface::flat([1920, 1080], Screen::default());
    TileGrid::new(surface, Cut::Tile(64), 5, 2).unwrap()
}

fn sphere() -> TileGrid {
    TileGrid::new(Surface::cube(1024), Cut::Tile(128), 5, 2).unwrap()
}

fn config(policy: Policy, target: f64) -> PolicyConfig {
    PolicyConfig {
        target: Some(target),
        ..PolicyConfig::new(policy)
    }
}

fn glance(grid: &TileGrid, yaw_deg: f64) -> Glance {
    let size = [1280, 720];
    let view = match grid.faces() {
        1 => EyeView::filling(&grid.surface, [1920, 1080]),
        _ => EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::across(Radians::from_degrees(90.0), size),
            size,
            eye: Default::default(),
        },
    };
    Glance {
        gaze: GazeSample::at(Seconds(0.0), Radians::from_degrees(yaw_deg), Radians(0.0)),
        view: Some(view),
        state: EyeState::Steady,
    }
}

fn chosen(grid: TileGrid, config: &PolicyConfig, content: &dyn VideoUnits) -> LevelMap {
    let glance = glance(&grid, 0.0);
    match TargetSelector::new(&grid, config) {
        Some(mut selector) => selector.select(content, 0, &glance).levels,
        None => {
            let mut rule = SteadySelector::new(grid, config.clone());
            rule.select(None, 0, &glance).levels
        }
    }
}

fn expected(grid: &TileGrid, policy: Policy, content: &dyn VideoUnits, levels: &LevelMap) -> f64 {
    let meter = LossMeter::new(grid, &PolicyConfig::new(policy).perception);
    let losses = meter.losses(grid, content, 0, &glance(grid, 0.0));
    policy.expectation().jod(losses.pooled(levels))
}

#[test]
fn the_target_is_expected_or_the_least_slope_taken_and_a_higher_one_never_expects_less() {
    let content = Texture(busy);
    for grid in [screen(), sphere()] {
        for policy in [Policy::Perceptual, Policy::Acuity] {
            let mut before = 0.0;
            for target in [7.5, 8.5, 9.0, 9.25, 9.5, 9.75, 9.9] {
                let levels = chosen(grid, &config(policy, target), &content);
                let jod = expected(&grid, policy, &content, &levels);
                let is_least = policy == Policy::Acuity && {
                    let least = PolicyConfig {
                        acuity: AcuityModel::linear(LEAST_SLOPE * slope_for(target)),
                        target: None,
                        ..config(policy, target)
                    };
                    levels == chosen(grid, &least, &content)
                };
                assert!(jod >= target || is_least, "{policy:?} {target}: {jod}");
                assert!(jod >= before - 1e-9, "{policy:?} {target}: {jod} {before}");
                before = jod;
            }
        }
    }
}

#[test]
fn no_more_than_the_target_is_shown_where_cells_are_small() {
    let content = Texture(busy);
    for target in [8.0, 9.0, 9.5] {
        let levels = chosen(screen(), &config(Policy::Perceptual, target), &content);
        let jod = expected(&screen(), Policy::Perceptual, &content, &levels);
        assert!(jod < target + 0.3, "{target}: {jod}");
    }
}

#[test]
fn what_is_plain_stays_coarse_under_perceptual_alone() {
    // Busy to the left of column 15, plain to the right.
    let half = |level: u8, place: u32| match (place & 63) << level < 15 {
        true => 0.1,
        false => 0.0,
    };
    let grid = screen();
    let level = |policy, x| {
        let levels = chosen(grid, &config(policy, 9.5), &Texture(half));
        levels.level(
            &grid,
            Tile {
                level: 0,
                face: 0,
                x,
                y: 8,
            },
        )
    };
    // Two columns as far to both sides of the gaze.
    let [left, right] = [13, 16].map(|x| level(Policy::Perceptual, x));
    assert!(left < right && right == grid.coarsest(), "{left} {right}");
    let [left, right] = [13, 16].map(|x| level(Policy::Acuity, x));
    assert_eq!(left, right);
}

/// A grating in one octave of the finest level: lost by every level coarser than that octave's.
fn grating(octave: u8) -> Texture<impl Fn(u8, u32) -> f64> {
    Texture(move |level, _| if level == octave { 0.1 } else { 0.0 })
}

#[test]
fn a_grating_that_is_seen_is_kept_and_one_that_is_too_fine_to_be_seen_is_not() {
    let grid = screen();
    // 40 pixels a degree: octaves round 10, 5, 2.5 and 1.25 cycles per degree.
    let finest_kept = |x| {
        let is_kept = |octave: u8| {
            let levels = chosen(grid, &config(Policy::Perceptual, 9.5), &grating(octave));
            let cell = Tile {
                level: 0,
                face: 0,
                x,
                y: 8,
            };
            levels.level(&grid, cell) <= octave
        };
        let kept: Vec<bool> = (0..4).map(is_kept).collect();
        let finest = kept.iter().position(|kept| *kept).unwrap();
        assert!(
            kept[finest..].iter().all(|kept| *kept),
            "column {x}: {kept:?}"
        );
        finest
    };
    // At the gaze, 10° and 20° from it.
    let [fovea, near, far] = [15, 21, 28].map(finest_kept);
    assert!(
        fovea <= near && near <= far && fovea < far,
        "{fovea} {near} {far}"
    );
}

#[test]
fn acuity_is_nowhere_finer_than_viewport() {
    for grid in [screen(), sphere()] {
        for yaw in [0.0, 20.0, 100.0] {
            let glance = glance(&grid, yaw);
            let levels = |policy| {
                let config = PolicyConfig {
                    acuity: AcuityModel::linear(0.0),
                    ..PolicyConfig::new(policy)
                };
                Rules::new(grid, config).select(&glance).levels
            };
            let [acuity, viewport] = [Policy::Acuity, Policy::Viewport].map(levels);
            for (acuity, viewport) in acuity.levels().iter().zip(viewport.levels()) {
                assert!(acuity >= viewport, "{yaw}");
            }
        }
    }
}

#[test]
fn a_still_eye_changes_no_level_from_frame_to_frame() {
    for policy in [Policy::Perceptual, Policy::Acuity] {
        for grid in [screen(), sphere()] {
            // What a group adds trembles by a tenth from group to group.
            let mut selector = TargetSelector::new(&grid, &config(policy, 9.5)).unwrap();
            let mut at = |frame: u32| {
                let contrast = if (frame / 8).is_multiple_of(2) {
                    0.1
                } else {
                    0.108
                };
                let content = Texture(move |_, _| contrast);
                let gaze = 0.1 * f64::from(frame % 3);
                selector
                    .select(&content, frame, &glance(&grid, gaze))
                    .levels
            };
            let settled = (0..24).map(&mut at).last().unwrap();
            for frame in 24..80 {
                assert_eq!(at(frame), settled, "{policy:?} frame {frame}");
            }
        }
    }
}

#[test]
fn a_view_is_as_sharp_at_its_borders_as_inside_them() {
    let content = Texture(busy);
    let grid = sphere();
    let glance = |degrees| {
        let wide = glance(&grid, 0.0);
        let field = Field::across(Radians::from_degrees(degrees), [1000; 2]);
        let view = wide.view.map(|view| EyeView {
            field,
            size: [1000; 2],
            ..view
        });
        Glance { view, ..wide }
    };
    let config = config(Policy::Perceptual, 9.5);
    let mut selector = TargetSelector::new(&grid, &config).unwrap();
    let levels = selector.select(&content, 0, &glance(42.0)).levels;
    let level_at = |yaw: f64, pitch: f64| {
        let [yaw, pitch] = [yaw, pitch].map(Radians::from_degrees);
        let direction = crate::view::axes::direction_from_yaw_pitch(yaw, pitch);
        let (face, place) = grid.surface.locate(direction).unwrap();
        levels.level(&grid, grid.cell_at(face, place))
    };
    for along in [-18.0, -8.0, 3.0, 14.0] {
        for [inside, beside] in [[20.0, 24.0], [-20.0, -24.0]] {
            assert!(level_at(beside, along) <= level_at(inside, along) + 1);
            assert!(level_at(along, beside) <= level_at(along, inside) + 1);
        }
    }
    assert_eq!(level_at(180.0, 0.0), grid.coarsest());
}

/// A glance ahead, with the head turned to a yaw and a pitch in degrees.
fn turned(grid: &TileGrid, yaw_deg: f64, pitch_deg: f64) -> Glance {
    let ahead = glance(grid, 0.0);
    let [yaw, pitch] = [yaw_deg, pitch_deg].map(Radians::from_degrees);
    let axes = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
    let view = ahead.view.map(|view| EyeView { axes, ..view });
    Glance { view, ..ahead }
}

#[test]
fn levels_stay_as_the_head_turns_and_the_slope_follows_when_it_has_turned_far() {
    // Busy on the face ahead, plain on the others: turning away from it asks for another slope.
    let content = Texture(|_: u8, place: u32| if place >> 12 == 0 { 0.1 } else { 0.001 });
    let grid = sphere();
    let config = config(Policy::Acuity, 9.5);
    let fresh = |degrees| {
        let mut chooser = TargetSelector::new(&grid, &config).unwrap();
        let chosen = chooser.select(&content, 0, &turned(&grid, degrees, 0.0));
        (chooser.before.unwrap().step, chosen.levels)
    };
    let mut chooser = TargetSelector::new(&grid, &config).unwrap();
    let first = chooser.select(&content, 0, &turned(&grid, 0.0, 0.0));
    let (ahead, far) = (fresh(0.0).0, fresh(120.0).0);
    assert_ne!(ahead, far, "the content asks for one slope everywhere");
    let near = chooser.select(&content, 0, &turned(&grid, 10.0, 0.0));
    assert_eq!(near.levels, first.levels);
    // What has come into view is at most a level coarser than for a head that pointed there before.
    let mut rule = Rules::new(grid, config.clone());
    rule.set_acuity(slope_of(9.5, ahead));
    let needed = rule.select(&turned(&grid, 10.0, 0.0)).levels;
    let mut cells = near.levels.levels().iter().zip(needed.levels());
    assert!(cells.all(|(shown, needed)| *shown <= needed + 1));
    let _ = chooser.select(&content, 0, &turned(&grid, 120.0, 0.0));
    assert_eq!(chooser.before.unwrap().step, far);
}

#[test]
fn a_nodding_head_under_a_steady_eye_changes_no_level_from_group_to_group() {
    // Busier from left to right, so that what is in view changes with the head.
    let content = Texture(|_: u8, place: u32| 0.02 + 0.02 * f64::from(place & 7));
    let grid = sphere();
    for policy in [Policy::Perceptual, Policy::Acuity] {
        let chooser = || TargetSelector::new(&grid, &config(policy, 9.5)).unwrap();
        let (mut nodding, mut still) = (chooser(), chooser());
        let mut settled = None;
        for frame in 0..80 {
            let nod = 9.0 * libm::sin(f64::from(frame) * 0.4);
            let [nodded, ahead] = [nod, 0.0].map(|nod| turned(&grid, 0.3 * nod, nod));
            let shown = nodding.select(&content, frame, &nodded).levels;
            let expected = still.select(&content, frame, &ahead).levels;
            assert_eq!(shown, expected, "{policy:?} frame {frame}");
            if frame >= 24 {
                let settled = settled.get_or_insert(shown.clone());
                assert_eq!(shown, *settled, "{policy:?} frame {frame}");
            }
        }
    }
}

#[test]
fn what_a_far_nod_brings_into_view_is_there_before_and_stays() {
    let content = Texture(|_: u8, place: u32| 0.02 + 0.02 * f64::from(place & 7));
    let grid = sphere();
    for policy in [Policy::Perceptual, Policy::Acuity] {
        let mut chooser = TargetSelector::new(&grid, &config(policy, 9.5)).unwrap();
        let rules = Rules::new(grid, config(policy, 9.5));
        let mut before: Option<(EyeView, LevelMap)> = None;
        for frame in 0..80 {
            let nod = 27.0 * libm::sin(f64::from(frame) * 0.3);
            let glance = turned(&grid, 0.1 * nod, nod);
            let levels = chooser.select(&content, frame, &glance).levels;
            if let Some((view, before)) = &before {
                let sight = Frustum::new(view, Radians(0.0));
                let in_view = rules.cells.iter().map(|cell| !cell.is_beyond(&sight));
                let changed = levels.levels().iter().zip(before.levels());
                for (changed, in_view) in changed.map(|(is, was)| is != was).zip(in_view) {
                    assert!(
                        !changed || !in_view && frame < 24,
                        "{policy:?} frame {frame}"
                    );
                }
            }
            before = glance.view.map(|view| (view, levels));
        }
    }
}

#[test]
fn nothing_changes_within_a_group_while_the_gaze_stays_within_the_steadiness() {
    let content = Texture(busy);
    for grid in [screen(), sphere()] {
        let mut chooser = TargetSelector::new(&grid, &config(Policy::Perceptual, 9.5)).unwrap();
        let mut at = |yaw| chooser.select(&content, 0, &glance(&grid, yaw)).levels;
        let first = at(0.0);
        for yaw in [0.9, -0.9, 0.4, -0.99, 0.99] {
            assert_eq!(at(yaw), first, "{yaw}");
        }
        assert_ne!(at(9.0), first);
    }
}

#[test]
fn a_head_that_nods_however_far_makes_nothing_coarser_while_the_eye_stays() {
    let content = Texture(busy);
    let grid = sphere();
    let mut chooser = TargetSelector::new(&grid, &config(Policy::Perceptual, 9.5)).unwrap();
    let mut at = |yaw| {
        let glance = turned(&grid, yaw, 0.0);
        chooser.select(&content, 0, &glance).levels
    };
    let mut before = at(0.0);
    for step in 1..60 {
        let levels = at(40.0 * libm::sin(f64::from(step) * 0.3));
        let pairs = levels.levels().iter().zip(before.levels());
        assert!(pairs.clone().all(|(is, was)| is <= was), "step {step}");
        assert!(step < 22 || levels == before, "step {step}");
        before = levels;
    }
}

#[test]
fn what_a_turned_head_shows_is_within_half_a_jod_of_the_target() {
    let content = Texture(busy);
    let grid = sphere();
    for policy in [Policy::Perceptual, Policy::Acuity] {
        let mut chooser = TargetSelector::new(&grid, &config(policy, 9.5)).unwrap();
        let mut jod_at = |yaw| {
            let glance = turned(&grid, yaw, 0.0);
            let levels = chooser.select(&content, 0, &glance).levels;
            let meter = LossMeter::new(&grid, &PolicyConfig::new(policy).perception);
            let losses = meter.losses(&grid, &content, 0, &glance);
            policy.expectation().jod(losses.pooled(&levels))
        };
        for yaw in [0.0, 10.0, 20.0] {
            let jod = jod_at(yaw);
            // At the border of its view a turned head is shown a level less, here busy everywhere.
            let least = if yaw == 0.0 { 9.5 } else { 9.0 };
            assert!(jod >= least, "{policy:?} {yaw}: {jod}");
        }
    }
}

/// Content that a judge saw.
#[derive(Debug)]
struct Judged(Texture<fn(u8, u32) -> f64>, Scale);

impl VideoUnits for Judged {
    fn has_signatures(&self) -> bool {
        true
    }

    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        self.0.unit(tile, frame)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        self.0.next_group(frame)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        self.0.bytes(unit)
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        self.0.signature(unit)
    }

    fn cues(&self, _: UnitId) -> Option<Cues> {
        None
    }

    fn scale(&self, _: Option<&EyeView>) -> Scale {
        self.1.clone()
    }
}

/// What a judge finds who sees as much lost as signatures predict, at any density.
fn as_foretold() -> Scale {
    let row = |bound: f64| CalibrationRow {
        rule: Expectation::ByLoss,
        ppd: 20.0,
        zone: None,
        bound,
        loss: bound / 2.0,
        jod_mean: BEST_JOD - jod_lost(bound / 2.0),
        jod_sd: 0.0,
        pixels_share: 0.5 / bound,
        bytes: 1,
    };
    let rows = [1.0, 20.0, 100.0, 500.0, 2000.0, 8000.0].map(row);
    let calibration = Calibration::new(1, 1, rows.to_vec()).unwrap();
    calibration.at(None)
}

#[test]
fn of_a_few_large_tiles_the_choice_nearest_to_the_target_is_taken_where_a_judge_saw_them() {
    let surface = Surface::flat([640, 360], Screen::default());
    let grid = TileGrid::new(surface, Cut::Tile(128), 3, 2).unwrap();
    let content = Judged(Texture(busy), as_foretold());
    let meter = LossMeter::new(&grid, &PolicyConfig::new(Policy::Perceptual).perception);
    let losses = meter.losses(&grid, &content, 0, &glance(&grid, 0.0));
    let mut below = 0;
    for hundredths in 800..995 {
        let target = f64::from(hundredths) / 100.0;
        let levels = chosen(grid, &config(Policy::Perceptual, target), &content);
        let expected = content.1.expected(Expectation::ByLoss, &losses.of(&levels));
        let jod = expected.for_target();
        assert!(jod >= target - BELOW_TARGET_JOD, "{target}: {jod}");
        below += u32::from(jod < target);
    }
    assert!((1..195).contains(&below), "{below} of 195 below the target");
}
