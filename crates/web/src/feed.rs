//! How do tiles come from a page's fetches and decoders?

use foveal_core::session::playback::{Delivery, Feed, TileOfFrame};
use foveal_render::RenderError;

/// What is wanted, and what came.
#[derive(Debug, Default)]
pub(crate) struct WebFeed {
    wanted: Vec<TileOfFrame>,
    done: Vec<Delivery>,
    /// Counts the changes of what is wanted.
    pub(crate) version: u32,
}

impl WebFeed {
    /// What is wanted and did not come yet, in order.
    pub(crate) fn wanted(&self) -> &[TileOfFrame] {
        &self.wanted
    }

    /// Takes what was decoded, or is damaged.
    pub(crate) fn deliver(&mut self, delivery: Delivery) {
        let came = (delivery.tile, delivery.frame);
        self.wanted.retain(|wanted| *wanted != came);
        self.done.push(delivery);
    }
}

impl Feed for WebFeed {
    type Error = RenderError;

    fn want(&mut self, wanted: Vec<TileOfFrame>) {
        let done = |wanted: &TileOfFrame| {
            let mut done = self.done.iter();
            done.any(|done| (done.tile, done.frame) == *wanted)
        };
        let missing: Vec<TileOfFrame> = wanted.into_iter().filter(|w| !done(w)).collect();
        if missing != self.wanted {
            self.wanted = missing;
            self.version = self.version.wrapping_add(1);
        }
    }

    fn take(&mut self) -> Result<Vec<Delivery>, RenderError> {
        Ok(std::mem::take(&mut self.done))
    }
}
