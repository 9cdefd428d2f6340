//! How long does a selection over 100,000 units take, and which part of it how long?

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use foveal_core::selection::greedy::{Catalog, CatalogError, Misfit, Rule};
use foveal_eval::bench_cases::{
    BUDGET_BYTES, LEVELS, SCENE_BUDGET_BYTES, UNITS, large_catalog, scene_catalog, scene_value_at,
    values_at,
};

/// Values of many units at a moment, with their units.
fn values(units: impl Iterator<Item = u32>, moment: u32) -> Vec<(u32, [f64; LEVELS])> {
    units.map(|unit| (unit, values_at(unit, moment))).collect()
}

fn set(catalog: &mut Catalog, values: &[(u32, [f64; LEVELS])]) {
    for (unit, values) in values {
        catalog.set_values(*unit, values);
    }
}

fn selection(criterion: &mut Criterion) -> Result<(), CatalogError> {
    let fresh = large_catalog(Rule::default())?;
    let mut group = criterion.benchmark_group("selection, 100,000 units x 4 levels");
    let mut catalog = fresh.clone();
    catalog.refresh();
    group.bench_function("hulls of all units", |bencher| {
        bencher.iter_batched_ref(|| fresh.clone(), Catalog::refresh, BatchSize::LargeInput);
    });
    group.bench_function("heap: up to the first step", |bencher| {
        bencher.iter(|| catalog.choices(BUDGET_BYTES).next());
    });
    group.bench_function("heap and pops of 2,000 steps", |bencher| {
        bencher.iter(|| catalog.select(BUDGET_BYTES));
    });
    for (name, every) in [("all units changed", 1), ("1 % of the units changed", 100)] {
        let moments = [1, 2].map(|moment| values((0..UNITS).step_by(every), moment));
        let mut turn = 0;
        group.bench_function(format!("tick, {name}"), |bencher| {
            bencher.iter(|| {
                turn = 1 - turn;
                set(&mut catalog, &moments[turn]);
                catalog.select(BUDGET_BYTES)
            });
        });
    }
    let stopping = Rule {
        misfit: Misfit::Stop,
        ..Rule::default()
    };
    for (name, rule) in [
        ("stopping at a misfit", stopping),
        ("paper rule", Rule::PAPER),
    ] {
        let mut catalog = large_catalog(rule)?;
        catalog.refresh();
        group.bench_function(format!("heap and pops, {name}"), |bencher| {
            bencher.iter(|| catalog.select(BUDGET_BYTES));
        });
    }
    group.finish();
    Ok(())
}

fn selection_of_scenes(criterion: &mut Criterion) -> Result<(), CatalogError> {
    let mut group = criterion.benchmark_group("selection, 100,000 units of a scene");
    let moments = [1, 2].map(|moment| {
        let values = (0..UNITS).map(|unit| scene_value_at(unit, moment));
        values.collect::<Vec<f64>>()
    });
    for (name, needs) in [
        ("two prerequisites a unit", true),
        ("no prerequisites", false),
    ] {
        let mut catalog = scene_catalog(Rule::default(), needs)?;
        catalog.refresh();
        group.bench_function(format!("heap and pops of 2,000 steps, {name}"), |bencher| {
            bencher.iter(|| catalog.select(SCENE_BUDGET_BYTES));
        });
        let mut turn = 0;
        group.bench_function(format!("tick, all units changed, {name}"), |bencher| {
            bencher.iter(|| {
                turn = 1 - turn;
                for (unit, value) in (0..).zip(&moments[turn]) {
                    catalog.set_values(unit, &[*value]);
                }
                catalog.select(SCENE_BUDGET_BYTES)
            });
        });
    }
    group.finish();
    Ok(())
}

fn run(criterion: &mut Criterion) {
    if let Err(error) = selection(criterion).and_then(|()| selection_of_scenes(criterion)) {
        eprintln!("{error}");
    }
}

criterion_group!(benches, run);
criterion_main!(benches);
