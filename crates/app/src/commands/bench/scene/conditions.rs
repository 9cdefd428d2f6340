//! What are all rows measured under?

use foveal_render::DrawDevice;

/// What all rows are measured under.
pub(super) struct BenchConditions {
    /// Turns of what is timed.
    pub(super) runs: usize,
    /// What draws the pictures.
    pub(super) drawing: DrawDevice,
}
