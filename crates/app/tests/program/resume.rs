//! Does a preparation that is killed go on, and end with the same pack?

use crate::scenes::{noisy_clip, write_clip};
use crate::support::{Folder, command, done, json, refused};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Nine periods of 32 frames and a part: a process that is slow to be stopped does not end first.
const FRAMES: u32 = 300;

/// Starts the command and sends it a signal once its journal has more than so many bytes.
pub(crate) fn stopped_at(arguments: &[&str], journal: &str, more_than: u64, signal: &str) {
    let mut running = command(arguments).stderr(Stdio::null()).spawn().unwrap();
    let long_enough = || std::fs::metadata(journal).is_ok_and(|there| there.len() > more_than);
    while !long_enough() {
        let ended = running.try_wait().unwrap();
        assert!(
            ended.is_none(),
            "{arguments:?} ended before it was stopped: {ended:?}"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    let id = running.id().to_string();
    assert!(
        Command::new("kill")
            .args([signal, &id])
            .status()
            .unwrap()
            .success()
    );
    assert!(!running.wait().unwrap().success());
}

#[test]
fn a_killed_preparation_goes_on_and_ends_with_the_same_bytes() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([192, 128], FRAMES));
    let (out, undisturbed) = (folder.name("a.foveal"), folder.name("b.foveal"));
    let partial = folder.name("a.foveal.partial");
    let journal = folder.name("a.foveal.partial.journal");
    let prepare = ["prepare", "video", &clip, "--out", &out, "--tile", "64"];
    done(&[
        "prepare",
        "video",
        &clip,
        "--out",
        &undisturbed,
        "--tile",
        "64",
    ]);
    let mut long = 0;
    // A shell that runs this in the background has its children ignore SIGINT.
    for signal in ["-KILL", "-TERM", "-KILL"] {
        stopped_at(&prepare, &journal, long, signal);
        long = std::fs::metadata(&journal).unwrap().len();
        assert!(Path::new(&partial).exists() && !Path::new(&out).exists());
    }
    let ran = done(&prepare);
    assert!(ran.stderr.contains("goes on after"), "{}", ran.stderr);
    assert_eq!(folder.names(), ["a.foveal", "a.mkv", "b.foveal"]);
    assert!(std::fs::read(&out).unwrap() == std::fs::read(&undisturbed).unwrap());
    assert_eq!(json(&["verify", &out])["ok"], true);
    // Nothing is left of it for the next one.
    let again = done(&[&prepare[..], &["--force"]].concat());
    assert!(!again.stderr.contains("goes on"), "{}", again.stderr);
}

#[test]
fn what_was_begun_otherwise_is_not_gone_on_with() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([192, 128], FRAMES));
    let out = folder.name("a.foveal");
    let journal = folder.name("a.foveal.partial.journal");
    let prepare = [
        "prepare", "video", &clip, "--out", &out, "--tile", "64", "--force",
    ];
    let mut before = None;
    for (how, word, signal) in [
        (&["--quality", "30"][..], "other settings", "-KILL"),
        (&["--no-resume"], "--no-resume", "-TERM"),
    ] {
        stopped_at(&prepare, &journal, 0, signal);
        // What it was to replace is still there.
        assert!(std::fs::read(&out).ok() == before);
        let ran = done(&[&prepare[..], how].concat());
        assert!(ran.stderr.contains("starting over"), "{}", ran.stderr);
        assert!(ran.stderr.contains(word), "{}", ran.stderr);
        assert_eq!(folder.names(), ["a.foveal", "a.mkv"]);
        before = std::fs::read(&out).ok();
    }
}

#[test]
fn why_a_preparation_stopped_is_told_before_what_it_keeps() {
    let folder = Folder::new();
    let whole = write_clip(&folder, "whole.mkv", &noisy_clip([128, 96], 80));
    let bytes = std::fs::read(&whole).unwrap();
    let cut = folder.holding("cut.mkv", &bytes[..bytes.len() * 9 / 10]);
    let out = folder.name("a.foveal");
    let words = ["broken at frame", "a.foveal.partial and its journal keep"];
    let prepare = [
        "prepare", "video", &cut, "--out", &out, "--tile", "64", "--strict",
    ];
    let said = refused(1, &prepare, &words).stderr;
    let [why, kept] = words.map(|word| said.find(word).unwrap());
    assert!(why < kept, "{said}");
    // What another keeps is no business of one that cannot begin.
    let partial = folder.name("a.foveal.partial");
    std::fs::remove_file(&partial).unwrap();
    std::fs::create_dir(&partial).unwrap();
    let said = refused(1, &prepare, &["in the way"]).stderr;
    assert!(!said.contains("keep what is done"), "{said}");
}

#[test]
fn codecs_qualities_and_bit_rates_are_told_by_the_pack() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([130, 70], 9));
    let prepare = |how: &[&str]| {
        let out = folder.name("a.foveal");
        let start = [
            "prepare", "video", &clip, "--out", &out, "--tile", "64", "--levels", "2", "--force",
        ];
        json(&[&start[..], how].concat())
    };
    let levels = prepare(&["--codec", "h264", "--quality", "20,30"]);
    assert_eq!(levels["codec"], "h264");
    assert_eq!(levels["quality"], serde_json::json!([20, 30]));
    let jpeg = prepare(&["--codec", "jpeg", "--quality", "q90"]);
    assert_eq!(jpeg["quality_scale"], "ijg");
    assert_eq!(jpeg["quality"], serde_json::json!([90, 90]));
    let rated = prepare(&["--codec", "av1", "--bitrate", "1mbit,200kbit"]);
    assert_eq!(rated["bit_rates"], serde_json::json!([1_000_000, 200_000]));
    // Six tiles of 1 Mbit/s at most, over nine frames at 25 a second.
    let finest = rated["bytes_per_level"][0].as_u64().unwrap();
    let tables = 6 * 4 * 9;
    let most = 6 * (1_000_000 / 8) * 9 / 25 + tables;
    assert!((most / 4..=most).contains(&finest), "{finest} of {most}");
    let start = ["prepare", "video", &clip, "--out", "x.foveal"];
    for (how, words) in [
        (
            &["--codec", "hevc", "--quality", "52"][..],
            &["--quality", "0 to 51 for hevc"][..],
        ),
        (&["--codec", "jpeg", "--quality", "q101"], &["q1 to q100"]),
        (&["--quality", "q90"], &["0 to 63 for vp9"]),
        (
            &["--codec", "jpeg", "--bitrate", "1mbit"],
            &["--bitrate", "jpeg"],
        ),
        (&["--bitrate", "fast"], &["--bitrate", "10mbit"]),
        (
            &["--bitrate", "1mbit", "--quality", "3"],
            &["--quality", "cannot be used"],
        ),
    ] {
        refused(2, &[&start[..], how].concat(), words);
    }
    let three = [&start[..], &["--levels", "2", "--quality", "1,2,3"]].concat();
    refused(1, &three, &["3 qualities", "2 levels", "finest first"]);
}
