//! May the signal be trusted, or is the eye closed, lost, or only just back?
//!
//! Trackers call samples valid while lids still cover the pupil: for some 30 ms before a loss and
//! 60–100 ms after it.

use crate::gaze::sample::EyeEvent;
use crate::units::Seconds;

/// A dropout up to this long is bridged: shorter than any blink, a sample or two of a headset's
/// tracker is not. In seconds.
const BRIDGED_S: f64 = 0.012;
/// No blink lasts longer, in seconds: the eye is lost.
const LONGEST_BLINK_S: f64 = 0.5;
/// Two valid samples further apart than this are a loss between them, in seconds.
const LARGEST_GAP_S: f64 = 0.1;

/// What is known of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Signal {
    /// To be used.
    Good,
    /// Missing, but for so short that what was still is.
    Bridged,
    /// Missing: a blink, or lost.
    Lost(EyeEvent),
    /// There again, not to be trusted yet.
    Returning,
}

/// Watches for losses.
#[derive(Clone, Debug)]
pub(super) struct LossGuard {
    length: f64,
    seen: Option<f64>,
    lost: bool,
    until: f64,
}

impl LossGuard {
    /// A guard that distrusts the signal for `length` after a loss.
    pub(super) fn new(length: Seconds) -> Self {
        Self {
            length: length.0,
            seen: None,
            lost: false,
            until: f64::NEG_INFINITY,
        }
    }

    /// Counts a sample as a loss that ends at `time`.
    pub(super) fn distrust(&mut self, time: Seconds) {
        self.until = time.0 + self.length;
    }

    /// Judges the next sample; times must grow.
    pub(super) fn next(&mut self, time: Seconds, valid: bool) -> Signal {
        let missing = self.seen.map_or(f64::INFINITY, |seen| time.0 - seen);
        if !valid {
            return self.miss(missing);
        }
        if self.seen.is_some() && (self.lost || missing > LARGEST_GAP_S) {
            self.distrust(time);
        }
        self.lost = false;
        self.seen = Some(time.0);
        if time.0 < self.until {
            Signal::Returning
        } else {
            Signal::Good
        }
    }

    fn miss(&mut self, missing: f64) -> Signal {
        if missing <= BRIDGED_S && !self.lost {
            return Signal::Bridged;
        }
        self.lost = true;
        Signal::Lost(if missing <= LONGEST_BLINK_S {
            EyeEvent::Blink
        } else {
            EyeEvent::Lost
        })
    }
}
