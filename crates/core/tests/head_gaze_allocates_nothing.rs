//! Does any sample cost an allocation on the way from a head pose or a tracker to a gaze?

use crate::counting;
use foveal_core::gaze::blend::blend;
use foveal_core::gaze::head_prediction::adaptive::AdaptiveHeadGaze;
use foveal_core::gaze::head_prediction::lu_2020::predict_lu_2020;
use foveal_core::gaze::head_prediction::motion_from_poses::MotionFromPoses;
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::gaze::head_prediction::sgaze::Sgaze;
use foveal_core::gaze::head_prediction::{GazeInHead, SgazeMotion};
use foveal_core::gaze::main_sequence::{saccade_duration, saccade_way};
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::spread::GazeEvidence;
use foveal_core::gaze::tracker::GazeTracker;
use foveal_core::units::{Radians, Seconds};

#[test]
fn no_sample_from_pose_to_gaze_allocates() {
    let mut motions = MotionFromPoses::default();
    let mut adaptive = AdaptiveHeadGaze::new(HeadGazePreset::free_viewing());
    let mut sgaze = Sgaze::default();
    let before = counting::allocations();
    let mut sum = 0.0;
    for k in 0..5000 {
        let time = Seconds(f64::from(k) * 0.001);
        let yaw = Radians(libm::sin(3.0 * time.0));
        let pose = HeadPose {
            yaw,
            ..HeadPose::default()
        };
        let Some(motion) = motions.update(time, &pose) else {
            continue;
        };
        let head = SgazeMotion {
            motion,
            ..SgazeMotion::default()
        };
        let truth = GazeInHead::within_reach([yaw.to_degrees(), 1.0]);
        let predicted = adaptive.predict(&motion);
        adaptive.observe(&motion, truth);
        let blended = blend(truth, predicted, Seconds(0.2));
        sum += blended.angle_to(sgaze.predict(&head)).0 + predict_lu_2020(&head).yaw_deg;
        sum += GazeEvidence::Head
            .spread(adaptive.preset().spread(), time)
            .0;
    }
    assert_eq!(counting::allocations(), before);
    assert!(sum.is_finite() && sum != 0.0);
    let counted = counting::allocations();
    drop(std::hint::black_box(Box::new(7u8)));
    assert_eq!(counting::allocations(), counted + 1);
}

#[test]
fn no_sample_that_a_tracker_takes_or_expects_allocates() {
    let mut tracker = GazeTracker::new(HeadGazePreset::search());
    let jump = Radians::from_degrees(10.0);
    let before = counting::allocations();
    let (mut events, mut sum) = ([0; 3], 0.0);
    for k in 0..6000 {
        let time = Seconds(f64::from(k) * 0.001);
        // A jump of 10 degrees every 200 ms, and an eye that is lost for two seconds of six.
        let way = saccade_way(jump, f64::from(k % 200) / 1e3 / saccade_duration(jump).0);
        let side = if k % 400 < 200 { 1.0 } else { -1.0 };
        let yaw = Radians(side * jump.0 * (way.min(1.0) - 0.5));
        let head = HeadPose {
            yaw: Radians(libm::sin(time.0)),
            ..HeadPose::default()
        };
        let sample = GazeSample {
            valid: k < 4000,
            spread: Radians(0.01),
            head: Some(head),
            ..GazeSample::at(time, Radians(yaw.0 + head.yaw.0), Radians(0.0))
        };
        tracker.push(&sample);
        let expected = [0.0, 0.02, 0.2].map(|ahead| tracker.predict(Seconds(time.0 + ahead)));
        for prediction in expected.iter().flatten() {
            sum += prediction.gaze.gaze_in_content.x;
            events[match prediction.event {
                EyeEvent::Fixation => 0,
                EyeEvent::Saccade => 1,
                EyeEvent::Blink | EyeEvent::Lost => 2,
            }] += 1;
        }
    }
    assert_eq!(counting::allocations(), before);
    assert!(
        sum.is_finite() && events.iter().all(|count| *count > 100),
        "{events:?}"
    );
}
