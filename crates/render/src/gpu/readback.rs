//! How does a result come back from the GPU?
//!
//! Through a buffer that the browser's event loop, or a blocking poll, maps when the GPU is done.

use crate::{error::RenderError, gpu::device::Gpu, image::RgbaImage};
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

/// A copy of a texture on its way; await it, or call [`Self::wait`] where blocking is allowed.
pub struct ReadBack {
    bytes: BytesBack,
    size: [u32; 2],
    bytes_per_row: u32,
}

/// The bytes of a buffer on their way; await it, or call [`Self::wait`] where blocking is allowed.
pub struct BytesBack {
    buffer: wgpu::Buffer,
    state: Arc<Mutex<State>>,
}

#[derive(Default)]
struct State {
    result: Option<Result<(), wgpu::BufferAsyncError>>,
    waker: Option<Waker>,
}

/// A copy of a texture that is recorded and not yet submitted.
pub(crate) struct PictureCopy {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    bytes_per_row: u32,
}

impl PictureCopy {
    /// Records the copy of an rgba8 texture.
    pub(crate) fn record(
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
    ) -> Self {
        let size = [texture.width(), texture.height()];
        let bytes_per_row = (size[0] * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = BytesBack::buffer(gpu, u64::from(bytes_per_row) * u64::from(size[1]));
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(bytes_per_row),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        Self {
            buffer,
            size,
            bytes_per_row,
        }
    }

    /// Asks for the picture, once the copy is submitted.
    pub(crate) fn map(self) -> ReadBack {
        ReadBack {
            bytes: BytesBack::map(self.buffer),
            size: self.size,
            bytes_per_row: self.bytes_per_row,
        }
    }
}

impl ReadBack {
    /// Blocks until the GPU is done.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(self, gpu: &Gpu) -> Result<RgbaImage, RenderError> {
        block_on(gpu, self)
    }

    fn rows(&self, bytes: &[u8]) -> RgbaImage {
        let mut pixels = Vec::with_capacity(self.size[0] as usize * self.size[1] as usize * 4);
        for row in bytes.chunks_exact(self.bytes_per_row as usize) {
            pixels.extend_from_slice(&row[..self.size[0] as usize * 4]);
        }
        RgbaImage {
            size: self.size,
            pixels,
        }
    }
}

/// Blocks until the GPU is done and what waits for it has its result.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn block_on<T>(
    gpu: &Gpu,
    waiting: impl Future<Output = Result<T, RenderError>>,
) -> Result<T, RenderError> {
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|reason| RenderError::ReadBack(reason.to_string()))?;
    pollster::block_on(waiting)
}

impl Future for ReadBack {
    type Output = Result<RgbaImage, RenderError>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        let bytes = Pin::new(&mut self.bytes).poll(context);
        bytes.map_ok(|bytes| self.rows(&bytes))
    }
}

impl BytesBack {
    /// A buffer of `size` bytes to copy to, before it is mapped.
    #[must_use]
    pub fn buffer(gpu: &Gpu, size: u64) -> wgpu::Buffer {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    /// Asks for all bytes of `buffer`, once the copy to it is submitted. When they have come the
    /// buffer can be copied to again.
    #[must_use]
    pub fn map(buffer: wgpu::Buffer) -> Self {
        let state = Arc::new(Mutex::new(State::default()));
        let told = Arc::clone(&state);
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            let mut state = told.lock().unwrap_or_else(PoisonError::into_inner);
            state.result = Some(result);
            if let Some(waker) = state.waker.take() {
                waker.wake();
            }
        });
        Self { buffer, state }
    }

    /// Blocks until the GPU is done.
    ///
    /// # Errors
    /// [`RenderError::ReadBack`] when the device does not return them.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(self, gpu: &Gpu) -> Result<Vec<u8>, RenderError> {
        block_on(gpu, self)
    }

    fn bytes(&self) -> Result<Vec<u8>, RenderError> {
        let mapped = self
            .buffer
            .get_mapped_range(..)
            .map_err(|reason| RenderError::ReadBack(reason.to_string()))?;
        let bytes = mapped.to_vec();
        drop(mapped);
        self.buffer.unmap();
        Ok(bytes)
    }
}

impl Future for BytesBack {
    type Output = Result<Vec<u8>, RenderError>;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        let result = {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.waker = Some(context.waker().clone());
            state.result.take()
        };
        match result {
            None => Poll::Pending,
            Some(Ok(())) => Poll::Ready(self.bytes()),
            Some(Err(reason)) => Poll::Ready(Err(RenderError::ReadBack(reason.to_string()))),
        }
    }
}
