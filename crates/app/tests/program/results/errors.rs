//! Are failures one JSON object too, with what, where and next?

use super::document::Document;
use crate::scenes::{waves, write_clip};
use crate::support::{Folder, done, json_of, refused};
use serde_json::Value;

/// The parts of the failure of a command, which prints nothing else.
fn error(code: i32, arguments: &[&str]) -> [String; 3] {
    let ran = refused(code, &[arguments, &["--json"]].concat(), &[]);
    assert!(
        !ran.stderr.is_empty(),
        "{arguments:?} prints nothing for people"
    );
    let found = json_of(&ran);
    let parts = found["error"].as_object().unwrap();
    assert_eq!(found.as_object().unwrap().len(), 1, "{found}");
    let documented = Document::read().keys("error");
    assert_eq!(parts.len(), documented.len(), "{found}");
    let part = |key: &str| {
        let text = parts[key].as_str().unwrap().trim().to_owned();
        assert!(!text.is_empty(), "{arguments:?}: no {key} in {found}");
        text
    };
    ["what", "where", "next"].map(part)
}

#[test]
fn a_command_line_that_cannot_be_read_fails_as_json() {
    for (arguments, place, next) in [
        (&[][..], "foveal", "foveal --help"),
        (&["waltz"], "waltz", "foveal --help"),
        (&["info"], "<PACK>", "foveal info --help"),
        (&["info", "a.foveal", "--jsn"], "--jsn", "--json"),
        (&["--json", "info", "a.foveal"], "foveal", "info --json"),
        (
            &["gaze", "eval"],
            "foveal gaze eval",
            "foveal gaze eval --help",
        ),
        (
            &["prepare", "video", "a.mkv", "--tile", "many"],
            "--tile <PX>",
            "foveal prepare video --help",
        ),
    ] {
        let [what, found, advice] = error(2, arguments);
        assert!(found.contains(place), "{arguments:?}: {found}");
        assert!(advice.contains(next), "{arguments:?}: {advice}");
        assert!(!what.contains('\n') && !what.starts_with("error"), "{what}");
    }
    let [what, place, _] = error(2, &["info", "a.foveal", "--json"]);
    assert!(what.contains("multiple times"), "{what}");
    assert_eq!(place, "--json");
}

#[test]
fn wrong_usage_names_the_option_and_what_to_give() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 1));
    let out = folder.name("out.foveal");
    let prepare = ["prepare", "video", &clip, "--out", &out];
    let [what, place, next] = error(2, &[&prepare[..], &["--jobs", "0"]].concat());
    assert_eq!(
        [what, place, next],
        ["--jobs is 0", "--jobs", "give 1 to 256"]
    );
    let [_, place, _] = error(2, &prepare[..3]);
    assert_eq!(place, "--out");
}

#[test]
fn a_failure_names_the_file_the_place_in_it_and_the_next_step() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let (pack, none) = (folder.name("a.foveal"), folder.name("none"));
    done(&["prepare", "video", &clip, "--fast", "--out", &pack]);
    let text = folder.holding(
        "text.foveal",
        b"no pack at all, but long enough for a header..",
    );
    let trace = folder.holding("gaze.csv", b"t_s,yaw_deg,pitch_deg\n0,0,0\n0.1,NaN,0\n");
    let gaze = format!("trace:{trace}");
    let play = [
        "simulate",
        &pack,
        "--renderer",
        "none",
        "--out",
        &none,
        "--gaze",
        &gaze,
    ];
    let look = ["--gaze", "1,1", "--fov", "20"];
    for (arguments, place) in [
        (&["info", &none][..], &none),
        (&["info", &text], &text),
        (&["verify", &clip], &clip),
        (&["prepare", "video", &none, "--out", &pack], &none),
        (&["prepare", "video", &trace, "--out", &none], &trace),
        (&play, &trace),
        (&["replay", &trace], &trace),
        (&["score", &clip, &trace, "--gaze", "1,1"], &trace),
        (
            &[&["perception", "bands", &text, "--out", &none][..], &look].concat(),
            &text,
        ),
        (&["gaze", "classify", &none], &none),
        (&["gaze", "eval", "head", "--data", &trace], &trace),
        (&["serve", &none], &none),
        (&["bench", "video", &text], &text),
        (&["evaluate", "codecs", &none], &none),
    ] {
        let [what, found, _] = error(1, arguments);
        assert!(
            found.starts_with(place.as_str()),
            "{arguments:?}: {found}: {what}"
        );
        assert!(!what.contains(place.as_str()), "{arguments:?}: {what}");
    }
    let [what, place, _] = error(1, &play);
    assert!(place.contains("line 3"), "{place}");
    assert!(what.contains("NaN"), "{what}");
}

#[test]
fn a_result_that_is_no_good_says_why_beside_its_keys() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&["prepare", "video", &clip, "--fast", "--out", &pack]);
    done(&["simulate", &pack, "--renderer", "none", "--out", &out]);
    let log = std::fs::read_to_string(format!("{out}/session.jsonl")).unwrap();
    let changed = folder.holding("changed.jsonl", log.trim_end().as_bytes());
    let ran = refused(1, &["replay", &changed, "--json"], &["changed.jsonl"]);
    let found = json_of(&ran);
    assert_eq!(found["same"], Value::Bool(false));
    assert_eq!(found["error"]["where"], changed.as_str());
    assert!(found["error"]["next"].is_string(), "{found}");
}
