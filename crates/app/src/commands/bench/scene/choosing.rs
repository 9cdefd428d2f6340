//! How long does choosing take: by a rule in a scene, and within a budget?

use super::conditions::BenchConditions;
use super::place::{Extent, looking};
use super::row::{BenchRow, Turns, thread_ms_each};
use super::subject::Subject;
use anyhow::Context;
use foveal_core::content::demand::Demand;
use foveal_core::content::policy::Policy;
use foveal_core::content::policy::asked::Detail;
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::demand::SceneDemand;
use foveal_core::content::scene::pack::ScenePack;
use foveal_core::perception::moment::Moment;
use foveal_core::selection::greedy::Rule;
use foveal_eval::bench_cases::{SCENE_BUDGET_BYTES, UNITS, scene_catalog, scene_value_at};
use foveal_media::plain_file::read_plain;
use std::hint::black_box;
use std::sync::Arc;

/// Clusters of a large scene.
const CLUSTERS: usize = 100_000;
/// Where the eye looks in turn, in degrees to the right and up.
const GAZES: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [8.0, 4.0],
    [-9.0, 6.0],
    [12.0, -7.0],
    [-5.0, -11.0],
];
/// Across the view, in degrees.
const ACROSS_DEG: f64 = 100.0;

/// A cut of so many clusters by `acuity`.
pub(super) fn choose(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let extent = Extent::of(subject);
    let clusters = clusters(subject)?;
    let copies = CLUSTERS.div_ceil(clusters.max(1));
    let scene = Arc::new(beside_each_other(subject, &extent, copies)?);
    let config = Detail::Usual.of(Policy::Acuity);
    let mut demand = SceneDemand::new(Arc::clone(&scene), &config);
    let moments = GAZES.map(|gaze| looking(extent.view(ACROSS_DEG), gaze));
    let chosen = demand.needed(0, &moments[0]).units.len();
    let mut round = |moments: &[Moment; 5]| {
        let ms = thread_ms_each(|| {
            for moment in moments {
                black_box(demand.needed(0, moment));
            }
            Ok(())
        })?;
        anyhow::Ok(ms / moments.len() as f64)
    };
    round(&moments)?;
    let ours = (0..conditions.runs).map(|_| round(&moments));
    let turns = Turns {
        ours: ours.collect::<anyhow::Result<_>>()?,
        baseline: Vec::new(),
    };
    let what = format!("choose of {} clusters by acuity", copies * clusters);
    let row = turns.row(&subject.name, what, "ms").asked("ours <= 1");
    let units = scene.pack().len();
    Ok(vec![
        row.with("copies", copies as f64)
            .with("units", units as f64)
            .with("chosen", chosen as f64),
    ])
}

fn clusters(subject: &Subject) -> anyhow::Result<usize> {
    let file = &subject.file;
    let mut clusters = 0;
    for unit in file.pack().units() {
        if !file.pack().row(unit).kind.facts().has_triangles {
            continue;
        }
        let places = file.scene().object_of(unit).placements.len();
        clusters += places * file.read_mesh(unit)?.clusters.len();
    }
    Ok(clusters)
}

/// The scene so many times, to both sides of where it stands.
fn beside_each_other(subject: &Subject, extent: &Extent, copies: usize) -> anyhow::Result<Scene> {
    let (file, header) = (&subject.file, subject.file.header());
    let bytes = read_plain(file.path(), file.bytes())?;
    let part = |from: u64, length: u64| {
        let part = bytes.get(from as usize..(from + length) as usize);
        part.context("the pack became shorter")
    };
    let mut about = file.pack().description().clone();
    for object in &mut about.objects {
        let there = object.placements.clone();
        object.placements = (0..copies)
            .flat_map(|copy| {
                let side = if copy % 2 == 0 { -1.0 } else { 1.0 };
                let away = side * copy.div_ceil(2) as f64 * 1.1 * extent.width();
                there.iter().map(move |place| {
                    let mut place = *place;
                    place[9] += away;
                    place
                })
            })
            .collect();
    }
    let table = about.units_table()?.clone();
    let index = part(header.index_offset, header.index_bytes)?;
    let pack = ScenePack::new(header, about, index, part(table.offset, table.bytes)?)?;
    Ok(Scene::new(&subject.name, Arc::new(pack)))
}

/// 2,000 steps of 100,000 units with prerequisites, against the same without.
pub(super) fn select(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let moments = [1, 2].map(|moment| {
        let values = (0..UNITS).map(|unit| scene_value_at(unit, moment));
        values.collect::<Vec<f64>>()
    });
    let tick = |needs: bool| {
        let mut catalog = scene_catalog(Rule::default(), needs)?;
        let mut turn = 0;
        anyhow::Ok(move |moments: &[Vec<f64>; 2]| {
            thread_ms_each(|| {
                turn = 1 - turn;
                for (unit, value) in (0..).zip(&moments[turn]) {
                    catalog.set_values(unit, &[*value]);
                }
                black_box(catalog.select(SCENE_BUDGET_BYTES));
                Ok(())
            })
        })
    };
    let (mut ours, mut baseline) = (tick(true)?, tick(false)?);
    let turns = Turns::take(conditions.runs, || ours(&moments), || baseline(&moments))?;
    let what = "select 2,000 steps of 100,000 units with prerequisites, against without";
    let row = turns.row(&subject.name, what, "ms").asked("ours <= 15");
    Ok(vec![row])
}
