//! Is what is odd, cut or damaged in films and animations shown, reported and counted?

use super::film_file::Film;
use super::films::{moving, prepared, remarks, repair, shown};
use crate::support::{Folder, Rgb, frame_picture, refused};
use ffmpeg_next::format::Pixel;
use serde_json::Value;

/// The bytes of a film that is written under this name.
fn made(folder: &Folder, name: &str, film: &Film<'_>) -> Vec<u8> {
    let path = folder.name(name);
    film.write(&path, moving);
    std::fs::read(path).unwrap()
}

/// What is reported of bytes under this name, and that `--strict` refuses them if it must.
fn told_of(folder: &Folder, name: &str, bytes: &[u8], is_mended: bool) -> Value {
    let file = folder.holding(name, bytes);
    let told = prepared(folder, &file, &[]);
    let out = folder.name("strict.foveal");
    let strict = [
        "prepare", "video", &file, "--strict", "--force", "--out", &out,
    ];
    match is_mended {
        true => {
            refused(1, &strict, &[name]);
        }
        false => {
            prepared(folder, &file, &["--strict"]);
        }
    }
    told
}

/// Where the contents of a box begin, by the names of the boxes that it lies in.
fn inside(bytes: &[u8], path: &[&[u8; 4]]) -> usize {
    let mut at = 0;
    for name in path {
        at += bytes[at..]
            .windows(4)
            .position(|four| four == *name)
            .unwrap()
            + 4;
    }
    at
}

/// Puts a box at the end of the description of the samples of an MP4 whose pictures lie first.
fn with_box(bytes: &[u8], new: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let names: [&[u8; 4]; 7] = [
        b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stsd", b"avc1",
    ];
    let mut end = 0;
    for depth in 1..=names.len() {
        let at = inside(&bytes, &names[..depth]) - 8;
        let size = u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
        end = at + size as usize;
        bytes[at..at + 4].copy_from_slice(&(size + new.len() as u32).to_be_bytes());
    }
    bytes.splice(end..end, new.iter().copied());
    bytes
}

/// Light to the left and above, so that every way to lay it is another picture.
fn corner(_: u32, p: usize, x: u32, y: u32) -> u8 {
    match p {
        0 if x < 32 && y < 24 => 220,
        0 => 40,
        _ => 128,
    }
}

/// Whether the four corners of a picture are lit: above and below, left before right.
fn lit(picture: &Rgb) -> [bool; 4] {
    let [w, h] = picture.size;
    [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[right, down]| {
        let at = [w / 8 + right * w * 3 / 4, h / 8 + down * h * 3 / 4];
        picture.at(at)[0] > 110
    })
}

#[test]
fn a_display_matrix_that_no_picture_can_follow_is_followed_as_near_as_it_goes() {
    let folder = Folder::new();
    let whole = folder.name("whole.mp4");
    let film = Film {
        frames: 4,
        ..Film::default()
    };
    film.write(&whole, corner);
    let whole = std::fs::read(whole).unwrap();
    let one = f64::from(1 << 16);
    let turned = |degrees: f64, across: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [across * cos, across * sin, -sin, cos].map(|it| (it * one) as i32)
    };
    let told = [
        ([0; 4], "of zeros", [true, false, false, false]),
        (turned(15.0, 1.0), "15.0°", [true, false, false, false]),
        (turned(-15.0, 1.0), "-15.0°", [true, false, false, false]),
        (turned(100.0, 1.0), "100.0°", [false, true, false, false]),
        (turned(0.0, -1.0), "", [false, true, false, false]),
        (turned(180.0, -1.0), "", [false, false, true, false]),
        (turned(90.0, -1.0), "", [false, false, false, true]),
        (turned(180.0, 1.0), "", [false, false, false, true]),
        ([1 << 15, 0, 0, 1 << 15], "", [true, false, false, false]),
    ];
    for (number, (matrix, words, corners)) in told.into_iter().enumerate() {
        let mut bytes = whole.clone();
        let at = inside(&bytes, &[b"moov", b"trak", b"tkhd"]) + 40;
        for (k, value) in [0, 1, 3, 4].into_iter().zip(matrix) {
            bytes[at + 4 * k..][..4].copy_from_slice(&value.to_be_bytes());
        }
        let name = format!("turned-{number}.mp4");
        let told = told_of(&folder, &name, &bytes, !words.is_empty());
        assert!(remarks(&told).contains(words), "{number}: {told}");
        let found = repair(&told, "broken_tags");
        assert_eq!(found, u64::from(!words.is_empty()), "{number}: {told}");
        let view = match told["width"].as_u64() {
            Some(48) => "48x64",
            _ => "64x48",
        };
        let picture = frame_picture(&shown(&folder, view), 0);
        assert_eq!(lit(&picture), corners, "{number}");
    }
}

