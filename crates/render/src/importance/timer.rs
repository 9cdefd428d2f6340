//! How long do the passes take on the GPU?

use crate::gpu::device::Gpu;

/// Time stamps before and after a compute pass.
pub(super) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Nanoseconds of one count.
    pub(super) tick: f32,
}

impl Timer {
    /// Bytes of both time stamps.
    pub(super) const BYTES: u64 = 16;

    /// Time stamps, where the device has them.
    pub(super) fn new(gpu: &Gpu) -> Option<Self> {
        let features = gpu.device.features();
        features
            .contains(wgpu::Features::TIMESTAMP_QUERY)
            .then(|| Self {
                queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("begin and end"),
                    ty: wgpu::QueryType::Timestamp,
                    count: 2,
                }),
                resolved: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("begin and end"),
                    size: Self::BYTES,
                    usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                }),
                tick: gpu.queue.get_timestamp_period(),
            })
    }

    /// Stamps the begin and the end of a pass.
    pub(super) fn around(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Orders the copy of both to a place in `to`.
    pub(super) fn copy(&self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::Buffer, at: u64) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, to, at, Self::BYTES);
    }
}
