//! Does the program do what the two frameworks of Kastner 2016 do?

use crate::scene::torus_pack;
use crate::scenes::{noisy_clip, numbered_sphere, waves, write_clip};
use crate::support::{Folder, Rgb, done, frame_picture, json, refused};
use crate::view::watched;
use foveal_core::content::policy::Policy;
use foveal_core::session::log_of_parts::SessionLog;
use foveal_core::view::picture::Picture;
use serde_json::json;

const WIDE: [&str; 7] = [
    "select",
    "--projection",
    "flat",
    "--size",
    "7680x4320",
    "--preset",
    "kastner-2016",
];

/// A clip of which the right half is noise and the left half one colour, as a pack of the preset.
fn half_noisy(folder: &Folder) -> String {
    let noise = noisy_clip([512, 256], 8);
    let half = |noisy: &Picture| {
        let mut picture = noisy.clone();
        for y in 0..256 {
            picture.planes[0][y * 512..y * 512 + 256].fill(90);
        }
        for plane in &mut picture.planes[1..] {
            plane.fill(128);
        }
        picture
    };
    let clip = write_clip(folder, "a.mkv", &noise.iter().map(half).collect::<Vec<_>>());
    let pack = folder.name("a.foveal");
    let preset = ["--preset", "kastner-2016"];
    done(&[&["prepare", "video", &clip, "--out", &pack], &preset[..]].concat());
    pack
}

#[test]
fn the_preset_cuts_into_4_by_4_cells_of_three_levels_in_steps_of_a_quarter() {
    let folder = Folder::new();
    let info = json(&["info", &half_noisy(&folder)]);
    assert_eq!(
        info["bytes_per_level"].as_array().map(Vec::len),
        Some(3),
        "{info}"
    );
    assert_eq!(info["units"], json!(48), "{info}");
    let around = [
        "--projection",
        "cube",
        "--face-size",
        "3000",
        "--source-faces",
        "4",
    ];
    let preset = ["--preset", "kastner-2016", "--gaze", "-10,10"];
    let one = json(&[&["select"], &around[..], &preset[..]].concat());
    assert_eq!(one["pixels"], json!(1_037_435));
    let noisy = ["--noisy-cells", "22"];
    let one = json(&[&["select"], &around[..], &preset[..], &noisy[..]].concat());
    assert_eq!(one["pixels"], json!(1_766_405));
}

#[test]
fn thresholds_say_how_far_each_level_reaches() {
    let with = |options: &[&str]| {
        json(
            &[
                &WIDE[..],
                &["--policy", "distance", "--gaze", "1,1"],
                options,
            ]
            .concat(),
        )
    };
    // One cell holds the gaze; those within a degree are its three neighbours at the centre.
    assert_eq!(
        with(&["--thresholds", "0.1"])["level_histogram"],
        json!([1, 0, 15])
    );
    assert_eq!(
        with(&["--thresholds", "3"])["level_histogram"],
        json!([4, 0, 12])
    );
    assert_eq!(
        with(&["--thresholds", "0.1,3"])["level_histogram"],
        json!([1, 3, 12])
    );
    assert_eq!(
        with(&["--thresholds", "0,180"])["level_histogram"],
        json!([1, 15, 0])
    );
    let wrong = |text: &'static str| [&WIDE[..], &["--thresholds", text]].concat();
    refused(2, &wrong("3,2"), &["--thresholds", "3,2", "rise"]);
    refused(
        2,
        &wrong("1,2,3"),
        &["--thresholds", "3 angles", "at most 2"],
    );
    refused(2, &wrong("181"), &["--thresholds", "181"]);
    refused(2, &wrong("x"), &["--thresholds", "x"]);
}

