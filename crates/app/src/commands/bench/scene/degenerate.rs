//! What does it cost where very many meet: triangles round one edge, points at one place?

use super::conditions::BenchConditions;
use super::place::SIZE;
use super::row::{BenchRow, Turns};
use super::subject::Subject;
use foveal_core::content::payload::PayloadView;
use foveal_core::content::points::payload::PointUnit;
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_render::twin::TwinScene;
use foveal_render::{Coming, SceneStyle};
use foveal_scene::build::{BuildOptions, build};
use foveal_scene::generate::{alone, book, cloud_of_torus, one_place, torus};
use foveal_scene::source::{SourceCloud, SourceScene};
use glam::DVec3;
use std::hint::black_box;
use std::time::Instant;

const CONTENT: &str = "degenerate";
const TRIANGLES: u32 = 60_000;
const POINTS: u32 = 30_000;
/// Vertices round and along a torus of as many triangles.
const TORUS: [u32; 2] = [300, 100];
/// Pixels of a picture: a quarter of those that are looked through elsewhere.
const PICTURE: [u32; 2] = [SIZE[0] / 2, SIZE[1] / 2];

/// Building triangles, and drawing points on processors, against as many that are spread out.
pub(super) fn degenerate(
    _: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let [round_edge, spread] = [book(TRIANGLES), torus(TORUS[0], TORUS[1])];
    let [round_edge, spread] = [round_edge, spread].map(|mesh| alone(CONTENT, mesh));
    let triangles = Turns::take(
        conditions.runs,
        || building_ms(&round_edge),
        || building_ms(&spread),
    )?;
    let [at_one_place, spread] = [one_place(POINTS), cloud_of_torus(POINTS)].map(drawn_from);
    let [at_one_place, spread] = [at_one_place?, spread?];
    let points = Turns::take(
        conditions.runs,
        || Ok(drawing_ms(&at_one_place)),
        || Ok(drawing_ms(&spread)),
    )?;
    let row = |turns: Turns, what: &str| turns.row(CONTENT, what, "ms").asked("ratio <= 2.0");
    Ok(vec![
        row(
            triangles,
            "build 60,000 triangles round one edge, against spread out",
        ),
        row(
            points,
            "draw 30,000 points at one place, against spread out, on the CPU",
        ),
    ])
}

fn building_ms(source: &SourceScene) -> anyhow::Result<f64> {
    let begun = Instant::now();
    black_box(build(source, &BuildOptions::default(), &|_, _| ())?);
    Ok(begun.elapsed().as_secs_f64() * 1e3)
}

/// What draws all units of a cloud.
fn drawn_from(cloud: SourceCloud) -> anyhow::Result<TwinScene> {
    let source = SourceScene {
        clouds: vec![cloud],
        ..SourceScene::default()
    };
    let built = build(&source, &BuildOptions::default(), &|_, _| ())?;
    let cloud = built.objects[0].shape.cloud().copied();
    let attributes = cloud.unwrap_or_default().attributes;
    let mut scene = TwinScene::new(&built.objects, &[]);
    for (number, unit) in (0..).zip(&built.units) {
        let octant = unit.row.replaces.first().map(|it| it.part);
        scene.upload(&Coming {
            unit: foveal_core::pack::unit::UnitId(number),
            object: 0,
            level: unit.level,
            needs: &unit.row.needs,
            part: octant,
            payload: PayloadView::Points(&PointUnit::parse(&unit.payload, attributes)?),
        })?;
    }
    Ok(scene)
}

/// Milliseconds by the clock of a picture that the cloud fills.
fn drawing_ms(scene: &TwinScene) -> f64 {
    let view = EyeView {
        position: DVec3::new(0.0, 0.5, 3.5),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(80.0), PICTURE),
        size: PICTURE,
        eye: Default::default(),
    };
    let begun = Instant::now();
    black_box(scene.picture(&view, &SceneStyle::default()));
    begun.elapsed().as_secs_f64() * 1e3
}
