//! Does comparing policies report every saving with its score?

use crate::results::agrees;
use crate::scenes::write_clip_at;
use crate::support::{Folder, done, json, refused};
use foveal_media::generate::GeneratedScene;
use serde_json::Value;

/// A clip of five frames a second.
fn clip(folder: &Folder, name: &str, scene: &GeneratedScene, frames: u64) -> String {
    let pictures: Vec<_> = (0..frames).map(|number| scene.frame(number)).collect();
    let ticks: Vec<u64> = (0..frames).collect();
    write_clip_at(folder, name, &pictures, [5, 1], &ticks)
}

fn pack(folder: &Folder, name: &str, clip: &str, options: &[&str]) -> String {
    let pack = folder.name(name);
    let prepare = ["prepare", "video", clip, "--fast", "--out", &pack];
    done(&[&prepare[..], options].concat());
    pack
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no {key} in {value}"))
}

/// The rows of a curve, in the order of the result.
fn curve<'a>(report: &'a Value, name: &str) -> Vec<&'a Value> {
    let rows = report["rows"].as_array().unwrap();
    rows.iter().filter(|row| row["curve"] == name).collect()
}

/// Bytes of the start and of what follows.
fn fetched(row: &Value) -> f64 {
    number(&row["start"], "bytes") + number(row, "bytes")
}

