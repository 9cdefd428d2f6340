//! Do the commands that README and the help show come out, on small inputs?

use crate::documented::{Shown, of_documents, of_line};
use crate::scene::torus;
use crate::scenes::{waves, write_clip};
use crate::support::{Folder, Rgb, command, finish, skipped};
use crate::view::Display;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// What makes commands short: how each begins, and the options that it is given besides.
const SHORTER: [(&str, &[&str]); 10] = [
    ("prepare video", &["--fast"]),
    ("simulate statue", &["--frames", "1", "--view", "96x54"]),
    ("simulate", &["--frames", "2", "--view", "96x54"]),
    ("evaluate policies", &["--frames", "2", "--view", "96x54"]),
    (
        "evaluate codecs",
        &["--frames", "8", "--codecs", "vp9", "--play", "10"],
    ),
    ("score my", &["--frames", "2", "--view", "96x54"]),
    ("bench video", &["--frames", "10", "--renderer", "none"]),
    ("bench scene", &["--only", "bytes", "--renderer", "none"]),
    ("panels warp examples/panels/three", &["--frames", "1"]),
    ("serve", &["--listen", "127.0.0.1:0"]),
];
/// They need another program's window or a tracker that sends; tests of their own run them.
const ELSEWHERE: [&str; 2] = ["x11:", "udp:5005"];

/// The files that the commands name, small.
fn inputs(folder: &Folder) {
    write_clip(folder, "my.mkv", &waves([128, 72], 8));
    std::fs::rename(folder.join("my.mkv"), folder.join("my.mp4")).unwrap();
    for name in ["statue.obj", "my.obj"] {
        folder.holding(name, torus(24, 12).as_bytes());
    }
    for (name, code) in [("a", 90), ("b", 120), ("ref", 90), ("test", 120)] {
        let size = [512, 288];
        let pixels = (0..size[0] * size[1] * 3).map(|k| ((k * 7) % code) as u8);
        let pixels = pixels.collect();
        Rgb { size, pixels }.write(&folder.name(&format!("{name}.png")));
    }
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    std::os::unix::fs::symlink(examples, folder.join("examples")).unwrap();
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

#[test]
fn every_command_that_readme_and_the_help_show_comes_out_on_small_inputs() {
    let folder = Folder::new();
    inputs(&folder);
    let display = Display::start();
    let help = [
        "prepare video",
        "simulate",
        "replay",
        "score",
        "perception importance",
        "evaluate policies",
        "evaluate codecs",
        "bench video",
        "bench scene",
        "panels warp",
    ];
    let help = help.map(|path| {
        let words: Vec<&str> = path.split(' ').chain(["--help"]).collect();
        let ran = finish(command(&words));
        let example = ran.stdout.split("Example:").nth(1).map(str::to_owned);
        example.unwrap_or_else(|| panic!("no example in the help of {path}"))
    });
    let help = help.iter().flat_map(|text| {
        let line = text.trim().lines().next().unwrap_or_default();
        of_line("help", line, true)
    });
    let mut ran = 0;
    let readme = of_documents().into_iter();
    let readme = readme.filter(|shown| shown.place.starts_with("README.md") && shown.is_whole);
    for shown in readme.chain(help) {
        let words = shortened(&shown);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let line = words.join(" ");
        if !ELSEWHERE.iter().any(|other| line.contains(other)) && !line.contains("clip.foveal") {
            run(&folder, display.as_ref(), &words);
            ran += 1;
        }
    }
    assert!(ran > 18, "{ran} commands");
}
