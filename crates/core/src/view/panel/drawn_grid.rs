//! By which grid of residuals is a bent panel drawn, and how far is that from its optics?

use super::distortion::GREEN;
use super::pixel_map::PixelMap;
use super::placement::{Placement, SourceProjection};
use super::residual_grid::ResidualGrid;
use super::rig::Panel;
use core::f64::consts::TAU;
use glam::{DMat3, DVec3};

/// Most pixels from one node to the next, and fewest.
const CELLS: [u32; 2] = [32, 4];
/// Pixels by which a grid may be wrong in the middle of a cell before a finer one is taken.
const MOST_ERROR: f64 = 1.0 / 64.0;
/// Grids of more nodes get no finer.
const MANY_NODES: usize = 1 << 18;
/// Pixels between the places of red and blue from which on colours are drawn one by one.
const COLOURS_APART: f64 = 0.25;

/// Residuals of a panel in pixels as they are sent.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnGrid {
    /// Pixels from node to node.
    pub cell: u32,
    /// One grid, or three of red, green and blue. The last nodes may lie beyond the panel.
    pub channels: Vec<ResidualGrid>,
}

impl DrawnGrid {
    /// The coarsest grid that is good enough, or the finest; `None` where pixels look straight
    /// ahead, as on most panels.
    #[must_use]
    pub fn of(panel: &Panel, placement: &Placement) -> Option<Self> {
        let bend = Bend::of(panel, placement)?;
        let channels = bend.channels();
        let [mut cell, finest] = CELLS;
        while cell > finest && !bend.is_good(cell, channels) {
            cell /= 2;
        }
        Some(Self {
            cell,
            channels: channels.iter().map(|it| bend.grid(cell, *it)).collect(),
        })
    }

    /// How far what is drawn by it is from where pixels look, at most, in source pixels: at nodes,
    /// in the middles of cells and of their edges.
    #[must_use]
    pub fn error(&self, panel: &Panel, placement: &Placement, size: [u32; 2]) -> f64 {
        let colours: &[usize] = match self.channels.len() {
            1 => &[GREEN],
            _ => &[0, 1, 2],
        };
        let bend = Bend::new(panel, placement);
        let all = self.channels.iter().zip(colours);
        let errors = all.flat_map(|(grid, channel)| {
            let halves = |k: usize| {
                let end = f64::from(panel.sent_size()[k]);
                let step = f64::from(self.cell) / 2.0;
                (0..2 * grid.nodes[k]).map(move |n| (n as f64 * step).min(end))
            };
            let (columns, bend) = (halves(0), &bend);
            halves(1).flat_map(move |y| {
                let row = columns.clone();
                row.filter_map(move |x| bend.off(grid, [x, y], *channel, size))
            })
        });
        errors.fold(0.0, f64::max)
    }
}

/// What a panel as it is sent does to its pixels before it looks at a source.
struct Bend<'a> {
    panel: &'a Panel,
    placement: &'a Placement,
    seen_from_sent: DMat3,
    sent_from_seen: DMat3,
}

impl<'a> Bend<'a> {
    fn new(panel: &'a Panel, placement: &'a Placement) -> Self {
        let seen_from_sent = panel.scanout.seen_from_sent(panel.view.size);
        Self {
            panel,
            placement,
            seen_from_sent,
            sent_from_seen: seen_from_sent.inverse(),
        }
    }

    fn of(panel: &'a Panel, placement: &'a Placement) -> Option<Self> {
        let bend = Self::new(panel, placement);
        (!panel.distortion.is_none() || bend.is_near_and_curved()).then_some(bend)
    }

    /// Seen from off its middle, a curved source is not where a straight ray goes.
    fn is_near_and_curved(&self) -> bool {
        self.placement.projection != SourceProjection::Plane && self.placement.eye != DVec3::ZERO
    }

    fn seen(&self, sent: [f64; 2]) -> [f64; 2] {
        let seen = self.seen_from_sent * DVec3::new(sent[0], sent[1], 1.0);
        [seen.x, seen.y]
    }