#[test]
fn a_clean_aperture_is_what_is_shown() {
    let folder = Folder::new();
    let whole = folder.name("whole.mp4");
    let film = Film {
        frames: 4,
        ..Film::default()
    };
    film.write(&whole, corner);
    let whole = std::fs::read(whole).unwrap();
    let clap = |numbers: [i32; 4]| {
        let numbers = numbers.map(|it| [it.to_be_bytes(), 1_i32.to_be_bytes()].concat());
        let all = [&40_u32.to_be_bytes()[..], b"clap", &numbers.concat()].concat();
        with_box(&whole, &all)
    };
    // Twice as wide as it is high, of what lies to the left.
    let told = told_of(&folder, "clap.mp4", &clap([48, 48, -8, 0]), false);
    assert_eq!([&told["width"], &told["height"]], [48, 48], "{told}");
    assert!(remarks(&told).contains("48x48 of 64x48"), "{told}");
    let picture = frame_picture(&shown(&folder, "48x48"), 0);
    let is_lit = |at| picture.at(at)[0] > 110;
    assert!(is_lit([28, 8]) && !is_lit([37, 8]) && !is_lit([8, 28]));
    // The whole picture, and what is no part of it.
    let told = told_of(&folder, "all.mp4", &clap([64, 48, 0, 0]), false);
    assert!(!remarks(&told).contains("clap"), "{told}");
    let told = told_of(&folder, "beyond.mp4", &clap([80, 48, 0, 0]), true);
    assert_eq!([&told["width"], &told["height"]], [64, 48], "{told}");
    assert_eq!(repair(&told, "broken_tags"), 1, "{told}");
}

#[test]
fn a_frame_that_lasts_two_hours_changes_no_rate_and_is_told() {
    let folder = Folder::new();
    for (name, long) in [("first.mp4", 0), ("middle.mp4", 4)] {
        let film = Film {
            ticks: &|number| if number == long { 720_000 } else { 4 },
            ..Film::default()
        };
        let bytes = made(&folder, name, &film);
        let told = told_of(&folder, name, &bytes, false);
        assert_eq!(told["frames"], 10, "{told}");
        let fps = told["fps"].as_f64().unwrap();
        assert!((fps - 25.0).abs() < 0.1, "{name}: {told}");
        let words = format!("frame {long} stands for 7200");
        assert!(remarks(&told).contains(&words), "{name}: {told}");
    }
}

#[test]
fn an_animation_or_bare_film_that_is_cut_in_its_last_frame_says_so() {
    let folder = Folder::new();
    for (name, encoder, format) in [
        ("a.gif", "gif", Pixel::RGB8),
        ("a.apng", "apng", Pixel::RGB24),
        ("a.y4m", "wrapped_avframe", Pixel::YUV420P),
    ] {
        let film = Film {
            encoder,
            format,
            ..Film::default()
        };
        let path = folder.name(name);
        film.write(&path, |n, p, x, y| match format {
            Pixel::YUV420P => moving(n, p, x, y),
            // Columns are bytes there.
            _ => moving(n, 0, x, y),
        });
        let whole = std::fs::read(path).unwrap();
        let told = told_of(&folder, &format!("whole-{name}"), &whole, false);
        assert_eq!(told["frames"], 10, "{name}: {told}");
        assert_eq!(repair(&told, "cut_short"), 0, "{name}: {told}");
        let cut = format!("cut-{name}");
        let told = told_of(&folder, &cut, &whole[..whole.len() - 60], true);
        assert_eq!(told["frames"], 9, "{name}: {told}");
        assert_eq!(repair(&told, "cut_short"), 1, "{name}: {told}");
        assert!(remarks(&told).contains("breaks off after 9"), "{told}");
        if name == "a.apng" {
            let mut more = whole;
            let at = inside(&more, &[b"acTL"]);
            more[at..at + 4].copy_from_slice(&14_u32.to_be_bytes());
            let told = told_of(&folder, "more.apng", &more, true);
            assert!(remarks(&told).contains("14 pictures"), "{told}");
        }
    }
}

