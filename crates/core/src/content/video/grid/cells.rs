//! How coarse may a cell be before a viewer could notice?
//!
//! The answer is a footprint: the level-0 pixels that one shown texel may span. A level is allowed
//! where its footprint is allowed everywhere in the cell.

use crate::content::video::grid::sphere_cell::SphereCell;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::units::{Ppd, Radians};
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;
use crate::view::frustum::Frustum;
use glam::DVec3;

/// Places a cell is probed at on each axis, borders included: corners alone are too few where a
/// tile is larger than the fovea.
const PROBES: u32 = 9;

/// A cell as selection sees it: what is needed to skip it without probing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellBounds {
    pub(crate) cell: Tile,
    /// Its middle, one of the places that it is probed at.
    middle: Probe,
    /// Its corners, which are probed too.
    corners: [Probe; 4],
    /// Directions between which it lies.
    hull: [DVec3; 4],
    /// Angle from the centre to the farthest corner, and its sine, of a quarter turn at most.
    radius: Radians,
    sine: f64,
    /// Least density in the cell.
    ppd: Ppd,
}

/// One place in a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    pub(crate) direction: DVec3,
    pub(crate) ppd: Ppd,
}

impl CellBounds {
    pub(crate) fn new(grid: &TileGrid, cell: Tile) -> Self {
        let middle = PROBES / 2;
        let middle = probe(grid, cell, [middle, middle]);
        let centre = middle.direction;
        let (mut radius, mut ppd) = (Radians(0.0), Ppd(f64::MAX));
        for probe in probes(grid, cell) {
            let angle = angle_between(centre, probe.direction);
            radius = if angle > radius { angle } else { radius };
            ppd = if probe.ppd < ppd { probe.ppd } else { ppd };
        }
        let corners = corners(grid, cell);
        let mut hull = corners.map(|corner| corner.direction);
        if !grid.surface.is_of_planes() {
            let sphere_cell = SphereCell::new(grid, cell);
            hull = sphere_cell.hull();
            radius = Radians(radius.0.max(sphere_cell.least_radius()));
        }
        Self {
            cell,
            middle,
            corners,
            hull,
            radius,
            sine: libm::sin(radius.0.min(core::f64::consts::FRAC_PI_2)),
            ppd,
        }
    }

    /// Whether no place of it is in sight.
    pub(crate) fn is_beyond(&self, sight: &Frustum) -> bool {
        let centre = self.middle.direction;
        let surely = sight.is_surely_missed(centre, self.sine);
        surely.unwrap_or_else(|| sight.is_missed_by(centre, self.radius))
            || sight.is_missed_between(self.hull)
    }

    /// Its corners, as they are probed.
    pub(crate) fn corners(&self) -> &[Probe; 4] {
        &self.corners
    }

    /// Its middle, as it is probed.
    pub(crate) fn middle(&self) -> &Probe {
        &self.middle
    }

    /// The direction of its middle.
    pub(crate) fn centre(&self) -> DVec3 {
        self.middle.direction
    }

    /// Least eccentricity that any place of the cell can have.
    pub(crate) fn least_eccentricity(&self, gaze: DVec3) -> Radians {
        Radians((angle_between(gaze, self.middle.direction).0 - self.radius.0).max(0.0))
    }

    /// Greatest eccentricity that any place of the cell can have.
    pub(crate) fn most_eccentricity(&self, gaze: DVec3) -> Radians {
        let away = angle_between(gaze, self.middle.direction).0 + self.radius.0;
        Radians(away.min(core::f64::consts::PI))
    }

    /// How much nearer to the gaze another probe can be than the one called nearest: cosines of
    /// small angles cannot be distinguished any better.
    pub(crate) const NEAREST_WITHIN: Radians = Radians(1e-7);

