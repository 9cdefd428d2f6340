//! Does a run hold what it says of itself, and nothing of another run?

use crate::scenes::{waves, write_clip};
use crate::support::{Folder, done, json, refused};
use foveal_core::session::log::SessionLogPart;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// What nothing draws.
const QUIET: [&str; 4] = ["--pictures", "none", "--renderer", "none"];

/// A 360° pack of a second at 25 frames a second.
fn sphere(folder: &Folder) -> String {
    let clip = write_clip(folder, "a.mkv", &waves([256, 128], 25));
    let pack = folder.name("a.foveal");
    let cut = ["--projection", "equirect", "--tile", "32", "--levels", "3"];
    done(
        &[
            &["prepare", "video", &clip, "--out", &pack, "--fast"],
            &cut[..],
        ]
        .concat(),
    );
    pack
}

/// A still, flat.
fn still(folder: &Folder) -> String {
    let clip = write_clip(folder, "still.mkv", &waves([128, 64], 1));
    let pack = folder.name("still.foveal");
    done(&[
        "prepare", "video", &clip, "--out", &pack, "--tile", "32", "--levels", "2",
    ]);
    pack
}

fn log_of(out: &str) -> SessionLogPart {
    let text = std::fs::read_to_string(format!("{out}/session.jsonl")).unwrap();
    SessionLogPart::parse(&text).unwrap()
}

/// The names and the cells of a table of frames.
fn table(out: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(format!("{out}/frames.csv")).unwrap();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    let mut lines = text.lines().map(cells);
    (lines.next().unwrap(), lines.collect())
}

fn column(out: &str, name: &str) -> Vec<Option<f64>> {
    let (names, rows) = table(out);
    let place = names.iter().position(|found| found == name).unwrap();
    rows.iter().map(|row| row[place].parse().ok()).collect()
}

/// The columns that the document lists under a title.
fn documented(title: &str) -> Vec<String> {
    let text = include_str!("../../../../docs/formats/frames.md");
    let part = text
        .split("\n## ")
        .find(|part| part.starts_with(title))
        .unwrap();
    let rows = part.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| row.split('`').next().unwrap().to_owned())
        .collect()
}

