//! Does the program judge, blend and fit gaze from head motion on a user's own recordings?

use crate::support::{Folder, done, json, refused};
use foveal_core::gaze::head_prediction::HeadMotion;
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::view::random::Random;
use std::fmt::Write as _;

const HEADER: &str = "gaze_x,gaze_y,head_vel_x,head_vel_y,head_acc_x,head_acc_mean_x,\
                      head_acc_mean_y,head_vel_std_x,head_vel_std_y\n";

/// Forty seconds of a viewer who follows `law`, with eyes that jump about it every 300 ms.
pub(crate) fn recording(law: &HeadGazePreset, seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut velocity = [0.0; 2];
    let mut aside = [0.0; 2];
    let mut text = HEADER.to_owned();
    for k in 0..4000 {
        if k % 50 == 0 {
            velocity = [60.0, 20.0].map(|fast| fast * (2.0 * random.unit() - 1.0));
        }
        if k % 30 == 0 {
            aside = [0, 1].map(|_| 10.0 * (random.unit() - random.unit()));
        }
        let motion = HeadMotion {
            velocity_deg_s: velocity,
            ..HeadMotion::default()
        };
        let gaze = law.predict(&motion).degrees();
        let _ = writeln!(
            text,
            "{:.2},{:.2},{:.2},{:.2},0,0,0,25,9",
            gaze[0] + aside[0],
            gaze[1] + aside[1],
            velocity[0],
            velocity[1]
        );
    }
    text
}

fn recordings(folder: &Folder, law: &HeadGazePreset) -> [String; 3] {
    [1, 2, 3].map(|seed| {
        let name = format!("viewer{seed}.csv");
        folder.holding(&name, recording(law, seed).as_bytes())
    })
}

#[test]
fn predictors_are_judged_in_one_table_and_one_object() {
    let folder = Folder::new();
    let [a, b, c] = recordings(&folder, &HeadGazePreset::free_viewing());
    let judge = ["gaze", "eval", "head", "--data", &a, &b, &c];
    let found = json(&judge);
    let of = |name: &str, what: &str| found["predictors"][name][what].as_f64().unwrap();
    for name in ["centre", "mean", "sgaze", "lu-2020", "foveal"] {
        let [median, p90, p95] = ["median_deg", "p90_deg", "p95_deg"].map(|what| of(name, what));
        assert!(0.0 < median && median < p90 && p90 < p95, "{name}: {found}");
        let within = [
            "within_5_deg_share",
            "within_10_deg_share",
            "within_15_deg_share",
        ]
        .map(|what| of(name, what));
        assert!(
            0.0 < within[0] && within[0] < within[1] && within[2] <= 1.0,
            "{found}"
        );
    }
    assert!(
        of("foveal", "mean_deg") < 0.92 * of("sgaze", "mean_deg"),
        "{found}"
    );
    assert!(
        of("sgaze", "mean_deg") < of("centre", "mean_deg"),
        "{found}"
    );
    assert_eq!(found["recordings"][2]["file"], c);
    assert!(found["recordings"][0]["sgaze"].as_f64() > found["recordings"][0]["foveal"].as_f64());
    let text = done(&judge).stdout;
    assert!(
        text.contains("lu-2020") && text.contains("viewer3.csv"),
        "{text}"
    );
    let left_out = json(&[&judge[..], &["--leave-one-out"]].concat());
    assert_eq!(
        left_out["predictors"]["sgaze"],
        found["predictors"]["sgaze"]
    );
    assert_ne!(
        left_out["predictors"]["foveal"],
        found["predictors"]["foveal"]
    );
}

