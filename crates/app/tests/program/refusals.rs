//! Is bad input refused with the file, the place and the next step, and nothing left behind?

use crate::scenes::{VIDEO, noisy_clip, waves, write_clip};
use crate::support::{Folder, Ran, done, frame_picture, json, refused};
use foveal_core::view::picture::Colour;
use foveal_media::{ClipCodec, ClipFormat, ClipWriter};
use std::path::Path;

/// Prepares a file, which must be refused; nothing but what was there may be left.
fn refuse(folder: &Folder, input: &str, words: &[&str]) -> Ran {
    let before = folder.names();
    let out = folder.name("out.foveal");
    let ran = refused(1, &["prepare", "video", input, "--out", &out], words);
    assert!(ran.stdout.is_empty(), "{}", ran.stdout);
    assert_eq!(folder.names(), before);
    ran
}

#[test]
fn what_is_no_video_is_refused() {
    let folder = Folder::new();
    let text = folder.holding("notes.mp4", b"Dear diary, today I made no video.\n");
    refuse(&folder, &text, &["notes.mp4", "is not a video", "ffprobe"]);
    let empty = folder.holding("empty.mkv", b"");
    refuse(&folder, &empty, &["empty.mkv", "empty"]);
    let state = |n: u32| (n.wrapping_mul(2_654_435_761) >> 13) as u8;
    let garbage: Vec<u8> = (0..50_000).map(state).collect();
    let garbage = folder.holding("garbage.bin", &garbage);
    refuse(&folder, &garbage, &["garbage.bin"]);
    let missing = folder.name("missing.mp4");
    refuse(&folder, &missing, &["missing.mp4", "check the path"]);
    refuse(&folder, &folder.name("."), &["it is a folder"]);
}

#[test]
fn a_codec_that_nobody_knows_is_refused() {
    let folder = Folder::new();
    let path = folder.name("a.avi");
    let format = ClipFormat {
        codec: ClipCodec::Mjpeg(3),
        size: [64, 48],
        frame_rate: [25, 1],
        colour: Colour {
            full_range: true,
            ..VIDEO
        },
    };
    let mut clip = ClipWriter::create(Path::new(&path), &format).unwrap();
    waves([64, 48], 3)
        .iter()
        .for_each(|p| clip.push(p).unwrap());
    clip.finish().unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let places: Vec<usize> = (0..bytes.len() - 4)
        .filter(|at| &bytes[*at..at + 4] == b"MJPG")
        .collect();
    assert!(!places.is_empty());
    places
        .iter()
        .for_each(|at| bytes[*at..at + 4].copy_from_slice(b"Q?Q?"));
    let strange = folder.holding("strange.avi", &bytes);
    refuse(&folder, &strange, &["strange.avi"]);
}

#[test]
fn a_video_cut_within_a_frame_is_shown_up_to_there_and_where_strict_refused_with_its_place() {
    let folder = Folder::new();
    let whole = write_clip(&folder, "whole.mkv", &noisy_clip([128, 96], 20));
    let bytes = std::fs::read(&whole).unwrap();
    let cut = folder.holding("cut.mkv", &bytes[..bytes.len() * 6 / 10]);
    let words = ["cut.mkv", "broken at frame 1", "copy the file again"];
    let out = folder.name("cut.foveal");
    let strict = ["prepare", "video", &cut, "--out", &out, "--strict"];
    refused(1, &strict, &words);
    assert!(!Path::new(&out).exists());
    let told = json(&["prepare", "video", &cut, "--out", &out, "--no-loss"]);
    assert_eq!(told["repairs"]["cut_short"], 1, "{told}");
    assert!(told["frames"].as_u64().unwrap() >= 10, "{told}");
    // What was asked for lies before the cut.
    let out = folder.name("start.foveal");
    let start = ["prepare", "video", &cut, "--out", &out, "--frames", "5"];
    assert_eq!(json(&start)["frames"], 5);
}

#[test]
fn a_video_without_frames_is_refused() {
    let folder = Folder::new();
    let whole = write_clip(&folder, "whole.mkv", &noisy_clip([128, 96], 3));
    let bytes = std::fs::read(&whole).unwrap();
    // The first cluster of Matroska holds the first frame.
    let cluster = bytes
        .windows(4)
        .position(|id| id == [0x1f, 0x43, 0xb6, 0x75]);
    let headers = folder.holding("headers.mkv", &bytes[..cluster.unwrap()]);
    refuse(&folder, &headers, &["headers.mkv", "copy it again"]);
    let header = folder.holding("header.y4m", b"YUV4MPEG2 W64 H48 F25:1 Ip C420jpeg\n");
    refuse(&folder, &header, &["header.y4m", "no frame"]);
}

#[test]
fn pictures_of_any_size_go_all_the_way() {
    for size in [[1, 1], [1, 3000], [3000, 1], [3, 5], [127, 33]] {
        let folder = Folder::new();
        let clip = write_clip(&folder, "a.mkv", &waves(size, 2));
        for codec in ["vp9", "png"] {
            let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
            let prepare = ["prepare", "video", &clip, "--out", &pack, "--force"];
            done(&[&prepare[..], &["--codec", codec]].concat());
            done(&["simulate", &pack, "--out", &out]);
            assert_eq!(json(&["verify", &pack])["ok"], true);
            let shown = frame_picture(&out, 1);
            let expected = size.map(|side| side.min(1920));
            assert_eq!(shown.size[0], expected[0], "{size:?}");
        }
    }
}

#[test]
fn a_picture_too_long_for_a_view_is_shown_smaller() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([1, 20_000], 1));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&["prepare", "video", &clip, "--out", &pack]);
    done(&["simulate", &pack, "--out", &out]);
    assert_eq!(frame_picture(&out, 0).size, [1, 8192]);
}

