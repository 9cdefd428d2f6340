//! Which clusters are drawn, each where it stands?

use crate::error::RenderError;
use crate::gpu::buffers::{storage, written};
use crate::gpu::device::Gpu;
use crate::gpu::pool::most_bound;
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::readback::BytesBack;

/// Bytes of a cluster in a list: its first word and its placement.
const BYTES: u64 = 8;
/// Words of the GPU's drawing arguments, and of what is counted besides.
const ARGUMENT_WORDS: usize = 8;
/// Bytes of a word.
const WORD: u64 = 4;
/// Which words are the number of corners, the first of them, the number of clusters, and that of
/// those that an earlier go found.
const CORNERS: u64 = 0;
const FIRST_CORNER: u64 = 2;
const CLUSTERS: u64 = 5;
const FIRST_CLUSTER: u64 = 6;
/// Bytes of a triangle: of each corner which cluster and which of its vertices.
const TRIANGLE_BYTES: u64 = 12;

/// A list on the GPU: all clusters that may be seen, and those of them that a picture shows with
/// the corners of their triangles.
pub(crate) struct DrawList {
    candidates: wgpu::Buffer,
    shown: wgpu::Buffer,
    corners: wgpu::Buffer,
    /// Of the first go, and of the second.
    arguments: [wgpu::Buffer; 2],
    count: u32,
}

impl DrawList {
    /// An empty list.
    ///
    /// # Errors
    /// The device binds next to nothing.
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_SRC;
        let bytes = ARGUMENT_WORDS as u64 * WORD;
        let arguments = || written(gpu, "how much is drawn", bytes, usage);
        Ok(Self {
            candidates: storage(gpu, "clusters that may be seen", BYTES)?,
            shown: storage(gpu, "clusters that are seen", BYTES)?,
            corners: corner_buffer(gpu, TRIANGLE_BYTES)?,
            arguments: [arguments(), arguments()],
            count: 0,
        })
    }

    /// From now on these may be seen: the first word of each cluster and its placement. They have
    /// so many triangles together.
    ///
    /// # Errors
    /// More than the device binds.
    pub(crate) fn fill(
        &mut self,
        gpu: &Gpu,
        clusters: &[[u32; 2]],
        triangles: u64,
    ) -> Result<(), RenderError> {
        let bytes = clusters.len() as u64 * BYTES;
        if bytes > self.candidates.size() {
            let room = roomy(gpu, bytes);
            self.candidates = storage(gpu, "clusters that may be seen", room)?;
            self.shown = storage(gpu, "clusters that are seen", room)?;
        }
        let bytes = triangles * TRIANGLE_BYTES;
        if bytes > self.corners.size() {
            self.corners = corner_buffer(gpu, roomy(gpu, bytes))?;
        }
        self.count = clusters.len() as u32;
        let bytes = bytemuck::cast_slice(clusters);
        gpu.queue.write_buffer(&self.candidates, 0, bytes);
        Ok(())
    }

    /// Readies it for a picture: nothing is shown so far, once.
    pub(crate) fn begin(&self, gpu: &Gpu) {
        for (buffer, again) in self.arguments.iter().zip(0_u32..) {
            let arguments: [u32; ARGUMENT_WORDS] = [0, 1, 0, 0, 0, 0, 0, again];
            let bytes = bytemuck::cast_slice(&arguments);
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
    }

    /// Records that the second go adds to what the first found.
    pub(crate) fn go_on(&self, encoder: &mut wgpu::CommandEncoder) {
        let [first, second] = &self.arguments;
        for (from, to) in [(CORNERS, FIRST_CORNER), (CLUSTERS, FIRST_CLUSTER)] {
            encoder.copy_buffer_to_buffer(first, from * WORD, second, to * WORD, WORD);
        }
    }

    /// Those that may be seen, no more: a shader sees by its length how many there are.
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

    /// The corners of the triangles that a picture shows, as its indices.
    pub(crate) fn corners(&self) -> &wgpu::Buffer {
        &self.corners
    }

    /// How much a go draws, the first or the second, as `draw_indexed_indirect` reads it.
    pub(crate) fn arguments(&self, go: usize) -> &wgpu::Buffer {
        &self.arguments[go]
    }

    /// Number of clusters that each go of the last picture drew. Blocks.
    ///
    /// # Errors
    /// The device was lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn clusters_drawn(&self, gpu: &Gpu) -> Result<[u32; 2], RenderError> {
        let back = BytesBack::buffer(gpu, 2 * WORD);
        let mut encoder = gpu.encoder("clusters that were drawn");
        for (arguments, go) in self.arguments.iter().zip(0..) {
            let from = CLUSTERS * WORD;
            encoder.copy_buffer_to_buffer(arguments, from, &back, go * WORD, WORD);
        }
        gpu.submit(encoder);
        let bytes = BytesBack::map(back).wait(gpu)?;
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        Ok([0, 1].map(|go| counts.get(go).copied().unwrap_or_default()))
    }

    /// How many may be seen.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// Bytes of GPU memory.
    pub(crate) fn bytes(&self) -> u64 {
        let buffers = [&self.candidates, &self.shown, &self.corners];
        let arguments = self.arguments.iter();
        arguments.chain(buffers).map(wgpu::Buffer::size).sum()
    }
}

/// Room for `bytes` and some more, as far as the device binds it.
fn roomy(gpu: &Gpu, bytes: u64) -> u64 {
    bytes.max(bytes.next_power_of_two().min(most_bound(gpu)))
}

fn corner_buffer(gpu: &Gpu, bytes: u64) -> Result<wgpu::Buffer, RenderError> {
    let (what, most) = ("triangles that may be seen", most_bound(gpu));
    if bytes > most {
        return Err(RenderError::TooMuch { what, bytes, most });
    }
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDEX;
    Ok(written(gpu, what, bytes, usage))
}
