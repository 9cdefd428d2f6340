//! Do the panels of a rig show a pack as a window does, each for itself and all together?

use crate::scene::torus_pack;
use crate::scenes::{noise, waves, write_clip};
use crate::support::{Folder, Rgb, done, json, refused};
use crate::view::watched;
use serde_json::Value;

/// A choice for a small cube.
fn of<'a>(options: &[&'a str]) -> Vec<&'a str> {
    let select = ["select", "--projection", "cube", "--face-size", "512"];
    [&select[..], options].concat()
}

/// A rig that is shipped.
fn example(name: &str) -> String {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    format!("{root}/examples/panels/{name}.toml")
}

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap()
}

const CUBE_16K: [&str; 12] = [
    "select",
    "--projection",
    "cube",
    "--face-size",
    "4096",
    "--tile",
    "256",
    "--policy",
    "acuity",
    "--random-gazes",
    "300",
    "--json",
];

#[test]
fn twelve_panels_take_a_hundredth_of_a_16k_cube_and_never_more_than_no_panels() {
    let twelve = example("twelve");
    let chosen = |options: &[&str]| json(&[&CUBE_16K[..11], options].concat());
    let by_slope = ["--slope", "0.022", "--mapping", "gnomonic"];
    for options in [&by_slope[..], &[]] {
        let all = chosen(options);
        let eyes = ["left", "right", "both"].map(|eye| {
            let panels = ["--panels", &twelve, "--eye", eye];
            chosen(&[options, &panels[..]].concat())
        });
        for panels in &eyes {
            for key in ["pixels_share_mean", "pixels_share_p95", "pixels_share_max"] {
                assert!(number(panels, key) <= number(&all, key), "{key}: {panels}");
            }
        }
        if !options.is_empty() {
            assert!(number(&eyes[2], "pixels_share_mean") <= 0.0095);
            assert!(number(&eyes[2], "pixels_share_mean") >= 0.004);
            assert!(number(&eyes[2], "pixels_share_max") <= 0.0117);
        }
        let [one, _, both] = eyes.map(|it| number(&it, "pixels_mean"));
        assert!(one <= both && both <= 1.05 * one, "{one} {both}");
    }
}

#[test]
fn panels_are_named_and_wrong_ones_are_told_of() {
    let three = example("three");
    let both = json(&of(&["--panels", &three, "--eye", "both"]));
    let panels = both["panels"].as_array().unwrap();
    let ids = panels.iter().map(|panel| panel["id"].as_str().unwrap());
    let ids: Vec<&str> = ids.collect();
    assert_eq!(ids, ["L", "C", "R", "L.right", "C.right", "R.right"]);
    assert_eq!(panels[5]["eye"], "right");
    for option in ["--view=640x480", "--fov=90", "--screen=24,1"] {
        let told = option.split_once('=').unwrap().0;
        refused(2, &of(&["--panels", &three, option]), &[told, "--panels"]);
    }
    refused(2, &of(&["--eye", "right"]), &["--panels"]);
    let sampled = ["--panels", &three, "--policy", "sampled"];
    refused(2, &of(&sampled), &["--policy sampled"]);
    let flat = ["select", "--projection", "flat", "--size", "640x480"];
    json(&[&flat[..], &["--panels", &three]].concat());
    // A wall is looked at by many: no gaze makes anything coarse.
    let wall = json(&of(&["--panels", &example("wall-2x2")]));
    assert_eq!(wall["panels"][0]["eye"], "both");
    let beside = json(&of(&[
        "--panels",
        &example("wall-2x2"),
        "--policy",
        "viewport",
    ]));
    assert_eq!(wall["pixels"], beside["pixels"]);
    refused(1, &of(&["--panels", "no-such.toml"]), &["no-such.toml"]);
}

/// One panel that shows what a window of 400x300 pixels and 90° does.
const WINDOW: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "w"
eye = "left"
pixels = [400, 300]
pose = { order = "yaw-pitch-roll", yaw = 0, pitch = 0, roll = 0 }
tangents = { left = 1.0, right = 1.0, up = 0.75, down = 0.75 }
"#;

/// A pack of a sphere, of some frames that move.
fn sphere_pack(folder: &Folder) -> String {
    let clip = write_clip(folder, "sphere.mkv", &waves([512, 256], 3));
    let pack = folder.name("sphere.foveal");
    let how = ["--projection", "equirect", "--tile", "32", "--fast"];
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    pack
}

