//! How does a plane lie so that the fewest source pixels are needed?
//!
//! Need is the area of the rectangle round all panels over the square of the smallest singular
//! value of d(source)/d(pixel): pixels at which no panel pixel is magnified.

use super::super::distortion::GREEN;
use super::super::placement::{Placement, SourceProjection};
use super::hull::{TurnedRectangle, hull, least_rectangle};
use super::samples::{FIRST_STEP, PanelSamples, cone_of, search};
use crate::units::Radians;
use crate::view::axes::{Axes, direction_at, yaw_pitch_from_direction};
use glam::DVec3;

/// Rays at more than this from a plane's axis (85°) are on none: its cosine.
const LEAST_DEPTH: f64 = 0.087_155_7;
/// How far from the axis of the cone the first search looks, in radians (60°).
const WIDEST: f64 = 1.05;

/// The axes of a direction, upright.
pub(in super::super) fn upright(forward: DVec3) -> Axes {
    let (yaw, pitch) = yaw_pitch_from_direction(forward);
    Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0))
}

/// Axes turned by a roll clockwise about where they look.
fn rolled(axes: Axes, roll: f64) -> Axes {
    let (sin, cos) = (libm::sin(roll), libm::cos(roll));
    Axes {
        forward: axes.forward,
        right: axes.right * cos + axes.down * sin,
        down: axes.down * cos - axes.right * sin,
    }
}

/// Tangents to the right and down of unit rays; `None` where one lies on no plane.
fn projected(axes: &Axes, rays: &[DVec3]) -> Option<Vec<[f64; 2]>> {
    let all = rays.iter().map(|ray| {
        let depth = ray.dot(axes.forward);
        let place = || [ray.dot(axes.right) / depth, ray.dot(axes.down) / depth];
        (depth > LEAST_DEPTH).then(place)
    });
    all.collect()
}

/// The outermost rays: all others lie between them on any plane that has all.
fn outermost(rays: &[DVec3], axis: DVec3) -> Option<Vec<DVec3>> {
    let points = projected(&upright(axis), rays)?;
    let corners = hull(&points).into_iter().map(|k| rays[k]);
    Some(corners.collect())
}

/// The smallest singular value over all panels, in the placement's own units a pixel; `None` where
/// some pixel looks past it.
pub(in super::super) fn least_sigma(
    all: &[PanelSamples<'_>],
    placement: &Placement,
) -> Option<f64> {
    let mut least = f64::INFINITY;
    for one in all {
        for ray in &one.inner {
            least = least.min(ray.coordinates(placement)?.sigma()[1]);
        }
        // Of a plane a panel's least is often at the pixel nearest its axis.
        let size = one.panel.view.size.map(f64::from);
        if let Some(place) = one.panel.view.place(placement.axes.forward) {
            let nearest = [0, 1].map(|k| place[k].clamp(0.5, size[k] - 0.5));
            let ray = one.panel.ray_at(nearest, GREEN);
            let found = ray.and_then(|ray| ray.coordinates(placement));
            least = found.map_or(least, |found| least.min(found.sigma()[1]));
        }
    }
    Some(least)
}

/// A placement of a rectangle on the plane square to axes.
fn placed(axes: Axes, rectangle: TurnedRectangle) -> Placement {
    let ([left, right], [up, down]) = (rectangle.across, rectangle.along);
    let axes = rolled(axes, rectangle.roll);
    Placement::new(SourceProjection::Plane, axes, [-left, right, -up, down])
}

/// The plane that needs the fewest pixels, with a source's aspect or a free one; `None` where no
/// plane has all panels.
pub(in super::super) fn best_plane(
    all: &[PanelSamples<'_>],
    aspect: Option<f64>,
) -> Option<Placement> {
    let (axis, _) = cone_of(all);
    let rays: Vec<DVec3> = all.iter().flat_map(|it| it.outer.iter().copied()).collect();
    let rays = outermost(&rays, axis)?;
    let placement_for = |forward: DVec3| {
        let axes = upright(forward);
        let rectangle = least_rectangle(&projected(&axes, &rays)?, aspect);
        Some(placed(axes, rectangle))
    };
    let cost = |forward: DVec3| {
        let placement = placement_for(forward)?;
        let [width, height] = placement.extent();
        let sigma = least_sigma(all, &placement)?;
        Some(width * height / (sigma * sigma))
    };
    // A panel's own plane is the best one of that panel; all of one direction are one.
    let own = all.iter().map(|it| it.panel.view.axes.forward);
    let starts = own.chain([DVec3::NEG_Z, axis]).chain(rings(axis));
    let costs = starts.filter_map(|forward| Some((forward, cost(forward)?)));
    let first = costs.reduce(|best, it| match it.1 < best.1 * (1.0 - 1e-9) {
        true => it,
        false => best,
    });
    let (forward, _) = search(first?.0, FIRST_STEP / 2.0, cost)?;
    placement_for(forward)
}

/// Directions 6° apart round an axis.
fn rings(axis: DVec3) -> impl Iterator<Item = DVec3> {
    let rings = (1..).map(|k| f64::from(k) * FIRST_STEP);
    rings
        .take_while(|angle| *angle < WIDEST)
        .flat_map(move |angle| {
            let count = libm::ceil(core::f64::consts::TAU * libm::sin(angle) / FIRST_STEP);
            let bearing = move |k: u32| core::f64::consts::TAU * f64::from(k) / count;
            (0..count as u32).map(move |k| direction_at(axis, Radians(bearing(k)), Radians(angle)))
        })
}
