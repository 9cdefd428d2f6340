//! What do the points of a cloud cost, compared with LAZ?

use super::conditions::BenchConditions;
use super::row::{BenchRow, Turns, thread_ms_each};
use super::subject::Subject;
use crate::commands::simulate::moving::Mover;
use crate::commands::simulate::scene_errors::Judge;
use crate::commands::simulate::scoring::ScoringOptions;
use crate::gaze_source::{GazeChoice, ViewerModel};
use crate::report::output;
use foveal_core::content::payload::Payload;
use foveal_core::content::points::payload::{CloudPoint, PointUnit};
use foveal_core::content::policy::Policy;
use foveal_core::content::policy::asked::Detail;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::route::Route;
use foveal_play::{Player, PlayerOptions};
use foveal_render::DrawDevice;
use foveal_scene::laz_whole::LazWhole;
use foveal_scene::source::SourceCloud;
use std::hint::black_box;

/// Steps of a budget within which error must fall.
const STEPS: u32 = 12;
/// Seconds between two pictures.
const INTERVAL: f64 = 0.1;
const SIZE: [u32; 2] = [960, 600];
const ACROSS_DEG: f64 = 90.0;

/// Bytes, decoding, and whether error falls with every step of a budget.
pub(super) fn points(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let clouds = clouds(subject)?;
    if clouds.is_empty() {
        return Ok(Vec::new());
    }
    let packed = clouds
        .into_iter()
        .map(|points| LazWhole::encode(points.into_iter()));
    let packed = packed.collect::<Result<Vec<_>, _>>()?;
    let mut rows = vec![
        bytes(subject, &packed)?,
        decoding(subject, conditions, &packed)?,
    ];
    if matches!(conditions.drawing, DrawDevice::Nothing) {
        output::say("points: nothing draws; give --renderer gpu or cpu");
    } else {
        rows.push(falling(subject, conditions)?);
    }
    Ok(rows)
}

/// The points of each cloud: in the order of its file, or, of a pack, in that of its units.
fn clouds(subject: &Subject) -> anyhow::Result<Vec<Vec<CloudPoint>>> {
    if let Some(source) = &subject.source {
        return Ok(source.clouds.iter().map(of_file).collect());
    }
    let objects = &subject.file.pack().description().objects;
    let mut clouds = vec![Vec::new(); objects.len()];
    for unit in subject.file.pack().units() {
        if let Payload::Points(says) = subject.file.read_unit(unit)? {
            clouds[usize::from(subject.file.pack().row(unit).object)].extend(says.points);
        }
    }
    clouds.retain(|points| !points.is_empty());
    Ok(clouds)
}

fn of_file(cloud: &SourceCloud) -> Vec<CloudPoint> {
    let point = |k: usize| CloudPoint {
        place: cloud.places[k].map(|it| it as u32),
        colour: cloud.colours.get(k).copied().unwrap_or_default(),
        intensity: cloud.intensities.get(k).copied().unwrap_or_default(),
        class: cloud.classes.get(k).copied().unwrap_or_default() & 31,
    };
    (0..cloud.places.len()).map(point).collect()
}

/// The chunks of all units of points, and what their points have.
fn bytes(subject: &Subject, packed: &[LazWhole]) -> anyhow::Result<BenchRow> {
    let (mut ours, mut points) = (0.0, 0.0);
    for unit in subject.file.pack().units() {
        if subject.file.scene().object_of(unit).shape.cloud().is_some() {
            ours += f64::from(subject.file.pack().entry(unit).bytes);
            points += f64::from(subject.file.pack().row(unit).samples);
        }
    }
    let theirs: usize = packed.iter().map(LazWhole::bytes).sum();
    let each = |bytes: f64| bytes / points;
    let turns = Turns::once(each(ours), Some(each(theirs as f64)));
    let row = turns.row(
        &subject.name,
        "all that points have, against LAZ",
        "bytes a point",
    );
    Ok(row.asked("ratio <= 1.0").with("points", points))
}

fn decoding(
    subject: &Subject,
    conditions: &BenchConditions,
    packed: &[LazWhole],
) -> anyhow::Result<BenchRow> {
    let mut units = Vec::new();
    for unit in subject.file.pack().units() {
        if let Some(cloud) = subject.file.scene().object_of(unit).shape.cloud() {
            units.push((subject.file.read_chunk(unit)?, cloud.attributes));
        }
    }
    let rate = |points: usize, ms: f64| points as f64 / ms / 1e3;
    let turns = Turns::take(
        conditions.runs,
        || {
            let mut points = 0;
            let ms = thread_ms_each(|| {
                points = 0;
                for (chunk, attributes) in &units {
                    points += black_box(PointUnit::parse(chunk, *attributes)?)
                        .points
                        .len();
                }
                Ok(())
            })?;
            Ok(rate(points, ms))
        },
        || {
            let mut points = 0;
            let ms = thread_ms_each(|| {
                points = 0;
                for whole in packed {
                    points += black_box(whole.decode()?);
                }
                Ok(())
            })?;
            Ok(rate(points, ms))
        },
    )?;
    let row = turns.row(
        &subject.name,
        "decode points, against LAZ",
        "million points/s",
    );
    Ok(row.asked("ratio >= 10"))
}

/// Steps of a budget after which the picture is farther from the whole than before.
fn falling(subject: &Subject, conditions: &BenchConditions) -> anyhow::Result<BenchRow> {
    let pack = subject.file.pack();
    let bytes: u64 = pack.index().bytes_per_level().iter().sum();
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::of_larger_side(Radians::from_degrees(ACROSS_DEG), SIZE),
        size: SIZE,
        eye: Default::default(),
    };
    let config = Detail::Usual.of(Policy::Uniform);
    let options = PlayerOptions {
        bytes_per_s: bytes as f64 / f64::from(STEPS) / INTERVAL,
        ..PlayerOptions::new(config.clone(), &conditions.drawing, output::say)
    };
    let mut player = Player::of_scene(&subject.file, options)?;
    let route = (Route::Still, subject.file.scene().bounds());
    let length = Seconds(f64::from(STEPS) * INTERVAL);
    let gaze = GazeChoice::At([0.0; 2]);
    let mover = Mover::new(route, &gaze, 1, length, &ViewerModel::default())?;
    let mut mover = mover.through(view);
    let scoring = ScoringOptions::unasked();
    let mut judge = Judge::open(&scoring, &subject.file, &[view], &conditions.drawing, None)?;
    let mut errors: Vec<f64> = Vec::new();
    for step in 0..=STEPS {
        let time = Seconds(f64::from(step) * INTERVAL);
        let standing = mover.at(time, &config.perception);
        let report = player.stand(time, &standing.moment)?;
        let judged = judge.frame(&mut player, &standing, &report)?;
        errors.extend(judged.map(|it| it.all));
    }
    let rises = errors.windows(2).filter(|pair| pair[1] > pair[0]).count();
    let what = format!("steps of {STEPS} of a budget at which error rises");
    let row = Turns::once(rises as f64, None).row(&subject.name, what, "steps");
    let row = row.asked("ours = 0");
    let ends = errors.first().zip(errors.last());
    Ok(match ends {
        Some((first, last)) => row.with("first_error", *first).with("last_error", *last),
        None => row,
    })
}
