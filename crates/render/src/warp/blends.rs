//! How much of the light does each of several panels give that show one direction?

use super::params::BlendParams;
use foveal_core::view::panel::rig::Panel;
use glam::{DMat3, DVec3};

/// Directions across and down a panel at which overlaps are counted.
const PROBED: u32 = 33;

/// What the panels that fade need: a record each, and lists of neighbours.
#[derive(Default)]
pub(super) struct Blends {
    /// Of panels that fade, in their order.
    pub(super) records: Vec<BlendParams>,
    /// Numbers of records.
    pub(super) neighbours: Vec<u32>,
    /// For each panel the number of its record from 1 on, or 0.
    pub(super) of_panel: Vec<u32>,
}

impl Blends {
    pub(super) fn new(panels: &[&Panel]) -> Self {
        let fading: Vec<&Panel> = panels.iter().copied().filter(|it| it.blend > 0.0).collect();
        let edges: Vec<[DVec3; 4]> = fading.iter().map(|it| edges_of(it)).collect();
        let mut blends = Self::default();
        let mut next = 0;
        for panel in panels {
            next += u32::from(panel.blend > 0.0);
            blends
                .of_panel
                .push(if panel.blend > 0.0 { next } else { 0 });
        }
        for (index, panel) in fading.iter().enumerate() {
            let first = blends.neighbours.len() as u32;
            let others = (0..fading.len()).filter(|other| {
                *other != index
                    && share_an_eye(panel, fading[*other])
                    && meet(panel, fading[*other])
            });
            blends.neighbours.extend(others.map(|other| other as u32));
            let count = blends.neighbours.len() as u32 - first;
            let rays = panel.view.ray_from_pixel() * panel.scanout.seen_from_sent(panel.view.size);
            let column = |v: DVec3| v.as_vec3().to_array();
            blends.records.push(BlendParams {
                right: column(rays.x_axis),
                sharpness: (1.0 / panel.blend) as f32,
                down: column(rays.y_axis),
                first,
                corner: column(rays.z_axis),
                count,
                edges: edges[index].map(|n| n.as_vec3().extend(0.0).to_array()),
                ..BlendParams::default()
            });
        }
        let most = blends.most_at_once(&fading, &edges);
        for record in &mut blends.records {
            record.most = most as f32;
        }
        blends
    }

    fn most_at_once(&self, fading: &[&Panel], edges: &[[DVec3; 4]]) -> usize {
        let counts = fading
            .iter()
            .zip(&self.records)
            .flat_map(|(panel, record)| {
                let neighbours = &self.neighbours[record.first as usize..][..record.count as usize];
                let rays = panel.view.ray_from_pixel();
                let places = (0..PROBED * PROBED).map(|k| [k % PROBED, k / PROBED]);
                places.map(move |place| {
                    let ray = probed(rays, panel.view.size, place);
                    let shows =
                        |other: &&u32| edges[**other as usize].iter().all(|n| n.dot(ray) > 0.0);
                    1 + neighbours.iter().filter(shows).count()
                })
            });
        counts.max().unwrap_or(1)
    }
}

fn probed(rays: DMat3, size: [u32; 2], place: [u32; 2]) -> DVec3 {
    let share = place.map(|k| (f64::from(k) + 0.5) / f64::from(PROBED));
    rays * DVec3::new(
        share[0] * f64::from(size[0]),
        share[1] * f64::from(size[1]),
        1.0,
    )
}

/// Inward unit normals of the planes through the eye and the left, right, upper and lower edge.
fn edges_of(panel: &Panel) -> [DVec3; 4] {
    let [top_left, top_right, bottom_left, bottom_right] = panel.corners();
    let middle = top_left + top_right + bottom_left + bottom_right;
    [
        [top_left, bottom_left],
        [top_right, bottom_right],
        [top_left, top_right],
        [bottom_left, bottom_right],
    ]
    .map(|[a, b]| {
        let normal = a.cross(b).normalize();
        normal * normal.dot(middle).signum()
    })
}

fn share_an_eye(a: &Panel, b: &Panel) -> bool {
    a.is_for_both || b.is_for_both || a.view.eye == b.view.eye
}

/// Whether the cones round two panels meet.
fn meet(a: &Panel, b: &Panel) -> bool {
    let cone = |panel: &Panel| {
        let corners = panel.corners().map(DVec3::normalize);
        let axis = corners.iter().sum::<DVec3>().normalize();
        let half = corners
            .iter()
            .map(|it| axis.angle_between(*it))
            .fold(0.0, f64::max);
        (axis, half)
    };
    let ((axis, half), (other, other_half)) = (cone(a), cone(b));
    axis.angle_between(other) < half + other_half
}
