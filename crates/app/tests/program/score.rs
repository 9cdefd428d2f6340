//! Does `foveal score` judge pictures, videos and packs, and refuse what cannot be judged?

use crate::scenes::{noise, write_clip};
use crate::support::{Folder, Rgb, assert_keys, done, json, refused, skipped};
use foveal_core::view::picture::Picture;
use serde_json::Value;

/// The inputs of goldens, as the program writes them, and the command that it says.
fn goldens(folder: &Folder, cases: &[&str]) -> Value {
    let out = folder.name("goldens");
    json(&[&["evaluate", "goldens", "--write", &out], cases].concat())
}

fn near(found: &Value, wanted: f64, by: f64) {
    let found = found.as_f64().unwrap();
    assert!((found - wanted).abs() <= by, "{found}, wanted {wanted}");
}

#[test]
fn the_command_that_goes_with_a_golden_gives_its_score() {
    let folder = Folder::new();
    let report = goldens(&folder, &["G2", "G4", "G9"]);
    for (row, wanted) in report["goldens"]
        .as_array()
        .unwrap()
        .iter()
        .zip([8.42211, 7.87191, 7.672])
    {
        let command = row["command"].as_str().unwrap();
        let words: Vec<&str> = command.split(' ').skip(1).collect();
        let found = json(&words);
        near(&found["jod"], wanted, 0.0005);
        near(&row["jod"], found["jod"].as_f64().unwrap(), 1e-9);
    }
}

#[test]
fn a_photograph_at_hand_has_its_published_scores() {
    refused(2, &["evaluate", "goldens", "G5"], &["G5", "--photo"]);
    let folder = Folder::new();
    goldens(&folder, &["G2"]);
    let other = folder.name("goldens/G2/test/0000.png");
    refused(
        1,
        &["evaluate", "goldens", "--photo", &other],
        &["--photo", "0000.png", "256x256", "astronaut"],
    );
    let Ok(photo) = std::env::var("FOVEAL_GOLDEN_PHOTO") else {
        skipped("FOVEAL_GOLDEN_PHOTO names no astronaut.png, so G5 and G6 were not run");
        return;
    };
    let report = json(&["evaluate", "goldens", "--photo", &photo, "G5", "G6"]);
    let rows = report["goldens"].as_array().unwrap();
    for (row, wanted) in rows.iter().zip([8.43239, 7.51087]) {
        near(&row["jod"], wanted, 0.0005);
        near(&row["worst_energy"], 0.0, 0.001);
    }
    assert_eq!(rows.len(), 2);
}

/// What every result has.
const KEYS: [&str; 17] = [
    "metric",
    "version",
    "mode",
    "display",
    "ppd",
    "peak_cd_m2",
    "black_cd_m2",
    "foveated",
    "gaze",
    "fps",
    "size_px",
    "frames",
    "device",
    "bands",
    "zones",
    "companions",
    "per_frame",
];

#[test]
fn a_result_says_under_which_conditions_it_was_found() {
    let folder = Folder::new();
    goldens(&folder, &["G9"]);
    let [reference, test] = ["reference", "test"].map(|k| folder.name(&format!("goldens/G9/{k}")));
    let heat = folder.name("heat.png");
    let arguments = [
        "score",
        &reference,
        &test,
        "--display",
        "standard_hmd",
        "--fps",
        "30",
        "--gaze",
        "160,120",
        "--heat",
        &heat,
    ];
    let found = json(&arguments);
    // A link to a device stays one: nothing is put in the device's place.
    let device = folder.name("device.png");
    std::os::unix::fs::symlink("/dev/null", &device).unwrap();
    let nowhere = arguments.map(|word| if word == heat { &device } else { word });
    done(&nowhere);
    assert!(std::fs::symlink_metadata(&device).unwrap().is_symlink());
    // Case G11 of the goldens.
    near(&found["jod"], 7.33896, 0.0005);
    assert_keys(&found, &KEYS);
    assert_eq!(found["metric"], "fovvideovdp");
    assert_eq!(found["version"], "1.2");
    assert_eq!(found["mode"], "compat");
    assert_eq!(found["per_frame"].as_array().unwrap().len(), 12);
    assert_eq!(found["bands"].as_array().unwrap().len(), 5);
    near(&found["bands"][1]["sustained"], 477.639, 0.48);
    near(&found["companions"]["psnr_db"], 20.180, 6e-4);
    let zones = &found["zones"];
    let shares = ["under_5_deg", "from_5_to_20_deg", "over_20_deg"];
    let shares = shares.map(|zone| zones[zone]["pixels_share"].as_f64().unwrap());
    assert!(
        (shares.iter().sum::<f64>() - 1.0).abs() < 1e-9,
        "{shares:?}"
    );
    let picture = Rgb::read(&heat);
    assert_eq!(picture.size, [320, 240]);
    assert!(
        picture.pixels.iter().any(|byte| *byte > 128),
        "nothing is lost anywhere"
    );
    let strict = json(&[arguments.as_slice(), &["--mode", "strict"]].concat());
    assert_eq!(strict["mode"], "strict");
    assert_ne!(strict["jod"], found["jod"]);
    let text = done(&arguments).stdout;
    assert!(
        text.contains("JOD") && text.contains("gaze: 160,120"),
        "{text}"
    );
}

