//! Do the commands about packs print what is documented?

use super::agrees;
use crate::scenes::{waves, write_clip};
use crate::support::{Folder, done, json, json_of, refused, skipped};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// An AVI file of two grey pictures of 32x32, 25 a second, and 8000 moments a second of silence.
fn sounding_clip(folder: &Folder) -> String {
    fn chunk(name: &[u8; 4], bytes: &[u8]) -> Vec<u8> {
        [name, &(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
    }
    fn list(name: &[u8; 4], chunks: &[Vec<u8>]) -> Vec<u8> {
        chunk(b"LIST", &[&name[..], &chunks.concat()].concat())
    }
    fn numbers(numbers: &[u32]) -> Vec<u8> {
        numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
    }
    fn stream(kind: [&[u8; 4]; 2], timing: &[u32], format: &[u8]) -> Vec<u8> {
        let head = [&kind[0][..], kind[1], &numbers(timing)].concat();
        list(b"strl", &[chunk(b"strh", &head), chunk(b"strf", format)])
    }
    let (picture, sound) = ([128; 32 * 32 * 3 / 2], [0; 2 * 320]);
    // BITMAPINFOHEADER and WAVEFORMATEX.
    let format = [
        40,
        32,
        32,
        1 | 12 << 16,
        u32::from_le_bytes(*b"I420"),
        1536,
        0,
        0,
        0,
        0,
    ];
    let wave = numbers(&[1 | 1 << 16, 8000, 16_000, 2 | 16 << 16]);
    // Flags to the buffer's size: scale, rate, start, length, size, quality, sample size, frame.
    let video = [0, 0, 0, 1, 25, 0, 2, 1536, 0, 0, 0, 32 | 32 << 16];
    let audio = [0, 0, 0, 2, 16_000, 0, 640, 640, 0, 2, 0, 0];
    let headers = list(
        b"hdrl",
        &[
            chunk(
                b"avih",
                &numbers(&[40_000, 0, 0, 0, 2, 0, 2, 1536, 32, 32, 0, 0, 0, 0]),
            ),
            stream([b"vids", b"I420"], &video, &numbers(&format)),
            stream([b"auds", &[0; 4]], &audio, &wave),
        ],
    );
    let frame = [chunk(b"00db", &picture), chunk(b"01wb", &sound)].concat();
    let movie = list(b"movi", &[frame.clone(), frame]);
    let bytes = chunk(b"RIFF", &[b"AVI ", &headers[..], &movie].concat());
    folder.holding("clip.avi", &bytes)
}

#[test]
fn a_pack_is_told_of_as_documented() {
    let folder = Folder::new();
    let clip = sounding_clip(&folder);
    let (pack, grid) = (folder.name("a.foveal"), folder.name("grid.foveal"));
    let how = [
        "prepare",
        "video",
        &clip,
        "--fast",
        "--projection",
        "flat",
        "--out",
    ];
    let tiles = json(&[&how[..], &[&pack, "--tile", "16", "--bitrate", "200kbit"]].concat());
    assert!(tiles["sound"].is_object(), "{tiles}");
    let cells = json(&[&how[..], &[&grid, "--grid", "2x2"]].concat());
    // A name without the usual ending is warned of.
    let unusual = folder.name("unusual");
    let dry = json(&[&how[..], &[&unusual, "--dry-run"]].concat());
    // 32 pixels are too few for a score.
    assert!(tiles["loss"].is_null(), "{tiles}");
    let larger = write_clip(&folder, "b.mkv", &waves([64, 48], 1));
    let judged = folder.name("judged.foveal");
    let of_eyes = ["--fast", "--calibrate", "usual", "--out", &judged];
    let lossy = json(&[&["prepare", "video", &larger], &of_eyes[..]].concat());
    let again = folder.name("again.foveal");
    agrees(
        "calibrate",
        &[&json(&["calibrate", &judged, "--out", &again])],
    );
    let whole = std::fs::read(write_clip(&folder, "c.mkv", &waves([64, 48], 9))).unwrap();
    let cut = folder.holding("cut.mkv", &whole[..whole.len() / 2]);
    let mended = folder.name("mended.foveal");
    let cut = json(&["prepare", "video", &cut, "--fast", "--out", &mended]);
    agrees("prepare video", &[&tiles, &cells, &lossy, &cut, &dry]);
    let info = [&pack, &grid, &judged, &mended].map(|pack| json(&["info", pack]));
    agrees("info", &info.each_ref());

    agrees("prepare formats", &[&json(&["prepare", "formats"])]);

    let whole = json(&["verify", &pack]);
    let mut bytes = std::fs::read(&pack).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    let damaged = folder.holding("damaged.foveal", &bytes);
    let found = json_of(&refused(
        1,
        &["verify", &damaged, "--json"],
        &["damaged place"],
    ));
    assert_eq!(found["error"]["where"], damaged.as_str());
    let mut found = found;
    found.as_object_mut().unwrap().remove("error");
    agrees("verify", &[&whole, &found]);
}

/// Three panels in a row.
const THREE: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "L"
eye = "left"
pixels = [64, 48]
pose = { order = "yaw-pitch-roll", yaw = -35 }
size = [0.9, 0.675]
[[panel]]
id = "C"
eye = "left"
pixels = [64, 48]
size = [0.9, 0.675]
[[panel]]
id = "R"
eye = "left"
pixels = [64, 48]
pose = { order = "yaw-pitch-roll", yaw = 35 }
size = [0.9, 0.675]
"#;

#[test]
fn what_is_chosen_and_played_is_told_of_as_documented() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([96, 64], 2));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&[
        "prepare", "video", &clip, "--fast", "--tile", "32", "--out", &pack,
    ]);
    let choose = ["select", "--projection", "cube", "--face-size", "256"];
    let one = json(&choose);
    let many = json(&[&choose[..], &["--random-gazes", "3"]].concat());
    let rig = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/panels/six.toml"
    );
    let panels = json(&[&choose[..], &["--panels", rig]].concat());
    agrees("select", &[&one, &many, &panels]);
    let play = [
        "simulate",
        &pack,
        "--out",
        &out,
        "--gaze",
        "0,0",
        "--pictures",
        "none",
    ];
    let drawn = ["--renderer", "cpu", "--score"];
    let alone = json(&[&play[..], &drawn].concat());
    let three = folder.holding("three.toml", THREE.as_bytes());
    let on_panels = json(&[&play[..], &drawn, &["--panels", &three]].concat());
    agrees("simulate", &[&alone, &on_panels]);
    let log = format!("{out}/session.jsonl");
    agrees("replay", &[&json(&["replay", &log, "--pack", &pack])]);
}

#[test]
fn a_site_is_told_of_as_documented() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 1));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--fast", "--out", &pack]);
    let about = b"[a]\ndescription = \"waves\"\nlicence = \"CC0\"\n";
    let about = folder.holding("about.toml", about);
    let export = [
        "export",
        "site",
        &pack,
        "--dry-run",
        "--about",
        &about,
        "--out",
        &folder.name("site"),
        "--json",
    ];
    let ran = crate::support::foveal(&export);
    if ran.stderr.contains("built without its pages") {
        skipped("the program carries no pages; run `cargo xtask web` and build again");
    } else {
        agrees("export site", &[&json_of(&ran)]);
    }
    folder.holding("index.html", b"");
    let here = folder.name(".");
    let mut serve = crate::support::command(&["serve", &here, "--listen", "127.0.0.1:0", "--json"]);
    let mut running = serve.stdout(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    let stdout = running.stdout.take().unwrap();
    BufReader::new(stdout).read_line(&mut line).unwrap();
    running.kill().unwrap();
    running.wait().unwrap();
    agrees("serve", &[&serde_json::from_str(&line).unwrap()]);
}
