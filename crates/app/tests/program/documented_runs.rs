//! Do the commands that README and the help show come out, on small inputs?

use crate::documented::{Shown, of_documents, of_line};
use crate::gaze_events::yaw;
use crate::gaze_head::recording;
use crate::panels::WALL;
use crate::scene::torus;
use crate::scenes::{waves, write_clip};
use crate::support::{Folder, Rgb, command, finish, skipped};
use crate::view::Display;
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// What makes commands short: how each begins, and the options that it is given besides.
const SHORTER: [(&str, &[&str]); 12] = [
    ("prepare video sphere", &["--calibrate", "off"]),
    ("prepare video", &["--fast"]),
    ("simulate statue", &["--frames", "1", "--view", "96x54"]),
    ("simulate", &["--frames", "2", "--view", "96x54"]),
    ("evaluate policies", &["--frames", "2", "--view", "96x54"]),
    (
        "evaluate codecs",
        &["--frames", "8", "--codecs", "vp9", "--play", "10"],
    ),
    (
        "evaluate grid-sweep",
        &[
            "--frames", "8", "--play", "10", "--grids", "2", "--levels", "2",
        ],
    ),
    ("score my", &["--frames", "2", "--view", "96x54"]),
    ("bench video", &["--frames", "10", "--renderer", "none"]),
    ("bench scene", &["--only", "bytes", "--renderer", "none"]),
    ("panels warp examples/panels/three", &["--frames", "1"]),
    ("serve", &["--listen", "127.0.0.1:0"]),
];
/// What runs elsewhere or takes long, and why.
const ELSEWHERE: [(&str, &str); 12] = [
    ("clip.foveal", "no such pack is made here"),
    ("x11:", "another program's window: `panels_live`"),
    ("udp:5005", "a tracker that sends: `bridge` and `live_gaze`"),
    ("demo --", "minutes: `demo`"),
    ("calibrate my.foveal --thorough", "minutes: `calibrated`"),
    ("evaluate goldens", "`cargo xtask measured --sample`"),
    ("evaluate targets", "hours"),
    ("bench perception", "minutes"),
    ("bench prepare", "minutes"),
    ("bench score", "minutes"),
    ("panels bench examples/panels/three", "minutes"),
    ("panels figures examples/panels/twelve", "another runs here"),
];

/// The files that the commands name, small.
fn inputs(folder: &Folder) {
    write_clip(folder, "my.mkv", &waves([128, 72], 8));
    std::fs::rename(folder.join("my.mkv"), folder.join("my.mp4")).unwrap();
    for name in ["statue.obj", "my.obj"] {
        folder.holding(name, torus(24, 12).as_bytes());
    }
    folder.holding("wall.obj", WALL);
    for (name, seed) in [("first.csv", 1), ("second.csv", 2)] {
        let law = HeadGazePreset::free_viewing();
        folder.holding(name, recording(&law, seed).as_bytes());
    }
    for (name, text) in [
        (
            "gaze.csv",
            saccades("t_s,yaw_deg,pitch_deg", |ms, yaw| {
                format!("{},{yaw},0", f64::from(ms) / 1e3)
            }),
        ),
        (
            "tracker.csv",
            saccades("time_ms,x,y", |ms, yaw| {
                format!("{ms},{},540", 960.0 + 30.0 * yaw)
            }),
        ),
        (
            "labelled.csv",
            saccades("x_deg,y_deg,valid,event", |ms, yaw| {
                format!("{yaw},0,1,{}", if ms % 500 < 50 { 2 } else { 1 })
            }),
        ),
    ] {
        folder.holding(name, text.as_bytes());
    }
    for (name, code, size) in [
        ("a", 90, [512, 288]),
        ("b", 120, [512, 288]),
        ("ref", 90, [512, 288]),
        ("test", 120, [512, 288]),
        ("sphere", 90, [512, 256]),
    ] {
        let pixels = (0..size[0] * size[1] * 3).map(|k| ((k * 7) % code) as u8);
        let pixels = pixels.collect();
        Rgb { size, pixels }.write(&folder.name(&format!("{name}.png")));
    }
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    std::os::unix::fs::symlink(examples, folder.join("examples")).unwrap();
}

