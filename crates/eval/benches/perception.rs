//! How long does a decision take to weigh at 1920x1080 with five levels?

use criterion::{Criterion, criterion_group, criterion_main};
use foveal_core::perception::fast::FastImportance;
use foveal_core::perception::parameters::Parameters;
use foveal_eval::fft_importance::FftImportance;
use foveal_eval::importance_bench::{Decision, LEVELS};

const SIZE: [u32; 2] = [1920, 1080];

fn importance(criterion: &mut Criterion) {
    let decision = Decision::generated(SIZE);
    let parameters = Parameters::default();
    let onlooker = decision.onlooker;
    let weights = parameters.weights(onlooker.state);
    let pictures = decision.pictures();
    let mut gains = vec![0.0; decision.units * (LEVELS - 1)];
    let mut group = criterion.benchmark_group("importance, 1080p, 5 levels");
    group.sample_size(10);
    let mut fast = FastImportance::new(&parameters, &onlooker.view, LEVELS);
    group.bench_function("pyramid", |bencher| {
        bencher.iter(|| {
            fast.look(&onlooker, &weights);
            fast.unit_gains(&pictures, &decision.unit_ids, &mut gains);
        });
    });
    let mut fft = FftImportance::new(&parameters, &onlooker.view, LEVELS);
    fft.look(&onlooker, &weights);
    group.bench_function("Fourier transforms", |bencher| {
        bencher.iter(|| fft.unit_gains(&pictures, &decision.unit_ids, &mut gains));
    });
    group.finish();
}

criterion_group!(benches, importance);
criterion_main!(benches);
