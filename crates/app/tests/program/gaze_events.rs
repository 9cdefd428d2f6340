//! Does the program say what eyes do, how well it knows, and what is wrong with a file?

use crate::support::{Folder, done, json, refused};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;

fn keys(value: &Value) -> BTreeSet<&str> {
    let object = value.as_object().unwrap();
    object.keys().map(String::as_str).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

const SCORE: [&str; 5] = [
    "event_f1",
    "false_events_per_minute",
    "kappa",
    "onset_lag_ms_median",
    "onset_lag_ms_p90",
];

const SCREEN: [&str; 2] = ["--screen", "0.38x0.30m,1024x768,0.67m"];

#[test]
fn saccades_are_found_early_and_better_than_by_one_threshold() {
    let found = json(&["gaze", "eval", "saccade"]);
    let rules = ["baseline_180", "baseline_engbert_kliegl", "baseline_ivt_30"];
    let rest = rules.into_iter().chain(["by_file"]);
    assert_eq!(keys(&found), SCORE.into_iter().chain(rest).collect());
    for rule in rules {
        assert_eq!(keys(&found[rule]), SCORE.into());
    }
    assert!(number(&found["event_f1"]) >= 0.88, "{found}");
    assert!(number(&found["onset_lag_ms_median"]) <= 8.0, "{found}");
    for better in ["event_f1", "kappa"] {
        let baseline = number(&found["baseline_180"][better]);
        assert!(baseline < number(&found[better]), "{better}: {found}");
    }
    for published in ["baseline_engbert_kliegl", "baseline_ivt_30"] {
        let f1 = number(&found[published]["event_f1"]);
        assert!(f1 > number(&found["baseline_180"]["event_f1"]), "{found}");
        assert!(f1 < number(&found["event_f1"]), "{found}");
    }
    let files = found["by_file"].as_array().unwrap();
    assert!(files.len() > 1);
    for file in files {
        assert!(keys(file).is_superset(&SCORE.into()), "{file}");
        assert!(number(&file["event_f1"]) >= 0.88, "{file}");
        assert!(file["file"].as_str().unwrap().starts_with("synthetic"));
    }
}

#[test]
fn outputs_never_replace_what_is_read() {
    let folder = Folder::new();
    let mut trace = "t_s,yaw_deg,pitch_deg,head_yaw_deg,head_pitch_deg\n".to_owned();
    for k in 0..1500 {
        let _ = writeln!(trace, "{},{},0,{},0", f64::from(k) * 0.01, k % 7, k % 5);
    }
    let file = folder.holding("mine.csv", trace.as_bytes());
    let gaze = format!("trace:{file}");
    for arguments in [
        &["gaze", "classify", &file, "--out", &file][..],
        &["gaze", "fit", "head", "--data", &file, "--out", &file],
        &["gaze", "eval", "delay", "--data", &file, "--plot", &file],
        &["gaze", "record", "--gaze", &gaze, "--out", &file],
    ] {
        refused(2, arguments, &["mine.csv", "is what is read"]);
        assert_eq!(
            std::fs::read(&file).unwrap(),
            trace.as_bytes(),
            "{arguments:?}"
        );
    }
}

#[test]
fn a_recording_is_refused_before_it_begins_where_it_could_not_be_kept() {
    let folder = Folder::new();
    let gaze = ["--gaze", "udp:0", "--seconds", "1"];
    let record = |out: &str, words: &[&str]| {
        refused(
            1,
            &[&["gaze", "record", "--out", out][..], &gaze].concat(),
            words,
        );
    };
    record(&folder.name("."), &["is not a plain file"]);
    record(&folder.name("none/mine.csv"), &["its folder is not there"]);
    let kept = folder.holding("mine.csv.partial", b"t_s,yaw_deg,pitch_deg\n0,1,2\n");
    record(
        &folder.name("mine.csv"),
        &["mine.csv.partial", "interrupted"],
    );
    assert!(std::fs::read(kept).unwrap().ends_with(b"0,1,2\n"));
}

#[test]
fn landings_and_filter_are_judged_in_the_fields_that_are_compared() {
    let landing = json(&["gaze", "eval", "landing"]);
    assert_eq!(keys(&landing), ["after_ms"].into());
    let after = landing["after_ms"].as_array().unwrap();
    for score in after {
        assert_eq!(keys(score), ["current_deg", "ms", "predicted_deg"].into());
        if number(&score["ms"]) >= 20.0 {
            assert!(number(&score["predicted_deg"]) < number(&score["current_deg"]));
        }
    }
    let ms: Vec<f64> = after.iter().map(|score| number(&score["ms"])).collect();
    assert!(
        ms.contains(&20.0) && ms.contains(&30.0) && ms.is_sorted(),
        "{ms:?}"
    );
    let filter = json(&["gaze", "eval", "filter"]);
    assert_eq!(keys(&filter), ["conforms", "extra_lag_samples"].into());
    assert_eq!(filter["conforms"], true);
    assert!(number(&filter["extra_lag_samples"]) <= 1.0, "{filter}");
}

/// Yaw in degrees at a millisecond: a saccade of 10 degrees in 50 ms, every half second.
pub(crate) fn yaw(ms: u32) -> f64 {
    let (jump, within) = (ms / 500, f64::from(ms % 500));
    let share = (within / 50.0).min(1.0);
    let way = 10.0 * share * share * (3.0 - 2.0 * share);
    if jump % 2 == 0 { way } else { 10.0 - way }
}

#[test]
fn every_row_of_a_trace_is_labelled_once() {
    let folder = Folder::new();
    let mut trace = "t_s,yaw_deg,pitch_deg,valid\n".to_owned();
    let rows = 2500;
    for row in 0..rows {
        let ms = 2 * row;
        let valid = u8::from(!(900..960).contains(&row) && !(1200..2000).contains(&row));
        let _ = writeln!(trace, "{},{},0,{valid}", f64::from(ms) / 1e3, yaw(ms));
    }
    let (path, out) = (
        folder.holding("a.csv", trace.as_bytes()),
        folder.name("out.csv"),
    );
    let counts = json(&["gaze", "classify", &path, "--out", &out]);
    let names = ["fixation", "saccade", "blink", "lost"];
    let table = std::fs::read_to_string(&out).unwrap();
    let labels: Vec<(f64, &str)> = table
        .lines()
        .skip(1)
        .map(|line| {
            let (time, event) = line.split_once(',').unwrap();
            (time.parse().unwrap(), event)
        })
        .collect();
    assert_eq!(table.lines().next(), Some("t_s,event"));
    assert_eq!(labels.len() as u32, rows);
    for (row, (time, _)) in (0..rows).zip(&labels) {
        assert_eq!(*time, f64::from(2 * row) / 1e3);
    }
    for name in names {
        let count = labels.iter().filter(|(_, event)| *event == name).count();
        assert!(count > 0, "no {name}: {counts}");
        assert_eq!(counts[name], count, "{name}");
    }
    let sum: f64 = names.iter().map(|name| number(&counts[*name])).sum();
    assert_eq!(sum, number(&counts["samples"]));
    assert_eq!(counts["samples"], rows);
    // Ten jumps, of which the gaps hide four, and the first has nothing before it.
    assert!(
        (4..=8).contains(&(number(&counts["saccades"]) as u32)),
        "{counts}"
    );
    let text = done(&["gaze", "classify", &path]).stdout;
    assert!(
        text.contains("fixation") && text.contains("2500 samples"),
        "{text}"
    );
    // Labels are causal: a trace cut short has the labels of the whole.
    let part: String = trace
        .lines()
        .take(701)
        .map(|line| format!("{line}\n"))
        .collect();
    let part = folder.holding("part.csv", part.as_bytes());
    done(&[
        "gaze",
        "classify",
        &part,
        "--out",
        &folder.name("part-out.csv"),
    ]);
    let again = std::fs::read_to_string(folder.name("part-out.csv")).unwrap();
    assert!(again.lines().count() == 701 && table.starts_with(&again));
}

/// Pixels of a recording of saccades; the coder `blind` saw none of them.
fn two_coders() -> String {
    let mut text = "trial,fs_hz,i,x_px,y_px,coder_AB,coder_blind\n".to_owned();
    for i in 0..5000u32 {
        let angle = (yaw(2 * i) - 5.0).to_radians();
        let x = 512.0 + angle.tan() * 0.67 / 0.38 * 1024.0;
        let label = if 2 * i % 500 < 50 { 2 } else { 1 };
        let _ = writeln!(text, "a,500,{i},{x:.3},384,{label},1");
    }
    text
}

#[test]
fn labelled_files_are_judged_by_each_coder_and_their_mean() {
    let folder = Folder::new();
    let path = folder.holding("coded.csv", two_coders().as_bytes());
    let judge = ["gaze", "eval", "saccade", "--data", &path];
    let found = json(&[&judge[..], &SCREEN].concat());
    let file = &found["by_file"][0];
    assert_eq!(file["file"], path.as_str());
    let coders = file["by_coder"].as_array().unwrap();
    assert_eq!([&coders[0]["coder"], &coders[1]["coder"]], ["AB", "blind"]);
    let [seeing, blind] = [0, 1].map(|k| number(&coders[k]["event_f1"]));
    assert!(seeing > 0.9 && blind == 0.0, "{found}");
    assert_eq!(number(&file["event_f1"]), (seeing + blind) / 2.0);
    assert_eq!(found["event_f1"], file["event_f1"]);
    let text = done(&[&judge[..], &SCREEN].concat()).stdout;
    assert!(
        text.contains("coder AB") && text.contains("coder blind"),
        "{text}"
    );
    refused(1, &judge, &["coded.csv", "line 1", "--screen"]);
    // Classifying reads the same file without its labels.
    let counts = json(&[&["gaze", "classify", &path], &SCREEN[..]].concat());
    assert_eq!(counts["samples"], 5000);
    // The first begins with the recording: nothing is known before it.
    assert!((19..=20).contains(&(number(&counts["saccades"]) as u32)));
}

#[test]
fn what_is_no_recording_is_refused_with_file_line_and_column() {
    let folder = Folder::new();
    let degrees = "x_deg,y_deg,valid,event\n";
    let pixels = "trial,fs_hz,i,x_px,y_px,coder_A\n";
    let cases: [(&str, String, &[&str]); 10] = [
        ("empty", String::new(), &["line 1", "x_deg"]),
        ("header", degrees.to_owned(), &["no rows"]),
        (
            "columns",
            "x_deg,y_deg,event\n0,0,1\n".to_owned(),
            &["line 1", "lacks valid"],
        ),
        (
            "coder",
            "trial,fs_hz,i,x_px,y_px\na,500,0,1,1\n".to_owned(),
            &["coder_NAME"],
        ),
        (
            "nan",
            format!("{degrees}0,0,1,1\n0,NaN,1,1\n"),
            &["line 3", "column y_deg", "NaN"],
        ),
        (
            "label",
            format!("{degrees}0,0,1,9\n"),
            &["line 2", "column event", "9"],
        ),
        (
            "backwards",
            format!("{pixels}a,500,4,1,1,1\na,500,3,1,1,1\n"),
            &["line 3", "column i", "time must grow"],
        ),
        (
            "duplicate",
            format!("{pixels}a,500,4,1,1,1\na,500,4,1,1,1\n"),
            &["line 3", "column i", "time must grow"],
        ),
        (
            "rate",
            format!("{pixels}a,500,4,1,1,1\na,250,5,1,1,1\n"),
            &["line 3", "column fs_hz", "250"],
        ),
        (
            "huge",
            format!("{degrees}{}", "7".repeat(4 << 20)),
            &["line 2", "longer than"],
        ),
    ];
    for (name, text, words) in &cases {
        let name = format!("{name}.csv");
        let path = folder.holding(&name, text.as_bytes());
        let words = [&[name.as_str()], *words].concat();
        for protocol in ["saccade", "landing", "filter"] {
            let judge = ["gaze", "eval", protocol, "--data", &path];
            refused(1, &[&judge[..], &SCREEN].concat(), &words);
        }
    }
    let there = folder.name("none.csv");
    let there = ["gaze", "eval", "saccade", "--data", &there];
    refused(1, &there, &["none.csv"]);
    let folder_name = folder.to_str().unwrap();
    refused(
        1,
        &["gaze", "eval", "saccade", "--data", folder_name],
        &["CSV"],
    );
}

#[test]
fn what_is_no_trace_is_refused_with_file_line_and_column() {
    let folder = Folder::new();
    let header = "t_s,yaw_deg,pitch_deg\n";
    let cases: [(&str, String, &[&str]); 7] = [
        ("empty", String::new(), &["t_s"]),
        (
            "columns",
            "t_s,yaw_deg\n0,1\n".to_owned(),
            &["line 1", "pitch_deg"],
        ),
        (
            "nan",
            format!("{header}0,1,2\n0.1,nan,2\n"),
            &["line 3", "yaw_deg"],
        ),
        (
            "backwards",
            format!("{header}1,1,2\n0.5,1,2\n"),
            &["line 3", "t_s"],
        ),
        (
            "duplicate",
            format!("{header}1,1,2\n1,1,2\n"),
            &["line 3", "t_s"],
        ),
        ("short", format!("{header}1,1\n"), &["line 2", "pitch_deg"]),
        (
            "huge",
            format!("{header}{}", "7".repeat(4 << 20)),
            &["line 2"],
        ),
    ];
    for (name, text, words) in &cases {
        let name = format!("{name}.csv");
        let path = folder.holding(&name, text.as_bytes());
        let words = [&[name.as_str()], *words].concat();
        let ran = refused(1, &["gaze", "classify", &path], &words);
        assert!(
            ran.stderr.len() < 1000,
            "{} bytes of message",
            ran.stderr.len()
        );
    }
    refused(
        1,
        &["gaze", "classify", &folder.name("none.csv")],
        &["none.csv"],
    );
}

#[test]
fn commands_and_options_that_are_not_there_are_wrong_usage() {
    for wrong in [
        &["gaze"][..],
        &["gaze", "eval"],
        &["gaze", "eval", "blinks"],
        &["gaze", "eval", "saccade", "--threshold", "3"],
        &["gaze", "eval", "saccade", "--data"],
        &["gaze", "eval", "landing", "--screen", "1024x768"],
        &["gaze", "eval", "filter", "--preset", "search"],
        &["gaze", "fit", "saccade"],
        &["gaze", "classify"],
        &["gaze", "classify", "a.csv", "--data", "b.csv"],
        &["perception", "table", "--meridian", "north"],
    ] {
        refused(2, wrong, &[]);
    }
}