#[test]
fn a_gpu_gives_the_score_of_the_processor() {
    let report = json(&["evaluate", "goldens", "G4", "G9", "--device", "gpu"]);
    assert!(report["device"].as_str().unwrap().starts_with("gpu: "));
    assert!(report["worst_jod"].as_f64().unwrap() <= 0.005, "{report}");
}

#[test]
fn displays_and_the_paper_are_listed() {
    let list = json(&["score", "--list-displays"]);
    near(&list["displays"][0]["ppd"], 75.4024, 1e-4);
    assert!(
        done(&["score", "--list-displays"])
            .stdout
            .contains("htc_vive_pro")
    );
    assert!(
        done(&["score", "--cite"])
            .stdout
            .contains("10.1145/3450626.3459831")
    );
    assert_eq!(json(&["score", "--cite"])["version"], "1.2");
}

#[test]
fn a_display_may_be_described_by_a_file() {
    let folder = Folder::new();
    goldens(&folder, &["G2"]);
    let [reference, test] = ["reference", "test"].map(|k| folder.name(&format!("goldens/G2/{k}")));
    let display = folder.holding(
        "headset.toml",
        b"name = \"mine\"\nsize_px = [1440, 1600]\nfov_diagonal_deg = 110\npeak_cd_m2 = 100\n\
          black_cd_m2 = 0.1\n",
    );
    let arguments = [
        "score",
        &reference,
        &test,
        "--display",
        &display,
        "--gaze",
        "128,128",
    ];
    let found = json(&arguments);
    near(&found["jod"], 8.42211, 0.0005);
    assert_eq!(found["display"], "mine");
}

#[test]
fn other_measures_are_given_by_name() {
    let folder = Folder::new();
    goldens(&folder, &["G2"]);
    let [reference, test] = ["reference", "test"].map(|k| folder.name(&format!("goldens/G2/{k}")));
    let base = [
        "score",
        &reference,
        &test,
        "--display",
        "standard_hmd",
        "--metric",
    ];
    let psnr = json(&[base.as_slice(), &["psnr"]].concat());
    near(&psnr["value"], 20.106, 6e-4);
    let gaze = ["--gaze", "center"];
    for metric in ["fw-psnr", "foveal-ssim", "ssim"] {
        let found = json(&[base.as_slice(), &[metric], &gaze].concat());
        assert!(
            found["value"].as_f64().is_some_and(|value| value > 0.1),
            "{found}"
        );
        assert_eq!(found["metric"], metric);
        assert_keys(&found, &KEYS[..12]);
    }
    refused(
        1,
        &[base.as_slice(), &["fw-psnr"]].concat(),
        &["the gaze", "give"],
    );
    refused(
        1,
        &[base.as_slice(), &["ws-psnr"]].concat(),
        &["256x256", "equirectangular"],
    );
}

/// A pack of a small generated clip, and the clip.
pub(crate) fn pack(folder: &Folder) -> [String; 2] {
    let pictures: Vec<Picture> = (0..6).map(|frame| noise([512, 256], frame)).collect();
    let clip = write_clip(folder, "clip.mkv", &pictures);
    let pack = folder.name("clip.foveal");
    done(&[
        "prepare",
        "video",
        &clip,
        "--out",
        &pack,
        "--projection",
        "flat",
        "--quality",
        "10",
    ]);
    [pack, clip]
}

