//! How is a picture held and drawn with a texture for every level?
//!
//! The comparison to the atlas: every level's texture holds the whole surface, whether its tiles
//! are in use or not (Kastner 2016, section 4.2).

use crate::error::RenderError;
use crate::gpu::buffers::{filled, written};
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::PictureTarget;
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::readback::PictureCopy;
use crate::gpu::screen_pass::{Reads, ScreenPass};
use crate::gpu::textures::{layers_of, paired, texture_array, write_texels};
use crate::params::{TileParams, ViewParams};
use crate::shaders;
use crate::tiles::blur::{Blur, FirstHalf, RadialBlur};
use crate::tiles::level_map::shown_map;
use crate::tiles::store::check;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Picture, plane_size};
use std::collections::BTreeMap;

/// Most levels: two textures each, and browsers bind sixteen.
const MOST_LEVELS: usize = 8;

/// Draws views of a picture whose levels are a texture each.
pub struct TextureRenderer {
    gpu: Gpu,
    grid: TileGrid,
    pass: ScreenPass,
    params: wgpu::Buffer,
    cells: wgpu::Buffer,
    view: wgpu::Buffer,
    levels: Vec<LevelTextures>,
    /// Frame that each tile was last updated for.
    frames: BTreeMap<Tile, u32>,
    frame: u32,
    bound: wgpu::BindGroup,
    output: PictureTarget,
    blur: Option<Blur>,
    /// What is blurred in the pictures drawn from now on.
    pub radial_blur: Option<RadialBlur>,
}

/// Luma and chroma of one level, a layer a face.
struct LevelTextures {
    luma: wgpu::Texture,
    chroma: wgpu::Texture,
}

impl TextureRenderer {
    /// Textures of every level of `grid`; refuses a level that is larger than a texture may be.
    pub fn new(gpu: &Gpu, grid: &TileGrid, colour: Colour) -> Result<Self, RenderError> {
        let [w, h] = level_size(grid, 0, 0);
        let (side, most) = (w.max(h), gpu.device.limits().max_texture_dimension_2d);
        if side > most {
            let what = "the texture of the finest level (an atlas holds any size)";
            return Err(RenderError::TooLarge { what, side, most });
        }
        let levels: Vec<LevelTextures> = (0..grid.levels)
            .map(|level| LevelTextures::new(gpu, grid, level))
            .collect();
        let mut reads = vec![
            (0, Reads::Uniform),
            (1, Reads::Storage),
            (4, Reads::Uniform),
        ];
        reads.extend((5..).zip([Reads::Layers; 2 * MOST_LEVELS]));
        let pass = ScreenPass::new(
            gpu,
            &shaders::reconstruct_textures(grid.surface.projection),
            &reads,
        );
        let uniform = wgpu::BufferUsages::UNIFORM;
        let params = filled(gpu, "textures", uniform, &[TileParams::new(grid, colour)]);
        let cells = u64::from(grid.tiles_in_level(0)) * 4;
        let cells = written(gpu, "cells", cells, wgpu::BufferUsages::STORAGE);
        let view = written(gpu, "view", size_of::<ViewParams>() as u64, uniform);
        let bound = bind(gpu, &pass, [&params, &cells, &view], &levels);
        Ok(Self {
            gpu: gpu.clone(),
            grid: *grid,
            pass,
            params,
            cells,
            view,
            levels,
            frames: BTreeMap::new(),
            frame: 0,
            bound,
            output: PictureTarget::new(gpu, [1, 1]),
            blur: None,
            radial_blur: None,
        })
    }

    /// From now on source frame `frame` is shown: only tiles uploaded for it are.
    pub fn begin_frame(&mut self, frame: u32) {
        self.frame = frame;
    }

    /// Updates the part of a level's texture that `tile` covers.
    pub fn upload(&mut self, tile: Tile, frame: u32, picture: &Picture) -> Result<(), RenderError> {
        check(&self.grid, tile, picture)?;
        let step = self.grid.tile_size(Tile { x: 0, y: 0, ..tile });
        let textures = &self.levels[usize::from(tile.level)];
        let chroma = paired(&picture.planes[1], &picture.planes[2]);
        for (plane, texture, bytes) in [
            (0, &textures.luma, &picture.planes[0]),
            (1, &textures.chroma, &chroma),
        ] {
            let [step_x, step_y] = plane_size(step[0], step[1], plane);
            let (x, y) = (u32::from(tile.x) * step_x, u32::from(tile.y) * step_y);
            let at = [x, y, u32::from(tile.face), 0];
            write_texels(&self.gpu, texture, at, picture.plane_size(plane), bytes);
        }
        self.frames.insert(tile, frame);
        Ok(())
    }

    /// Tiles of the coarsest level that hold another source frame than the one shown, or none;
    /// finer ones are drawn in the frame they were updated for and in no other.
    #[must_use]
    pub fn wrong_frame_tiles(&self) -> usize {
        let base = self.grid.tiles_of(self.grid.coarsest());
        base.filter(|tile| self.frames.get(tile) != Some(&self.frame))
            .count()
    }

