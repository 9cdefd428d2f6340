//! Do the panels of a rig show a pack as a window does, each for itself and all together?

use crate::support::{json, refused};
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
    let flat = [&flat[..], &["--panels", &three]].concat();
    refused(2, &flat, &["--projection cube"]);
    refused(1, &of(&["--panels", "no-such.toml"]), &["no-such.toml"]);
}
