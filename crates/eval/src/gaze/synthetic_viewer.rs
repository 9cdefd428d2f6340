//! What would be recorded of a viewer who follows a known law?

use super::head_recording::{HeadRecording, HeadRow, RATE_HZ};
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::gaze::head_prediction::{GazeInHead, HeadMotion, SgazeMotion};
use foveal_core::units::Seconds;
use foveal_core::view::random::Random;

/// Half a minute of a head that pauses and turns, and of eyes that follow `law`, jumping every
/// 300 ms to another place of some degrees round it; few jumps go much farther than most.
pub(super) fn viewer(law: &HeadGazePreset, noise_deg: f64, seed: u64) -> HeadRecording {
    let mut random = Random::new(seed);
    let mut wanted = [0.0; 2];
    let mut velocity = [0.0; 2];
    let mut recent = [[0.0; 2]; 2];
    let mut aside = [0.0; 2];
    let rows = (0..3000).map(|k| {
        if k % 80 == 0 {
            let moves = random.unit() < 0.7;
            wanted = [60.0, 16.0].map(|fast| {
                let speed = fast * (2.0 * random.unit() - 1.0);
                if moves { speed } else { 0.0 }
            });
        }
        if k % 30 == 0 {
            let far = if random.unit() < 0.1 { 4.0 } else { 1.0 };
            aside = [0, 1].map(|_| far * noise_deg * 2.0 * (random.unit() - random.unit()));
        }
        let before = velocity;
        velocity = [0, 1].map(|axis| before[axis] + 0.08 * (wanted[axis] - before[axis]));
        let acceleration = [0, 1].map(|axis| (velocity[axis] - before[axis]) * RATE_HZ);
        recent = [recent[1], acceleration];
        let motion = HeadMotion {
            time: Seconds(f64::from(k) / RATE_HZ),
            velocity_deg_s: velocity,
            mean_acceleration_deg_s2: [0, 1].map(|axis| (recent[0][axis] + recent[1][axis]) / 2.0),
        };
        let followed = law.predict(&motion).degrees();
        HeadRow {
            gaze: GazeInHead::within_reach([0, 1].map(|axis| followed[axis] + aside[axis])),
            head: SgazeMotion {
                motion,
                yaw_acceleration_deg_s2: acceleration[0],
                velocity_deviation_deg_s: [25.0, 9.0],
                salient_deg: None,
            },
        }
    });
    HeadRecording::new(rows.collect()).expect("half a minute has rows")
}
