//! Does Foveal report, in every container, that a film lost its end or its beginning, or that it is
//! two films?

use super::film_file::{Film, trimmed};
use super::films::{moving, prepared, remarks, repair};
use crate::support::{Folder, refused};
use ffmpeg_next::format::Pixel;
use serde_json::{Value, json};

/// What is reported of a file with this name and these bytes; asserts that `--strict` refuses one
/// that is mended.
fn told_of(folder: &Folder, name: &str, bytes: &[u8], is_mended: bool) -> Value {
    let file = folder.holding(name, bytes);
    let told = prepared(folder, &file, &[]);
    let out = folder.name("strict.foveal");
    match is_mended {
        true => {
            let strict = ["prepare", "video", &file, "--strict", "--out", &out];
            refused(1, &strict, &[name]);
        }
        false => {
            prepared(folder, &file, &["--strict"]);
        }
    }
    told
}

fn made(folder: &Folder, name: &str, film: &Film<'_>) -> Vec<u8> {
    let path = folder.name(name);
    film.write(&path, moving);
    std::fs::read(path).unwrap()
}

/// Where the mark occurs for the nth time, counted from 0.
fn nth(bytes: &[u8], mark: &[u8], number: usize) -> usize {
    let all = bytes.windows(mark.len()).enumerate();
    let all = all.filter(|(_, it)| *it == mark).map(|(at, _)| at);
    all.clone().nth(number.min(all.count() - 1)).unwrap()
}

/// Where the nth piece of an FLV begins.
fn tag(bytes: &[u8], number: usize) -> usize {
    let mut at = 13;
    for _ in 0..number {
        let [a, b, c] = [1, 2, 3].map(|k| usize::from(bytes[at + k]));
        at += 15 + (a << 16 | b << 8 | c);
    }
    at
}

#[test]
fn a_film_that_ends_between_two_pictures_is_cut_short_in_every_container_that_tells() {
    let folder = Folder::new();
    for (name, encoder, format) in [
        ("a.avi", "mpeg4", Pixel::YUV420P),
        ("b.avi", "mjpeg", Pixel::YUVJ420P),
        ("c.flv", "libx264", Pixel::YUV420P),
        ("d.wmv", "wmv2", Pixel::YUV420P),
        ("e.ogv", "libtheora", Pixel::YUV420P),
    ] {
        let film = Film {
            encoder,
            format,
            frames: 40,
            gop: 10,
            ..Film::default()
        };
        let whole = made(&folder, name, &film);
        let told = told_of(&folder, &format!("whole-{name}"), &whole, false);
        assert_eq!(told["repairs"], json!({}), "{name}: {told}");
        assert_eq!(told["frames"], 40, "{name}: {told}");
        let at = match &name[2..] {
            "avi" => nth(&whole, b"00dc", 20),
            "flv" => tag(&whole, 22),
            // Only the last page says that it is the last.
            "ogv" => nth(&whole, b"OggS", usize::MAX),
            _ => whole.len() * 6 / 10,
        };
        let told = told_of(&folder, &format!("cut-{name}"), &whole[..at], true);
        assert_eq!(repair(&told, "cut_short"), 1, "{name}: {told}");
        let frames = told["frames"].as_u64().unwrap();
        assert!((5..40).contains(&frames), "{name}: {told}");
        assert!(remarks(&told).contains("breaks off after"), "{told}");
    }
}

#[test]
fn frames_that_lean_on_what_lies_before_a_film_are_counted_in_every_container() {
    let folder = Folder::new();
    let open = [(
        "x265-params",
        "log-level=none:open-gop=1:keyint=12:min-keyint=12:bframes=3:b-adapt=0:scenecut=0",
    )];
    let hevc = Film {
        encoder: "libx265",
        options: &open,
        frames: 40,
        b_frames: 3,
        gop: 12,
        ..Film::default()
    };
    let whole = folder.name("whole.mkv");
    hevc.write(&whole, moving);
    for name in ["a.mkv", "a.ts"] {
        let cut = folder.name(name);
        trimmed(&whole, &cut, 14, 0);
        let told = prepared(&folder, &cut, &[]);
        assert_eq!(
            repair(&told, "frames_dropped_at_start"),
            3,
            "{name}: {told}"
        );
    }
    let mpeg2 = Film {
        encoder: "mpeg2video",
        frames: 40,
        gop: 12,
        b_frames: 2,
        ..Film::default()
    };
    for name in ["b.mpg", "b.vob"] {
        let whole = made(&folder, name, &mpeg2);
        let told = told_of(&folder, &format!("whole-{name}"), &whole, false);
        assert_eq!(told["frames"], 40, "{told}");
        let told = told_of(
            &folder,
            &format!("cut-{name}"),
            &whole[whole.len() / 3..],
            true,
        );
        assert!(
            repair(&told, "frames_dropped_at_start") > 0,
            "{name}: {told}"
        );
    }
}

#[test]
fn recordings_that_are_put_behind_each_other_are_no_damage() {
    let folder = Folder::new();
    for (name, encoder) in [
        ("a.ts", "libx264"),
        ("b.ts", "mpeg2video"),
        ("c.mpg", "mpeg2video"),
    ] {
        let of = |frames: u32| Film {
            encoder,
            frames,
            gop: 10,
            b_frames: 2,
            ..Film::default()
        };
        // Shorter than a second, and longer.
        let (short, long) = (made(&folder, name, &of(20)), made(&folder, name, &of(40)));
        let joined = [&long[..], &short, &long].concat();
        let told = told_of(&folder, &format!("joined-{name}"), &joined, false);
        let damage: u64 = [
            "damaged_frames",
            "lost_packets",
            "missing_frames",
            "time_stamps",
        ]
        .iter()
        .map(|it| repair(&told, it))
        .sum();
        assert_eq!(damage, 0, "{name}: {told}");
        assert_eq!(repair(&told, "joined_recordings"), 2, "{name}: {told}");
        assert!(remarks(&told).contains("start again 2 times"), "{told}");
        let frames = told["frames"].as_u64().unwrap();
        assert!((98..=100).contains(&frames), "{name}: {told}");
        let seconds = told["seconds"].as_f64().unwrap();
        assert!((3.8..4.3).contains(&seconds), "{name}: {told}");
    }
}

#[test]
fn a_film_without_its_beginning_is_told_from_one_without_its_end() {
    let folder = Folder::new();
    let film = Film {
        frames: 40,
        gop: 10,
        ..Film::default()
    };
    let whole = made(&folder, "a.mkv", &film);
    let [first, second] = [0, 1].map(|number| nth(&whole, b"\x1f\x43\xb6\x75", number));
    let without = [&whole[..first], &whole[second..]].concat();
    let told = told_of(&folder, "late.mkv", &without, true);
    assert!(
        remarks(&told).contains("at its start: its time stamps begin at"),
        "{told}"
    );
    assert_eq!(told["frames"], 30, "{told}");
    let lost = 40 - told["frames"].as_u64().unwrap();
    assert_eq!(repair(&told, "missing_frames"), lost, "{told}");
    assert_eq!(repair(&told, "cut_short"), 0, "{told}");
}
