//! Do the commands about eyes and scores print what is documented?

use super::agrees;
use crate::scenes::{noise, write_clip};
use crate::support::{Folder, json};
use std::fmt::Write as _;

#[test]
fn what_the_eye_sees_is_told_of_as_documented() {
    let folder = Folder::new();
    agrees("perception table", &[&json(&["perception", "table"])]);
    let [before, after] = [0, 9].map(|add| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 32, 32);
        encoder.set_color(png::ColorType::Grayscale);
        let grey: Vec<u8> = (0..1024_u32)
            .map(|k| (k % 7 * 20 + k % 2 * add) as u8)
            .collect();
        encoder
            .write_header()
            .unwrap()
            .write_image_data(&grey)
            .unwrap();
        folder.holding(&format!("{add}.png"), &bytes)
    });
    let look = ["--gaze", "16,16", "--fov", "20", "--out"];
    let weigh = ["perception", "importance", &before, &after, "--updates"];
    let acuity = folder.holding("acuity.csv", b"ecc_deg,mar_arcmin\n0,1\n20,9\n");
    let csf = "cpd,ecc_deg,sensitivity\n1,0,50\n8,0,20\n";
    let csf = folder.holding("csf.csv", csf.as_bytes());
    let own = ["--acuity", &acuity, "--sensitivity", &csf];
    let out = folder.name("map.png");
    let weighed = json(&[&weigh[..], &look, &[&out]].concat());
    let by_own = json(&[&weigh[..], &own, &look, &[&out]].concat());
    assert_ne!(weighed["maps"][0]["mean"], by_own["maps"][0]["mean"]);
    agrees("perception importance", &[&weighed, &by_own]);
    let seen = json(
        &[
            &["perception", "bands", &before],
            &look[..],
            &[&folder.name("bands")],
        ]
        .concat(),
    );
    agrees("perception bands", &[&seen]);
}

#[test]
fn scores_are_told_of_as_documented() {
    let folder = Folder::new();
    let [reference, test] = ["a.mkv", "b.mkv"].map(|name| {
        let frames = [0, 1].map(|frame| noise([64, 48], frame + u32::from(name == "b.mkv")));
        write_clip(&folder, name, &frames)
    });
    let heat = folder.name("heat.png");
    let pair = [
        "score",
        &reference,
        &test,
        "--gaze",
        "32,24",
        "--display",
        "standard_fhd",
    ];
    let by_eye = json(&[&pair[..], &["--heat", &heat]].concat());
    let by_error = json(&[&pair[..], &["--metric", "psnr"]].concat());
    let displays = json(&["score", "--list-displays"]);
    let cited = json(&["score", "--cite"]);
    let table = folder.holding("pairs.csv", b"reference,test\na.mkv,b.mkv\n");
    let scores = folder.name("scores.csv");
    let many = ["--pairs", &table, "--display", "standard_fhd"];
    let many = json(&[&["score"][..], &many, &["--gaze", "1,1", "--out", &scores]].concat());
    agrees("score", &[&by_eye, &by_error, &displays, &cited, &many]);
    let goldens = [
        "evaluate",
        "goldens",
        "G9",
        "--write",
        &folder.name("goldens"),
    ];
    agrees("evaluate goldens", &[&json(&goldens)]);
    let few = [
        "--seeds",
        "1",
        "--frames",
        "1",
        "--targets",
        "8",
        "--slopes",
        "0.044,0.01",
    ];
    let targets = json(&[&["evaluate", "targets"][..], &few].concat());
    agrees("evaluate targets", &[&targets]);
}

/// Thirty seconds of a head that turns to and fro and eyes that are ahead of it.
fn recording() -> String {
    let mut text = "gaze_x,gaze_y,head_vel_x,head_vel_y,head_acc_x,head_acc_mean_x,\
                    head_acc_mean_y,head_vel_std_x,head_vel_std_y\n"
        .to_owned();
    for k in 0..3000 {
        let turn = (f64::from(k) / 40.0).sin() * 60.0;
        let _ = writeln!(text, "{:.2},1,{turn:.2},2,0,0,0,25,9", turn / 5.0);
    }
    text
}

#[test]
fn gaze_is_told_of_as_documented() {
    let folder = Folder::new();
    let heads = folder.holding("heads.csv", recording().as_bytes());
    let head = json(&["gaze", "eval", "head", "--data", &heads]);
    agrees("gaze eval head", &[&head]);
    let delay = json(&["gaze", "eval", "delay", "--data", &heads, "--delays", "50"]);
    agrees("gaze eval delay", &[&delay]);
    let preset = folder.name("mine.toml");
    let fitted = json(&["gaze", "fit", "head", "--data", &heads, "--out", &preset]);
    agrees("gaze fit head", &[&fitted]);

    let mut labelled = "x_deg,y_deg,valid,event\n".to_owned();
    for ms in 0..2000 {
        // A saccade of 10 degrees in 40 ms, every half second.
        let (turn, within) = (ms / 500, ms % 500);
        let way = f64::from(within.min(40)) / 40.0;
        let along = if turn % 2 == 0 { way } else { 1.0 - way };
        let event = if within < 40 { 2 } else { 1 };
        let _ = writeln!(labelled, "{:.3},0,1,{event}", along * 10.0);
    }
    let eyes = folder.holding("eyes.csv", labelled.as_bytes());
    let judged = |what| json(&["gaze", "eval", what, "--data", &eyes]);
    agrees("gaze eval saccade", &[&judged("saccade")]);
    agrees("gaze eval landing", &[&judged("landing")]);
    agrees("gaze eval filter", &[&judged("filter")]);

    let trace = folder.name("scan.csv");
    let record = [
        "gaze",
        "record",
        "--gaze",
        "scan",
        "--seconds",
        "1",
        "--out",
    ];
    agrees("gaze record", &[&json(&[&record[..], &[&trace]].concat())]);
    agrees("gaze classify", &[&json(&["gaze", "classify", &trace])]);
}
