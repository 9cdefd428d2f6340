//! Does `select` give the figures that it is known for?

use crate::support::{done, json, refused};
use serde_json::json;

const KASTNER_GRID: [&str; 14] = [
    "select",
    "--projection",
    "cube",
    "--face-size",
    "3000",
    "--grid",
    "4x4",
    "--levels",
    "3",
    "--level-ratio",
    "4",
    "--source-faces",
    "4",
    "--policy",
];

#[test]
fn the_pixels_of_kastner_s_grid_are_counted() {
    let pixels = |options: &[&str]| json(&[&KASTNER_GRID[..], options].concat());
    let inner = pixels(&["grid", "--gaze", "-10,10"]);
    assert_eq!(inner["pixels"], json!(1_037_435));
    assert_eq!(inner["level_histogram"], json!([1, 8, 87]));
    let share = inner["pixels_share"].as_f64().unwrap();
    assert_eq!((share * 1e5).round(), 2882.0);
    let noisy = pixels(&["grid", "--gaze", "-10,10", "--noisy-cells", "22"]);
    assert_eq!(noisy["pixels"], json!(1_766_405));
    let corner = pixels(&["grid", "--gaze", "0,0", "--edge-rule", "conservative"]);
    assert_eq!(corner["pixels"], json!(2_850_848));
    let coarsest = pixels(&["coarsest", "--gaze", "0,0"]);
    assert_eq!(coarsest["pixels"], json!(212_064));
}

#[test]
fn acuity_takes_a_hundredth_of_a_16k_cube() {
    for (disc, mean, most) in [("0", 0.010, 0.015), ("2.5", 0.013, 1.0), ("5", 0.018, 1.0)] {
        let many = json(&[
            "select",
            "--projection",
            "cube",
            "--face-size",
            "4096",
            "--mapping",
            "gnomonic",
            "--tile",
            "256",
            "--policy",
            "acuity",
            "--slope",
            "0.022",
            "--safety-disc",
            disc,
            "--random-gazes",
            "300",
            "--seed",
            "1",
        ]);
        let figure = |key: &str| many[key].as_f64().unwrap();
        assert!(figure("pixels_share_mean") <= mean, "{disc}: {many}");
        assert!(figure("pixels_share_max") <= most, "{disc}: {many}");
        assert!(figure("pixels_share_mean") >= 0.005, "{disc}: {many}");
        assert_eq!(many["gazes"], json!(300));
    }
}

#[test]
fn a_higher_target_takes_more_and_the_usual_one_is_9_5() {
    let share = |slope: &[&str]| {
        let cube = [
            "select",
            "--projection",
            "cube",
            "--face-size",
            "4096",
            "--tile",
            "128",
        ];
        json(&[&cube[..], slope].concat())["pixels_share"]
            .as_f64()
            .unwrap()
    };
    let usual = share(&[]);
    assert_eq!(usual, share(&["--target", "9.5"]));
    assert!(share(&["--target", "9"]) < usual && usual < share(&["--target", "9.8"]));
    assert!(share(&["--slope", "0.011"]) > 1.5 * share(&["--slope", "0.022"]));
    assert!(share(&["--slope", "0"]) > share(&["--slope", "0.011"]));
    // Without content no texture is known: the slope of the usual target comes from a table.
    assert_eq!(usual, share(&["--slope", "0.0075"]));
}

#[test]
fn targets_that_make_no_sense_are_refused() {
    let cube = ["select", "--projection", "cube", "--face-size", "512"];
    let with = |options: &[&'static str]| [&cube[..], options].concat();
    for target in ["10", "11", "0.5", "-1", "NaN", "inf", "fine"] {
        refused(
            2,
            &with(&["--target", target]),
            &["--target", target, "1 to 9.99"],
        );
    }
    let both = with(&["--target", "9", "--slope", "0.01"]);
    refused(2, &both, &["--target", "--slope", "one of them"]);
    let both = with(&["--target", "9", "--acuity", "watson"]);
    refused(2, &both, &["--target", "--acuity", "one of them"]);
    let unused = done(&with(&["--target", "9", "--policy", "grid"]));
    assert!(
        unused
            .stderr
            .contains("--target changes nothing with --policy grid")
    );
}

#[test]
fn options_that_do_not_fit_are_refused_with_their_names() {
    let cube = ["select", "--projection", "cube"];
    let with = |options: &[&'static str]| [&cube[..], options].concat();
    refused(2, &cube, &["--face-size"]);
    refused(2, &["select", "--projection", "flat"], &["--size"]);
    let flat = ["select", "--projection", "flat", "--size", "640x360"];
    for of_cubes in [["--mapping", "gnomonic"], ["--face-size", "64"]] {
        refused(2, &[&flat[..], &of_cubes].concat(), &of_cubes[..1]);
    }
    refused(
        2,
        &with(&["--face-size", "64", "--tile", "15"]),
        &["15", "even"],
    );
    refused(
        2,
        &with(&["--face-size", "64", "--levels", "9"]),
        &["9 levels"],
    );
    refused(
        2,
        &with(&["--face-size", "64", "--gaze", "0,91"]),
        &["--gaze", "91"],
    );
    refused(
        2,
        &with(&["--face-size", "64", "--safety-disc", "-1"]),
        &["--safety-disc", "0 to 180"],
    );
    refused(
        2,
        &with(&["--face-size", "64", "--source-faces", "7"]),
        &["--source-faces"],
    );
}
