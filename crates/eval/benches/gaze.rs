//! What does a gaze sample cost from the tracker to the predicted landing?
//!
//! Detector, filter and landing over ten seconds of a synthetic eye; the time is that of all its
//! samples, the throughput is samples per second. At most 5 µs a sample is wanted.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use foveal_core::gaze::landing::predict_landing;
use foveal_core::gaze::one_euro::GazeFilter;
use foveal_core::gaze::saccade::SaccadeDetector;
use foveal_eval::gaze::synthetic::{SyntheticConfig, synthetic_recording};
use std::hint::black_box;

fn gaze_path(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gaze path");
    for rate_hz in [120.0, 500.0, 1000.0] {
        let config = SyntheticConfig {
            rate_hz,
            seconds: 10.0,
            ..SyntheticConfig::default()
        };
        let trial = synthetic_recording(&config).trials.remove(0);
        group.throughput(Throughput::Elements(trial.samples.len() as u64));
        group.bench_function(format!("{rate_hz} Hz"), |bencher| {
            let mut detector = SaccadeDetector::default();
            let mut filter = GazeFilter::default();
            bencher.iter(|| {
                detector.reset();
                for s in &trial.samples {
                    let said = detector.next(s.time, s.gaze_in_content, s.valid);
                    black_box(filter.next(s.time, s.gaze_in_content, said.event));
                    black_box(said.saccade.as_ref().map(predict_landing));
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, gaze_path);
criterion_main!(benches);
