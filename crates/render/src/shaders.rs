//! Which text makes each shader?
//!
//! Files are joined in the order in which they need each other; there is no preprocessor.

use foveal_core::view::surface::Projection;

const SCREEN: &str = include_str!("../shaders/shared/screen.wgsl");
const COVER: &str = include_str!("../shaders/shared/cover.wgsl");
const TILES: &str = include_str!("../shaders/shared/tiles.wgsl");
const COLOUR: &str = include_str!("../shaders/shared/colour.wgsl");
const MAPPING: &str = include_str!("../shaders/shared/mapping.wgsl");
const LATTICE: &str = include_str!("../shaders/shared/lattice.wgsl");
const WIDENED: &str = include_str!("../shaders/shared/widened.wgsl");
const FOOTPRINT: &str = include_str!("../shaders/shared/footprint.wgsl");
const RAMP: &str = include_str!("../shaders/shared/ramp.wgsl");
const PAGES: &str = include_str!("../shaders/shared/pages.wgsl");
const SCENE: &str = include_str!("../shaders/shared/scene.wgsl");
const PICTURE: &str = include_str!("../shaders/shared/picture.wgsl");
const PLANE: &str = include_str!("../shaders/shared/plane.wgsl");
const CUBE: &str = include_str!("../shaders/shared/cube.wgsl");
const EQUIRECT: &str = include_str!("../shaders/shared/equirect.wgsl");
const RECONSTRUCT_PLANE: &str = include_str!("../shaders/reconstruct_plane.wgsl");
const RECONSTRUCT_CUBE: &str = include_str!("../shaders/reconstruct_cube.wgsl");
const RECONSTRUCT_EQUIRECT: &str = include_str!("../shaders/reconstruct_equirect.wgsl");
const OVERLAY: &str = include_str!("../shaders/overlay.wgsl");
const INTERPOLATE_SPARSE: &str = include_str!("../shaders/interpolate_sparse.wgsl");
const BLUR_HALVE: &str = include_str!("../shaders/blur_halve.wgsl");
const BLUR_RADIAL: &str = include_str!("../shaders/blur_radial.wgsl");
const RECONSTRUCT_TEXTURES: &str = include_str!("../shaders/reconstruct_textures.wgsl");
const CULL_CLUSTERS: &str = include_str!("../shaders/cull_clusters.wgsl");
const DEPTHS: &str = include_str!("../shaders/shared/depths.wgsl");
const HALVE_TILES: &str = include_str!("../shaders/halve_tiles.wgsl");
const HALVE_DEPTHS: &str = include_str!("../shaders/halve_depths.wgsl");
const MARK_UNITS: &str = include_str!("../shaders/mark_units.wgsl");
const FOOTPRINTS: &str = include_str!("../shaders/footprints.wgsl");
const DRAW_CLUSTERS: &str = include_str!("../shaders/draw_clusters.wgsl");
const BAND: &str = include_str!("../shaders/shared/band.wgsl");
const DOUBLED: &str = include_str!("../shaders/shared/doubled.wgsl");
const EYE: &str = include_str!("../shaders/shared/eye.wgsl");
const LUMINANCE: &str = include_str!("../shaders/luminance.wgsl");
const HALVE: &str = include_str!("../shaders/halve.wgsl");
const CONTRAST: &str = include_str!("../shaders/contrast.wgsl");
const SEEN: &str = include_str!("../shaders/seen.wgsl");
const GAIN: &str = include_str!("../shaders/gain.wgsl");
const FADING: &str = include_str!("../shaders/shared/fading.wgsl");
const FILTERS: &str = include_str!("../shaders/shared/filters.wgsl");
const PROJECTED: &str = include_str!("../shaders/shared/projected.wgsl");
const WARP: &str = include_str!("../shaders/warp.wgsl");
const REDUCE_SOURCE: &str = include_str!("../shaders/reduce_source.wgsl");
const ACCUMULATE: &str = include_str!("../shaders/accumulate.wgsl");

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
        Projection::Equirect => Shader {
            name: "reconstruct_equirect",
            steps: &[
                ["cover", "reconstruct_equirect_inside"],
                ["cover_rest", "reconstruct_equirect"],
            ],
            text: joined(EQUIRECT, &[COLOUR, PICTURE, RECONSTRUCT_EQUIRECT]),
        },
    }
}

/// The pass that draws levels, borders and gaze over the picture.
#[must_use]
pub fn overlay(projection: Projection) -> Shader {
    Shader {
        name: "overlay",
        steps: &[["cover", "overlay"]],
        text: joined(surroundings(projection), &[RAMP, OVERLAY]),
    }
}

/// The pass that draws samples round the gaze over the resident tiles.
#[must_use]
pub fn interpolate_sparse(projection: Projection) -> Shader {
    Shader {
        name: "interpolate_sparse",
        steps: &[["cover", "interpolate_sparse"]],
        text: joined(
            surroundings(projection),
            &[COLOUR, PICTURE, INTERPOLATE_SPARSE],
        ),
    }
}

