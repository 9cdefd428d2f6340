//! Does the detector say what an eye does, at every rate, whatever comes in?

use super::*;
use crate::gaze::main_sequence::{saccade_duration, saccade_peak_deg_per_s, saccade_way};
use crate::view::axes::direction_from_yaw_pitch;
use crate::view::random::Random;

fn toward(yaw_deg: f64, pitch_deg: f64) -> DVec3 {
    direction_from_yaw_pitch(
        Radians::from_degrees(yaw_deg),
        Radians::from_degrees(pitch_deg),
    )
}

/// Yaw in degrees of an eye that makes a saccade of `size` at 0.5 s.
fn jump(size: f64, time: f64) -> f64 {
    let amplitude = Radians::from_degrees(size.abs());
    size * saccade_way(amplitude, (time - 0.5) / saccade_duration(amplitude).0)
}

/// What is said of a second of an eye that looks to `yaw(time)`, with noise, at a rate.
fn watch(rate: f64, noise_deg: f64, yaw: impl Fn(f64) -> f64) -> Vec<(f64, Detection)> {
    let mut random = Random::new(11);
    let mut detector = SaccadeDetector::default();
    let times = (0..rate as u32).map(|k| f64::from(k) / rate);
    let mut noise = move || noise_deg * (random.unit() + random.unit() - 1.0);
    times
        .map(|t| {
            (
                t,
                detector.next(Seconds(t), toward(yaw(t) + noise(), noise()), true),
            )
        })
        .collect()
}

fn events(said: &[(f64, Detection)]) -> Vec<(f64, f64)> {
    let jumping = |s: &(f64, Detection)| s.1.event == EyeEvent::Saccade;
    said.chunk_by(|a, b| jumping(a) == jumping(b))
        .filter(|run| jumping(&run[0]))
        .map(|run| (run[0].0, run[run.len() - 1].0))
        .collect()
}

#[test]
fn one_saccade_is_one_event_at_every_rate() {
    for rate in [60.0, 72.0, 90.0, 120.0, 200.0, 250.0, 500.0, 1000.0] {
        for size in [4.0, 8.0, -12.0, 20.0] {
            let said = watch(rate, 0.03, |t| jump(size, t));
            let found = events(&said);
            assert_eq!(found.len(), 1, "{size} deg at {rate} Hz: {found:?}");
            let lag_ms = (found[0].0 - 0.5) * 1e3;
            assert!(
                lag_ms > 0.0 && lag_ms < 11.0 + 1.5e3 / rate,
                "{lag_ms} at {rate} Hz"
            );
            let end = 0.5 + saccade_duration(Radians::from_degrees(size.abs())).0;
            assert!(
                (found[0].1 - end).abs() < 0.010 + 1.5 / rate,
                "{found:?} for {end}"
            );
        }
    }
}

#[test]
fn left_and_right_are_alike() {
    let right = watch(500.0, 0.0, |t| jump(7.0, t));
    let left = watch(500.0, 0.0, |t| jump(-7.0, t));
    let event = |said: &[(f64, Detection)]| said.iter().map(|s| s.1.event).collect::<Vec<_>>();
    assert_eq!(event(&right), event(&left));
}

#[test]
fn noise_drift_and_pursuit_are_no_saccades() {
    for rate in [120.0, 500.0, 1000.0] {
        for noise in [0.01, 0.05, 0.1] {
            for speed in [0.0, 5.0, 15.0] {
                let found = events(&watch(rate, noise, |t| speed * t));
                assert!(
                    found.is_empty(),
                    "{noise} deg, {speed} deg/s, {rate} Hz: {found:?}"
                );
            }
        }
    }
}

#[test]
fn a_saccade_out_of_pursuit_is_seen() {
    let found = events(&watch(500.0, 0.05, |t| 15.0 * t + jump(3.0, t)));
    assert_eq!(found.len(), 1, "{found:?}");
}

#[test]
fn the_swing_after_landing_is_not_part_of_a_saccade_nor_one_of_its_own() {
    let swinging = |t: f64| {
        let end = 0.5 + saccade_duration(Radians::from_degrees(10.0)).0;
        let since = (t - end).max(0.0);
        let swing = (-since / 0.012).exp() * (2.0 * std::f64::consts::PI * 22.0 * since).sin();
        jump(10.0, t) + 0.6 * swing
    };
    for rate in [250.0, 500.0, 1000.0] {
        let found = events(&watch(rate, 0.01, swinging));
        assert_eq!(found.len(), 1, "{found:?} at {rate} Hz");
        assert!(found[0].1 < 0.5393 + 0.013, "{found:?} at {rate} Hz");
    }
}

#[test]
fn a_saccade_says_when_and_where_it_began_and_how_fast_it_is() {
    let said = watch(1000.0, 0.0, |t| jump(10.0, t));
    let runs: Vec<_> = said.iter().filter_map(|s| s.1.saccade).collect();
    assert!((runs[0].onset.0 - 0.5).abs() < 0.005, "{:?}", runs[0]);
    assert!((runs[0].from - toward(0.0, 0.0)).length() < 0.005);
    let peak = runs[runs.len() - 1].peak_deg_per_s;
    let expected = saccade_peak_deg_per_s(Radians::from_degrees(10.0));
    assert!(
        peak < expected && peak > 0.95 * expected,
        "{peak} through the window"
    );
    assert!(
        runs.windows(2)
            .all(|p| p[0].onset == p[1].onset && p[0].found == p[1].found)
    );
}

