//! Is a sphere of equirectangular tiles played like one on a cube?

use crate::scenes::{noise, picture, write_clip};
use crate::support::{Folder, Rgb, done, foveal, frame_picture, json, refused, skipped};
use crate::view::watched;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::{CUBE_FACES, Surface};
use glam::DVec3;
use serde_json::json;

const SIZE: [u32; 2] = [512, 256];

/// Soft colours of every direction.
fn colours(p: usize, d: DVec3) -> u8 {
    let wave = |x: f64, y: f64, z: f64| (d.x * x + d.y * y + d.z * z).sin();
    let of = [
        40.0 * wave(5.0, 2.0, -3.0) + 30.0 * wave(-9.0, 8.0, 7.0),
        40.0 * wave(4.0, -6.0, 2.0),
        40.0 * wave(-3.0, 2.0, 7.0),
    ];
    (128.0 + of[p]) as u8
}

/// The place of a sample's middle in luma pixels; chroma lies on the left.
fn middle(p: usize, [x, y]: [u32; 2]) -> [f64; 2] {
    let [x, y] = [x, y].map(f64::from);
    match p {
        0 => [x + 0.5, y + 0.5],
        _ => [2.0 * x + 0.5, 2.0 * y + 1.0],
    }
}

fn sphere(size: [u32; 2]) -> Picture {
    let surface = Surface::equirect(size);
    picture(size, |p, x, y| {
        colours(p, surface.direction(0, middle(p, [x, y])))
    })
}

/// The same colours on the faces of a cube, six across: right, left, top, bottom, front, back.
fn cube(face: u32) -> Picture {
    let surface = Surface::cube(face);
    picture([6 * face, face], |p, x, y| {
        let [x, y] = middle(p, [x, y]);
        let column = (x / f64::from(face)) as usize;
        let side = [1, 3, 4, 5, 0, 2][column];
        let place = [x - column as f64 * f64::from(face), y];
        colours(p, CUBE_FACES[side].at(surface.tangent(place)).normalize())
    })
}

/// A pack of one picture or a few, without loss.
fn packed(folder: &Folder, clip: &str, name: &str, how: &[&str]) -> String {
    let pack = folder.name(name);
    let usual = [
        "--tile",
        "64",
        "--levels",
        "3",
        "--codec",
        "png",
        "--no-loss",
    ];
    done(&[&["prepare", "video", clip, "--out", &pack], &usual[..], how].concat());
    pack
}

fn seen(folder: &Folder, pack: &str, gaze: &str, policy: &str) -> Rgb {
    let out = folder.name(&format!("{policy}{gaze}"));
    let how = ["--policy", policy, "--gaze", gaze, "--frames", "1"];
    let view = ["--view", "160x120", "--fov", "90", "--out", &out];
    done(&[&["simulate", pack], &how[..], &view[..]].concat());
    let picture = frame_picture(&out, 0);
    std::fs::remove_dir_all(&out).unwrap();
    picture
}

fn mean_difference(a: &Rgb, b: &Rgb) -> f64 {
    assert_eq!(a.size, b.size);
    let pairs = a.pixels.iter().zip(&b.pixels);
    let sum: u32 = pairs.map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
    f64::from(sum) / a.pixels.len() as f64
}

#[test]
fn at_its_seam_and_its_poles_it_shows_what_a_cube_shows() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "world_360.mkv", &[sphere(SIZE)]);
    let flat = packed(
        &folder,
        &clip,
        "sphere.foveal",
        &["--pack-projection", "equirect"],
    );
    let faces = packed(&folder, &clip, "faces.foveal", &[]);
    let info = json(&["info", &flat]);
    let told = [
        "projection",
        "face_width",
        "face_height",
        "faces",
        "mapping",
    ]
    .map(|k| &info[k]);
    let expected = [
        json!("equirect"),
        json!(512),
        json!(256),
        json!(1),
        json!("gnomonic"),
    ];
    assert_eq!(told, expected.each_ref(), "{info}");
    for gaze in ["180,0", "0,90", "-90,-90", "150,60", "10,5"] {
        for (policy, most) in [("full", 0.7), ("coarsest", 1.5), ("acuity", 1.5)] {
            let [a, b] = [&flat, &faces].map(|pack| seen(&folder, pack, gaze, policy));
            let off = mean_difference(&a, &b);
            assert!(off < most, "{gaze} {policy}: {off}");
        }
    }
}

#[test]
fn of_a_still_nothing_is_fetched_again_where_the_head_turns_away_for_a_while() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "world_360.mkv", &[sphere(SIZE)]);
    let how = ["--pack-projection", "equirect"];
    let pack = packed(&folder, &clip, "sphere.foveal", &how);
    let trace = "t_s,yaw_deg,pitch_deg,head_yaw_deg,head_pitch_deg\n\
                 0,0,0,0,0\n1,150,10,150,0\n6,0,0,0,0\n8,0,0,0,0\n";
    let trace = folder.holding("away.csv", trace.as_bytes());
    let out = folder.name("out");
    let gaze = format!("trace:{trace}");
    let play = ["simulate", &pack, "--gaze", &gaze, "--out", &out];
    let how = [
        "--policy",
        "acuity",
        "--view",
        "320x240",
        "--interval",
        "200ms",
    ];
    let run = json(&[&play[..], &how, &["--pictures", "none"]].concat());
    assert!(run["level_changes"].as_u64().unwrap() > 0, "{run}");
    assert_eq!(run["refetched_bytes"], 0, "{run}");
}

