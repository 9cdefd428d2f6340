//! Which clusters are drawn, each where it stands?

use crate::error::RenderError;
use crate::gpu::buffers::{storage, written};
use crate::gpu::device::Gpu;

/// Bytes of a cluster in a list: its first word and its placement.
const BYTES: u64 = 8;
/// Bytes of what tells the GPU how much to draw.
const ARGUMENT_BYTES: u64 = 16;

/// A list on the GPU: all clusters that may be seen, and those of them that a picture shows.
pub(crate) struct DrawList {
    candidates: wgpu::Buffer,
    shown: wgpu::Buffer,
    arguments: wgpu::Buffer,
    count: u32,
}

impl DrawList {
    /// An empty list.
    ///
    /// # Errors
    /// The device binds next to nothing.
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        Ok(Self {
            candidates: storage(gpu, "clusters that may be seen", BYTES)?,
            shown: storage(gpu, "clusters that are seen", BYTES)?,
            arguments: written(gpu, "how much is drawn", ARGUMENT_BYTES, usage),
            count: 0,
        })
    }

    /// From now on these may be seen: the first word of each cluster and its placement.
    ///
    /// # Errors
    /// More than the device binds.
    pub(crate) fn fill(&mut self, gpu: &Gpu, clusters: &[[u32; 2]]) -> Result<(), RenderError> {
        let bytes = clusters.len() as u64 * BYTES;
        if bytes > self.candidates.size() {
            let room = bytes.next_power_of_two();
            self.candidates = storage(gpu, "clusters that may be seen", room)?;
            self.shown = storage(gpu, "clusters that are seen", room)?;
        }
        self.count = clusters.len() as u32;
        let bytes = bytemuck::cast_slice(clusters);
        gpu.queue.write_buffer(&self.candidates, 0, bytes);
        Ok(())
    }

    /// Readies it for a picture of clusters of at most `triangles`, of which the first `shown` are
    /// shown so far.
    pub(crate) fn begin(&self, gpu: &Gpu, triangles: u32, shown: u32) {
        let arguments = [3 * triangles, shown, 0, 0];
        let bytes = bytemuck::cast_slice(&arguments);
        gpu.queue.write_buffer(&self.arguments, 0, bytes);
    }

    /// Those that may be seen, no more: a shader tells by its length how many there are.
    pub(crate) fn candidates(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.candidates,
            offset: 0,
            size: wgpu::BufferSize::new(u64::from(self.count.max(1)) * BYTES),
        })
    }

    /// Those that a picture shows.
    pub(crate) fn shown(&self) -> &wgpu::Buffer {
        &self.shown
    }

    /// How much is drawn, as `draw_indirect` reads it.
    pub(crate) fn arguments(&self) -> &wgpu::Buffer {
        &self.arguments
    }

    /// How many may be seen.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// Bytes of GPU memory.
    pub(crate) fn bytes(&self) -> u64 {
        self.candidates.size() + self.shown.size() + self.arguments.size()
    }
}
