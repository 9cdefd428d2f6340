//! Do eyes and faces reach a pack as if each had been prepared alone?

use std::io::Cursor;

use av::ffi::AVPacketSideDataType as SideData;
use av::format::Pixel;
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Projection;

use crate::pack::pack_file::PackFile;
use crate::prepare::{PrepareSettings, ProjectionChoice, StereoChoice};
use crate::surround::cube_layout::CubeLayout;
use crate::surround::spherical_boxes::broken_boxes;
use crate::tests::scenes::{
    RawFile, Scratch, group, plan_of, prepared, raw, settings, write_clip, write_raw,
};
use crate::{ClipCodec, VideoInput};

const FRAMES: u32 = 3;

/// Pictures put together in columns and rows, in reading order.
fn joined(columns: usize, parts: &[Picture]) -> Picture {
    let [w, h] = [parts[0].width, parts[0].height];
    let planes = [0, 1, 2].map(|p| {
        let width = parts[0].plane_size(p)[0] as usize;
        let mut plane = Vec::new();
        for row in parts.chunks(columns) {
            for y in 0..parts[0].plane_size(p)[1] as usize {
                row.iter().for_each(|part| {
                    plane.extend_from_slice(&part.planes[p][y * width..][..width]);
                });
            }
        }
        plane
    });
    Picture {
        width: w * columns as u32,
        height: h * (parts.len() / columns) as u32,
        planes,
    }
}

/// The frames of several clips, put together.
fn together(columns: usize, clips: &[Vec<Picture>]) -> Vec<Picture> {
    let frame =
        |frame: usize| -> Vec<Picture> { clips.iter().map(|clip| clip[frame].clone()).collect() };
    (0..clips[0].len())
        .map(|f| joined(columns, &frame(f)))
        .collect()
}

/// Every chunk of the faces `first..` of a pack, and those of a pack of these faces alone.
fn assert_same_chunks(pack: &PackFile, first: u32, alone: &PackFile) {
    let (grid, one) = (*pack.pack().grid(), *alone.pack().grid());
    for level in 0..one.levels {
        for tile in one.tiles_of(level) {
            let mut there = tile;
            there.face += first as u8;
            assert_eq!(grid.tile_size(there), one.tile_size(tile));
            let chunk = pack.read_chunk(pack.pack().unit(there, 0)).unwrap();
            let expected = alone.read_chunk(alone.pack().unit(tile, 0)).unwrap();
            assert!(chunk == expected, "{there:?}");
        }
    }
}

fn with(projection: ProjectionChoice, stereo: StereoChoice) -> PrepareSettings {
    PrepareSettings {
        stereo,
        ..settings(projection, Codec::Vp9)
    }
}

#[test]
fn each_eye_is_prepared_as_it_would_be_alone() {
    for (projection, size) in [
        (ProjectionChoice::Flat, [96, 64]),
        (ProjectionChoice::Equirect, [128, 64]),
        (ProjectionChoice::HalfEquirect, [64, 64]),
        (ProjectionChoice::Cube, [96, 64]),
    ] {
        let eyes = [1, 5].map(|seed| group(size, FRAMES, seed));
        let alone = eyes.clone().map(|eye| {
            let clip = write_clip("mkv", ClipCodec::Ffv1, &eye);
            prepared(&clip, &with(projection, StereoChoice::Mono))
        });
        let alone = alone.each_ref().map(|pack| PackFile::open(pack).unwrap());
        for (stereo, columns) in [(StereoChoice::SideBySide, 2), (StereoChoice::TopBottom, 1)] {
            let clip = write_clip("mkv", ClipCodec::Ffv1, &together(columns, &eyes));
            let pack = PackFile::open(&prepared(&clip, &with(projection, stereo))).unwrap();
            let surface = pack.pack().grid().surface;
            assert_eq!((surface.eyes, pack.verify(|_, _| {}).places()), (2, 0));
            for (eye, alone) in (0..).zip(&alone) {
                assert_same_chunks(&pack, eye * surface.faces_of_an_eye(), alone);
            }
        }
    }
}

