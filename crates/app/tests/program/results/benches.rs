//! Do benchmarks print what is documented?

use super::agrees;
use crate::scene::torus;
use crate::support::{Folder, json, refused};

#[test]
fn what_weighing_costs_is_told_of_as_documented() {
    agrees(
        "bench perception",
        &[&json(&["bench", "perception", "--runs", "1"])],
    );
}

#[test]
fn what_scoring_costs_is_told_of_as_documented() {
    let least = ["--frames", "1", "--runs", "1", "--no-baseline"];
    agrees(
        "bench score",
        &[&json(&[&["bench", "score"], &least[..]].concat())],
    );
}

#[test]
fn what_a_scene_costs_is_told_of_beside_its_baselines_as_documented() {
    let folder = Folder::new();
    let source = folder.holding("torus.obj", torus(64, 32).as_bytes());
    let bench = [
        "bench",
        "scene",
        &source,
        "--fast",
        "--runs",
        "1",
        "--renderer",
        "cpu",
    ];
    let report = json(&bench);
    agrees("bench scene", &[&report]);
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 16, "{report}");
    for row in rows {
        assert!(row["ours"].is_number(), "{row}");
        assert!(
            row["ratio"].is_number() || row["baseline"].as_f64().unwrap_or(0.0) == 0.0,
            "{row}"
        );
        assert_eq!(row["content"], "torus.obj", "{row}");
    }
    assert_eq!(rows[0]["ours"], 0.0, "no odd edge: {report}");

    let only = ["bench", "scene", &source, "--only", "2,first-picture"];
    assert_eq!(json(&only)["rows"].as_array().unwrap().len(), 3);
    refused(
        2,
        &["bench", "scene", &source, "--only", "14"],
        &["--only 14", "first-picture"],
    );
}

#[test]
fn signatures_order_the_units_of_a_scene_as_pictures_of_its_levels_do() {
    let folder = Folder::new();
    let source = folder.holding("torus.obj", torus(300, 120).as_bytes());
    let bench = ["bench", "scene", &source, "--fast", "--only", "worth"];
    let report = json(&bench);
    let rank = report["rows"][0]["ours"].as_f64().unwrap();
    assert!(rank >= 0.8, "{report}");
}
