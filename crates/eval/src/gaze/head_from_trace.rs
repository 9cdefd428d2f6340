//! Which recording of eyes and head does a trace hold?

use super::head_recording::{HeadRecording, HeadRow, RATE_HZ};
use foveal_core::gaze::head_prediction::motion_from_poses::MotionFromPoses;
use foveal_core::gaze::head_prediction::{GazeInHead, HeadMotion, SgazeMotion};
use foveal_core::gaze::read::trace::Trace;
use foveal_core::units::Seconds;
use std::collections::VecDeque;

/// How far back the deviation of velocity looks, in rows: 10 s.
const DEVIATION_ROWS: usize = 1000;
/// Older samples say nothing of a row, in seconds.
const OLDEST_S: f64 = 0.05;

/// The moments, 100 a second, at which a trace of any rate knows eyes and head; `None` where it
/// never knows both. Moments without either are left out.
#[must_use]
pub fn recording_from_trace(trace: &Trace) -> Option<HeadRecording> {
    let samples = trace.samples();
    let (first, last) = (samples.first()?.time.0, samples.last()?.time.0);
    let mut motion_from_poses = MotionFromPoses::default();
    let (mut given, mut motion) = (0, None);
    let mut window = Window::default();
    let mut rows = Vec::new();
    for step in 0..=((last - first) * RATE_HZ) as usize {
        let time = first + step as f64 / RATE_HZ;
        while let Some(sample) = samples.get(given).filter(|sample| sample.time.0 <= time) {
            if let Some(head) = &sample.head {
                motion = motion_from_poses.update(sample.time, head).or(motion);
            }
            given += 1;
        }
        let newest = &samples[given.saturating_sub(1)];
        let known = newest.valid && time - newest.time.0 <= OLDEST_S;
        let fresh = |motion: &HeadMotion| time - motion.time.0 <= OLDEST_S;
        let (true, Some(head), Some(motion)) = (known, newest.head, motion.filter(fresh)) else {
            continue;
        };
        let in_head = head.head_from_content(newest.gaze_in_content);
        if let Some(gaze) = GazeInHead::from_direction_in_head(in_head) {
            let head = window.next(HeadMotion {
                time: Seconds(rows.len() as f64 / RATE_HZ),
                ..motion
            });
            rows.push(HeadRow { gaze, head });
        }
    }
    HeadRecording::new(rows)
}

/// The velocities of the last 10 s.
#[derive(Default)]
struct Window {
    velocities: VecDeque<[f64; 2]>,
    sum: [f64; 2],
    squares: [f64; 2],
}

impl Window {
    fn next(&mut self, motion: HeadMotion) -> SgazeMotion {
        let velocity = motion.velocity_deg_s;
        let before = self.velocities.back().copied().unwrap_or(velocity);
        self.velocities.push_back(velocity);
        self.add(velocity, 1.0);
        if self.velocities.len() > DEVIATION_ROWS
            && let Some(oldest) = self.velocities.pop_front()
        {
            self.add(oldest, -1.0);
        }
        let count = self.velocities.len() as f64;
        SgazeMotion {
            motion,
            yaw_acceleration_deg_s2: (velocity[0] - before[0]) * RATE_HZ,
            velocity_deviation_deg_s: [0, 1].map(|k| {
                let mean = self.sum[k] / count;
                (self.squares[k] / count - mean * mean).max(0.0).sqrt()
            }),
            salient_deg: None,
        }
    }

    fn add(&mut self, velocity: [f64; 2], sign: f64) {
        for (k, v) in velocity.into_iter().enumerate() {
            self.sum[k] += sign * v;
            self.squares[k] += sign * v * v;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    /// A head that swings, and eyes 6° ahead of it to the right.
    fn trace(rate_hz: f64, losses: bool) -> Trace {
        let mut text = "t_s,yaw_deg,pitch_deg,valid,head_yaw_deg,head_pitch_deg\n".to_owned();
        for k in 0..(20.0 * rate_hz) as usize {
            let time = k as f64 / rate_hz;
            let yaw = 30.0 * (time * 1.1).sin();
            let valid = u8::from(!losses || k % 100 > 20);
            let _ = writeln!(text, "{time},{},0,{valid},{yaw},0", yaw + 6.0);
        }
        Trace::parse(&text).unwrap()
    }

    #[test]
    fn a_trace_of_any_rate_gives_the_motion_of_its_head_and_the_eyes_in_it() {
        for rate in [60.0, 100.0, 250.0, 1000.0] {
            let recording = recording_from_trace(&trace(rate, false)).unwrap();
            assert!(recording.rows().len() > 1900, "{rate}");
            for (k, row) in recording.rows().iter().enumerate().skip(100) {
                assert!((row.gaze.yaw_deg - 6.0).abs() < 1e-6, "{rate} {k}");
                assert!(row.head.motion.velocity_deg_s[0].abs() < 35.0, "{rate} {k}");
            }
            let fastest = recording
                .rows()
                .iter()
                .map(|row| row.head.motion.velocity_deg_s[0]);
            assert!(fastest.fold(0.0, f64::max) > 30.0, "{rate}");
            let deviation = recording.rows()[1500].head.velocity_deviation_deg_s[0];
            assert!(
                (deviation - 33.0 / 2f64.sqrt()).abs() < 3.0,
                "{rate}: {deviation}"
            );
        }
    }

    #[test]
    fn moments_without_eyes_are_left_out_and_a_trace_without_a_head_gives_none() {
        let whole = recording_from_trace(&trace(100.0, false)).unwrap();
        let lost = recording_from_trace(&trace(100.0, true)).unwrap();
        let share = lost.rows().len() as f64 / whole.rows().len() as f64;
        assert!((share - 0.79).abs() < 0.02, "{share}");
        let headless = Trace::parse("t_s,yaw_deg,pitch_deg\n0,1,2\n0.5,1,2\n").unwrap();
        assert!(recording_from_trace(&headless).is_none());
    }
}