#[test]
fn noisy_cells_are_shown_at_the_middle_level_and_the_run_replays() {
    let folder = Folder::new();
    let pack = half_noisy(&folder);
    let run = |name: &str, options: &[&str]| {
        let out = folder.name(name);
        let how = [
            "--policy",
            "grid",
            "--gaze",
            "-20,10",
            "--edge-rule",
            "single",
        ];
        let quiet = ["--renderer", "none", "--out", &out];
        json(&[&["simulate", &pack], &how[..], &quiet[..], options].concat())
    };
    let plain = run("plain", &[]);
    let noisy = run("noisy", &["--noise-threshold", "300"]);
    let none = run("none", &["--noise-threshold", "16384"]);
    assert_eq!(none["decoded_megapixels"], plain["decoded_megapixels"]);
    // Eight cells of the right half, none of which touches the gaze's, 32x16 pixels each.
    let more = noisy["decoded_megapixels"].as_f64().unwrap()
        - plain["decoded_megapixels"].as_f64().unwrap();
    let expected = 8.0 * 8.0 * f64::from(32 * 16) / 1e6;
    assert!((more - expected).abs() < 1e-9, "{more} {expected}");
    let log = folder.name("noisy/session.jsonl");
    let gone = folder.elsewhere(&log);
    refused(2, &["replay", &gone], &["--pack"]);
    assert_eq!(
        json(&["replay", &log, "--pack", &pack])["same"],
        json!(true)
    );
}

#[test]
fn what_needs_content_is_refused_without_it() {
    let noise = ["--policy", "grid", "--noise-threshold", "100"];
    refused(
        2,
        &[&WIDE[..], &noise[..]].concat(),
        &["--noise-threshold", "--noisy-cells"],
    );
    let wrong = ["--policy", "grid", "--noise-threshold", "-1"];
    refused(
        2,
        &[&WIDE[..], &wrong[..]].concat(),
        &["--noise-threshold", "0 to 16384"],
    );
}

#[test]
fn the_published_mask_is_2_08_percent_of_8k() {
    let one = json(&WIDE);
    assert_eq!(one["pixels"], json!(690_926));
    assert_eq!((one["pixels_share"].as_f64().unwrap() * 1e4).round(), 208.0);
    let wanted = json(&[
        "select",
        "--projection",
        "flat",
        "--size",
        "7680x4320",
        "--policy",
        "sampled",
    ]);
    let samples = wanted["pixels"].as_u64().unwrap();
    assert!((14_000..=42_000).contains(&samples), "{samples}");
    let wrong = |option: &'static str, value: &'static str| [&WIDE[..], &[option, value]].concat();
    refused(2, &wrong("--samples", "0"), &["--samples", "1 to"]);
    refused(2, &wrong("--samples", "3686401"), &["--samples", "3686400"]);
    refused(2, &wrong("--mask-size", "0"), &["--mask-size", "1 to 4096"]);
}

/// A pack of soft waves, 512 x 256, as the preset cuts it.
fn wave_pack(folder: &Folder) -> String {
    let clip = write_clip(folder, "w.mkv", &waves([512, 256], 2));
    let pack = folder.name("w.foveal");
    let how = ["--preset", "kastner-2016", "--codec", "png"];
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    pack
}

#[test]
fn samples_show_the_whole_picture_near_the_gaze_and_something_everywhere() {
    let folder = Folder::new();
    let pack = wave_pack(&folder);
    let play = |name: &str, options: &[&str]| {
        let out = folder.name(name);
        let how = [
            "--gaze", "-20,9", "--frames", "1", "--view", "512x256", "--out", &out,
        ];
        let run = json(&[&["simulate", &pack], &how[..], options].concat());
        (frame_picture(&out, 0), run)
    };
    let (whole, _) = play("whole", &["--policy", "full"]);
    let masked = [
        "--samples",
        "40000",
        "--mask-size",
        "480",
        "--preset",
        "kastner-2016",
    ];
    for (n, options) in [
        &[][..],
        &["--renderer", "cpu"],
        &["--interpolation", "blended"],
    ]
    .into_iter()
    .enumerate()
    {
        let (shown, run) = play(&format!("sampled {n}"), &[&masked[..], options].concat());
        assert_eq!(run["pixels_share_mean"], json!(40_000.0 / (512.0 * 256.0)));
        assert_eq!(run["wrong_frame_tiles"], json!(0));
        let (mut near, mut sum) = (0, 0);
        for place in whole.places() {
            let (a, b) = (whole.at(place), shown.at(place));
            let apart = (0..3)
                .map(|k| u32::from(a[k].abs_diff(b[k])))
                .max()
                .unwrap();
            // The gaze is at pixel (51, 33); 2.5° are 25 pixels.
            if place[0].abs_diff(51) < 14 && place[1].abs_diff(33) < 14 {
                near = near.max(apart);
            }
            sum += apart;
        }
        // Near the gaze only chroma differs, which samples take unfiltered; elsewhere a hole, or
        // a sample of nothing, would be far off.
        assert!(near <= 14, "{options:?}: {near}");
        assert!(sum / (512 * 256) < 20, "{options:?}: {sum}");
    }
}

