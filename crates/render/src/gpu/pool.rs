//! How does a buffer of the GPU grow with what lies in it?

use crate::error::RenderError;
use crate::gpu::arena::Arena;
use crate::gpu::buffers::storage;
use crate::gpu::device::Gpu;

/// Places of a new pool.
const FIRST_PLACES: u32 = 1 << 14;

/// A storage buffer of places of some words each.
pub(crate) struct Pool {
    label: &'static str,
    buffer: wgpu::Buffer,
    arena: Arena,
    place_bytes: u64,
}

impl Pool {
    /// A pool of places of `place_bytes` each, a few or `places` of them.
    ///
    /// # Errors
    /// The device cannot bind as many.
    pub(crate) fn new(
        gpu: &Gpu,
        label: &'static str,
        place_bytes: u64,
        places: Option<u32>,
    ) -> Result<Self, RenderError> {
        let places = places.unwrap_or(FIRST_PLACES);
        Ok(Self {
            label,
            buffer: storage(gpu, label, u64::from(places) * place_bytes)?,
            arena: Arena::new(places),
            place_bytes,
        })
    }

    /// All places.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Bytes of all places, in use or not.
    pub(crate) fn bytes(&self) -> u64 {
        self.buffer.size()
    }

    /// Whether `count` places in a row are free.
    pub(crate) fn has_place(&self, count: u32) -> bool {
        self.arena.has_place(count)
    }

    /// Number of places that are free.
    pub(crate) fn free(&self) -> u32 {
        self.arena.free()
    }

    /// Takes `count` places in a row; grows to at most `most_bytes` where there are none. `None`
    /// where that is not enough.
    pub(crate) fn take(&mut self, gpu: &Gpu, count: u32, most_bytes: u64) -> Option<u32> {
        if let Some(start) = self.arena.take(count) {
            return Some(start);
        }
        let most_bytes = most_bytes.min(most_bound(gpu));
        let most = u32::try_from(most_bytes / self.place_bytes).unwrap_or(u32::MAX);
        let length = self.arena.length();
        let doubled = length.saturating_mul(2);
        let wanted = doubled.max(length.saturating_add(count)).min(most);
        if wanted < length.saturating_add(count) {
            return None;
        }
        self.grow(gpu, wanted).ok()?;
        self.arena.take(count)
    }

    fn grow(&mut self, gpu: &Gpu, places: u32) -> Result<(), RenderError> {
        let larger = storage(gpu, self.label, u64::from(places) * self.place_bytes)?;
        let mut encoder = gpu.encoder("larger pool");
        encoder.copy_buffer_to_buffer(&self.buffer, 0, &larger, 0, self.buffer.size());
        gpu.submit(encoder);
        self.buffer = larger;
        self.arena.grow(places);
        Ok(())
    }

    /// Gives back what [`Self::take`] gave.
    pub(crate) fn give_back(&mut self, start: u32, count: u32) {
        self.arena.give_back(start, count);
    }

    /// Writes words from a place on.
    pub(crate) fn write(&self, gpu: &Gpu, start: u32, words: &[u32]) {
        let at = u64::from(start) * self.place_bytes;
        gpu.queue
            .write_buffer(&self.buffer, at, bytemuck::cast_slice(words));
    }
}

/// Bytes that the device binds at most, in whole places: drivers report odd numbers.
pub(crate) fn most_bound(gpu: &Gpu) -> u64 {
    const PLACES: u64 = 256;
    let limits = gpu.device.limits();
    let most = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size);
    most - most % PLACES
}
