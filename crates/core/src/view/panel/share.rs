//! How much of a source do panels see, and where do pixels take more than one probe of it?

use super::footprint::Probes;
use super::pixel_map::PixelMap;
use super::placement::Placement;
use super::placing::samples::PanelSamples;
use super::rig::Panel;

/// Most columns and rows that are tried of a source.
const MOST_TRIED: u32 = 1024;

/// Share of a source of `size` pixels that some panel sees, by its pixels' centres.
#[must_use]
pub fn seen_share(panels: &[&Panel], placement: &Placement, size: [u32; 2]) -> f64 {
    let tried = size.map(|side| side.min(MOST_TRIED));
    let panels: Vec<PanelSamples<'_>> = panels.iter().map(|it| PanelSamples::of(it, 1)).collect();
    let mut seen = 0_u64;
    for row in 0..tried[1] {
        for column in 0..tried[0] {
            let place = [column, row].map(|it| f64::from(it) + 0.5);
            let ray = placement.ray_from_source(place, tried);
            let is_seen = ray.is_some_and(|ray| panels.iter().any(|panel| panel.sees(ray)));
            seen += u64::from(is_seen);
        }
    }
    seen as f64 / (f64::from(tried[0]) * f64::from(tried[1]))
}

/// The part of a source that panels see, from edge to edge: left, right, top and bottom, as shares
/// of it from its upper left.
///
/// Some of a picture that keeps its aspect may lie outside all panels.
#[must_use]
pub fn seen_part(panels: &[&Panel], placement: &Placement) -> [f64; 4] {
    let (mut low, mut high) = ([1.0_f64; 2], [0.0_f64; 2]);
    let rays = panels.iter().flat_map(|it| PanelSamples::of(it, 1).rim);
    for place in rays.filter_map(|ray| placement.source_from_ray(ray, [1, 1])) {
        for k in 0..2 {
            low[k] = low[k].min(place[k].max(0.0));
            high[k] = high[k].max(place[k].min(1.0));
        }
    }
    [low[0], high[0], low[1], high[1]]
}

/// Share of all pixels of panels for which Feline takes more than one probe of a source of `size`
/// pixels, at most `most` of each.
#[must_use]
pub fn multi_probe_share(
    panels: &[&Panel],
    placement: &Placement,
    size: [u32; 2],
    most: u32,
) -> f64 {
    let last = libm::log2(f64::from(size[0].max(size[1]).max(1)));
    let (mut several, mut all) = (0_u64, 0_u64);
    for &panel in panels {
        let map = PixelMap {
            panel,
            placement,
            size,
        };
        let [columns, rows] = panel.view.size;
        for pixel in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
            let probes = map
                .of_pixel(pixel)
                .map(|it| Probes::of(it.jacobian, most, last));
            several += u64::from(probes.is_some_and(|it| it.count > 1));
            all += 1;
        }
    }
    several as f64 / all.max(1) as f64
}
