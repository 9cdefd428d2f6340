//! How does a view of the resident tiles become a picture?
//!
//! [`Renderer`] is what a window, a browser and a headless run call: upload into
//! [`Renderer::tiles`], then draw. Everything else in this crate serves it.

#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::params::{Overlay, ViewParams};
use crate::passes::{Pass, Target};
use crate::readback::ReadBack;
use crate::residency::TileStore;
use crate::{device::Gpu, error::RenderError, shaders};
use foveal_core::asset::picture::Colour;
use foveal_core::asset::tile_grid::TileGrid;
use foveal_core::view::eye_view::EyeView;

/// Draws views of one picture's tiles; keeps its pipelines and its output texture.
pub struct Renderer {
    gpu: Gpu,
    grid: TileGrid,
    tiles: TileStore,
    reconstruct: Pass,
    overlay: Option<Pass>,
    output: Target,
}

impl Renderer {
    /// A renderer of tiles of `grid`, whose atlas may grow to `layers` texture layers (256 at most,
    /// and never fewer than the coarsest level and one tile need); a layer takes 2 bytes for each
    /// of its pixels, usually 1024² to 2048².
    pub fn new(
        gpu: &Gpu,
        grid: &TileGrid,
        colour: Colour,
        layers: u32,
    ) -> Result<Self, RenderError> {
        let shader = shaders::reconstruct(grid.surface.projection);
        Ok(Self {
            gpu: gpu.clone(),
            grid: *grid,
            tiles: TileStore::new(gpu, grid, colour, layers)?,
            reconstruct: Pass::new(gpu, &shader),
            overlay: None,
            output: Target::new(gpu, [1, 1]),
        })
    }

    /// The resident tiles, to upload to and to evict from.
    pub fn tiles(&mut self) -> &mut TileStore {
        &mut self.tiles
    }

    /// Draws the picture that `view` shows of the resident tiles, with `marks` over it if there are
    /// any, and returns its rgba8 texture; the next draw reuses it.
    pub fn draw(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<&wgpu::Texture, RenderError> {
        self.tiles.flush();
        self.fit_output(view.size)?;
        let params = ViewParams::new(view, &self.grid);
        self.reconstruct
            .draw(&self.gpu, &self.tiles, &self.output, &params, None);
        if marks.is_some() {
            let overlay = self.overlay.get_or_insert_with(|| {
                Pass::over(&self.gpu, &shaders::overlay(self.grid.surface.projection))
            });
            overlay.draw(&self.gpu, &self.tiles, &self.output, &params, marks);
        }
        Ok(&self.output.picture)
    }

    /// [`Self::draw`], with the picture on its way back to the CPU.
    pub fn read(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<ReadBack, RenderError> {
        let gpu = self.gpu.clone();
        let texture = self.draw(view, marks)?;
        Ok(ReadBack::start(&gpu, texture))
    }

    /// The picture that `view` shows; blocks until it is there.
    ///
    /// ```no_run
    /// # use foveal_core::{asset::*, view::{eye_view::EyeView, surface::*}};
    /// # use foveal_core::asset::{picture::*, tile_grid::*};
    /// # use foveal_render::{Gpu, Renderer};
    /// # fn show(grid: &TileGrid, colour: Colour, tile: Tile, decoded: &Picture)
    /// # -> Result<(), foveal_render::RenderError> {
    /// let gpu = Gpu::open_blocking()?;
    /// let mut renderer = Renderer::new(&gpu, grid, colour, 16)?;
    /// renderer.tiles().begin_frame(7);
    /// renderer.tiles().upload(tile, 7, decoded)?;
    /// let image = renderer.reconstruct(&EyeView::filling(&grid.surface, [1280, 720]))?;
    /// # Ok(()) }
    /// ```
    #[cfg(not(target_arch = "wasm32"))]
    pub fn reconstruct(&mut self, view: &EyeView) -> Result<RgbaImage, RenderError> {
        self.read(view, None)?.wait(&self.gpu)
    }

    /// The picture with the levels, borders and gaze that `marks` asks for; blocks.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn heat_map(&mut self, view: &EyeView, marks: &Overlay) -> Result<RgbaImage, RenderError> {
        self.read(view, Some(marks))?.wait(&self.gpu)
    }

    fn fit_output(&mut self, size: [u32; 2]) -> Result<(), RenderError> {
        let size = size.map(|side| side.max(1));
        let (side, most) = (
            size[0].max(size[1]),
            self.gpu.device.limits().max_texture_dimension_2d,
        );
        if side > most {
            let what = "the picture";
            return Err(RenderError::TooLarge { what, side, most });
        }
        if self.output.size() != size {
            self.output = Target::new(&self.gpu, size);
        }
        Ok(())
    }
}
