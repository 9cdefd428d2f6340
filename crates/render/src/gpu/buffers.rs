//! How are the buffers made that passes read and write?

use crate::error::RenderError;
use crate::gpu::device::Gpu;

/// A buffer of `bytes`, filled with zeros, that is written from the CPU.
pub(crate) fn written(
    gpu: &Gpu,
    label: &'static str,
    bytes: u64,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A storage buffer of `bytes`, at least 8, filled with zeros; it can be copied from and to.
///
/// # Errors
/// [`RenderError::TooMuch`] when the device cannot bind that many bytes,
/// [`RenderError::OutOfMemory`] when its memory has no room for them.
pub fn storage(gpu: &Gpu, what: &'static str, bytes: u64) -> Result<wgpu::Buffer, RenderError> {
    let limits = gpu.device.limits();
    let most = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size);
    if bytes > most {
        return Err(RenderError::TooMuch { what, bytes, most });
    }
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    gpu.roomed((what, bytes), |_| written(gpu, what, bytes.max(8), usage))
}

/// A buffer for `usage` that holds the bytes of `values`, no more; it can be rewritten.
pub fn filled<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    what: &'static str,
    usage: wgpu::BufferUsages,
    values: &[T],
) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    let buffer = written(gpu, what, bytes.len() as u64, usage);
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}
