//! How far is the ideal pixel from the pixel that is seen, where that was measured at places?

use super::lens::Bent;

/// Residuals (ideal pixel minus pixel seen) at evenly spaced places, row by row, linear between
/// them. f32 holds them to 1e-4 pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualGrid {
    /// Columns and rows of places, each at least 2.
    pub nodes: [usize; 2],
    /// Pixel of the first place.
    pub origin: [f64; 2],
    /// Pixels from place to place.
    pub step: [f64; 2],
    /// Pixels to the right and down; not a number where the panel is unlit.
    pub residuals: Vec<[f32; 2]>,
}

impl ResidualGrid {
    /// A grid over a whole panel from edge to edge, by the residual at every pixel place.
    #[must_use]
    pub fn over(
        size: [u32; 2],
        nodes: [usize; 2],
        residual: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Self {
        let nodes = nodes.map(|count| count.max(2));
        let step = [0, 1].map(|k| f64::from(size[k]) / (nodes[k] - 1) as f64);
        let all = (0..nodes[1]).flat_map(|row| (0..nodes[0]).map(move |column| [column, row]));
        let residuals = all.map(|at| {
            let place = [0, 1].map(|k| at[k] as f64 * step[k]);
            residual(place).map(|it| it as f32)
        });
        Self {
            nodes,
            origin: [0.0; 2],
            step,
            residuals: residuals.collect(),
        }
    }

    /// The ideal pixel of a place; beyond the outer places as in the nearest cell. `None` where a
    /// place round it is unlit.
    #[must_use]
    pub fn ideal(&self, place: [f64; 2]) -> Option<Bent> {
        let at = [0, 1].map(|k| (place[k] - self.origin[k]) / self.step[k]);
        let cell = [0, 1].map(|k| (at[k].max(0.0) as usize).min(self.nodes[k].saturating_sub(2)));
        let [x, y] = [0, 1].map(|k| at[k] - cell[k] as f64);
        let node = |column: usize, row: usize| {
            let index = (cell[1] + row) * self.nodes[0] + cell[0] + column;
            self.residuals.get(index).map(|it| it.map(f64::from))
        };
        let (a, b, c, d) = (node(0, 0)?, node(1, 0)?, node(0, 1)?, node(1, 1)?);
        let residual = [0, 1]
            .map(|k| (a[k] * (1.0 - x) + b[k] * x) * (1.0 - y) + (c[k] * (1.0 - x) + d[k] * x) * y);
        let across = [0, 1].map(|k| ((b[k] - a[k]) * (1.0 - y) + (d[k] - c[k]) * y) / self.step[0]);
        let down = [0, 1].map(|k| ((c[k] - a[k]) * (1.0 - x) + (d[k] - b[k]) * x) / self.step[1]);
        residual.iter().all(|it| it.is_finite()).then(|| Bent {
            place: [0, 1].map(|k| place[k] + residual[k]),
            jacobian: [[1.0 + across[0], down[0]], [across[1], 1.0 + down[1]]],
        })
    }

    /// The same of a panel with so many times the columns and rows.
    #[must_use]
    pub fn scaled(&self, scale: [f64; 2]) -> Self {
        let residuals = self.residuals.iter();
        Self {
            nodes: self.nodes,
            origin: [0, 1].map(|k| self.origin[k] * scale[k]),
            step: [0, 1].map(|k| self.step[k] * scale[k]),
            residuals: residuals
                .map(|it| [0, 1].map(|k| (f64::from(it[k]) * scale[k]) as f32))
                .collect(),
        }
    }

    /// The same in a mirror, of a panel of so many columns.
    #[must_use]
    pub fn mirrored(&self, columns: u32) -> Self {
        let last = self.origin[0] + self.step[0] * (self.nodes[0] - 1) as f64;
        let rows = self.residuals.chunks(self.nodes[0].max(1));
        let residuals = rows.flat_map(|row| row.iter().rev().map(|[x, y]| [-x, *y]));
        Self {
            origin: [f64::from(columns) - last, self.origin[1]],
            residuals: residuals.collect(),
            ..self.clone()
        }
    }
}
