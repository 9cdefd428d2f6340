//! Which numbers do the shaders and their twins need to find a sample?
//!
//! The structs here have the layout of the WGSL structs whose names lack the `Params`;
//! `tests/shaders.rs` compares them.

use crate::tiles::atlas_shape::AtlasShape;
use crate::tiles::samples::Extent;
use bytemuck::{Pod, Zeroable};
use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};
use foveal_core::perception::samples::sample_mask::{SPACINGS, SampleMask};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Colour;
use foveal_core::view::surface::Mapping;

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
    /// How the pixels of a cube's faces lie over their angles: 0 gnomonic, 1 equi-angular.
    pub mapping: u32,
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

/// A plane of a tile whose samples are averaged in squares.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct HalvedParams {
    /// Column and row of the first texel that is written.
    pub first: [u32; 2],
    /// Columns and rows that are written.
    pub size: [u32; 2],
    /// Column and row of the first texel that is read.
    pub low: [u32; 2],
    /// Column and row behind the last texel that is read.
    pub high: [u32; 2],
    /// What a written texel times `ratio` lacks to the first texel of its square.
    pub shift: [i32; 2],
    /// Layer of the atlas.
    pub layer: u32,
    /// Texels of a square on a side.
    pub ratio: u32,
}

/// Samples round the gaze.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SparseParams {
    /// Pixel of the view that the mask's top left pixel is shown at.
    pub corner: [i32; 2],
    /// Pixels of the mask on a side.
    pub side: u32,
    /// 1 to blend neighbouring samples, 0 to take the nearest.
    pub blends: u32,
    /// Pixels from one radius of `spacings` to the next.
    pub spacing_step: f32,
    /// Keeps what follows at a multiple of sixteen.
    pub unused: f32,
    /// The same.
    pub unused_pair: [f32; 2],
    /// Pixels between samples, by radius.
    pub spacings: [[f32; 4]; SPACINGS / 4],
}

/// A blur outside the fovea.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct BlurParams {
    /// Columns of the matrix that turns (column, row, 1) into a ray of depth 1.
    pub ray_from_pixel: [[f32; 4]; 3],
    /// Unit direction of the gaze.
    pub gaze: [f32; 3],
    /// Length of the chord from the gaze to the edge of the fovea, on the unit sphere.
    pub fovea_chord: f32,
    /// Radius of the fovea in radians.
    pub fovea: f32,
    /// Spread of the Gaussian by eccentricity beyond the fovea.
    pub growth: f32,
    /// Tangent of the angle that a pixel fills at the view's axis.
    pub pitch: f32,
    /// Last of the halves.
    pub last: f32,
    /// Variance of the first half in pixels².
    pub first: f32,
    /// Keeps the size a multiple of sixteen.
    pub unused: f32,
    /// The same.
    pub unused_pair: [f32; 2],
}

impl SparseParams {
    /// The parameters of a mask at the view's corner.
    #[must_use]
    pub(crate) fn new(mask: &SampleMask, blends: bool) -> Self {
        let corner = f64::from(mask.side) * std::f64::consts::FRAC_1_SQRT_2 + 2.0;
        let mut spacings = [[0.0; 4]; SPACINGS / 4];
        spacings
            .as_flattened_mut()
            .copy_from_slice(&mask.spacings[..SPACINGS]);
        Self {
            corner: [0; 2],
            side: mask.side,
            blends: u32::from(blends),
            spacing_step: (corner / SPACINGS as f64) as f32,
            unused: 0.0,
            unused_pair: [0.0; 2],
            spacings,
        }
    }
}

impl HalvedParams {
    /// Samples of `extent` whose first lies at column, row and layer `texel` of their mip, column
    /// and row multiples of `ratio`.
    #[must_use]
    pub(crate) fn new(extent: Extent, [x, y, layer]: [u32; 3], ratio: u32) -> Self {
        let reduced = extent.reduced(ratio);
        let shift = |k: usize| (ratio * reduced.first[k]) as i32 - extent.first[k] as i32;
        Self {
            first: [x / ratio, y / ratio],
            size: reduced.size,
            low: [x, y],
            high: [x + extent.size[0], y + extent.size[1]],
            shift: [shift(0), shift(1)],
            layer,
            ratio,
        }
    }
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
            mapping: match grid.surface.mapping {
                Mapping::Gnomonic => 0,
                Mapping::EquiAngular => 1,
            },
            rgb_from_yuv: colour.rgb_from_yuv(),
        }
    }
}