#[test]
fn a_texture_for_every_level_takes_1_0664_of_the_finest_and_draws_on_both_sides() {
    let folder = Folder::new();
    let pack = wave_pack(&folder);
    let play = |name: &str, options: &[&str]| {
        let out = folder.name(name);
        let how = [
            "--policy", "distance", "--gaze", "0,0", "--frames", "1", "--out", &out,
        ];
        let run = json(&[&["simulate", &pack], &how[..], options].concat());
        (frame_picture(&out, 0), run["gpu_bytes"].as_f64().unwrap())
    };
    let (gpu, bytes) = play("gpu", &["--reconstruction", "textures"]);
    let share = bytes / (512.0 * 256.0 * 1.5);
    assert!((1.0664..1.07).contains(&share), "{share}");
    let (cpu, _) = play(
        "cpu",
        &["--reconstruction", "textures", "--renderer", "cpu"],
    );
    let alike = |place| (0..3).all(|k| gpu.at(place)[k].abs_diff(cpu.at(place)[k]) <= 1);
    assert!(gpu.places().all(alike));
    let out = folder.name("none");
    let textures = [
        "simulate",
        &pack,
        "--out",
        &out,
        "--reconstruction",
        "textures",
    ];
    refused(
        2,
        &[&textures[..], &["--policy", "sampled"]].concat(),
        &["--reconstruction"],
    );
    refused(
        2,
        &[&textures[..], &["--heat-map"]].concat(),
        &["--heat-map"],
    );
}

#[test]
fn the_blur_is_off_unless_asked_for_and_leaves_where_the_eye_looks() {
    let folder = Folder::new();
    let pack = half_noisy(&folder);
    let play = |name: &str, options: &[&str]| {
        let out = folder.name(name);
        let how = [
            "--policy", "full", "--gaze", "12,0", "--frames", "1", "--out", &out,
        ];
        done(&[&["simulate", &pack], &how[..], options].concat());
        frame_picture(&out, 0)
    };
    let (plain, off) = (play("plain", &[]), play("off", &["--blur", "off"]));
    let blurred = play("on", &["--blur", "on"]);
    assert!(plain.places().all(|place| plain.at(place) == off.at(place)));
    let changed = plain
        .places()
        .filter(|place| plain.at(*place) != blurred.at(*place));
    assert!(changed.count() > 1000);
}

/// The policies of a window's log, part by part.
fn policies_of(log: &str) -> Vec<Policy> {
    let log = SessionLog::parse(&std::fs::read_to_string(log).unwrap()).unwrap();
    log.parts
        .iter()
        .map(|part| part.head.policy.policy)
        .collect()
}

