//! Where does the time of a preparation go?

use super::*;
use crate::generate::GeneratedScene;
use crate::read::source::SourceInfo;
use crate::tiles::encode_settings::{Rate, Speed};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::view::picture::{Colour, Matrix};
use std::time::Instant;

fn info([width, height]: [u32; 2]) -> SourceInfo {
    SourceInfo {
        width,
        height,
        frame_rate: [30, 1],
        frames: Some(8),
        frames_told: None,
        seconds: None,
        colour: Colour {
            matrix: Matrix::Bt709,
            full_range: false,
            chroma_left: false,
        },
        spherical: None,
        stereo: None,
        tags: Default::default(),
        broken_boxes: Vec::new(),
        camera: None,
        sound: None,
        transparency: None,
        pixel_aspect: None,
        is_hdr: false,
        is_interlaced: false,
        codec: "none".to_owned(),
        pixel_format: "yuv420p".to_owned(),
        bytes: 0,
        looks_still: false,
    }
}

/// Measures groups of all levels, finest first, as if they were coded without loss.
fn measure(plan: &PreparationPlan, groups: &[(u8, Vec<Picture>)]) {
    let (grid, about) = (&plan.grid, &plan.description);
    let notes = Notes::new(grid, about.colour);
    let mut shown = DecodedGroups::new(grid, about.colour, Codec::Png, &about.groups);
    let tiles = (0..grid.levels).flat_map(|level| grid.tiles_of(level));
    for (tile, (level, group)) in tiles.zip(groups) {
        notes.cues(*level, group);
        let group = shown.decoded(&[], group.clone()).unwrap();
        shown.push(*level, grid.rank(tile), group);
    }
    for level in 0..grid.levels {
        shown.measured(level, 1);
    }
}

/// `cargo test --release -p foveal-media speed_of_preparing -- --ignored --nocapture`
#[test]
#[ignore = "a measurement"]
fn speed_of_preparing() {
    let size = [4096, 2048];
    for (name, scene, projection) in [
        ("wide", GeneratedScene::wide(size), ProjectionChoice::Flat),
        (
            "sphere",
            GeneratedScene::panorama(size),
            ProjectionChoice::Equirect,
        ),
    ] {
        let settings = PrepareSettings {
            projection,
            ..PrepareSettings::default()
        };
        let plan = PreparationPlan::new(Path::new("none"), &info(size), &settings).unwrap();
        let pixels = f64::from(size[0] * size[1]) * 8.0 / 1e6;
        let say = |what: &str, begun: Instant| {
            let seconds = begun.elapsed().as_secs_f64();
            println!(
                "{name}: {what} {:.0} source MPix/s of one thread",
                pixels / seconds
            );
        };
        let frames: Vec<Picture> = (0..8).map(|n| scene.frame(n)).collect();
        let cutter = Cutter::new(&plan);
        let begun = Instant::now();
        let cut: Vec<_> = frames.iter().map(|frame| cutter.tiles_of(frame)).collect();
        say("cutting", begun);
        let groups: Vec<(u8, Vec<Picture>)> = (0..plan.grid.levels)
            .flat_map(|level| {
                let cut = &cut;
                (0..plan.grid.tiles_in_level(level) as usize).map(move |rank| {
                    let of = |frame: &Vec<Vec<Picture>>| frame[usize::from(level)][rank].clone();
                    (level, cut.iter().map(of).collect())
                })
            })
            .collect();
        let begun = Instant::now();
        measure(&plan, &groups);
        say("measuring", begun);
        for (codec, speed, rate) in [
            (Codec::Vp9, Speed::Default, 24),
            (Codec::Vp9, Speed::Fast, 24),
            (Codec::Vp9, Speed::Small, 24),
            (Codec::Jpeg, Speed::Default, 3),
        ] {
            let begun = Instant::now();
            let mut bytes = 0;
            for (level, group) in &groups {
                let settings = EncodeSettings {
                    codec,
                    rate: Rate::Quantiser(rate),
                    frame_rate: [30, 1],
                    speed: speed.at_level(*level),
                };
                let units = encode_group(&settings, group).unwrap();
                bytes += units.iter().map(Vec::len).sum::<usize>();
            }
            say(&format!("{codec:?} {speed:?}, {} kB,", bytes / 1000), begun);
        }
    }
}
