//! Does `foveal score` take every gaze and every display that it should, and does its help say so?

use crate::score::pack;
use crate::support::{Folder, Rgb, done, json, refused};
use foveal_eval::score::{Display, Judge, Mode, ScorePicture, Viewing};
use serde_json::Value;
use std::collections::BTreeSet;

/// Columns and rows of the small pictures.
const SIZE: [u32; 2] = [48, 40];

/// A small picture with detail everywhere.
fn detailed() -> Vec<u8> {
    let bytes = 0..(SIZE[0] * SIZE[1] * 3) as usize;
    bytes.map(|n| 60 + (n / 3 * 7919 % 137) as u8).collect()
}

/// The same with a little less of it, everywhere alike.
fn faded() -> Vec<u8> {
    detailed().iter().map(|byte| 64 + byte / 2).collect()
}

/// Writes RGB as PNG.
pub(crate) fn write_rgb(folder: &Folder, name: &str, rgb: &[u8]) -> String {
    let path = folder.name(name);
    let mut encoder = png::Encoder::new(std::fs::File::create(&path).unwrap(), SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(rgb).unwrap();
    path
}

/// A detailed picture, and one that is a little worse everywhere.
pub(crate) fn pair(folder: &Folder) -> [String; 2] {
    [
        write_rgb(folder, "reference.png", &detailed()),
        write_rgb(folder, "test.png", &faded()),
    ]
}

#[test]
fn a_gaze_beside_the_picture_is_scored_and_forgives_more_the_farther_it_is() {
    let folder = Folder::new();
    let [reference, test] = pair(&folder);
    let score = ["score", &reference, &test, "--display", "standard_hmd"];
    for mode in ["compat", "strict"] {
        let at = |gaze: &str| {
            let found = json(&[&score[..], &["--mode", mode, "--gaze", gaze]].concat());
            (found["jod"].as_f64().unwrap(), found)
        };
        let mut before = at("center").0;
        for gaze in ["-40,20", "150,-90", "900,900", "-1e9,4e5", "1e300,-1e300"] {
            let (jod, found) = at(gaze);
            assert!(
                jod >= before - 1e-3 && jod < 10.0,
                "{mode} {gaze}: {jod} after {before}"
            );
            assert!(found["companions"]["fw_psnr_db"].is_f64(), "{found}");
            before = jod;
        }
        let (_, found) = at("-4000,20");
        assert!(found["companions"]["foveal_ssim"].is_null(), "{found}");
        assert!(found["zones"]["under_5_deg"].is_null(), "{found}");
    }
    let metric = [
        &score[..],
        &["--metric", "foveal-ssim", "--gaze", "-4000,20"],
    ]
    .concat();
    assert!(json(&metric)["value"].is_null());
    assert!(
        done(&metric)
            .stdout
            .contains("nothing of the picture is in the fovea")
    );
}

#[test]
fn a_gaze_trace_may_leave_the_picture() {
    let folder = Folder::new();
    let [reference, test] = pair(&folder);
    let trace = folder.holding("far.csv", b"frame,x_px,y_px\n0,-90,2e7\n");
    let score = ["score", &reference, &test, "--display", "standard_hmd"];
    let traced = json(&[&score[..], &["--gaze-trace", &trace]].concat());
    let given = json(&[&score[..], &["--gaze", "-90,2e7"]].concat());
    assert_eq!(traced["jod"], given["jod"]);
}

#[test]
fn a_gaze_that_is_no_number_is_refused() {
    for gaze in ["nan,3", "3,inf", "3", "left,3", "1e999,0"] {
        let score = [
            "score",
            "a.png",
            "b.png",
            "--display",
            "standard_hmd",
            "--gaze",
            gaze,
        ];
        refused(
            2,
            &score,
            &["--gaze", gaze, "two finite numbers of pixels", "center"],
        );
    }
}

#[test]
fn a_pack_is_scored_for_an_eye_that_looks_past_it() {
    let folder = Folder::new();
    let [pack, _] = pack(&folder);
    let score = [
        "score", &pack, &pack, "--policy", "acuity", "--frames", "1", "--gaze",
    ];
    for gaze in ["-9000,40", "1e300,-7"] {
        let found = json(&[&score[..], &[gaze]].concat());
        let jod = found["jod"].as_f64().unwrap();
        assert!((5.0..=10.0).contains(&jod), "{found}");
        assert!(
            found["companions"]["psnr_db"].as_f64().unwrap() < 60.0,
            "{found}"
        );
    }
}

#[test]
fn the_published_package_s_displays_have_their_names() {
    let list = json(&["score", "--list-displays"]);
    let rows = list["displays"].as_array().unwrap();
    let names: BTreeSet<&str> = rows
        .iter()
        .map(|row| row["name"].as_str().unwrap())
        .collect();
    assert_eq!(names.len(), 14);
    let help = done(&["score", "--help"]).stdout;
    let text = done(&["score", "--list-displays"]).stdout;
    let folder = Folder::new();
    let [reference, test] = pair(&folder);
    for row in rows {
        let name = row["name"].as_str().unwrap();
        assert!(text.contains(name), "no {name} in {text}");
        let score = [
            "score",
            &reference,
            &test,
            "--display",
            name,
            "--frames",
            "1",
        ];
        let Some(why) = row["refused"].as_str() else {
            assert!(help.contains(name), "no {name} in {help}");
            let found = json(&score);
            assert_eq!(found["display"], name);
            assert_eq!(found["peak_cd_m2"], row["peak_cd_m2"]);
            continue;
        };
        refused(2, &score, &["--display", name, why, "standard_hdr_pq"]);
    }
    let refused: Vec<&Value> = rows
        .iter()
        .filter(|row| !row["refused"].is_null())
        .collect();
    assert_eq!(refused.len(), 1);
    assert_eq!(refused[0]["name"], "standard_hdr_linear");
}

#[test]
fn codes_of_a_display_with_pq_are_taken_as_absolute_light() {
    let folder = Folder::new();
    let [reference, test] = pair(&folder);
    let on = |display: &str| {
        let found = json(&["score", &reference, &test, "--display", display]);
        found["jod"].as_f64().unwrap()
    };
    let file = b"name = \"x\"\nsize_px = [3840, 2160]\ndiagonal_inches = 30\ndistance_m = 0.7472\n\
                 peak_cd_m2 = 1500\ncontrast = 1e6\nambient_lux = 10\ntransfer = \"pq\"\n";
    let file = folder.holding("pq.toml", file);
    assert_eq!(on("standard_hdr_pq"), on(&file));
    assert_ne!(on("standard_hdr_pq"), on("standard_4k"));
}

#[test]
fn the_heat_map_as_numbers_is_what_numpy_reads() {
    let folder = Folder::new();
    let [reference, test] = pair(&folder);
    let heat = folder.name("lost.npy");
    let score = [
        "score",
        &reference,
        &test,
        "--display",
        "standard_hmd",
        "--gaze",
        "9,30",
    ];
    let found = json(&[&score[..], &["--heat", &heat]].concat());
    assert_eq!(found["heat_file"], *heat);
    let display = Display::named("standard_hmd").unwrap();
    let viewing = Viewing::new(display, SIZE, None, true, Mode::Compat).unwrap();
    let mut judge = Judge::new(&viewing, 1).unwrap();
    judge.keep_heat();
    let [reference, test] =
        [detailed(), faded()].map(|rgb| ScorePicture::from_rgb8(SIZE, rgb).unwrap());
    judge.frame(&reference, &test, [9.0, 30.0]).unwrap();
    let about = "{'descr': '<f4', 'fortran_order': False, 'shape': (40, 48), }";
    let mut wanted = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    wanted.extend(format!("{about:<117}\n").as_bytes());
    for lost in judge.heat().unwrap().jod_lost {
        wanted.extend(lost.to_le_bytes());
    }
    assert_eq!(std::fs::read(&heat).unwrap(), wanted);
    let neither = folder.name("lost.txt");
    let score_into = [&score[..], &["--heat", &neither]].concat();
    refused(2, &score_into, &["--heat", ".png", ".npy"]);
    let picture = folder.name("lost.png");
    done(&[&score[..], &["--heat", &picture]].concat());
    assert_eq!(Rgb::read(&picture).size, SIZE);
}

#[test]
fn help_keeps_what_packs_alone_need_apart() {
    for help in ["-h", "--help"] {
        let text = done(&["score", help]).stdout;
        let headings = [
            "Options:",
            "Pictures and videos:",
            "Many pairs:",
            "Packs alone:",
        ];
        let places = headings.map(|heading| text.find(&format!("\n{heading}\n")));
        assert!(
            places.iter().all(Option::is_some) && places.is_sorted(),
            "{text}"
        );
        let (others, packs) = text.split_at(places[3].unwrap());
        for option in [
            "--policy",
            "--acuity",
            "--thresholds",
            "--model",
            "--set",
            "--view",
            "--fov",
        ] {
            let line = |part: &str| part.lines().any(|l| l.trim_start().starts_with(option));
            assert!(line(packs) && !line(others), "{option}: {text}");
        }
        for option in [
            "--display",
            "--gaze",
            "--metric",
            "--heat",
            "--json",
            "--help",
            "--pairs",
        ] {
            let line = |part: &str| part.lines().any(|l| l.contains(option) && l.contains("--"));
            assert!(line(others), "{option}: {text}");
        }
    }
}
