//! How does the pass know the optics of a panel? By residuals on a grid.

use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::rig::Panel;
use glam::{DMat3, DVec3};

/// Most pixels from one node to the next, and fewest.
const CELLS: [u32; 2] = [32, 4];

/// Pixels by which a grid may be wrong in the middle of a cell before a finer one is taken.
const MOST_ERROR: f64 = 1.0 / 64.0;

/// Pixels between the places of red and blue from which on colours are fetched one by one.
const COLOURS_APART: f64 = 0.25;

/// A residual where nothing is lit; the shader knows what is as far as a tenth of it.
const UNLIT: f32 = 1e9;

/// A panel's residuals.
pub(super) struct BentGrid {
    /// Pixels from node to node.
    pub(super) cell: u32,
    /// One, or three of red, green and blue.
    pub(super) channels: u32,
    /// Bits of two numbers a node: rows of nodes, channel by channel.
    pub(super) bits: Vec<u32>,
}

/// What a panel as it is sent does to its pixels before it looks at a source.
pub(super) struct Bend<'a> {
    panel: &'a Panel,
    placement: &'a Placement,
    seen_from_sent: DMat3,
    sent_from_seen: DMat3,
}

impl<'a> Bend<'a> {
    /// `None` where pixels look straight ahead, as on most panels.
    pub(super) fn of(panel: &'a Panel, placement: &'a Placement) -> Option<Self> {
        let seen_from_sent = panel.scanout.seen_from_sent(panel.view.size);
        let bend = Self {
            panel,
            placement,
            seen_from_sent,
            sent_from_seen: seen_from_sent.inverse(),
        };
        (!panel.distortion.is_none() || bend.is_near_and_curved()).then_some(bend)
    }

    /// Seen from beside its middle, a curved source is not where a straight ray goes.
    fn is_near_and_curved(&self) -> bool {
        self.placement.projection != SourceProjection::Plane && self.placement.eye != DVec3::ZERO
    }

    /// Ideal less seen place, in pixels as sent; `None` where the panel is unlit.
    fn residual(&self, sent: [f64; 2], channel: usize) -> Option<[f64; 2]> {
        let seen = self.seen_from_sent * DVec3::new(sent[0], sent[1], 1.0);
        let view = &self.panel.view;
        let bent = self
            .panel
            .distortion
            .ideal(view, [seen.x, seen.y], channel)?;
        let mut ideal = DVec3::new(bent.place[0], bent.place[1], 1.0);
        if self.is_near_and_curved() {
            let rays = view.ray_from_pixel();
            let (moved, _) = self.placement.met(rays * ideal)?;
            ideal = rays.inverse() * moved;
            ideal /= ideal.z;
        }
        let back = self.sent_from_seen * ideal;
        Some([back.x - sent[0], back.y - sent[1]])
    }

    /// The coarsest grid that is good enough, or the finest.
    pub(super) fn grid(&self) -> BentGrid {
        let channels: &[usize] = match self.parts_colours() {
            true => &[0, 1, 2],
            false => &[GREEN],
        };
        let [mut cell, finest] = CELLS;
        while cell > finest && self.error(cell, channels) > MOST_ERROR {
            cell /= 2;
        }
        let [columns, rows] = self.nodes(cell);
        let mut bits = Vec::with_capacity((columns * rows) as usize * 2 * channels.len());
        for channel in channels {
            for row in 0..rows {
                for column in 0..columns {
                    let at = [column, row].map(|k| f64::from(k * cell));
                    let found = self.residual(at, *channel);
                    let found = found.map_or([UNLIT; 2], |it| it.map(|k| k as f32));
                    bits.extend(found.map(f32::to_bits));
                }
            }
        }
        BentGrid {
            cell,
            channels: channels.len() as u32,
            bits,
        }
    }

    fn nodes(&self, cell: u32) -> [u32; 2] {
        self.panel.sent_size().map(|side| side.div_ceil(cell) + 1)
    }

    /// Largest error in the middles of cells, in pixels.
    fn error(&self, cell: u32, channels: &[usize]) -> f64 {
        let [columns, rows] = self.nodes(cell).map(|count| count - 1);
        let mut worst = 0.0_f64;
        for channel in channels {
            for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |c| (row, c))) {
                let at = |x: f64, y: f64| {
                    let place = [f64::from(column) + x, f64::from(row) + y];
                    self.residual(place.map(|k| k * f64::from(cell)), *channel)
                };
                let corners = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)];
                let Some(middle) = at(0.5, 0.5) else { continue };
                let Some(corners) = corners.into_iter().collect::<Option<Vec<_>>>() else {
                    continue;
                };
                for k in 0..2 {
                    let mean = corners.iter().map(|it| it[k]).sum::<f64>() / 4.0;
                    worst = worst.max((mean - middle[k]).abs());
                }
            }
        }
        worst
    }

    fn parts_colours(&self) -> bool {
        if !self.panel.distortion.parts_colours() {
            return false;
        }
        let [columns, rows] = self.nodes(CELLS[0]);
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        places.into_iter().any(|at| {
            let at = at.map(|k| f64::from(k * CELLS[0]));
            let both = self.residual(at, 0).zip(self.residual(at, 2));
            both.is_some_and(|(red, blue)| {
                (red[0] - blue[0]).hypot(red[1] - blue[1]) > COLOURS_APART
            })
        })
    }
}