#[test]
fn a_preset_fitted_on_a_viewer_predicts_that_viewer_better() {
    let folder = Folder::new();
    let mut law = HeadGazePreset::search();
    law.yaw.offset_deg = -4.0;
    let [a, b, c] = recordings(&folder, &law);
    let preset = folder.name("mine.toml");
    let fitted = json(&["gaze", "fit", "head", "--data", &a, &b, "--out", &preset]);
    let offset = fitted["preset"]["yaw"]["offset_deg"].as_f64().unwrap();
    assert!((offset + 4.0).abs() < 1.0, "{fitted}");
    let mean_deg = |preset: &str| {
        let found = json(&["gaze", "eval", "head", "--data", &c, "--preset", preset]);
        found["predictors"]["foveal"]["mean_deg"].as_f64().unwrap()
    };
    let [mine, free, search] = [&preset, "free-viewing", "search"].map(mean_deg);
    assert!(mine < search && search < free, "{mine} {search} {free}");
}

#[test]
fn a_late_gaze_is_judged_beside_the_head_and_their_blend() {
    let folder = Folder::new();
    let [a, b, _] = recordings(&folder, &HeadGazePreset::free_viewing());
    let judge = [
        "gaze", "eval", "delay", "--data", &a, &b, "--delays", "20,500",
    ];
    let found = json(&judge);
    let of = |k: usize, what: &str| found["delays"][k][what].as_f64().unwrap();
    assert_eq!((of(0, "delay_ms"), of(1, "delay_ms")), (20.0, 500.0));
    assert!(
        of(0, "last_mean_deg") < of(0, "head_mean_deg")
            && of(0, "blend_mean_deg") == of(0, "last_mean_deg"),
        "{found}"
    );
    assert!(of(1, "blend_mean_deg") < of(1, "last_mean_deg"), "{found}");
    assert!(done(&judge).stdout.contains("blend"));
    let plot = folder.name("delay.svg");
    done(&[&judge[..], &["--plot", &plot]].concat());
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(svg.starts_with("<svg xmlns") && svg.trim_end().ends_with("</svg>"));
    assert_eq!(svg.matches("<polyline").count(), 3);
}

#[test]
fn what_is_no_recording_or_no_preset_is_refused_by_its_place() {
    let folder = Folder::new();
    let [good, ..] = recordings(&folder, &HeadGazePreset::free_viewing());
    let refuse = |name: &str, text: &str, words: &[&str]| {
        let file = folder.holding(name, text.as_bytes());
        let words = [words, &[name]].concat();
        refused(1, &["gaze", "eval", "head", "--data", &good, &file], &words);
    };
    refuse("empty.csv", "", &["line 1", "gaze_x"]);
    refuse(
        "short.csv",
        "gaze_x,gaze_y\n1,2\n",
        &["line 1", "lacks head_vel_x"],
    );
    refuse(
        "nan.csv",
        &format!("{HEADER}1,2,NaN,4,5,6,7,8,9\n"),
        &["line 2", "head_vel_x", "NaN"],
    );
    refuse("long.csv", &"9".repeat(3 << 20), &["line 1", "longer than"]);
    let preset = |text: &str, words: &[&str]| {
        let file = folder.holding("bad.toml", text.as_bytes());
        refused(
            1,
            &["gaze", "eval", "head", "--data", &good, "--preset", &file],
            words,
        );
    };
    preset("name = 7", &["bad.toml", "line 1"]);
    let mut steep = HeadGazePreset::search();
    steep.pitch.scale_deg_s = -3.0;
    preset(
        &toml_of(&steep),
        &["bad.toml", "pitch.scale_deg_s is -3", "0.3 to 100"],
    );
    let evaluate = ["gaze", "eval", "head", "--data", &good];
    refused(
        2,
        &[&evaluate[..], &["--preset", "reading"]].concat(),
        &["reading", "free-viewing"],
    );
    refused(
        2,
        &[&evaluate[..], &["--leave-one-out"]].concat(),
        &["--leave-one-out", "two"],
    );
    let delays = ["gaze", "eval", "delay", "--data", &good, "--delays", "55"];
    refused(2, &delays, &["--delays is 55", "multiples of 10"]);
}

