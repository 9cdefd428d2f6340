//! Does a window show what the headless run shows, and does it survive what happens to windows?

use crate::results::agrees;
use crate::scenes::write_clip;
use crate::support::{
    Folder, Ran, Rgb, assert_refused, command, done, finish, frame_picture, refused, skipped,
};
use foveal_core::view::picture::Picture;
use foveal_media::generate::numbered_tiles;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// A display without a screen, which goes away with the value.
pub(crate) struct Display {
    server: Child,
    pub(crate) name: String,
    /// Where it keeps what is on its screen.
    kept: Folder,
}

impl Display {
    /// Starts one; `None`, and a line that says so, where there is no Xvfb. The server chooses a
    /// free number and prints it when clients may come: a socket left behind by one that
    /// was killed is not mistaken for a server.
    pub(crate) fn start() -> Option<Self> {
        let kept = Folder::new();
        let started = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1000x700x24"])
            .args(["-nolisten", "tcp", "-fbdir", kept.to_str().unwrap()])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut server) = started else {
            skipped("there is no Xvfb, so no window was opened (apt-get install xvfb)");
            return None;
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap())
            .read_line(&mut number)
            .unwrap();
        assert!(number.ends_with('\n'), "Xvfb does not start");
        let name = format!(":{}", number.trim());
        Some(Self { server, name, kept })
    }

    /// What is on the screen: an XWD file, whose header is 32-bit numbers, the big end first, and
    /// whose pixels are blue, green, red and nothing.
    pub(crate) fn screen(&self) -> Rgb {
        let bytes = std::fs::read(self.kept.name("Xvfb_screen0")).unwrap();
        let number = |at: usize| u32::from_be_bytes(bytes[4 * at..4 * at + 4].try_into().unwrap());
        let [header, width, height, line, colours] = [0, 4, 5, 12, 19].map(number);
        let begin = (header + 12 * colours) as usize;
        let rows = bytes[begin..].chunks(line as usize).take(height as usize);
        let pixels = rows.flat_map(|row| row[..4 * width as usize].chunks(4));
        Rgb {
            size: [width, height],
            pixels: pixels
                .flat_map(|bgrx| [bgrx[2], bgrx[1], bgrx[0]])
                .collect(),
        }
    }

    /// The program in a window on it, with a script, in the folder, where screenshots go.
    pub(crate) fn view(
        &self,
        folder: &Folder,
        pack: &str,
        script: &str,
        options: &[&str],
    ) -> Command {
        // Screenshots have names, and no folders.
        let script = script.replace(&folder.name(""), "");
        let script = folder.holding("script.txt", script.as_bytes());
        let mut view = command(&["view", pack, "--script", &script, "--json"]);
        view.args(options).current_dir(folder.name(""));
        view.env("DISPLAY", &self.name)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", folder.to_str().unwrap());
        view
    }
}

impl Drop for Display {
    /// Asks the server to end, which takes its socket and its lock along.
    fn drop(&mut self) {
        let id = self.server.id().to_string();
        let _ = Command::new("kill").args(["-TERM", &id]).status();
        let _ = self.server.wait();
    }
}

/// Opens a pack on a display of its own and lets a script run to its end; `None` without Xvfb.
pub(crate) fn watched(
    folder: &Folder,
    pack: &str,
    script: &str,
    options: &[&str],
) -> Option<Value> {
    let display = Display::start()?;
    let ran: Ran = finish(display.view(folder, pack, script, options));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    Some(serde_json::from_str(&ran.stdout).unwrap())
}

/// A flat pack of six frames in which every tile identifies its frame.
pub(crate) fn flat_pack(folder: &Folder) -> String {
    let pictures: Vec<Picture> = (0..6)
        .map(|frame| numbered_tiles([512, 288], 64, frame))
        .collect();
    let clip = write_clip(folder, "clip.mkv", &pictures);
    let pack = folder.name("clip.foveal");
    done(&[
        "prepare", "video", &clip, "--out", &pack, "--tile", "64", "--fast",
    ]);
    pack
}

/// The headless picture of a frame, everything in view at display density.
fn headless(folder: &Folder, pack: &str, size: &str, frame: usize) -> Rgb {
    let out = folder.name(&format!("headless-{size}"));
    done(&[
        "simulate", pack, "--out", &out, "--gaze", "center", "--policy", "viewport", "--view", size,
    ]);
    frame_picture(&out, frame)
}

