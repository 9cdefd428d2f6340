//! How do panels stand before the eye, and where in the source do their pixels lie?

use super::drawn_rig::DrawnRig;
use super::svg::Drawing;
use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::placement::SourceProjection;
use foveal_core::view::panel::rig::Panel;
use glam::DVec3;

/// Steps along an edge.
const STEPS: u32 = 24;
/// Lines across and down a panel in the drawing of its map, and steps along one.
const LINES: u32 = 17;
/// Where one looks from: so far to the left and above, in radians.
const TURN: f64 = 0.5;
const TILT: f64 = 0.45;

/// A point of the world, seen from the upper left and behind; rows down.
fn oblique(at: DVec3) -> [f64; 2] {
    let (sin, cos) = TURN.sin_cos();
    let (right, depth) = (at.x * cos - at.z * sin, at.x * sin + at.z * cos);
    let (sin, cos) = TILT.sin_cos();
    [right, -(at.y * cos - depth * sin)]
}

/// Places along the edge of a picture of `size`.
fn rim([w, h]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    let sides = [
        [[0.0, 0.0], [w, 0.0]],
        [[w, 0.0], [w, h]],
        [[w, h], [0.0, h]],
        [[0.0, h], [0.0; 2]],
    ];
    sides.into_iter().flat_map(|[from, to]| {
        (0..STEPS).map(move |step| {
            let share = f64::from(step) / f64::from(STEPS);
            [0, 1].map(|k| from[k] + (to[k] - from[k]) * share)
        })
    })
}

/// The rays of a placed source's edge; those of a plane end on it, `depth` from the eye, those of a
/// curved one so far away.
fn source_edge(rig: &DrawnRig<'_>) -> Vec<DVec3> {
    let placement = &rig.found.placement;
    let size = rig.found.size;
    let depth = rig.found.depth.map_or(1.2, f64::abs);
    let places = rim(size.map(f64::from));
    let rays = places.filter_map(|at| placement.ray_from_source(at, size));
    let ends = rays.map(|ray| match placement.projection {
        SourceProjection::Plane => ray * (depth / ray.dot(placement.axes.forward)),
        _ => ray * depth,
    });
    ends.collect()
}

fn middle(panel: &Panel) -> DVec3 {
    panel.corners().into_iter().sum::<DVec3>() / 4.0
}

fn outline(panel: &Panel) -> [DVec3; 4] {
    let [a, b, c, d] = panel.corners();
    [a, b, d, c]
}

/// Panels and the source in space, with the rays of corners.
pub(super) fn panels(rig: &DrawnRig<'_>) -> String {
    let mut drawing = Drawing::default();
    let edge = source_edge(rig);
    drawing.outline("source", edge.into_iter().map(oblique).collect());
    for panel in rig.panels {
        for corner in outline(panel) {
            drawing.line("ray", vec![oblique(DVec3::ZERO), oblique(corner)]);
        }
        drawing.outline("panel", outline(panel).map(oblique).to_vec());
        drawing.word(&panel.id, oblique(middle(panel)));
    }
    drawing.eye(oblique(DVec3::ZERO));
    drawing.file("Panels (blue) and the source (grey) before the eye")
}

/// The same from above.
pub(super) fn above(rig: &DrawnRig<'_>) -> String {
    let down = |at: DVec3| [at.x, at.z];
    let mut drawing = Drawing::default();
    let edge = source_edge(rig);
    drawing.outline("source", edge.into_iter().map(down).collect());
    for panel in rig.panels {
        for corner in outline(panel) {
            drawing.line("ray", vec![[0.0; 2], down(corner)]);
        }
        drawing.outline("panel", outline(panel).map(down).to_vec());
        drawing.word(&panel.id, down(middle(panel)));
    }
    drawing.eye([0.0; 2]);
    drawing.file("From above, ahead is up")
}

/// Where panels lie in the source.
pub(super) fn source(rig: &DrawnRig<'_>) -> String {
    let mut drawing = Drawing::default();
    let [w, h] = rig.found.size.map(f64::from);
    drawing.outline("source", vec![[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]]);
    for panel in rig.panels {
        let map = rig.map_of(panel);
        let size = panel.view.size.map(f64::from);
        let places = rim(size).filter_map(|at| Some(map.at(at)?.place));
        drawing.outline("panel", places.collect());
        if let Some(found) = map.at(size.map(|side| side / 2.0)) {
            drawing.word(&panel.id, found.place);
        }
    }
    let seen = rig.found.seen_share * 100.0;
    let title = format!(
        "{w:.0} x {h:.0} pixels of the source ({}), {seen:.0} % of them seen",
        rig.found.name
    );
    drawing.file(&title)
}

/// Rows and columns of each panel, as the source has them; of bent panels on the panel itself.
pub(super) fn lines(rig: &DrawnRig<'_>) -> String {
    let mut drawing = Drawing::default();
    if rig.panels.iter().all(|it| it.distortion.is_none()) {
        for panel in rig.panels {
            let map = rig.map_of(panel);
            for line in grid_lines(panel.view.size, &|at| Some(map.at(at)?.place)) {
                drawing.line("line", line);
            }
        }
        return drawing.file("Every sixteenth part of each panel, in the source");
    }
    let mut left = 0.0;
    for panel in rig.panels {
        let [w, h] = panel.view.size.map(f64::from);
        let beside = |at: [f64; 2]| [at[0] + left, at[1]];
        let straight = grid_lines(panel.view.size, &|at| Some(beside(at)));
        let bent = grid_lines(panel.view.size, &|at| {
            Some(beside(
                panel.distortion.ideal(&panel.view, at, GREEN)?.place,
            ))
        });
        for (class, lines) in [("ideal", straight), ("line", bent)] {
            for line in lines {
                drawing.line(class, line);
            }
        }
        drawing.word(&panel.id, [left + w / 2.0, h / 2.0]);
        left += w * 1.4;
    }
    drawing.file("Pixels as they are seen (blue) on the flat panels that look so (grey)")
}

/// Lines across and down a panel, as far as they are lit.
fn grid_lines(size: [u32; 2], place: &dyn Fn([f64; 2]) -> Option<[f64; 2]>) -> Vec<Vec<[f64; 2]>> {
    let at = |k: usize, step: u32, of: u32| f64::from(size[k]) * f64::from(step) / f64::from(of);
    let mut lines = Vec::new();
    for number in 0..LINES {
        for k in 0..2 {
            let along = (0..=2 * STEPS).filter_map(|step| {
                let mut spot = [0.0; 2];
                spot[k] = at(k, number, LINES - 1);
                spot[1 - k] = at(1 - k, step, 2 * STEPS);
                place(spot)
            });
            lines.push(along.collect());
        }
    }
    lines
}
