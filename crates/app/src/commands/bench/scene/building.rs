//! How long do building units and decoding them take?

use super::conditions::BenchConditions;
use super::row::{BenchRow, Turns, thread_ms_each};
use super::subject::Subject;
use crate::commands::bench::processor_time::cpu_seconds;
use crate::report::output;
use foveal_core::content::mesh::payload::MeshUnit;
use foveal_core::content::scene::description::GRID_BITS;
use foveal_scene::baseline::{WholeMesh, clod_build};
use foveal_scene::build::{BuildOptions, build as build_units};
use std::hint::black_box;
use std::time::Instant;

/// Seconds of processors, where the system reports them, and by the clock.
fn seconds(work: impl FnOnce() -> anyhow::Result<()>) -> anyhow::Result<[f64; 2]> {
    let (cpu, begun) = (cpu_seconds(), Instant::now());
    work()?;
    let clock = begun.elapsed().as_secs_f64();
    let cpu = cpu_seconds().zip(cpu).map(|(after, before)| after - before);
    Ok([cpu.unwrap_or(clock), clock])
}

/// Building and encoding units, against meshoptimizer's own clusterlod, which encodes nothing; and
/// what measuring their signatures takes besides.
pub(super) fn build(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let Some(source) = &subject.source else {
        output::say(&format!(
            "{}: a pack does not record how it was built",
            subject.name
        ));
        return Ok(Vec::new());
    };
    let bits = subject.file.pack().description().objects.first();
    let bits = bits.map_or(*GRID_BITS.start(), |it| it.grid.bits);
    let ours = |jobs, signatures| {
        seconds(|| {
            let options = BuildOptions {
                bits,
                jobs,
                exact: false,
                signatures,
            };
            black_box(build_units(source, &options, &|_, _| ())?);
            Ok(())
        })
    };
    let [mut processor, mut clock, mut threads, mut measuring] = [const { Vec::new() }; 4];
    for _ in 0..conditions.runs {
        let [one, two] = [ours(1, false)?, ours(2, false)?];
        let measured = ours(1, true)?;
        let theirs = seconds(|| {
            black_box(clod_build(source));
            Ok(())
        })?;
        processor.push([one[0], theirs[0]]);
        clock.push([one[1], theirs[1]]);
        threads.push([two[1], theirs[1]]);
        measuring.push([measured[0] - one[0], one[0]]);
    }
    let row = |what: &str, runs: Vec<[f64; 2]>| {
        let turns = Turns {
            ours: runs.iter().map(|it| it[0]).collect(),
            baseline: runs.iter().map(|it| it[1]).collect(),
        };
        turns.row(&subject.name, what, "s")
    };
    Ok(vec![
        row(
            "build and encode against clod_build, processor time",
            processor,
        )
        .asked("ratio <= 1.5"),
        row("the same by the clock, one thread", clock),
        row("the same by the clock, two threads against one", threads).asked("ratio <= 0.85"),
        row("measure what units add, against building them", measuring),
    ])
}

/// Decoding all units, against meshoptimizer's decoder of the triangles of the whole mesh.
pub(super) fn decode(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let file = &subject.file;
    let mut units = Vec::new();
    for unit in file.pack().units() {
        let row = file.pack().row(unit);
        if row.kind.facts().has_triangles {
            let attributes = file.scene().object_of(unit).attributes;
            units.push((file.read_chunk(unit)?, attributes, &row.replaces));
        }
    }
    let meshes = subject.finest.iter().map(WholeMesh::encode);
    let meshes = meshes.collect::<Result<Vec<_>, _>>()?;
    let rate = |triangles: usize, ms: f64| triangles as f64 / ms / 1e3;
    let turns = Turns::take(
        conditions.runs,
        || {
            let mut triangles = 0;
            let ms = thread_ms_each(|| {
                triangles = 0;
                for (payload, attributes, replaces) in &units {
                    let parsed = MeshUnit::parse(payload, *attributes, replaces)?;
                    triangles += black_box(parsed).triangles();
                }
                Ok(())
            })?;
            Ok(rate(triangles, ms))
        },
        || {
            let mut triangles = 0;
            let ms = thread_ms_each(|| {
                triangles = 0;
                for mesh in &meshes {
                    triangles += mesh.decode_triangles()?;
                }
                Ok(())
            })?;
            Ok(rate(triangles, ms))
        },
    )?;
    let what = "decode units, against decode_index_buffer of the whole mesh";
    let row = turns.row(&subject.name, what, "million triangles/s");
    Ok(vec![row.asked("ratio >= 1.0")])
}
