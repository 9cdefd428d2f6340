//! Where do panels look, at enough of their places to place a source by?

use super::super::distortion::{Distortion, GREEN};
use super::super::pixel_map::{PanelRay, singular_values};
use super::super::rig::Panel;
use crate::view::axes::{angle_between, direction_at};
use crate::view::eye_view::{EyeView, Field};
use glam::DVec3;

/// Steps of pattern searches begin at this many radians (6°) and end below the last (0.001°).
pub(in super::super) const FIRST_STEP: f64 = 0.104_719_755;
const LAST_STEP: f64 = 1.7e-5;

/// The rays of one panel that placements are judged by.
pub(in super::super) struct PanelSamples<'a> {
    pub(in super::super) panel: &'a Panel,
    /// Unit rays round the lit part: no other place of the panel looks outside of them.
    pub(in super::super) rim: Vec<DVec3>,
    /// The corners where nothing bends, else the whole rim: what is outermost on any plane.
    pub(in super::super) outer: Vec<DVec3>,
    /// Centres of pixels, evenly over the panel with its outermost ones.
    pub(in super::super) inner: Vec<PanelRay>,
}

impl<'a> PanelSamples<'a> {
    /// With `count` x `count` inner pixels.
    pub(in super::super) fn of(panel: &'a Panel, count: u32) -> Self {
        let size = panel.view.size;
        let centres = |side: u32| -> Vec<f64> {
            let last = (count - 1).max(1);
            let pixel = move |k| u64::from(k) * u64::from(side - 1) / u64::from(last);
            (0..count).map(|k| pixel(k) as f64 + 0.5).collect()
        };
        let (columns, rows) = (centres(size[0]), centres(size[1]));
        let all = rows.iter().flat_map(|y| columns.iter().map(|x| [*x, *y]));
        let rim = rim(panel);
        let outer = match panel.distortion.is_none() {
            true => panel.corners().map(DVec3::normalize).to_vec(),
            false => rim.clone(),
        };
        Self {
            panel,
            rim,
            outer,
            inner: all.filter_map(|at| panel.ray_at(at, GREEN)).collect(),
        }
    }

    /// Whether a lit place of the panel looks in a direction.
    pub(in super::super) fn sees(&self, direction: DVec3) -> bool {
        let Some(ideal) = self.panel.view.place(direction) else {
            return false;
        };
        let seen = match self.panel.distortion.is_none() {
            true => Some(ideal),
            false => seen_from_ideal(self.panel, ideal),
        };
        let size = self.panel.view.size.map(f64::from);
        seen.is_some_and(|place| [0, 1].iter().all(|&k| (0.0..size[k]).contains(&place[k])))
    }
}

/// The place that is seen where an ideal panel has one, by Newton's method; `None` where there is
/// none near the panel.
fn seen_from_ideal(panel: &Panel, ideal: [f64; 2]) -> Option<[f64; 2]> {
    const MOST_STEPS: u32 = 16;
    /// Panel pixels.
    const NEAR_ENOUGH: f64 = 1e-3;
    let size = panel.view.size.map(f64::from);
    // Beyond the edge a lens may be anything: no step goes far beyond.
    let kept = |place: [f64; 2]| [0, 1].map(|k| place[k].clamp(-0.05 * size[k], 1.05 * size[k]));
    let mut place = kept(ideal);
    for _ in 0..MOST_STEPS {
        let bent = panel.distortion.ideal(&panel.view, place, GREEN)?;
        let [x, y] = [0, 1].map(|k| ideal[k] - bent.place[k]);
        if x * x + y * y < NEAR_ENOUGH * NEAR_ENOUGH {
            return Some(place);
        }
        let [[a, b], [c, d]] = bent.jacobian;
        let area = bent.area();
        place = kept([
            place[0] + (d * x - b * y) / area,
            place[1] + (a * y - c * x) / area,
        ]);
    }
    None
}

/// Places on the border, at every pixel and no fewer than 512 a side; with a bent panel's inner
/// places, which may look outside of it where parts are unlit.
fn rim(panel: &Panel) -> Vec<DVec3> {
    const FEWEST: u32 = 512;
    let [w, h] = panel.view.size;
    let along = |side: u32| {
        let count = side.max(FEWEST);
        (0..=count).map(move |k| f64::from(side) * f64::from(k) / f64::from(count))
    };
    let [right, bottom] = [w, h].map(f64::from);
    let columns = along(w).flat_map(|x| [[x, 0.0], [x, bottom]]);
    let rows = along(h).flat_map(|y| [[0.0, y], [right, y]]);
    let mut places: Vec<[f64; 2]> = columns.chain(rows).collect();
    if matches!(panel.distortion, Distortion::Grid(_)) {
        let step = |side: u32| (0..=side.div_ceil(8)).map(move |k| (8 * k).min(side));
        places.extend(step(h).flat_map(|y| step(w).map(move |x| [x, y].map(f64::from))));
    }
    let rays = places.into_iter().filter_map(|at| panel.ray_at(at, GREEN));
    rays.map(|found| found.ray.normalize()).collect()
}