fn toml_of(preset: &HeadGazePreset) -> String {
    let axis = |name: &str, [gain, scale, linear, offset, lead]: [f64; 5]| {
        format!(
            "[{name}]\ngain_deg = {gain:?}\nscale_deg_s = {scale:?}\nlinear_deg = {linear:?}\n\
             offset_deg = {offset:?}\nlead_s = {lead:?}\n"
        )
    };
    format!(
        "name = \"mine\"\nspread_deg = 7.0\n{}{}",
        axis("yaw", preset.yaw.parameters()),
        axis("pitch", preset.pitch.parameters())
    )
}

#[test]
fn a_recording_that_is_judged_also_plays_and_is_converted_to_a_trace() {
    let folder = Folder::new();
    let [recording, ..] = recordings(&folder, &HeadGazePreset::free_viewing());
    let trace = folder.name("trace.csv");
    let gaze = format!("head:{recording}");
    let select = [
        "select",
        "--projection",
        "cube",
        "--face-size",
        "512",
        "--gaze",
        &gaze,
    ];
    assert!(json(&select)["pixels"].as_u64().unwrap() > 0);
    let eyes = format!("trace:{recording}");
    json(&["gaze", "record", "--gaze", &eyes, "--out", &trace]);
    // Where the head is set level again, a few rows are left out.
    let samples = json(&["gaze", "classify", &recording])["samples"].as_u64();
    assert!(samples.is_some_and(|count| (3800..=4000).contains(&count)));
    // What is converted is judged as what it was made from.
    let mean_deg = |file: &str| {
        let found = json(&["gaze", "eval", "head", "--data", file]);
        found["predictors"]["foveal"]["mean_deg"].as_f64().unwrap()
    };
    let [of_recording, of_trace] = [&recording, &trace].map(|file| mean_deg(file));
    assert!(
        (of_recording - of_trace).abs() < 0.5,
        "{of_recording} {of_trace}"
    );
}

#[test]
fn the_table_of_a_tracker_is_read_by_the_names_of_its_columns() {
    let folder = Folder::new();
    let table = "Recording timestamp\tGaze X\tGaze Y\n1000\t960\t540\n1010\t1440\t540\n1020\t\t\n";
    let table = folder.holding("tobii.tsv", table.as_bytes());
    let (gaze, out) = (format!("trace:{table}"), folder.name("trace.csv"));
    let columns = ["--gaze-columns", "Recording timestamp:ms,Gaze X,Gaze Y"];
    let screen = ["--gaze-screen", "0.52x0.29m,1920x1080,0.6m"];
    let record = ["gaze", "record", "--gaze", &gaze, "--out", &out];
    let made = json(&[&record[..], &columns, &screen].concat());
    assert_eq!(
        (&made["samples"], &made["valid"]),
        (&3.into(), &2.into()),
        "{made}"
    );
    let trace = std::fs::read_to_string(&out).unwrap();
    let second: Vec<&str> = trace.lines().nth(2).unwrap().split(',').collect();
    let yaw = (0.13_f64 / 0.6).atan().to_degrees();
    assert!(
        (second[0].parse::<f64>().unwrap() - 0.01).abs() < 1e-9,
        "{trace}"
    );
    assert!(
        (second[2].parse::<f64>().unwrap() - yaw).abs() < 1e-9,
        "{trace}"
    );
    let select = [
        "select",
        "--projection",
        "flat",
        "--size",
        "960x540",
        "--gaze",
        &gaze,
    ];
    let direct = json(&[&select[..], &columns, &screen].concat());
    let through = format!("trace:{out}");
    let select = [
        "select",
        "--projection",
        "flat",
        "--size",
        "960x540",
        "--gaze",
        &through,
    ];
    assert_eq!(direct, json(&select));
    refused(2, &[&record[..], &columns].concat(), &["--gaze-screen"]);
    let scan = [
        "select",
        "--projection",
        "cube",
        "--face-size",
        "512",
        "--gaze",
        "scan",
    ];
    refused(
        2,
        &[&scan[..], &columns, &screen].concat(),
        &["--gaze-columns", "trace:FILE"],
    );
    let missing = ["--gaze-columns", "t,x,y"];
    refused(
        1,
        &[&record[..], &missing, &screen].concat(),
        &["tobii.tsv", "names t, x, y"],
    );
}
