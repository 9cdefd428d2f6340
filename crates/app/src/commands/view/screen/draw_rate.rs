//! How many pictures a second does a window draw?

use foveal_core::units::Seconds;
use std::collections::VecDeque;

/// How much of the past counts, in seconds.
const WINDOW_S: f64 = 1.0;
/// Most pictures that are remembered.
const MOST: usize = 512;

/// When pictures were drawn lately.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawRate(VecDeque<f64>);

impl DrawRate {
    /// A picture was drawn.
    pub(crate) fn note(&mut self, at: Seconds) {
        if self.0.len() == MOST {
            self.0.pop_front();
        }
        self.0.push_back(at.0);
    }

    /// Pictures in the second before `now`.
    pub(crate) fn per_second(&self, now: Seconds) -> usize {
        let lately = |at: &&f64| now.0 - **at < WINDOW_S;
        self.0.iter().filter(lately).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_count_for_a_second() {
        let mut rate = DrawRate::default();
        (0..100).for_each(|k| rate.note(Seconds(f64::from(k) / 10.0)));
        assert_eq!(rate.per_second(Seconds(9.95)), 10);
        assert_eq!(rate.per_second(Seconds(20.0)), 0);
        (0..9999).for_each(|_| rate.note(Seconds(30.0)));
        assert_eq!(rate.per_second(Seconds(30.0)), MOST);
    }
}
