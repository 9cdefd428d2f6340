//! Where are tiles shown in a page?

use foveal_core::asset::picture::{Colour, Picture};
use foveal_core::asset::tile_grid::{Tile, TileGrid};
use foveal_core::selection::stage::Easel;
use foveal_render::{Gpu, RenderError, Renderer};

/// Most layers of the atlas: what browsers give.
const MOST_LAYERS: u32 = 256;

/// Resident tiles and what draws them.
pub struct WebEasel {
    /// The device.
    pub gpu: Gpu,
    /// What draws.
    pub renderer: Renderer,
}

impl WebEasel {
    /// An empty one.
    pub fn new(gpu: Gpu, grid: &TileGrid, colour: Colour) -> Result<Self, RenderError> {
        let renderer = Renderer::new(&gpu, grid, colour, MOST_LAYERS)?;
        Ok(Self { gpu, renderer })
    }
}

impl Easel for WebEasel {
    type Error = RenderError;

    fn begin_frame(&mut self, frame: u32) {
        self.renderer.tiles().begin_frame(frame);
    }

    fn upload(&mut self, tile: Tile, frame: u32, picture: Picture) -> Result<(), RenderError> {
        self.renderer.tiles().upload(tile, frame, &picture)
    }

    fn retain(&mut self, wanted: &[Tile]) {
        self.renderer.tiles().retain(wanted);
    }

    fn wrong_frame_tiles(&mut self) -> usize {
        self.renderer.tiles().wrong_frame_tiles()
    }

    fn gpu_bytes(&mut self) -> u64 {
        self.renderer.gpu_bytes()
    }
}
