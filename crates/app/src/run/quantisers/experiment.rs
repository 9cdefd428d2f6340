//! Which quantisers leave equally visible noise in tiles of different light and texture?

use super::*;
use foveal_core::view::random::Random;
use foveal_media::Rate;
use foveal_media::VideoInput;
use foveal_media::prepare::{PrepareSettings, Quality, TileLook, coded};

/// Quantisers that every tile is coded with.
const TRIED: [u8; 12] = [3, 4, 6, 8, 11, 14, 18, 23, 29, 36, 44, 54];
/// Share of the tiles that are looked at.
const LOOKED_AT: f64 = 0.5;

/// Prints of each tile its light and texture, and of each quantiser the JOD that a still and a
/// moving picture lose to an eye that looks at its middle, and the bytes:
///
/// `FOVEAL_CLIPS=a.mp4:b.mkv cargo test --release --bin foveal noise_of_tiles -- --ignored
/// --nocapture`
#[test]
#[ignore = "a measurement"]
fn noise_of_tiles() {
    let clips = std::env::var("FOVEAL_CLIPS").unwrap_or_default();
    let mut random = Random::new(1);
    for clip in clips.split(':').filter(|clip| !clip.is_empty()) {
        let input = Path::new(clip);
        let settings = PrepareSettings {
            quality: Some(Quality::Auto),
            ..PrepareSettings::default()
        };
        let info = VideoInput::open(input).unwrap().info().clone();
        let plan = Plan::new(input, &info, &settings).unwrap();
        for window in sample_windows(input, &plan) {
            for group in window.groups() {
                if random.unit() < LOOKED_AT {
                    print_tile(clip, &plan, (&window, group));
                }
            }
        }
    }
}

fn print_tile(clip: &str, plan: &Plan, (window, group): (&SampleWindow, &[Picture])) {
    let size = [group[0].width, group[0].height];
    if size.iter().any(|side| *side < LEAST_SIDE) {
        return;
    }
    let look = TileLook::of(&group[0], plan.colour());
    let whole = display_of(plan, window);
    let extent = [0, 1].map(|k| {
        let share = f64::from(size[k]) / f64::from(window.size[k]);
        2.0 * ((whole.fov_deg()[k] * share).to_radians() / 2.0).tan()
    });
    let light = match plan.description.projection {
        Projection::Flat => Photometry::DESK,
        Projection::Cube | Projection::Equirect => Photometry::HEADSET,
    };
    let display = Display::of("tile", size, extent, light);
    let gaze = size.map(|side| f64::from(side) / 2.0);
    let seen: Vec<ScorePicture> = group
        .iter()
        .filter_map(|it| score_picture(plan, it))
        .collect();
    let mut line = format!("{clip},{:.2},{:.3}", look.light, look.texture);
    for quantiser in TRIED {
        let (shown, bytes) = coded(plan, Rate::Quantiser(quantiser), group).unwrap();
        let shown: Vec<ScorePicture> = shown
            .iter()
            .filter_map(|it| score_picture(plan, it))
            .collect();
        let lost = |fps: Option<f64>, frames: &[usize]| {
            let viewing = Viewing::new(display.clone(), size, fps, true, Mode::Compat).unwrap();
            let mut judge = Judge::new(&viewing, 1).unwrap();
            for frame in frames.iter().filter(|frame| **frame < seen.len()) {
                judge.frame(&seen[*frame], &shown[*frame], gaze).unwrap();
            }
            10.0 - judge.score().map_or(10.0, |score| score.jod)
        };
        let still = lost(None, &STILLS);
        let moving = lost(Some(plan.description.fps()), &[0, 1, 2, 3, 4, 5, 6, 7]);
        line += &format!(",{still:.4},{moving:.4},{bytes}");
    }
    println!("{line}");
}
