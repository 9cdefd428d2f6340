//! How far is the finest level of a pack from its source, to an eye that looks there?
//!
//! Nine gazes, each in a view of about a pixel of the source a pixel; frames are judged as stills.
//! The pack is drawn by the CPU twin and figures are rounded, so that packs do not depend on
//! machine and threads.

use crate::commands::score::{display_of_view, picture_of};
use crate::report::output;
use crate::run::in_parallel::in_parallel;
use crate::run::open_player::open_player;
use crate::run::source_frames::SourceFrames;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::description::{Description, Loss};
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::tracker::Prediction;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::{Eye, Screen, Surface};
use foveal_eval::score::companion::{Companion, CompanionJudge};
use foveal_eval::score::pooling::Pool;
use foveal_eval::score::{Judge, Mode, ScorePicture, Viewing};
use foveal_media::pack::pack_file::PackFile;
use foveal_media::prepare::{PreparationPlan as Plan, Surround};
use foveal_media::sphere::Coverage;
use foveal_play::Decoding;
use foveal_play::WatchedFrame;
use foveal_play::{FrameOptions, PlayerOptions};
use foveal_render::DrawDevice;
use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

/// Largest view, in pixels: nine of three frames take about five seconds of a processor.
const LARGEST_VIEW: [u32; 2] = [480, 300];
/// Smallest side of a view of a sphere, in pixels: that of a score.
const LEAST_SIDE: u32 = 16;
/// Pixels of the source that are read at most: half a minute of film, or less.
const MOST_READ: u64 = 1 << 30;
/// Where in a flat picture the gazes are, in sixths of its width and height.
const SIXTHS: [u32; 3] = [1, 3, 5];
/// Where on a sphere they are, in degrees.
const YAWS: [f64; 3] = [-120.0, 0.0, 120.0];
const PITCHES: [f64; 3] = [-45.0, 0.0, 45.0];

/// A view, and the gazes in it: pixels, 0 the middle of the first one.
struct Scene {
    view: EyeView,
    head: HeadPose,
    gazes: Vec<[f64; 2]>,
}

/// What preparing as planned lost of `source`; none where its pictures are too small for a score.
pub(crate) fn loss_of(
    source: &Path,
    pack: &Path,
    plan: &Plan,
    jobs: usize,
) -> anyhow::Result<Option<Loss>> {
    let file = Arc::new(PackFile::open(pack)?);
    let about = file.pack().description();
    let surface = about.grid(Screen::default()).surface;
    let scenes = match plan.surround {
        Surround::Flat => flat_scenes(&surface),
        _ => sphere_scenes(plan, &surface),
    };
    let display = display_of_view(&scenes[0].view, surface.projection);
    let size = scenes[0].view.size;
    let Ok(viewing) = Viewing::new(display, size, None, true, Mode::Compat) else {
        return Ok(None);
    };
    let frames = frames_of(about);
    let views: Vec<EyeView> = scenes.iter().map(|scene| scene.view).collect();
    let mut source = SourceFrames::planned(source, &file, plan, Screen::default(), jobs)?;
    let seen = frames.iter().map(|frame| source.seen(*frame, &views));
    let seen = seen.collect::<anyhow::Result<Vec<_>>>()?;
    let shown = in_parallel(jobs, &scenes, |scene| draw(&file, scene, &frames))?;
    let mut noise = CompanionJudge::new(Companion::Psnr, &viewing)?;
    let mut judge = Judge::new(&viewing, jobs)?;
    let mut worst = f64::INFINITY;
    for (number, (scene, shown)) in scenes.iter().zip(&shown).enumerate() {
        let pairs = || seen.iter().map(|seen| &seen[number]).zip(shown);
        for (seen, shown) in pairs() {
            noise.frame(seen, shown, scene.gazes[0])?;
        }
        for gaze_px in &scene.gazes {
            let mut pool = Pool::default();
            for (seen, shown) in pairs() {
                pool.add(&judge.frame(seen, shown, *gaze_px)?);
            }
            let jod = pool.score(&[]).map(|score| score.jod);
            worst = jod.map_or(worst, |jod| worst.min(jod));
        }
    }
    let hundredths = |value: f64| (value * 100.0).round() / 100.0;
    Ok(Some(Loss {
        psnr_db: Some(hundredths(noise.total())).filter(|decibels| decibels.is_finite()),
        jod: hundredths(worst),
    }))
}

