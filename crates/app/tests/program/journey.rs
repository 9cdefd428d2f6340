//! Does a clip go all the way from a file to pictures, figures and a log that replays?

use crate::scenes::{noisy_clip, waves, write_clip, write_clip_at};
use crate::support::{Folder, assert_keys, column, done, foveal, json, json_of, refused};
use serde_json::{Value, json};

const INFO: [&str; 11] = [
    "projection",
    "frames",
    "fps",
    "width",
    "height",
    "units",
    "levels",
    "codec",
    "bytes",
    "bytes_per_level",
    "source_bytes",
];

const SIMULATED: [&str; 10] = [
    "frames",
    "pixels_share_mean",
    "pixels_share_max",
    "bytes",
    "decoded_megapixels",
    "late_frames",
    "wrong_frame_tiles",
    "level_changes",
    "gpu_bytes",
    "log_sha256",
];

/// Prepares a clip of `frames` frames and goes every step to a replay.
fn go_all_the_way(folder: &Folder, size: [u32; 2], options: &[&str]) -> Value {
    let frames = 10;
    let clip = write_clip(folder, "a.mkv", &waves(size, frames));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    let prepare = [&["prepare", "video", &clip, "--out", &pack], options].concat();
    let mut prepared = json(&prepare);
    let of_preparing = prepared.as_object_mut().unwrap();
    assert_eq!(of_preparing.remove("already_there"), Some(json!(false)));
    for key in ["target_pixels_share", "target_policy", "calibrate_s"] {
        assert!(of_preparing.remove(key).is_some(), "{key}");
    }
    let info = json(&["info", &pack]);
    assert_eq!(prepared, info);
    assert_keys(&info, &INFO);
    assert_eq!(info["frames"], json!(frames));
    assert_eq!(info["fps"], json!(25.0));
    assert_eq!(
        [&info["width"], &info["height"]],
        [&json!(size[0]), &json!(size[1])]
    );
    assert_eq!(
        info["bytes"],
        json!(std::fs::metadata(&pack).unwrap().len())
    );
    assert_eq!(
        info["source_bytes"],
        json!(std::fs::metadata(&clip).unwrap().len())
    );
    assert_eq!(info["bytes_per_level"].as_array().unwrap().len(), 3);
    let verified = json(&["verify", &pack]);
    assert_eq!(
        (&verified["ok"], &verified["damage"]),
        (&json!(true), &json!([]))
    );
    let run = json(&["simulate", &pack, "--gaze", "scan", "--out", &out]);
    assert_keys(&run, &SIMULATED);
    assert_eq!(run["frames"], json!(frames));
    assert_eq!(run["wrong_frame_tiles"], json!(0));
    assert_eq!(run["damaged_tiles"], json!(0));
    let share = run["pixels_share_mean"].as_f64().unwrap();
    assert!((0.0..1.4).contains(&share), "{share}");
    let pictures = (0..frames).map(|frame| format!("frame_{frame:05}.png"));
    let mut names: Vec<String> = pictures.collect();
    names.extend(["frames.csv".to_owned(), "session.jsonl".to_owned()]);
    let mut found: Vec<String> = std::fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    assert_eq!(found, names);
    let replayed = json(&["replay", &format!("{out}/session.jsonl")]);
    assert_eq!(replayed["same"], json!(true));
    for hash in ["log_sha256", "replay_sha256"] {
        assert_eq!(replayed[hash], run["log_sha256"]);
    }
    assert_eq!(folder.names(), ["a.foveal", "a.mkv", "out"]);
    info
}

#[test]
fn a_flat_clip_goes_all_the_way() {
    let folder = Folder::new();
    let options = ["--tile", "64", "--levels", "3"];
    let info = go_all_the_way(&folder, [250, 141], &options);
    assert_eq!(info["projection"], json!("flat"));
    assert_eq!(
        (&info["levels"], &info["codec"]),
        (&json!(3), &json!("vp9"))
    );
    // 4 x 3 tiles in two groups, 2 x 2 in two, and one in one.
    assert_eq!(info["units"], json!(12 * 2 + 4 * 2 + 1));
}

