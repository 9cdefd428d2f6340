//! How long does a mesh take to become units, how large are they, and are all cuts closed?
//!
//! `cargo run --release -p foveal-scene --example build_speed -- MESH.ply`: ASCII PLY, positions
//! and triangles only. Without a file, a torus. Compares with meshoptimizer's own clusterlod.
#![allow(clippy::print_stdout)]

use foveal_core::content::mesh::payload::{Attributes, MeshUnit};
use foveal_core::pack::unit::UnitId;
use foveal_scene::baseline::clod_build;
use foveal_scene::build::{BuildOptions, Built, build};
use foveal_scene::cracks::{CutTrial, check_cuts};
use foveal_scene::generate::{alone, torus};
use foveal_scene::source::{SourceMesh, SourceScene};
use glam::DVec3;
use std::collections::BTreeMap;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = match std::env::args().nth(1) {
        Some(path) => ply(&std::fs::read_to_string(path)?).ok_or("no ASCII PLY of triangles")?,
        None => torus(1024, 512),
    };
    let source = alone("mesh", mesh);
    let rounds = std::env::args().nth(2).map_or(Ok(3), |it| it.parse())?;
    let mut best = BTreeMap::<&str, f64>::new();
    let mut keep = |name: &'static str, seconds: f64| {
        let best = best.entry(name).or_insert(f64::INFINITY);
        *best = best.min(seconds);
    };
    let mut last = Built::default();
    for _ in 0..rounds {
        for (name, jobs) in [("build, 1 thread", 1), ("build, 2 threads", 2)] {
            let options = BuildOptions {
                jobs,
                signatures: false,
                ..BuildOptions::default()
            };
            let start = Instant::now();
            let before = processor_seconds();
            last = build(&source, &options, &|_, _| ())?;
            keep(name, start.elapsed().as_secs_f64());
            if jobs == 1 {
                keep("build, processor", processor_seconds() - before);
            }
        }
        let before = processor_seconds();
        keep("clod_build", clod(&source));
        keep("clod_build, processor", processor_seconds() - before);
    }
    let (indices, encoded) = encoded_indices(&source.meshes[0])?;
    // Short: many tries find one that nothing else disturbs.
    for _ in 0..20 {
        keep("decode units", decode(&last));
        let start = Instant::now();
        let decoded = meshopt::decode_index_buffer::<u32>(&encoded, indices)?;
        keep("decode index buffer", start.elapsed().as_secs_f64());
        assert_eq!(
            decoded.len(),
            indices,
            "the codec returns what it was given"
        );
    }
    let triangles = source.meshes[0].triangles.len() as f64;
    for (name, seconds) in best {
        println!(
            "{name}: {seconds:.3} s, {:.1} Mtri/s",
            triangles / seconds / 1e6
        );
    }
    sizes(&last);
    cracks(&last, false)?;
    cracks(&last, true)
}

