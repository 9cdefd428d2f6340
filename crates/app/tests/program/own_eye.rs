//! Does a measured model of the eye take the place of ours, also in a log?

use crate::scenes::{noisy_clip, write_clip};
use crate::support::{Folder, done, json, refused};
use serde_json::Value;

const ACUITY: &str = "ecc_deg,mar_arcmin\n0,1\n5,6\n40,60\n";
/// An eye that resolves far less than the usual one.
const COARSE: &str = "ecc_deg,mar_arcmin\n0,6\n5,60\n40,300\n";
const SENSITIVITY: &str = "cpd,ecc_deg,sensitivity\n0.5,0,40\n4,0,60\n30,0,1\n0.5,20,10\n4,20,2\n\
                           30,20,0\n";

const SELECT: [&str; 7] = [
    "select",
    "--projection",
    "cube",
    "--face-size",
    "2048",
    "--target",
    "none",
];
const TABLE: [&str; 6] = [
    "perception",
    "table",
    "--ecc",
    "0,5,22.5",
    "--cpd",
    "0.5,4,31",
];

/// The first line of a log.
fn head(log: &str) -> Value {
    let text = std::fs::read_to_string(log).unwrap();
    serde_json::from_str(text.lines().next().unwrap()).unwrap()
}

#[test]
fn what_was_measured_chooses_and_a_replay_needs_no_file() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([512, 256], 2));
    let pack = folder.name("a.foveal");
    let cut = ["--projection", "equirect", "--tile", "32", "--levels", "4"];
    done(
        &[
            &["prepare", "video", &clip, "--out", &pack, "--fast"],
            &cut[..],
        ]
        .concat(),
    );
    let acuity = folder.holding("acuity.csv", ACUITY.as_bytes());
    let coarse = folder.holding("coarse.csv", COARSE.as_bytes());
    let sensitivity = folder.holding("csf.csv", SENSITIVITY.as_bytes());
    let run = |name: &str, options: &[&str]| {
        let out = folder.name(name);
        let common = [
            "simulate",
            &pack,
            "--out",
            &out,
            "--pictures",
            "none",
            "--renderer",
            "none",
        ];
        let found = json(&[&common[..], &["--gaze", "20,0"], options].concat());
        let share = found["pixels_share_mean"].as_f64().unwrap();
        (share, format!("{out}/session.jsonl"))
    };
    let (usual, _) = run("usual", &["--policy", "acuity", "--target", "none"]);
    let (coarser, by_acuity) = run("acuity", &["--policy", "acuity", "--acuity", &coarse]);
    assert!(
        coarser < usual,
        "an eye that resolves less takes less: {coarser} {usual}"
    );
    let link = [
        "--policy",
        "perceptual",
        "--link",
        "1mbit",
        "--target",
        "none",
    ];
    let (_, plain) = run("plain", &link);
    let own = ["--acuity", &acuity, "--sensitivity", &sensitivity];
    let (_, by_both) = run("both", &[&link[..], &own].concat());
    let measured = serde_json::json!([[0.0, 1.0 / 60.0], [5.0, 0.1], [40.0, 1.0]]);
    let table = serde_json::json!([[0.0, 0.1], [5.0, 1.0], [40.0, 5.0]]);
    assert_eq!(head(&by_acuity)["policy"]["acuity"]["table"], table);
    let perception = head(&by_both)["policy"]["perception"].clone();
    assert_eq!(perception["acuity"], measured);
    assert_eq!(
        perception["sensitivity"][0],
        serde_json::json!([0.5, 0.0, 40.0])
    );
    assert_eq!(perception["sensitivity"].as_array().unwrap().len(), 6);
    assert!(head(&plain)["policy"]["perception"]["acuity"].is_null());
    std::fs::remove_file(&acuity).unwrap();
    std::fs::remove_file(&coarse).unwrap();
    std::fs::remove_file(&sensitivity).unwrap();
    for log in [by_acuity, by_both, plain] {
        assert_eq!(
            json(&["replay", &log, "--pack", &pack])["same"],
            true,
            "{log}"
        );
    }
}

#[test]
fn select_and_perception_take_it() {
    let folder = Folder::new();
    let acuity = folder.holding("acuity.csv", ACUITY.as_bytes());
    let sensitivity = folder.holding("csf.csv", SENSITIVITY.as_bytes());
    let pixels = |options: &[&str]| json(&[&SELECT[..], options].concat())["pixels"].as_u64();
    let coarse = folder.holding("coarse.csv", COARSE.as_bytes());
    assert!(pixels(&["--acuity", &coarse]) < pixels(&[]));
    let own = ["--acuity", &acuity, "--sensitivity", &sensitivity];
    let found = json(&[&TABLE[..], &own].concat());
    let row = |k: usize| found["acuity"][k]["e_cpd"].as_f64().unwrap();
    assert!(
        (row(0) - 30.0).abs() < 1e-9 && (row(1) - 5.0).abs() < 1e-9,
        "{found}"
    );
    assert_eq!(found["acuity"][0]["density_per_deg2"], Value::Null);
    let seen = |k: usize| found["csf"][k]["sensitivity"].as_f64().unwrap();
    assert_eq!([0, 1, 2].map(seen), [40.0, 60.0, 0.0]);
}

#[test]
fn what_is_wrong_with_a_measured_eye_is_named() {
    let folder = Folder::new();
    let acuity = folder.holding("acuity.csv", ACUITY.as_bytes());
    for (option, text, words) in [
        ("--acuity", "ecc_deg,mar_arcmin\n0,2\n5,1\n", "falls from"),
        (
            "--acuity",
            "ecc,mar\n0,2\n",
            "line 1: the header lacks ecc_deg",
        ),
        (
            "--sensitivity",
            "cpd,ecc_deg,sensitivity\n1,0,x\n",
            "line 2, column sensitivity",
        ),
        (
            "--sensitivity",
            "cpd,ecc_deg,sensitivity\n1,0,1\n2,5,1\n",
            "every frequency",
        ),
    ] {
        let bad = folder.holding("bad.csv", text.as_bytes());
        refused(
            1,
            &[&SELECT[..], &[option, &bad]].concat(),
            &["bad.csv", words],
        );
        refused(
            1,
            &[&TABLE[..], &[option, &bad]].concat(),
            &["bad.csv", words],
        );
    }
    refused(
        2,
        &[&SELECT[..], &["--acuity", "mine"]].concat(),
        &["--acuity", "watson-paper"],
    );
    refused(
        1,
        &[&SELECT[..], &["--acuity", "none.csv"]].concat(),
        &["none.csv"],
    );
    let slope = ["--acuity", &acuity, "--slope", "0.01"];
    refused(2, &[&SELECT[..], &slope].concat(), &["--slope"]);
}

#[test]
fn the_help_lists_every_constant_with_its_unit_and_its_range() {
    let help = done(&["simulate", "--help"]).stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for line in [
        "lambda: weight of popping against what is gained; 0 to 1000000 (default: 3)",
        "landed_ms: how long after a saccade changes stay hard to see; 0 to 1000000 ms",
        "luminance: luminance that the eye is adapted to; 0.000001 to 1000000 cd/m² \
         (default: 18; paper 100)",
        "saccade_field_deg: eccentricity that a place may have after a jump; 1 to 180 degrees",
    ] {
        assert!(help.contains(line), "{line}: {help}");
    }
    let wrong = [
        "select",
        "--projection",
        "cube",
        "--face-size",
        "64",
        "--set",
        "omega=0",
    ];
    refused(2, &wrong, &["omega is 0", "0.000001 to 1000000 thresholds"]);
}
