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

/// A shader's text and its entries.
#[derive(Clone, Debug)]
pub struct Shader {
    /// Name of the pass.
    pub name: &'static str,
    /// Vertex and fragment entries of each step, in the order in which they are drawn.
    pub steps: &'static [[&'static str; 2]],
    /// WGSL.
    pub text: String,
}

/// The pass that draws the picture.
#[must_use]
pub fn reconstruct(projection: Projection) -> Shader {
    match projection {
        Projection::Flat => Shader {
            name: "reconstruct_plane",
            steps: &[
                ["cover", "reconstruct_plane_inside"],
                ["cover_rest", "reconstruct_plane"],
            ],
            text: joined(PLANE, &[COLOUR, PICTURE, RECONSTRUCT_PLANE]),
        },
        Projection::Cube => Shader {
            name: "reconstruct_cube",
            steps: &[
                ["cover", "reconstruct_cube_inside"],
                ["cover_rest", "reconstruct_cube"],
            ],
            text: joined(CUBE, &[COLOUR, PICTURE, RECONSTRUCT_CUBE]),
        },
    }
}

/// The pass that draws levels, borders and gaze over the picture.
#[must_use]
pub fn overlay(projection: Projection) -> Shader {
    let surroundings = match projection {
        Projection::Flat => PLANE,
        Projection::Cube => CUBE,
    };
    Shader {
        name: "overlay",
        steps: &[["cover", "overlay"]],
        text: joined(surroundings, &[OVERLAY]),
    }
}

fn joined(surroundings: &str, entry: &[&str]) -> String {
    let shared = [SCREEN, TILES, LATTICE, FOOTPRINT, surroundings];
    [shared.as_slice(), entry].concat().join("\n")
}