#[test]
fn a_bad_trace_is_refused_with_its_line() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let header = "t_s,yaw_deg,pitch_deg\n";
    for (rows, words) in [
        ("0,0,0\n0.1,NaN,0\n", &["line 3", "yaw_deg", "NaN"][..]),
        ("0,0,0\n0.1,0,inf\n", &["line 3", "pitch_deg"]),
        (
            "0,0,0\n0.2,0,0\n0.1,0,0\n",
            &["line 4", "t_s is 0.1", "sort"],
        ),
        ("0,0,0\n0,0,0\n", &["line 3", "not after"]),
        ("0,0,91\n", &["line 2", "pitch_deg"]),
        ("0,0\n", &["line 2", "pitch_deg"]),
        ("", &["no rows"]),
    ] {
        let trace = folder.holding("gaze.csv", format!("{header}{rows}").as_bytes());
        let (gaze, out) = (format!("trace:{trace}"), folder.name("out"));
        let play = [
            "simulate",
            &pack,
            "--gaze",
            &gaze,
            "--out",
            &out,
            "--renderer",
            "none",
        ];
        refused(1, &play, &[&["gaze.csv"], words].concat());
        assert!(!Path::new(&out).exists(), "{rows:?} left a folder");
    }
    let wrong = folder.holding("gaze.csv", b"time,x,y\n0,0,0\n");
    let (gaze, out) = (format!("trace:{wrong}"), folder.name("out"));
    let play = [
        "simulate",
        &pack,
        "--gaze",
        &gaze,
        "--out",
        &out,
        "--renderer",
        "none",
    ];
    refused(1, &play, &["gaze.csv", "line 1", "t_s"]);
}

#[test]
fn wrong_usage_is_told_apart_from_failure() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let out = folder.name("out");
    for wrong in [
        &[][..],
        &["dance"],
        &["prepare", "video"],
        &[
            "prepare", "video", &clip, "--out", &out, "--tile", "64", "--grid", "2x2",
        ],
        &["prepare", "video", &clip, "--out", &out, "--tile", "many"],
        &["prepare", "video", &clip, "--out", &out, "--codec", "divx"],
        &["prepare", "video", &clip, "--out", &out, "--grid", "0x2"],
        &["prepare", "video", &clip, "--out", &out, "--jobs", "-1"],
        &["simulate", &pack],
        &["simulate", &pack, "--out", &out, "--gaze", "up"],
        &["simulate", &pack, "--out", &out, "--gaze", "0,nan"],
        &["simulate", &pack, "--out", &out, "--policy", "best"],
        &[
            "select",
            "--projection",
            "cube",
            "--gaze",
            "1,2",
            "--random-gazes",
            "3",
        ],
        &["info", &pack, "--jsn"],
    ] {
        let ran = refused(2, wrong, &[]);
        assert!(
            ran.stderr.contains("--help") || wrong.is_empty(),
            "{}",
            ran.stderr
        );
    }
    assert_eq!(folder.names(), ["a.foveal", "a.mkv"]);
}

#[test]
fn options_out_of_range_are_refused_with_their_names() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let out = folder.name("out.foveal");
    let prepare = ["prepare", "video", &clip, "--out", &out];
    for (code, option, words) in [
        (2, &["--quality", "64"][..], &["--quality", "0 to 63"][..]),
        (
            2,
            &["--codec", "jpeg", "--quality", "0"],
            &["--quality", "1 to 31"],
        ),
        (2, &["--frames", "0"], &["--frames", "at least 1"]),
        (2, &["--jobs", "0"], &["--jobs", "1 to 256"]),
        (2, &["--jobs", "100000"], &["--jobs", "1 to 256"]),
        (2, &["--tile", "17"], &["17", "even"]),
        (2, &["--levels", "0"], &["0 levels"]),
        (2, &["--level-ratio", "3"], &["ratio 3"]),
        (2, &["--grid", "70x2"], &["70x2", "at least 2 pixels"]),
    ] {
        refused(code, &[&prepare[..], option].concat(), words);
    }
    refused(2, &prepare[..3], &["--out"]);
    assert_eq!(folder.names(), ["a.mkv"]);
    done(&prepare);
    let play = [
        "simulate",
        &out,
        "--renderer",
        "none",
        "--out",
        &folder.name("run"),
    ];
    for (option, words) in [
        (["--every", "0"], ["--every", "1 to 10000"]),
        (["--frames", "0"], ["--frames", "at least 1"]),
        (["--jobs", "0"], ["--jobs", "1 to 256"]),
        (["--view", "9000x10"], ["--view", "8192"]),
        (["--safety-disc", "-3"], ["--safety-disc", "0 to 180"]),
        (["--slope", "-0.1"], ["--slope", "0 to 1"]),
        (["--slope", "nan"], ["--slope", "0 to 1"]),
        (["--margin", "nan"], ["--margin", "0 to 180"]),
        (["--edge-margin", "181"], ["--edge-margin", "0 to 180"]),
    ] {
        refused(2, &[&play[..], &option].concat(), &words);
    }
    let both = ["--slope", "0.011", "--acuity", "watson"];
    refused(
        2,
        &[&play[..], &both].concat(),
        &["--slope", "--acuity linear"],
    );
    assert_eq!(folder.names(), ["a.mkv", "out.foveal"]);
    let around = folder.name("around.foveal");
    let sphere = ["--projection", "equirect", "--out", &around];
    done(&[&["prepare", "video", &clip], &sphere[..]].concat());
    let play = [
        "simulate",
        &around,
        "--out",
        &folder.name("run"),
        "--fov",
        "171",
    ];
    refused(2, &play, &["--fov", "1 to 170"]);
}
