//! Does what must hold of any panel, source and optics hold?

use super::sets::{panel, six, three, twelve};
use crate::units::Radians;
use crate::view::axes::Axes;
use crate::view::panel::distortion::{Distortion, GREEN};
use crate::view::panel::drawn_grid::DrawnGrid;
use crate::view::panel::fit::{FitError, PanelFilter, PlacementRule, SourceSize, fit, place};
use crate::view::panel::footprint::Probes;
use crate::view::panel::lens::{BrownConrady, Bulge, RadialPolynomial};
use crate::view::panel::pixel_map::{PixelMap, homography};
use crate::view::panel::placement::{Placement, SourceProjection};
use crate::view::panel::residual_grid::ResidualGrid;
use crate::view::panel::rig::{Panel, Scanout};
use crate::view::panel::seed::{
    CHANGE_STEP, SeedPlane, SeedTexel, edge_means, panels_by_fill_rate,
};
use glam::{DMat3, DVec3};
use proptest::prelude::*;
use std::sync::Arc;

const SOURCE: [u32; 2] = [1600, 1200];
const RULES: [PlacementRule; 5] = [
    PlacementRule::Auto,
    PlacementRule::Seed,
    PlacementRule::Plane,
    PlacementRule::Cylinder,
    PlacementRule::Equirect,
];
const PROJECTIONS: [SourceProjection; 4] = [
    SourceProjection::Plane,
    SourceProjection::Cylinder,
    SourceProjection::Equirect,
    SourceProjection::Fisheye,
];

fn refs(panels: &[Panel]) -> Vec<&Panel> {
    panels.iter().collect()
}

fn map<'a>(panel: &'a Panel, placement: &'a Placement) -> PixelMap<'a> {
    PixelMap {
        panel,
        placement,
        size: SOURCE,
    }
}

fn axes(yaw: f64, pitch: f64, roll: f64) -> Axes {
    Axes::from_yaw_pitch_roll(Radians(yaw), Radians(pitch), Radians(roll))
}

/// One of each kind, for a panel of 80 x 60 pixels and about 1 x 0.75.
fn distortions() -> Vec<Distortion> {
    let radial = |c2: f64| RadialPolynomial {
        centre: [0.03, -0.02],
        coefficients: vec![1.0, 0.02, c2, 0.0, 0.03],
    };
    let brown = |k1: f64| BrownConrady {
        centre: [0.01, 0.02],
        radial: [k1, -0.04, 0.01],
        tangential: [0.01, -0.02],
    };
    let grid = ResidualGrid::over([80, 60], [5, 4], |[x, y]| {
        [(x - 40.0) * 0.01 + y * 0.002, (y - 30.0) * -0.02]
    });
    let grid = Arc::new(grid);
    vec![
        Distortion::None,
        Distortion::Bulge(Bulge { height: 0.15 }),
        Distortion::Bulge(Bulge { height: -0.3 }),
        Distortion::Polynomial(Box::new([radial(0.11), radial(0.12), radial(0.13)])),
        Distortion::BrownConrady(Box::new([brown(0.11), brown(0.12), brown(0.13)])),
        Distortion::Grid([grid.clone(), grid.clone(), grid]),
    ]
}

fn turned(axes: Axes, turn: &DMat3) -> Axes {
    Axes {
        forward: *turn * axes.forward,
        right: *turn * axes.right,
        down: *turn * axes.down,
    }
}

#[test]
fn where_the_seed_cuts_its_plane_changes_no_place() {
    let panels = three();
    let corners: Vec<DVec3> = panels.iter().flat_map(Panel::corners).collect();
    let seed = SeedPlane::round(&corners, Some(4.0 / 3.0)).unwrap();
    let nearer = SeedPlane {
        depth: seed.depth * 3.7,
        half: seed.half.map(|it| it * 3.7),
        ..seed
    };
    for panel in &panels {
        for pixel in [[0, 0], [799, 3], [321, 456]] {
            let [a, b] = [seed, nearer].map(|it| {
                let placement = it.placement();
                map(panel, &placement).of_pixel(pixel).unwrap().place
            });
            assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
        }
    }
}

