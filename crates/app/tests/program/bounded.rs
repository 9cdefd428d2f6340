//! Are time and memory of every command bounded by what it reads?
//!
//! Each case runs with limits on both, so that a hang is a failure and not a slow build.

use crate::scenes::{waves, write_clip, write_clip_at};
use crate::support::{Folder, Ran, assert_refused, command, done, finish, skipped};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::pack::{HEADER_BYTES, Header};
use foveal_core::view::picture::Picture;
use serde_json::{Value, json};
use std::process::Command;

/// A run with at most so many seconds of processor time and KiB of memory.
pub(crate) fn within([seconds, kib]: [u32; 2], arguments: &[&str]) -> Ran {
    let plain = command(arguments);
    let mut limited = Command::new("sh");
    limited.args([
        "-c",
        &format!("ulimit -t {seconds}; ulimit -v {kib}; exec \"$@\""),
        "sh",
    ]);
    limited.arg(plain.get_program()).args(plain.get_args());
    finish(limited)
}

fn value_of(ran: &Ran) -> Value {
    assert_eq!(ran.code, Some(0), "{ran:?}");
    serde_json::from_str(&ran.stdout).unwrap()
}

/// A pack of 30 frames at these ticks of a frame rate.
fn pack_at(folder: &Folder, name: &str, rate: [i32; 2], step: u64) -> String {
    let pictures: Vec<Picture> = waves([64, 64], 30);
    let ticks: Vec<u64> = (0..30).map(|frame| frame * step).collect();
    let clip = write_clip_at(folder, &format!("{name}.mkv"), &pictures, rate, &ticks);
    let pack = folder.name(&format!("{name}.foveal"));
    done(&[
        "prepare", "video", &clip, "--out", &pack, "--tile", "64", "--fast",
    ]);
    pack
}

#[test]
fn a_gap_in_time_costs_nothing() {
    let folder = Folder::new();
    let day = 25 * 86_400;
    let packs = [
        ("second", 1),
        ("day", day),
        ("month", 31 * day),
        ("years", 9 * 365 * day),
    ];
    for (name, step) in packs {
        let pack = pack_at(&folder, name, [25, 1], step);
        for gaze in ["scan", "center"] {
            let out = folder.name(&format!("{name}-{gaze}"));
            let arguments = [
                "simulate",
                &pack,
                "--out",
                &out,
                "--gaze",
                gaze,
                "--policy",
                "acuity",
                "--renderer",
                "none",
                "--pictures",
                "none",
                "--json",
            ];
            let ran = value_of(&within([20, 2_000_000], &arguments));
            assert_eq!(ran["frames"], 30, "{name}");
            let log = format!("{out}/session.jsonl");
            let again = value_of(&within([20, 2_000_000], &["replay", &log, "--json"]));
            assert_eq!(again["same"], true, "{name}");
        }
    }
}

/// The parts of a small pack: what it says of itself can be changed.
struct Parts {
    header: Header,
    about: Value,
}

impl Parts {
    fn of(folder: &Folder) -> Self {
        let clip = write_clip(folder, "small.mkv", &waves([128, 64], 2));
        let pack = folder.name("small.foveal");
        done(&[
            "prepare", "video", &clip, "--out", &pack, "--tile", "64", "--fast",
        ]);
        let bytes = std::fs::read(&pack).unwrap();
        let header = Header::parse(&bytes).unwrap();
        let end = HEADER_BYTES + header.description_bytes as usize;
        let about = serde_json::from_slice(&bytes[HEADER_BYTES..end]).unwrap();
        Self { header, about }
    }

    /// Header and description of a pack of so many frames, each a group of its own, with nothing
    /// but `data` before its index.
    fn of_frames(&self, frames: u32, data: u64) -> (Header, Vec<u8>) {
        let mut about = self.about.clone();
        about["frames"] = frames.into();
        let groups = about["groups"].as_array().unwrap().len();
        about["groups"] = json!(vec![1; groups]);
        about["tables"] = json!([]);
        let mut description = serde_json::to_vec(&about).unwrap();
        description.resize(self.header.description_bytes as usize, b' ');
        let mut header = Header {
            description_crc: crc32c(&description),
            index_offset: self.header.data_offset() + data,
            index_bytes: 0,
            ..self.header
        };
        // The message names the bytes that the index of these units takes when others are given.
        let refused = VideoPack::begin(&header, &description).unwrap_err();
        header.index_bytes = refused.expected.split(' ').next().unwrap().parse().unwrap();
        header.file_bytes = header.index_offset + header.index_bytes;
        (header, description)
    }
}

/// CRC-32C (Castagnoli) as packs have it.
pub(crate) fn crc32c(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0x82f6_3b78 * (crc & 1))
        })
    })
}