#[test]
fn a_settled_window_shows_the_picture_of_the_headless_run() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let [first, last] = ["first", "last"].map(|name| folder.name(&format!("made/here/{name}.png")));
    let script = "0 settle\n0 screenshot first.png\n0.1 key End\n0.1 settle\n\
                  0.1 screenshot last.png\n0.2 quit";
    let shots = folder.name("made/here");
    let options = ["--view", "400x225", "--paused", "--screenshots", &shots];
    let Some(summary) = watched(&folder, &pack, script, &options) else {
        return;
    };
    assert_eq!(summary["wrong_frame_tiles"], 0);
    agrees("view", &[&summary]);
    for (shot, frame) in [(first, 0), (last, 5)] {
        let expected = headless(&folder, &pack, "400x225", frame);
        assert!(Rgb::read(&shot).difference(&expected) <= 1, "frame {frame}");
    }
}

/// Whether a rectangle of the screen is as dark as behind words, where the picture is not.
fn is_behind_words(screen: &Rgb, plain: &Rgb, [xs, ys]: [std::ops::Range<u32>; 2]) -> bool {
    let sum = |pixel: [u8; 3]| pixel.map(u32::from).iter().sum::<u32>();
    let places = ys.flat_map(|y| xs.clone().map(move |x| [x, y]));
    let bright: Vec<[u32; 2]> = places.filter(|at| sum(plain.at(*at)) > 90).collect();
    let is_dark = |at: &[u32; 2]| 2 * sum(screen.at(*at)) < sum(plain.at(*at));
    !bright.is_empty() && bright.iter().all(is_dark)
}

#[test]
fn a_window_says_which_key_lists_the_keys_and_that_key_does() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let plain = folder.name("plain.png");
    let open = |more: &str| format!("0 settle\n0 screenshot {plain}\n{more}");
    // At the bottom in the middle, below the text; at the left, next to all lines of the table.
    let hint = || [375..393, 413..417];
    let keys = || [12..18, 14..320];
    let options = ["--view", "768x432", "--paused"];
    for (script, is_seen) in [(open(""), [true, false]), (open("0 key h"), [false, true])] {
        let Some(display) = Display::start() else {
            return;
        };
        let mut view = display.view(&folder, &pack, &script, &options);
        let mut window = view.stdout(Stdio::null()).spawn().unwrap();
        let seen = (0..1200).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(50));
            if !std::path::Path::new(&plain).exists() {
                return false;
            }
            let (screen, plain) = (display.screen(), Rgb::read(&plain));
            [hint(), keys()].map(|place| is_behind_words(&screen, &plain, place)) == is_seen
        });
        let _ = window.kill();
        let _ = window.wait();
        assert!(seen, "{script}");
        std::fs::remove_file(&plain).unwrap();
    }
}

#[test]
fn a_screenshot_of_a_script_has_a_name_alone_and_replaces_nothing() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let refused_name = |name: &str| {
        let script = format!("0 screenshot {name}\n");
        let script = folder.holding("bad.txt", script.as_bytes());
        let view = ["view", &pack, "--script", &script];
        refused(1, &view, &["bad.txt", "line 1", "--screenshots"]);
    };
    let there = folder.name("there.png");
    for name in ["../../x.png", "a/b.png", "/tmp/x.png", "..", ".", &there] {
        refused_name(name);
    }
    std::fs::write(&there, b"mine").unwrap();
    std::fs::create_dir(folder.name("shots")).unwrap();
    std::os::unix::fs::symlink(&there, folder.name("shots/link.png")).unwrap();
    for (name, options) in [
        ("there.png", &[][..]),
        ("link.png", &["--screenshots", "shots"]),
    ] {
        let Some(display) = Display::start() else {
            return;
        };
        let script = format!("0 settle\n0 screenshot {name}\n0.1 quit");
        let options = [&["--view", "200x112", "--paused"], options].concat();
        let ran = finish(display.view(&folder, &pack, &script, &options));
        assert_refused(&ran, 1, &[name, "there already"]);
        assert_eq!(std::fs::read(&there).unwrap(), b"mine");
    }
}