#[test]
fn the_other_eye_sees_the_mirrored_source() {
    for panels in [three(), six(), twelve()] {
        let twins: Vec<Panel> = panels.iter().map(Panel::mirrored).collect();
        let (own, _) = place(&refs(&panels), PlacementRule::Seed, Some(SOURCE)).unwrap();
        let (other, _) = place(&refs(&twins), PlacementRule::Seed, Some(SOURCE)).unwrap();
        for (panel, twin) in panels.iter().zip(&twins) {
            assert_eq!(twin.mirrored(), *panel);
            for pixel in [[0, 0], [17, 450], [799, 599]] {
                let found = map(panel, &own).of_pixel(pixel).unwrap();
                let there = map(twin, &other)
                    .of_pixel([799 - pixel[0], pixel[1]])
                    .unwrap();
                assert!((found.place[0] + there.place[0] - 1600.0).abs() < 1e-8);
                assert!((found.place[1] - there.place[1]).abs() < 1e-8);
                let change = |found: [[f64; 2]; 2]| [found[0][1], found[1][0]];
                let [a, b] = [change(found.jacobian), change(there.jacobian)];
                assert!((a[0] + b[0]).abs() < 1e-9 && (a[1] + b[1]).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn every_mapped_place_lies_within_the_source() {
    let mut sets = vec![three(), six(), twelve()];
    for distortion in distortions() {
        let of = |id: &str, yaw: f64| Panel {
            distortion: distortion.clone(),
            ..panel(id, axes(yaw, 0.1, 0.05), [1.0, 0.75], [80, 60])
        };
        sets.push(vec![of("a", -0.5), of("b", 0.2)]);
    }
    for panels in sets {
        let panels = refs(&panels);
        for (rule, source) in RULES.into_iter().flat_map(|it| {
            [
                SourceSize::Needed,
                SourceSize::Drawn(SOURCE),
                SourceSize::Picture(SOURCE),
            ]
            .map(|size| (it, size))
        }) {
            let (placement, name) = place(&panels, rule, source).unwrap();
            for panel in &panels {
                let [w, h] = panel.view.size;
                let steps = |side: u32| (0..=24).map(move |k| f64::from(side * k) / 24.0);
                for at in steps(h).flat_map(|y| steps(w).map(move |x| [x, y])) {
                    let [u, v] = map(panel, &placement).at(at).unwrap().place;
                    let is_in = (-1e-9..=1600.0 + 1e-9).contains(&u)
                        && (-1e-9..=1200.0 + 1e-9).contains(&v);
                    assert!(is_in, "{name} {} {at:?}: {u}, {v}", panel.id);
                }
            }
        }
    }
}

#[test]
fn the_best_plane_of_one_flat_panel_is_itself_and_needs_its_own_pixels() {
    for (yaw, pitch, roll) in [(0.0, 0.0, 0.0), (0.7, -0.3, 0.2), (2.6, 0.4, -0.6)] {
        let own = panel("a", axes(yaw, pitch, roll), [0.9, 0.675], [800, 600]);
        let found = fit(&[&own], PlacementRule::Plane, None).unwrap();
        assert!((found.need[0] - 800.0).abs() < 1e-3, "{:?}", found.need);
        assert!((found.need[1] - 600.0).abs() < 1e-3, "{:?}", found.need);
        assert!(found.placement.axes.forward.distance(own.view.axes.forward) < 1e-6);
        assert!(found.placement.axes.right.distance(own.view.axes.right) < 1e-6);
        assert!((found.seen_share - 1.0).abs() < 1e-3);
        assert!((found.panels[0].density - 1.0).abs() < 1e-6);
        assert_eq!(found.panels[0].filter, PanelFilter::Bicubic);
        assert_eq!((found.size, found.map_error), ([800, 600], 0.0));
    }
}

#[test]
fn panels_turned_one_way_and_the_head_back_see_the_same() {
    let turn = DMat3::from_rotation_y(0.4) * DMat3::from_rotation_x(-0.3);
    let panels = six();
    let there: Vec<Panel> = panels
        .iter()
        .map(|own| {
            let mut there = own.clone();
            there.view.axes = turned(own.view.axes, &turn);
            there
        })
        .collect();
    for (rule, projection) in [(PlacementRule::Plane, 0), (PlacementRule::Equirect, 2)] {
        let (own, _) = place(&refs(&panels), rule, None).unwrap();
        assert_eq!(own.projection, PROJECTIONS[projection]);
        let turned_source = Placement {
            axes: turned(own.axes, &turn),
            ..own
        };
        for (a, b) in panels.iter().zip(&there) {
            for pixel in [[0, 0], [400, 300], [799, 10]] {
                let a = map(a, &own).of_pixel(pixel).unwrap().place;
                let b = map(b, &turned_source).of_pixel(pixel).unwrap().place;
                assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
            }
        }
    }
    // A plane is found wherever panels look.
    let need = |panels: &[Panel]| {
        let found = fit(&refs(panels), PlacementRule::Plane, None).unwrap();
        found.need[0] * found.need[1]
    };
    assert!((need(&there) / need(&panels) - 1.0).abs() < 0.01);
}

#[test]
fn what_looks_too_far_away_for_a_plane_is_named_with_what_works() {
    let of = |id: &str, yaw: f64| panel(id, axes(yaw, 0.0, 0.0), [0.9, 0.675], [80, 60]);
    let wide = [of("west", -1.4), of("ahead", 0.0), of("east", 1.2)];
    let error = fit(&refs(&wide), PlacementRule::Seed, None).unwrap_err();
    let beyond = |error: &FitError| match error {
        FitError::Beyond { panel, works, .. } => (panel.clone(), *works),
        _ => unreachable!("{error}"),
    };
    let is_west = beyond(&error) == ("west".to_owned(), "equirect");
    assert!(is_west, "{error}");
    assert!(fit(&refs(&wide), PlacementRule::Plane, None).is_err());
    let found = fit(&refs(&wide), PlacementRule::Auto, None).unwrap();
    assert!(["cylinder", "equirect"].contains(&found.name));
    // To one side a plane does, and the seed's does not.
    let side = [of("near", 0.9), of("far", 1.5)];
    let error = fit(&refs(&side), PlacementRule::Seed, None).unwrap_err();
    let is_far = beyond(&error) == ("far".to_owned(), "plane");
    assert!(is_far, "{error}");
    assert_eq!(
        fit(&refs(&side), PlacementRule::Auto, None).unwrap().name,
        "plane"
    );
    assert_eq!(fit(&[], PlacementRule::Auto, None), Err(FitError::NoPanel));
    // All round, a sphere has every azimuth.
    let round: Vec<Panel> = (0..8).map(|k| of("a", f64::from(k) * 0.785)).collect();
    let found = fit(&refs(&round), PlacementRule::Equirect, None).unwrap();
    let [width, _] = found.placement.extent();
    assert!((width - core::f64::consts::TAU).abs() < 1e-4, "{width}");
    // Straight up there is a sphere, and no cylinder.
    let up = panel("up", axes(0.0, 1.57, 0.0), [0.9, 0.675], [80, 60]);
    assert!(fit(&[&up], PlacementRule::Auto, None).is_ok());
    assert!(fit(&[&up], PlacementRule::Cylinder, None).is_ok());
}

#[test]
fn grids_that_panels_are_drawn_by_follow_their_distortion() {
    for distortion in distortions() {
        let panel = Panel {
            distortion,
            ..panel("a", axes(0.3, 0.1, 0.0), [1.0, 0.75], [80, 60])
        };
        // What is seen of a sphere outside the panel is what its pixels cover of it.
        let found = fit(&[&panel], PlacementRule::Equirect, Some([640, 480])).unwrap();
        let Some(drawn) = DrawnGrid::of(&panel, &found.placement) else {
            assert!(panel.distortion.is_none());
            continue;
        };
        assert!(drawn.cell <= 32 && drawn.channels.len() <= 3);
        let grid = &drawn.channels[drawn.channels.len() / 2];
        let covered = found.panels[0].density * found.panels[0].density * 4800.0;
        let seen = found.seen_share * 640.0 * 480.0;
        assert!((covered / seen - 1.0).abs() < 0.01, "{covered} {seen}");
        for at in [[0.0, 0.0], [80.0, 60.0], [13.0, 47.0], [40.5, 30.5]] {
            let told = grid.ideal(at).unwrap().place;
            let wanted = panel
                .distortion
                .ideal(&panel.view, at, GREEN)
                .unwrap()
                .place;
            assert!((told[0] - wanted[0]).abs() < 0.3 && (told[1] - wanted[1]).abs() < 0.3);
        }
    }
}

#[test]
fn a_turned_picture_is_sent_with_every_corner_where_the_display_turns_it_back() {
    let size = [30, 20];
    let at = |scanout: Scanout, place: [f64; 2]| {
        let found = scanout.seen_from_sent(size) * DVec3::new(place[0], place[1], 1.0);
        [found.x, found.y]
    };
    // What is sent at the upper left, and to its right.
    assert_eq!(at(Scanout::Rot90, [0.0, 0.0]), [0.0, 20.0]);
    assert_eq!(at(Scanout::Rot90, [20.0, 0.0]), [0.0, 0.0]);
    assert_eq!(at(Scanout::Rot270, [0.0, 0.0]), [30.0, 0.0]);
    assert_eq!(at(Scanout::FlipX, [0.0, 0.0]), [30.0, 0.0]);
    assert_eq!(at(Scanout::FlipY, [0.0, 0.0]), [0.0, 20.0]);
    for scanout in Scanout::ALL {
        let [w, h] = scanout.sent_size(size).map(f64::from);
        for corner in [[0.0, 0.0], [w, 0.0], [0.0, h], [w, h], [w / 4.0, h / 3.0]] {
            let [x, y] = at(scanout, corner);
            assert!(
                (0.0..=30.0).contains(&x) && (0.0..=20.0).contains(&y),
                "{scanout:?}"
            );
        }
        let twice = scanout.seen_from_sent(scanout.sent_size(size));
        assert!((twice.determinant().abs() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_maps_of_the_seed_hold_places_to_a_65536th_and_its_model_gives_its_panels() {
    let panels = three();
    let (placement, _) = place(&refs(&panels), PlacementRule::Seed, Some(SOURCE)).unwrap();
    for pixel in [[0, 0], [100, 200], [799, 599]] {
        let map = map(&panels[0], &placement);
        let (texel, wanted) = (SeedTexel::of(&map, pixel), edge_means(&map, pixel).unwrap());
        for k in 0..2 {
            assert!((texel.place()[k] - wanted.place[k]).abs() <= 0.5 / 65536.0 + 1e-9);
            for l in 0..2 {
                let told = f64::from(texel.change[2 * k + l]) * CHANGE_STEP;
                assert!((told - wanted.jacobian[k][l]).abs() <= CHANGE_STEP / 2.0);
            }
        }
    }
    let panels = [3.0, 4.0].map(|fetches| panels_by_fill_rate(26_400e6, 480_000.0, fetches));
    assert!((panels[0] - 38.194).abs() < 1e-3 && (panels[1] - 28.646).abs() < 1e-3);
}

/// A panel that every projection has a place for, and its optics by number.
fn some_panel(yaw: f64, pitch: f64, roll: f64, optics: usize) -> Panel {
    Panel {
        distortion: distortions().swap_remove(optics),
        ..panel("a", axes(yaw, pitch, roll), [1.0, 0.75], [80, 60])
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn derivatives_are_what_places_change_by(
        yaw in -0.6..0.6f64, pitch in -0.5..0.5f64, roll in -3.0..3.0f64,
        optics in 0..6usize, projection in 0..4usize,
        x in 1.0..79.0f64, y in 1.0..59.0f64, near in any::<bool>(),
    ) {
        let panel = some_panel(yaw, pitch, roll, optics);
        let mut placement = Placement::new(
            PROJECTIONS[projection], axes(0.1, -0.1, 0.2), [2.0, 1.5, 1.0, 1.2],
        );
        if near {
            placement = placement.seen_from(DVec3::new(-0.0315, 0.01, 0.02), 0.5);
        }
        let map = map(&panel, &placement);
        let off = 1e-5;
        let found = map.at([x, y]).unwrap();
        let [left, right] = [-off, off].map(|d| map.at([x + d, y]).unwrap().place);
        let [above, below] = [-off, off].map(|d| map.at([x, y + d]).unwrap().place);
        // Across a kink of a bulge or a grid there is no derivative.
        let bent = |d: f64| panel.distortion.ideal(&panel.view, [x + d, y + d], GREEN).unwrap();
        let kink = bent(-off).jacobian.iter().flatten().zip(bent(off).jacobian.iter().flatten())
            .any(|(a, b)| (a - b).abs() > 1e-4);
        prop_assume!(!kink);
        for k in 0..2 {
            let wanted = [(right[k] - left[k]) / (2.0 * off), (below[k] - above[k]) / (2.0 * off)];
            for l in 0..2 {
                let error = (found.jacobian[k][l] - wanted[l]).abs();
                prop_assert!(error < 1e-3 * (1.0 + wanted[l].abs()), "{found:?} {wanted:?}");
            }
        }
    }

    #[test]
    fn means_over_edges_are_the_analytic_derivatives(
        yaw in -0.6..0.6f64, pitch in -0.5..0.5f64, roll in -3.0..3.0f64,
        column in 0..800u32, row in 0..600u32,
    ) {
        let panel = panel("a", axes(yaw, pitch, roll), [0.9, 0.675], [800, 600]);
        let placement =
            Placement::new(SourceProjection::Plane, Axes::FRONT, [1.7, 1.7, 1.26, 1.26]);
        let map = map(&panel, &placement);
        let a = map.of_pixel([column, row]).unwrap();
        let b = edge_means(&map, [column, row]).unwrap();
        for (a, b) in a.jacobian.iter().flatten().zip(b.jacobian.iter().flatten()) {
            prop_assert!((a - b).abs() < 2e-5 * (1.0 + a.abs()), "{a} {b}");
        }
    }

    #[test]
    fn a_direction_survives_the_way_into_a_source_and_back(
        yaw in -1.0..1.0f64, pitch in -0.8..0.8f64, projection in 0..4usize,
    ) {
        let placement = Placement::new(
            PROJECTIONS[projection], axes(0.2, 0.1, 0.3), [1.0, 1.3, 0.8, 0.9],
        );
        let ray = axes(yaw, pitch, 0.0).forward;
        let place = placement.source_from_ray(ray * 3.0, SOURCE).unwrap();
        let back = placement.ray_from_source(place, SOURCE).unwrap();
        prop_assert!(back.distance(ray) < 1e-9);
    }

    #[test]
    fn a_near_plane_is_seen_where_its_rays_meet_it_and_as_the_homography_says(
        yaw in -0.5..0.5f64, pitch in -0.5..0.5f64, distance in 0.3..10.0f64,
        column in 0..80u32, row in 0..60u32,
    ) {
        let panel = panel("a", axes(yaw, pitch, 0.1), [1.0, 0.75], [80, 60]);
        let eye = DVec3::new(-0.0315, 0.0, 0.0);
        let placement =
            Placement::new(SourceProjection::Plane, Axes::FRONT, [1.0, 1.0, 0.75, 0.75])
                .seen_from(eye, distance);
        let found = map(&panel, &placement).of_pixel([column, row]).unwrap().place;
        let pixel = [column, row].map(|it| f64::from(it) + 0.5);
        let ray = panel.view.ray(pixel);
        let hit = eye + ray * (distance / -ray.z);
        let wanted = [(hit.x / distance + 1.0) * 800.0, (0.75 - hit.y / distance) * 800.0];
        prop_assert!((found[0] - wanted[0]).abs() < 1e-8 && (found[1] - wanted[1]).abs() < 1e-8);
        let m = homography(&panel, &placement, SOURCE).unwrap();
        let place = m * DVec3::new(pixel[0], pixel[1], 1.0);
        prop_assert!((place.x / place.z - wanted[0]).abs() < 1e-8);
        prop_assert!((place.y / place.z - wanted[1]).abs() < 1e-8);
    }

    #[test]
    fn weights_sum_to_one_and_probes_lie_symmetrically_along_the_major_axis(
        ux in -8.0..8.0f64, uy in -8.0..8.0f64, vx in -8.0..8.0f64, vy in -8.0..8.0f64,
        most in 1..20u32,
    ) {
        let probes = Probes::of([[ux, uy], [vx, vy]], most, 12.0);
        let weights = probes.weights();
        prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        prop_assert!(probes.count >= 1 && probes.count <= most && probes.level >= 0.0);
        let offsets: Vec<[f64; 2]> = probes.offsets().collect();
        prop_assert_eq!(offsets.len(), probes.count as usize);
        for (a, b) in offsets.iter().zip(offsets.iter().rev()) {
            prop_assert!((a[0] + b[0]).abs() < 1e-9 && (a[1] + b[1]).abs() < 1e-9);
        }
        // No farther than the ellipse reaches.
        let reach = offsets.iter().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f64::max);
        prop_assert!(reach <= probes.major + 1e-9);
        // The ellipse of McCormack et al. 1999, by their own formulas.
        let (a, b, c) = (vx * vx + vy * vy, -2.0 * (ux * vx + uy * vy), ux * ux + uy * uy);
        let f = a * c - b * b / 4.0;
        prop_assume!(f > 1e-3);
        let (a, b, c) = (a / f, b / f, c / f);
        let root = ((a - c) * (a - c) + b * b).sqrt();
        let major = (1.0 / ((a + c - root) / 2.0)).sqrt().max(1.0);
        prop_assert!((probes.major / major - 1.0).abs() < 1e-6, "{} {major}", probes.major);
    }
}
