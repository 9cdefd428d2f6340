//! Does a window fly through a scene, and can what it showed be chosen again?

use crate::scene::torus;
use crate::support::{Folder, Rgb, done, json, refused};
use crate::view::watched;
use foveal_core::content::policy::Policy;
use foveal_core::session::log_of_parts::SessionLog;
use std::fmt::Write;

/// A torus with bumps, of 2 x 96 x 48 triangles, as a pack.
fn torus_pack(folder: &Folder) -> String {
    let (around, across) = (96u32, 48u32);
    let mut obj = String::new();
    let turn = |k: u32, of: u32| std::f64::consts::TAU * f64::from(k) / f64::from(of);
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        let (u, v) = (turn(i, around), turn(j, across));
        let thick = 0.4 + 0.05 * (9.0 * u).sin() * (5.0 * v).cos();
        let out = 1.0 + thick * v.cos();
        let at = [out * u.cos(), out * u.sin(), thick * v.sin()];
        writeln!(obj, "v {} {} {}", at[0], at[1], at[2]).unwrap();
    }
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        let at = |i: u32, j: u32| (i % around) * across + j % across + 1;
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        writeln!(obj, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    }
    let mesh = folder.holding("torus.obj", obj.as_bytes());
    let pack = folder.name("torus.foveal");
    done(&["prepare", "scene", &mesh, "--out", &pack]);
    pack
}

fn share(picture: &Rgb, counts: impl Fn(&[u32; 2]) -> bool) -> f64 {
    let all = picture.places().count();
    picture.places().filter(counts).count() as f64 / all as f64
}

/// Share of the pixels that differ clearly from the one in the corner.
fn covered(picture: &Rgb) -> f64 {
    let corner = picture.at([0, 0]);
    let differs = |at: &[u32; 2]| {
        let pixel = picture.at(*at);
        (0..3).any(|k| pixel[k].abs_diff(corner[k]) > 12)
    };
    share(picture, differs)
}

#[test]
fn a_window_flies_through_a_scene_and_the_log_is_replayed() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let shots = folder.name("shots");
    let log = folder.name("flight.jsonl");
    let script = "0 settle\n0 screenshot start.png\n\
                  0.1 press w\n0.6 release w\n0.6 key w\n0.6 key w\n0.6 key w\n\
                  0.6 settle\n0.6 screenshot near.png\n\
                  0.7 drag 40 20\n0.7 settle\n0.7 screenshot turned.png\n\
                  0.8 key l\n0.8 settle\n0.8 screenshot levels.png\n0.8 key l\n\
                  0.9 key d\n0.9 wheel -2\n0.9 key space\n0.9 key r\n0.9 key j\n0.9 key m\n\
                  1.0 key Home\n1.0 settle\n1.0 screenshot home.png\n\
                  1.1 key p\n1.1 key h\n1.1 key h\n1.2 settle\n1.3 quit";
    let options = [
        "--view",
        "480x300",
        "--screenshots",
        &shots,
        "--log",
        &log,
        "--demo",
    ];
    let Some(summary) = watched(&folder, &pack, script, &options) else {
        return;
    };
    assert_eq!(summary["damaged_tiles"], 0);
    assert_eq!(summary["gpu_errors"], 0);
    let shot = |name: &str| Rgb::read(&format!("{shots}/{name}.png"));
    let [start, near, turned, levels, home] =
        ["start", "near", "turned", "levels", "home"].map(shot);
    let share = covered(&start);
    assert!(
        (0.1..0.6).contains(&share),
        "the whole torus covers {share}"
    );
    assert!(
        covered(&near) > share * 1.2,
        "{} after {share}",
        covered(&near)
    );
    for (name, other) in [("near", &start), ("turned", &near), ("levels", &turned)] {
        assert!(shot(name).difference(other) > 30, "{name} is as before");
    }
    assert!(covered(&levels) > 0.1);
    assert_eq!(home.size, start.size);
    assert!(
        (covered(&home) - share).abs() < 0.02,
        "it is not back at the start"
    );
    let again = json(&["replay", &log]);
    assert_eq!(again["same"], true, "{again}");
    assert!(again["frames"].as_u64().unwrap() > 5, "{again}");
}

