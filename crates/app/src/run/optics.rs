//! What does an eye see of a panel through its optics, by a flat picture of all that they show?

use foveal_core::view::panel::rig::{Panel, Scanout};
use foveal_render::warp::PanelOptics;

/// Pixels of the pictures that are resampled between what is drawn and what these panels show:
/// of bent ones the flat view in which everything lies that they show.
pub(crate) fn intermediate_pixels(panels: &[Panel]) -> u64 {
    let bent = panels.iter().filter(|panel| !panel.distortion.is_none());
    let pixels = |panel: &Panel| panel.reach().size.map(u64::from).iter().product::<u64>();
    bent.map(pixels).sum()
}

/// What makes the pictures that an eye sees on panels, whichever way they are sent.
pub(crate) fn as_seen(panels: &[Panel]) -> PanelOptics {
    let upright = panels.iter().map(|panel| Panel {
        scanout: Scanout::Normal,
        ..panel.clone()
    });
    PanelOptics::new(&upright.collect::<Vec<_>>())
}
