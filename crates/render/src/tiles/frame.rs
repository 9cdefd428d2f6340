//! How does a view of the resident tiles become a picture?
//!
//! [`Renderer`] is what a window, a browser and a headless run call: upload into
//! [`Renderer::tiles`], then draw. Everything else in this crate serves it.

use crate::gpu::picture_target::PictureTarget;
use crate::gpu::readback::{PictureCopy, ReadBack};
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::params::{Overlay, ViewParams};
use crate::tiles::blur::{Blur, FirstHalf, RadialBlur};
use crate::tiles::sparse::{Interpolation, SparseStore};
use crate::tiles::store::TileStore;
use crate::tiles::tile_pass::TilePass;
use crate::{error::RenderError, gpu::device::Gpu, shaders};
use foveal_core::content::video::grid::tile_grid::TileGrid;
use foveal_core::perception::samples::sample_mask::SampleMask;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Colour;

/// Draws views of one picture's tiles; keeps its pipelines and its output texture.
pub struct Renderer {
    gpu: Gpu,
    grid: TileGrid,
    tiles: TileStore,
    reconstruct: TilePass,
    reconstruct_half: TilePass,
    overlay: Option<TilePass>,
    output: PictureTarget,
    sparse: Option<SparseStore>,
    blur: Option<Blur>,
    /// What is blurred in the pictures drawn from now on; a window can turn it on and off.
    pub radial_blur: Option<RadialBlur>,
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
        let reconstruct = TilePass::new(gpu, &shader);
        Ok(Self {
            gpu: gpu.clone(),
            grid: *grid,
            tiles: TileStore::new(gpu, grid, colour, layers)?,
            reconstruct_half: reconstruct.again(gpu),
            reconstruct,
            overlay: None,
            output: PictureTarget::new(gpu, [1, 1]),
            sparse: None,
            blur: None,
            radial_blur: None,
        })
    }

    /// From now on shows samples round the gaze over the resident tiles, which need then be no
    /// more than the coarsest level. Uploads the mask; refuses one larger than the device binds.
    pub fn sample_by(
        &mut self,
        mask: &SampleMask,
        interpolation: Interpolation,
    ) -> Result<(), RenderError> {
        let projection = self.grid.surface.projection;
        self.sparse = Some(SparseStore::new(
            &self.gpu,
            projection,
            mask,
            interpolation,
        )?);
        Ok(())
    }

    /// Uploads Y, U and V of every sample, in the three low bytes of each; the mask's top left
    /// pixel is shown at `corner` of the view.
    ///
    /// # Panics
    /// [`Self::sample_by`] comes first.
    pub fn show_samples(&mut self, corner: [i32; 2], codes: &[u32]) -> Result<(), RenderError> {
        assert!(
            self.sparse.is_some(),
            "samples were given before their mask"
        );
        let gpu = &self.gpu;
        self.sparse
            .as_mut()
            .map_or(Ok(()), |sparse| sparse.show(gpu, corner, codes))
    }

    /// Bytes of GPU memory of tiles, samples and tables.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        self.tiles.gpu_bytes() + self.sparse.as_ref().map_or(0, SparseStore::bytes)
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
        let gpu = self.gpu.clone();
        let mut encoder = gpu.encoder("frame");
        let picture = self.record(&mut encoder, view, marks)?;
        gpu.submit(encoder);
        Ok(picture)
    }

    /// Records all passes of a frame; returns what it shows.
    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<&wgpu::Texture, RenderError> {
        self.output.fit(&self.gpu, view.size)?;
        // Behind what may fail: what is recorded here counts as done.
        self.tiles.flush(encoder);
        let params = ViewParams::new(view, &self.grid);
        let (gpu, tiles, output) = (&self.gpu, &self.tiles, &self.output);
        let reconstruct = &mut self.reconstruct;
        let blur = self.radial_blur.as_ref();
        let blurred = blur.map(|wanted| {
            let blur = Blur::of_size(&mut self.blur, gpu, output.size());
            (blur, wanted)
        });
        let shown = match (&mut self.sparse, blurred) {
            (Some(sparse), blurred) => {
                sparse.record((gpu, encoder), tiles, output, &params);
                blurred.map_or(output, |(blur, wanted)| {
                    blur.record((gpu, encoder), output, view, wanted, FirstHalf::Halved)
                })
            }
            (None, None) => {
                reconstruct.record((gpu, encoder), tiles, output.whole(), &params, None);
                output
            }
            (None, Some((blur, wanted))) => {
                let half = ViewParams::new(&RadialBlur::half_view(view), &self.grid);
                let first_half = blur.first_half().whole();
                self.reconstruct_half
                    .record((gpu, encoder), tiles, first_half, &half, None);
                if let Some(sharp) = wanted.sharp_pixels(view, FirstHalf::Drawn) {
                    let area = output.within(sharp);
                    reconstruct.record((gpu, encoder), tiles, area, &params, None);
                }
                blur.record((gpu, encoder), output, view, wanted, FirstHalf::Drawn)
            }
        };
        if marks.is_some() {
            let shader = || shaders::overlay(self.grid.surface.projection);
            let overlay = self
                .overlay
                .get_or_insert_with(|| TilePass::over(gpu, &shader()));
            overlay.record((gpu, encoder), tiles, shown.whole(), &params, marks);
        }
        Ok(&shown.picture)
    }

    /// [`Self::draw`], with the picture on its way back to the CPU.
    pub fn read(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<ReadBack, RenderError> {
        let gpu = self.gpu.clone();
        let mut encoder = gpu.encoder("frame to read");
        let picture = self.record(&mut encoder, view, marks)?;
        let copy = PictureCopy::record(&gpu, &mut encoder, picture);
        gpu.submit(encoder);
        Ok(copy.map())
    }

    /// The picture that `view` shows; blocks until it is there.
    ///
    /// ```no_run
    /// # use foveal_core::view::{eye_view::EyeView, picture::*, surface::*};
    /// # use foveal_core::content::video::grid::tile_grid::*;
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
}
