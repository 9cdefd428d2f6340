//! Which numbers do the shaders and their twins need to find a sample?
//!
//! The structs here have the layout of the WGSL structs of the same name; `tests/shaders.rs`
//! compares them.

use crate::atlas_shape::AtlasShape;
use bytemuck::{Pod, Zeroable};
use foveal_core::asset::picture::Colour;
use foveal_core::asset::tile_grid::{Cut, TileGrid};
use foveal_core::view::eye_view::EyeView;

/// What stays the same from frame to frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct TileParams {
    /// Level-0 pixels of a face.
    pub size: [f32; 2],
    /// Level-0 pixels over which the samples of a level are evenly spaced: a face of a pyramid, a
    /// cell of a grid.
    pub segment: [f32; 2],
    /// Level-0 pixels of a cell.
    pub cell: [f32; 2],
    /// Level-0 pixels under a tile of the coarsest level.
    pub base_span: [f32; 2],
    /// Columns and rows of cells on a face.
    pub cells: [u32; 2],
    /// Columns and rows of segments on a face.
    pub segments: [u32; 2],
    /// Pixels from one tile of the coarsest level to the next in the atlas.
    pub base_step: [u32; 2],
    /// Pixels from one face of the coarsest level to the next in the atlas.
    pub base_face: [u32; 2],
    /// Faces of the coarsest level in a layer of the atlas, columns and rows.
    pub base_across: [u32; 2],
    /// Pixels of a slot of the atlas.
    pub slot: [u32; 2],
    /// Index of the coarsest level.
    pub coarsest: u32,
    /// Octaves between neighbouring levels: 1 or 2.
    pub octaves: u32,
    /// Octaves by which a tile covers more than one of the level before: as above, 0 in a grid.
    pub span_octaves: u32,
    /// Level-0 pixels over which the shown footprint grows by one.
    pub growth: f32,
    /// Level-0 pixels under a pixel of the coarsest level, on a side.
    pub coarsest_scale: f32,
    /// Where a chroma sample of level 0 lies across its two luma columns, 0 to 1.
    pub chroma_offset: f32,
    /// Faces of one eye; those of the other follow.
    pub faces_of_an_eye: u32,
    /// Keeps the rows that follow at a multiple of sixteen.
    pub unused: u32,
    /// Rows that turn (Y, U, V, 1) into red, green, blue, all 0 to 1.
    pub rgb_from_yuv: [[f32; 4]; 3],
}

/// What a view shows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ViewParams {
    /// Columns of the matrix that turns (column, row, 1) into a homogeneous place or a ray.
    pub content_from_pixel: [[f32; 4]; 3],
    /// The first face of the eye that looks.
    pub first_face: u32,
    /// Keeps the size a multiple of sixteen.
    pub unused: [u32; 3],
}

/// What the overlay draws.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Overlay {
    /// Place of the gaze in output pixels.
    pub gaze: [f32; 2],
    /// Radius of the ring round the gaze in output pixels; 0 draws none.
    pub gaze_radius: f32,
    /// How much of the level's colour covers the picture, 0 to 1.
    pub heat: f32,
    /// How much of a border's colour covers the picture, 0 to 1; 0 draws none.
    pub borders: f32,
    /// Keeps the size a multiple of eight.
    pub unused: f32,
}

impl Default for Overlay {
    fn default() -> Self {
        Self {
            gaze: [0.0; 2],
            gaze_radius: 0.0,
            heat: 0.6,
            borders: 0.0,
            unused: 0.0,
        }
    }
}

impl ViewParams {
    /// The parameters of `view` on the surface of `grid`.
    #[must_use]
    pub fn new(view: &EyeView, grid: &TileGrid) -> Self {
        let m = view.content_from_pixel(&grid.surface);
        let column = |c: glam::DVec3| [c.x as f32, c.y as f32, c.z as f32, 0.0];
        Self {
            content_from_pixel: [column(m.x_axis), column(m.y_axis), column(m.z_axis)],
            first_face: grid.surface.first_face(view.eye),
            unused: [0; 3],
        }
    }
}

impl TileParams {
    /// The parameters of `grid`, with tiles of `colour`.
    #[must_use]
    pub(crate) fn new(grid: &TileGrid, colour: Colour) -> Self {
        let shape = AtlasShape::new(grid);
        let octaves = grid.ratio.trailing_zeros();
        let size = grid.surface.size.map(|s| s as f32);
        let cell = grid.span(0).map(|s| s as f32);
        let (segment, segments, span_octaves) = match grid.cut {
            Cut::Tile(_) => (size, [1; 2], octaves),
            Cut::Grid(_) => (cell, grid.cells(), 0),
        };
        Self {
            size,
            segment,
            cell,
            base_span: grid.span(grid.coarsest()).map(|s| s as f32),
            cells: grid.cells(),
            segments,
            base_step: shape.base_step,
            base_face: shape.base_face,
            base_across: shape.base_across,
            slot: shape.slot,
            coarsest: u32::from(grid.coarsest()),
            octaves,
            span_octaves,
            growth: grid.blend_pixels() as f32,
            coarsest_scale: grid.scale(grid.coarsest()) as f32,
            chroma_offset: if colour.chroma_left { 0.25 } else { 0.5 },
            faces_of_an_eye: grid.surface.faces_of_an_eye(),
            unused: 0,
            rgb_from_yuv: rgb_from_yuv(colour),
        }
    }
}

/// ITU-T H.273, equations 35 to 43: limited or full range, then the matrix of the luma weights.
pub(crate) fn rgb_from_yuv(colour: Colour) -> [[f32; 4]; 3] {
    let [kr, kb] = colour.matrix.luma_weights().map(f64::from);
    let kg = 1.0 - kr - kb;
    let (luma, black, chroma) = if colour.full_range {
        (1.0, 0.0, 1.0)
    } else {
        (255.0 / 219.0, 16.0 / 255.0, 255.0 / 224.0)
    };
    let (red, blue) = (2.0 * (1.0 - kr) * chroma, 2.0 * (1.0 - kb) * chroma);
    let grey = 128.0 / 255.0;
    let row = |u: f64, v: f64| {
        [luma, u, v, -luma * black - grey * (u + v)].map(|coefficient| coefficient as f32)
    };
    [
        row(0.0, red),
        row(-blue * kb / kg, -red * kr / kg),
        row(blue, 0.0),
    ]
}
