//! Does the program do what the two frameworks of Kastner 2016 do?

use crate::scenes::{noisy_clip, write_clip};
use crate::support::{Folder, done, json, refused};
use foveal_core::asset::picture::Picture;
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
    refused(2, &["replay", &log], &["--pack"]);
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
