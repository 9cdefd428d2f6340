//! What becomes of a pack that lies where another is to go?

use crate::scenes::{noisy_clip, waves, write_clip};
use crate::support::{Folder, done, json, refused};
use foveal_core::pack::{HEADER_BYTES, Header};
use serde_json::{Value, json};

fn prepare<'a>(input: &'a str, out: &'a str) -> [&'a str; 7] {
    ["prepare", "video", input, "--out", out, "--tile", "32"]
}

/// Whether a file is what it was: the same bytes, never written again.
struct Kept<'a> {
    path: &'a str,
    bytes: Vec<u8>,
    modified: std::time::SystemTime,
}

impl<'a> Kept<'a> {
    fn of(path: &'a str) -> Self {
        Self {
            path,
            bytes: std::fs::read(path).unwrap(),
            modified: std::fs::metadata(path).unwrap().modified().unwrap(),
        }
    }

    fn assert(&self) {
        let now = Self::of(self.path);
        assert!(self.bytes == now.bytes, "{} has other bytes", self.path);
        assert_eq!(self.modified, now.modified, "{}", self.path);
    }
}

#[test]
fn the_same_preparation_is_done_already_and_writes_nothing() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let out = folder.name("a.foveal");
    let mut first = json(&prepare(&clip, &out));
    assert_eq!(first["already_there"], json!(false));
    let kept = Kept::of(&out);
    let roundabout = folder.name("./a.mkv");
    for again in [
        prepare(&clip, &out).to_vec(),
        prepare(&roundabout, &out).to_vec(),
        [&prepare(&clip, &out)[..], &["--jobs", "1", "--no-resume"]].concat(),
    ] {
        let ran = done(&again);
        assert_eq!(ran.stdout.lines().count(), 1, "{}", ran.stdout);
        assert!(ran.stdout.contains("a.foveal: already exists"));
        assert_eq!(ran.stderr, "");
        kept.assert();
    }
    first["already_there"] = json!(true);
    assert_eq!(json(&prepare(&clip, &out)), first);
    assert_eq!(folder.names(), ["a.foveal", "a.mkv"]);
}

#[test]
fn a_pack_of_anything_else_is_refused_before_any_work_and_stays() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let other = write_clip(&folder, "b.mkv", &waves([64, 48], 2));
    let out = folder.name("a.foveal");
    done(&prepare(&clip, &out));
    let kept = Kept::of(&out);
    let refuse = |with: &[&str], how: &str| {
        let words = ["--out", "a.foveal", "a.mkv (64x48)", how, "--force"];
        let ran = refused(2, with, &words);
        assert_eq!((ran.stdout.as_str(), ran.stderr.lines().count()), ("", 1));
        kept.assert();
    };
    refuse(&prepare(&other, &out), "of another input");
    let frames = [&prepare(&clip, &out)[..], &["--frames", "1"]].concat();
    refuse(&frames, "with other settings");
    write_clip(&folder, "a.mkv", &noisy_clip([64, 48], 2));
    refuse(&prepare(&clip, &out), "before it changed");
    assert_eq!(folder.names(), ["a.foveal", "a.mkv", "b.mkv"]);
}

/// CRC32C bit by bit.
fn crc32c(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| crc >> 1 ^ if crc & 1 == 1 { 0x82f6_3b78 } else { 0 };
    let byte = |crc: u32, byte: &u8| (0..8).fold(crc ^ u32::from(*byte), |crc, _| bit(crc));
    !bytes.iter().fold(!0, byte)
}

/// A pack with another description of the same length.
fn described_otherwise(pack: &[u8], change: impl Fn(&str) -> String) -> Vec<u8> {
    let mut header = Header::parse(&pack[..HEADER_BYTES]).unwrap();
    let chunks = HEADER_BYTES + header.description_bytes as usize;
    let text = std::str::from_utf8(&pack[HEADER_BYTES..chunks]).unwrap();
    let text = change(text);
    assert_eq!(text.len(), chunks - HEADER_BYTES);
    header.description_crc = crc32c(text.as_bytes());
    [&header.write()[..], text.as_bytes(), &pack[chunks..]].concat()
}