/// Hills 40 wide and 1 high, as a pack.
fn land_pack(folder: &Folder) -> String {
    let sides = 60u32;
    let mut obj = String::new();
    for (i, j) in (0..=sides).flat_map(|i| (0..=sides).map(move |j| (i, j))) {
        let [x, z] = [i, j].map(|k| f64::from(k) / 1.5);
        let y = (x * 0.7).sin() * (z * 0.5).cos() / 2.0;
        writeln!(obj, "v {x} {y} {z}").unwrap();
    }
    let at = |i: u32, j: u32| i * (sides + 1) + j + 1;
    for (i, j) in (0..sides).flat_map(|i| (0..sides).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        writeln!(obj, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    }
    let mesh = folder.holding("land.obj", obj.as_bytes());
    let pack = folder.name("land.foveal");
    done(&["prepare", "scene", &mesh, "--out", &pack]);
    pack
}

#[test]
fn flat_land_is_seen_from_above_at_first_and_where_it_is_told_to_be_on_a_route() {
    let folder = Folder::new();
    let pack = land_pack(&folder);
    let shots = folder.name("shots");
    let script = "0 settle\n0 screenshot start.png\n0.1 drag 0 60\n0.2 key Home\n\
                  0.2 settle\n0.3 screenshot home.png\n0.3 quit";
    let options = ["--view", "480x300", "--screenshots", &shots];
    if watched(&folder, &pack, script, &options).is_some() {
        let shot = |name: &str| Rgb::read(&format!("{shots}/{name}.png"));
        let [start, home] = ["start", "home"].map(shot);
        assert!(covered(&start) > 0.1, "{}", covered(&start));
        assert!(home.difference(&start) <= 1);
    }
    let still = folder.name("still");
    let run = [
        "simulate", &pack, "--frames", "1", "--view", "480x300", "--out", &still,
    ];
    done(&run);
    let beside = Rgb::read(&format!("{still}/frame_00000.png"));
    assert!(
        covered(&beside) < 0.05,
        "a route stands still where it is meant to"
    );
}

#[test]
fn a_single_flat_triangle_is_seen_from_above_too() {
    let folder = Folder::new();
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n";
    let mesh = folder.holding("flat.obj", obj);
    let pack = folder.name("flat.foveal");
    done(&["prepare", "scene", &mesh, "--out", &pack]);
    let shots = folder.name("shots");
    let script = "0 settle\n0 screenshot start.png\n0.1 quit";
    let options = ["--view", "300x200", "--screenshots", &shots];
    if watched(&folder, &pack, script, &options).is_some() {
        let start = Rgb::read(&format!("{shots}/start.png"));
        assert!(covered(&start) > 0.02, "{}", covered(&start));
    }
}

/// Share of the pixels that are no grey.
fn coloured(picture: &Rgb) -> f64 {
    let is_coloured = |at: &[u32; 2]| {
        let [r, g, b] = picture.at(*at);
        r.abs_diff(b).max(r.abs_diff(g)) > 20
    };
    share(picture, is_coloured)
}

#[test]
fn a_window_colours_a_scene_by_importance_and_a_held_key_makes_the_eye_jump() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let (shots, log) = (folder.name("shots"), folder.name("flight.jsonl"));
    // Of levels and importance one is shown, and importance also by a new device.
    let script = "0 move 60 150\n0 settle\n0 screenshot plain.png\n\
                  0.1 key l\n0.2 key i\n0.4 screenshot worth.png\n\
                  0.5 lose-device\n0.5 key i\n0.5 key i\n0.6 settle\n0.7 screenshot again.png\n\
                  0.7 move 420 150\n0.8 settle\n0.9 screenshot right.png\n\
                  0.9 move 60 150\n\
                  1.0 key i\n1.0 settle\n1.0 screenshot off.png\n\
                  1.0 press x\n1.2 move 400 100\n1.4 release x\n1.4 move 300 100\n2.2 quit";
    let options = [
        "--view",
        "480x300",
        "--screenshots",
        &shots,
        "--log",
        &log,
        "--demo",
        "--policy",
        "acuity",
    ];
    let Some(summary) = watched(&folder, &pack, script, &options) else {
        return;
    };
    assert_eq!(summary["gpu_errors"], 0);
    let shot = |name: &str| Rgb::read(&format!("{shots}/{name}.png"));
    let [plain, worth, again, right, off] = ["plain", "worth", "again", "right", "off"].map(shot);
    assert_eq!(coloured(&plain), 0.0, "the torus is white");
    assert!(coloured(&worth) > 0.5 * covered(&plain));
    assert!(again.difference(&worth) <= 2);
    assert!(off.difference(&plain) <= 2);
    // Warmer where the eye looks.
    let warmth = |picture: &Rgb, columns: [u32; 2]| -> i64 {
        let within = |[x, _]: &[u32; 2]| (columns[0]..columns[1]).contains(x);
        let warm = |at| i64::from(picture.at(at)[0]) - i64::from(picture.at(at)[2]);
        picture.places().filter(within).map(warm).sum()
    };
    let tilt = |it: &Rgb| warmth(it, [0, 240]) - warmth(it, [240, 480]);
    assert!(
        tilt(&worth) > tilt(&right) + 10_000,
        "{} {}",
        tilt(&worth),
        tilt(&right)
    );
    let told = std::fs::read_to_string(&log).unwrap();
    for state in ["jumping", "landed", "steady"] {
        assert!(
            told.contains(&format!("\"state\":\"{state}\"")),
            "{state}: {told}"
        );
    }
    assert_eq!(json(&["replay", &log])["same"], true);
}

