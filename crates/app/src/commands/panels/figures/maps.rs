//! What does each pixel of each panel take of the source, as pictures?

use super::super::pattern;
use super::drawn_rig::DrawnRig;
use super::legend::Legend;
use crate::report::colour_ramp::fire;
use foveal_core::view::panel::footprint::{MOST_PROBES, Probes};
use foveal_core::view::panel::rig::Panel;
use foveal_render::RgbaImage;
use foveal_render::twin::{self, TwinSource};
use foveal_render::warp::{PanelOnSource, WarpFilter, WarpPlan, WarpStyle};

/// Columns and rows of a panel in a figure, at most; pixels between panels; most in a row.
const SIDE: u32 = 320;
const GAP: u32 = 8;
const IN_A_ROW: usize = 4;
/// Columns and rows of the source of a filter's figure, at most.
const MOST_SOURCE: u32 = 4096;
/// Lines across the longer side of the source in the picture of the grid, how wide one is of the
/// way to the next, and the colours of the middle, of every eighth, of others, and between.
const LINES: f64 = 48.0;
const LINE_WIDTH: f64 = 0.14;
const GRID_COLOURS: [[f64; 3]; 4] = [
    [255.0, 60.0, 40.0],
    [255.0, 220.0, 60.0],
    [235.0; 3],
    [24.0; 3],
];
/// Between panels, and where nothing is lit.
const GROUND: [u8; 4] = [255, 255, 255, 255];
const UNLIT: [u8; 4] = [0, 0, 0, 255];

/// All panels as the eye sees them, row by row, coloured by the place of each.
fn sheet<'a>(
    panels: &[&'a Panel],
    colour: impl Fn(&'a Panel, [f64; 2], f64) -> [u8; 4],
) -> RgbaImage {
    let sizes: Vec<[u32; 2]> = panels.iter().map(|it| shown_size(it)).collect();
    let columns = panels.len().min(IN_A_ROW);
    let rows = panels.len().div_ceil(columns.max(1));
    let most = |k: usize| sizes.iter().map(|it| it[k]).max().unwrap_or(1);
    let cell = [most(0) + GAP, most(1) + GAP];
    let size = [cell[0] * columns as u32 + GAP, cell[1] * rows as u32 + GAP];
    let mut image = RgbaImage::black(size);
    for at in pixels(size) {
        image.set_pixel(at, GROUND);
    }
    for (k, (panel, own)) in panels.iter().zip(&sizes).enumerate() {
        let cell_at = [(k % columns) as u32, (k / columns) as u32];
        let origin = [0, 1].map(|k| GAP + cell_at[k] * cell[k]);
        let step = f64::from(panel.view.size[0]) / f64::from(own[0]);
        for at in pixels(*own) {
            let place = at.map(|it| (f64::from(it) + 0.5) * step);
            let at = [0, 1].map(|k| at[k] + origin[k]);
            image.set_pixel(at, colour(panel, place, step));
        }
    }
    image
}

fn pixels([columns, rows]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]))
}

fn shown_size(panel: &Panel) -> [u32; 2] {
    let [w, h] = panel.view.size.map(f64::from);
    let scale = (f64::from(SIDE) / w.max(h)).min(1.0);
    [w, h].map(|side| ((side * scale) as u32).max(1))
}

/// A grid as each panel shows it: light lines on dark, every eighth yellow, those through the
/// middle red. What of a line lies within a pixel is computed, so that close lines fade to grey.
pub(super) fn grid(rig: &DrawnRig<'_>) -> RgbaImage {
    let size = rig.found.size.map(f64::from);
    // As many lines whatever the size.
    let pitch = size[0].max(size[1]) / LINES;
    sheet(rig.panels, |panel, place, step| {
        let Some(seen) = rig.map_of(panel).at(place) else {
            return UNLIT;
        };
        if !(0..2).all(|k| (0.0..=size[k]).contains(&seen.place[k])) {
            return UNLIT;
        }
        let axes = [0, 1].map(|k| {
            let [x, y] = seen.jacobian[k];
            let width = x.hypot(y) * step / pitch;
            lines_within((seen.place[k] - size[k] / 2.0) / pitch, width)
        });
        // Shares that are not red; neither red nor yellow; on no line.
        let without = [0, 1, 2].map(|k| (1.0 - axes[0][k]) * (1.0 - axes[1][k]));
        let shares = [
            1.0 - without[0],
            without[0] - without[1],
            without[1] - without[2],
            without[2],
        ];
        let mixed = [0, 1, 2].map(|k| {
            let parts = shares.iter().zip(GRID_COLOURS);
            parts.map(|(share, colour)| share * colour[k]).sum::<f64>()
        });
        let [r, g, b] = mixed.map(|it| it.round() as u8);
        [r, g, b, 255]
    })
}

