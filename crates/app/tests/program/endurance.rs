//! Does the program get through what is long, wide or interrupted by the machine?

use crate::scenes::{noisy_clip, picture, write_clip};
use crate::support::{Folder, assert_refused, done, finish, json, refused, skipped};
use foveal_core::view::picture::Picture;
use serde_json::json;
use std::process::Command;

/// Frames of a long clip of small pictures.
const MANY: u32 = 10_000;

/// A picture of one grey that identifies its frame.
fn grey(frame: u32) -> Picture {
    let code = 40 + (frame * 7 % 160) as u8;
    picture([64, 64], |p, _, _| if p == 0 { code } else { 128 })
}

#[test]
fn ten_thousand_frames_are_prepared_and_any_of_them_is_played() {
    let folder = Folder::new();
    let pictures: Vec<Picture> = (0..MANY).map(grey).collect();
    let clip = write_clip(&folder, "long.mkv", &pictures);
    drop(pictures);
    let (pack, out) = (folder.name("long.foveal"), folder.name("out"));
    let how = ["--codec", "jpeg", "--tile", "32", "--levels", "2"];
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    assert_eq!(json(&["info", &pack])["frames"], json!(MANY));
    assert_eq!(json(&["verify", &pack])["ok"], json!(true));
    for start in ["0", "4999", "9997"] {
        let play = ["simulate", &pack, "--out", &out, "--start", start];
        let few = ["--frames", "3", "--policy", "full", "--renderer", "cpu"];
        let run = json(&[&play[..], &few].concat());
        assert_eq!(
            (&run["frames"], &run["damaged_tiles"]),
            (&json!(3), &json!(0))
        );
        let first: u32 = start.parse().unwrap();
        for frame in first..first + 3 {
            let shown = crate::support::frame_picture(&out, frame as usize);
            let luma = f64::from(40 + frame * 7 % 160);
            let expected = (luma - 16.0) * 255.0 / 219.0;
            let found = f64::from(shown.at([20, 40])[1]);
            assert!(
                (found - expected).abs() < 6.0,
                "frame {frame}: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn a_preparation_that_ran_out_of_room_goes_on_when_there_is_some() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([192, 128], 140));
    let (out, undisturbed) = (folder.name("a.foveal"), folder.name("b.foveal"));
    let prepare = |out| {
        [
            "prepare",
            "video",
            &clip,
            "--out",
            out,
            "--tile",
            "64",
            "--quality",
            "24",
            "--calibrate",
            "off",
        ]
    };
    done(&prepare(&undisturbed));
    let whole = std::fs::read(&undisturbed).unwrap();
    // Files may grow to three quarters of what is needed; blocks have 512 bytes.
    let limit = format!("ulimit -f {}", whole.len() * 3 / 4 / 512);
    let mut limited = Command::new("sh");
    let script = format!("trap '' XFSZ; {limit} || exit 77; exec \"$0\" \"$@\"");
    limited.args(["-c", &script, env!("CARGO_BIN_EXE_foveal")]);
    limited.args(prepare(&out));
    let ran = limited.output().unwrap();
    if ran.status.code() == Some(77) {
        skipped("this shell sets no limits, so running out of room was not tried");
        return;
    }
    let mut again = Command::new("sh");
    again.args(["-c", &script, env!("CARGO_BIN_EXE_foveal")]);
    again.args(prepare(&out));
    assert_refused(&finish(again), 1, &["a.foveal", "after", "bytes"]);
    assert_eq!(
        folder.names(),
        [
            "a.foveal.partial",
            "a.foveal.partial.journal",
            "a.mkv",
            "b.foveal"
        ]
    );
    let ran = done(&prepare(&out));
    assert!(ran.stderr.contains("goes on after"), "{}", ran.stderr);
    assert!(std::fs::read(&out).unwrap() == whole);
    assert_eq!(folder.names(), ["a.foveal", "a.mkv", "b.foveal"]);
}

#[test]
fn a_pack_of_a_later_program_is_refused_with_what_to_do() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([64, 48], 2));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let mut bytes = std::fs::read(&pack).unwrap();
    bytes[8] = 2;
    let later = folder.holding("later.foveal", &bytes);
    for command in [&["info", &later][..], &["verify", &later]] {
        refused(1, command, &["later.foveal", "version", "update foveal"]);
    }
}

#[test]
fn decoding_is_the_same_with_and_without_a_wish_for_a_device() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([96, 64], 9));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    for codec in ["vp9", "h264"] {
        let prepare = ["prepare", "video", &clip, "--out", &pack, "--force"];
        done(&[&prepare[..], &["--codec", codec]].concat());
        let play = |decoder: &str| {
            let play = [
                "simulate",
                &pack,
                "--out",
                &out,
                "--renderer",
                "cpu",
                "--frames",
                "2",
            ];
            done(&[&play[..], &["--decoder", decoder]].concat());
            std::fs::read(format!("{out}/frame_00001.png")).unwrap()
        };
        // Tiles this small are not worth the way to a device, so auto is software.
        assert!(play("auto") == play("software"));
        let run = json(&["simulate", &pack, "--out", &out, "--renderer", "none"]);
        assert_eq!(run["decoded_on"]["device"], json!(null));
    }
}

#[test]
fn a_device_that_is_not_there_is_told_with_all_that_was_tried() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([64, 48], 2));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&["prepare", "video", &clip, "--out", &pack, "--codec", "png"]);
    // No device decodes PNG anywhere.
    let play = ["simulate", &pack, "--out", &out, "--decoder", "hardware"];
    refused(1, &play, &["--decoder hardware", "png", "auto or software"]);
    assert!(!std::path::Path::new(&out).exists());
    done(&["prepare", "video", &clip, "--out", &pack, "--force"]);
    let ran = crate::support::foveal(&[&play[..], &["--json"]].concat());
    if ran.code == Some(0) {
        let run = crate::support::json_of(&ran);
        assert!(run["decoded_on"]["device"].is_string(), "{run}");
        assert!(run["decoded_on"]["decoders"].as_u64() > Some(0), "{run}");
    } else {
        assert_refused(&ran, 1, &["--decoder hardware", "vp9", "auto or software"]);
    }
}
