//! Is damage to a pack always reported, and never fatal to the program?

use crate::scenes::{noise, waves, write_clip};
use crate::support::{Folder, done, finish, foveal, has_dev_full, json, json_of, refused};
use serde_json::json;

/// Places that the program is tried on; every byte is tried in `foveal-media`.
const PLACES: usize = 100;

fn small_pack(folder: &Folder, codec: &str) -> String {
    let clip = write_clip(folder, "a.mkv", &waves([96, 64], 9));
    let pack = folder.name("a.foveal");
    let how = ["--codec", codec, "--tile", "32", "--levels", "2"];
    let prepare = ["prepare", "video", &clip, "--out", &pack, "--force"];
    done(&[&prepare[..], &how].concat());
    pack
}

#[test]
fn a_flipped_byte_is_found_by_verify_and_survived_by_every_command() {
    let folder = Folder::new();
    let pack = small_pack(&folder, "vp9");
    let good = std::fs::read(&pack).unwrap();
    let out = folder.name("out");
    for turn in 0..PLACES {
        // Half of them spread over the file, half over the densest part, the header.
        let place = match turn % 2 {
            0 => turn * good.len() / PLACES,
            _ => turn * 300 / PLACES,
        };
        let mut bad = good.clone();
        bad[place] ^= 1 << (turn % 8);
        let path = folder.holding("bad.foveal", &bad);
        let verified = foveal(&["verify", &path, "--json"]);
        assert_eq!(verified.code, Some(1), "byte {place}");
        assert!(
            verified.stderr.contains("bad.foveal"),
            "{}",
            verified.stderr
        );
        // Each of the others is tried on every other place.
        let ran = match turn % 4 {
            0 | 1 => foveal(&["info", &path, "--json"]),
            _ => {
                let renderer = ["--renderer", if turn % 8 == 2 { "cpu" } else { "none" }];
                let play = [
                    "simulate", &path, "--out", &out, "--policy", "full", "--json",
                ];
                foveal(&[&play[..], &renderer].concat())
            }
        };
        if ran.code == Some(0) {
            json_of(&ran);
            let found = json_of(&verified);
            assert_eq!(found["ok"], json!(false));
            assert!(!found["damage"].as_array().unwrap().is_empty());
        } else {
            assert!(ran.stderr.contains("bad.foveal"), "{}", ran.stderr);
        }
    }
}

#[test]
fn a_damaged_fine_tile_is_stood_in_for_and_counted() {
    let folder = Folder::new();
    for codec in ["vp9", "jpeg", "png"] {
        let pack = small_pack(&folder, codec);
        let mut bytes = std::fs::read(&pack).unwrap();
        let info = json(&["info", &pack]);
        let of_level = |level: usize| info["bytes_per_level"][level].as_u64().unwrap() as usize;
        // The coarsest level of all nine frames is one chunk, which comes first.
        let head = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize + 64;
        let inside_a_fine_chunk = head + of_level(1) + 60;
        bytes[inside_a_fine_chunk] ^= 0x10;
        let bad = folder.holding("bad.foveal", &bytes);
        let out = folder.name("out");
        let play = ["simulate", &bad, "--out", &out, "--policy", "full"];
        let run = json(&[&play[..], &["--pictures", "none"]].concat());
        assert_eq!(
            run["damaged_tiles"],
            json!(8),
            "{codec}: the tile's group of frames"
        );
        assert_eq!(run["wrong_frame_tiles"], json!(0));
        // Without the coarsest level there is nothing to show.
        bytes[head + of_level(1) / 2] ^= 0x10;
        let worse = folder.holding("worse.foveal", &bytes);
        let play = ["simulate", &worse, "--out", &out, "--renderer", "none"];
        refused(1, &play, &["worse.foveal", "coarsest", "prepare it again"]);
    }
}

#[test]
fn what_is_no_pack_is_refused_by_every_command() {
    let folder = Folder::new();
    let pack = small_pack(&folder, "png");
    let good = std::fs::read(&pack).unwrap();
    let clip = folder.name("a.mkv");
    let empty = folder.holding("empty.foveal", b"");
    let text = folder.holding(
        "text.foveal",
        b"this is no pack, it is a piece of text of 64 bytes...",
    );
    let cut = folder.holding("cut.foveal", &good[..good.len() - 1]);
    let missing = folder.name("missing.foveal");
    let out = folder.name("out");
    let folder_name = folder.name(".");
    for path in [&clip, &empty, &text, &cut, &missing, &folder_name] {
        let name = std::path::Path::new(path.as_str());
        for command in [
            &["info", path][..],
            &["verify", path],
            &["simulate", path, "--out", &out],
        ] {
            let ran = refused(1, command, &[name.to_str().unwrap()]);
            assert!(ran.stdout.is_empty(), "{}", ran.stdout);
        }
    }
    assert!(!std::path::Path::new(&out).exists());
}

#[test]
fn results_that_nobody_can_take_are_told() {
    if !has_dev_full() {
        return;
    }
    let folder = Folder::new();
    let pack = small_pack(&folder, "png");
    let mut command = crate::support::command(&["info", &pack, "--json"]);
    command.stdout(std::fs::File::create("/dev/full").unwrap());
    let ran = finish(command);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stderr.contains("No space left"), "{}", ran.stderr);
}

#[test]
fn a_clip_of_noise_in_every_codec_verifies() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &[noise([70, 50], 0), noise([70, 50], 1)]);
    for codec in ["vp9", "jpeg", "png"] {
        let pack = folder.name(&format!("{codec}.foveal"));
        done(&["prepare", "video", &clip, "--out", &pack, "--codec", codec]);
        assert_eq!(json(&["verify", &pack])["ok"], json!(true));
    }
}