    /// The place of those probed that is nearest to the gaze.
    pub(crate) fn nearest_probe(&self, grid: &TileGrid, gaze: DVec3) -> Probe {
        let axes = grid.surface.axes(u32::from(self.cell.face));
        let ahead = [axes.right, axes.down, axes.forward].map(|axis| axis.dot(gaze));
        let tangents: [[f64; 2]; PROBES as usize] = core::array::from_fn(|step| {
            grid.surface
                .tangent(place(grid, self.cell, [step as u32; 2]))
        });
        let on_plane = |[x, y]: [u32; 2]| {
            let [a, b] = [tangents[x as usize][0], tangents[y as usize][1]];
            (a * ahead[0] + b * ahead[1] + ahead[2]) / (a * a + b * b + 1.0).sqrt()
        };
        let turned = tangents.map(|[yaw, down]| [libm::sincos(yaw), libm::sincos(down)]);
        let on_sphere = |[x, y]: [u32; 2]| {
            let [(right, forward), _] = turned[x as usize];
            let [_, (down, level)] = turned[y as usize];
            level * (right * ahead[0] + forward * ahead[2]) + down * ahead[1]
        };
        let is_of_planes = grid.surface.is_of_planes();
        let mut nearest = (f64::NEG_INFINITY, [0; 2]);
        for step in steps() {
            let cosine = match is_of_planes {
                true => on_plane(step),
                false => on_sphere(step),
            };
            if cosine > nearest.0 {
                nearest = (cosine, step);
            }
        }
        probe(grid, self.cell, nearest.1)
    }

    /// At least the angle between two neighbouring probes.
    pub(crate) fn probe_spacing(&self) -> Radians {
        // Eight steps across a diameter; across a diagonal, and where a face is wide, they are
        // longer than the mean by less than two.
        Radians(self.radius.0 / 2.0)
    }

    /// Least density of the cell.
    pub(crate) fn least_ppd(&self) -> Ppd {
        self.ppd
    }
}

/// The places at which a cell is probed, borders included.
pub(crate) fn probes(grid: &TileGrid, cell: Tile) -> impl Iterator<Item = Probe> + '_ {
    steps().map(move |step| probe(grid, cell, step))
}

fn corners(grid: &TileGrid, cell: Tile) -> [Probe; 4] {
    const LAST: u32 = PROBES - 1;
    [[0, 0], [LAST, 0], [0, LAST], [LAST, LAST]].map(|step| probe(grid, cell, step))
}

fn steps() -> impl Iterator<Item = [u32; 2]> {
    (0..PROBES * PROBES).map(|k| [k % PROBES, k / PROBES])
}

/// Places that a view looks at or would if it were half as large again, each with its cell.
pub(crate) fn probes_under(grid: &TileGrid, view: &EyeView) -> impl Iterator<Item = (Tile, Probe)> {
    (0..PROBES * PROBES).filter_map(move |k| {
        let across = |step: u32| f64::from(step) / f64::from(PROBES - 1) * 1.5 - 0.25;
        let step = [k % PROBES, k / PROBES];
        let direction = view
            .ray([0, 1].map(|k| across(step[k]) * f64::from(view.size[k])))
            .normalize();
        let (face, place) = grid.surface.locate(direction)?;
        let side = grid.surface.size.map(f64::from);
        if (0..2).any(|k| !(0.0..side[k]).contains(&place[k])) {
            return None;
        }
        let ppd = grid.surface.ppd(place);
        Some((grid.cell_at(face, place), Probe { direction, ppd }))
    })
}

fn probe(grid: &TileGrid, cell: Tile, step: [u32; 2]) -> Probe {
    let place = place(grid, cell, step);
    Probe {
        direction: grid.surface.direction(u32::from(cell.face), place),
        ppd: grid.surface.ppd(place),
    }
}

/// Level-0 pixels on the cell's face.
fn place(grid: &TileGrid, cell: Tile, step: [u32; 2]) -> [f64; 2] {
    let (from, size) = (grid.origin(cell), grid.covered(cell));
    [0, 1].map(|k| {
        f64::from(from[k]) + f64::from(size[k]) * f64::from(step[k]) / f64::from(PROBES - 1)
    })
}

/// The coarsest level whose texels span no more than `footprint` level-0 pixels.
pub(crate) fn level_of_footprint(grid: &TileGrid, footprint: f64) -> u8 {
    // A rounding error must not ask for a finer level than a footprint that is exactly allowed.
    let allowed = footprint * (1.0 + 1e-9);
    (1..grid.levels)
        .take_while(|&level| f64::from(grid.scale(level)) <= allowed)
        .count() as u8
}