#[test]
fn a_whole_one_keeps_its_pixels_and_cubes_and_halves_become_whole() {
    let folder = Folder::new();
    let how = ["--pack-projection", "equirect"];
    let clip = write_clip(&folder, "noise_360.mkv", &[noise(SIZE, 1)]);
    let pack = packed(&folder, &clip, "noise.foveal", &how);
    let score = json(&[
        "score", &clip, &pack, "--policy", "full", "--gaze", "center",
    ]);
    assert!(score["jod"].as_f64().unwrap() > 8.0, "{score}");
    let clip = write_clip(&folder, "world_cube.mkv", &[cube(128)]);
    let pack = packed(&folder, &clip, "unfolded.foveal", &how);
    let faces = packed(&folder, &clip, "cube.foveal", &[]);
    let info = json(&["info", &pack]);
    assert_eq!([&info["face_width"], &info["face_height"]], [512, 256]);
    for gaze in ["180,0", "0,90", "45,30"] {
        let [a, b] = [&pack, &faces].map(|pack| seen(&folder, pack, gaze, "full"));
        assert!(mean_difference(&a, &b) < 1.0, "{gaze}");
    }
    let clip = write_clip(&folder, "world_180.mkv", &[sphere([256, 256])]);
    let pack = packed(&folder, &clip, "half.foveal", &how);
    let info = json(&["info", &pack]);
    assert_eq!([&info["face_width"], &info["face_height"]], [512, 256]);
    assert_eq!(seen(&folder, &pack, "180,0", "full").at([80, 60]), [0; 3]);
    assert_ne!(seen(&folder, &pack, "0,0", "full").at([80, 60]), [0; 3]);
}

#[test]
fn every_command_plays_it() {
    let folder = Folder::new();
    let pictures: Vec<Picture> = (0..4).map(|_| sphere([256, 128])).collect();
    let clip = write_clip(&folder, "world_360.mkv", &pictures);
    let pack = folder.name("world.foveal");
    let made = ["prepare", "video", &clip, "--out", &pack, "--tile", "32"];
    done(&[&made[..], &["--pack-projection", "equirect"]].concat());
    done(&["verify", &pack]);
    for policy in [
        "full",
        "coarsest",
        "viewport",
        "grid",
        "distance",
        "sampled",
        "acuity",
        "uniform",
        "eccentricity",
        "perceptual",
    ] {
        let out = folder.name(policy);
        let how = ["--policy", policy, "--view", "96x64", "--gaze", "scan"];
        let told = json(&[&["simulate", &pack, "--out", &out], &how[..]].concat());
        assert_eq!(told["frames"], json!(4), "{policy}: {told}");
        done(&["replay", &format!("{out}/session.jsonl")]);
    }
    let rig = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/panels/twelve.toml"
    );
    let out = folder.name("panels");
    let panels = [
        "--panels",
        rig,
        "--frames",
        "1",
        "--pictures",
        "none",
        "--out",
        &out,
    ];
    done(&[&["simulate", &pack], &panels[..]].concat());
    let seen = ["--view", "96x64", "--fov", "60", "--gaze", "scan"];
    let score = json(&[&["score", &clip, &pack], &seen[..]].concat());
    assert!(score["jod"].as_f64().unwrap() > 8.0, "{score}");
    let bench = [
        "bench",
        "video",
        &pack,
        "--frames",
        "10",
        "--renderer",
        "none",
    ];
    done(&bench);
    let size = ["select", "--projection", "equirect", "--size", "4096x2048"];
    let selected = json(&[&size[..], &["--policy", "acuity", "--random-gazes", "20"]].concat());
    assert!(
        selected["pixels_share_mean"].as_f64().unwrap() < 0.3,
        "{selected}"
    );
    let site = folder.name("site");
    let exported = foveal(&["export", "site", &pack, "--out", &site]);
    if exported.stderr.contains("built without its pages") {
        return skipped("the program was built without its pages, so no site was exported");
    }
    assert_eq!(exported.code, Some(0), "{exported:?}");
}

#[test]
fn in_a_window_one_turns_up_to_its_pole_and_the_log_replays() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "world_360.mkv", &[sphere([256, 128])]);
    let pack = packed(
        &folder,
        &clip,
        "world.foveal",
        &["--pack-projection", "equirect"],
    );
    let log = folder.name("log.jsonl");
    let script = "0 drag 60 300\n0.3 move 100 80\n0.8 settle\n1 quit";
    let options = ["--view", "200x150", "--demo", "--log", &log];
    if let Some(summary) = watched(&folder, &pack, script, &options) {
        assert_eq!(summary["damaged_tiles"], 0, "{summary}");
        done(&["replay", &log, "--pack", &pack]);
    }
}

#[test]
fn a_flat_input_and_faces_of_none_are_refused() {
    let folder = Folder::new();
    let flat = write_clip(&folder, "flat.mkv", &[noise([96, 64], 0)]);
    let prepare = ["prepare", "video", &flat, "--out", "never.foveal"];
    let equirect = ["--pack-projection", "equirect"];
    let refused_of = |more: &[&str], words: &[&str]| {
        refused(1, &[&prepare[..], &equirect[..], more].concat(), words);
    };
    refused_of(&[], &["--pack-projection equirect", "flat", "--projection"]);
    let sphere = ["--projection", "equirect"];
    let large = [&sphere[..], &["--face-size", "16384"]].concat();
    refused(
        1,
        &[&prepare[..], &large].concat(),
        &[
            "--face-size 16384",
            "32 pixels",
            "GB of memory",
            "at most 2048",
        ],
    );
    for faces in [["--face-size", "64"], ["--mapping", "gnomonic"]] {
        refused_of(&[&sphere[..], &faces[..]].concat(), &["no faces", faces[0]]);
    }
}
