//! How long do passes take by the device's own clock?

use crate::gpu::device::Gpu;
use std::time::Duration;

/// Time stamps before the first and after the last of the passes that are recorded with it.
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    tick: Tick,
}

/// How long one count of a device's clock is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    nanoseconds: f32,
}

impl Timer {
    /// Bytes of both time stamps.
    pub const BYTES: u64 = 16;

    /// Time stamps, where the device has them: `None` where it lacks `TIMESTAMP_QUERY`.
    #[must_use]
    pub fn new(gpu: &Gpu) -> Option<Self> {
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
                tick: Tick {
                    nanoseconds: gpu.queue.get_timestamp_period(),
                },
            })
    }

    /// Stamps the begin and the end of a pass.
    pub(crate) fn around(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// The same of a pass that draws.
    pub(crate) fn around_drawing(&self) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Records the copy of both stamps, [`Self::BYTES`] bytes, to the byte `at` of `to`.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::Buffer, at: u64) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, to, at, Self::BYTES);
    }

    /// What turns stamps that came back into a time.
    #[must_use]
    pub fn tick(&self) -> Tick {
        self.tick
    }
}

impl Tick {
    /// The time between the two stamps that [`Timer::copy`] left, which are the first bytes of
    /// `stamps`; `None` where those are fewer than [`Timer::BYTES`].
    #[must_use]
    pub fn between(self, stamps: &[u8]) -> Option<Duration> {
        let stamp = |at: usize| Some(u64::from_le_bytes(stamps.get(at..at + 8)?.try_into().ok()?));
        let counts = stamp(8)?.saturating_sub(stamp(0)?);
        let nanoseconds = counts as f64 * f64::from(self.nanoseconds);
        Some(Duration::from_nanos(nanoseconds as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_counts_by_ticks_and_needs_both_stamps() {
        let tick = Tick { nanoseconds: 2.5 };
        let stamps = [100_u64.to_le_bytes(), 104_u64.to_le_bytes()].concat();
        assert_eq!(tick.between(&stamps), Some(Duration::from_nanos(10)));
        assert_eq!(tick.between(&stamps[..15]), None);
        let backwards = [9_u64.to_le_bytes(), 7_u64.to_le_bytes()].concat();
        assert_eq!(tick.between(&backwards), Some(Duration::ZERO));
    }
}
