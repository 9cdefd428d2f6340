//! Which text makes each shader?
//!
//! Files are joined in the order in which they need each other; there is no preprocessor.

use foveal_core::view::surface::Projection;

const SCREEN: &str = include_str!("../shaders/shared/screen.wgsl");
const TILES: &str = include_str!("../shaders/shared/tiles.wgsl");
const COLOUR: &str = include_str!("../shaders/shared/colour.wgsl");
const LATTICE: &str = include_str!("../shaders/shared/lattice.wgsl");
const FOOTPRINT: &str = include_str!("../shaders/shared/footprint.wgsl");
const PICTURE: &str = include_str!("../shaders/shared/picture.wgsl");
const PLANE: &str = include_str!("../shaders/shared/plane.wgsl");
const CUBE: &str = include_str!("../shaders/shared/cube.wgsl");
const RECONSTRUCT_PLANE: &str = include_str!("../shaders/reconstruct_plane.wgsl");
const RECONSTRUCT_CUBE: &str = include_str!("../shaders/reconstruct_cube.wgsl");
const OVERLAY: &str = include_str!("../shaders/overlay.wgsl");

/// A shader's text and the name of its fragment entry; the vertex entry of all is `cover`.
#[derive(Clone, Debug)]
pub struct Shader {
    /// Name of the pass and of the fragment entry.
    pub name: &'static str,
    /// WGSL.
    pub text: String,
}

/// The pass that draws the picture.
#[must_use]
pub fn reconstruct(projection: Projection) -> Shader {
    match projection {
        Projection::Flat => joined(
            "reconstruct_plane",
            PLANE,
            &[COLOUR, PICTURE, RECONSTRUCT_PLANE],
        ),
        Projection::Cube => joined(
            "reconstruct_cube",
            CUBE,
            &[COLOUR, PICTURE, RECONSTRUCT_CUBE],
        ),
    }
}

/// The pass that draws levels, borders and gaze over the picture.
#[must_use]
pub fn overlay(projection: Projection) -> Shader {
    let surroundings = match projection {
        Projection::Flat => PLANE,
        Projection::Cube => CUBE,
    };
    joined("overlay", surroundings, &[OVERLAY])
}

fn joined(name: &'static str, surroundings: &str, entry: &[&str]) -> Shader {
    let shared = [SCREEN, TILES, LATTICE, FOOTPRINT, surroundings];
    Shader {
        name,
        text: [shared.as_slice(), entry].concat().join("\n"),
    }
}