#[test]
fn a_cube_keeps_its_faces_pixel_for_pixel() {
    let faces: Vec<Vec<Picture>> = (0..6).map(|seed| group([32, 32], FRAMES, seed)).collect();
    for (columns, order, count) in [(3, &[4, 0, 5, 1, 2, 3][..], 6), (4, &[1, 2, 3, 0][..], 4)] {
        let clip = together(columns, &faces[..count]);
        let clip = write_clip("mkv", ClipCodec::Ffv1, &clip);
        let settings = with(ProjectionChoice::Cube, StereoChoice::Auto);
        let pack = PackFile::open(&prepared(&clip, &settings)).unwrap();
        let about = pack.pack().description();
        assert_eq!((about.projection, about.size), (Projection::Cube, [32, 32]));
        assert_eq!(usize::from(about.cube_faces), count);
        assert!(about.colour.chroma_left, "chroma stays where it lay");
        for (face, place) in (0..).zip(order) {
            let alone = write_clip("mkv", ClipCodec::Ffv1, &faces[*place]);
            let alone = prepared(&alone, &with(ProjectionChoice::Flat, StereoChoice::Auto));
            assert_same_chunks(&pack, face, &PackFile::open(&alone).unwrap());
        }
    }
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|n| n.to_ne_bytes()).collect()
}

/// A clip of one grey frame with this spherical mapping and stereo layout in its metadata.
fn told(size: [u32; 2], mapping: &[u32; 9], stereo: Option<[u32; 3]>) -> Scratch {
    let mut side_data = vec![(SideData::AV_PKT_DATA_SPHERICAL, words(mapping))];
    side_data.extend(stereo.map(|s| (SideData::AV_PKT_DATA_STEREO3D, words(&s))));
    let right_first = stereo.is_some_and(|stereo| stereo[1] == 1);
    let file = RawFile {
        side_data: &side_data,
        // MP4 has no word for the right eye first.
        ..raw(
            "mjpeg",
            if right_first { "mkv" } else { "mp4" },
            Pixel::YUVJ420P,
            size,
        )
    };
    write_raw(&file, 1, |_, _, _, _| 90)
}

const QUARTER: u32 = 1 << 30;

#[test]
fn metadata_says_how_the_eyes_are_surrounded() {
    let whole = [0; 9];
    let half = [2, 0, 0, 0, QUARTER, 0, QUARTER, 0, 0];
    let cube = [1, 0, 0, 0, 0, 0, 0, 0, 2];
    for (size, mapping, stereo, eyes, face) in [
        ([128, 64], whole, None, 1, 32),
        ([128, 128], whole, Some([2, 0, 0]), 2, 32),
        ([256, 64], whole, Some([1, 1, 0]), 2, 32),
        ([128, 64], half, Some([1, 0, 0]), 2, 32),
        ([96, 64], cube, None, 1, 28),
        ([192, 64], cube, Some([1, 0, 0]), 2, 28),
    ] {
        let clip = told(size, &mapping, stereo);
        let plan = plan_of(&clip, &settings(ProjectionChoice::Auto, Codec::Png)).unwrap();
        let about = &plan.description;
        assert_eq!(
            (about.eyes, about.size),
            (eyes, [face; 2]),
            "{:?}",
            plan.remarks
        );
        assert_eq!(
            plan.eyes.right_first,
            stereo.is_some_and(|stereo| stereo[1] == 1)
        );
        assert!(
            plan.remarks
                .all()
                .iter()
                .any(|note| note.contains("metadata") || eyes == 1)
        );
    }
}

#[test]
fn frames_that_do_not_split_are_refused_with_what_to_do() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([66, 64], 1, 1));
    for (projection, stereo, word) in [
        (
            ProjectionChoice::Auto,
            StereoChoice::SideBySide,
            "--stereo mono",
        ),
        (ProjectionChoice::Cube, StereoChoice::Auto, "no cube"),
    ] {
        let error = plan_of(&clip, &with(projection, stereo))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(word) && error.contains("ffmpeg -i"),
            "{error}"
        );
    }
}

#[test]
fn a_squeezed_pair_is_shown_in_its_true_shape_and_that_is_said() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([192, 108], 1, 1));
    for (stereo, size, aspect) in [
        (StereoChoice::SideBySide, [96, 108], [2, 1]),
        (StereoChoice::TopBottom, [192, 54], [1, 2]),
    ] {
        let plan = plan_of(&clip, &with(ProjectionChoice::Flat, stereo)).unwrap();
        assert_eq!(plan.description.size, size);
        assert_eq!(plan.description.pixel_aspect, aspect);
        let [w, h] = plan.grid.surface.tangents;
        assert!((w / h - 16.0 / 9.0).abs() < 1e-9);
        assert!(
            plan.remarks.all().join(" ").contains("half the"),
            "{:?}",
            plan.remarks
        );
    }
}

