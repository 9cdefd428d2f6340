//! What does a picture hide of the next one?

use crate::error::RenderError;
use crate::gpu::buffers::{filled, storage, written};
use crate::gpu::compute::{Compute, Dispatch, record};
use crate::gpu::device::Gpu;
use crate::scene::params::{HalvingParams, SceneParams};
use crate::shaders;

/// Texels on a side of a workgroup.
const WORKGROUP: [u32; 2] = [8, 8];

/// How near the farthest thing in each square of pixels is, in the picture that was drawn last.
pub(crate) struct Hiding {
    passes: [Compute; 2],
    /// Of all levels, one behind the other.
    depths: wgpu::Buffer,
    /// What each level is made by, the finest first.
    levels: Vec<wgpu::Buffer>,
    /// The picture's size.
    size: [u32; 2],
    /// The view that the depths are of, and the placements in it.
    pub(crate) view: wgpu::Buffer,
    pub(crate) placements: wgpu::Buffer,
    /// Whether they are of any.
    pub(crate) is_there: bool,
}

impl Hiding {
    /// Nothing was drawn so far; `placements` take so many bytes.
    ///
    /// # Errors
    /// The device binds no buffer that is so large.
    pub(crate) fn new(gpu: &Gpu, placements: u64) -> Result<Self, RenderError> {
        let view = size_of::<SceneParams>() as u64;
        Ok(Self {
            passes: shaders::halve_depths().map(|it| Compute::new(gpu, &it)),
            depths: storage(gpu, "depths that hide", 4)?,
            levels: Vec::new(),
            size: [0, 0],
            view: written(gpu, "view before", view, wgpu::BufferUsages::UNIFORM),
            placements: storage(gpu, "placements before", placements)?,
            is_there: false,
        })
    }

    /// The depths, as the pass that culls reads them.
    pub(crate) fn depths(&self) -> wgpu::BindingResource<'_> {
        self.depths.as_entire_binding()
    }

    /// Makes room for the depths of a picture; those of another size are forgotten.
    ///
    /// # Errors
    /// The device binds no buffer that is so large.
    pub(crate) fn fit(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
        if self.size == size {
            return Ok(());
        }
        self.depths = storage(gpu, "depths that hide", depth_bytes_of(size))?;
        let halving = |level| {
            let params = [HalvingParams {
                picture: size,
                level,
                unused: 0,
            }];
            filled(gpu, "level of depths", wgpu::BufferUsages::UNIFORM, &params)
        };
        self.levels = (1..=levels(size)).map(halving).collect();
        self.size = size;
        self.is_there = false;
        Ok(())
    }

    /// Records what makes the depths of a picture whose pixels have `drawn` ones.
    pub(crate) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        drawn: &wgpu::TextureView,
    ) {
        let dispatches = self.levels.iter().zip(1..).map(|(params, level)| {
            let [first, further] = &self.passes;
            let mut bindings = vec![
                (0, params.as_entire_binding()),
                (1, self.depths.as_entire_binding()),
            ];
            if level == 1 {
                bindings.push((2, wgpu::BindingResource::TextureView(drawn)));
            }
            let pass = if level == 1 { first } else { further };
            pass.over(gpu, sides(self.size, level), WORKGROUP, &bindings)
        });
        let dispatches: Vec<Dispatch> = dispatches.collect();
        record(encoder, "halve_depths", None, &dispatches);
    }

    /// Records that the depths are from now on those of this view and these placements.
    pub(crate) fn take(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::Buffer,
        placements: &wgpu::Buffer,
    ) {
        encoder.copy_buffer_to_buffer(view, 0, &self.view, 0, view.size());
        let bytes = placements.size();
        encoder.copy_buffer_to_buffer(placements, 0, &self.placements, 0, bytes);
        self.is_there = true;
    }

    /// Bytes of GPU memory of the placements.
    pub(crate) fn table_bytes(&self) -> u64 {
        self.placements.size()
    }

    /// Bytes of GPU memory of the depths that are there.
    pub(crate) fn depth_bytes(&self) -> u64 {
        self.depths.size()
    }
}

/// Bytes of the depths of a picture of this size.
pub(crate) fn depth_bytes_of(size: [u32; 2]) -> u64 {
    4 * (1..=levels(size))
        .map(|level| texels(sides(size, level)))
        .sum::<u64>()
}

/// Number of levels of a picture, of which the coarsest is one depth.
pub(crate) fn levels(size: [u32; 2]) -> u32 {
    let side = size[0].max(size[1]).max(2);
    u32::BITS - (side - 1).leading_zeros()
}

/// Columns and rows of a level of a picture of this size.
pub(crate) fn sides(size: [u32; 2], level: u32) -> [u32; 2] {
    size.map(|side| side.div_ceil(1 << level))
}

fn texels([columns, rows]: [u32; 2]) -> u64 {
    u64::from(columns) * u64::from(rows)
}