/// The first, the middle and the last frame, as far as the source is read.
fn frames_of(about: &Description) -> Vec<u32> {
    let [w, h] = about.source.size.map(u64::from);
    let readable = (MOST_READ / (w * h).max(1)).max(1);
    let last = u64::from(about.frames).min(readable) as u32 - 1;
    let mut frames = vec![0, last / 2, last];
    frames.dedup();
    frames
}

/// Parts of a flat picture round its gazes, pixel for pixel; one that holds several is seen once.
fn flat_scenes(surface: &Surface) -> Vec<Scene> {
    let size = [0, 1].map(|k| surface.size[k].min(LARGEST_VIEW[k]));
    let mut scenes: Vec<Scene> = Vec::new();
    for sixth in SIXTHS.into_iter().flat_map(|y| SIXTHS.map(|x| [x, y])) {
        let gaze = [0, 1].map(|k| f64::from(surface.size[k] * sixth[k]) / 6.0);
        let corner = [0, 1].map(|k| {
            let left = gaze[k] - f64::from(size[k]) / 2.0;
            (left.max(0.0) as u32).min(surface.size[k] - size[k])
        });
        let view = EyeView::of_part(surface, corner, size);
        let gaze_px = [0, 1].map(|k| gaze[k] - f64::from(corner[k]) - 0.5);
        match scenes.iter_mut().find(|scene| scene.view == view) {
            Some(scene) => scene.gazes.push(gaze_px),
            None => scenes.push(Scene {
                view,
                head: HeadPose::default(),
                gazes: vec![gaze_px],
            }),
        }
    }
    scenes
}

/// Views of the source's density round a sphere; of one that is not whole, where it is.
fn sphere_scenes(plan: &Plan, surface: &Surface) -> Vec<Scene> {
    let source = plan.description.source.size;
    let [w, h] = plan.eyes.eye_size(source).unwrap_or(source).map(f64::from);
    // Squeezed across or down, the longer side says how much detail there is.
    let (pixel, yaws) = match plan.surround {
        Surround::Equirect(Coverage::FrontHalf) => (TAU / (2.0 * w.max(h)), 0.5),
        Surround::Equirect(Coverage::Full) => (TAU / w.max(2.0 * h), 1.0),
        Surround::Flat | Surround::Cube(_) => (surface.pitch(), 1.0),
    };
    let pitches = match plan.surround {
        Surround::Cube(layout) if layout.faces() == 4 => 0.5,
        _ => 1.0,
    };
    let quarter = TAU / pixel / 4.0;
    let shape = [1.0, f64::from(LARGEST_VIEW[1]) / f64::from(LARGEST_VIEW[0])];
    let size = [0, 1].map(|k| ((quarter * shape[k]) as u32).clamp(LEAST_SIDE, LARGEST_VIEW[k]));
    let towards = |[yaw, pitch]: [f64; 2]| {
        let head = HeadPose {
            yaw: Radians::from_degrees(yaw * yaws),
            pitch: Radians::from_degrees(pitch * pitches),
            ..HeadPose::default()
        };
        let view = EyeView {
            position: Default::default(),
            axes: head.axes(),
            field: Field::symmetric(size.map(|side| f64::from(side) * pixel / 2.0)),
            size,
            eye: Eye::Left,
        };
        let gazes = vec![size.map(|side| f64::from(side - 1) / 2.0)];
        Scene { view, head, gazes }
    };
    let all = PITCHES.into_iter().flat_map(|p| YAWS.map(|y| [y, p]));
    all.map(towards).collect()
}

/// What the finest level shows in a scene, frame by frame.
fn draw(file: &Arc<PackFile>, scene: &Scene, frames: &[u32]) -> anyhow::Result<Vec<ScorePicture>> {
    let config = PolicyConfig::new(Policy::Viewport);
    let player = PlayerOptions::new(config, &DrawDevice::Twin, output::say);
    let options = FrameOptions {
        decoding: Decoding::on(1),
        ..FrameOptions::new(player, scene.view)
    };
    let mut player = open_player(file, options)?;
    let look = |time: Seconds| {
        let gaze = GazeSample {
            time,
            received: time,
            gaze_in_content: scene.view.axes.forward,
            valid: true,
            spread: Radians(0.0),
            head: None,
        };
        WatchedFrame {
            gaze,
            gaze_is_known: true,
            head: scene.head,
            expected: Prediction {
                gaze,
                event: EyeEvent::Fixation,
                since_saccade: None,
            },
            head_expected: scene.head,
        }
    };
    let draw = |frame: &u32| {
        let look = look(player.time(*frame));
        let report = player.show(*frame, &look)?;
        picture_of(&mut player, &report.view)
    };
    frames.iter().map(draw).collect()
}