/// The pass that draws from a texture for every level.
#[must_use]
pub fn reconstruct_textures(projection: Projection) -> Shader {
    Shader {
        name: "reconstruct_textures",
        steps: &[["cover", "reconstruct_textures"]],
        text: joined(surroundings(projection), &[COLOUR, RECONSTRUCT_TEXTURES]),
    }
}

/// The pass that averages tiles to the spacing of a coarser level.
#[must_use]
pub fn halve_tiles() -> Shader {
    Shader {
        name: "halve_tiles",
        steps: &[["place_tile", "halve_tiles"]],
        text: HALVE_TILES.to_owned(),
    }
}

/// The pass that halves a picture.
#[must_use]
pub fn blur_halve() -> Shader {
    Shader {
        name: "blur_halve",
        steps: &[["cover", "blur_halve"]],
        text: [COVER, BLUR_HALVE].join("\n"),
    }
}

/// The pass that blurs a picture outside the fovea.
#[must_use]
pub fn blur_radial() -> Shader {
    Shader {
        name: "blur_radial",
        steps: &[["cover", "blur_radial"]],
        text: [COVER, BLUR_RADIAL].join("\n"),
    }
}

/// The pass that fills the panels of an atlas from one source.
#[must_use]
pub fn warp() -> Shader {
    Shader {
        name: "warp",
        steps: &[["place_panel", "warp"]],
        text: [FADING, FILTERS, PROJECTED, WARP].join("\n"),
    }
}

/// The pass that makes a coarser level of a source.
#[must_use]
pub fn reduce_source() -> Shader {
    Shader {
        name: "reduce_source",
        steps: &[["cover", "reduce_source"]],
        text: [COVER, REDUCE_SOURCE].join("\n"),
    }
}

/// A pass that draws a kind of a scene's units: its own texts behind those that all read.
#[must_use]
pub fn of_units(name: &'static str, steps: &'static [[&'static str; 2]], texts: &[&str]) -> Shader {
    Shader {
        name,
        steps,
        text: [&[SCENE, RAMP], texts].concat().join("\n"),
    }
}

/// The pass that draws clusters of meshes: their colours, or which units would refine them.
#[must_use]
pub fn draw_clusters() -> Shader {
    let steps = &[
        ["place_corner", "draw_clusters"],
        ["place_corner", "draw_refiners"],
    ];
    of_units("draw_clusters", steps, &[PAGES, DRAW_CLUSTERS])
}

/// The pass that paints what units are worth over what they would refine.
#[must_use]
pub fn mark_units() -> Shader {
    Shader {
        name: "mark_units",
        steps: &[["cover", "mark_units"]],
        text: [COVER, RAMP, MARK_UNITS].join("\n"),
    }
}

/// The pass that finds the clusters of meshes that can be seen.
#[must_use]
pub fn cull_clusters() -> ComputeShader {
    ComputeShader {
        name: "cull_clusters",
        text: [SCENE, DEPTHS, CULL_CLUSTERS].join("\n"),
    }
}

/// The passes that make a coarser level of depths: of those of a picture, and of the level before.
#[must_use]
pub fn halve_depths() -> [ComputeShader; 2] {
    ["first_depths", "halve_depths"].map(|name| ComputeShader {
        name,
        text: [DEPTHS, HALVE_DEPTHS].join("\n"),
    })
}

/// The pass that adds up how much of a view each unit of a scene would refine.
#[must_use]
pub fn footprints() -> ComputeShader {
    ComputeShader {
        name: "footprints",
        text: FOOTPRINTS.to_owned(),
    }
}

fn surroundings(projection: Projection) -> &'static str {
    match projection {
        Projection::Flat => PLANE,
        Projection::Cube => CUBE,
        Projection::Equirect => EQUIRECT,
    }
}

fn joined(surroundings: &str, entry: &[&str]) -> String {
    let shared = [
        COVER,
        SCREEN,
        TILES,
        MAPPING,
        LATTICE,
        WIDENED,
        FOOTPRINT,
        surroundings,
    ];
    [shared.as_slice(), entry].concat().join("\n")
}

/// A compute pass's text; its entry has the name of the pass.
#[derive(Clone, Debug)]
pub struct ComputeShader {
    /// Name of the pass.
    pub name: &'static str,
    /// WGSL.
    pub text: String,
}

/// The passes of [`crate::importance`], in their order.
#[must_use]
pub fn importance() -> [ComputeShader; 6] {
    let shader = |name, parts: &[&str]| ComputeShader {
        name,
        text: parts.join("\n"),
    };
    [
        shader("luminance", &[BAND, LUMINANCE]),
        shader("halve", &[BAND, HALVE]),
        shader("contrast", &[BAND, DOUBLED, CONTRAST]),
        shader("seen", &[BAND, EYE, SEEN]),
        shader("gain", &[BAND, DOUBLED, EYE, GAIN]),
        shader("accumulate", &[BAND, EYE, ACCUMULATE]),
    ]
}
