//! Which samples would a fixed speed call a saccade? The baseline of every claim.

use crate::gaze::sample::EyeEvent;
use crate::units::Seconds;
use crate::view::axes::angle_between;
use glam::DVec3;

/// Speed of a saccade by Chen et al. 2022 (Instant Reality), in degrees per second.
const SACCADE_DEG_PER_S: f64 = 180.0;

/// The rule of Chen et al. 2022 (Instant Reality): a saccade is a step from one sample to the next
/// at more than 180°/s. Kept as the baseline; [`super::SaccadeDetector`] is what is used.
#[derive(Clone, Copy, Debug, Default)]
pub struct FixedThreshold {
    before: Option<(Seconds, DVec3)>,
}

impl FixedThreshold {
    /// Says what the eye does at a sample.
    pub fn next(&mut self, time: Seconds, direction: DVec3, valid: bool) -> EyeEvent {
        if !valid || !direction.is_finite() {
            self.before = None;
            return EyeEvent::Blink;
        }
        let before = self.before.replace((time, direction));
        match before {
            Some((then, from)) if time.0 > then.0 => {
                let turned = angle_between(from, direction).to_degrees();
                if turned > SACCADE_DEG_PER_S * (time.0 - then.0) {
                    EyeEvent::Saccade
                } else {
                    EyeEvent::Fixation
                }
            }
            _ => EyeEvent::Fixation,
        }
    }
}