#[test]
fn a_step_forward_and_one_back_come_to_the_same_frame() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let shots = ["a.png", "b.png", "c.png"].map(|name| folder.name(name));
    let script = format!(
        "0 settle\n0 screenshot {}\n0 key .\n0 settle\n0 screenshot {}\n0 key ,\n0 settle\n\
         0 screenshot {}\n0 quit",
        shots[0], shots[1], shots[2]
    );
    let options = ["--view", "400x225", "--paused"];
    if watched(&folder, &pack, &script, &options).is_none() {
        return;
    }
    let [a, b, c] = shots.map(|shot| Rgb::read(&shot));
    assert_eq!(a.difference(&c), 0);
    assert!(b.difference(&headless(&folder, &pack, "400x225", 1)) <= 1);
    assert!(a.difference(&b) > 8, "the next frame is the same picture");
}

#[test]
fn a_window_survives_a_lost_gpu_and_losing_all_its_pixels() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let (before, after) = (folder.name("before.png"), folder.name("after.png"));
    let script = format!(
        "0 settle\n0 screenshot {before}\n0.1 lose-device\n0.6 settle\n0.6 resize 0 0\n\
         0.8 resize 400 225\n0.9 settle\n0.9 screenshot {after}\n1 quit"
    );
    let options = ["--view", "400x225", "--paused"];
    let Some(summary) = watched(&folder, &pack, &script, &options) else {
        return;
    };
    assert_eq!(summary["lost_devices"], 1, "{summary}");
    assert_eq!(Rgb::read(&before).difference(&Rgb::read(&after)), 0);
}

#[test]
fn the_log_of_a_wandering_viewer_replays() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let log = folder.name("log.jsonl");
    let script = "0 move 100 100\n0.1 wheel 6\n0.2 drag 30 -20\n0.3 key p\n0.5 move 300 50\n\
                  0.7 leave\n0.8 key 0\n0.9 resize 300 300\n1.2 settle\n1.5 quit";
    let options = ["--view", "400x225", "--demo", "--log", &log];
    if watched(&folder, &pack, script, &options).is_none() {
        return;
    }
    let text = std::fs::read_to_string(&log).unwrap();
    let heads = text.lines().filter(|line| line.contains("foveal_session"));
    assert!(
        heads.count() >= 3,
        "zoom and policy begin new sessions: {text}"
    );
    done(&["replay", &log, "--pack", &pack]);
}

#[test]
fn a_close_look_decodes_little_and_shows_the_finest_pixels() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let shot = folder.name("close.png");
    let script = format!("0 move 200 112\n0 wheel 60\n0.1 settle\n0.1 screenshot {shot}\n0.1 quit");
    let options = ["--view", "400x225", "--paused"];
    let Some(summary) = watched(&folder, &pack, &script, &options) else {
        return;
    };
    assert_eq!(summary["damaged_tiles"], 0);
    // 400 display pixels are 12.5 of the content: neighbours differ by little, but not by nothing.
    let picture = Rgb::read(&shot);
    let across: Vec<u8> = (0..400).map(|x| picture.at([x, 112])[1]).collect();
    let steps = across.windows(2).map(|pair| pair[0].abs_diff(pair[1]));
    assert!(steps.max().unwrap_or(0) < 80, "{across:?}");
}

#[test]
fn every_way_to_show_a_picture_shows_one_and_goes_back() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let shots = ["plain", "textures", "blurred", "sampled", "back"];
    let shots = shots.map(|name| folder.name(&format!("{name}.png")));
    let [plain, textures, blurred, sampled, back] = &shots;
    // From viewport, seven times P comes to sampled, and three times on to viewport.
    let next = |times: usize| "0 key p\n".repeat(times);
    let script = format!(
        "0 move 200 112\n0 settle\n0 screenshot {plain}\n0 key t\n0 settle\n\
         0 screenshot {textures}\n0 key t\n0 key r\n0 settle\n0 screenshot {blurred}\n0 key r\n\
         {}0 settle\n0 key i\n0 key t\n0 key e\n0 settle\n0 screenshot {sampled}\n\
         {}0 settle\n0 screenshot {back}\n0 quit",
        next(7),
        next(3)
    );
    let options = ["--view", "400x225", "--paused", "--mask-size", "128"];
    let Some(summary) = watched(&folder, &pack, &script, &options) else {
        return;
    };
    assert_eq!(summary["wrong_frame_tiles"], 0);
    let [plain, textures, blurred, sampled, back] = shots.map(|shot| Rgb::read(&shot));
    assert_eq!(plain.difference(&back), 0);
    assert!(plain.difference(&blurred) > 8, "nothing was blurred");
    assert!(plain.difference(&sampled) > 8, "nothing was sampled");
    // Nothing is filtered across levels, so edges differ, but it is the same picture.
    let places: Vec<[u32; 2]> = plain.places().collect();
    let off = |at: &[u32; 2]| f64::from(plain.at(*at)[1].abs_diff(textures.at(*at)[1]));
    let mean = places.iter().map(off).sum::<f64>() / places.len() as f64;
    assert!(mean < 6.0, "{mean}");
}

