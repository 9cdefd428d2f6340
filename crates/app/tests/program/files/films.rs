//! Are films as people have them shown, and are repairs reported?

use super::film_file::{Film, trimmed};
use crate::scenes::{VIDEO, waves};
use crate::support::{Folder, Rgb, done, frame_picture, json, refused};
use foveal_media::{ClipCodec, ClipFormat, ClipWriter};
use serde_json::Value;
use std::path::Path;

/// Prepares a film fast and coarse, and gives what is reported of it.
pub(super) fn prepared(folder: &Folder, film: &str, how: &[&str]) -> Value {
    let pack = folder.name("film.foveal");
    let all = [
        "prepare",
        "video",
        film,
        "--out",
        &pack,
        "--force",
        "--fast",
        "--no-loss",
    ];
    let told = json(&[&all[..], &["--levels", "2"], how].concat());
    let info = json(&["info", &pack]);
    for key in ["remarks", "repairs", "frames"] {
        assert_eq!(info[key], told[key], "{film}");
    }
    told
}

pub(super) fn remarks(told: &Value) -> String {
    let all = told["remarks"].as_array().unwrap().iter();
    all.map(|it| it.as_str().unwrap())
        .collect::<Vec<_>>()
        .join("\n")
}

pub(super) fn repair(told: &Value, name: &str) -> u64 {
    told["repairs"][name].as_u64().unwrap_or(0)
}

/// Soft waves that move, with some grain, so that packets are some hundred bytes long.
pub(super) fn moving(frame: u32, p: usize, x: u32, y: u32) -> u8 {
    let [x, y, t] = [x, y, frame].map(f64::from);
    let grain = (x * 12.9 + y * 78.2 + t * 3.7).sin() * 43758.5;
    let wave = 60.0 * ((x + 3.0 * t) * 0.2).sin() + 20.0 * (y * 0.3).cos();
    [128.0 + wave + 24.0 * grain.fract(), 120.0, 130.0][p] as u8
}

/// Pictures that a run shows, frame by frame.
pub(super) fn shown(folder: &Folder, view: &str) -> String {
    let (pack, out) = (folder.name("film.foveal"), folder.name("shown"));
    let _ = std::fs::remove_dir_all(&out);
    let play = ["simulate", &pack, "--policy", "full", "--renderer", "cpu"];
    done(&[&play[..], &["--view", view, "--out", &out]].concat());
    out
}

#[test]
fn a_stream_that_begins_anywhere_is_shown_from_its_first_whole_frame_on() {
    let folder = Folder::new();
    let open = [(
        "x264-params",
        "open-gop=1:keyint=50:bframes=2:b-adapt=0:scenecut=0",
    )];
    let film = Film {
        frames: 100,
        options: &open,
        b_frames: 2,
        ..Film::default()
    };
    let whole = folder.name("whole.mkv");
    film.write(&whole, moving);
    let stream = folder.name("whole.ts");
    film.write(&stream, moving);
    for (name, skipped) in [("a.mkv", 32), ("a.mp4", 33), ("a.ts", 49), ("a.mov", 20)] {
        let cut = folder.name(name);
        trimmed(
            if name == "a.ts" { &stream } else { &whole },
            &cut,
            skipped,
            0,
        );
        let told = prepared(&folder, &cut, &[]);
        assert_eq!(told["frames"], 50, "{name}: {told}");
        // The frames are those of the whole film, whatever the first ask for.
        let damaged = repair(&told, "damaged_frames") + repair(&told, "lost_packets");
        assert_eq!(damaged, 0, "{name}: {told}");
    }
    for (name, gop) in [("b.ts", 12), ("c.m2ts", 25)] {
        let whole = folder.name(name);
        let film = Film {
            frames: 40,
            gop,
            ..film.clone()
        };
        let film = Film {
            options: &[("preset", "veryfast")],
            ..film
        };
        film.write(&whole, moving);
        let bytes = std::fs::read(&whole).unwrap();
        let packet = if name.ends_with("m2ts") { 192 } else { 188 };
        for share in [3, 5, 8] {
            let at = bytes.len() * share / 20 / packet * packet;
            let cut = folder.holding(&format!("cut-{share}-{name}"), &bytes[at..]);
            let told = prepared(&folder, &cut, &[]);
            let dropped = repair(&told, "frames_dropped_at_start");
            let frames = told["frames"].as_u64().unwrap();
            assert!(
                frames >= 10 && frames + dropped <= 40,
                "{name} {share}: {told}"
            );
            assert!(
                dropped > 0 && remarks(&told).contains("begins in the middle"),
                "{told}"
            );
            assert_eq!(repair(&told, "damaged_frames"), 0, "{told}");
            let out = folder.name("strict.foveal");
            refused(
                1,
                &["prepare", "video", &cut, "--strict", "--out", &out],
                &["cut-"],
            );
        }
    }
}