#[test]
fn a_clip_around_the_viewer_goes_all_the_way() {
    let folder = Folder::new();
    let options = ["--projection", "equirect", "--tile", "32", "--levels", "3"];
    let info = go_all_the_way(&folder, [384, 192], &options);
    assert_eq!(info["projection"], json!("cube"));
    assert_eq!(info["units"], json!(6 * (9 * 2 + 4 * 2 + 1)));
}

#[test]
fn two_runs_write_the_same_log_and_a_tampered_one_is_told() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([200, 120], 12));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack, "--tile", "32"]);
    let hash = |name: &str, seed: &str| {
        let out = folder.name(name);
        let quiet = ["--pictures", "none", "--renderer", "none"];
        let quiet = [&quiet[..], &["--slope", "0.022", "--seed", seed]].concat();
        json(&[&["simulate", &pack, "--out", &out], &quiet[..]].concat())["log_sha256"].clone()
    };
    assert_eq!(hash("first", "1"), hash("second", "1"));
    assert_ne!(hash("first", "1"), hash("third", "2"));
    let log = std::fs::read_to_string(folder.name("first/session.jsonl")).unwrap();
    for (from, to, words) in [
        ("\"pixels\":", "\"pixels\":1", "frame 0"),
        (
            "\"policy\":\"acuity\"",
            "\"policy\":\"coarsest\"",
            "frame 0",
        ),
        (
            "\"foveal_session\":1",
            "\"foveal_session\":2",
            "foveal_session",
        ),
        ("{\"frame\":3", "{\"frame\":x", "line 5"),
    ] {
        let tampered = log.replacen(from, to, 1);
        assert_ne!(tampered, log, "{from}");
        let path = folder.holding("tampered.jsonl", tampered.as_bytes());
        refused(1, &["replay", &path, "--json"], &["tampered.jsonl", words]);
    }
    let later = log.replacen("{\"frame\":7", "{\"frame\":8", 1);
    let path = folder.holding("tampered.jsonl", later.as_bytes());
    // The number of a frame is no part of what is selected: the text stays the same.
    assert_eq!(foveal(&["replay", &path]).code, Some(0));
    let path = folder.holding("tampered.jsonl", log.trim_end().as_bytes());
    let ran = refused(
        1,
        &["replay", &path, "--json"],
        &["tampered.jsonl", "was changed"],
    );
    assert_eq!(json_of(&ran)["same"], json!(false));
    refused(
        1,
        &["replay", &folder.name("none.jsonl")],
        &["none.jsonl", "simulate"],
    );
}

#[test]
fn frames_of_a_variable_rate_are_shown_at_their_times() {
    let folder = Folder::new();
    let ticks = [0u64, 1, 2, 5, 6, 20, 21, 23];
    let path = write_clip_at(&folder, "a.mkv", &waves([64, 64], 8), [50, 1], &ticks);
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&["prepare", "video", &path, "--out", &pack]);
    done(&["simulate", &pack, "--out", &out, "--renderer", "none"]);
    let expected = ticks.map(|tick| tick as f64 * 0.02);
    assert_eq!(column(&out, "time_s"), expected);
}

#[test]
fn a_dry_run_says_the_cost_and_writes_nothing() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([96, 64], 20));
    let pack = folder.name("a.foveal");
    let dry = [
        "prepare",
        "video",
        &clip,
        "--dry-run",
        "--codec",
        "png",
        "--tile",
        "32",
    ];
    let without_name = json(&dry);
    let estimate = json(&[&dry[..], &["--out", &pack]].concat());
    assert_eq!(estimate["dry_run"], json!(true));
    for (key, value) in estimate.as_object().unwrap() {
        assert!(!value.is_null() && without_name.get(key).is_some(), "{key}");
    }
    assert_eq!(folder.names(), ["a.mkv"]);
    // What it says is what it takes: every frame of noise is as large as the next.
    let said = estimate["bytes"].as_f64().unwrap();
    done(&[
        "prepare", "video", &clip, "--codec", "png", "--tile", "32", "--out", &pack,
    ]);
    let info = json(&["info", &pack]);
    let levels = info["bytes_per_level"].as_array().unwrap();
    let took: f64 = levels.iter().map(|bytes| bytes.as_f64().unwrap()).sum();
    assert!((said / took - 1.0).abs() < 0.05, "said {said}, took {took}");
}
