//! How long does a saccade of an amplitude last, how fast is it, and where is it meanwhile?
//!
//! The main sequence (Bahill, Clark and Stark 1975), fitted on recordings at 1000 Hz of people who
//! looked at points.

use crate::units::{Radians, Seconds};

/// Duration in seconds: this plus this per degree.
const DURATION_S: [f64; 2] = [0.0153, 0.002_40];
/// Fastest speed in degrees per second, and the amplitude in degrees at which 63 % of it is
/// reached.
const PEAK: [f64; 2] = [534.0, 5.7];

/// How long a saccade lasts: 15.3 ms + 2.40 ms/°.
#[must_use]
pub fn saccade_duration(amplitude: Radians) -> Seconds {
    Seconds(DURATION_S[0] + DURATION_S[1] * amplitude.to_degrees())
}

/// Peak speed of a saccade in degrees per second: 534 (1 - exp(-amplitude / 5.7°)).
#[must_use]
pub fn saccade_peak_deg_per_s(amplitude: Radians) -> f64 {
    PEAK[0] * (1.0 - libm::exp(-amplitude.to_degrees() / PEAK[1]))
}

/// Share of the way that a saccade has come at a share of its duration (held to 0..1).
///
/// A mix of the minimum-acceleration and the minimum-jerk path (Flash and Hogan 1985) whose peak
/// speed is that of the main sequence: those two peak at 1.5 and 1.875 times the mean speed.
#[must_use]
pub fn saccade_way(amplitude: Radians, share: f64) -> f64 {
    let mean = amplitude.to_degrees() / saccade_duration(amplitude).0;
    let peaked = (saccade_peak_deg_per_s(amplitude) / mean - 1.5) / 0.375;
    let jerk = if peaked.is_finite() {
        peaked.clamp(0.0, 1.0)
    } else {
        0.0
    };
    let s = share.clamp(0.0, 1.0);
    let least_acceleration = s * s * (3.0 - 2.0 * s);
    let least_jerk = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    least_acceleration + (least_jerk - least_acceleration) * jerk
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_main_sequence_has_its_golden_durations_and_speeds() {
        let ms = |degrees| saccade_duration(Radians::from_degrees(degrees)).0 * 1e3;
        assert!((ms(10.0) - 39.3).abs() < 1e-9 && (ms(0.0) - 15.3).abs() < 1e-9);
        // 180°/s is the peak of a saccade of 2.4°.
        let peak = saccade_peak_deg_per_s(Radians::from_degrees(2.4));
        assert!((peak - 183.5).abs() < 0.1, "{peak}");
    }

    #[test]
    fn a_saccade_moves_one_way_and_peaks_where_the_main_sequence_says() {
        for degrees in [2.0, 5.0, 10.0, 20.0] {
            let amplitude = Radians::from_degrees(degrees);
            let length = saccade_duration(amplitude).0;
            let at = |k: u32| degrees * saccade_way(amplitude, f64::from(k) / 1000.0);
            let speeds: Vec<f64> = (0..1000)
                .map(|k| (at(k + 1) - at(k)) / (length / 1000.0))
                .collect();
            assert!(speeds.iter().all(|&speed| speed >= 0.0));
            let peak = speeds.iter().copied().fold(0.0, f64::max);
            let expected = saccade_peak_deg_per_s(amplitude);
            assert!(
                (peak / expected - 1.0).abs() < 0.002,
                "{peak} for {expected}"
            );
            assert_eq!((at(0), at(1000)), (0.0, degrees));
        }
        assert_eq!(saccade_way(Radians(0.0), 2.0), 1.0);
    }
}