#[test]
fn a_panel_like_a_window_shows_its_picture_byte_for_byte() {
    let folder = Folder::new();
    let (pack, rig) = (
        sphere_pack(&folder),
        folder.holding("w.toml", WINDOW.as_bytes()),
    );
    let [window, panel] = ["window", "panel"].map(|name| folder.name(name));
    for how in [
        &["--gaze", "12,-7", "--policy", "acuity"][..],
        &["--gaze", "scan"],
    ] {
        let play = [&["simulate", &pack, "--renderer", "cpu"], how].concat();
        let view = ["--fov", "90", "--view", "400x300", "--out", &window];
        let one = json(&[&play[..], &view].concat());
        let same = json(&[&play[..], &["--panels", &rig, "--out", &panel]].concat());
        assert_eq!(one["pixels_share_mean"], same["pixels_share_mean"]);
        assert_eq!(one["bytes"], same["bytes"]);
        assert_eq!(same["intermediate_pixels"], 0);
        for frame in 0..3 {
            let [own, panels] = [&window, &format!("{panel}/w")]
                .map(|folder| std::fs::read(format!("{folder}/frame_{frame:05}.png")).unwrap());
            assert!(own == panels, "frame {frame}");
        }
        let log = format!("{panel}/session.jsonl");
        assert_eq!(json(&["replay", &log, "--pack", &pack])["same"], true);
    }
}

#[test]
fn a_run_on_six_panels_replays_and_each_is_scored_by_itself() {
    let folder = Folder::new();
    let (pack, out) = (sphere_pack(&folder), folder.name("out"));
    let play = [
        "simulate",
        &pack,
        "--panels",
        &example("six"),
        "--out",
        &out,
    ];
    for policy in ["viewport", "perceptual", "eccentricity"] {
        let how = [
            "--policy",
            policy,
            "--pictures",
            "none",
            "--renderer",
            "none",
        ];
        json(&[&play[..], &how].concat());
        let log = format!("{out}/session.jsonl");
        assert_eq!(json(&["replay", &log, "--pack", &pack])["same"], true);
    }
    let how = [
        "--score",
        "--frames",
        "1",
        "--gaze",
        "20,5",
        "--renderer",
        "cpu",
    ];
    let scored = json(&[&play[..], &how].concat());
    let panels = scored["panels"].as_array().unwrap();
    let jods: Vec<f64> = panels.iter().map(|it| number(it, "jod")).collect();
    let lowest = jods.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(jods.len(), 6);
    assert_eq!(number(&scored["score"], "jod"), lowest);
    assert!(std::path::Path::new(&format!("{out}/r1c2/frame_00000.png")).is_file());
}

#[test]
fn flat_packs_and_scenes_are_shown_on_panels_too() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "flat.mkv", &[noise([128, 96], 0)]);
    let (flat, out) = (folder.name("flat.foveal"), folder.name("out"));
    let three = example("three");
    done(&[
        "prepare", "video", &clip, "--tile", "32", "--fast", "--out", &flat,
    ]);
    for pack in [flat, torus_pack(&folder)] {
        let play = ["simulate", &pack, "--out", &out, "--frames", "2"];
        let play = [&play[..], &["--panels", &three, "--eye", "both"]].concat();
        let shown = json(&[&play[..], &["--renderer", "cpu", "--gaze", "5,3"]].concat());
        assert_eq!(shown["panels"].as_array().unwrap().len(), 6);
        for id in ["L", "C.right"] {
            let picture = std::fs::read(format!("{out}/{id}/frame_00000.png")).unwrap();
            // Of one colour it would be far smaller.
            assert!(picture.len() > 6000, "{pack} {id}: {}", picture.len());
        }
        let log = format!("{out}/session.jsonl");
        assert_eq!(json(&["replay", &log, "--pack", &pack])["same"], true);
    }
}

#[test]
fn panels_that_packs_are_not_drawn_on_are_named() {
    let folder = Folder::new();
    let (pack, out) = (sphere_pack(&folder), folder.name("out"));
    let play = ["simulate", &pack, "--out", &out, "--pictures", "none"];
    let said = |options: &[&str], words: &[&str]| {
        refused(2, &[&play[..], options].concat(), words);
    };
    let three = example("three");
    for option in ["--view=64x48", "--fov=90", "--screen=24,1"] {
        let told = option.split_once('=').unwrap().0;
        said(&["--panels", &three, option], &["--panels", told]);
    }
    let lens = example("lens");
    let window = ["view", &pack, "--panels", &lens];
    refused(2, &window, &["panel left", "distortion", "foveal simulate"]);
    let bent = ["--panels", &lens, "--renderer", "cpu"];
    let bent = json(&[&play[..], &bent].concat());
    assert!(number(&bent, "intermediate_pixels") > 0.0, "{bent}");
    said(&["--panels", &three, "--policy", "sampled"], &["sampled"]);
    let one = folder.holding("one.toml", WINDOW.as_bytes());
    said(
        &["--panels", &one, "--eye", "right"],
        &["no panel", "--eye left"],
    );
}