#[test]
fn a_still_is_decoded_once_and_settles() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &[numbered_tiles([512, 288], 64, 0)]);
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack, "--tile", "64"]);
    let Some(summary) = watched(&folder, &pack, "0 settle\n0.5 settle\n0.5 quit", &[]) else {
        return;
    };
    let pixels = summary["decoded_megapixels"].as_f64().unwrap();
    assert!(pixels * 1e6 < 2.0 * 512.0 * 288.0, "{summary}");
}

#[test]
fn a_link_brings_the_picture_bit_by_bit_and_its_log_replays() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let log = folder.name("log.jsonl");
    let script = "0 settle\n0.1 quit";
    let options = [
        "--view", "400x225", "--paused", "--policy", "uniform", "--link", "400kbit", "--log", &log,
    ];
    if watched(&folder, &pack, script, &options).is_none() {
        return;
    }
    let text = std::fs::read_to_string(&log).unwrap();
    let frames: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .filter(|line: &Value| line.get("budget").is_some())
        .collect();
    let pixels = |frame: &Value| frame["pixels"].as_u64().unwrap();
    assert!(frames.len() > 2, "{text}");
    assert!(
        pixels(&frames[0]) < pixels(&frames[frames.len() - 1]),
        "{text}"
    );
    done(&["replay", &log, "--pack", &pack]);
}

#[test]
fn without_a_graphics_driver_it_is_said_what_is_missing() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let Some(display) = Display::start() else {
        return;
    };
    let mut view = command(&["view", &pack]);
    view.env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent");
    let ran = finish(view);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stderr.contains("adapter"), "{}", ran.stderr);
}

#[test]
fn without_a_display_it_is_said_what_is_missing() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let mut view = command(&["view", &pack]);
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        view.env_remove(name);
    }
    let ran = finish(view);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    for word in ["no window can be opened", "display", "simulate"] {
        assert!(ran.stderr.contains(word), "no {word:?} in {}", ran.stderr);
    }
}

#[test]
fn what_is_wrong_is_said_before_a_window_opens() {
    let folder = Folder::new();
    let broken = folder.holding("broken.foveal", b"no pack at all");
    refused(1, &["view", &broken], &["broken.foveal"]);
    let pack = flat_pack(&folder);
    let script = folder.holding("script.txt", b"0 settle\n1 dance");
    refused(
        1,
        &["view", &pack, "--script", &script],
        &["line 2", "dance", "settle"],
    );
    refused(
        1,
        &["view", &pack, "--screenshots", &script],
        &["--screenshots", "folder", "script.txt"],
    );
    refused(
        2,
        &["view", &pack, "--link", "4g"],
        &["--link", "viewport", "perceptual"],
    );
    let textures = ["--reconstruction", "textures", "--policy", "sampled"];
    refused(
        2,
        &[&["view", &pack][..], &textures].concat(),
        &["tiles", "samples"],
    );
    refused(2, &["view", &pack, "--gaze", "cat"], &["mouse"]);
}

#[test]
fn a_demo_shows_more_than_the_coarsest_level() {
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let log = folder.name("view.jsonl");
    let options = ["--demo", "--paused", "--view", "400x225", "--log", &log];
    let script = "0 move 200 100\n0.1 settle\n0.2 quit";
    if watched(&folder, &pack, script, &options).is_none() {
        return;
    }
    let text = std::fs::read_to_string(&log).unwrap();
    let last: Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    assert_ne!(last["tiles"][0], 0, "{last}");
}
