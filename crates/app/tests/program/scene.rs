//! Does a scene go from its file to the picture that an eye gets?

use crate::support::{Folder, Ran, Rgb, column, command, finish, frame_picture, json};
use serde_json::Value;
use std::fmt::Write as _;

/// A closed torus of 2 x `around` x `across` triangles, as OBJ.
pub(crate) fn torus(around: u32, across: u32) -> String {
    let mut text = String::new();
    for i in 0..around {
        for j in 0..across {
            let [a, b] = [(i, around), (j, across)]
                .map(|(n, of)| std::f64::consts::TAU * f64::from(n) / f64::from(of));
            let ring = 0.4 + 0.05 * (7.0 * a).sin() * (5.0 * b).cos();
            let out = 1.0 + ring * b.cos();
            let _ = writeln!(
                text,
                "v {} {} {}",
                out * a.cos(),
                ring * b.sin(),
                out * a.sin()
            );
        }
    }
    let at = |i: u32, j: u32| (i % around) * across + j % across + 1;
    for i in 0..around {
        for j in 0..across {
            let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
            let _ = writeln!(text, "f {a} {b} {c}\nf {c} {b} {d}");
        }
    }
    text
}

/// The pack of a torus of 16,384 triangles.
pub(crate) fn torus_pack(folder: &Folder) -> String {
    let source = folder.holding("torus.obj", torus(128, 64).as_bytes());
    let pack = folder.name("torus.foveal");
    let done = json(&["prepare", "scene", &source, "--out", &pack]);
    assert_eq!(done["leaf_triangles"], 16384, "{done}");
    pack
}

fn simulate(folder: &Folder, pack: &str, more: &[&str]) -> Value {
    let out = folder.name("out");
    let mut arguments = vec!["simulate", pack, "--out", &out];
    arguments.extend(["--view", "320x200", "--renderer", "cpu"]);
    arguments.extend(more);
    json(&arguments)
}

fn refused(arguments: &[&str]) -> (Option<i32>, String) {
    let Ran { code, stderr, .. } = finish(command(arguments));
    (code, stderr)
}

#[test]
fn a_torus_is_prepared_told_of_and_closed_in_every_cut_and_order() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let told = json(&["info", &pack]);
    assert_eq!(
        (&told["kind"], &told["objects"]),
        (&"scene".into(), &1.into())
    );
    let per_level = told["bytes_per_level"].as_array().unwrap();
    assert_eq!(per_level.len() as u64, told["levels"].as_u64().unwrap());
    let sum: u64 = per_level.iter().map(|it| it.as_u64().unwrap()).sum();
    assert_eq!(told["bytes_by_kind"]["mesh"], sum);
    assert!(
        told["bytes_per_leaf_with_tables"].as_f64().unwrap() < 8.0,
        "{told}"
    );
    let tried = json(&["verify", &pack, "--cuts", "20", "--orders", "10"]);
    for (what, expected) in [("ok", Value::from(true)), ("source_odd_edges", 0.into())] {
        assert_eq!(tried[what], expected, "{tried}");
    }
    assert_eq!(tried["odd_edges_max"], 0);
    assert!(tried["levels_in_cut_min"].as_u64().unwrap() >= 3, "{tried}");
    // The negative control: without prerequisites there are cracks, and they are found.
    let arguments = [
        "verify",
        &pack,
        "--cuts",
        "3",
        "--orders",
        "3",
        "--ignore-prerequisites",
    ];
    let (code, stderr) = refused(&arguments);
    assert_eq!(code, Some(1));
    assert!(stderr.contains("not closed"), "{stderr}");
}

#[test]
fn the_same_files_make_the_same_pack_on_any_number_of_threads_and_only_once() {
    let folder = Folder::new();
    let source = folder.holding("t.obj", torus(48, 24).as_bytes());
    let packs = ["1", "2"].map(|jobs| {
        let pack = folder.name(&format!("{jobs}.foveal"));
        let done = json(&["prepare", "scene", &source, "--out", &pack, "--jobs", jobs]);
        assert_eq!(done["already_there"], false);
        std::fs::read(pack).unwrap()
    });
    assert!(packs[0] == packs[1]);
    let pack = folder.name("1.foveal");
    let again = json(&["prepare", "scene", &source, "--out", &pack]);
    assert_eq!(again["already_there"], true);
    let (code, stderr) = refused(&["prepare", "scene", &source, "--out", &pack, "--bits", "12"]);
    assert_eq!(code, Some(2));
    assert!(stderr.contains("--force"), "{stderr}");
    let forced = [
        "prepare", "scene", &source, "--out", &pack, "--bits", "12", "--force",
    ];
    assert_eq!(json(&forced)["already_there"], false);
}