#[test]
fn policies_and_options_that_are_for_video_are_refused_for_scenes() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let works = "viewport, acuity, perceptual, eccentricity, uniform, full, coarsest";
    refused(
        2,
        &["view", &pack, "--policy", "grid"],
        &["--policy grid", works],
    );
    refused(2, &["view", &pack, "--blur", "on"], &["--blur on", "video"]);
    refused(
        2,
        &["view", &pack, "--gpu-memory", "much"],
        &["--gpu-memory", "256MB"],
    );
    let score = ["view", &pack, "--demo", "--link", "8mbit", "--target", "9"];
    refused(2, &score, &["--target", "eccentricity", "--policy acuity"]);
    let out = folder.name("out");
    let score = [
        "simulate",
        &pack,
        "--policy",
        "perceptual",
        "--target",
        "9",
        "--out",
        &out,
    ];
    refused(2, &score, &["--target", "perceptual", "--policy acuity"]);
    let script = folder.holding("script.txt", b"0 press h\n");
    refused(
        1,
        &["view", &pack, "--script", &script],
        &["key h does all it does at once"],
    );
    let log = folder.holding("log.jsonl", b"{}\n");
    refused(1, &["replay", &log, "--pack", &pack], &["log.jsonl"]);
}

#[test]
fn a_demo_of_a_scene_stays_coarse_beside_the_gaze() {
    let folder = Folder::new();
    let mesh = folder.holding("fine.obj", torus(160, 80).as_bytes());
    let pack = folder.name("fine.foveal");
    done(&["prepare", "scene", &mesh, "--out", &pack]);
    // The policy of a window, and the triangles that it ends with.
    let watch = |name: &str, more: &[&str]| {
        let log = folder.name(name);
        let script = "0 move 60 150\n0 settle\n0.1 quit";
        let options = [&["--view", "480x300", "--log", &log], more].concat();
        watched(&folder, &pack, script, &options)?;
        let log = SessionLog::parse(&std::fs::read_to_string(log).unwrap()).unwrap();
        let part = log.parts.last().unwrap();
        Some((part.head.policy.policy, part.frames.last().unwrap().samples))
    };
    let Some((policy, foveated)) = watch("demo.jsonl", &["--demo"]) else {
        return;
    };
    assert_eq!(policy, Policy::Acuity);
    let (_, all) = watch("full.jsonl", &["--policy", "full"]).unwrap();
    let share = foveated as f64 / all as f64;
    assert!(share < 0.7, "{foveated} of {all} triangles are shown");
    // What a link brings is spent by worth, as before.
    let linked = watch("link.jsonl", &["--demo", "--link", "8mbit"]);
    assert_eq!(linked.unwrap().0, Policy::Eccentricity);
}

#[test]
fn one_frame_of_a_scene_under_perceptual_says_that_it_shows_the_roots() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let run = |policy: &str, frames: &str| {
        let out = folder.name("out");
        let how = ["--policy", policy, "--frames", frames, "--pictures", "none"];
        done(&[&["simulate", &pack, "--out", &out], &how[..]].concat()).stderr
    };
    let told = run("perceptual", "1");
    assert!(
        told.contains("only the roots") && told.contains("--frames 2"),
        "{told}"
    );
    for (policy, frames) in [("perceptual", "2"), ("acuity", "1")] {
        let told = run(policy, frames);
        assert!(!told.contains("roots"), "{policy} {frames}: {told}");
    }
}
