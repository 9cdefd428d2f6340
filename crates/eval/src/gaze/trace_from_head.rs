//! Which trace of eyes and head is a recording that has the motion of a head, but no poses?

use super::head_recording::{HeadRecording, HeadRow, RATE_HZ};
use foveal_core::gaze::read::row::TraceRow;
use foveal_core::gaze::read::trace::{Trace, TraceError};
use foveal_core::gaze::sample::HeadPose;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::yaw_pitch_from_direction;

/// Highest and lowest that a head is taken to look, in degrees. Velocities add up to more only
/// because recordings have gaps that no row shows.
const MOST_PITCH_DEG: f64 = 40.0;
/// Rows that are left out where a head is set level again, longer than the silence after which a
/// head's motion is unknown: what was not recorded must not look like a fast turn.
const LEFT_OUT: usize = 12;

/// A trace with the same motion of the head and the same eyes in it, 100 rows a second from 0. The
/// head begins straight ahead, without roll; its poses are the sum of its velocities, and where
/// they would pass 40° up or down it is set level again and 0.12 s are left out.
///
/// # Errors
/// The recording has more rows than a trace may.
pub fn trace_from_recording(recording: &HeadRecording) -> Result<Trace, TraceError> {
    let [mut yaw, mut pitch] = [0.0_f64; 2];
    let mut left_out = 0;
    let mut rows = Vec::with_capacity(recording.rows().len());
    for (number, row) in recording.rows().iter().enumerate() {
        let [right, up] = row.head.motion.velocity_deg_s;
        pitch += up / RATE_HZ;
        if pitch.abs() > MOST_PITCH_DEG {
            (pitch, left_out) = (0.0, LEFT_OUT);
        }
        // Velocities are about the head's own axes.
        yaw += right / RATE_HZ / libm::cos(Radians::from_degrees(pitch).0);
        match left_out.checked_sub(1) {
            Some(left) => left_out = left,
            None => rows.push(trace_row(number, row, [yaw % 360.0, pitch])),
        }
    }
    Trace::from_rows(rows)
}

fn trace_row(number: usize, row: &HeadRow, [yaw_deg, pitch_deg]: [f64; 2]) -> TraceRow {
    let time = Seconds(number as f64 / RATE_HZ);
    let [yaw, pitch] = [yaw_deg, pitch_deg].map(Radians::from_degrees);
    let roll = Radians(0.0);
    let axes = HeadPose { yaw, pitch, roll }.axes();
    let in_head = row.gaze.direction_in_head();
    let in_content = axes.right * in_head.x - axes.down * in_head.y - axes.forward * in_head.z;
    let (gaze_yaw, gaze_pitch) = yaw_pitch_from_direction(in_content);
    TraceRow {
        time,
        received: time,
        gaze_deg: Some([gaze_yaw.to_degrees(), gaze_pitch.to_degrees()]),
        valid: true,
        spread_deg: 0.0,
        head_deg: Some([yaw_deg, pitch_deg, 0.0]),
    }
}

#[cfg(test)]
mod tests {
    use super::super::head_from_trace::recording_from_trace;
    use super::*;
    use foveal_core::gaze::head_prediction::{GazeInHead, HeadMotion, SgazeMotion};

    /// A head that nods and turns, with eyes off its forward direction, and `drift` upwards.
    fn recording(drift: f64) -> HeadRecording {
        let row = |number: usize| {
            let time = number as f64 / RATE_HZ;
            let velocity = [60.0 * (time * 1.3).sin(), 20.0 * (time * 0.9).cos() + drift];
            HeadRow {
                gaze: GazeInHead {
                    yaw_deg: 7.0 * (time * 2.0).sin(),
                    pitch_deg: -4.0,
                },
                head: SgazeMotion {
                    motion: HeadMotion {
                        time: Seconds(time),
                        velocity_deg_s: velocity,
                        ..HeadMotion::default()
                    },
                    yaw_acceleration_deg_s2: 0.0,
                    velocity_deviation_deg_s: [0.0; 2],
                    salient_deg: None,
                },
            }
        };
        HeadRecording::new((0..6000).map(row).collect()).unwrap()
    }

    #[test]
    fn the_trace_has_the_motion_of_the_head_and_the_eyes_in_it() {
        let given = recording(0.0);
        let again = recording_from_trace(&trace_from_recording(&given).unwrap()).unwrap();
        // The motion of the first poses is unknown.
        let begun = given.rows().len() - again.rows().len();
        assert!(begun < 5, "{begun}");
        for (a, b) in given.rows()[begun..].iter().zip(again.rows()).skip(10) {
            assert!(a.gaze.angle_to(b.gaze).to_degrees() < 1e-6, "{a:?} {b:?}");
            let [a, b] = [a, b].map(|row| row.head.motion.velocity_deg_s);
            let off = [0, 1].map(|k| (a[k] - b[k]).abs());
            assert!(off[0] < 1.0 && off[1] < 1.0, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_head_whose_turns_do_not_add_up_is_set_level_without_a_fast_turn() {
        let trace = trace_from_recording(&recording(6.0)).unwrap();
        let heads = trace.rows().iter().map(|row| row.head_deg.unwrap());
        assert!(
            heads
                .clone()
                .all(|[_, pitch, _]| pitch.abs() <= MOST_PITCH_DEG)
        );
        assert!(trace.rows().len() < 6000 && trace.rows().len() > 5800);
        let fastest = recording_from_trace(&trace).unwrap();
        let fastest = fastest.rows().iter().map(|row| {
            let [x, y] = row.head.motion.velocity_deg_s;
            x.abs().max(y.abs())
        });
        assert!(fastest.fold(0.0, f64::max) < 65.0);
    }
}
