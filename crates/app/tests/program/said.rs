//! Are results and warnings said in words that a person can act on, and by one scheme?

use crate::scenes::write_clip;
use crate::support::{Folder, foveal, refused};
use foveal_media::generate::numbered_tiles;

/// A flat pack of four frames.
fn pack(folder: &Folder) -> String {
    let pictures: Vec<_> = (0..4)
        .map(|it| numbered_tiles([512, 288], 64, it))
        .collect();
    let clip = write_clip(folder, "clip.mkv", &pictures);
    let pack = folder.name("clip.foveal");
    let ran = foveal(&["prepare", "video", &clip, "--out", &pack, "--fast"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stderr.contains("treated as flat, judging by its size"));
    pack
}

#[test]
fn a_gaze_outside_the_picture_and_a_missed_target_are_said() {
    let folder = Folder::new();
    let (pack, out) = (pack(&folder), folder.name("run"));
    let play = |options: &[&str]| {
        let head = ["simulate", &pack, "--out", &out, "--renderer", "none"];
        let ran = foveal(&[&head[..], &["--pictures", "none"], options].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
        ran
    };
    let ran = play(&["--gaze", "80,0"]);
    assert!(
        ran.stderr
            .contains("warning: in 4 of 4 frames the gaze lies outside the picture")
    );
    let ran = play(&["--gaze", "3,2"]);
    assert!(!ran.stderr.contains("outside"), "{ran:?}");
    let perceptual = ["--gaze", "3,2", "--policy", "perceptual", "--target", "9.5"];
    assert!(!play(&perceptual).stderr.contains("missed"));
    // Only the coarsest level comes through.
    let judged = ["--link", "1kbit", "--score", "--frames", "2"];
    let slow = ["simulate", &pack, "--out", &out, "--renderer", "cpu"];
    let slow = foveal(&[&slow[..], &perceptual, &judged].concat());
    let missed = "warning: --target 9.5 is missed: the score is ";
    assert!(slow.stderr.contains(missed), "{slow:?}");
    assert!(
        slow.stderr.contains("a faster --link brings more"),
        "{slow:?}"
    );
    let ran = play(&["--gaze", "3,2"]);
    assert!(
        ran.stdout.contains("% of the pixels of the finest level"),
        "{ran:?}"
    );
    assert!(
        ran.stdout
            .trim_end()
            .ends_with(&format!("written to {out}")),
        "{ran:?}"
    );
    let log = format!("{out}/session.jsonl");
    let ran = foveal(&["replay", &log]);
    assert!(
        ran.stdout
            .starts_with("replayed: all 4 selections are identical"),
        "{ran:?}"
    );
}

#[test]
fn a_log_that_cannot_be_read_is_told_of_in_words() {
    let folder = Folder::new();
    for (text, words) in [
        (
            "not json\n",
            "line 1: is no JSON, and so not the head of a session log",
        ),
        ("{\"a\":1}\n", "line 1: is not the head of a session log"),
        ("{\"a\":1", "line 1: is cut off"),
    ] {
        let log = folder.holding("a.jsonl", text.as_bytes());
        refused(
            1,
            &["replay", &log],
            &["error: ", words, "take the log as it was written"],
        );
    }
    let log = folder.holding("b.jsonl", b"\xff\xfe");
    refused(
        1,
        &["replay", &log],
        &["is no text; give the session.jsonl of a simulate"],
    );
}
