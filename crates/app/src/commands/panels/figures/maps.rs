//! What does each pixel of each panel take of the source, as pictures?

use super::super::pattern;
use super::drawn_rig::DrawnRig;
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
/// Samples along a pixel's side in the picture of the grid.
const SAMPLES: u32 = 3;
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

/// A grid as each panel shows it.
pub(super) fn grid(rig: &DrawnRig<'_>) -> RgbaImage {
    let size = rig.found.size;
    // As many lines whatever the size.
    let scale = 1600.0 / f64::from(size[0]);
    let picture = pattern::grid(size.map(|side| (f64::from(side) * scale).ceil().max(1.0) as u32));
    sheet(rig.panels, |panel, place, step| {
        let mut sum = [0_u32; 3];
        for sample in pixels([SAMPLES; 2]) {
            let off = sample.map(|k| (f64::from(k) + 0.5) / f64::from(SAMPLES) - 0.5);
            let place = [0, 1].map(|k| place[k] + off[k] * step);
            let Some(seen) = rig.map_of(panel).at(place) else {
                continue;
            };
            let at = seen.place.map(|it| it * scale);
            if (0..2).all(|k| at[k] >= 0.0 && at[k] < f64::from(picture.size[k])) {
                let pixel = picture.pixel(at.map(|it| it as u32));
                for (sum, own) in sum.iter_mut().zip(pixel) {
                    *sum += u32::from(own);
                }
            }
        }
        let [r, g, b] = sum.map(|it| (it / (SAMPLES * SAMPLES)) as u8);
        [r, g, b, 255]
    })
}

/// By how much the source is magnified: black where it has two pixels or more for each along the
/// most magnified way, brighter up to eight times magnified.
pub(super) fn magnification(rig: &DrawnRig<'_>) -> RgbaImage {
    sheet(rig.panels, |panel, place, _| {
        let Some(seen) = rig.map_of(panel).at(place) else {
            return UNLIT;
        };
        let [_, least] = seen.sigma();
        let [r, g, b] = fire(((1.0 - least.log2()) / 4.0) as f32);
        [r, g, b, 255]
    })
}

/// How many of Feline's samples a pixel takes: grey for one, brighter for more.
pub(super) fn probes(rig: &DrawnRig<'_>) -> RgbaImage {
    let [w, h] = rig.found.size;
    let last = f64::from(w.max(h)).log2();
    sheet(rig.panels, |panel, place, _| {
        let Some(seen) = rig.map_of(panel).at(place) else {
            return UNLIT;
        };
        match Probes::of(seen.jacobian, MOST_PROBES, last).count {
            0 | 1 => [96, 96, 96, 255],
            count => {
                let [r, g, b] = fire(0.35 + 0.65 * (f64::from(count).log2() / 4.0) as f32);
                [r, g, b, 255]
            }
        }
    })
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
