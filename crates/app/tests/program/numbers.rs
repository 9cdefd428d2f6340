//! Does every tile of every picture come from the frame that is shown?
//!
//! The clips carry their frame's number in every cell; it is read back out of the pictures.

use crate::scenes::{CELL, numbered_sphere, read_numbers, turned, write_clip_at};
use crate::support::{Folder, column, done, frame_picture, json, refused};
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::{Projection, Screen, Surface};
use foveal_media::generate::numbered_tiles;
use serde_json::Value;

const FRAMES: u32 = 18;
const CODECS: [&str; 7] = ["vp9", "vp8", "h264", "hevc", "av1", "jpeg", "png"];

/// Bursts of three frames a millisecond apart, which a paced run cannot have every tile of in time,
/// with pauses in which the scan path moves on.
const BURST: u64 = 3;
const PAUSE_MS: u64 = 150;
/// Frames that the CPU draws, which takes its time.
const FRAMES_ON_CPU: u32 = 4;

/// A flat clip whose every cell carries the number of its frame.
fn numbered_flat(size: [u32; 2], frames: u32) -> Vec<Picture> {
    let numbered = |frame| numbered_tiles(size, CELL, u64::from(frame));
    (0..frames).map(numbered).collect()
}

fn write_bursts(folder: &Folder, pictures: &[Picture]) -> String {
    let ticks: Vec<u64> = (0..pictures.len() as u64)
        .map(|frame| frame / BURST * PAUSE_MS + frame % BURST)
        .collect();
    write_clip_at(folder, "a.mkv", pictures, [1000, 1], &ticks)
}

/// Reads the number of every cell of every picture; returns how many cells were read in all.
fn read_all(out: &str, surface: &Surface, view: &EyeView) -> usize {
    let (yaw, pitch) = (column(out, "head_yaw_deg"), column(out, "head_pitch_deg"));
    let mut read = 0;
    for frame in 0..yaw.len() {
        let view = match surface.projection {
            Projection::Flat => *view,
            Projection::Cube | Projection::Equirect => turned(view, yaw[frame], pitch[frame]),
        };
        let numbers = read_numbers(&frame_picture(out, frame), surface, &view);
        for (cell, number) in &numbers {
            let shown = Some(frame as u32);
            assert_eq!(
                *number, shown,
                "{out}, frame {frame}, face and cell {cell:?}"
            );
        }
        assert!(numbers.len() >= 4, "frame {frame}: {} cells", numbers.len());
        read += numbers.len();
    }
    read
}

/// Plays a pack unpaced and paced, and reads all numbers of both.
fn assert_one_frame_a_picture(folder: &Folder, pack: &str, surface: &Surface, view: &EyeView) {
    let [w, h] = view.size;
    let size = format!("{w}x{h}");
    let play = |name: &str, how: &[&str]| -> (String, Value) {
        let out = folder.name(name);
        let scan = [
            "simulate", pack, "--gaze", "scan", "--seed", "3", "--slope", "0.022", "--out", &out,
        ];
        let run = json(&[&scan[..], &["--view", &size], how].concat());
        assert_eq!(run["wrong_frame_tiles"], 0, "{name}");
        assert_eq!(run["damaged_tiles"], 0, "{name}");
        (out, run)
    };
    let (waited, unpaced) = play("waited", &[]);
    let levels = column(&waited, "level_changes");
    assert!(
        levels.iter().any(|changes| *changes > 0.0),
        "the scan stood still"
    );
    let cells = read_all(&waited, surface, view);
    // A tile that comes too late is stood in for by a coarser one of the same frame.
    let (hurried, paced) = play("paced", &["--paced", "--jobs", "1"]);
    assert_eq!(read_all(&hurried, surface, view), cells);
    assert_eq!(paced["log_sha256"], unpaced["log_sha256"]);
    let frames = FRAMES_ON_CPU.to_string();
    let on_cpu = ["--paced", "--renderer", "cpu", "--frames", &frames];
    let (hurried, _) = play("paced on the cpu", &on_cpu);
    assert!(read_all(&hurried, surface, view) > 0);
}

#[test]
fn every_tile_of_a_flat_picture_is_of_the_frame_shown() {
    let folder = Folder::new();
    let size = [448, 256];
    let clip = write_bursts(&folder, &numbered_flat(size, FRAMES));
    let pack = folder.name("a.foveal");
    done(&[
        "prepare", "video", &clip, "--out", &pack, "--tile", "64", "--levels", "3",
    ]);
    let surface = Surface::flat(size, Screen::default());
    let view = EyeView::filling(&surface, size);
    assert_one_frame_a_picture(&folder, &pack, &surface, &view);
}

