//! Which rigs are tested?

use crate::units::Radians;
use crate::view::axes::Axes;
use crate::view::eye_view::{EyeView, Field};
use crate::view::panel::rig::{Panel, axes_from_seed_angles};
use crate::view::surface::Eye;
use glam::DVec3;

/// A panel of the left eye, centred.
pub(crate) fn panel(id: &str, axes: Axes, [w, h]: [f64; 2], size: [u32; 2]) -> Panel {
    let view = EyeView {
        position: DVec3::ZERO,
        axes,
        field: Field::symmetric([w / 2.0, h / 2.0]),
        size,
        eye: Eye::Left,
    };
    Panel::flat(id, view)
}

fn seed_axes([roll, pitch, yaw]: [f64; 3]) -> Axes {
    let radians = |degrees| Radians::from_degrees(degrees).0;
    axes_from_seed_angles(radians(roll), radians(pitch), radians(yaw))
}

/// Three in a row.
pub(crate) fn three() -> Vec<Panel> {
    let all = [("L", -35.0), ("C", 0.0), ("R", 35.0)];
    let of = |(id, yaw)| panel(id, seed_axes([0.0, 0.0, yaw]), [0.90, 0.675], [800, 600]);
    all.map(of).to_vec()
}

/// Rows from above, columns from the left; rows below mirror those above.
fn rows(upper: &[[f64; 3]], middle: Option<&[f64]>, size: [f64; 2]) -> Vec<Panel> {
    let mut rows: Vec<Vec<[f64; 3]>> = vec![upper.to_vec()];
    rows.extend(middle.map(|yaws| yaws.iter().map(|yaw| [0.0, 0.0, *yaw]).collect()));
    rows.push(upper.iter().map(|[r, p, y]| [-r, -p, *y]).collect());
    let mut all = Vec::new();
    for (row, angles) in rows.iter().enumerate() {
        for (column, angles) in angles.iter().enumerate() {
            let id = format!("r{row}c{column}");
            all.push(panel(&id, seed_axes(*angles), size, [800, 600]));
        }
    }
    all
}

/// Three columns, two rows.
pub(crate) fn six() -> Vec<Panel> {
    let upper = [
        [7.286214, -8.594930, -40.548264],
        [2.368187, -11.001059, -12.228085],
        [-3.138253, -10.808839, 16.296970],
    ];
    rows(&upper, None, [0.7677280700708315, 0.5757960525531236])
}

/// Four columns, three rows.
pub(crate) fn twelve() -> Vec<Panel> {
    let upper = [
        [17.845208, -11.255307, -58.772647],
        [10.864769, -18.080671, -31.733718],
        [1.150911, -20.969861, -3.213003],
        [-8.874035, -19.110157, 25.496683],
    ];
    let middle = [-57.0, -30.0, -3.0, 24.0];
    rows(
        &upper,
        Some(&middle),
        [0.7279404685324047, 0.5459553513993035],
    )
}
