//! What does one sample cost, from a head pose to a gaze?

use criterion::{Criterion, criterion_group, criterion_main};
use foveal_core::gaze::blend::blend;
use foveal_core::gaze::head_prediction::GazeInHead;
use foveal_core::gaze::head_prediction::adaptive::AdaptiveHeadGaze;
use foveal_core::gaze::head_prediction::motion_from_poses::MotionFromPoses;
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::gaze::sample::HeadPose;
use foveal_core::units::{Radians, Seconds};
use std::hint::black_box;

/// Poses of a sweeping head at 1000 Hz, the estimator's worst case.
fn pose(k: u32) -> (Seconds, HeadPose) {
    let time = f64::from(k) * 0.001;
    let yaw = Radians((1.7 * time).sin());
    let pitch = Radians(0.3 * (2.3 * time).sin());
    let roll = Radians(0.0);
    (Seconds(time), HeadPose { yaw, pitch, roll })
}

fn head_gaze(criterion: &mut Criterion) {
    let mut motions = MotionFromPoses::default();
    let mut adaptive = AdaptiveHeadGaze::new(HeadGazePreset::free_viewing());
    let truth = GazeInHead::within_reach([6.0, -3.0]);
    let mut k = 0;
    criterion.bench_function("head pose to blended gaze, learning", |bencher| {
        bencher.iter(|| {
            k += 1;
            let (time, pose) = pose(k);
            let motion = motions.update(time, &pose).unwrap_or_default();
            let predicted = adaptive.predict(&motion);
            adaptive.observe(&motion, truth);
            black_box(blend(truth, predicted, Seconds(0.2)))
        });
    });
}

criterion_group!(benches, head_gaze);
criterion_main!(benches);