#[test]
fn chunks_that_lie_on_one_place_are_told_of_and_not_read() {
    let folder = Folder::new();
    let parts = Parts::of(&folder);
    let chunk = vec![7_u8; 1 << 20];
    let (header, description) = parts.of_frames(60_000, chunk.len() as u64);
    let pack = VideoPack::begin(&header, &description).unwrap();
    let pages = pack.index().numbers().pages();
    assert!(pack.units().len() >= 200_000, "{}", pack.units().len());
    let crc = crc32c(&chunk);
    let mut bytes = [&header.write()[..], &description, &chunk].concat();
    for (page, units) in (0_u32..).zip(pages) {
        let head = [page, units.start, units.len() as u32];
        let mut rows: Vec<u8> = Vec::new();
        for _ in units {
            rows.extend(header.data_offset().to_le_bytes());
            rows.extend((chunk.len() as u32).to_le_bytes());
            rows.extend(crc.to_le_bytes());
        }
        let head: Vec<u8> = head.iter().flat_map(|word| word.to_le_bytes()).collect();
        let page_crc = crc32c(&[&head[..], &rows].concat());
        bytes.extend(head);
        bytes.extend(page_crc.to_le_bytes());
        bytes.extend(rows);
    }
    let path = folder.holding("one-place.foveal", &bytes);
    let ran = within([20, 1_000_000], &["verify", &path, "--json"]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let told: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(told["damaged_places"], 1, "{told}");
    assert!(
        told["damage"][0].as_str().unwrap().contains("chunks"),
        "{told}"
    );
    let site = folder.name("site");
    let ran = within([60, 4_000_000], &["export", "site", &path, "--out", &site]);
    if ran.stderr.contains("built without its pages") {
        return skipped("the program was built without its pages, so no site was exported");
    }
    assert!(ran.stderr.contains("chunks"), "{ran:?}");
}

#[test]
fn an_index_that_is_claimed_is_read_no_further_than_its_first_wrong_page() {
    let folder = Folder::new();
    let parts = Parts::of(&folder);
    let (header, description) = parts.of_frames(1 << 24, 0);
    assert!(header.index_bytes > 1 << 30, "{header:?}");
    let begin = [&header.write()[..], &description].concat();
    let path = folder.holding("claims.foveal", &begin);
    let file = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
    file.set_len(header.file_bytes).unwrap();
    for command in ["info", "verify"] {
        let ran = within([20, 400_000], &[command, &path]);
        assert_refused(&ran, 1, &["index page 0"]);
    }
}

#[test]
fn reserved_bytes_of_the_header_are_zeros_or_the_pack_is_refused() {
    let folder = Folder::new();
    let parts = Parts::of(&folder);
    let good = std::fs::read(folder.name("small.foveal")).unwrap();
    assert_eq!(parts.header, Header::parse(&good).unwrap());
    for (place, words) in [
        (20, "reserved bytes 20 to 23"),
        (59, "reserved bytes 48 to 59"),
    ] {
        let mut bad = good.clone();
        bad[place] = 1;
        let crc = crc32c(&bad[..60]);
        bad[60..64].copy_from_slice(&crc.to_le_bytes());
        let path = folder.holding("bad.foveal", &bad);
        assert_refused(&within([20, 1_000_000], &["info", &path]), 1, &[words]);
    }
}

#[test]
fn nothing_that_a_terminal_obeys_is_shown_of_a_name() {
    let folder = Folder::new();
    let name = "a\u{1b}[2J\u{202e}b\u{9b}.foveal";
    let path = folder.holding(
        name,
        b"no pack, but long enough to have a header of 64 bytes.........",
    );
    let shown = ["\\u{1b}[2J\\u{202e}b\\u{9b}.foveal"];
    for command in ["info", "verify", "replay"] {
        let ran = within([20, 2_000_000], &[command, &path]);
        assert_refused(&ran, 1, &shown);
        assert!(
            !ran.stderr.contains(['\u{1b}', '\u{202e}', '\u{9b}']),
            "{ran:?}"
        );
    }
    let wrong = format!("--{name}");
    let ran = within([20, 2_000_000], &["info", &wrong]);
    assert_refused(&ran, 2, &["\\u{202e}b\\u{9b}.foveal"]);
    assert!(!ran.stderr.contains('\u{1b}'), "{ran:?}");
}

#[test]
fn a_log_that_is_written_otherwise_replays_the_same_selection() {
    let folder = Folder::new();
    let pack = pack_at(&folder, "plain", [25, 1], 1);
    let out = folder.name("out");
    done(&[
        "simulate",
        &pack,
        "--out",
        &out,
        "--policy",
        "acuity",
        "--renderer",
        "none",
        "--pictures",
        "none",
        "--frames",
        "3",
    ]);
    let text = std::fs::read_to_string(format!("{out}/session.jsonl")).unwrap();
    let spaced = folder.holding("spaced.jsonl", text.replacen('{', "{ ", 1).as_bytes());
    let ran = within([20, 2_000_000], &["replay", &spaced]);
    assert_refused(&ran, 1, &["the same selection, written otherwise"]);
}

#[test]
fn a_line_of_two_gigabytes_is_refused_by_its_line() {
    let folder = Folder::new();
    let path = folder.holding("long.csv", b"t_s,yaw_deg,pitch_deg\n0,1,2\n");
    let file = std::fs::File::options().write(true).open(&path).unwrap();
    file.set_len(1 << 31).unwrap();
    let gaze = format!("trace:{path}");
    let select = ["select", "--projection", "cube", "--face-size", "256"];
    let arguments = [&select[..], &["--gaze", &gaze]].concat();
    let words = ["long.csv", "line 3", "longer than 65536 bytes"];
    assert_refused(&within([20, 1_500_000], &arguments), 1, &words);
}

#[test]
fn a_file_of_a_tebibyte_of_nothing_is_refused_in_little_memory() {
    let folder = Folder::new();
    let sparse = |name: &str| {
        let path = folder.holding(name, b"");
        let file = std::fs::File::options().write(true).open(&path).unwrap();
        file.set_len(1 << 40).unwrap();
        path
    };
    for ending in ["obj", "ply", "stl", "gltf", "las"] {
        let path = sparse(&format!("nothing.{ending}"));
        let out = folder.name("nothing.foveal");
        let ran = within([20, 1_000_000], &["prepare", "scene", &path, "--out", &out]);
        assert_refused(&ran, 1, &[&format!("nothing.{ending}")]);
    }
    for ending in ["mjpeg", "h264", "ts"] {
        let path = sparse(&format!("nothing.{ending}"));
        let ran = within(
            [60, 3_000_000],
            &[
                "prepare",
                "video",
                &path,
                "--out",
                &folder.name("nothing.foveal"),
            ],
        );
        assert_refused(&ran, 1, &[&format!("nothing.{ending}")]);
    }
}

#[test]
fn where_the_system_opens_no_more_files_a_line_says_so_and_what_to_do() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "small.mkv", &waves([64, 64], 2));
    let out = folder.name("small.foveal");
    let told = |files: u32| {
        let plain = command(&["prepare", "video", &clip, "--out", &out, "--force"]);
        let mut limited = Command::new("sh");
        let script = format!("ulimit -n {files}; exec \"$@\"");
        limited.args(["-c", &script, "sh"]).arg(plain.get_program());
        limited.args(plain.get_args());
        finish(limited)
    };
    let all: Vec<Ran> = (4..14).map(told).collect();
    // With fewest the loader of the system finds no library, before the program begins.
    let is_told = |ran: &&Ran| ran.code == Some(1) && ran.stderr.contains("`ulimit -n 4096`");
    let told: Vec<&Ran> = all.iter().filter(is_told).collect();
    assert!(!told.is_empty(), "{all:?}");
    assert!(
        told.iter().any(|ran| ran.stderr.contains("small.")),
        "{told:?}"
    );
}

