//! How many bytes come before the fovea is sharp?

use super::conditions::BenchConditions;
use super::row::{BenchRow, Turns};
use super::subject::Subject;
use crate::commands::simulate::moving::Mover;
use crate::commands::simulate::scene_errors::Judge;
use crate::commands::simulate::scoring::ScoringOptions;
use crate::gaze_source::{GazeChoice, ViewerModel};
use crate::report::output;
use foveal_core::content::policy::Policy;
use foveal_core::content::policy::asked::Detail;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::route::Route;
use foveal_play::{Player, PlayerOptions};
use foveal_render::DrawDevice;

/// Where the eye looks, in degrees to the right and up.
const GAZES: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [8.0, 4.0],
    [-9.0, 6.0],
    [12.0, -7.0],
    [-5.0, -11.0],
];
/// What a link brings: 40 Mbit/s.
const BYTES_PER_S: f64 = 5e6;
/// Seconds between two pictures.
const INTERVAL: f64 = 1.0 / 60.0;
/// Pictures after which a fovea that is not sharp will not become so.
const MOST_FRAMES: u32 = 1200;
/// The largest error of a sharp fovea, as a share of its light.
const SHARP: f64 = 0.01;
const SIZE: [u32; 2] = [1280, 800];
const ACROSS_DEG: f64 = 90.0;

/// Bytes under `perceptual` against `uniform` and `eccentricity`, and under `eccentricity` against
/// `uniform`, gaze by gaze.
pub(super) fn bytes_to_fovea(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    if matches!(conditions.drawing, DrawDevice::Nothing) {
        output::say("fovea: nothing draws; give --renderer gpu or cpu");
        return Ok(Vec::new());
    }
    let policies = [Policy::Perceptual, Policy::Eccentricity, Policy::Uniform];
    let mut runs = [const { Vec::new() }; 3];
    let mut missed = [0.0; 3];
    for gaze in GAZES {
        for (at, policy) in policies.into_iter().enumerate() {
            let (bytes, is_sharp) = bytes_of(subject, conditions, policy, gaze)?;
            runs[at].push(bytes);
            missed[at] += f64::from(u8::from(!is_sharp));
        }
    }
    let row = |ours: usize, baseline: usize| {
        let turns = Turns {
            ours: runs[ours].clone(),
            baseline: runs[baseline].clone(),
        };
        let [of, against] = [ours, baseline].map(|at| policies[at].name());
        let what = format!("until the fovea is sharp, {of} against {against}, 40 Mbit/s, 5 gazes");
        let row = turns.row(&subject.name, what, "bytes");
        row.with("never_sharp", missed[ours])
            .with("baseline_never_sharp", missed[baseline])
    };
    Ok(vec![
        row(0, 2).asked("ratio <= 0.35, bytes <= 220000"),
        row(0, 1).asked("ratio <= 1.0"),
        row(1, 2),
    ])
}

/// Bytes that came until the fovea was sharp, or all, and whether it was.
fn bytes_of(
    subject: &Subject,
    conditions: &BenchConditions,
    policy: Policy,
    gaze: [f64; 2],
) -> anyhow::Result<(f64, bool)> {
    let config = Detail::Usual.of(policy);
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::of_larger_side(Radians::from_degrees(ACROSS_DEG), SIZE),
        size: SIZE,
        eye: Default::default(),
    };
    let options = PlayerOptions {
        bytes_per_s: BYTES_PER_S,
        ..PlayerOptions::new(config.clone(), &conditions.drawing, output::say)
    };
    let mut player = Player::of_scene(&subject.file, options)?;
    let route = (Route::Still, subject.file.scene().bounds());
    let length = Seconds(f64::from(MOST_FRAMES) * INTERVAL);
    let viewer = ViewerModel::default();
    let mover = Mover::new(route, &GazeChoice::At(gaze), 1, length, &viewer)?;
    let mut mover = mover.through(view);
    let unasked = ScoringOptions::unasked();
    let mut judge = Judge::open(&unasked, &subject.file, &[view], &conditions.drawing, None)?;
    let mut bytes = subject.file.head_bytes();
    for frame in 0..MOST_FRAMES {
        let time = Seconds(f64::from(frame) * INTERVAL);
        let standing = mover.at(time, &config.perception);
        let report = player.stand(time, &standing.moment)?;
        bytes += report.new_bytes + report.page_bytes;
        let judged = judge.frame(&mut player, &standing, &report)?;
        if judged
            .and_then(|judged| judged.fovea)
            .is_some_and(|fovea| fovea <= SHARP)
        {
            return Ok((bytes as f64, true));
        }
    }
    Ok((bytes as f64, false))
}