#[test]
fn a_pack_of_an_older_program_or_a_damaged_one_is_another() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let out = folder.name("a.foveal");
    done(&prepare(&clip, &out));
    let pack = std::fs::read(&out).unwrap();
    let silent = described_otherwise(&pack, |text| text.replace("\"identity\"", "\"unknowns\""));
    // Within what is coded.
    let mut flipped = pack.clone();
    flipped[4096] ^= 1;
    let text = String::from_utf8_lossy(&pack[HEADER_BYTES..]);
    let description: Value = serde_json::Deserializer::from_str(&text)
        .into_iter()
        .next()
        .unwrap()
        .unwrap();
    let program = description["identity"]["program"].as_str().unwrap();
    let older = described_otherwise(&pack, |text| {
        text.replace(program, &program.replace("foveal", "elder "))
    });
    for (bytes, how) in [
        (&silent[..], "does not say how it was made"),
        (&older, "another version of the program"),
        (&pack[..pack.len() - 1], "damaged"),
        (&flipped, "damaged"),
    ] {
        std::fs::write(&out, bytes).unwrap();
        let kept = Kept::of(&out);
        refused(2, &prepare(&clip, &out), &["a.foveal", how, "--force"]);
        kept.assert();
    }
    // The pack gives away no folder.
    let here = folder.to_str().unwrap();
    assert!(!text.contains(here), "the pack names {here}");
}

#[test]
fn force_replaces_a_pack_once_the_new_one_is_whole() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([128, 96], 20));
    let bytes = std::fs::read(&clip).unwrap();
    let cut = folder.holding("cut.mkv", &bytes[..bytes.len() / 2]);
    let other = write_clip(&folder, "b.mkv", &waves([64, 48], 2));
    let out = folder.name("a.foveal");
    done(&prepare(&other, &out));
    let kept = Kept::of(&out);
    let force = |input| [&prepare(input, &out)[..], &["--force"]].concat();
    let strict = [&force(&cut)[..], &["--strict"]].concat();
    refused(1, &strict, &["broken at frame"]);
    kept.assert();
    let replaced = json(&force(&clip));
    assert_eq!(replaced["already_there"], json!(false));
    assert_eq!(json(&["info", &out])["source"], json!("a.mkv"));
    assert_eq!(json(&["verify", &out])["ok"], json!(true));
    // The new one is as if there had been none, and is made again where that is asked for.
    let fresh = folder.name("fresh.foveal");
    done(&prepare(&clip, &fresh));
    assert!(std::fs::read(&fresh).unwrap() == std::fs::read(&out).unwrap());
    assert_eq!(json(&force(&clip))["already_there"], json!(false));
    let names = ["a.foveal", "a.mkv", "b.mkv", "cut.mkv", "fresh.foveal"];
    assert_eq!(folder.names(), names);
}

#[test]
fn what_is_no_pack_is_refused_and_not_even_force_removes_it() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let diary = folder.holding("diary.foveal", b"Dear diary, today I made no video.\n");
    let kept = folder.name("kept.foveal");
    std::fs::create_dir(&kept).unwrap();
    let inside = folder.holding("kept.foveal/precious.txt", b"mine");
    let (diary_kept, inside_kept) = (Kept::of(&diary), Kept::of(&inside));
    for force in [&[][..], &["--force"]] {
        for (out, what) in [(&diary, "a file"), (&kept, "a folder")] {
            let words = [out.as_str(), what, "not a pack", "--force"];
            refused(2, &[&prepare(&clip, out)[..], force].concat(), &words);
        }
    }
    diary_kept.assert();
    inside_kept.assert();
    let names = ["a.mkv", "diary.foveal", "kept.foveal"];
    assert_eq!(folder.names(), names);
}

#[test]
fn the_folder_of_a_run_is_written_over() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let (pack, run) = (folder.name("a.foveal"), folder.name("run"));
    done(&prepare(&clip, &pack));
    for _ in 0..2 {
        let play = ["simulate", &pack, "--renderer", "none", "--out", &run];
        assert_eq!(json(&play)["frames"], json!(2));
    }
}