/// A table with a row a millisecond, of eyes that jump every half second.
fn saccades(header: &str, row: impl Fn(u32, f64) -> String) -> String {
    let rows = (0..3000).map(|ms| row(ms, yaw(ms)));
    let lines: Vec<String> = std::iter::once(header.to_owned()).chain(rows).collect();
    lines.join("\n") + "\n"
}

/// Runs a command in a folder, in a window or as a server where it is one.
fn run(folder: &Folder, display: Option<&Display>, words: &[&str]) {
    let mut program = command(words);
    program.current_dir(&**folder);
    match (words[0], display) {
        ("view", None) => {}
        ("view", Some(display)) => {
            folder.holding("quit.txt", b"0 quit\n");
            program.args(["--script", "quit.txt"]);
            program.env("DISPLAY", &display.name);
            program.env_remove("WAYLAND_DISPLAY");
            succeeds(program);
        }
        ("serve", _) => answers(program),
        _ => succeeds(program),
    }
}

fn succeeds(program: Command) {
    let shown = format!("{program:?}");
    let ran = finish(program);
    if ran.stderr.contains("built without its pages") {
        return skipped("the program was built without its pages, so no site was exported");
    }
    assert_eq!(ran.code, Some(0), "{shown}: {ran:?}");
}

/// A server says where it answers; then it is ended.
fn answers(mut program: Command) {
    program.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut server = program.spawn().unwrap();
    let mut line = String::new();
    let mut said = BufReader::new(server.stdout.take().unwrap());
    said.read_line(&mut line).unwrap();
    let _ = server.kill();
    let told = server.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&told.stderr).into_owned();
    if told.contains("built without its pages") {
        return skipped("the program was built without its pages, so nothing was served");
    }
    assert!(line.contains("http://"), "{program:?}: {line} {told}");
}

/// A command as it runs here: shorter, and with the mesh that is there.
fn shortened(shown: &Shown) -> Vec<String> {
    let mut words = shown.words.clone();
    for word in &mut words {
        *word = word.replace(".glb", ".obj");
    }
    let line = words.join(" ");
    let more = SHORTER.iter().find(|(begins, _)| line.starts_with(begins));
    for pair in more.map_or(&[][..], |(_, more)| more).chunks(2) {
        if !words.iter().any(|word| word == pair[0]) {
            words.extend(pair.iter().map(|&word| word.to_owned()));
        }
    }
    words
}

fn shows_a_run(line: &str) -> bool {
    !ELSEWHERE.iter().any(|(other, _)| line.contains(other))
}

#[test]
fn every_command_that_readme_shows_comes_out_on_small_inputs() {
    let folder = Folder::new();
    inputs(&folder);
    let display = Display::start();
    let mut ran = 0;
    let shown = of_documents().into_iter();
    let shown = shown.filter(|shown| shown.place.starts_with("README.md") && shown.is_whole);
    for shown in shown {
        let words = shortened(&shown);
        if shows_a_run(&words.join(" ")) {
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            run(&folder, display.as_ref(), &words);
            ran += 1;
        }
    }
    assert!(ran > 8, "{ran} commands");
}

/// The examples with which the help of the commands ends, two of each, as docs/commands.md has
/// them.
fn examples() -> Vec<Shown> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/commands.md");
    let page = std::fs::read_to_string(page).unwrap();
    let lists = page.split("\nExamples:\n").skip(1);
    let lines = lists.flat_map(|list| list.lines().take(2));
    let mut shown: Vec<Shown> = lines
        .flat_map(|line| of_line("the help", line, true))
        .collect();
    // Packs come before what reads them.
    shown.sort_by_key(|shown| shown.words[0] != "prepare");
    shown
}

#[test]
fn every_example_of_the_help_comes_out_on_small_inputs() {
    let folder = Folder::new();
    inputs(&folder);
    let display = Display::start();
    let mut ran = 0;
    for shown in examples() {
        let words = shortened(&shown);
        if shows_a_run(&words.join(" ")) {
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            run(&folder, display.as_ref(), &words);
            ran += 1;
        }
    }
    assert!(ran > 64, "{ran} examples");
}