#[test]
fn the_preset_plays_in_a_window_by_mouse_and_keys() {
    let folder = Folder::new();
    let flat = wave_pack(&folder);
    let shots = folder.name("shots");
    // The mouse is the eye; I fills pixels otherwise, P goes to another rule and back.
    let script = "0 move 40 60\n0 settle\n0 screenshot left.png\n\
                  0.1 move 460 60\n0.1 settle\n0.1 screenshot right.png\n\
                  0.2 key i\n0.2 settle\n0.2 screenshot blended.png\n\
                  0.3 key p\n0.3 settle\n0.4 key Shift+P\n0.4 settle\n0.5 quit";
    let preset = ["--preset", "kastner-2016", "--samples", "9000"];
    let log = folder.name("log.jsonl");
    let window = [
        "--view",
        "512x256",
        "--paused",
        "--screenshots",
        &shots,
        "--log",
        &log,
    ];
    let options = [&preset[..], &["--mask-size", "200"], &window[..]].concat();
    if watched(&folder, &flat, script, &options).is_none() {
        return;
    }
    let policies = policies_of(&log);
    assert_eq!(policies.first(), Some(&Policy::Sampled), "{policies:?}");
    assert_eq!(policies.last(), Some(&Policy::Sampled), "{policies:?}");
    assert!(policies.contains(&Policy::Full), "{policies:?}");
    let out = folder.name("whole");
    let full = ["--policy", "full", "--frames", "1", "--view", "512x256"];
    done(&[&["simulate", &flat, "--out", &out], &full[..]].concat());
    let whole = frame_picture(&out, 0);
    // Mean difference to the whole picture round a place of the mouse.
    let shot = |name: &str| Rgb::read(&format!("{shots}/{name}.png"));
    let off = |shot: &Rgb, x: u32| {
        let near = |at: &[u32; 2]| at[0].abs_diff(x) < 12 && at[1].abs_diff(60) < 12;
        let places: Vec<[u32; 2]> = whole.places().filter(near).collect();
        let apart = |at: &[u32; 2]| {
            let (shown, whole) = (shot.at(*at), whole.at(*at));
            (0..3).map(move |k| u32::from(shown[k].abs_diff(whole[k])))
        };
        let sum: u32 = places.iter().flat_map(apart).sum();
        f64::from(sum) / places.len() as f64
    };
    for (name, gaze, beside) in [("left", 40, 460), ("right", 460, 40), ("blended", 460, 40)] {
        let [near, far] = [gaze, beside].map(|x| off(&shot(name), x));
        assert!(
            2.0 * near < far,
            "{name}: {near} at the mouse, {far} far from it"
        );
    }
    assert!(shot("right").difference(&shot("blended")) > 2);
}

#[test]
fn a_panorama_of_the_preset_plays_by_the_grid_and_a_scene_refuses_it() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "s.mkv", &numbered_sphere(64, 2));
    let pack = folder.name("s.foveal");
    let preset = ["--preset", "kastner-2016"];
    let cube = ["--projection", "equirect", "--codec", "png", "--out", &pack];
    done(&[&["prepare", "video", &clip], &cube[..], &preset[..]].concat());
    // Arrows turn the head.
    let script = "0 move 100 60\n0 settle\n0 key Left\n0 key Up\n0 settle\n0 quit";
    let log = folder.name("log.jsonl");
    let options = [&preset[..], &["--view", "320x200", "--log", &log]].concat();
    if watched(&folder, &pack, script, &options).is_some() {
        let policies = policies_of(&log);
        assert!(
            policies.iter().all(|it| *it == Policy::Grid),
            "{policies:?}"
        );
        let again = json(&["replay", &log, "--pack", &pack]);
        assert_eq!(again["same"], true, "{again}");
    }
    let scene = torus_pack(&folder);
    let out = folder.name("out");
    let view = [&["view", &scene], &preset[..]].concat();
    refused(2, &view, &["kastner-2016", "scene"]);
    let simulate = [&["simulate", &scene, "--out", &out], &preset[..]].concat();
    refused(2, &simulate, &["kastner-2016", "scene"]);
    refused(
        2,
        &["view", &pack, "--preset", "kastner"],
        &["kastner-2016", "free-viewing"],
    );
}

#[test]
fn the_gpu_memory_of_a_run_is_told_over_two_frames() {
    let folder = Folder::new();
    let pack = wave_pack(&folder);
    let out = folder.name("out");
    let how = ["--frames", "1", "--view", "512x256", "--out", &out];
    let preset = [
        "--preset",
        "kastner-2016",
        "--samples",
        "9000",
        "--mask-size",
        "200",
    ];
    let run = json(&[&["simulate", &pack], &how[..], &preset[..]].concat());
    let number = |key: &str| run[key].as_f64().unwrap();
    let pixels = 512.0 * 256.0;
    assert_eq!(number("gpu_share"), number("gpu_bytes") / (1.5 * pixels));
    assert_eq!(
        number("gpu_share_of_floats"),
        number("gpu_bytes") / (12.0 * pixels)
    );
    assert!(number("gpu_bytes") > 0.0, "{run}");
}
