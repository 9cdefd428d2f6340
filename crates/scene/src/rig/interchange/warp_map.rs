//! Which way up does a map that others wrote lie, and what does it do to a panel?

use std::sync::Arc;

use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::distortion::Distortion;
use foveal_core::view::panel::residual_grid::ResidualGrid;
use foveal_core::view::panel::rig::{Panel, Scanout};

use super::super::distortion::check_folds;
use super::super::pfm::{FloatMap, by_shares};

/// Shares of an ideal panel within this are those of an even map, as single floats round them.
const EVEN: f64 = 1.2e-7;

/// What a map makes of the pixels of a panel as they are sent.
pub(super) enum WarpMap {
    /// They are those of the ideal panel.
    Even,
    /// They are elsewhere.
    Bent {
        /// As the eye sees the panel.
        grid: ResidualGrid,
        /// Whether the picture is sent left for right.
        is_mirrored: bool,
    },
}

/// Two numbers by line and column.
pub(super) type PairAt<'a> = &'a dyn Fn(usize, usize) -> [f64; 2];

impl WarpMap {
    /// Reads the map of a panel: shares of the ideal panel to the right and up. Lines come from
    /// above; from below where the picture would else be upside down.
    pub(super) fn read(map: &FloatMap<'_>, size: [u32; 2]) -> Result<Self, String> {
        Self::by_lines(size, &|line, column| map.pair(line, column))
    }

    /// The same of shares to the right and up by line and column.
    pub(super) fn by_lines(size: [u32; 2], pair: PairAt<'_>) -> Result<Self, String> {
        let rows = size[1] as usize;
        let from_above = |row: usize, column: usize| {
            let [right, up] = pair(row, column);
            [right, 1.0 - up]
        };
        let from_below = |row: usize, column: usize| from_above(rows - 1 - row, column);
        let [[right_across, right_down], [down_across, down_down]] = slopes(size, from_above);
        let is_turned_over = right_across * down_down - right_down * down_across < 0.0;
        let is_mirrored =
            is_turned_over && right_across < 0.0 && right_across.abs() > right_down.abs();
        Self::of(
            size,
            is_mirrored,
            &|row, column| match is_turned_over && !is_mirrored {
                true => from_below(row, column),
                false => from_above(row, column),
            },
        )
    }

    /// The same of lines that come from above: what turns a picture over shows left for right.
    pub(super) fn from_above(size: [u32; 2], pair: PairAt<'_>) -> Result<Self, String> {
        let share = |row: usize, column: usize| {
            let [right, up] = pair(row, column);
            [right, 1.0 - up]
        };
        let [[a, b], [c, d]] = slopes(size, share);
        Self::of(size, a * d - b * c < 0.0, &share)
    }

    /// The map of shares to the right and down of pixels as they are sent, by row and column.
    pub(super) fn of(
        size: [u32; 2],
        is_mirrored: bool,
        share: &dyn Fn(usize, usize) -> [f64; 2],
    ) -> Result<Self, String> {
        let [w, h] = size.map(|side| side as usize);
        let even = |k: usize, at: usize| (at as f64 + 0.5) / f64::from(size[k]);
        let mut pixels = (0..h).flat_map(|row| (0..w).map(move |column| (row, column)));
        let is_even = pixels.all(|(row, column)| {
            let [right, down] = share(row, column);
            (right - even(0, column)).abs() <= EVEN && (down - even(1, row)).abs() <= EVEN
        });
        if is_even {
            return Ok(Self::Even);
        }
        if w < 2 || h < 2 {
            return Err("has fewer than 2 columns or rows".to_owned());
        }
        let grid = by_shares(size, |row, column| match is_mirrored {
            true => share(row, w - 1 - column),
            false => share(row, column),
        });
        Ok(Self::Bent { grid, is_mirrored })
    }

    /// Bends a flat panel, and turns the light that its pixels keep as its picture is turned.
    pub(super) fn bend(self, panel: &mut Panel, sent: Option<AlphaMap>) -> Result<(), String> {
        let mut is_turned = false;
        if let Self::Bent { grid, is_mirrored } = self {
            let grid = Arc::new(grid);
            panel.distortion = Distortion::Grid([grid.clone(), grid.clone(), grid]);
            check_folds(&panel.distortion, &panel.view, "").map_err(|wrong| wrong.what)?;
            if is_mirrored {
                panel.scanout = Scanout::FlipX;
                is_turned = true;
            }
        }
        panel.alpha = sent.map(|alpha| match is_turned {
            true => Arc::new(alpha.mirrored()),
            false => Arc::new(alpha),
        });
        Ok(())
    }
}

/// Rows: how the share to the right, and down, changes from column to column and from row to row,
/// summed over all.
fn slopes(size: [u32; 2], share: impl Fn(usize, usize) -> [f64; 2]) -> [[f64; 2]; 2] {
    let [w, h] = size.map(|side| side as usize);
    let mut sums = [[0.0; 2]; 2];
    for (row, column) in (0..h).flat_map(|row| (0..w).map(move |column| (row, column))) {
        let own = share(row, column);
        for (k, sum) in sums.iter_mut().enumerate() {
            let to = |row: usize, column: usize| {
                let step = share(row, column)[k] - own[k];
                if step.is_finite() { step } else { 0.0 }
            };
            if column + 1 < w {
                sum[0] += to(row, column + 1);
            }
            if row + 1 < h {
                sum[1] += to(row + 1, column);
            }
        }
    }
    sums
}