/// The smallest cone round all panels: its axis and half angle in radians. Of bent rims a part of
/// the rays will do.
pub(in super::super) fn cone_of(all: &[PanelSamples<'_>]) -> (DVec3, f64) {
    let rays = all.iter().flat_map(|it| {
        let step = it.outer.len().div_ceil(256).max(1);
        it.outer.iter().copied().step_by(step)
    });
    cone(&rays.collect::<Vec<_>>())
}

/// The smallest cone round unit rays: its axis and half angle in radians.
fn cone(rays: &[DVec3]) -> (DVec3, f64) {
    // Towards the farthest ray by ever smaller steps (Badoiu and Clarkson 2003), then exactly.
    let mut centre = rays.iter().sum::<DVec3>();
    centre /= rays.len().max(1) as f64;
    for turn in 1..64 {
        let farthest = rays.iter().max_by(|a, b| {
            a.distance_squared(centre)
                .total_cmp(&b.distance_squared(centre))
        });
        let Some(farthest) = farthest else { break };
        centre += (*farthest - centre) / f64::from(turn + 1);
    }
    let axis = centre.try_normalize().unwrap_or(DVec3::NEG_Z);
    let widest = |axis: DVec3| {
        let angles = rays.iter().map(|ray| angle_between(axis, *ray).0);
        angles.fold(0.0, f64::max)
    };
    search(axis, FIRST_STEP, |axis| Some(widest(axis))).unwrap_or((axis, widest(axis)))
}

/// The direction of least cost near another, and the cost: pattern search, steps halved where none
/// is better. Nothing where there is no cost at the beginning.
pub(in super::super) fn search(
    from: DVec3,
    first_step: f64,
    cost: impl Fn(DVec3) -> Option<f64>,
) -> Option<(DVec3, f64)> {
    let mut best = (from, cost(from)?);
    let mut step = first_step;
    while step > LAST_STEP {
        let around = (0..8).map(|k| core::f64::consts::FRAC_PI_4 * f64::from(k));
        let near = around.map(|bearing| {
            direction_at(
                best.0,
                crate::units::Radians(bearing),
                crate::units::Radians(step),
            )
        });
        let costs = near.filter_map(|direction| Some((direction, cost(direction)?)));
        let least = costs.min_by(|a, b| a.1.total_cmp(&b.1));
        match least {
            // Gains in the last digits are none: what is symmetrical stays so.
            Some(better) if better.1 < best.1 * (1.0 - 1e-9) => best = better,
            _ => step /= 2.0,
        }
    }
    Some(best)
}

impl Panel {
    /// The flat view in which everything lies that the panel shows through its optics, nowhere less
    /// dense than the panel unless that takes more than 8,192 pixels on a side: itself where
    /// nothing is bent.
    #[must_use]
    pub fn reach(&self) -> EyeView {
        const STEPS: u32 = 32;
        /// Nothing is denser than this many pixels of it in one, on a side.
        const LEAST_SIGMA: f64 = 0.1;
        /// Every device draws so many on a side.
        const MOST_PIXELS: f64 = 8192.0;
        if self.distortion.is_none() {
            return self.view;
        }
        let size = self.view.size.map(f64::from);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut finest: f64 = 1.0;
        for step in 0..(STEPS + 1) * (STEPS + 1) {
            let at = [step % (STEPS + 1), step / (STEPS + 1)];
            let place = [0, 1].map(|k| size[k] * f64::from(at[k]) / f64::from(STEPS));
            for channel in 0..3 {
                let Some(bent) = self.distortion.ideal(&self.view, place, channel) else {
                    continue;
                };
                for k in 0..2 {
                    low[k] = low[k].min(bent.place[k]);
                    high[k] = high[k].max(bent.place[k]);
                }
                let [[a, b], [c, d]] = bent.jacobian;
                // The singular value that shrinks most: a pixel seen is that much of an ideal one.
                let least = singular_values([[a, b], [c, d]])[1];
                finest = finest.min(least.max(LEAST_SIGMA));
            }
        }
        if !(low[0] < high[0] && low[1] < high[1]) {
            return self.view;
        }
        let field = self.view.field;
        let pitch = [
            (field.left + field.right) / size[0],
            (field.up + field.down) / size[1],
        ];
        // Between two steps a lens bulges by less than a step.
        let beyond = [0, 1].map(|k| (high[k] - low[k]) / f64::from(STEPS));
        let [left, up] = [0, 1].map(|k| low[k] - beyond[k]);
        let [right, down] = [0, 1].map(|k| high[k] + beyond[k]);
        let pixels = |k: usize, from: f64, to: f64| {
            let most = MOST_PIXELS.max(size[k]);
            libm::ceil((to - from) / finest).clamp(1.0, most) as u32
        };
        EyeView {
            field: Field::of([
                field.left - left * pitch[0],
                right * pitch[0] - field.left,
                field.up - up * pitch[1],
                down * pitch[1] - field.up,
            ]),
            size: [pixels(0, left, right), pixels(1, up, down)],
            ..self.view
        }
    }
}
