//! Do the panels of a rig show a pack as a window does, each for itself and all together?

use crate::scene::torus_pack;
use crate::scenes::{noise, picture, waves, write_clip};
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

/// How much screens of the panels of a rig differ, in codes on average: from a flat pack, and
/// from its source by the pass that fills panels.
fn apart_from_warped(folder: &Folder, [clip, pack]: [&str; 2], rig: &str, how: &[&str]) -> f64 {
    let (out, warped) = (folder.name("played"), folder.name("warped"));
    let eye = ["--eye", "left"];
    let play = ["simulate", pack, "--panels", rig, "--out", &out];
    let level = ["--policy", "full", "--renderer", "cpu", "--frames", "1"];
    let shown = json(&[&play[..], &level, &eye, how].concat());
    let log = format!("{out}/session.jsonl");
    assert_eq!(json(&["replay", &log, "--pack", pack])["same"], true);
    let warp = ["panels", "warp", rig, clip, "--out", &warped];
    let level = ["--renderer", "cpu", "--frames", "1"];
    done(&[&warp[..], &level, &eye, how].concat());
    let (mut sum, mut count) = (0.0, 0.0);
    for panel in shown["panels"].as_array().unwrap() {
        let id = panel["id"].as_str().unwrap();
        let own = Rgb::read(&format!("{out}/{id}/frame_00000.png"));
        let warped = format!("{warped}/{id}");
        let folder = std::path::Path::new(&warped);
        let still = match folder.is_dir() {
            true => format!("{warped}/frame_00000.png"),
            false => format!("{warped}.png"),
        };
        let same = Rgb::read(&still);
        for at in own.places() {
            let (a, b) = (own.at(at), same.at(at));
            sum += (0..3).map(|k| f64::from(a[k].abs_diff(b[k]))).sum::<f64>() / 3.0;
            count += 1.0;
        }
    }
    sum / count
}

/// A rig of small panels.
fn small(name: &str) -> String {
    let rig = std::fs::read_to_string(example(name)).unwrap();
    rig.replace("[800, 600]", "[120, 90]")
        .replace("[1920, 1080]", "[120, 68]")
}

#[test]
fn a_flat_pack_lies_where_its_source_would() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "flat.mkv", &waves([512, 384], 1));
    let pack = folder.name("flat.foveal");
    let how = ["--tile", "32", "--fast", "--out", &pack];
    done(&[&["prepare", "video", &clip], &how[..]].concat());
    let mut shown = Vec::new();
    for name in ["six", "wall-2x2"] {
        let rig = folder.holding(&format!("{name}.toml"), small(name).as_bytes());
        for how in [&[][..], &["--placement", "seed"], &["--placement", "plane"]] {
            let apart = apart_from_warped(&folder, [&clip, &pack], &rig, how);
            println!("{name} {how:?}: {apart:.3} codes");
            assert!(apart < 3.0, "{name} {how:?}: {apart}");
            shown.push(std::fs::read(folder.name("played/r0c0/frame_00000.png")).unwrap());
        }
    }
    // A screen is filled whatever its shape.
    let screened = small("six").replacen("mirror", "screen = [4.0, 1.8]\nmirror", 1);
    let rig = folder.holding("screened.toml", screened.as_bytes());
    let apart = apart_from_warped(&folder, [&clip, &pack], &rig, &[]);
    assert!(apart < 3.0, "screen: {apart}");
    // Of six panels the plane is not square before the head.
    assert!(shown[0] == shown[2] && shown[0] != shown[1]);
    let play = ["simulate", &pack, "--pictures", "none", "--out"];
    let out = folder.name("refused");
    let curved = ["--panels", &example("three"), "--placement", "cylinder"];
    let told = ["--placement", "auto, seed or plane", "foveal panels warp"];
    refused(2, &[&play[..], &[&out], &curved].concat(), &told);
    let dome = ["--panels", &example("dome-4")];
    refused(
        2,
        &[&play[..], &[&out], &dome].concat(),
        &["no plane", "sphere"],
    );
    let select = [
        "select",
        "--projection",
        "flat",
        "--size",
        "640x480",
        "--panels",
    ];
    let six = example("six");
    let [seed, plane] =
        ["seed", "plane"].map(|name| json(&[&select[..], &[&six, "--placement", name]].concat()));
    assert!(number(&plane, "pixels") != number(&seed, "pixels"));
}