    /// Blocks until the GPU holds what was uploaded.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&self) -> Result<(), RenderError> {
        self.gpu.settle()
    }

    /// Bytes of GPU memory of the textures and tables.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        texture_bytes(&self.grid).iter().sum::<u64>() + self.params.size() + self.cells.size()
    }

    /// The picture that `view` shows; blocks until it is there.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn reconstruct(&mut self, view: &EyeView) -> Result<crate::image::RgbaImage, RenderError> {
        let gpu = self.gpu.clone();
        let mut encoder = gpu.encoder("frame to read");
        let texture = self.record(&mut encoder, view)?;
        let copy = PictureCopy::record(&gpu, &mut encoder, texture);
        gpu.submit(encoder);
        copy.map().wait(&gpu)
    }

    /// Draws the picture that `view` shows and returns its rgba8 texture; the next draw reuses it.
    pub fn draw(&mut self, view: &EyeView) -> Result<&wgpu::Texture, RenderError> {
        let gpu = self.gpu.clone();
        let mut encoder = gpu.encoder("frame");
        let texture = self.record(&mut encoder, view)?;
        gpu.submit(encoder);
        Ok(texture)
    }

    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &EyeView,
    ) -> Result<&wgpu::Texture, RenderError> {
        self.output.fit(&self.gpu, view.size)?;
        let now = self
            .frames
            .iter()
            .filter(|(_, frame)| **frame == self.frame);
        let map = shown_map(
            &self.grid,
            now.map(|(tile, _)| (*tile, u32::from(tile.level))),
        );
        let (gpu, output) = (&self.gpu, &self.output);
        gpu.queue
            .write_buffer(&self.cells, 0, bytemuck::cast_slice(&map));
        let params = ViewParams::new(view, &self.grid);
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&params));
        self.pass.record(encoder, &self.bound, output.whole());
        let shown = match &self.radial_blur {
            Some(wanted) => {
                let blur = Blur::of_size(&mut self.blur, gpu, output.size());
                blur.record((gpu, encoder), output, view, wanted, FirstHalf::Halved)
            }
            None => output,
        };
        Ok(&shown.picture)
    }
}

/// Bytes of the textures of every level of `grid`, finest first: 8 bits of luma a pixel, and two of
/// chroma for four.
#[must_use]
pub fn texture_bytes(grid: &TileGrid) -> Vec<u64> {
    let bytes = |level| {
        let [luma, chroma] = [0, 1].map(|plane| {
            let [w, h] = level_size(grid, level, plane).map(u64::from);
            w * h * (plane as u64 + 1)
        });
        u64::from(grid.faces()) * (luma + chroma)
    };
    (0..grid.levels).map(bytes).collect()
}

/// Samples of a plane of a level on one face: its tiles side by side.
fn level_size(grid: &TileGrid, level: u8, plane: usize) -> [u32; 2] {
    let first = grid.tile_at(level, 0);
    let tiles = grid.tiles(level);
    let last = Tile {
        x: (tiles[0] - 1) as u16,
        y: (tiles[1] - 1) as u16,
        ..first
    };
    let [step, rest] = [first, last].map(|tile| {
        let [w, h] = grid.tile_size(tile);
        plane_size(w, h, plane)
    });
    [0, 1].map(|k| (tiles[k] - 1) * step[k] + rest[k])
}

impl LevelTextures {
    fn new(gpu: &Gpu, grid: &TileGrid, level: u8) -> Self {
        let texture = |plane, format| {
            let [width, height] = level_size(grid, level, plane);
            let size = [width, height, grid.faces(), 1];
            let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
            texture_array(&gpu.device, "level", size, format, usage)
        };
        Self {
            luma: texture(0, wgpu::TextureFormat::R8Unorm),
            chroma: texture(1, wgpu::TextureFormat::Rg8Unorm),
        }
    }
}

/// Every binding of the pass; levels that are not there repeat the coarsest and are never read.
fn bind(
    gpu: &Gpu,
    pass: &ScreenPass,
    [params, cells, view]: [&wgpu::Buffer; 3],
    levels: &[LevelTextures],
) -> wgpu::BindGroup {
    let views = |of: fn(&LevelTextures) -> &wgpu::Texture| {
        let view = move |level: usize| layers_of(of(&levels[level.min(levels.len() - 1)]), 0..1);
        (0..MOST_LEVELS).map(view).collect::<Vec<_>>()
    };
    let textures = [views(|level| &level.luma), views(|level| &level.chroma)].concat();
    let mut resources = vec![
        (0, params.as_entire_binding()),
        (1, cells.as_entire_binding()),
        (4, view.as_entire_binding()),
    ];
    let textures = textures.iter().map(wgpu::BindingResource::TextureView);
    resources.extend((5..).zip(textures));
    pass.bind(gpu, &resources)
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::content::video::grid::tile_grid::Cut;
    use foveal_core::view::surface::Surface;

    #[test]
    fn three_levels_in_steps_of_a_quarter_take_106_64_percent_of_the_finest() {
        let grid = TileGrid::new(Surface::cube(4096), Cut::Grid([4, 4]), 3, 4).unwrap();
        let bytes = texture_bytes(&grid);
        // 8-bit 4:2:0 of six faces of 4096².
        assert_eq!(bytes[0], 6 * 4096 * 4096 * 3 / 2);
        let share = bytes.iter().sum::<u64>() as f64 / bytes[0] as f64;
        assert_eq!((share * 1e4).round(), 10_664.0);
    }
}