#[test]
fn damage_in_the_middle_is_concealed_counted_and_refused_where_that_is_asked() {
    let folder = Folder::new();
    for (name, encoder, format) in [
        ("a.mkv", "libx264", "yuv420p"),
        ("a.mp4", "libx264", "yuv420p"),
        ("a.ts", "mpeg2video", "yuv420p"),
        ("b.avi", "mjpeg", "yuvj420p"),
    ] {
        let whole = folder.name(name);
        let film = Film {
            encoder,
            format: if format == "yuv420p" {
                Film::default().format
            } else {
                FULL
            },
            frames: 30,
            size: [96, 64],
            gop: 10,
            // Other codes may be damaged without anything that shows it.
            options: if encoder == "libx264" {
                &[("x264-params", "cabac=0:qp=30")]
            } else {
                &[]
            },
            ..Film::default()
        };
        film.write(&whole, moving);
        let mut bytes = std::fs::read(&whole).unwrap();
        let middle = bytes.len() / 2;
        let length = (bytes.len() / 60).min(300);
        bytes[middle..middle + length]
            .iter_mut()
            .for_each(|byte| *byte ^= 0x5a);
        let cut = folder.holding(&format!("bad-{name}"), &bytes);
        let told = prepared(&folder, &cut, &[]);
        let frames = told["frames"].as_u64().unwrap();
        let damaged = repair(&told, "damaged_frames") + repair(&told, "lost_packets");
        assert!((20..=30).contains(&frames) && damaged > 0, "{name}: {told}");
        assert!(remarks(&told).contains("damaged"), "{name}: {told}");
        let out = folder.name("strict.foveal");
        refused(
            1,
            &["prepare", "video", &cut, "--strict", "--out", &out],
            &["bad-"],
        );
        assert!(!Path::new(&out).exists());
    }
}

const FULL: ffmpeg_next::format::Pixel = ffmpeg_next::format::Pixel::YUVJ420P;

/// Columns and rows that a bright disc covers, through its middle.
fn disc(picture: &Rgb) -> [u32; 2] {
    let [w, h] = picture.size;
    let is_lit = |at| picture.at(at)[0] > 110;
    let across = (0..w).filter(|x| is_lit([*x, h / 2])).count();
    let down = (0..h).filter(|y| is_lit([w / 2, *y])).count();
    [across as u32, down as u32]
}

#[test]
fn a_circle_stays_a_circle_whoever_says_how_wide_pixels_are() {
    let folder = Folder::new();
    let disc_of = |_: u32, p: usize, x: u32, y: u32| {
        // Half as wide as high in pixels of 2:1.
        let [x, y] = [(f64::from(x) - 31.5) * 2.0, f64::from(y) - 47.5];
        if p > 0 {
            128
        } else {
            [30, 200][usize::from(x.hypot(y) < 36.0)]
        }
    };
    let plain = Film {
        size: [64, 96],
        frames: 2,
        ..Film::default()
    };
    let (in_container, in_stream) = ([2, 1], [0, 1]);
    for (name, encoder, container, stream) in [
        ("a.mkv", "libx264", in_container, in_stream),
        ("a.mp4", "libx264", in_container, in_stream),
        ("b.mov", "prores", in_container, in_container),
        ("b.webm", "libvpx-vp9", in_container, in_stream),
        ("c.mkv", "libx264", in_stream, in_container),
        ("c.mp4", "mpeg4", in_container, in_stream),
    ] {
        let path = folder.name(name);
        let format = match encoder {
            "prores" => ffmpeg_next::format::Pixel::YUV422P10LE,
            _ => plain.format,
        };
        let film = Film {
            encoder,
            format,
            container_aspect: container,
            aspect: stream,
            ..plain.clone()
        };
        if encoder == "prores" {
            film.write(&path, |frame, p, x, y| match (x % 2, p) {
                // Ten bits, low byte first; chroma has its own rows.
                (0, _) => 0,
                (_, 0) => disc_of(frame, 0, x / 2, y) >> 6,
                _ => 2,
            });
        } else {
            film.write(&path, disc_of);
        }
        let told = prepared(&folder, &path, &["--frames", "1"]);
        assert_eq!(
            told["pixel_aspect"],
            serde_json::json!([2, 1]),
            "{name}: {told}"
        );
        let [across, down] = disc(&frame_picture(&shown(&folder, "256x192"), 0));
        let ratio = f64::from(across) / f64::from(down);
        assert!((0.95..1.06).contains(&ratio), "{name}: {across} x {down}");
    }
}

/// How far lines differ from the two next to them, at most, where those agree.
fn comb(picture: &Rgb) -> f64 {
    let [w, h] = picture.size;
    let luma = |x: u32, y: u32| f64::from(picture.at([x, y])[1]);
    let mut most = 0.0f64;
    for y in 4..h - 4 {
        let row = (0..w).map(|x| (luma(x, y) - (luma(x, y - 1) + luma(x, y + 1)) / 2.0).abs());
        most = most.max(row.sum::<f64>() / f64::from(w));
    }
    most
}

/// Where a bright bar begins, in the middle row.
fn edge(picture: &Rgb) -> u32 {
    let row = picture.size[1] / 2;
    (0..picture.size[0])
        .find(|x| picture.at([*x, row])[1] > 110)
        .unwrap_or(0)
}

