//! Does a user who gives the wrong words learn the right ones?

use crate::scenes::write_clip;
use crate::support::{Folder, foveal, json, refused};
use foveal_media::generate::numbered_tiles;

const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_file_that_another_command_reads_is_told_with_that_command() {
    let folder = Folder::new();
    let film = write_clip(&folder, "film.mkv", &[numbered_tiles([64, 48], 16, 0)]);
    let mesh = folder.holding("mesh.obj", TRIANGLE);
    let (pack, out) = (folder.name("mesh.foveal"), folder.name("never.foveal"));
    let made = foveal(&["prepare", "scene", &mesh, "--out", &pack]);
    assert_eq!(made.code, Some(0), "{made:?}");
    let prepare = |kind: &str, file: &str, words: &[&str]| {
        refused(2, &["prepare", kind, file, "--out", &out], words);
    };
    prepare("video", &mesh, &["3D file", "foveal prepare scene"]);
    prepare(
        "scene",
        &film,
        &["video or a picture", "foveal prepare video"],
    );
    for kind in ["video", "scene"] {
        prepare(kind, &pack, &["is a pack already", "foveal view"]);
    }
    for (file, meant) in [
        (&film, "foveal prepare video"),
        (&mesh, "foveal prepare scene"),
    ] {
        refused(2, &["prepare", file], &["tip: ", meant, file]);
        let ran = foveal(&["prepare", file, "--json"]);
        assert!(ran.stdout.contains(meant), "{ran:?}");
    }
    refused(2, &[&film], &["tip: ", "foveal prepare video"]);
    refused(2, &[&pack], &["tip: ", "foveal view"]);
    // A file of neither kind is refused as before.
    let text = folder.holding("a.txt", b"nothing");
    refused(
        1,
        &["prepare", "scene", &text, "--out", &out],
        &["not a 3D file"],
    );
    refused(2, &["prepare", "vido"], &["unrecognized subcommand"]);
}

#[test]
fn an_address_in_place_of_a_file_is_told_to_be_downloaded() {
    let address = "https://example.com/film.mp4";
    for command in [
        &["prepare", "video", address, "--out", "never.foveal"][..],
        &[
            "prepare",
            "scene",
            "HTTP://example.com/a.glb",
            "--out",
            "never.foveal",
        ],
        &["info", address],
        &["simulate", address, "--out", "never"],
        &["panels", "fit", "http://example.com/rig.toml"],
    ] {
        refused(1, command, &["is an address", "curl -LO"]);
    }
}

#[test]
fn rates_of_links_are_read_however_they_are_written() {
    for rate in ["1Mbit", "1mbit", "4MBit/s", "4 Mbps", "4G"] {
        let ran = foveal(&["simulate", "none.foveal", "--out", "never", "--link", rate]);
        assert!(!ran.stderr.contains("--link"), "{rate}: {ran:?}");
    }
    refused(
        2,
        &[
            "simulate",
            "none.foveal",
            "--out",
            "never",
            "--link",
            "fast",
        ],
        &["--link", "as 40mbit"],
    );
}

#[test]
fn a_gaze_in_two_words_or_in_pixels_is_answered_with_what_to_write() {
    let play = ["simulate", "none.foveal", "--out", "never"];
    for (gaze, words) in [
        (&["--gaze", "10", "5"][..], &["tip: ", "--gaze 10,5"][..]),
        (&["--gaze", "10"], &["--gaze", "one number", "10,5"]),
        (&["--gaze", "200,100"], &["pitch 100", "not pixels"]),
    ] {
        refused(2, &[&play[..], gaze].concat(), words);
    }
    let folder = Folder::new();
    let table = folder.holding("tobii.csv", b"time_ms,x,y\n0,1,1\n");
    let classify = ["gaze", "classify", &table];
    refused(1, &classify, &["tobii.csv", "t_s", "--gaze-columns"]);
}

#[test]
fn a_name_that_says_something_else_than_what_is_there_is_said() {
    let folder = Folder::new();
    let film = write_clip(&folder, "my360.mkv", &[numbered_tiles([64, 32], 16, 0)]);
    let out = folder.name("a.mp4");
    refused(
        2,
        &["prepare", "video", &film, "--out", &out],
        &["a pack is written", "a.foveal"],
    );
    let pack = folder.name("a.foveal");
    let ran = foveal(&["prepare", "video", &film, "--out", &pack, "--fast"]);
    let warned = |line: &str| line.starts_with("warning: ") && line.contains("part of its name");
    assert!(ran.stderr.lines().any(warned), "{ran:?}");
    // What was said is not said again with the result.
    assert!(!ran.stdout.contains("treated as flat"), "{ran:?}");
    std::fs::rename(&pack, &out).unwrap();
    refused(2, &[&out], &["tip: ", "foveal view"]);
}

#[test]
fn a_path_of_windows_is_printed_as_it_stands() {
    let folder = Folder::new();
    folder.holding("m.mtl", b"newmtl a\nmap_Kd C:\\x\\wood.png\n");
    let text = [b"mtllib D:\\y\\M.MTL\nusemtl a\n", TRIANGLE].concat();
    let mesh = folder.holding("a.obj", &text);
    let told = json(&["prepare", "scene", &mesh, "--out", &folder.name("a.foveal")]);
    let remarks = told["remarks"].as_array().unwrap();
    for path in ["\"D:\\y\\M.MTL\"", "\"C:\\x\\wood.png\""] {
        let has = |it: &serde_json::Value| it.as_str().unwrap().contains(path);
        assert!(remarks.iter().any(has), "{path}: {told}");
    }
}