#[test]
fn a_video_is_itself_and_packs_are_scored_under_two_policies() {
    let folder = Folder::new();
    let [pack, clip] = pack(&folder);
    let same = json(&[
        "score",
        &clip,
        &clip,
        "--display",
        "standard_fhd",
        "--gaze",
        "center",
    ]);
    assert_eq!(same["jod"], 10.0);
    assert_eq!(same["frames"], 6);
    assert!(same["companions"]["psnr_db"].is_null());
    let arguments = ["score", &pack, &pack, "--gaze", "60,40", "--policy"];
    let jod = |policy: &str| {
        let found = json(&[arguments.as_slice(), &[policy]].concat());
        assert_eq!(found["display"], "view");
        found["jod"].as_f64().unwrap()
    };
    assert_eq!(jod("full"), 10.0);
    let [acuity, coarsest] = ["acuity", "coarsest"].map(jod);
    assert!(coarsest < acuity && acuity <= 10.0, "{coarsest} {acuity}");
    refused(2, &["score", &pack, &pack], &["clip.foveal", "--gaze"]);
}

#[test]
fn a_run_is_scored_against_the_full_picture() {
    let folder = Folder::new();
    let [pack, _] = pack(&folder);
    let run = |policy: &str| {
        let out = folder.name(policy);
        json(&[
            "simulate",
            &pack,
            "--out",
            &out,
            "--pictures",
            "none",
            "--policy",
            policy,
            "--gaze",
            "0,0",
            "--score",
        ])
    };
    let full = run("full");
    assert_eq!(full["score"]["jod"], 10.0);
    assert_eq!(full["score"]["frames"], 6);
    let coarsest = run("coarsest");
    assert!(
        coarsest["score"]["jod"].as_f64().unwrap() < 9.9,
        "{coarsest}"
    );
    assert_eq!(coarsest["score"]["foveated"], true);
    assert_eq!(coarsest["score"]["gaze"], "true gaze of the run (0, 0)");
    assert_keys(&coarsest["score"], &KEYS);
    let out = folder.name("nowhere");
    let nowhere = ["simulate", &pack, "--out", &out, "--score"];
    let nowhere = [nowhere.as_slice(), &["--score-display", "tv"]].concat();
    refused(2, &nowhere, &["--score-display", "tv", "standard_fhd"]);
    let out = folder.name("unseen");
    let unseen = [
        "simulate",
        &pack,
        "--out",
        &out,
        "--score",
        "--renderer",
        "none",
    ];
    refused(2, &unseen, &["--score", "--renderer"]);
}

#[test]
fn a_run_is_scored_by_where_the_eye_looked_and_not_by_what_the_system_was_told() {
    let folder = Folder::new();
    let [pack, _] = pack(&folder);
    // The eye jumps from the left to the right after the third frame.
    let mut trace = "t_s,yaw_deg,pitch_deg,valid,spread_deg\n".to_owned();
    for n in 0..60 {
        let time = f64::from(n) * 0.005;
        let yaw = if time < 0.11 { -15.0 } else { 15.0 };
        trace += &format!("{time},{yaw},0,1,0.5\n");
    }
    let gaze = format!("trace:{}", folder.holding("jump.csv", trace.as_bytes()));
    let run = |late: &str| {
        let out = folder.name(late);
        let words = [
            "simulate",
            &pack,
            "--out",
            &out,
            "--pictures",
            "none",
            "--slope",
            "0.022",
            "--gaze",
            &gaze,
            "--score",
            "--late",
            late,
        ];
        let found = json(&words);
        let source = found["score"]["gaze"].as_str().unwrap();
        assert!(
            source.starts_with("true gaze of the run (trace:"),
            "{source}"
        );
        found["score"]["jod"].as_f64().unwrap()
    };
    let [in_time, late] = ["0", "100"].map(run);
    assert!(late < in_time - 0.05, "{late} {in_time}");
}

