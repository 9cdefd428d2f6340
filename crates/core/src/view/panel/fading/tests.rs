//! Do fades end where light ends, evenly, and do shares of light add up?

use super::{Fades, LitPanel};
use crate::units::Radians;
use crate::view::axes::{Axes, angle_between};
use crate::view::eye_view::Field;
use crate::view::panel::distortion::Distortion;
use crate::view::panel::drawn_grid::DrawnGrid;
use crate::view::panel::lens::BrownConrady;
use crate::view::panel::placement::{Placement, SourceProjection};
use crate::view::panel::placing::samples::PanelSamples;
use crate::view::panel::residual_grid::ResidualGrid;
use crate::view::panel::rig::{Panel, Scanout};
use crate::view::panel::tests::sets::panel;
use glam::DVec3;
use std::sync::Arc;

const SIZE: [u32; 2] = [480, 320];

/// Panels as they are drawn, and how they share light.
struct Shown {
    panels: Vec<Panel>,
    grids: Vec<Option<DrawnGrid>>,
    fades: Fades,
}

impl Shown {
    fn of(panels: Vec<Panel>) -> Self {
        let plane = Placement::new(SourceProjection::Plane, Axes::FRONT, [1.0; 4]);
        let grids = panels.iter().map(|it| DrawnGrid::of(it, &plane));
        let grids: Vec<Option<DrawnGrid>> = grids.collect();
        let both = panels.iter().zip(grids.iter().map(Option::as_ref));
        let fades = Fades::of(&both.collect::<Vec<_>>());
        Self {
            panels,
            grids,
            fades,
        }
    }

    fn direction(&self, index: usize, place: [f64; 2]) -> Option<DVec3> {
        let lit = LitPanel::of(&self.panels[index], self.grids[index].as_ref());
        lit.direction(place)
    }

    /// The share of a pixel as sent; `None` where it is unlit.
    fn share(&self, index: usize, pixel: [u32; 2]) -> Option<f64> {
        let direction = self.direction(index, pixel.map(|it| f64::from(it) + 0.5))?;
        Some(self.fades.share(index, direction).light)
    }

    /// Largest step of the share from a pixel to its neighbours, farther than `apart` radians from
    /// places where it may be steep.
    fn step(&self, steep: &[DVec3], apart: f64) -> f64 {
        let mut worst = 0.0_f64;
        for index in 0..self.panels.len() {
            let [columns, rows] = self.panels[index].sent_size();
            let shares: Vec<Option<f64>> = (0..rows)
                .flat_map(|row| (0..columns).map(move |column| [column, row]))
                .map(|pixel| {
                    let at = self.direction(index, pixel.map(f64::from))?;
                    let is_even = steep.iter().all(|it| angle_between(*it, at).0 > apart);
                    self.share(index, pixel).filter(|_| is_even)
                })
                .collect();
            let columns = columns as usize;
            for (k, own) in shares.iter().enumerate() {
                let right = (k % columns + 1 < columns).then(|| shares[k + 1]).flatten();
                let below = shares.get(k + columns).copied().flatten();
                for other in [right, below].into_iter().flatten() {
                    worst = own.map_or(worst, |own| worst.max((own - other).abs()));
                }
            }
        }
        worst
    }

    /// How far from one the shares of all panels are that look at what one of them shows; not at
    /// most a pixel off an edge, where half a pixel counts.
    fn off(&self) -> f64 {
        let sampled: Vec<PanelSamples<'_>> = self
            .panels
            .iter()
            .map(|panel| PanelSamples::of(panel, 1))
            .collect();
        let mut worst = 0.0_f64;
        for index in 0..self.panels.len() {
            let [columns, rows] = self.panels[index].sent_size();
            for k in 0..6000_u32 {
                let pixel = [k * 37 % columns, k * 61 % rows];
                let place = pixel.map(|it| f64::from(it) + 0.5);
                let Some(direction) = self.direction(index, place) else {
                    continue;
                };
                let seen = (0..self.panels.len()).filter(|it| sampled[*it].sees(direction));
                let sum: f64 = seen.map(|it| self.fades.share(it, direction).light).sum();
                worst = worst.max((sum - 1.0).abs());
            }
        }
        worst
    }
}

fn fading(mut panel: Panel, degrees: f64) -> Panel {
    panel.blend = f64::to_radians(degrees);
    panel.is_for_both = true;
    panel
}

/// Screens of a wall straight ahead, 480 x 320 pixels for 0.9 x 0.6, which overlap by 0.3.
fn wall(columns: u32, rows: u32) -> Vec<Panel> {
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let of = |[column, row]: [u32; 2]| {
        let middle =
            |k: u32, count: u32, step: f64| (f64::from(k) - f64::from(count - 1) / 2.0) * step;
        let (x, y) = (middle(column, columns, 0.6), middle(row, rows, 0.3));
        let mut it = panel("wall", Axes::FRONT, [0.9, 0.6], SIZE);
        it.view.field = Field::of([0.45 - x, 0.45 + x, 0.3 - y, 0.3 + y]);
        fading(it, 12.0)
    };
    places.map(of).collect()
}

/// Two that look to the left and to the right.
fn turned(lens: f64) -> Vec<Panel> {
    let of = |yaw: f64| {
        let axes =
            Axes::from_yaw_pitch_roll(Radians::from_degrees(yaw), Radians(0.0), Radians(0.0));
        let mut it = panel("turned", axes, [0.9, 0.6], SIZE);
        if lens != 0.0 {
            let lens = BrownConrady {
                centre: [0.0; 2],
                radial: [lens, 0.0, 0.0],
                tangential: [0.0; 2],
            };
            it.distortion = Distortion::BrownConrady(Box::new([lens; 3]));
        }
        fading(it, 12.0)
    };
    vec![of(-15.0), of(15.0)]
}

