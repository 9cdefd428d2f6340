//! Are projectors before a wall panels that look where they light it?

use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::rig::{Panel, Scanout};
use glam::DVec3;

use super::super::interchange::projectors::{self, Projector};

const EYE: DVec3 = DVec3::new(0.4, 0.1, 0.5);

fn projector(id: &str, at: [f64; 3], yaw_pitch_roll: [f64; 3]) -> Projector {
    Projector {
        id: id.to_owned(),
        at,
        yaw_pitch_roll,
        pixels: [40, 24],
        tangents: [0.5, 0.4, 0.35, 0.2],
        blend: 3.0,
    }
}

/// A wall straight ahead, its middle 3 away, of so many parts in a row, on a cylinder where its
/// radius is finite.
fn wall(parts: u32, radius: f64) -> Vec<[DVec3; 3]> {
    let column = |k: u32| {
        let x = 12.0 * f64::from(k) / f64::from(parts) - 6.0;
        let angle = x / radius;
        let deep = -3.0 + radius * (1.0 - angle.cos());
        [-4.0, 4.0].map(|y| match radius.is_finite() {
            true => DVec3::new(radius * angle.sin(), y, deep),
            false => DVec3::new(x, y, -3.0),
        })
    };
    let cell = |k: u32| {
        let ([a, b], [c, d]) = (column(k), column(k + 1));
        [[a, b, c], [b, d, c]]
    };
    (0..parts).flat_map(cell).collect()
}

/// Where a projector's pixel leaves its lens.
fn lit(projector: &Projector, [column, row]: [u32; 2]) -> DVec3 {
    let [yaw, pitch, roll] = projector.yaw_pitch_roll.map(Radians::from_degrees);
    let axes = Axes::from_yaw_pitch_roll(yaw, pitch, roll);
    let [left, right, up, down] = projector.tangents;
    let share = |k: u32, side: u32| (f64::from(k) + 0.5) / f64::from(side);
    let [w, h] = projector.pixels;
    axes.at([
        share(column, w) * (left + right) - left,
        share(row, h) * (up + down) - up,
    ])
}

/// The largest angle between where a panel's pixels look and where points are that they light.
fn off(panel: &Panel, projector: &Projector, point: impl Fn(DVec3, DVec3) -> DVec3) -> f64 {
    let seen_from_sent = panel.scanout.seen_from_sent(panel.view.size);
    let [w, h] = projector.pixels;
    let pixels = (0..h).flat_map(|row| (0..w).map(move |column| [column, row]));
    let angles = pixels.map(|at| {
        let sent = DVec3::new(f64::from(at[0]) + 0.5, f64::from(at[1]) + 0.5, 1.0);
        let place = seen_from_sent * sent;
        let ray = panel.ray_at([place.x, place.y], GREEN).unwrap().ray;
        let seen = point(projector.at.into(), lit(projector, at)) - EYE;
        ray.normalize().distance(seen.normalize())
    });
    angles.fold(0.0, f64::max)
}

/// Where a ray meets the flat wall.
fn on_flat(lens: DVec3, way: DVec3) -> DVec3 {
    lens + way * ((-3.0 - lens.z) / way.z)
}

#[test]
fn a_pixel_of_a_projector_looks_where_it_lights_a_flat_wall() {
    let all = [
        projector("straight", [-0.5, 0.3, 0.2], [0.0, 0.0, 0.0]),
        projector("askew", [0.8, -0.3, 1.0], [14.0, -6.0, 5.0]),
        projector("hung", [0.0, 1.5, 0.0], [-8.0, -20.0, 180.0]),
    ];
    let rig = projectors::rig(&wall(3, f64::INFINITY), &all, EYE).unwrap();
    for (panel, projector) in rig.panels.iter().zip(&all) {
        let off = off(panel, projector, on_flat);
        assert!(off < 1e-5, "{}: {off}", panel.id);
        assert_eq!(
            (&panel.id, &panel.output.surface),
            (&projector.id, &projector.id)
        );
        assert_eq!(panel.scanout, Scanout::Normal);
        assert!((panel.blend.to_degrees() - 3.0).abs() < 1e-9);
    }
}