    /// Ideal less seen place, in pixels as sent; `None` where the panel is unlit.
    fn residual(&self, sent: [f64; 2], channel: usize) -> Option<[f64; 2]> {
        let view = &self.panel.view;
        let distortion = &self.panel.distortion;
        let bent = distortion.ideal(view, self.seen(sent), channel)?;
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

    fn nodes(&self, cell: u32) -> [usize; 2] {
        let sent = self.panel.sent_size();
        sent.map(|side| side.div_ceil(cell) as usize + 1)
    }

    fn grid(&self, cell: u32, channel: usize) -> ResidualGrid {
        let nodes = self.nodes(cell);
        let all = (0..nodes[1]).flat_map(|row| (0..nodes[0]).map(move |column| [column, row]));
        let residuals = all.map(|at| {
            let found = self.residual(at.map(|k| k as f64 * f64::from(cell)), channel);
            found.map_or([f32::NAN; 2], |it| it.map(|k| k as f32))
        });
        ResidualGrid {
            nodes,
            origin: [0.0; 2],
            step: [f64::from(cell); 2],
            residuals: residuals.collect(),
        }
    }

    /// Whether a grid needs to be no finer, or would be too large.
    fn is_good(&self, cell: u32, channels: &[usize]) -> bool {
        let [columns, rows] = self.nodes(cell);
        columns * rows > MANY_NODES
            || channels
                .iter()
                .all(|it| self.misses(cell, *it) <= MOST_ERROR)
    }

    /// Largest error in the middles of cells, in pixels; without bound where a cell is lit in part,
    /// as all of it is then drawn unlit.
    fn misses(&self, cell: u32, channel: usize) -> f64 {
        let [columns, rows] = self.nodes(cell).map(|count| count - 1);
        let mut worst = 0.0_f64;
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |c| (row, c))) {
            let at = |[x, y]: [f64; 2]| {
                let place = [column as f64 + x, row as f64 + y];
                self.residual(place.map(|k| k * f64::from(cell)), channel)
            };
            let places = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
            let found = places.map(at);
            if found.iter().all(Option::is_none) {
                continue;
            }
            let [Some(middle), Some(a), Some(b), Some(c), Some(d)] = found else {
                return f64::INFINITY;
            };
            for k in 0..2 {
                let mean = (a[k] + b[k] + c[k] + d[k]) / 4.0;
                worst = worst.max((mean - middle[k]).abs());
            }
        }
        worst
    }

    /// Green, or all colours where they part.
    fn channels(&self) -> &'static [usize] {
        if !self.panel.distortion.parts_colours() {
            return &[GREEN];
        }
        let step = CELLS[0];
        let [columns, rows] = self.nodes(step);
        let mut places = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let part = places.any(|at| {
            let at = at.map(|k| k as f64 * f64::from(step));
            let both = self.residual(at, 0).zip(self.residual(at, 2));
            both.is_some_and(|(red, blue)| {
                let [x, y] = [0, 1].map(|k| red[k] - blue[k]);
                x * x + y * y > COLOURS_APART * COLOURS_APART
            })
        });
        match part {
            true => &[0, 1, 2],
            false => &[GREEN],
        }
    }

    /// Source pixels between where a grid leads from a place as sent and where that looks; `None`
    /// where either is unlit.
    fn off(
        &self,
        grid: &ResidualGrid,
        sent: [f64; 2],
        channel: usize,
        size: [u32; 2],
    ) -> Option<f64> {
        let map = PixelMap {
            panel: self.panel,
            placement: self.placement,
            size,
        };
        let true_place = map.of_channel(self.seen(sent), channel)?.place;
        let [x, y] = self.seen(grid.ideal(sent)?.place);
        let ray = self.panel.view.ray_from_pixel() * DVec3::new(x, y, 1.0);
        // The grid of a near and curved source has moved the eye to the middle already.
        let told = match self.is_near_and_curved() {
            true => Placement {
                eye: DVec3::ZERO,
                ..*self.placement
            },
            false => *self.placement,
        };
        let told = told.source_from_ray(ray, size)?;
        let [mut across, down] = [0, 1].map(|k| (told[k] - true_place[k]).abs());
        if self.placement.projection != SourceProjection::Plane {
            // Behind, azimuths begin again.
            let round = TAU / self.placement.extent()[0] * f64::from(size[0]);
            across = across.min((round - across).abs());
        }
        Some((across * across + down * down).sqrt())
    }
}
