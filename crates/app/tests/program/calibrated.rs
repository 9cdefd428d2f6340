//! Does a pack keep the score that is asked for, and say what it takes?

use crate::perceptual::patches;
use crate::scenes::write_clip;
use crate::support::{Folder, done, json, refused};
use foveal_media::generate::GeneratedScene;
use serde_json::Value;

/// A clip prepared as a person would.
fn prepared(folder: &Folder, clip: &str) -> (String, Value) {
    let pack = folder.name("clip.foveal");
    let how = ["--tile", "32", "--levels", "3", "--quality", "16"];
    let calibrated = ["--calibrate", "usual", "--no-loss"];
    let prepare = ["prepare", "video", clip, "--out", &pack];
    let figures = json(&[&prepare[..], &how, &calibrated].concat());
    (pack, figures)
}

#[test]
fn a_pack_keeps_its_target_where_nobody_looked_and_tells_what_it_takes() {
    let folder = Folder::new();
    let frames: Vec<_> = (0..24).map(|frame| patches([320, 192], frame)).collect();
    let clip = write_clip(&folder, "clip.mkv", &frames);
    let (pack, figures) = prepared(&folder, &clip);
    let share = figures["target_pixels_share"].as_f64().unwrap();
    assert!((0.05..=1.1).contains(&share), "{share}");
    let rows = figures["calibration"]["rows"].as_array().unwrap();
    assert!(rows.iter().any(|row| row["zone"] == "under_5_deg"));
    let out = folder.name("run");
    for gaze in ["4,3", "-11,6"] {
        let gaze = format!("--gaze={gaze}");
        let run = json(&[
            "simulate",
            &pack,
            &gaze,
            "--view",
            "320x192",
            "--score",
            "--pictures",
            "none",
            "--renderer",
            "cpu",
            "--out",
            &out,
        ]);
        let score = run["score"]["jod"].as_f64().unwrap();
        let expected = run["expected_jod"].as_f64().unwrap();
        assert!((score - 9.5).abs() <= 0.2, "{gaze}: {score}");
        assert!(
            (score - expected).abs() <= 0.25,
            "{gaze}: {score}, {expected}"
        );
        assert_eq!(run["policy_chosen"], figures["target_policy"]);
    }
    let timed = json(&[
        "bench",
        "video",
        &pack,
        "--frames",
        "10",
        "--renderer",
        "none",
    ]);
    assert_eq!(timed["policy"], figures["target_policy"]);
    let linked = json(&[
        "simulate",
        &pack,
        "--link",
        "50mbit",
        "--renderer",
        "none",
        "--pictures",
        "none",
        "--out",
        &out,
    ]);
    assert!(linked["expected_jod"].as_f64().unwrap() > 9.0, "{linked}");
    assert_eq!(linked["stopped_at_target"], true);
    assert!(linked["unspent_bytes"].as_u64().unwrap() > 0);
    let replayed = done(&["replay", &format!("{out}/session.jsonl"), "--pack", &pack]);
    assert!(replayed.stdout.contains("identical"), "{}", replayed.stdout);
}

#[test]
fn a_sphere_keeps_its_target_at_a_gaze_that_nobody_judged() {
    let folder = Folder::new();
    let scene = GeneratedScene::panorama([2048, 1024]);
    let clip = write_clip(&folder, "clip.mkv", &[scene.frame(0)]);
    let pack = folder.name("sphere.foveal");
    let prepare = ["prepare", "video", &clip, "--out", &pack];
    let how = ["--projection", "equirect", "--tile", "64", "--levels", "4"];
    let calibrated = ["--quality", "12", "--calibrate", "usual", "--no-loss"];
    done(&[&prepare[..], &how, &calibrated].concat());
    let out = folder.name("run");
    for gaze in ["-6,4", "9,-7"] {
        let gaze = format!("--gaze={gaze}");
        let view = ["--view", "660x660", "--fov", "60"];
        let play = ["simulate", &pack, &gaze, "--score"];
        let how = ["--frames", "1", "--pictures", "none", "--renderer", "cpu"];
        let run = json(&[&play[..], &view, &how, &["--out", &out]].concat());
        let score = run["score"]["jod"].as_f64().unwrap();
        assert!((score - 9.5).abs() <= 0.2, "{gaze}: {score}");
    }
}

#[test]
fn an_older_pack_is_calibrated_into_another_and_nothing_else_is() {
    let folder = Folder::new();
    let frames: Vec<_> = (0..8).map(|frame| patches([160, 96], frame)).collect();
    let clip = write_clip(&folder, "clip.mkv", &frames);
    let [old, new] = ["old.foveal", "new.foveal"].map(|name| folder.name(name));
    let how = ["--tile", "32", "--levels", "2", "--no-loss"];
    done(&[&["prepare", "video", &clip, "--out", &old], &how[..]].concat());
    let before = json(&["info", &old]);
    assert_eq!(before["calibration"], Value::Null);
    let made = json(&["calibrate", &old, "--out", &new, "--jobs", "1"]);
    assert!(!made["calibration"]["rows"].as_array().unwrap().is_empty());
    done(&["verify", &new]);
    // Once more, over what it has, on two threads.
    done(&["calibrate", &new, "--out", &old, "--force", "--jobs", "2"]);
    let [old_bytes, new_bytes] = [&old, &new].map(|path| std::fs::read(path).unwrap());
    assert!(old_bytes == new_bytes, "calibrating again gave other bytes");
    refused(2, &["calibrate", &new, "--out", &new], &["--out", "itself"]);
    refused(2, &["calibrate", &new, "--out", &old], &["--force"]);
    // A table that is cut short is passed over; all else plays.
    let mut cut = new_bytes;
    let last = cut.len() - 1;
    cut[last] ^= 1;
    std::fs::write(&old, cut).unwrap();
    let out = folder.name("run");
    let ran = done(&[
        "simulate",
        &old,
        "--frames",
        "2",
        "--renderer",
        "none",
        "--pictures",
        "none",
        "--out",
        &out,
    ]);
    assert!(ran.stderr.contains("calibration"), "{}", ran.stderr);
}