/// Seconds that all threads of this process ran, on Linux; elsewhere none.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let words = stat.split_ascii_whitespace().skip(13).take(2);
    // In ticks, of which Linux counts a hundred a second.
    words.filter_map(|it| it.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn sizes(built: &Built) {
    let leaves: u64 = built.objects.iter().map(|it| it.shape.samples()).sum();
    let bytes: usize = built.units.iter().map(|it| it.payload.len()).sum();
    let needs: usize = built.units.iter().map(|it| it.row.needs.len()).sum();
    let roots = built
        .units
        .iter()
        .filter(|it| it.row.needs.is_empty())
        .count();
    let count = built.units.len();
    let parsed = built.units.iter().filter_map(|it| {
        let object = &built.objects[usize::from(it.row.object)];
        MeshUnit::parse(&it.payload, object.attributes, &it.row.replaces).ok()
    });
    let parsed: Vec<MeshUnit> = parsed.collect();
    let clusters: usize = parsed.iter().map(|it| it.clusters.len()).sum();
    let triangles: usize = parsed.iter().map(MeshUnit::triangles).sum();
    let new: usize = parsed.iter().map(|it| it.vertices.len()).sum();
    let named = parsed.iter().flat_map(|it| &it.clusters);
    let named: usize = named.map(|it| it.vertices.len()).sum();
    println!(
        "{:.3} bytes a leaf triangle, {bytes} bytes, {count} units, {roots} roots, {} levels",
        bytes as f64 / leaves as f64,
        built.levels
    );
    println!(
        "{:.2} needs a unit, {:.2} triangles a cluster, {clusters} clusters, {triangles} triangles",
        needs as f64 / count as f64,
        triangles as f64 / clusters as f64,
    );
    println!("{new} new vertices, {named} names; {:?}", built.repairs);
}

fn cracks(built: &Built, ignore_prerequisites: bool) -> Result<(), Box<dyn std::error::Error>> {
    let start = Instant::now();
    let rows = built.units.iter().map(|it| (it.level, it.row.clone()));
    let mut payload_of = |unit: UnitId| {
        let unit = &built.units[unit.0 as usize];
        let object = &built.objects[usize::from(unit.row.object)];
        MeshUnit::parse(&unit.payload, object.attributes, &unit.row.replaces)
    };
    let trial = CutTrial {
        cuts: 100,
        orders: 200,
        seed: 1,
        ignore_prerequisites,
    };
    let report = check_cuts(&rows.collect::<Vec<_>>(), &mut payload_of, &trial)?;
    let seconds = start.elapsed().as_secs_f64();
    println!("ignore prerequisites: {ignore_prerequisites}, {seconds:.1} s: {report:?}");
    Ok(())
}

/// Seconds in which meshoptimizer's clusterlod builds a scene in clusters and groups of our sizes.
fn clod(source: &SourceScene) -> f64 {
    let start = Instant::now();
    let groups = clod_build(source);
    assert!(groups > 0, "the mesh has triangles");
    start.elapsed().as_secs_f64()
}

fn decode(built: &Built) -> f64 {
    let start = Instant::now();
    let attributes = built
        .objects
        .first()
        .map_or(Attributes::default(), |it| it.attributes);
    let parsed = built.units.iter();
    let parsed = parsed.map(|it| MeshUnit::parse(&it.payload, attributes, &it.row.replaces));
    let triangles: usize = parsed.flatten().map(|it| it.triangles()).sum();
    let leaves: u64 = built.objects.iter().map(|it| it.shape.samples()).sum();
    // As seconds for the leaf triangles alone: of all triangles these are about half.
    start.elapsed().as_secs_f64() * leaves as f64 / triangles as f64
}

/// How many indices a mesh has, and these as meshoptimizer writes them.
fn encoded_indices(mesh: &SourceMesh) -> Result<(usize, Vec<u8>), meshopt::Error> {
    let count = mesh.positions.len();
    let indices = meshopt::optimize_vertex_cache(mesh.triangles.as_flattened(), count);
    Ok((
        indices.len(),
        meshopt::encode_index_buffer(&indices, count)?,
    ))
}

fn ply(text: &str) -> Option<SourceMesh> {
    let (head, body) = text.split_once("end_header")?;
    let count = |element: &str| {
        let mut lines = head.lines();
        let after = lines.find_map(|it| it.strip_prefix(element))?;
        after.trim().parse::<usize>().ok()
    };
    let [vertices, faces] = [count("element vertex")?, count("element face")?];
    let mut lines = body.lines().skip(1);
    let numbers = |line: &str| {
        let words = line.split_ascii_whitespace();
        words
            .filter_map(|it| it.parse::<f64>().ok())
            .collect::<Vec<_>>()
    };
    let positions = lines.by_ref().take(vertices).map(numbers);
    let positions = positions
        .map(|it| DVec3::new(it[0], it[1], it[2]))
        .collect();
    let triangles = lines.take(faces).map(numbers);
    let triangles = triangles.map(|it| [it[1], it[2], it[3]].map(|it| it as u32));
    Some(SourceMesh {
        positions,
        triangles: triangles.collect(),
        ..Default::default()
    })
}
