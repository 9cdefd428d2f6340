//! Where, as the eye sees it, does the lit part of a panel end?

use crate::view::panel::distortion::GREEN;
use crate::view::panel::drawn_grid::DrawnGrid;
use crate::view::panel::residual_grid::ResidualGrid;
use crate::view::panel::rig::Panel;
use glam::{DMat3, DVec3};

/// Fewest pieces along the longer side: chords of a bent edge are then within a hundredth of a
/// pixel where it bulges by 40.
const PIECES: f64 = 128.0;
/// Directions across and down a panel by which overlaps are found and counted.
const PROBED: u32 = 33;

/// A panel as it is sent, and which of its pixels are lit.
pub(super) struct LitPanel<'a> {
    /// From (column, row, 1) of the ideal panel, as sent, to a ray.
    rays: DMat3,
    size: [f64; 2],
    grid: Option<&'a ResidualGrid>,
    /// Columns and rows of cells, each lit or unlit as a whole: one where nothing is bent.
    cells: [usize; 2],
    /// Pixels of a cell.
    cell: [f64; 2],
}

/// A piece of the edge: an arc of a great circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgePiece {
    /// Its number among those of its panel.
    pub(super) number: usize,
    /// The side of the panel that it lies on, from 0; always 0 where the panel is lit in part.
    pub(super) side: usize,
    /// Unit directions of its ends.
    pub(super) ends: [DVec3; 2],
    /// Unit normal, to the lit side, of the plane through the eye and its ends.
    pub(super) inward: DVec3,
    /// Half a pixel there, in radians.
    pub(super) half_pixel: f64,
}

impl<'a> LitPanel<'a> {
    /// A panel that is drawn by a grid of residuals, or by none.
    pub(super) fn of(panel: &Panel, drawn: Option<&'a DrawnGrid>) -> Self {
        let size = panel.sent_size().map(f64::from);
        let seen_from_sent = panel.scanout.seen_from_sent(panel.view.size);
        let grid = drawn.and_then(|it| it.channels.get(GREEN.min(it.channels.len() - 1)));
        Self {
            rays: panel.view.ray_from_pixel() * seen_from_sent,
            size,
            grid,
            cells: grid.map_or([1, 1], |it| it.nodes.map(|count| count - 1)),
            cell: grid.map_or(size, |it| it.step),
        }
    }

    /// From (column, row, 1) of the ideal panel, as sent, to a ray.
    pub(super) fn rays(&self) -> DMat3 {
        self.rays
    }

