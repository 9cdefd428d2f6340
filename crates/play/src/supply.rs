//! Who brings what a session wants?

use foveal_core::session::decoder::Decoded;
use foveal_core::session::unit_states::Piece;
use std::time::Duration;

/// Fetches and decodes what a session wants.
pub trait Supply {
    /// From now on these are wanted, in this order, and nothing else.
    fn want(&mut self, pieces: &[Piece]);

    /// Waits until all that is wanted came, at most this long, or without limit; by default not at
    /// all.
    fn wait_for_all(&mut self, patience: Option<Duration>) {
        let _ = patience;
    }

    /// The next piece that came; waits for it at most this long, or without limit.
    fn next(&mut self, patience: Option<Duration>) -> Option<Decoded>;
}

/// Brings nothing by itself: the caller looks at what the session wants, and hands over what came
/// with [`Player::take`](crate::Player::take).
#[derive(Clone, Copy, Debug, Default)]
pub struct Outside;

impl Supply for Outside {
    fn want(&mut self, _pieces: &[Piece]) {}

    fn next(&mut self, _patience: Option<Duration>) -> Option<Decoded> {
        None
    }
}
