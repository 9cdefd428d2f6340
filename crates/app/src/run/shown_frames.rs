//! Which frame of the content does each picture of a run show, and when?

use foveal_core::units::Seconds;
use foveal_play::FramePlayer;

/// The pictures of a run: frame after frame, from the beginning again where that was the last; a
/// still is the same frame all along.
pub(crate) struct ShownFrames {
    /// First frame.
    start: u32,
    /// Frames of the content, at least one.
    there: u32,
    /// Time from one picture to the next, of a still.
    interval: Seconds,
}

impl ShownFrames {
    /// Of content with so many frames, from `start` on; of one frame, a picture every `interval`.
    pub(crate) fn new(there: u32, start: u32, interval: Seconds) -> Self {
        Self {
            start,
            there: there.max(1),
            interval,
        }
    }

    /// The frame of a picture, by its number from 0.
    pub(crate) fn frame(&self, picture: u32) -> u32 {
        ((u64::from(self.start) + u64::from(picture)) % u64::from(self.there)) as u32
    }

    /// When a picture is shown, in time that goes on through all rounds.
    pub(crate) fn time(&self, picture: u32, player: &FramePlayer) -> Seconds {
        if self.there == 1 {
            return Seconds(self.interval.0 * f64::from(picture));
        }
        let round = (u64::from(self.start) + u64::from(picture)) / u64::from(self.there);
        let within = player.time(self.frame(picture));
        Seconds(player.length().0 * round as f64 + within.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_follow_each_other_and_begin_anew_after_the_last() {
        let shown = ShownFrames::new(5, 3, Seconds(1.0));
        let frames: Vec<u32> = (0..6).map(|picture| shown.frame(picture)).collect();
        assert_eq!(frames, [3, 4, 0, 1, 2, 3]);
        assert_eq!(ShownFrames::new(1, 0, Seconds(1.0)).frame(u32::MAX), 0);
    }
}