/// Whether the files in a folder say what was printed.
fn is_written(report: &Value, out: &str) {
    for file in ["score-over-bytes.svg", "score-over-pixels.svg"] {
        let svg = std::fs::read_to_string(format!("{out}/{file}")).unwrap();
        assert_eq!(
            svg.matches("<polyline").count(),
            16,
            "8 curves and their keys"
        );
        assert!(!svg.contains("NaN"), "{svg}");
    }
    let table = std::fs::read_to_string(format!("{out}/policies.csv")).unwrap();
    assert_eq!(
        table.lines().count(),
        1 + report["rows"].as_array().unwrap().len()
    );
    let written = std::fs::read_to_string(format!("{out}/policies.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&written).unwrap(), *report);
}

/// Along every curve more is asked for, taken and seen.
fn more_takes_more(report: &Value) {
    let acuity = curve(report, "acuity by slope");
    assert_eq!(acuity.len(), 3);
    for pair in acuity.windows(2) {
        assert!(
            number(pair[1], "jod") > number(pair[0], "jod") - 0.02,
            "{report}"
        );
        assert!(
            number(pair[1], "bytes") > number(pair[0], "bytes"),
            "{report}"
        );
    }
    for name in ["acuity", "uniform", "eccentricity", "perceptual"] {
        let rows = curve(report, &format!("{name} by target"));
        assert_eq!(number(rows[0], "target"), 8.5);
        assert!(
            number(rows[1], "jod") > number(rows[0], "jod") - 0.02,
            "{report}"
        );
    }
    for name in ["uniform", "eccentricity", "perceptual"] {
        let rows = curve(report, &format!("{name} by rate"));
        assert!(
            number(rows[1], "bytes") > number(rows[0], "bytes"),
            "{report}"
        );
    }
}

#[test]
fn every_policy_is_told_with_its_score_and_what_it_takes() {
    let folder = Folder::new();
    let clip = clip(&folder, "clip.mkv", &GeneratedScene::wide([480, 270]), 8);
    let pack = pack(&folder, "clip.foveal", &clip, &["--projection", "flat"]);
    let out = folder.name("out");
    let report = json(&[
        "evaluate",
        "policies",
        &pack,
        "--source",
        &clip,
        "--slopes",
        "0.044,0.011,0.003",
        "--rates",
        "0.1,0.5",
        "--targets",
        "8.5,9.5",
        "--out",
        &out,
    ]);
    agrees("evaluate policies", &[&report]);
    assert_eq!(
        (number(&report, "start_frames"), number(&report, "frames")),
        (5.0, 3.0)
    );
    let full = curve(&report, "full")[0];
    assert_eq!(number(full, "jod"), 10.0);
    assert!(number(full, "pixels_share_mean") >= 1.0 && full["fw_psnr"].is_null());
    for row in report["rows"].as_array().unwrap() {
        assert!(
            number(row, "jod") <= 10.0 && number(row, "jod_source") < 10.0,
            "{row}"
        );
        assert!(
            number(row, "jod_source") < number(full, "jod_source") + 0.02,
            "{row}"
        );
        // Steps on the way up are fetched too.
        assert!(fetched(row) < 1.5 * fetched(full), "{row}");
        let over = number(row, "bytes_over_original") / number(full, "bytes_over_original");
        assert!(
            (over - number(row, "bytes") / number(full, "bytes")).abs() < 1e-9,
            "{row}"
        );
        assert_eq!(row["content"], "clip.mkv");
        assert_eq!(row["display"], "desk");
    }
    more_takes_more(&report);
    assert!(curve(&report, "grid").is_empty() && !curve(&report, "acuity watson").is_empty());
    is_written(&report, &out);
}

#[test]
fn a_sphere_is_compared_with_the_grid_and_with_a_source_that_says_not_what_it_is() {
    let folder = Folder::new();
    let clip = clip(
        &folder,
        "clip.mkv",
        &GeneratedScene::panorama([256, 128]),
        4,
    );
    let whole = ["--projection", "equirect"];
    let pack = pack(
        &folder,
        "clip.foveal",
        &clip,
        &[&whole[..], &["--frames", "3"]].concat(),
    );
    let compare = [
        "evaluate",
        "policies",
        &pack,
        "--view",
        "96x60",
        "--fov",
        "40",
        "--gaze",
        "scan",
        "--slopes",
        "0.022",
        "--rates",
        "1",
        "--targets",
        "9",
        "--out",
        &folder.name("out"),
    ];
    let display = ["--display", "standard_hmd", "--source", &clip];
    let report = json(&[&compare[..], &display].concat());
    let grid = curve(&report, "grid")[0];
    assert!(number(grid, "pixels_share_mean") < 1.0, "{grid}");
    assert_eq!(grid["display"], "standard_hmd");
    assert!(number(curve(&report, "full")[0], "jod_source") > 5.0);
    assert_eq!(
        (number(&report, "start_frames"), number(&report, "frames")),
        (3.0, 3.0)
    );
    let text = done(&compare).stdout;
    for word in [
        "grid",
        "acuity by slope 0.022",
        "perceptual by rate 1 Mbit/s",
        "at equal score",
    ] {
        assert!(text.contains(word), "no {word} in {text}");
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = Folder::new();
    let [a, b, long] = [
        ([64, 48], "a.mkv", 3),
        ([96, 48], "b.mkv", 3),
        ([64, 48], "long.mkv", 9),
    ]
    .map(|(size, name, frames)| clip(&folder, name, &GeneratedScene::wide(size), frames));
    let pack = pack(&folder, "a.foveal", &a, &[]);
    let out = folder.name("out");
    let compare = ["evaluate", "policies", &pack, "--out", &out];
    for (options, words) in [
        (["--slopes", "0.02,1.5"], &["--slopes", "1.5", "0 to 1"][..]),
        (["--slopes", "-0.1"], &["--slopes", "-0.1"]),
        (["--slopes", "nan"], &["--slopes", "NaN"]),
        (["--slopes", "steep"], &["--slopes", "steep"]),
        (["--rates", "0"], &["--rates", "0.001 to 100000"]),
        (["--rates", "2,-1"], &["--rates", "-1"]),
        (["--rates", "inf"], &["--rates", "inf"]),
        (["--targets", "9,10"], &["--targets", "10", "1 to 9.99"]),
        (["--targets", "nan"], &["--targets", "NaN"]),
        (["--targets", "good"], &["--targets", "good"]),
        (["--frames", "0"], &["--frames", "1 to 10000"]),
        (
            ["--gaze", "udp:5005"],
            &["--gaze", "udp:127.0.0.1:5005", "scan"],
        ),
        (
            ["--display", "wall"],
            &["--display", "wall", "standard_hmd"],
        ),
        (
            ["--source", &b],
            &["--source", "b.mkv", "96x48", "a.foveal", "64x48"],
        ),
        (
            ["--source", &long],
            &["--source", "long.mkv", "9 frames", "a.foveal", "3 frames"],
        ),
    ] {
        refused(2, &[&compare[..], &options].concat(), words);
    }
    refused(2, &["evaluate", "policies", &pack], &["--out"]);
    refused(
        1,
        &[
            "evaluate",
            "policies",
            &folder.name("no.foveal"),
            "--out",
            &out,
        ],
        &["no.foveal"],
    );
}
