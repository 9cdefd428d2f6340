//! Do the benchmark of video and the experiments measure what they say?

use crate::results::agrees;
use crate::scenes::write_clip;
use crate::support::{Folder, assert_keys, command, done, json, refused};
use foveal_media::generate::GeneratedScene;
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;

/// A generated clip.
fn wide_clip(folder: &Folder, size: [u32; 2], frames: u64) -> String {
    let scene = GeneratedScene::wide(size);
    let pictures: Vec<_> = (0..frames).map(|number| scene.frame(number)).collect();
    write_clip(folder, "clip.mkv", &pictures)
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no {key} in {value}"))
}

#[test]
fn experiments_that_are_ended_leave_nothing() {
    let folder = Folder::new();
    let clip = wide_clip(&folder, [640, 360], 64);
    let scratch = folder.name("scratch");
    std::fs::create_dir(&scratch).unwrap();
    let mut command = command(&["evaluate", "codecs", &clip, "--scratch", &scratch]);
    let mut running = command.stderr(Stdio::null()).spawn().unwrap();
    let holds_something = || std::fs::read_dir(&scratch).unwrap().next().is_some();
    while !holds_something() {
        assert!(running.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(1));
    }
    let id = running.id().to_string();
    let killed = Command::new("kill").args(["-TERM", &id]).status().unwrap();
    assert!(killed.success() && !running.wait().unwrap().success());
    assert!(!holds_something());
}

#[test]
fn a_pack_is_timed_foveated_against_viewport_full_and_its_original() {
    let folder = Folder::new();
    let clip = wide_clip(&folder, [640, 360], 12);
    let pack = folder.name("clip.foveal");
    done(&[
        "prepare",
        "video",
        &clip,
        "--projection",
        "flat",
        "--out",
        &pack,
    ]);
    let report = json(&[
        "bench",
        "video",
        &pack,
        "--original",
        &clip,
        "--frames",
        "30",
        "--slope",
        "0.022",
    ]);
    assert_eq!(report["score"], report["before"]["score"]);
    assert!(number(&report, "score") < 9.9, "{report}");
    for key in [
        "foveated_fps",
        "viewport_fps",
        "full_fps",
        "original_fps",
        "ratio",
    ] {
        assert!(number(&report, key) > 0.0, "{report}");
    }
    assert_keys(&report, &["ratio_viewport", "late_frames", "machine"]);
    assert!(number(&report, "frames_to_fovea_p95") >= 1.0);
    assert!(number(&report, "pixels_share_mean") < 1.0, "{report}");
    let whole = 640.0 * 360.0 * 1.5;
    let share = number(&report, "gpu_bytes") / whole;
    assert!((share - number(&report, "gpu_share")).abs() < 1e-9);
}

#[test]
fn a_benchmark_without_content_or_with_too_few_frames_is_refused() {
    refused(2, &["bench", "video"], &["PACK"]);
    let bench = ["bench", "video", "x.foveal"];
    let policy = [&bench[..], &["--policy", "best"]].concat();
    refused(2, &policy, &["--policy", "perceptual"]);
    for policy in ["grid", "all"] {
        let slope = [&bench[..], &["--policy", policy, "--slope", "0.01"]].concat();
        refused(2, &slope, &["--slope", "acuity"]);
    }
    let workers = [&bench[..], &["--workers", "4,0"]].concat();
    refused(2, &workers, &["--workers is 0", "1 to 256"]);
    let score = [&bench[..], &["--policy", "grid", "--target", "9"]].concat();
    refused(2, &score, &["--target", "grid"]);
    let target = ["bench", "video", "x.foveal", "--target", "10"];
    refused(2, &target, &["--target", "1 to 9.99"]);
    refused(
        2,
        &["bench", "video", "x.foveal", "--frames", "9"],
        &["--frames", "10 to 100000"],
    );
    refused(
        1,
        &["bench", "video", "x.foveal", "--renderer", "none"],
        &["x.foveal"],
    );
}