#[test]
fn scenes_on_panels_are_scored_panel_by_panel_and_weighed_by_all() {
    let folder = Folder::new();
    let (pack, out) = (torus_pack(&folder), folder.name("out"));
    let rig = folder.holding("three.toml", small("three").as_bytes());
    let play = [
        "simulate", &pack, "--panels", &rig, "--out", &out, "--frames", "2",
    ];
    let scored = json(&[&play[..], &["--score", "--budget", "20kB"]].concat());
    let panels = scored["panels"].as_array().unwrap();
    let jods: Vec<f64> = panels.iter().map(|it| number(it, "jod")).collect();
    let lowest = jods.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(jods.len(), 3);
    assert_eq!(number(&scored["score"], "jod"), lowest);
    let rendered = [
        "--importance",
        "rendered",
        "--policy",
        "perceptual",
        "--budget",
        "20kB",
    ];
    let rendered = json(&[&play[..], &rendered].concat());
    assert!(number(&rendered, "bytes") > 0.0);
    let log = format!("{out}/session.jsonl");
    assert_eq!(json(&["replay", &log, "--pack", &pack])["same"], true);
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
    let bent = ["--panels", &lens, "--renderer", "cpu"];
    let bent = json(&[&play[..], &bent].concat());
    assert!(number(&bent, "intermediate_pixels") > 0.0, "{bent}");
    said(&["--placement", "plane"], &["--placement", "--panels"]);
    let round = ["--panels", &three, "--placement", "plane"];
    said(&round, &["--placement", "flat packs"]);
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

/// The same with optics before the first two, and fading into each other.
fn bent() -> String {
    let optics = [
        "distortion = { model = \"bulge\", b = 0.15, sign = \"toward-eye\" }\nblend = 5.0\n",
        "distortion = { model = \"polynomial\", red = { coefficients = [1.0, 0.0, 0.2] },\
         green = { coefficients = [1.0, 0.0, 0.24] },\
         blue = { coefficients = [1.0, 0.0, 0.3] } }\n\
         blend = 5.0\ngain = [1.0, 0.8, 0.9]\n",
        "blend = 5.0\nblack = 0.01\n",
    ];
    let panels = TURNED.split("[[panel]]").skip(1).zip(optics);
    let panels = panels.map(|(panel, optics)| format!("[[panel]]{panel}{optics}"));
    let panels: String = panels.collect();
    format!("format = \"tiled-view/1\"\n{panels}")
}

#[test]
fn a_window_shows_every_panel_where_and_how_it_is_sent() {
    for rig in [TURNED.to_owned(), bent()] {
        a_window_shows_what_simulate_writes(&rig);
    }
}

fn a_window_shows_what_simulate_writes(rig: &str) {
    let folder = Folder::new();
    let pack = sphere_pack(&folder);
    let rig = folder.holding("turned.toml", rig.as_bytes());
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

/// Two panels that overlap by 12 degrees, straight ahead and to the right.
const FADING: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "a"
pixels = [480, 360]
size = [0.8, 0.6]
blend = 6.0
[[panel]]
id = "b"
pixels = [480, 360]
pose = { order = "yaw-pitch-roll", yaw = 32 }
size = [0.8, 0.6]
blend = 6.0
"#;

#[test]
fn flat_white_through_overlapping_panels_is_flat() {
    let folder = Folder::new();
    let white = picture([128, 96], |plane, _, _| if plane == 0 { 235 } else { 128 });
    let clip = write_clip(&folder, "white.mkv", &[white]);
    let (pack, out) = (folder.name("white.foveal"), folder.name("out"));
    done(&["prepare", "video", &clip, "--fast", "--out", &pack]);
    let rig = folder.holding("fading.toml", FADING.as_bytes());
    let play = ["simulate", &pack, "--panels", &rig, "--out", &out];
    let shown = json(&[&play[..], &["--frames", "1", "--renderer", "cpu"]].concat());
    assert_eq!(shown["intermediate_pixels"], 0);
    let [a, b] = ["a", "b"].map(|id| Rgb::read(&format!("{out}/{id}/frame_00000.png")));
    let linear = |code: u8| match f64::from(code) / 255.0 {
        code if code <= 0.040_45 => code / 12.92,
        code => ((code + 0.055) / 1.055).powf(2.4),
    };
    let coded = |light: f64| 255.0 * (1.055 * light.powf(1.0 / 2.4) - 0.055);
    let (sin, cos) = 32.0_f64.to_radians().sin_cos();
    let white = f64::from(a.at([10, 180])[0]);
    assert!(white > 250.0, "{white}");
    let (mut faded, mut beyond, mut worst) = (0, 0, 0.0_f64);
    for [x, y] in a.places() {
        // The ray of a pixel of the first panel, as the second has it.
        let [right, down] = [x, y].map(|at| (f64::from(at) + 0.5) / 600.0);
        let (right, down) = (right - 0.4, down - 0.3);
        let depth = right * sin + cos;
        let place = [(right * cos - sin) / depth + 0.4, down / depth + 0.3];
        let place = place.map(|at| at * 600.0);
        let light = linear(a.at([x, y])[0]);
        if place[0] < 2.0 || place[1] < 2.0 || place[1] > 358.0 {
            continue;
        }
        faded += u32::from(light < 0.9);
        let part = [0, 1].map(|k| (place[k] - 0.5).fract());
        let at = |dx: u32, dy: u32| {
            let at = [0, 1].map(|k| (place[k] - 0.5) as u32);
            linear(b.at([at[0] + dx, at[1] + dy])[0])
        };
        let row = |dy| at(0, dy) * (1.0 - part[0]) + at(1, dy) * part[0];
        let other = row(0) * (1.0 - part[1]) + row(1) * part[1];
        let off = (coded(light + other) - white).abs();
        worst = worst.max(off);
        beyond += u32::from(off > 1.0);
    }
    println!("flat white: worst {worst:.3} codes, {beyond} of {faded} beyond one");
    // Where edges of two panels cross, shares change within a pixel, and between pixels is neither.
    assert!(
        beyond * 1000 <= faded && worst <= 4.0 && faded > 10_000,
        "{beyond} {worst}"
    );
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
