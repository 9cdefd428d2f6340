//! How do whole numbers on the GPU become values of units?

use super::pictures::UnitIds;
use crate::error::RenderError;
use crate::gpu::readback::BytesBack;
use crate::gpu::timer::Tick;
use std::future::Future;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

/// What steps are worth to units.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitGains {
    /// Value of every unit and step: `[step][unit]`, step i from level i + 1 to level i.
    pub per_step: Vec<Vec<f64>>,
    /// How long the passes took on the GPU, where the adapter reports it.
    pub gpu_time: Option<Duration>,
}

/// Where the sums of every step lie in their buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SumsShape {
    pub(super) steps: usize,
    pub(super) units: usize,
    /// Bytes from one step to the next, as bindings are aligned.
    pub(super) stride: u64,
}

impl SumsShape {
    pub(super) fn new(gpu: &crate::gpu::device::Gpu, steps: usize, ids: &UnitIds) -> Self {
        let alignment = u64::from(gpu.device.limits().min_storage_buffer_offset_alignment);
        let mut shape = Self {
            steps,
            units: ids.units,
            stride: 0,
        };
        shape.stride = shape.step_bytes().next_multiple_of(alignment);
        shape
    }

    /// Bytes of one step: two words a unit, and two that count pixels of no such unit.
    pub(super) fn step_bytes(&self) -> u64 {
        (self.units as u64 + 1) * 8
    }

    /// Bytes of all steps.
    pub(super) fn bytes(&self) -> u64 {
        self.steps as u64 * self.stride
    }
}

/// Values on their way back; await it, or call [`Self::wait`] where blocking is allowed.
pub struct PendingGains {
    pub(super) bytes: BytesBack,
    pub(super) shape: SumsShape,
    pub(super) quantum: f64,
    /// What times the time stamps behind the sums, where there are any.
    pub(super) tick: Option<Tick>,
}

impl PendingGains {
    /// Blocks until the GPU is done.
    ///
    /// # Errors
    /// When the GPU returns nothing, or a pixel has the id of no unit.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(self, gpu: &crate::gpu::device::Gpu) -> Result<UnitGains, RenderError> {
        crate::gpu::readback::block_on(gpu, self)
    }

    fn gains(&self, bytes: &[u8]) -> Result<UnitGains, RenderError> {
        let (sums, times) = bytes.split_at(self.shape.bytes() as usize);
        let steps = sums.chunks_exact(self.shape.stride as usize);
        Ok(UnitGains {
            per_step: steps
                .map(|step| self.step(step))
                .collect::<Result<_, _>>()?,
            gpu_time: self.tick.and_then(|tick| tick.between(times)),
        })
    }

    fn step(&self, bytes: &[u8]) -> Result<Vec<f64>, RenderError> {
        let units = self.shape.units;
        let mut sums = eights(bytes).map(i64::from_le_bytes);
        let gains = sums.by_ref().take(units);
        let gains = gains.map(|sum| sum as f64 * self.quantum).collect();
        match sums.next() {
            Some(runs) if runs != 0 => Err(RenderError::StrayUnits {
                units,
                runs: runs as u32,
            }),
            _ => Ok(gains),
        }
    }
}

fn eights(bytes: &[u8]) -> impl Iterator<Item = [u8; 8]> + '_ {
    bytes
        .chunks_exact(8)
        .map(|chunk| core::array::from_fn(|k| chunk[k]))
}

impl Future for PendingGains {
    type Output = Result<UnitGains, RenderError>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        match Pin::new(&mut self.bytes).poll(context) {
            Poll::Pending => Poll::Pending,
            Poll::Ready(Err(error)) => Poll::Ready(Err(error)),
            Poll::Ready(Ok(bytes)) => Poll::Ready(self.gains(&bytes)),
        }
    }
}