/// Where the upper and the lower edges of panels cross that mirror each other.
fn crossings(shown: &Shown) -> [DVec3; 2] {
    let rows = [0.0, f64::from(SIZE[1])];
    rows.map(|row| {
        let columns = (0..=10 * SIZE[0]).map(|k| f64::from(k) / 10.0);
        let all = columns.filter_map(|column| shown.direction(0, [column, row]));
        all.min_by(|a, b| a.x.abs().total_cmp(&b.x.abs())).unwrap()
    })
}

#[test]
fn fades_on_a_flat_wall_have_no_step_at_its_top_nor_where_four_screens_meet() {
    for (columns, rows) in [(2, 1), (1, 2), (2, 2)] {
        let shown = Shown::of(wall(columns, rows));
        let (step, off) = (shown.step(&[], 0.0), shown.off());
        // The outermost pixel of a corner lies where distances to all edges are not linear.
        assert!(step <= 0.0125, "{columns} x {rows}: {step}");
        assert!(off <= 0.01, "{columns} x {rows}: {off}");
        // In the middle of two, each gives half; a screen gives all where it is alone.
        let [w, h] = SIZE;
        if (columns, rows) == (2, 1) {
            for row in [0, h / 2, h - 1] {
                assert!((shown.share(0, [w - 80, row]).unwrap() - 0.5).abs() < 0.01);
                assert_eq!(shown.share(0, [10, row]), Some(1.0));
                assert!(shown.share(0, [w - 1, row]).unwrap() < 0.01);
            }
        }
    }
}

#[test]
fn fades_of_bent_panels_end_where_light_ends_and_add_up() {
    for lens in [0.0, -0.25, 0.3] {
        let mut panels = turned(lens);
        panels[1].scanout = Scanout::Rot90;
        let shown = Shown::of(panels);
        let off = shown.off();
        assert!(off <= 0.01, "{lens}: {off}");
        // Where edges cross one panel gives all on one side and nothing on the other.
        let pixel = 0.9 / f64::from(SIZE[0]);
        let step = shown.step(&crossings(&shown), 105.0 * pixel);
        assert!(step <= 0.01, "{lens}: {step}");
        let middle = shown.share(0, [SIZE[0] - 1, SIZE[1] / 2]).unwrap();
        assert!(middle < 0.01, "{lens}: {middle}");
    }
}

#[test]
fn fades_stay_even_along_edges_that_lie_on_each_other_or_nearly_so() {
    // The lower edges lie on the horizon, or a fraction of a pixel above and below it.
    for lift in [0.0_f64, 0.0006, -0.002] {
        let mut panels = turned(0.0);
        panels[0].view.field = Field::of([0.45, 0.45, 0.6, lift]);
        panels[1].view.field = Field::of([0.45, 0.45, 0.6, 0.0]);
        let shown = Shown::of(panels);
        let pixel = 0.9 / f64::from(SIZE[0]);
        let step = shown.step(&crossings(&shown)[..1], 105.0 * pixel);
        // Where they are apart by a pixel, one row is alone.
        let most = if lift.abs() < 0.5 * pixel { 0.015 } else { 1.0 };
        assert!(step <= most, "{lift}: {step}");
        assert!(shown.off() <= 0.01, "{lift}: {}", shown.off());
    }
}

#[test]
fn a_fade_ends_at_the_border_of_what_a_map_leaves_unlit() {
    let mut panels = wall(2, 1);
    // The right one shows nothing in its first 80 columns.
    let grid = ResidualGrid::over(SIZE, [121, 81], |[x, _]| match x < 80.0 {
        true => [f64::NAN; 2],
        false => [0.0; 2],
    });
    panels[1].distortion = Distortion::Grid([(); 3].map(|()| Arc::new(grid.clone())));
    let shown = Shown::of(panels);
    assert_eq!(shown.share(1, [40, 100]), None);
    assert!(shown.share(1, [80, 100]).unwrap() < 0.01);
    // 80 columns of overlap are left, in which all the light goes from one to the other.
    let step = shown.step(&[], 0.0);
    assert!(step <= 1.05 / 80.0, "{step}");
    assert_eq!(shown.share(0, [399, 100]), Some(1.0));
    assert!(shown.off() <= 0.01);
}

#[test]
fn black_is_lifted_by_as_many_panels_as_are_missing() {
    let shown = Shown::of(wall(2, 2));
    assert_eq!(shown.fades.most, 4);
    let lifts = |pixel: [f64; 2]| {
        let direction = shown.direction(0, pixel).unwrap();
        shown.fades.share(0, direction).lifts
    };
    assert_eq!(lifts([10.0, 10.0]), 3.0);
    assert_eq!(lifts([470.0, 10.0]), 2.0);
    assert_eq!(lifts([470.0, 310.0]), 0.0);
}

#[test]
fn what_overlaps_nothing_gives_all_its_light() {
    let shown = Shown::of(wall(1, 1));
    assert_eq!(shown.share(0, [0, 0]), Some(1.0));
    let mut apart = turned(0.0);
    apart[1] = Panel {
        blend: 0.0,
        ..apart[1].clone()
    };
    let shown = Shown::of(apart);
    assert_eq!(shown.fades.of_panel, [Some(0), None]);
    assert_eq!(shown.share(0, [479, 160]), Some(1.0));
}
