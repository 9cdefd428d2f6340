//! How many bytes may a session have under way, waiting and on the GPU?

/// The most bytes that anything may take where nobody asks for less: more than a frame of the
/// largest content that a pack can hold, twelve faces of 65,536 x 65,536 samples in all levels,
/// which is 104 GB. Whoever knows the device can set less, as a page does.
const MOST_OF_A_FRAME: u64 = 128 << 30;
/// Most bytes in flight: what is asked for is of one frame, and is coded.
pub const MOST_IN_FLIGHT: u64 = MOST_OF_A_FRAME;
/// Most bytes decoded and waiting: only one frame at a time is prepared.
pub const MOST_CACHED: u64 = MOST_OF_A_FRAME;
/// Most bytes on the GPU: only one frame is shown.
pub const MOST_ON_GPU: u64 = MOST_OF_A_FRAME;

/// What a session keeps below. The coarsest level is fetched, kept and shown whatever it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Bytes of what is to be fetched at once; one piece is always fetched.
    pub in_flight: u64,
    /// Bytes, as they will be on the GPU, of what is decoded and waits to be shown, and of what is
    /// fetched to wait there. What has no room is fetched once the frame is shown, if it stays.
    pub cached: u64,
    /// Bytes on the GPU of what is shown. What would not fit beside what matters more is not
    /// chosen. While one frame takes the place of another, both are there.
    pub gpu: u64,
}

impl Default for Bounds {
    fn default() -> Self {
        Self {
            in_flight: MOST_IN_FLIGHT,
            cached: MOST_CACHED,
            gpu: MOST_ON_GPU,
        }
    }
}