/// Shares of a stretch about a place, one wide at least a little, that lie on line 0, on every
/// eighth, and on any; lines stand at whole numbers.
fn lines_within(middle: f64, width: f64) -> [f64; 3] {
    let width = width.max(1e-6);
    let (low, high) = (middle - width / 2.0, middle + width / 2.0);
    let first = (high.min(LINE_WIDTH / 2.0) - low.max(-LINE_WIDTH / 2.0)).max(0.0);
    let every = |period: f64| {
        // Of all lines below a place, how much.
        let below = |at: f64| {
            let at = at + LINE_WIDTH / 2.0;
            let number = (at / period).floor();
            number * LINE_WIDTH + (at - number * period).min(LINE_WIDTH)
        };
        below(high) - below(low)
    };
    [first, every(8.0), every(1.0)].map(|it| (it / width).clamp(0.0, 1.0))
}

/// By how much the source is magnified: black where it has two pixels or more for each along the
/// most magnified way, brighter up to eight times magnified.
pub(super) fn magnification(rig: &DrawnRig<'_>) -> RgbaImage {
    let colour = |share: f64| {
        let [r, g, b] = fire(share as f32);
        [r, g, b, 255]
    };
    let drawn = sheet(rig.panels, |panel, place, _| {
        let Some(seen) = rig.map_of(panel).at(place) else {
            return UNLIT;
        };
        let [_, least] = seen.sigma();
        colour((1.0 - least.log2()) / 4.0)
    });
    let legend = Legend {
        caption: "MAGNIFICATION",
        ticks: &[
            ("0.5", 0.0),
            ("1", 0.25),
            ("2", 0.5),
            ("4", 0.75),
            ("8", 1.0),
        ],
        colour: &colour,
    };
    legend.below(&drawn)
}

/// How many of Feline's samples a pixel takes: grey for one, brighter for more.
pub(super) fn probes(rig: &DrawnRig<'_>) -> RgbaImage {
    let [w, h] = rig.found.size;
    let last = f64::from(w.max(h)).log2();
    let colour = |count: u32| match count {
        0 | 1 => [96, 96, 96, 255],
        count => {
            let [r, g, b] = fire(0.35 + 0.65 * (f64::from(count).log2() / 4.0) as f32);
            [r, g, b, 255]
        }
    };
    let drawn = sheet(rig.panels, |panel, place, _| {
        let Some(seen) = rig.map_of(panel).at(place) else {
            return UNLIT;
        };
        colour(Probes::of(seen.jacobian, MOST_PROBES, last).count)
    });
    let legend = Legend {
        caption: "SAMPLES OF FELINE",
        ticks: &[
            ("1", 0.0),
            ("2", 0.25),
            ("4", 0.5),
            ("8", 0.75),
            ("16", 1.0),
        ],
        colour: &|share| colour((4.0 * share).exp2().round() as u32),
    };
    legend.below(&drawn)
}

/// The most stretched panel's grid, by trilinear filtering on the left and by Feline on the right.
pub(super) fn filters(rig: &DrawnRig<'_>) -> RgbaImage {
    let stretch = |index: &usize| {
        let fit = &rig.found.panels[*index];
        fit.sigma_max / fit.sigma_min
    };
    let all = 0..rig.panels.len();
    let most = all.max_by(|a, b| stretch(a).total_cmp(&stretch(b)));
    let panel = rig.panels[most.unwrap_or(0)];
    let size = rig.found.size;
    let scale = (f64::from(MOST_SOURCE) / f64::from(size[0].max(size[1]))).min(1.0);
    let size = size.map(|side| ((f64::from(side) * scale) as u32).max(1));
    let plan = WarpPlan::new(&[PanelOnSource {
        panel,
        placement: &rig.found.placement,
        part: [0, 0, size[0], size[1]],
        origin: [0; 2],
    }]);
    let source = TwinSource::new(&pattern::grid(size), true);
    let drawn = [WarpFilter::Trilinear, WarpFilter::Feline].map(|filter| {
        let style = WarpStyle {
            filter,
            paints: false,
        };
        twin::warp(&source, &plan, &style)
    });
    let [w, h] = drawn[0].size;
    let mut image = RgbaImage::black([2 * w + GAP, h]);
    for at in pixels(image.size) {
        let [x, y] = at;
        image.set_pixel(
            at,
            match () {
                () if x < w => drawn[0].pixel(at),
                () if x < w + GAP => GROUND,
                () => drawn[1].pixel([x - w - GAP, y]),
            },
        );
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_on_a_line_is_that_line_and_one_over_many_is_their_mean() {
        for (middle, expected) in [
            (0.0, [1.0, 1.0, 1.0]),
            (8.0, [0.0, 1.0, 1.0]),
            (-3.0, [0.0, 0.0, 1.0]),
            (0.5, [0.0; 3]),
        ] {
            let found = lines_within(middle, 0.1);
            let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-12, "{middle}: {found:?}");
        }
        let [_, eighth, any] = lines_within(2.345, 800.0);
        assert!((any - LINE_WIDTH).abs() < 1e-9 && (eighth - LINE_WIDTH / 8.0).abs() < 1e-9);
    }
}