#[test]
fn every_tile_of_a_picture_around_the_viewer_is_of_the_frame_shown() {
    let folder = Folder::new();
    let clip = write_bursts(&folder, &numbered_sphere(256, FRAMES));
    let pack = folder.name("a.foveal");
    let how = ["--projection", "equirect", "--tile", "64", "--levels", "3"];
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    let size = [400, 250];
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(100.0), size),
        size,
        eye: Default::default(),
    };
    assert_one_frame_a_picture(&folder, &pack, &Surface::cube(256), &view);
}

#[test]
fn even_the_coarsest_level_carries_numbers_that_can_be_read() {
    let surface = Surface::flat([128, 64], Screen::default());
    let view = EyeView::filling(&surface, surface.size);
    let folder = Folder::new();
    let clip = write_bursts(&folder, &numbered_flat([128, 64], 3));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&[
        "prepare", "video", &clip, "--out", &pack, "--tile", "64", "--levels", "3",
    ]);
    done(&["simulate", &pack, "--out", &out, "--policy", "coarsest"]);
    let read = |frame| read_numbers(&frame_picture(&out, frame), &surface, &view);
    for frame in [0, 2] {
        let shown = Some(frame as u32);
        assert_eq!(read(frame), [([0, 0, 0], shown), ([0, 1, 0], shown)]);
    }
}

/// Groups of 8, 8 and 32 frames: first, middle and last of a group, and the short one at the end.
const STARTS: [u32; 6] = [0, 1, 7, 8, 13, 17];

#[test]
fn a_run_may_begin_at_any_frame_in_every_codec() {
    let folder = Folder::new();
    let size = [192, 128];
    let clip = write_bursts(&folder, &numbered_flat(size, FRAMES));
    let surface = Surface::flat(size, Screen::default());
    let view = EyeView::filling(&surface, size);
    for codec in CODECS {
        let pack = folder.name(&format!("{codec}.foveal"));
        let how = ["--codec", codec, "--tile", "64", "--levels", "3"];
        done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
        for start in STARTS {
            let out = folder.name(&format!("{codec}-{start}"));
            let at = start.to_string();
            let one = ["--start", &at, "--frames", "1", "--policy", "full"];
            let run = json(&[&["simulate", &pack, "--out", &out], &one[..]].concat());
            assert_eq!(run["frames"], 1);
            assert_eq!(run["wrong_frame_tiles"], 0, "{codec} {start}");
            let numbers = read_numbers(&frame_picture(&out, start as usize), &surface, &view);
            assert_eq!(numbers.len(), 6, "{codec} {start}");
            for (cell, number) in numbers {
                assert_eq!(number, Some(start), "{codec}, cell {cell:?}");
            }
        }
    }
}

#[test]
fn frames_count_from_the_first_that_is_played() {
    let folder = Folder::new();
    let clip = write_bursts(&folder, &numbered_flat([128, 64], FRAMES));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    let how = ["--tile", "64", "--levels", "2"];
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    let simulate = ["simulate", &pack, "--out", &out, "--gaze", "center"];
    let part = ["--start", "5", "--frames", "7", "--every", "3"];
    done(&[&simulate[..], &part].concat());
    let played: Vec<f64> = (5..12).map(f64::from).collect();
    assert_eq!(column(&out, "frame"), played);
    let pictures: Vec<String> = [5, 8, 11].map(|n| format!("frame_{n:05}.png")).into();
    let names = ["frames.csv".to_owned(), "session.jsonl".to_owned()];
    let mut there: Vec<String> = std::fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    there.sort();
    assert_eq!(there, [pictures, names.into()].concat());
    let log = format!("{out}/session.jsonl");
    assert_eq!(json(&["replay", &log])["same"], true);
    let ran = done(&[&simulate[..], &["--start", "15", "--frames", "9"]].concat());
    let said = "has 18 frames, so only 3 from frame 15 on will be played";
    assert!(ran.stderr.contains(said), "{}", ran.stderr);
    let late = [&simulate[..], &["--start", "18"]].concat();
    refused(2, &late, &["--start", "18", "0 to 17"]);
}
