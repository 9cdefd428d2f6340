//! Where are tiles shown in a page?

use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::session::playback::Easel;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Picture};
use foveal_render::twin::{self, TwinTiles};
use foveal_render::{Gpu, Overlay, RenderError, Renderer, RgbaImage};

/// Most layers of the atlas: what browsers give.
const MOST_LAYERS: u32 = 256;

/// Resident tiles and what draws them.
pub enum WebEasel {
    /// A graphics device.
    Gpu(Box<GpuEasel>),
    /// The plain CPU twin of its passes, where there is none.
    Twin(Box<TwinTiles>),
}

/// Resident tiles on a graphics device.
pub struct GpuEasel {
    /// The device.
    pub gpu: Gpu,
    /// What draws.
    pub renderer: Renderer,
}

impl WebEasel {
    /// An empty one, on a device where there is one.
    pub fn new(gpu: Option<Gpu>, grid: &TileGrid, colour: Colour) -> Result<Self, RenderError> {
        Ok(match gpu {
            Some(gpu) => {
                let renderer = Renderer::new(&gpu, grid, colour, MOST_LAYERS)?;
                Self::Gpu(Box::new(GpuEasel { gpu, renderer }))
            }
            None => Self::Twin(Box::new(TwinTiles::new(grid, colour))),
        })
    }

    /// What draws, for people.
    pub fn name(&self) -> &str {
        match self {
            Self::Gpu(easel) => easel.gpu.adapter_name(),
            Self::Twin(_) => "the processor",
        }
    }
}

/// The picture of a view by the CPU twin.
pub(crate) fn twin_picture(
    tiles: &TwinTiles,
    view: &EyeView,
    marks: Option<&Overlay>,
) -> RgbaImage {
    let picture = twin::reconstruct(tiles, view);
    match marks {
        Some(marks) => twin::marked(tiles, view, marks, picture),
        None => picture,
    }
}

impl Easel for WebEasel {
    type Error = RenderError;

    fn begin_frame(&mut self, frame: u32) {
        match self {
            Self::Gpu(easel) => easel.renderer.tiles().begin_frame(frame),
            Self::Twin(tiles) => tiles.begin_frame(frame),
        }
    }

    fn upload(&mut self, tile: Tile, frame: u32, picture: Picture) -> Result<(), RenderError> {
        match self {
            Self::Gpu(easel) => easel.renderer.tiles().upload(tile, frame, &picture),
            Self::Twin(tiles) => tiles.upload(tile, frame, &picture),
        }
    }

    fn retain(&mut self, wanted: &[Tile]) {
        match self {
            Self::Gpu(easel) => easel.renderer.tiles().retain(wanted),
            Self::Twin(tiles) => tiles.retain(wanted),
        }
    }

    fn wrong_frame_tiles(&mut self) -> usize {
        match self {
            Self::Gpu(easel) => easel.renderer.tiles().wrong_frame_tiles(),
            Self::Twin(tiles) => tiles.wrong_frame_tiles(),
        }
    }

    fn gpu_bytes(&mut self) -> u64 {
        match self {
            Self::Gpu(easel) => easel.renderer.gpu_bytes(),
            Self::Twin(_) => 0,
        }
    }
}