#[test]
fn every_column_of_frames_is_documented_and_each_frame_has_its_score() {
    let folder = Folder::new();
    let (pack, out) = (still(&folder), folder.name("run"));
    let run = [
        "simulate",
        &pack,
        "--out",
        &out,
        "--pictures",
        "none",
        "--gaze",
        "center",
    ];
    let scored = [
        "--renderer",
        "cpu",
        "--policy",
        "coarsest",
        "--score",
        "--hold",
        "0.1",
    ];
    let found = json(&[&run[..], &scored].concat());
    assert_eq!(table(&out).0, documented("Video"));
    let scores: Vec<f64> = column(&out, "jod")
        .into_iter()
        .map(Option::unwrap)
        .collect();
    let told = found["score"]["per_frame"].as_array().unwrap();
    let told: Vec<f64> = told.iter().map(|jod| jod.as_f64().unwrap()).collect();
    assert_eq!(told.len(), 3, "{found}");
    for (a, b) in scores.iter().zip(&told) {
        assert!((a - b).abs() < 1e-6 && *a < 10.0, "{scores:?} {told:?}");
    }
    done(&[&run[..], &["--renderer", "none"]].concat());
    assert_eq!(column(&out, "jod"), [None]);
    let scene = folder.name("scene.foveal");
    let obj = folder.holding("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    done(&["prepare", "scene", &obj, "--out", &scene]);
    let out = folder.name("through");
    let walk = [
        "simulate", &scene, "--out", &out, "--hold", "0.2", "--gaze", "center",
    ];
    done(&[&walk[..], &QUIET].concat());
    let (names, rows) = table(&out);
    assert_eq!((names, rows.len()), (documented("Scenes"), 6));
    assert_eq!(column(&out, "triangles"), [None; 6]);
}

#[test]
fn a_still_is_shown_as_long_as_it_is_held_or_as_its_trace_lasts() {
    let folder = Folder::new();
    let pack = still(&folder);
    let out = folder.name("run");
    let run = ["simulate", &pack, "--out", &out, "--policy", "acuity"];
    let with = |options: &[&str]| {
        let found = json(&[&run[..], &QUIET, options].concat());
        (found["frames"].as_u64().unwrap(), log_of(&out))
    };
    assert_eq!(with(&["--gaze", "scan"]).0, 1);
    let (frames, log) = with(&["--gaze", "scan", "--hold", "0.4", "--interval", "50ms"]);
    assert_eq!(frames, 8);
    let times: Vec<f64> = log.frames.iter().map(|frame| frame.time_s.0).collect();
    assert!(
        times
            .iter()
            .zip(0..)
            .all(|(t, k)| (t - 0.05 * f64::from(k)).abs() < 1e-9)
    );
    let trace = "t_s,yaw_deg,pitch_deg\n0,-15,0\n0.25,15,0\n0.5,15,5\n";
    let gaze = format!("trace:{}", folder.holding("eye.csv", trace.as_bytes()));
    let (frames, log) = with(&["--gaze", &gaze]);
    assert_eq!(frames, 15);
    let sides: BTreeSet<bool> = log.frames.iter().map(|frame| frame.gaze[0] > 0.0).collect();
    assert_eq!(sides.len(), 2, "the gaze moves over the still");
    let log = format!("{out}/session.jsonl");
    assert_eq!(json(&["replay", &log, "--pack", &pack])["same"], true);
    for wrong in ["0", "-1", "nan", "1e9", "soon"] {
        refused(2, &[&run[..], &["--hold", wrong]].concat(), &["--hold"]);
    }
    refused(
        2,
        &[&run[..], &["--hold", "1", "--frames", "3"]].concat(),
        &["--frames", "--hold"],
    );
    let long = "t_s,yaw_deg,pitch_deg\n0,0,0\n1e9,0,0\n";
    let long = format!("trace:{}", folder.holding("long.csv", long.as_bytes()));
    refused(
        2,
        &[&run[..], &QUIET, &["--gaze", &long]].concat(),
        &["1000000000 s", "--hold"],
    );
    let moving = write_clip(&folder, "b.mkv", &waves([128, 64], 3));
    let video = folder.name("b.foveal");
    done(&["prepare", "video", &moving, "--out", &video]);
    let held = ["simulate", &video, "--out", &out, "--hold", "1"];
    refused(2, &held, &["--hold", "a video of 3 frames"]);
}

/// Leaves what an older run on panels left, with a log that also names what is outside the folder;
/// returns the name of that.
fn leave_panels(folder: &Folder, out: &str) -> String {
    std::fs::create_dir_all(format!("{out}/left")).unwrap();
    std::fs::write(format!("{out}/left/frame_00000.png"), "old").unwrap();
    let precious = folder.holding("frame_00007.png", b"precious");
    let log = std::fs::read_to_string(format!("{out}/session.jsonl")).unwrap();
    let panels = "{\"panels\":[{\"id\":\"left\"},{\"id\":\"..\"}],";
    std::fs::write(format!("{out}/session.jsonl"), log.replacen('{', panels, 1)).unwrap();
    precious
}

#[test]
fn a_run_takes_the_place_of_an_older_one_says_so_first_and_spares_all_else() {
    let folder = Folder::new();
    let pack = still(&folder);
    let out = folder.name("run");
    let run = |options: &[&str]| {
        let common = [
            "simulate",
            &pack,
            "--out",
            &out,
            "--renderer",
            "cpu",
            "--view",
            "64x32",
        ];
        done(&[&common[..], &["--gaze", "center"], options].concat())
    };
    let names = || {
        let entries = std::fs::read_dir(&out).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect::<BTreeSet<String>>()
    };
    let first = run(&["--hold", "0.1"]);
    assert!(!first.stderr.contains("earlier run"), "{}", first.stderr);
    assert_eq!(names().len(), 5);
    for kept in ["notes.txt", "frame_1.png", "frame_00000.png.bak"] {
        std::fs::write(format!("{out}/{kept}"), "mine").unwrap();
    }
    let precious = leave_panels(&folder, &out);
    let second = run(&["--every", "1"]);
    assert!(
        second
            .stderr
            .contains("run: overwriting an earlier run of 6 files"),
        "{}",
        second.stderr
    );
    let expected = [
        "frame_00000.png",
        "frame_00000.png.bak",
        "frame_1.png",
        "frames.csv",
        "notes.txt",
        "session.jsonl",
    ];
    assert_eq!(names(), expected.map(str::to_owned).into());
    assert_eq!(std::fs::read(precious).unwrap(), b"precious");
    assert_eq!(log_of(&out).frames.len(), 1);
    // A trace that lies where the table goes is no older run.
    std::fs::write(
        format!("{out}/frames.csv"),
        "t_s,yaw_deg,pitch_deg\n0,1,2\n",
    )
    .unwrap();
    let own = format!("trace:{out}/frames.csv");
    let lost = [
        "simulate",
        &pack,
        "--out",
        &out,
        "--gaze",
        &own,
        "--renderer",
        "none",
    ];
    refused(2, &lost, &["frames.csv", "is what is read"]);
    assert!(Path::new(&format!("{out}/session.jsonl")).exists());
}

#[test]
fn what_is_not_known_of_a_gaze_is_null_and_what_a_recording_knows_is_not() {
    let folder = Folder::new();
    let (pack, out) = (sphere(&folder), folder.name("run"));
    let run = |gaze: &str| {
        let common = [
            "simulate", &pack, "--out", &out, "--policy", "acuity", "--gaze", gaze,
        ];
        json(&[&common[..], &QUIET].concat())
    };
    let trace = |eyes: bool| {
        let name = if eyes { "eyes.csv" } else { "head.csv" };
        let columns = if eyes { ",yaw_deg,pitch_deg" } else { "" };
        let mut text = format!("t_s,head_yaw_deg,head_pitch_deg{columns}\n");
        for k in 0..110 {
            let (time, yaw) = (f64::from(k) * 0.01, f64::from(k) * 0.3);
            text += &format!("{time},{yaw},0");
            text += &if eyes {
                format!(",{},2\n", yaw + 9.0)
            } else {
                "\n".to_owned()
            };
        }
        format!("head:{}", folder.holding(name, text.as_bytes()))
    };
    let alone = run(&trace(false));
    assert_eq!(alone["gaze_error_deg_mean"], Value::Null, "{alone}");
    assert!(column(&out, "gaze_error_deg").iter().all(Option::is_none));
    let known = run(&trace(true));
    let error = known["gaze_error_deg_mean"].as_f64().unwrap();
    assert!(
        (0.5..9.5).contains(&error),
        "eyes are judged that the system never saw: {error}"
    );
    assert!(column(&out, "gaze_error_deg").iter().all(Option::is_some));
}

#[test]
fn no_score_is_expected_under_a_link_and_a_line_says_why() {
    let folder = Folder::new();
    let (pack, out) = (sphere(&folder), folder.name("run"));
    let run = [
        "simulate", &pack, "--out", &out, "--policy", "uniform", "--json",
    ];
    let with = |options: &[&str]| done(&[&run[..], &QUIET, options].concat());
    let limited = with(&["--link", "1mbit"]);
    let found: Value = serde_json::from_str(&limited.stdout).unwrap();
    assert_eq!(found["expected_jod"], Value::Null, "{found}");
    assert!(
        limited.stderr.contains("expected_jod is null"),
        "{}",
        limited.stderr
    );
    let free = with(&[]);
    let found: Value = serde_json::from_str(&free.stdout).unwrap();
    assert!(found["expected_jod"].as_f64().unwrap() > 5.0, "{found}");
    assert!(!free.stderr.contains("expected_jod"), "{}", free.stderr);
}

#[cfg(unix)]
#[test]
fn two_runs_never_write_into_one_folder_at_once() {
    let folder = Folder::new();
    let pack = still(&folder);
    let out = folder.name("out");
    let run = [&["simulate", &pack, "--out", &out], &QUIET[..]].concat();
    done(&run);
    let before = std::fs::read(folder.name("out/session.jsonl")).unwrap();
    // As another run that is still at work holds it.
    let held = std::fs::File::open(&out).unwrap();
    held.lock().unwrap();
    refused(1, &run, &["another run writes there now"]);
    let after = std::fs::read(folder.name("out/session.jsonl")).unwrap();
    assert_eq!(before, after);
    drop(held);
    done(&run);
}