    /// Unit directions of lit places evenly over the panel.
    pub(super) fn probes(&self) -> impl Iterator<Item = DVec3> + '_ {
        let share = |k: u32| (f64::from(k) + 0.5) / f64::from(PROBED);
        let places = (0..PROBED * PROBED).map(move |k| [share(k % PROBED), share(k / PROBED)]);
        places.filter_map(|share| self.direction([0, 1].map(|k| share[k] * self.size[k])))
    }

    /// The unit direction of a place as sent; `None` where it is unlit.
    pub(super) fn direction(&self, place: [f64; 2]) -> Option<DVec3> {
        let cell = [0, 1].map(|k| {
            let at = (place[k] / self.cell[k]).max(0.0) as usize;
            at.min(self.cells[k] - 1)
        });
        self.is_lit(cell).then(|| self.direction_in(cell, place))
    }

    /// The whole edge of what is lit.
    pub(super) fn edge(&self) -> Vec<EdgePiece> {
        let [columns, rows] = self.cells;
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let mut pieces = Vec::new();
        let has_sides = cells.clone().all(|it| self.is_lit(it));
        for cell in cells.filter(|it| self.is_lit(*it)) {
            for (axis, is_last) in [(0, false), (0, true), (1, false), (1, true)] {
                if !self.is_lit_beside(cell, axis, is_last) {
                    let first = pieces.len();
                    self.add_side(cell, (axis, is_last), &mut pieces);
                    for piece in pieces[first..].iter_mut().filter(|_| has_sides) {
                        piece.side = 2 * axis + usize::from(is_last);
                    }
                }
            }
        }
        pieces
    }

    fn node(&self, [column, row]: [usize; 2]) -> [f64; 2] {
        self.grid.map_or([0.0; 2], |grid| {
            grid.residuals[row * grid.nodes[0] + column].map(f64::from)
        })
    }

    fn is_lit(&self, [column, row]: [usize; 2]) -> bool {
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
        let is_known = |[x, y]: [usize; 2]| {
            let residual = self.node([column + x, row + y]);
            residual.iter().all(|it| it.is_finite())
        };
        self.grid.is_none() || corners.into_iter().all(is_known)
    }

    /// Whether the cell before or after a cell along an axis is lit; none is beyond the panel.
    fn is_lit_beside(&self, cell: [usize; 2], axis: usize, is_next: bool) -> bool {
        let at = match is_next {
            true => cell[axis] + 1,
            false => cell[axis].wrapping_sub(1),
        };
        let mut beside = cell;
        beside[axis] = at;
        at < self.cells[axis] && self.is_lit(beside)
    }

    /// The direction of a place from its cell, which is lit.
    fn direction_in(&self, cell: [usize; 2], place: [f64; 2]) -> DVec3 {
        let [x, y] = [0, 1].map(|k| place[k] / self.cell[k] - cell[k] as f64);
        let node = |dx: usize, dy: usize| self.node([cell[0] + dx, cell[1] + dy]);
        let (a, b, c, d) = (node(0, 0), node(1, 0), node(0, 1), node(1, 1));
        let ideal = [0, 1].map(|k| {
            let upper = a[k] * (1.0 - x) + b[k] * x;
            let lower = c[k] * (1.0 - x) + d[k] * x;
            place[k] + upper * (1.0 - y) + lower * y
        });
        (self.rays * DVec3::new(ideal[0], ideal[1], 1.0)).normalize()
    }

    /// Adds the side of a cell that lies first or last along an axis.
    fn add_side(
        &self,
        cell: [usize; 2],
        (axis, is_last): (usize, bool),
        pieces: &mut Vec<EdgePiece>,
    ) {
        let low = [0, 1].map(|k| cell[k] as f64 * self.cell[k]);
        let high = [0, 1].map(|k| (low[k] + self.cell[k]).min(self.size[k]));
        let along = 1 - axis;
        let length = high[along] - low[along];
        let longest = self.size[0].max(self.size[1]) / PIECES;
        let count = libm::ceil(length / longest).max(1.0);
        let place = |share: f64, inward: f64| {
            let mut place = low;
            place[along] += share * length;
            place[axis] = match is_last {
                true => high[axis] - inward,
                false => low[axis] + inward,
            };
            self.direction_in(cell, place)
        };
        // Within the cell, however small it is.
        let inward = 0.5 * (high[axis] - low[axis]).min(1.0);
        for k in 0..count as u32 {
            let share = |k: u32| f64::from(k) / count;
            let ends = [place(share(k), 0.0), place(share(k + 1), 0.0)];
            let inner = place((f64::from(k) + 0.5) / count, inward);
            let Some(normal) = ends[0].cross(ends[1]).try_normalize() else {
                continue;
            };
            let middle = (ends[0] + ends[1]).normalize_or_zero();
            pieces.push(EdgePiece {
                number: pieces.len(),
                side: 0,
                ends,
                inward: normal * normal.dot(inner).signum(),
                half_pixel: middle.distance(inner) * 0.5 / inward,
            });
        }
    }
}

impl EdgePiece {
    /// The direction of its middle.
    pub(super) fn middle(&self) -> DVec3 {
        (self.ends[0] + self.ends[1]).normalize()
    }

    /// The square of the chord to its nearest point, and the sine of the angle to its plane,
    /// positive on the lit side.
    pub(super) fn reached(&self, from: DVec3) -> [f64; 2] {
        let [a, b] = self.ends;
        let sine = self.inward.dot(from);
        // Which way the ends follow each other about the normal.
        let turn = self.inward.dot(a.cross(b)).signum();
        let is_after = self.inward.cross(a).dot(from) * turn >= 0.0;
        let is_before = b.cross(self.inward).dot(from) * turn >= 0.0;
        let chord = match is_after && is_before {
            true => 2.0 * sine * sine / (1.0 + (1.0 - sine * sine).max(0.0).sqrt()),
            false => from.distance_squared(a).min(from.distance_squared(b)),
        };
        [chord, sine]
    }
}