#[test]
fn the_rule_of_a_published_system_is_timed_beside_ours_at_its_score() {
    let folder = Folder::new();
    let clip = wide_clip(&folder, [640, 360], 9);
    let pack = folder.name("clip.foveal");
    let preset = ["--preset", "kastner-2016"];
    let flat = ["--projection", "flat", "--out", &pack];
    done(&[&["prepare", "video", &clip], &flat[..], &preset[..]].concat());
    let bench = ["bench", "video", &pack, "--frames", "10"];
    let original = ["--original", &clip];
    let report = json(&[&bench[..], &preset[..], &original[..]].concat());
    let published = &report["published"];
    assert_eq!(published["policy"], "sampled", "{report}");
    let [ours, theirs] = [&report, published].map(|it| number(it, "score"));
    assert!(ours >= theirs - 0.01, "{ours} {theirs}");
    assert!(number(&report, "target") <= 9.99, "{report}");
    for key in ["decode_fps", "end_to_end_fps"] {
        assert!(number(&published[key], "median") > 0.0, "{report}");
        assert!(number(&report["coarsest"][key], "median") > 0.0, "{report}");
    }
    assert_eq!(published["full"], report["full"], "they play one pack");
    // A rule that has no score is timed as it is.
    let grid = [
        "--policy",
        "grid",
        "--renderer",
        "none",
        "--workers",
        "1,40",
    ];
    let grid = json(&[&bench[..], &grid[..]].concat());
    agrees("bench video", &[&report, &grid]);
    assert_eq!(grid["policy"], "grid");
    // More threads than there are tiles are as good as others.
    let workers = grid["workers"].as_array().unwrap();
    let counts: Vec<f64> = workers.iter().map(|it| number(it, "workers")).collect();
    assert_eq!(counts, [1.0, 40.0]);
    for row in workers {
        assert!(number(row, "decode_ms_mean") > 0.0, "{row}");
        assert!(number(row, "foveated_fps") > 0.0, "{row}");
    }
    assert!(
        grid["score"].is_null() && grid["published"].is_null(),
        "{grid}"
    );
    assert!(
        number(&grid, "foveated_fps") > number(&grid, "full_fps"),
        "{grid}"
    );
}

#[test]
fn both_rules_that_keep_a_target_are_timed_in_one_run_part_by_part() {
    let folder = Folder::new();
    let clip = wide_clip(&folder, [640, 360], 9);
    let pack = folder.name("clip.foveal");
    let calibrated = ["--projection", "flat", "--out", &pack];
    done(&[&["prepare", "video", &clip], &calibrated[..]].concat());
    let bench = ["bench", "video", &pack, "--frames", "20"];
    let report = json(&[&bench[..], &["--policy", "all"]].concat());
    let policies = report["policies"].as_object().unwrap();
    assert_eq!(policies.len(), 2, "{report}");
    for (name, policy) in policies {
        assert_eq!(policy["policy"], **name);
        assert!(number(policy, "decodes_per_frame") >= 1.0, "{policy}");
        assert!(number(policy, "ratio") > 0.0, "{policy}");
        for part in ["choose", "decode", "upload", "draw"] {
            for key in ["ms_mean", "ms_median", "jump_ms_mean"] {
                assert!(number(&policy["parts"][part], key) > 0.0, "{part} {policy}");
            }
        }
        let wait = &policy["parts"]["wait"];
        assert!(number(wait, "ms_mean") >= 0.0, "{policy}");
        assert!(number(wait, "jump_ms_mean") >= 0.0, "{policy}");
    }
    // What stands at the top is of the first, the cheaper one where that is known.
    let first = report["policy"].as_str().unwrap();
    assert_eq!(report["parts"], policies[first]["parts"]);
    let auto = json(&bench);
    assert_eq!(auto["policy"], first, "{auto}");
    assert_eq!(auto["policies"].as_object().unwrap().len(), 1, "{auto}");
}