#[test]
fn damaged_boxes_of_projection_and_stereo_are_survived() {
    let clip = told(
        [128, 64],
        &[2, 5 << 16, 0, 0, QUARTER, 0, QUARTER, 0, 0],
        Some([1, 0, 0]),
    );
    let good = std::fs::read(&*clip).unwrap();
    let place = |name: &[u8]| good.windows(4).position(|four| four == name).unwrap();
    let (from, to) = (place(b"st3d") - 4, place(b"proj") + 60);
    let mut opened = 0;
    for at in from..to.min(good.len()) {
        for wrong in [0x00, 0x7f, 0xff, good[at] ^ 1] {
            let mut bad = good.clone();
            bad[at] = wrong;
            let bad = Scratch::holding("mp4", &bad);
            if let Ok(input) = VideoInput::open(&bad) {
                let settings = settings(ProjectionChoice::Auto, Codec::Png);
                opened += u32::from(plan_of(&bad, &settings).is_ok());
                assert!(input.info().width > 0);
            }
        }
    }
    assert!(opened > 0, "most damage leaves a readable file");
}

/// A clip of both eyes of 180° whose box `name` is changed by `change` from its letters on.
fn with_box(name: &[u8; 4], change: impl Fn(&mut [u8])) -> Scratch {
    let clip = told(
        [128, 64],
        &[2, 5 << 16, 0, 0, QUARTER, 0, QUARTER, 0, 0],
        Some([1, 0, 0]),
    );
    let mut bytes = std::fs::read(&*clip).unwrap();
    let at = bytes.windows(4).position(|four| four == name).unwrap();
    change(&mut bytes[at..]);
    Scratch::holding("mp4", &bytes)
}

#[test]
fn a_broken_box_is_named_with_its_place_and_hidden_as_the_error_says() {
    let cases = [
        (b"equi", 8, [0xff; 4], "cuts off more"),
        (b"svhd", 0, *b"proj", "header"),
        (b"proj", 0, *b"prxj", "no projection"),
    ];
    for (name, at, bytes, word) in cases {
        let clip = with_box(name, |b| b[at..at + 4].copy_from_slice(&bytes));
        let settings = settings(ProjectionChoice::Auto, Codec::Png);
        let said = match plan_of(&clip, &settings) {
            Ok(plan) => plan.remarks.all().join("; "),
            Err(error) => error.to_string(),
        };
        assert!(
            said.contains("sv3d box, at byte") && said.contains(word),
            "{said}"
        );
        let place = said.split("at byte ").nth(1).unwrap();
        let at: usize = place.split([',', ' ']).next().unwrap().parse().unwrap();
        let mut bytes = std::fs::read(&*clip).unwrap();
        assert_eq!(&bytes[at..at + 4], b"sv3d");
        bytes[at..at + 4].copy_from_slice(b"free");
        let plan = plan_of(&Scratch::holding("mp4", &bytes), &settings).unwrap();
        let notes = plan.remarks.all().join("; ");
        assert!(
            !notes.contains("sv3d") && notes.contains("side by side"),
            "{notes}"
        );
    }
}

#[test]
fn eyes_that_are_told_twice_or_in_an_unknown_way_are_told() {
    let unknown = with_box(b"st3d", |b| b[8] = 9);
    let plan = plan_of(&unknown, &settings(ProjectionChoice::Auto, Codec::Png)).unwrap();
    assert!(
        plan.remarks.all().join(" ").contains("says 9"),
        "{:?}",
        plan.remarks
    );
    // The sphere's box becomes a second one about the eyes.
    let twice = with_box(b"sv3d", |b| b[..4].copy_from_slice(b"st3d"));
    let error = VideoInput::open(&twice).err().unwrap().to_string();
    assert!(
        error.contains("second one") && error.contains("dd of=COPY"),
        "{error}"
    );
}

#[test]
fn a_box_that_ends_within_its_numbers_is_not_believed() {
    // FFmpeg reads on in what follows the box, and so takes a sphere for a part of one.
    let clip = with_box(b"equi", |b| {
        // Of its 28 bytes 12 are left; the others become a box of their own.
        b[8..12].copy_from_slice(&[0, 0, 0, 16]);
        b[12..16].copy_from_slice(b"free");
    });
    let mut bytes = std::fs::read(&*clip).unwrap();
    let at = bytes.windows(4).position(|four| four == b"equi").unwrap();
    bytes[at - 4..at].copy_from_slice(&12_u32.to_be_bytes());
    let clip = Scratch::holding("mp4", &bytes);
    let plan = plan_of(&clip, &settings(ProjectionChoice::Auto, Codec::Png)).unwrap();
    let notes = plan.remarks.all().join("; ");
    assert!(notes.contains("ends within the numbers"), "{notes}");
    assert_eq!(VideoInput::open(&clip).unwrap().info().spherical, None);
}

