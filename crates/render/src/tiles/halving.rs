//! How does the GPU make the averages of tiles that came?
//!
//! A pass draws one mip of all new tiles of a layer at once, before a picture reads them. An
//! adapter in software takes longer for that than [`crate::tiles::reduce`] does, so it leaves them
//! to the thread that uploads.

use crate::gpu::bindings::bind;
use crate::gpu::buffers::filled;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::{Drawing, module, pipeline};
use crate::gpu::screen_pass::Reads;
use crate::gpu::textures::layers_of;
use crate::params::HalvedParams;
use crate::shaders::halve_tiles;
use crate::tiles::atlas::Planes;
use crate::tiles::samples::{Extent, reductions};
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::perception::measures::luma_light::LumaLight;
use foveal_core::view::picture::Colour;
use std::ops::Range;

/// What makes the averages of tiles that a coarser level's spacing asks for: the same, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HalvedBy {
    /// The GPU, before it draws.
    Gpu,
    /// The thread that uploads.
    Cpu,
}

impl HalvedBy {
    /// What takes less time. (Every device of Vulkan and WebGPU draws on the atlas' formats.)
    pub(crate) fn fastest(gpu: &Gpu) -> Self {
        const BUFFERS: u32 = 2;
        let is_software = gpu.device.adapter_info().device_type == wgpu::DeviceType::Cpu;
        let has = gpu.device.limits().max_storage_buffers_per_shader_stage;
        match is_software || has < BUFFERS {
            true => Self::Cpu,
            false => Self::Gpu,
        }
    }
}

/// A tile that came, and column, row and layer of its first luma texel.
pub(crate) type NewTile = (Tile, [u32; 3]);

/// The pass, for luma and for chroma.
pub(crate) struct TileHalving {
    layout: wgpu::BindGroupLayout,
    pipelines: [wgpu::RenderPipeline; 2],
    lights: wgpu::Buffer,
}

/// What is drawn of one mip of a plane: tiles by their records, for each layer.
struct Step {
    plane: usize,
    /// The mip that is read.
    mip: u32,
    layers: Vec<(u32, Range<u32>)>,
}

/// What is drawn onto one layer of a mip.
struct Pass {
    plane: usize,
    bound: wgpu::BindGroup,
    target: wgpu::TextureView,
    /// Records of the tiles.
    tiles: Range<u32>,
}

impl TileHalving {
    /// The pass over tiles of `colour`.
    pub(crate) fn new(gpu: &Gpu, colour: Colour) -> Self {
        let shader = halve_tiles();
        let reads = [(0, Reads::Storage), (1, Reads::Storage), (2, Reads::Layers)];
        let layout = Reads::layout(
            gpu,
            shader.name,
            wgpu::ShaderStages::VERTEX_FRAGMENT,
            &reads,
        );
        let module = module(gpu, shader.name, &shader.text);
        let [luma, chroma] = Planes::FORMATS;
        let pipelines = [(luma, 1.0), (chroma, 0.0)].map(|(format, is_luma)| {
            let drawing = Drawing {
                layout: Some(&layout),
                primitive: wgpu::PrimitiveState {
                    topology: wgpu::PrimitiveTopology::TriangleStrip,
                    ..wgpu::PrimitiveState::default()
                },
                depth: None,
                target: format.into(),
                constants: &[("pipeline_luma", is_luma)],
            };
            pipeline(gpu, &module, shader.steps[0], drawing)
        });
        let storage = wgpu::BufferUsages::STORAGE;
        Self {
            lights: filled(gpu, "light of codes", storage, &lights(colour)),
            layout,
            pipelines,
        }
    }

    /// Bytes of its table.
    pub(crate) fn bytes(&self) -> u64 {
        self.lights.size()
    }

