//! Who decodes, and on how many threads?

use foveal_media::MediaError;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::decode_pool::DecodePool;
use foveal_media::tiles::decoders::DecoderChoice;
use std::sync::Arc;

/// How a pack is decoded.
#[derive(Clone, Copy, Debug)]
pub struct Decoding {
    /// Decoding threads.
    pub jobs: usize,
    /// The processor or a graphics device.
    pub choice: DecoderChoice,
}

impl Decoding {
    /// By the processor, on all cores.
    #[must_use]
    pub fn software() -> Self {
        let cores = std::thread::available_parallelism();
        Self {
            jobs: cores.map_or(1, usize::from),
            choice: DecoderChoice::Software,
        }
    }

    /// The decoders of a pack.
    pub(crate) fn pool(self, file: Arc<PackFile>) -> Result<DecodePool, MediaError> {
        DecodePool::choosing(file, self.jobs, self.choice)
    }
}