#[test]
fn a_box_that_is_shorter_than_its_head_is_told() {
    for name in [b"st3d", b"sv3d"] {
        let mut bytes = std::fs::read(&*with_box(name, |_| ())).unwrap();
        let at = bytes.windows(4).position(|four| four == name).unwrap();
        bytes[at - 1] = 7;
        let clip = Scratch::holding("mp4", &bytes);
        let plan = plan_of(&clip, &settings(ProjectionChoice::Auto, Codec::Png)).unwrap();
        let notes = plan.remarks.all().join("; ");
        assert!(notes.contains("7 bytes long"), "{notes}");
    }
}

#[test]
fn padding_that_leaves_nothing_of_a_face_is_refused() {
    for padding in [15, 32, u32::MAX] {
        let why = CubeLayout::of_metadata([192, 128], padding).unwrap_err();
        assert!(why.contains(&format!("says {padding} pixels")), "{why}");
    }
    assert!(CubeLayout::of_metadata([192, 128], 30).is_ok());
}

#[test]
fn any_bytes_are_searched_for_broken_boxes_without_panic() {
    let clip = std::fs::read(&*with_box(b"st3d", |_| ())).unwrap();
    let mut state = 1_u32;
    for _ in 0..2000 {
        let mut bytes = clip.clone();
        for _ in 0..4 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let at = (state >> 8) as usize % bytes.len();
            bytes[at] = state as u8;
        }
        let broken = broken_boxes(&mut Cursor::new(&bytes));
        assert!(broken.iter().all(|one| (one.at as usize) < bytes.len()));
    }
}

#[test]
fn names_and_sizes_say_what_is_taken_for_what() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 64], 1, 1));
    let plain = VideoInput::open(&clip).unwrap().info().clone();
    let auto = settings(ProjectionChoice::Auto, Codec::Png);
    for (name, size, eyes, face, faces) in [
        ("film.mp4", [1920, 1080], 1, [1920, 1080], 1),
        ("photo.jpg", [6000, 4000], 1, [6000, 4000], 1),
        ("wide.png", [12_000, 3000], 1, [12_000, 3000], 1),
        ("tour.mp4", [4096, 2048], 1, [1024, 1024], 6),
        ("tour_180.mp4", [5760, 2880], 2, [1440, 1440], 6),
        ("tour_180_LR.mp4", [5760, 2880], 2, [1440, 1440], 6),
        ("tour_180.mp4", [2880, 2880], 1, [1440, 1440], 6),
        ("tour_360_TB.mp4", [4096, 4096], 2, [1024, 1024], 6),
        ("tour_360_TB.mp4", [4096, 2048], 2, [1024, 1024], 6),
        ("tour_360_SBS.mp4", [4096, 2048], 2, [1024, 1024], 6),
        ("tour_TB.mp4", [2048, 2048], 2, [512, 512], 6),
        ("tour_LR.mp4", [4096, 1024], 2, [512, 512], 6),
        ("tour_TB.mp4", [4096, 2048], 2, [1024, 1024], 6),
        ("tour_TB.mp4", [2048, 1024], 2, [2048, 512], 1),
        ("tour_LR.mp4", [4096, 2048], 2, [2048, 2048], 1),
        ("pano_TB.png", [1920, 1080], 2, [1920, 540], 1),
        ("film_sbs.mkv", [3840, 1080], 2, [1920, 1080], 1),
        ("film_hsbs.mkv", [1920, 1080], 2, [960, 1080], 1),
        ("strip.mp4", [6144, 1024], 1, [1024, 1024], 6),
        ("room_cube.mp4", [3072, 2048], 1, [1024, 1024], 6),
        ("market_cube.png", [12_000, 3000], 1, [3000, 3000], 4),
        ("room_cube_TB.mp4", [3072, 4096], 2, [1024, 1024], 6),
    ] {
        let info = crate::SourceInfo {
            width: size[0],
            height: size[1],
            ..plain.clone()
        };
        let plan = crate::prepare::PreparationPlan::new(name.as_ref(), &info, &auto).unwrap();
        let surface = plan.grid.surface;
        let found = (surface.eyes, surface.size, surface.faces_of_an_eye());
        assert_eq!(
            found,
            (eyes, face, faces),
            "{name} {size:?}: {:?}",
            plan.remarks
        );
        assert!(
            plan.remarks
                .all()
                .iter()
                .any(|note| note.contains("treated as")),
            "{name}"
        );
    }
    let info = crate::SourceInfo {
        width: 3072,
        height: 2048,
        ..plain
    };
    let error =
        crate::prepare::PreparationPlan::new("room_eac.webm".as_ref(), &info, &auto).unwrap_err();
    assert!(error.to_string().contains("v360=eac:c3x2"), "{error}");
}