#[test]
fn nothing_is_said_of_samples_to_come() {
    let yaw = |t: f64| jump(9.0, t);
    let whole = watch(500.0, 0.05, yaw);
    let changed = watch(500.0, 0.05, |t| if t < 0.52 { yaw(t) } else { -80.0 });
    let cut = whole.iter().filter(|s| s.0 < 0.52).count();
    assert_eq!(whole[..cut], changed[..cut]);
}

#[test]
fn a_closed_eye_blinks_then_is_lost_and_is_not_trusted_for_100_ms_after() {
    let mut detector = SaccadeDetector::default();
    let mut said = Vec::new();
    for k in 0..2000 {
        let time = f64::from(k) * 1e-3;
        let open = !(0.5..1.3).contains(&time);
        // The lid drags the gaze for 80 ms after the eye is seen again.
        let drag = if (1.3..1.38).contains(&time) {
            200.0 * (1.38 - time)
        } else {
            0.0
        };
        said.push(detector.next(Seconds(time), toward(0.0, -drag), open).event);
    }
    assert_eq!(
        said[505],
        EyeEvent::Fixation,
        "a dropout of some milliseconds is bridged"
    );
    assert_eq!(said[520], EyeEvent::Blink);
    assert_eq!(said[990], EyeEvent::Blink);
    assert_eq!(said[1010], EyeEvent::Lost);
    assert_eq!(said[1301], EyeEvent::Blink);
    assert_eq!(said[1395], EyeEvent::Blink);
    assert_eq!(said[1405], EyeEvent::Fixation);
    assert!(!said.contains(&EyeEvent::Saccade));
}

#[test]
fn a_gap_in_time_is_a_loss_and_not_a_saccade() {
    let mut detector = SaccadeDetector::default();
    for k in 0..200 {
        detector.next(Seconds(f64::from(k) * 0.002), toward(0.0, 0.0), true);
    }
    let back = detector.next(Seconds(2.0), toward(15.0, 0.0), true);
    assert_eq!(back.event, EyeEvent::Blink);
    for k in 1..200 {
        let said = detector.next(Seconds(2.0 + f64::from(k) * 0.002), toward(15.0, 0.0), true);
        assert_ne!(said.event, EyeEvent::Saccade);
    }
    assert_eq!(
        detector.next(Seconds(3.0), toward(15.0, 0.0), false).event,
        EyeEvent::Lost
    );
}

#[test]
fn a_speed_that_no_eye_has_is_a_loss() {
    let said = watch(500.0, 0.0, |t| if t < 0.5 { 0.0 } else { 40.0 });
    assert!(
        said.iter()
            .filter(|s| s.1.event == EyeEvent::Saccade)
            .count()
            <= 1
    );
    assert_eq!(said[255].1.event, EyeEvent::Blink);
}

#[test]
fn bad_times_and_directions_change_nothing_for_the_worse() {
    let mut detector = SaccadeDetector::default();
    let mut random = Random::new(4);
    let mut time = 0.0;
    for k in 0..20_000 {
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e300, time];
        let wild = [
            DVec3::NAN,
            DVec3::ZERO,
            DVec3::splat(1e200),
            DVec3::X * f64::INFINITY,
        ];
        if k % 3 == 0 {
            let before = detector.last;
            let said = detector.next(Seconds(bad[k % 5]), toward(9.0, 0.0), true);
            assert!(said == before || bad[k % 5] == time && k == 0);
        }
        time += 0.004 * random.unit();
        let direction = if k % 7 == 0 {
            wild[k % 4]
        } else {
            toward(random.unit(), 0.0)
        };
        let said = detector.next(Seconds(time), direction, true);
        assert!(
            said.saccade
                .is_none_or(|s| s.speed_deg_per_s.is_finite() && s.at.is_finite())
        );
    }
}

#[test]
fn a_reset_detector_is_a_new_one() {
    let mut used = SaccadeDetector::default();
    for k in 0..300 {
        used.next(
            Seconds(f64::from(k)),
            toward(f64::from(k % 17), 0.0),
            k % 5 > 0,
        );
    }
    used.reset();
    let mut new = SaccadeDetector::default();
    for k in 0..500 {
        let (time, at) = (
            Seconds(f64::from(k) * 0.002),
            toward(jump(6.0, f64::from(k) * 0.002), 0.0),
        );
        assert_eq!(used.next(time, at, true), new.next(time, at, true));
    }
}

#[test]
fn the_fixed_threshold_sees_what_is_faster_than_180_degrees_per_second() {
    let mut rule = FixedThreshold::default();
    let mut said = |time: f64, yaw: f64, valid| rule.next(Seconds(time), toward(yaw, 0.0), valid);
    assert_eq!(said(0.0, 0.0, true), EyeEvent::Fixation);
    assert_eq!(said(0.01, 1.79, true), EyeEvent::Fixation);
    assert_eq!(said(0.02, 3.60, true), EyeEvent::Saccade);
    assert_eq!(
        said(0.02, 90.0, true),
        EyeEvent::Fixation,
        "no time has passed"
    );
    assert_eq!(said(0.03, 90.0, false), EyeEvent::Blink);
    assert_eq!(
        said(0.04, 0.0, true),
        EyeEvent::Fixation,
        "nothing to compare with"
    );
}
