//! How long do the passes of a frame take by the device's own clock?

use std::time::Duration;

/// Time stamps before and after the passes of a frame.
pub(super) struct Stamps {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Nanoseconds of one count.
    tick: f32,
}

impl Stamps {
    /// Bytes of both.
    pub(super) const BYTES: u64 = 16;

    /// Time stamps, where the device has them.
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        let has_them = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        has_them.then(|| Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("begin and end"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("begin and end"),
                size: Self::BYTES,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            tick: queue.get_timestamp_period(),
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

    /// What passed between them.
    pub(super) fn between(&self, bytes: &[u8]) -> Option<Duration> {
        let stamp = |at: usize| Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?));
        let counts = stamp(8)?.saturating_sub(stamp(0)?);
        Some(Duration::from_nanos(
            (counts as f64 * f64::from(self.tick)) as u64,
        ))
    }
}
