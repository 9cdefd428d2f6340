//! In which ways can tiles be shown, and how do those read?

use foveal_core::view::keys::Action;
use foveal_render::{Interpolation, TileStyle};

/// What fills the pixels between samples.
pub(super) fn interpolation(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Nearest => "nearest sample",
        Interpolation::Blended => "blended samples",
    }
}

/// What tiles lie in.
pub(super) fn reconstruction(showing: TileStyle) -> &'static str {
    if showing.has_textures {
        "textures"
    } else {
        "atlas"
    }
}

/// The way to show tiles that a key goes over to, and what is said of it; another key blurs.
pub(super) fn restyled(style: TileStyle, action: Action) -> (TileStyle, &'static str) {
    let mut style = style;
    let said = match action {
        Action::Interpolation if !style.samples => {
            "policy sampled has pixels to fill between samples, this one has not"
        }
        Action::Textures if style.samples => "policy sampled shows no tiles",
        Action::Interpolation => {
            style.interpolation = match style.interpolation {
                Interpolation::Nearest => Interpolation::Blended,
                Interpolation::Blended => Interpolation::Nearest,
            };
            interpolation(style.interpolation)
        }
        Action::Textures => {
            style.has_textures = !style.has_textures;
            reconstruction(style)
        }
        _ => {
            style.blurs = !style.blurs;
            if style.blurs { "blur on" } else { "blur off" }
        }
    };
    (style, said)
}
