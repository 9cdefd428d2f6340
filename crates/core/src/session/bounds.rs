//! How many bytes may a session have under way, waiting, on the GPU and in main memory?

/// Default: more than a frame of the largest content that a pack can hold,
/// twelve faces of 65,536 x 65,536 samples in all levels, which is 104 GB. One frame at a time is
/// fetched, one waits, one is shown. A caller that knows the device can set less, as a page does.
const MORE_THAN_A_FRAME: u64 = 128 << 30;

/// Default of what a client holds in main memory: as much as a page holds of a file.
pub const CLIENT_BYTES: u64 = 256 << 20;

/// What a session keeps below. The coarsest level is fetched, kept and shown whatever it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Bytes of what is to be fetched at once; one piece is always fetched.
    pub in_flight: u64,
    /// Bytes, as they will be on the GPU, of what is decoded and waits to be shown, and of what is
    /// fetched to wait there. What has no room is fetched once the frame is shown, if it stays.
    pub cached: u64,
    /// Bytes on the GPU of what is shown, and of what stays there. What would not fit next to what
    /// matters more is not chosen. While one frame takes the place of another, both are there.
    pub gpu: u64,
    /// Bytes of units, as they were fetched, that stay in main memory. What is chosen stays
    /// whatever it takes.
    pub client: u64,
}

impl Default for Bounds {
    fn default() -> Self {
        Self {
            in_flight: MORE_THAN_A_FRAME,
            cached: MORE_THAN_A_FRAME,
            gpu: MORE_THAN_A_FRAME,
            client: CLIENT_BYTES,
        }
    }
}