#[test]
fn preparing_is_timed_at_every_speed_and_its_sizes_are_compared() {
    let folder = Folder::new();
    let clip = wide_clip(&folder, [256, 256], 8);
    let report = json(&["bench", "prepare", "--input", &clip, "--frames", "8"]);
    agrees("bench prepare", &[&report]);
    let speeds = report["speed"].as_array().unwrap();
    let ways: Vec<_> = speeds
        .iter()
        .map(|row| row["way"].as_str().unwrap())
        .collect();
    assert_eq!(ways, ["default", "--fast", "--small", "--codec jpeg"]);
    for row in speeds {
        assert_eq!(row["content"], "clip.mkv");
        assert!(number(row, "bytes") > 0.0, "{row}");
        let mpix = number(row, "prepare_mpix_per_s") * number(row, "prepare_s");
        assert!((mpix - 256.0 * 256.0 * 8.0 / 1e6).abs() < 1e-6, "{row}");
    }
    let sizes = report["sizes"].as_array().unwrap();
    let of = |way: &str| {
        let row = sizes.iter().find(|row| row["way"] == way).unwrap();
        number(row, "bytes_over_reference")
    };
    assert_eq!(sizes.len(), 3, "one size of tile fits: {report}");
    assert!(of("--small") < of("--fast"), "{report}");
    refused(
        1,
        &["bench", "prepare", "--input", &folder.name("none.mkv")],
        &["none.mkv"],
    );
    refused(2, &["bench", "prepare", "--frames", "0"], &["--frames"]);
}

#[test]
fn codecs_are_compared_by_time_bytes_and_speed() {
    let folder = Folder::new();
    let clip = wide_clip(&folder, [320, 180], 8);
    let options = ["evaluate", "codecs", &clip, "--frames", "8", "--play", "18"];
    let cut = [
        "--grid", "4x4", "--policy", "coarsest", "--codecs", "vp9,png",
    ];
    let report = json(&[&options[..], &cut].concat());
    agrees("evaluate codecs", &[&report]);
    let rows = report["codecs"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for row in rows {
        let levels = row["bytes_per_level"].as_array().unwrap();
        let levels: Vec<f64> = levels.iter().map(|bytes| bytes.as_f64().unwrap()).collect();
        assert!(levels.is_sorted_by(|a, b| a > b), "{row}");
        assert!(levels.iter().sum::<f64>() < number(row, "bytes"));
        for key in [
            "foveated_fps_median",
            "foveated_saccade_fps_p5",
            "full_fps",
            "coarsest_fps",
            "grid_fps_median",
            "grid_saccade_fps_p5",
            "prepare_s",
        ] {
            assert!(number(row, key) > 0.0, "{row}");
        }
        assert_eq!(row["policy"], "coarsest");
        let [coarsest, grid] = ["pixels_share_mean", "grid_pixels_share_mean"].map(|key| {
            let share = number(row, key);
            assert!(share > 0.0 && share < 1.0, "{row}");
            share
        });
        assert!(coarsest < grid, "{row}");
    }
    // Lossless takes more.
    assert!(number(&rows[1], "bytes") > 2.0 * number(&rows[0], "bytes"));
    assert!(number(&rows[1], "storage_ratio") > number(&rows[0], "storage_ratio"));
    let preset = ["--preset", "kastner-2016", "--codecs", "jpeg90"];
    let report = json(&[&options[..], &preset].concat());
    agrees("evaluate codecs", &[&report]);
    let row = &report["codecs"][0];
    assert_eq!(row["policy"], "sampled", "{row}");
    assert_eq!(row["bytes_per_level"].as_array().map(Vec::len), Some(3));
    refused(
        2,
        &[&options[..], &["--codecs", "vp7"]].concat(),
        &["vp7", "vp9"],
    );
}

#[test]
fn small_cells_follow_the_eye_with_fewer_pixels() {
    let folder = Folder::new();
    let clip = wide_clip(&folder, [320, 180], 4);
    let options = [
        "evaluate",
        "grid-sweep",
        &clip,
        "--frames",
        "4",
        "--play",
        "18",
    ];
    let sweep = ["--grids", "2,8,400", "--levels", "3"];
    let report = json(&[&options[..], &sweep].concat());
    agrees("evaluate grid-sweep", &[&report]);
    let cuts = report["cuts"].as_array().unwrap();
    let shares: Vec<f64> = cuts
        .iter()
        .map(|cut| number(cut, "pixels_share_mean"))
        .collect();
    assert_eq!(shares.len(), 2, "{report}");
    assert!(shares[1] < 0.8 * shares[0], "{shares:?}");
    let impossible = report["impossible"].as_array().unwrap();
    assert_eq!(impossible[0]["grid"], serde_json::json!([400, 400]));
}