    /// Records every average of tiles, which are in mip 0 when it runs; none where the device was
    /// lost.
    pub(crate) fn record(
        &self,
        (gpu, encoder): (&Gpu, &mut wgpu::CommandEncoder),
        planes: &Planes,
        grid: &TileGrid,
        tiles: &mut [NewTile],
    ) {
        tiles.sort_unstable_by_key(|(_, [.., layer])| *layer);
        let (records, steps) = steps(grid, tiles);
        if records.is_empty() {
            return;
        }
        let octaves = grid.ratio.trailing_zeros();
        let passes = gpu.unless_lost(|| {
            let usage = wgpu::BufferUsages::STORAGE;
            let records = filled(gpu, "tiles to halve", usage, &records);
            let passes = steps.into_iter();
            let passes =
                passes.flat_map(|step| self.passes(gpu, planes, (&records, octaves), step));
            passes.collect::<Vec<Pass>>()
        });
        for drawn in passes.into_iter().flatten() {
            let mut pass = begin(encoder, &drawn.target);
            pass.set_pipeline(&self.pipelines[drawn.plane]);
            pass.set_bind_group(0, &drawn.bound, &[]);
            pass.draw(0..4, drawn.tiles);
        }
    }

    /// The passes of a step, one a layer.
    fn passes(
        &self,
        gpu: &Gpu,
        planes: &Planes,
        (records, octaves): (&wgpu::Buffer, u32),
        step: Step,
    ) -> Vec<Pass> {
        let texture = [&planes.luma, &planes.chroma][step.plane];
        let finer = layers_of(texture, step.mip..step.mip + 1);
        let resources = [
            (0, records.as_entire_binding()),
            (1, self.lights.as_entire_binding()),
            (2, wgpu::BindingResource::TextureView(&finer)),
        ];
        let bound = bind(gpu, "halve_tiles", &self.layout, &resources);
        let pass = |(layer, tiles)| Pass {
            plane: step.plane,
            bound: bound.clone(),
            target: layer_of(texture, step.mip + octaves, layer),
            tiles,
        };
        step.layers.into_iter().map(pass).collect()
    }
}

/// The words of `lights` in the shader.
fn lights(colour: Colour) -> Vec<u32> {
    let table = LumaLight::of(colour);
    let lights = (0..=u8::MAX).map(|code| table.light(code) as u32);
    let white = table.light(u8::MAX);
    let codes = (0..=white).step_by(4).map(|light| {
        let four = [0, 1, 2, 3].map(|k| table.code(light + k));
        u32::from_le_bytes(four)
    });
    lights.chain(codes).collect()
}

/// The record of every tile at every step, and the steps in their order. Tiles come layer by layer.
fn steps(grid: &TileGrid, tiles: &[NewTile]) -> (Vec<HalvedParams>, Vec<Step>) {
    let most = tiles.iter().map(|(tile, _)| reductions(grid, *tile)).max();
    let (mut records, mut steps) = (Vec::new(), Vec::new());
    for plane in [0, 1] {
        let extents = tiles.iter().map(|(tile, _)| Extent::of(grid, *tile, plane));
        let mut extents: Vec<Extent> = extents.collect();
        for step in 0..most.unwrap_or(0) {
            let mip = step * grid.ratio.trailing_zeros();
            let mut layers: Vec<(u32, Range<u32>)> = Vec::new();
            for ((tile, [x, y, layer]), extent) in tiles.iter().zip(&mut extents) {
                if step >= reductions(grid, *tile) {
                    continue;
                }
                let texel = [(x >> plane) >> mip, (y >> plane) >> mip, *layer];
                let at = records.len() as u32;
                records.push(HalvedParams::new(*extent, texel, grid.ratio));
                *extent = extent.reduced(grid.ratio);
                match layers.last_mut() {
                    Some((last, tiles)) if last == layer => tiles.end = at + 1,
                    _ => layers.push((*layer, at..at + 1)),
                }
            }
            steps.push(Step { plane, mip, layers });
        }
    }
    (records, steps)
}

/// The view of one layer of a mip.
fn layer_of(texture: &wgpu::Texture, mip: u32, layer: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_mip_level: mip,
        mip_level_count: Some(1),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    })
}