/// A pack's bytes, of whose first chunk the second half is `with`, and all its checksums are right.
fn with_other_chunk(pack: &[u8], with: u8) -> Vec<u8> {
    let header = Header::parse(pack).unwrap();
    let mut bytes = pack.to_vec();
    let page = header.index_offset as usize;
    let word = |at: usize| u32::from_le_bytes(pack[at..at + 4].try_into().unwrap()) as usize;
    let (rows, units) = (page + 16, word(page + 8));
    let chunk = word(rows)..word(rows) + word(rows + 8);
    bytes[chunk.start + chunk.len() / 2..chunk.end].fill(with);
    let crc = crc32c(&bytes[chunk]).to_le_bytes();
    bytes[rows + 12..rows + 16].copy_from_slice(&crc);
    let all = [&bytes[page..page + 12], &bytes[rows..rows + 16 * units]].concat();
    bytes[page + 12..page + 16].copy_from_slice(&crc32c(&all).to_le_bytes());
    bytes
}

#[test]
fn a_coarsest_unit_that_does_not_decode_is_found_though_its_checksum_is_right() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "clip.mkv", &waves([128, 64], 10));
    let pack = folder.name("clip.foveal");
    for codec in ["png", "jpeg", "h264", "vp9"] {
        let prepare = [
            "prepare", "video", &clip, "--out", &pack, "--force", "--fast",
        ];
        done(&[&prepare[..], &["--levels", "1", "--codec", codec]].concat());
        let whole = std::fs::read(&pack).unwrap();
        done(&["verify", &pack]);
        let path = folder.holding("altered.foveal", &with_other_chunk(&whole, 0xff));
        let ran = within([20, 2_000_000], &["verify", &path, "--json"]);
        // Other decoders may make pictures of anything.
        if ["h264", "vp9"].contains(&codec) && ran.code == Some(0) {
            continue;
        }
        assert_eq!(ran.code, Some(1), "{codec}: {ran:?}");
        let told: Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!(told["damaged_places"], 1, "{told}");
        let damage = told["damage"][0].as_str().unwrap();
        for words in ["chunk of level 0, frames from 0", "pictures that decode"] {
            assert!(damage.contains(words), "{codec}: {damage}");
        }
    }
}
