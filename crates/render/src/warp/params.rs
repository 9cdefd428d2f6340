//! Which numbers does the pass that fills panels need?
//!
//! The structs here have the layout of the WGSL structs whose names lack the `Params`;
//! `tests/shaders.rs` compares them.

use super::style::{WarpFilter, WarpStyle};
use bytemuck::{Pod, Zeroable};

/// A panel: 128 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PanelParams {
    /// First column of the matrix that turns (column, row, 1) of the panel as it is sent into a ray
    /// of the source: right, down, forward.
    pub right: [f32; 3],
    /// 0 plane, 1 cylinder, 2 equirectangular, 3 fisheye, 4 the maps of the seed.
    pub projection: u32,
    /// Second column.
    pub down: [f32; 3],
    /// Linear light where the picture is black.
    pub black: f32,
    /// Third column.
    pub corner: [f32; 3],
    /// Number of the panel's [`BlendParams`] from 1 on; 0 where it has none.
    pub blend: u32,
    /// First column and row in the atlas.
    pub origin: [u32; 2],
    /// Columns and rows as they are sent.
    pub size: [u32; 2],
    /// Texels of the source by unit of the projection.
    pub scale: [f32; 2],
    /// Texel of the source on the projection's axis.
    pub offset: [f32; 2],
    /// Where the part of the source begins that is taken.
    pub low: [f32; 2],
    /// Where it ends.
    pub high: [f32; 2],
    /// What linear light is multiplied by.
    pub gain: [f32; 3],
    /// Index of the panel's first number among the grids.
    pub grid: u32,
    /// Pixels from one node of the grid to the next; 0 where there is none.
    pub cell: u32,
    /// Grids of the panel: 1, or 3 where colours part.
    pub channels: u32,
    /// Index among the grids of the shares of light that pixels keep, plus 1; 0 where they keep
    /// all.
    pub alpha: u32,
    /// Index of the [`SightParams`] of the panel's source; not read where no eye blurs.
    pub sight: u32,
}

/// How rays of a source stand in the world: columns of matrices, with padding.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct SightParams {
    /// From rays to the right, down and forward of the source's axis, in which its place is read.
    pub world_from_source: [[f32; 4]; 3],
    /// And back.
    pub source_from_world: [[f32; 4]; 3],
}

/// How a panel fades into its neighbours.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct BlendParams {
    /// First column of the matrix that turns (column, row, 1) as sent into a ray in the world.
    pub right: [f32; 3],
    /// One over the width of the fade, a radian.
    pub sharpness: f32,
    /// Second column.
    pub down: [f32; 3],
    /// Index of the first neighbour.
    pub first: u32,
    /// Third column.
    pub corner: [f32; 3],
    /// How many neighbours there are.
    pub count: u32,
    /// Unit direction to the right of the chart of its field.
    pub chart_right: [f32; 3],
    /// The most panels that show one direction.
    pub most: f32,
    /// Unit direction down the chart.
    pub chart_down: [f32; 3],
    /// Index of the field's first node.
    pub field: u32,
    /// Unit direction of the chart's middle.
    pub chart_axis: [f32; 3],
    /// One over the distance of nodes on the chart.
    pub per_step: f32,
    /// Place of the first node on the chart.
    pub low: [f32; 2],
    /// Columns and rows of nodes.
    pub nodes: [u32; 2],
}

/// What all panels share.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct WarpParams {
    /// Columns and rows of the atlas.
    pub atlas: [f32; 2],
    /// Half the line that an eye makes of a point straight ahead, right and down, in radians, as
    /// long as the filter takes it; nothing where no eye blurs.
    pub spread: [f32; 2],
    /// Number of the filter.
    pub filter_by: u32,
    /// Index of the coarsest level of the source.
    pub last: f32,
    /// Most of Feline's samples.
    pub most_probes: f32,
    /// Whether pixels of more than one sample are painted.
    pub paints: u32,
    /// Whether the device's own anisotropic filter is taken.
    pub by_device: u32,
    /// Padding.
    pub unused: u32,
}

/// Most samples of Feline's, and of the device's anisotropic filter.
pub(crate) const MOST_PROBES: u16 = 16;

/// Most samples where an eye blurs: lines of 64 texels are drawn no wider across.
const MOST_BLURRED: u16 = 64;

impl WarpParams {
    pub(crate) fn new(atlas: [u32; 2], levels: u32, style: &WarpStyle) -> Self {
        let filter_by = match style.filter {
            WarpFilter::Bilinear => 0,
            WarpFilter::Trilinear => 1,
            WarpFilter::Bicubic => 2,
            WarpFilter::Anisotropic => 3,
            WarpFilter::Feline => 4,
            WarpFilter::Auto => 5,
        };
        Self {
            atlas: atlas.map(|side| side as f32),
            spread: [0.0; 2],
            filter_by,
            last: (levels - 1) as f32,
            most_probes: f32::from(MOST_PROBES),
            paints: u32::from(style.paints),
            by_device: 0,
            unused: 0,
        }
    }

    /// The same for an eye that spreads points by so many radians, one standard deviation; the
    /// filter takes steps to have this moment.
    ///
    /// # Panics
    /// When an eye blurs and the filter has no moment.
    pub(crate) fn blurred(mut self, spread: [f32; 2], moment: Option<f64>) -> Self {
        if spread == [0.0; 2] {
            return self;
        }
        let Some(moment) = moment else {
            panic!("an eye's blur is drawn along lines, which this filter does not take");
        };
        let scale = (1.0 / moment.sqrt()) as f32;
        self.spread = spread.map(|it| it * scale);
        self.most_probes = f32::from(MOST_BLURRED);
        // The device's own filter takes 16 samples, of places that are its affair.
        self.by_device = 0;
        self
    }

    pub(crate) fn blurs(&self) -> bool {
        self.spread != [0.0; 2]
    }
}