/// Three panels, of which one is sent on its side and one mirrored.
const TURNED: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "L"
eye = "left"
pixels = [120, 90]
pose = { order = "yaw-pitch-roll", yaw = -35 }
size = [0.9, 0.675]
scanout = "rot90"
output = { surface = "main", x = 0, y = 0 }
[[panel]]
id = "C"
eye = "left"
pixels = [120, 90]
size = [0.9, 0.675]
output = { surface = "main", x = 90, y = 0 }
[[panel]]
id = "R"
eye = "left"
pixels = [120, 90]
pose = { order = "yaw-pitch-roll", yaw = 35 }
size = [0.9, 0.675]
scanout = "flip-x"
output = { surface = "main", x = 90, y = 90 }
"#;

#[test]
fn a_window_shows_every_panel_where_and_how_it_is_sent() {
    let folder = Folder::new();
    let pack = sphere_pack(&folder);
    let rig = folder.holding("turned.toml", TURNED.as_bytes());
    let shot = folder.name("shot.png");
    let script = format!("0 settle\n0 screenshot {shot}\n0.1 quit");
    let options = ["--panels", &rig, "--paused"];
    let Some(summary) = watched(&folder, &pack, &script, &options) else {
        return;
    };
    assert_eq!(summary["gpu_errors"], 0);
    let out = folder.name("out");
    let play = ["simulate", &pack, "--panels", &rig, "--out", &out];
    let how = ["--policy", "viewport", "--gaze", "0,0", "--frames", "1"];
    done(&[&play[..], &how].concat());
    let atlas = Rgb::read(&shot);
    assert_eq!(atlas.size, [210, 180]);
    let seen = |id: &str| Rgb::read(&format!("{out}/{id}/frame_00000.png"));
    let [left, middle, right] = ["L", "C", "R"].map(seen);
    let mut most = 0;
    let mut apart = |sent: [u32; 2], own: [u8; 3]| {
        let shown = atlas.at(sent);
        let off = (0..3).map(|k| shown[k].abs_diff(own[k]));
        most = most.max(off.max().unwrap());
    };
    for [x, y] in middle.places() {
        apart([90 + x, y], middle.at([x, y]));
        apart([90 + 119 - x, 90 + y], right.at([x, y]));
        // Turned a quarter clockwise, what is low comes to the left.
        apart([89 - y, x], left.at([x, y]));
    }
    assert!(most <= 2, "{most}");
}

#[test]
fn the_mouse_looks_through_the_panel_under_it_and_keys_turn_the_head() {
    let folder = Folder::new();
    let pack = sphere_pack(&folder);
    let rig = folder.holding("turned.toml", TURNED.as_bytes());
    let log = folder.name("view.jsonl");
    // The middle of the second panel, of a window as large as the three together, then of the one
    // on its side.
    let script = "0 settle\n0.1 move 150 45\n0.2 settle\n0.3 key Right\n0.4 settle\n\
                  0.5 move 45 60\n0.6 settle\n0.7 quit";
    let options = ["--panels", &rig, "--paused", "--demo", "--log", &log];
    if watched(&folder, &pack, script, &options).is_none() {
        return;
    }
    let text = std::fs::read_to_string(&log).unwrap();
    let lines = text.lines().skip(1).map(serde_json::from_str);
    let frames: Vec<Value> = lines.map(Result::unwrap).collect();
    let yaw_of = |frame: &Value| {
        let gaze = [0, 2].map(|k| frame["gaze"][k].as_f64().unwrap());
        gaze[0].atan2(-gaze[1])
    };
    let turned = |frame: &Value| number(&frame["head"], "yaw");
    let is_ahead = |frame: &Value| yaw_of(frame).abs() < 1e-6 && turned(frame) == 0.0;
    assert!(frames.iter().any(is_ahead));
    let last = frames.last().unwrap();
    assert!(turned(last) > 0.05, "{last}");
    let aside = turned(last) - 35.0_f64.to_radians();
    assert!((yaw_of(last) - aside).abs() < 0.02, "{last}");
    // What is looked at is not left at the coarsest level.
    let tiles = last["tiles"].as_array().unwrap();
    assert!(
        tiles[..tiles.len() - 1].iter().any(|count| *count != 0),
        "{last}"
    );
    assert_eq!(json(&["replay", &log, "--pack", &pack])["same"], true);
}