#[test]
fn a_picture_thrown_from_behind_is_sent_left_for_right() {
    let behind = projector("behind", [0.2, 0.0, -9.0], [180.0, 0.0, 0.0]);
    let rig = projectors::rig(&wall(5, f64::INFINITY), std::slice::from_ref(&behind), EYE);
    let rig = rig.unwrap();
    assert_eq!(rig.panels[0].scanout, Scanout::FlipX);
    let off = off(&rig.panels[0], &behind, on_flat);
    assert!(off < 1e-5, "{off}");
}

#[test]
fn a_bent_wall_bends_the_panel() {
    let radius = 4.0;
    let one = projector("round", [-1.0, 0.5, 0.5], [-10.0, 4.0, 0.0]);
    let rig = projectors::rig(&wall(600, radius), std::slice::from_ref(&one), EYE).unwrap();
    // The axis of the cylinder stands at z = 1.
    let on_round = |lens: DVec3, way: DVec3| {
        let (x, z) = (lens.x, lens.z - (radius - 3.0));
        let a = way.x * way.x + way.z * way.z;
        let b = x * way.x + z * way.z;
        let c = x * x + z * z - radius * radius;
        lens + way * ((-b + (b * b - a * c).sqrt()) / a)
    };
    let off = off(&rig.panels[0], &one, on_round);
    assert!(off < 1e-4, "{off}");
}

#[test]
fn what_is_missed_stays_dark_and_what_hides_a_wall_is_lit_in_its_place() {
    // A wall of one half, and a board before its middle.
    let mut half = wall(2, f64::INFINITY);
    half.truncate(2);
    let one = projector("half", [0.0, 0.0, 0.5], [0.0, 0.0, 0.0]);
    let rig = projectors::rig(&half, std::slice::from_ref(&one), EYE).unwrap();
    let ray = |place| rig.panels[0].ray_at(place, GREEN);
    assert!(ray([10.5, 12.5]).is_some() && ray([35.5, 12.5]).is_none());
    let [a, b, c, d] =
        [[-0.2, -0.2], [0.2, -0.2], [-0.2, 0.2], [0.2, 0.2]].map(|[x, y]| DVec3::new(x, y, -1.0));
    let board = [[a, b, c], [b, d, c]];
    let alone = projectors::rig(&board, std::slice::from_ref(&one), EYE).unwrap();
    let before = [&half[..], &board].concat();
    let both = projectors::rig(&before, std::slice::from_ref(&one), one.at.into()).unwrap();
    // From the lens itself nothing hides anything, so the board is where it was alone.
    let middle = [21.5, 12.5];
    assert!(alone.panels[0].ray_at(middle, GREEN).is_some());
    assert!(both.panels[0].ray_at(middle, GREEN).is_some());
}

#[test]
fn projectors_that_light_nothing_or_are_called_alike_are_refused_by_name() {
    let wall = wall(3, f64::INFINITY);
    let refused = |all: &[Projector], words: &str| {
        let error = projectors::rig(&wall, all, EYE).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    let away = projector("away", [0.0; 3], [180.0, 0.0, 0.0]);
    refused(&[away], "projector \"away\": it lights nothing");
    let one = projector("one", [0.0; 3], [0.0; 3]);
    refused(&[one.clone(), one.clone()], "\"one\" is there twice");
    let bad = Projector {
        id: "a/b".to_owned(),
        ..one.clone()
    };
    refused(&[bad], "projector \"a/b\".id");
    let large = Projector {
        pixels: [u32::MAX; 2],
        ..one
    };
    refused(&[large], "more than 67108864 pixels");
}