#[test]
fn each_policy_shows_the_torus_and_what_saves_bytes_is_nearer_where_the_eye_looks() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let still = |policy| {
        simulate(
            &folder,
            &pack,
            &["--policy", policy, "--frames", "1", "--gaze", "0,0"],
        )
    };
    let [full, coarsest, viewport, acuity] = ["full", "coarsest", "viewport", "acuity"].map(still);
    assert_eq!(full["error_all"], 0.0);
    let bytes = [&coarsest, &acuity, &viewport, &full].map(|run| run["bytes"].as_u64().unwrap());
    assert!(bytes.is_sorted(), "{bytes:?}");
    let triangles = |run: &Value| run["triangles_mean"].as_f64().unwrap();
    assert_eq!(triangles(&full), 16384.0);
    assert!(triangles(&acuity) <= triangles(&viewport));
    let error = |run: &Value| run["error_all"].as_f64().unwrap();
    assert!(error(&viewport) < error(&coarsest));
    let picture = std::fs::read(folder.name("out/frame_00000.png")).unwrap();
    assert!(picture.len() > 1000);
}

#[test]
fn a_link_brings_the_whole_step_by_step_and_the_run_repeats() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    for policy in ["uniform", "eccentricity"] {
        let link = [
            "--policy",
            policy,
            "--budget",
            "20KB",
            "--interval",
            "100ms",
        ];
        let more = [
            "--frames",
            "12",
            "--gaze",
            "scan",
            "--route",
            "orbit",
            "--pictures",
            "none",
        ];
        let run = || simulate(&folder, &pack, &[&link[..], &more].concat());
        let [first, second] = [run(), run()];
        assert_eq!(first["log_sha256"], second["log_sha256"]);
        let budget = 20_000 * 11;
        let units = first["bytes_by_kind"]["mesh"].as_u64().unwrap();
        assert!(
            (budget / 4..=budget + 5_000).contains(&units),
            "{policy}: {units}"
        );
        let errors = column(&folder.name("out"), "error_all");
        assert!(errors[11] < errors[0] / 4.0, "{policy}: {errors:?}");
    }
}

#[test]
fn nothing_is_fetched_again_where_the_head_turns_away_for_five_seconds() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let route = "t_s,x,y,z,yaw_deg,pitch_deg\n\
                 0,0,1,2.5,0,-15\n1,0,1,2.5,0,-15\n2,0,1,2.5,180,-15\n\
                 7,0,1,2.5,180,-15\n8,0,1,2.5,0,-15\n9,0,1,2.5,0,-15\n";
    let route = folder.holding("away.csv", route.as_bytes());
    let play = [
        "--route",
        &route,
        "--interval",
        "250ms",
        "--policy",
        "acuity",
    ];
    let run = |more: &[&str]| simulate(&folder, &pack, &[&play[..], more].concat());
    let all = run(&["--pictures", "none"]);
    assert_eq!(all["refetched_bytes"], 0, "{all}");
    // What came for the first picture is all that the last one needs.
    let first = run(&["--pictures", "none", "--frames", "4"]);
    assert_eq!(all["units_by_level"], first["units_by_level"]);
    assert_eq!(all["error_all"], first["error_all"]);
}

#[test]
fn perceptual_brings_the_fovea_with_fewer_bytes_and_its_log_replays_without_a_gpu() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let to_fovea = |policy| {
        let run = simulate(
            &folder,
            &pack,
            &[
                &["--policy", policy, "--budget", "6KB", "--interval", "50ms"][..],
                &["--frames", "60", "--gaze", "4,3", "--pictures", "none"],
            ]
            .concat(),
        );
        let bytes = run["bytes_to_fovea"].as_u64();
        bytes.unwrap_or_else(|| panic!("{policy} never got there: {run}"))
    };
    let [uniform, perceptual] = ["uniform", "perceptual"].map(to_fovea);
    assert!(perceptual < uniform, "{perceptual} of {uniform}");
    let log = folder.name("out/session.jsonl");
    let lines = std::fs::read_to_string(&log).unwrap();
    let frames: Vec<Value> = lines
        .lines()
        .skip(1)
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    // Nothing is drawn yet when the first frame is chosen.
    assert_eq!(frames[0]["footprints"], Value::Null);
    assert_eq!(frames[0]["budget"], 0);
    let told = |frame: &Value| frame["footprints"].as_array().map_or(0, Vec::len);
    assert_eq!(told(&frames[1]), 4, "of the root one unit is refined next");
    assert!(frames.iter().any(|frame| told(frame) > 40));
    let again = json(&["replay", &log, "--pack", &pack]);
    assert_eq!(again["same"], true, "{again}");
    // A footprint that was not there leads to another choice.
    let changed = lines.replacen("\"footprints\":[", "\"footprints\":[3,90000,1,1,", 1);
    let changed = folder.holding("changed.jsonl", changed.as_bytes());
    let (code, _) = refused(&["replay", &changed, "--pack", &pack]);
    assert_eq!(code, Some(1));
}

