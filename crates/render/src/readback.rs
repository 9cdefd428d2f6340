//! How does a picture come back from the GPU?
//!
//! Through a buffer that the browser's event loop, or a blocking poll, maps when the GPU is done.

use crate::{device::Gpu, error::RenderError, image::RgbaImage};
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

/// A copy of a texture on its way; await it, or call [`Self::wait`] where blocking is allowed.
pub struct ReadBack {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    bytes_per_row: u32,
    state: Arc<Mutex<State>>,
}

#[derive(Default)]
struct State {
    result: Option<Result<(), wgpu::BufferAsyncError>>,
    waker: Option<Waker>,
}

impl ReadBack {
    /// Orders the copy of an rgba8 texture.
    pub(crate) fn start(gpu: &Gpu, texture: &wgpu::Texture) -> Self {
        let size = [texture.width(), texture.height()];
        let bytes_per_row = (size[0] * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: u64::from(bytes_per_row) * u64::from(size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
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
        gpu.queue.submit([encoder.finish()]);
        let state = Arc::new(Mutex::new(State::default()));
        let told = Arc::clone(&state);
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            let mut state = told.lock().unwrap_or_else(PoisonError::into_inner);
            state.result = Some(result);
            if let Some(waker) = state.waker.take() {
                waker.wake();
            }
        });
        Self {
            buffer,
            size,
            bytes_per_row,
            state,
        }
    }

    /// Blocks until the GPU is done.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(self, gpu: &Gpu) -> Result<RgbaImage, RenderError> {
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|reason| RenderError::ReadBack(reason.to_string()))?;
        pollster::block_on(self)
    }

    fn rows(&self) -> Result<RgbaImage, RenderError> {
        let mapped = self
            .buffer
            .get_mapped_range(..)
            .map_err(|reason| RenderError::ReadBack(reason.to_string()))?;
        let mut pixels = Vec::with_capacity(self.size[0] as usize * self.size[1] as usize * 4);
        for row in mapped.chunks_exact(self.bytes_per_row as usize) {
            pixels.extend_from_slice(&row[..self.size[0] as usize * 4]);
        }
        drop(mapped);
        self.buffer.unmap();
        Ok(RgbaImage {
            size: self.size,
            pixels,
        })
    }
}

impl Future for ReadBack {
    type Output = Result<RgbaImage, RenderError>;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        let result = {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.waker = Some(context.waker().clone());
            state.result.take()
        };
        match result {
            None => Poll::Pending,
            Some(Ok(())) => Poll::Ready(self.rows()),
            Some(Err(reason)) => Poll::Ready(Err(RenderError::ReadBack(reason.to_string()))),
        }
    }
}
