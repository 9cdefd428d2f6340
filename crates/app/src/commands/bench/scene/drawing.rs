//! How much is drawn under `acuity`, against `viewport`?

use super::conditions::BenchConditions;
use super::place::{Extent, looking};
use super::row::{BenchRow, Turns};
use super::subject::Subject;
use crate::commands::score::{DeviceName, Engine, LastGaze, display_of_view, from_image};
use crate::report::output;
use anyhow::Context;
use foveal_core::content::policy::asked::Detail;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::perception::moment::Moment;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Projection;
use foveal_eval::score::{Mode, Viewing};
use foveal_play::{Player, PlayerOptions};
use foveal_render::{DrawDevice, RgbaImage};
use std::time::Instant;

/// Across the views, in degrees.
const ACROSS_DEG: [f64; 2] = [60.0, 100.0];

/// A player of the scene under a policy, with all at hand.
pub(super) fn player(
    subject: &Subject,
    conditions: &BenchConditions,
    config: PolicyConfig,
    gpu_bytes: u64,
) -> anyhow::Result<Player> {
    let options = PlayerOptions {
        gpu_bytes,
        ..PlayerOptions::new(config, &conditions.drawing, output::say)
    };
    Ok(Player::of_scene(&subject.file, options)?)
}

/// Triangles that are drawn and how long that takes, through a narrow and a wide view.
pub(super) fn triangles(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    if matches!(conditions.drawing, DrawDevice::Nothing) {
        output::say("triangles: nothing draws; give --renderer gpu or cpu");
        return Ok(Vec::new());
    }
    let extent = Extent::of(subject);
    let mut rows = Vec::new();
    for across in ACROSS_DEG {
        let view = extent.view(across);
        rows.extend(through(
            subject,
            conditions,
            &looking(view, [0.0; 2]),
            across,
        )?);
    }
    Ok(rows)
}

fn through(
    subject: &Subject,
    conditions: &BenchConditions,
    moment: &Moment,
    across: f64,
) -> anyhow::Result<[BenchRow; 2]> {
    let view = moment.views[0];
    let showing = |policy| {
        let mut player = player(subject, conditions, Detail::Usual.of(policy), u64::MAX / 4)?;
        player.stand(Seconds(0.0), moment)?;
        anyhow::Ok(player)
    };
    let [mut acuity, mut viewport] = [showing(Policy::Acuity)?, showing(Policy::Viewport)?];
    let times = Turns::take(
        conditions.runs,
        || drawing_ms(&mut acuity, &view),
        || drawing_ms(&mut viewport, &view),
    )?;
    // What is drawn is known once it was.
    let drawn = |player: &mut Player| player.triangles_drawn() as f64;
    let counts = Turns::once(drawn(&mut acuity), Some(drawn(&mut viewport)));
    let picture = picture(&mut acuity, &view)?;
    drop((acuity, viewport));
    let whole = self::picture(&mut showing(Policy::Full)?, &view)?;
    let jod = jod([&whole, &picture], moment)?;
    let name = |what: &str| format!("{what}, acuity against viewport, {across}°");
    Ok([
        counts
            .row(&subject.name, name("triangles drawn"), "triangles")
            .asked("ratio <= 0.6")
            .with("acuity_jod", jod),
        times
            .row(&subject.name, name("drawing"), "ms")
            .with("acuity_jod", jod),
    ])
}

fn picture(player: &mut Player, view: &EyeView) -> anyhow::Result<RgbaImage> {
    player
        .picture(view, false)?
        .context("what draws has a picture")
}

/// Milliseconds by the clock until a picture is in main memory.
fn drawing_ms(player: &mut Player, view: &EyeView) -> anyhow::Result<f64> {
    let begun = Instant::now();
    picture(player, view)?;
    Ok(begun.elapsed().as_secs_f64() * 1e3)
}

/// The score of a picture against the whole.
fn jod([whole, picture]: [&RgbaImage; 2], moment: &Moment) -> anyhow::Result<f64> {
    let view = moment.views[0];
    let display = display_of_view(&view, Projection::Cube);
    let viewing = Viewing::new(display, view.size, None, true, Mode::Compat)?;
    let mut engine = Engine::open(DeviceName::Cpu, &viewing, output::jobs(None)?)?;
    let gaze_px = LastGaze::new(&view).in_view(&view, &moment.gaze);
    engine.frame(&from_image(whole)?, &from_image(picture)?, gaze_px)?;
    Ok(engine.score()?.jod)
}