#[test]
fn what_a_scene_cannot_do_is_said() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let out = folder.name("out");
    for (more, expected) in [
        (
            ["--policy", "grid"],
            "a scene has none; scenes are chosen by full, coarsest, viewport, acuity, uniform, \
             eccentricity, perceptual",
        ),
        (["--route", "nowhere.csv"], "nowhere.csv"),
        (["--gaze", "40,0"], "20 degrees"),
        (["--start", "3"], "no frames in time"),
        (["--gpu-memory", "lots"], "256MB"),
    ] {
        let (code, stderr) = refused(&["simulate", &pack, "--out", &out, more[0], more[1]]);
        assert!(
            matches!(code, Some(1 | 2)) && stderr.contains(expected),
            "{more:?}: {stderr}"
        );
    }
    for command in ["score", "select"] {
        let (code, stderr) = refused(&[command, &pack, &pack]);
        assert!(matches!(code, Some(1 | 2)), "{command}: {stderr}");
    }
    let bad = folder.holding("bad.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9\n");
    let to = folder.name("bad.foveal");
    let (code, stderr) = refused(&["prepare", "scene", &bad, "--out", &to]);
    assert!(
        code == Some(1) && stderr.contains("bad.obj") && stderr.contains("line 3"),
        "{stderr}"
    );
    for (name, bytes, expected) in [
        (
            "empty.glb",
            &b""[..],
            "empty.glb: there is nothing to draw: the file has no bytes",
        ),
        (
            "far.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 2e15 0\nf 1 2 3\n",
            "far.obj: there is nothing to draw",
        ),
    ] {
        let bad = folder.holding(name, bytes);
        let (code, stderr) = refused(&["prepare", "scene", &bad, "--out", &to]);
        assert!(code == Some(1) && stderr.contains(expected), "{stderr}");
    }
    assert!(!folder.names().contains(&"bad.foveal".to_owned()));
    let (code, stderr) = refused(&["verify", &pack, "--ignore-prerequisites"]);
    assert!(code == Some(2) && stderr.contains("--cuts N"), "{stderr}");
}

#[test]
fn a_heat_map_has_the_colours_of_levels() {
    let folder = Folder::new();
    let pack = torus_pack(&folder);
    let pictures = [&[][..], &["--heat-map"]].map(|more| {
        let still = [
            &["--policy", "acuity", "--frames", "1", "--gaze", "0,0"],
            more,
        ]
        .concat();
        simulate(&folder, &pack, &still);
        frame_picture(&folder.name("out"), 0)
    });
    // Of a grey torus: no pixel has a colour without, many have with.
    let colourful = |picture: &Rgb| {
        let is_colour = |[r, g, b]: &[u8; 3]| r.abs_diff(*g).max(g.abs_diff(*b)) > 40;
        picture
            .places()
            .filter(|it| is_colour(&picture.at(*it)))
            .count()
    };
    assert_eq!(colourful(&pictures[0]), 0);
    assert!(
        colourful(&pictures[1]) > 3000,
        "{}",
        colourful(&pictures[1])
    );
}

#[test]
fn every_flipped_byte_of_a_scene_is_found() {
    let folder = Folder::new();
    let source = folder.holding("t.obj", torus(12, 8).as_bytes());
    let pack = folder.name("t.foveal");
    json(&["prepare", "scene", &source, "--out", &pack]);
    let good = std::fs::read(&pack).unwrap();
    for place in (0..good.len()).step_by(good.len() / 60) {
        let mut bad = good.clone();
        bad[place] ^= 0x40;
        std::fs::write(&pack, &bad).unwrap();
        let (code, stderr) = refused(&["verify", &pack]);
        assert!(
            code == Some(1) && !stderr.contains("panicked"),
            "byte {place}: {stderr}"
        );
    }
}