#[test]
fn frames_that_vanish_between_others_are_told() {
    let folder = Folder::new();
    let film = Film {
        frames: 30,
        ticks: &|number| if number == 10 { 28 } else { 4 },
        ..Film::default()
    };
    let told = told_of(&folder, "gap.mkv", &made(&folder, "gap.mkv", &film), false);
    let words = "about 6 frames are missing between others, the first after frame 10";
    assert!(remarks(&told).contains(words), "{told}");
    // A film that slows down lacks nothing.
    let film = Film {
        frames: 30,
        ticks: &|number| if number > 20 { 12 } else { 4 },
        ..film
    };
    let told = told_of(
        &folder,
        "slow.mkv",
        &made(&folder, "slow.mkv", &film),
        false,
    );
    assert!(!remarks(&told).contains("missing"), "{told}");
    // What was cut out of a cluster shows in its structure.
    let film = Film {
        frames: 30,
        size: [96, 64],
        gop: 10,
        ..Film::default()
    };
    for name in ["hole.mkv", "hole.webm"] {
        let film = Film {
            encoder: if name == "hole.webm" {
                "libvpx-vp9"
            } else {
                "libx264"
            },
            options: if name == "hole.webm" {
                &[("cpu-used", "8"), ("deadline", "realtime")]
            } else {
                &[]
            },
            ..film.clone()
        };
        let whole = made(&folder, name, &film);
        let middle = whole.len() / 2;
        let torn = [&whole[..middle], &whole[middle + 300..]].concat();
        let told = told_of(&folder, name, &torn, true);
        assert!(repair(&told, "damaged_clusters") > 0, "{name}: {told}");
        assert!(told["frames"].as_u64().unwrap() < 30, "{name}: {told}");
    }
}

#[test]
fn damage_in_hevc_and_vp9_is_told_where_anything_tells_of_it() {
    let folder = Folder::new();
    let hash = [("x265-params", "hash=1:log-level=none:keyint=10")];
    let plain = [("x265-params", "log-level=none:keyint=10")];
    let fast = [("cpu-used", "8"), ("deadline", "realtime")];
    for (name, encoder, options, is_hole) in [
        // A checksum of every picture.
        ("hash.mp4", "libx265", &hash[..], false),
        // Zeros where data were.
        ("hole.mkv", "libx265", &plain[..], true),
        ("hole.webm", "libvpx-vp9", &fast[..], true),
        ("vp9.mp4", "libvpx-vp9", &fast[..], true),
    ] {
        let film = Film {
            encoder,
            frames: 20,
            size: [320, 192],
            gop: 10,
            options,
            ..Film::default()
        };
        let mut bytes = made(&folder, name, &film);
        let told = told_of(&folder, &format!("whole-{name}"), &bytes, false);
        assert_eq!(told["repairs"], serde_json::json!({}), "{name}: {told}");
        let middle = bytes.len() / 2;
        for byte in &mut bytes[middle..middle + 1400] {
            *byte = if is_hole { 0 } else { *byte ^ 0x5a };
        }
        let told = told_of(&folder, &format!("bad-{name}"), &bytes, true);
        let names = ["damaged_frames", "lost_packets", "damaged_clusters"];
        let damage: u64 = names.iter().map(|it| repair(&told, it)).sum();
        assert!(damage > 0, "{name}: {told}");
    }
    // A stream that begins in the middle shows no frame that leans on what is gone.
    let film = Film {
        encoder: "libx265",
        frames: 30,
        size: [160, 96],
        gop: 10,
        options: &plain,
        ..Film::default()
    };
    let whole = made(&folder, "late.hevc", &film);
    let told = told_of(&folder, "late.hevc", &whole[whole.len() / 6..], true);
    assert!(repair(&told, "frames_dropped_at_start") > 0, "{told}");
    assert_eq!(told["frames"], 20, "{told}");
}

#[test]
fn a_bare_stream_that_begins_inside_its_first_key_frame_says_so() {
    let folder = Folder::new();
    let film = Film {
        frames: 30,
        gop: 10,
        options: &[("x264-params", "repeat-headers=1")],
        ..Film::default()
    };
    let whole = made(&folder, "whole.h264", &film);
    let told = told_of(&folder, "whole.h264", &whole, false);
    assert_eq!(told["frames"], 30, "{told}");
    let key = whole
        .windows(4)
        .position(|four| four == [0, 0, 1, 0x65])
        .unwrap();
    for from in [20, 200, 600] {
        let name = format!("from-{from}.h264");
        let told = told_of(&folder, &name, &whole[key + from..], true);
        let counted = repair(&told, "frames_dropped_at_start") + repair(&told, "damaged_frames");
        assert!(counted > 0, "{from}: {told}");
        assert!(told["frames"].as_u64().unwrap() >= 20, "{from}: {told}");
    }
}

#[test]
fn a_transport_stream_that_ends_within_a_packet_is_cut_short() {
    let folder = Folder::new();
    let film = Film {
        frames: 20,
        ..Film::default()
    };
    let whole = made(&folder, "whole.ts", &film);
    told_of(&folder, "whole.ts", &whole, false);
    let told = told_of(
        &folder,
        "cut.ts",
        &whole[..whole.len() * 3 / 4 / 188 * 188 + 90],
        true,
    );
    assert!(
        repair(&told, "cut_short") + repair(&told, "damaged_frames") > 0,
        "{told}"
    );
}