/// Begins a pass over what a target holds.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    target: &wgpu::TextureView,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("halve_tiles"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            },
        })],
        ..wgpu::RenderPassDescriptor::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::atlas::Atlas;
    use crate::tiles::atlas_shape::AtlasShape;
    use crate::tiles::read_tile::read_planes;
    use crate::tiles::reduce::pyramid;
    use foveal_core::content::video::grid::tile_grid::Cut;
    use foveal_core::view::picture::{Matrix, Picture};
    use foveal_core::view::surface::{Screen, Surface};

    fn flat(size: [u32; 2]) -> Surface {
        Surface::flat(size, Screen::default())
    }

    fn noise([width, height]: [u32; 2], seed: u32) -> Picture {
        let mut picture = Picture::filled(width, height, [0; 3]);
        let mut state = seed;
        for code in picture.planes.iter_mut().flatten() {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *code = (state >> 24) as u8;
        }
        picture
    }

    fn assert_as_by_the_cpu(gpu: &Gpu, grid: &TileGrid, colour: Colour) {
        let mut atlas = Atlas::new(gpu, AtlasShape::new(grid), 256).unwrap();
        let mut free: Vec<_> = atlas.slots().collect();
        let levels = 0..grid.coarsest();
        let all: Vec<Tile> = levels.flat_map(|level| grid.tiles_of(level)).collect();
        let mut new: Vec<NewTile> = Vec::new();
        for (n, tile) in (0..).zip(&all) {
            if free.is_empty() {
                free = atlas.grow(gpu);
            }
            let texel = atlas.texel_of_slot(free.pop().unwrap());
            let picture = noise(grid.tile_size(*tile), n);
            let planes = [0, 1, 2].map(|p| (picture.plane_size(p), &picture.planes[p][..]));
            atlas.planes.write(gpu, texel, 0, planes);
            new.push((*tile, texel));
        }
        let mut encoder = gpu.encoder("octaves");
        let halving = TileHalving::new(gpu, colour);
        halving.record((gpu, &mut encoder), &atlas.planes, grid, &mut new.clone());
        gpu.submit(encoder);
        for (n, (tile, texel)) in (0..).zip(&new) {
            let picture = noise(grid.tile_size(*tile), n);
            let expected = [0, 1, 2].map(|p| pyramid(grid, *tile, &picture, p, colour));
            for step in 0..=reductions(grid, *tile) {
                let [y, u, v] = [0, 1, 2].map(|p: usize| &expected[p][step as usize]);
                let sizes = [y.extent.size, u.extent.size];
                let mip = step * grid.ratio.trailing_zeros();
                let found = read_planes(gpu, &atlas.planes, (*texel, mip), sizes).unwrap();
                let expected = [y, u, v].map(|samples| samples.codes.clone());
                assert_eq!(found, expected, "{tile:?} of {grid:?}, step {step}");
            }
        }
    }

    #[test]
    fn the_averages_of_tiles_are_those_of_the_twin() {
        let gpu = Gpu::open_blocking().unwrap();
        for (surface, cut, levels, ratio) in [
            (flat([283, 171]), Cut::Tile(32), 4, 2),
            (flat([190, 90]), Cut::Tile(20), 5, 2),
            (flat([7, 3]), Cut::Tile(128), 2, 2),
            (flat([65, 49]), Cut::Tile(16), 4, 4),
            (flat([97, 51]), Cut::Grid([8, 4]), 5, 2),
            (Surface::cube(100), Cut::Tile(32), 5, 2),
            (Surface::cube(94), Cut::Grid([4, 4]), 3, 4),
        ] {
            let grid = TileGrid::new(surface, cut, levels, ratio).unwrap();
            for full_range in [true, false] {
                let colour = Colour {
                    matrix: Matrix::Bt709,
                    full_range,
                    chroma_left: false,
                };
                assert_as_by_the_cpu(&gpu, &grid, colour);
            }
        }
    }
}