#[test]
fn what_cannot_be_scored_is_refused_by_file_and_field() {
    let folder = Folder::new();
    goldens(&folder, &["G2", "G4", "G9"]);
    let of = |name: &str| folder.name(&format!("goldens/{name}"));
    let [still, wide, video] = ["G2/test", "G4/test", "G9/test"].map(of);
    let hmd = ["--display", "standard_hmd"];
    let score = |a: &str, b: &str, more: &[&str], code: i32, words: &[&str]| {
        refused(
            code,
            &[&["score", a, b], hmd.as_slice(), more].concat(),
            words,
        );
    };
    score(&still, &wide, &[], 1, &["G4", "321x243", "256x256"]);
    score(&video, &video, &[], 2, &["G9", "--fps"]);
    score(
        &video,
        &video,
        &["--fps", "0"],
        1,
        &["frames a second", "give"],
    );
    score(&folder.name("gone"), &still, &[], 1, &["gone"]);
    score(&still, &of("G9"), &[], 1, &["G9", "no numbered pictures"]);
    let trace = folder.holding("short.csv", b"frame,x_px,y_px\n0,1,1\n1,2,2\n");
    let traced = ["--fps", "30", "--gaze-trace", &trace];
    score(&video, &video, &traced, 1, &["short.csv", "frame 2"]);
    let trace = folder.holding("bad.csv", b"frame,x_px,y_px\n0,NaN,1\n");
    let traced = ["--fps", "30", "--gaze-trace", &trace];
    score(&video, &video, &traced, 1, &["bad.csv", "line 2", "x_px"]);
    let display = |text: &str| folder.holding("display.toml", text.as_bytes());
    let shown = |on: &str, code: i32, words: &[&str]| {
        refused(code, &["score", &still, &still, "--display", on], words);
    };
    shown(
        "standard_8k",
        2,
        &["--display", "standard_8k", "standard_4k"],
    );
    refused(
        2,
        &["score", &still, &still],
        &["--display", "standard_fhd"],
    );
    let absurd = "name = \"x\"\nsize_px = [640, 480]\nfov_diagonal_deg = 1\npeak_cd_m2 = 9\n\
                  contrast = 9\n";
    shown(&display(absurd), 1, &["display.toml", "pixels per degree"]);
    shown(
        &display("name = \"x\"\nsize = 3\n"),
        1,
        &["display.toml", "size"],
    );
}

/// A PNG file of a colour type and depth.
fn png(folder: &Folder, name: &str, kind: png::ColorType, bytes: &[u8]) -> String {
    let path = folder.name(name);
    let file = std::fs::File::create(&path).unwrap();
    let mut encoder = png::Encoder::new(file, 16, 16);
    encoder.set_color(kind);
    let depth = bytes.len() / 256 / kind.samples();
    encoder.set_depth(if depth == 2 {
        png::BitDepth::Sixteen
    } else {
        png::BitDepth::Eight
    });
    encoder
        .write_header()
        .unwrap()
        .write_image_data(bytes)
        .unwrap();
    path
}

#[test]
fn small_deep_and_opaque_pictures_are_scored_and_transparent_ones_are_not() {
    use png::ColorType::{Grayscale, Rgb, Rgba};
    let folder = Folder::new();
    let code = |n: usize| (n * 37 % 251) as u8;
    let rgb: Vec<u8> = (0..256 * 3).map(code).collect();
    let deep: Vec<u8> = rgb.iter().flat_map(|&code| [code, code]).collect();
    let with_alpha = |alpha: u8| -> Vec<u8> {
        rgb.chunks_exact(3)
            .flat_map(|p| [p[0], p[1], p[2], alpha])
            .collect()
    };
    let plain = png(&folder, "plain.png", Rgb, &rgb);
    let deep = png(&folder, "deep.png", Rgb, &deep);
    let opaque = png(&folder, "opaque.png", Rgba, &with_alpha(255));
    let clear = png(&folder, "clear.png", Rgba, &with_alpha(254));
    let grey = png(&folder, "grey.png", Grayscale, &[90; 256]);
    let more = ["--display", "standard_4k", "--gaze", "8,8"];
    for other in [&deep, &opaque] {
        // Light of 8 and of 16 bits may differ in the last bit.
        let found = json(&[&["score", &plain, other], more.as_slice()].concat());
        near(&found["jod"], 10.0, 1e-6);
    }
    let found = json(&[&["score", &plain, &grey], more.as_slice()].concat());
    assert!(found["jod"].as_f64().unwrap() < 10.0);
    let refusal = ["clear.png", "transparent", "flatten"];
    refused(
        1,
        &[&["score", &plain, &clear], more.as_slice()].concat(),
        &refusal,
    );
    let damaged = std::fs::read(&plain).unwrap();
    let damaged = folder.holding("damaged.png", &damaged[..damaged.len() / 2]);
    refused(
        1,
        &[&["score", &plain, &damaged], more.as_slice()].concat(),
        &["damaged.png"],
    );
}