#[test]
fn interlaced_film_is_shown_without_combs_at_the_rate_of_frames_or_fields() {
    let folder = Folder::new();
    for (name, encoder, top_first) in [
        ("a.ts", "mpeg2video", true),
        ("b.ts", "mpeg2video", false),
        ("a.mkv", "libx264", true),
        ("b.mkv", "libx264", false),
    ] {
        let path = folder.name(name);
        // A bar that moves by 4 pixels from field to field.
        let bar = |frame: u32, p: usize, x: u32, y: u32| {
            let is_second = y.is_multiple_of(2) != top_first;
            let from = 8 + 8 * frame + 4 * u32::from(is_second);
            if p > 0 {
                128
            } else {
                [40, 200][usize::from((from..from + 24).contains(&x))]
            }
        };
        let options = [("qp", "4"), ("preset", "veryfast")];
        let film = Film {
            encoder,
            size: [128, 64],
            frames: 8,
            top_first: Some(top_first),
            options: if encoder == "libx264" { &options } else { &[] },
            ..Film::default()
        };
        film.write(&path, bar);
        let told = prepared(&folder, &path, &[]);
        assert_eq!(told["frames"], 8, "{name}: {told}");
        assert_eq!(repair(&told, "deinterlaced_frames"), 8, "{name}: {told}");
        assert!(remarks(&told).contains("bwdif"), "{told}");
        let out = shown(&folder, "128x64");
        let smooth = comb(&frame_picture(&out, 4));
        let told = prepared(&folder, &path, &["--deinterlace", "fields"]);
        let out = shown(&folder, "128x64");
        assert_eq!(told["frames"], 16, "{name}: {told}");
        assert!(
            (told["fps"].as_f64().unwrap() - 50.0).abs() < 0.01,
            "{told}"
        );
        assert!(
            (told["seconds"].as_f64().unwrap() - 0.32).abs() < 0.03,
            "{told}"
        );
        let edges: Vec<u32> = (2..14).map(|at| edge(&frame_picture(&out, at))).collect();
        let rises = edges
            .windows(2)
            .all(|pair| pair[1] > pair[0] && pair[1] - pair[0] < 8);
        assert!(rises, "{name}: {edges:?}");
        let told = prepared(&folder, &path, &["--deinterlace", "off"]);
        assert!(remarks(&told).contains("combs"), "{told}");
        let combed = comb(&frame_picture(&shown(&folder, "128x64"), 4));
        assert!(
            smooth < combed / 3.0,
            "{name}: {smooth}, left as it is {combed}"
        );
    }
}

#[test]
fn only_what_really_ends_early_is_said_to_be_cut_short() {
    let folder = Folder::new();
    let film = Film {
        frames: 50,
        b_frames: 2,
        gop: 25,
        ..Film::default()
    };
    let whole = folder.name("whole.mkv");
    film.write(&whole, moving);
    let stream = folder.name("whole.ts");
    film.write(&stream, moving);
    for (name, skipped, early, frames) in [
        ("edit.mp4", 0, 60, 35),
        ("edit.mov", 0, 100, 25),
        ("trim.mp4", 10, 0, 25),
        ("trim.mkv", 10, 0, 25),
        ("trim.ts", 10, 0, 25),
        ("whole.mp4", 0, 0, 50),
    ] {
        let path = folder.name(name);
        trimmed(
            if name == "trim.ts" { &stream } else { &whole },
            &path,
            skipped,
            early,
        );
        let told = prepared(&folder, &path, &[]);
        let found = told["frames"].as_u64().unwrap();
        assert!(found.abs_diff(frames) <= 1, "{name}: {told}");
        let said = remarks(&told);
        assert!(
            !said.contains("cut short") && !said.contains("ends after"),
            "{name}: {said}"
        );
        assert_eq!(repair(&told, "cut_short"), 0, "{name}: {told}");
    }
    // With its index first, as films on the web have it.
    let index_first = folder.name("index.mp4");
    let format = ClipFormat {
        codec: ClipCodec::H264(20),
        size: [64, 48],
        frame_rate: [25, 1],
        colour: VIDEO,
    };
    let mut clip = ClipWriter::create(Path::new(&index_first), &format).unwrap();
    waves([64, 48], 50)
        .iter()
        .for_each(|it| clip.push(it).unwrap());
    clip.finish().unwrap();
    for path in [&index_first, &whole] {
        let bytes = std::fs::read(path).unwrap();
        let name = format!("cut-{}", &path[path.len() - 9..]);
        let cut = folder.holding(&name, &bytes[..bytes.len() * 6 / 10]);
        let told = prepared(&folder, &cut, &[]);
        assert!(told["frames"].as_u64().unwrap() >= 10, "{told}");
        assert!(remarks(&told).contains("cut short"), "{name}: {told}");
        assert_eq!(repair(&told, "cut_short"), 1, "{name}: {told}");
        let out = folder.name("strict.foveal");
        refused(
            1,
            &["prepare", "video", &cut, "--strict", "--out", &out],
            &["cut-"],
        );
    }
}
