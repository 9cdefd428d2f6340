//! Do panels show what is captured, and do windows show what files hold?

use crate::scenes::CELL;
use crate::support::{Folder, Rgb, assert_refused, command, finish, json, refused};
use crate::view::{Display, flat_pack};
use foveal_core::view::panel::fit::{PlacementRule, SourceSize, fit};
use foveal_core::view::panel::pixel_map::homography;
use foveal_core::view::panel::placement::Placement;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Eye;
use foveal_media::generate::read_number;
use foveal_scene::rig::read_rig;
use glam::DVec3;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConfigureWindowAux, ConnectionExt};

/// Two panels, each on a surface of its own, 320 columns wide.
const TWO: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "A"
eye = "left"
pixels = [320, 240]
pose = { order = "yaw-pitch-roll", yaw = -20 }
tangents = { left = 0.4, right = 0.4, up = 0.3, down = 0.3 }
output = { surface = "a" }
[[panel]]
id = "B"
eye = "left"
pixels = [320, 240]
pose = { order = "yaw-pitch-roll", yaw = 20, roll = 10 }
tangents = { left = 0.4, right = 0.4, up = 0.3, down = 0.3 }
output = { surface = "b" }
"#;

/// Waits until something is so, at most two minutes; whether it is.
fn comes(mut is_so: impl FnMut() -> bool) -> bool {
    (0..1200).any(|_| {
        let so = is_so();
        if !so {
            std::thread::sleep(Duration::from_millis(100));
        }
        so
    })
}

/// The numbers that can be read on a panel, of cells of a source of this size.
fn numbers_on(picture: &Rgb, panel: &Panel, placement: &Placement, size: [u32; 2]) -> Vec<u32> {
    let source_from_panel = homography(panel, placement, size).unwrap();
    let panel_from_source = source_from_panel.inverse();
    let [columns, rows] = size.map(|side| side / CELL);
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let read = |[column, row]: [u32; 2]| {
        let mut cell = Picture::filled(CELL, CELL, [0, 128, 128]);
        for (y, line) in (0..).zip(cell.planes[0].chunks_exact_mut(CELL as usize)) {
            for (x, luma) in (0..).zip(line) {
                let place = [column * CELL + x, row * CELL + y].map(|k| f64::from(k) + 0.5);
                let at = panel_from_source * DVec3::new(place[0], place[1], 1.0);
                let [x, y] = [at.x / at.z, at.y / at.z];
                let [w, h] = picture.size.map(f64::from);
                if !(0.0..w).contains(&x) || !(0.0..h).contains(&y) {
                    return None;
                }
                let [r, g, b] = picture.at([x as u32, y as u32]).map(f64::from);
                *luma = (0.2126 * r + 0.7152 * g + 0.0722 * b) as u8;
            }
        }
        read_number(&cell)
    };
    cells.filter_map(read).collect()
}

/// Gives the only window of a display another size.
fn resize_window(display: &str, width: u32, height: u32) {
    let (connection, screen) = x11rb::connect(Some(display)).unwrap();
    let root = connection.setup().roots[screen].root;
    let tree = connection.query_tree(root).unwrap().reply().unwrap();
    let area = |window: &u32| {
        let shape = connection.get_geometry(*window).unwrap().reply();
        shape.map_or(0, |it| u32::from(it.width) * u32::from(it.height))
    };
    let window = tree.children.into_iter().max_by_key(area).unwrap();
    let size = ConfigureWindowAux::new().width(width).height(height);
    let asked = connection.configure_window(window, &size).unwrap();
    asked.check().unwrap();
}

fn kill(child: &mut Child) {
    let _ = child.kill();
    let _ = child.wait();
}

#[test]
fn the_window_of_an_application_fills_three_panels_until_it_is_closed() {
    let Some(display) = Display::start() else {
        return;
    };
    let folder = Folder::new();
    let pack = flat_pack(&folder);
    let options = ["--view", "512x288", "--paused"];
    let mut view = display.view(&folder, &pack, "0 settle\n0 key End", &options);
    let mut view = view.stdout(Stdio::null()).spawn().unwrap();
    // The last frame has the number 5.
    let on_screen = || {
        let screen = display.screen();
        let mut cell = Picture::filled(CELL, CELL, [0, 128, 128]);
        for (y, line) in (0..).zip(cell.planes[0].chunks_exact_mut(CELL as usize)) {
            for (x, luma) in (0..).zip(line) {
                *luma = screen.at([CELL + x, y])[1];
            }
        }
        read_number(&cell)
    };
    assert!(
        comes(|| on_screen() == Some(5)),
        "the window does not show its last frame"
    );
    let rig = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/panels/three.toml"
    );
    let out = folder.name("panels");
    let mut warp = command(&["panels", "warp", rig, "x11:clip.foveal", "--out", &out]);
    warp.args(["--frames", "1000", "--json"]);
    warp.env("DISPLAY", &display.name);
    let warp = warp.stdout(Stdio::piped()).spawn().unwrap();
    let is_written = |frame: u32| Path::new(&format!("{out}/R/frame_{frame:05}.png")).exists();
    assert!(comes(|| is_written(2)), "nothing is captured");
    resize_window(&display.name, 384, 300);
    assert!(
        comes(|| is_written(6)),
        "nothing comes after a change of size"
    );
    kill(&mut view);
    let ended = warp.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(0));
    let result: Value = serde_json::from_slice(&ended.stdout).unwrap();
    assert_eq!(result["source"], serde_json::json!([384, 300]), "{result}");
    let rig = read_rig(Path::new(rig)).unwrap();
    let panels = rig.seen_by(Some(Eye::Left));
    let size = [512, 288];
    let found = fit(&panels, PlacementRule::Auto, SourceSize::Picture(size)).unwrap();
    for panel in &panels {
        let picture = Rgb::read(&format!("{out}/{}/frame_00001.png", panel.id));
        let numbers = numbers_on(&picture, panel, &found.placement, size);
        assert!(!numbers.is_empty(), "{}: no number can be read", panel.id);
        assert!(
            numbers.iter().all(|it| *it == 5),
            "{}: {numbers:?}",
            panel.id
        );
    }
}

#[test]
fn two_windows_of_a_rig_show_what_is_written_to_files() {
    let Some(display) = Display::start() else {
        return;
    };
    let folder = Folder::new();
    let rig = folder.holding("two.toml", TWO.as_bytes());
    let picture = folder.name("numbers.png");
    json(&[
        "panels", "pattern", "numbers", "--size", "640x480", "--out", &picture,
    ]);
    let out = folder.name("panels");
    json(&["panels", "warp", &rig, &picture, "--out", &out]);
    let panels = ["A", "B"].map(|id| Rgb::read(&format!("{out}/{id}.png")));
    let mut windows = command(&["panels", "warp", &rig, &picture, "--window"]);
    windows.env("DISPLAY", &display.name);
    windows.env_remove("WAYLAND_DISPLAY");
    let mut windows = windows.stdout(Stdio::null()).spawn().unwrap();
    let off = || {
        let screen = display.screen();
        let differs = |[x, y]: [u32; 2]| {
            let panel = &panels[(x / 320) as usize];
            screen.at([x, y]) != panel.at([x % 320, y])
        };
        let places = (0..240).flat_map(|y| (0..640).map(move |x| [x, y]));
        places.filter(|at| differs(*at)).count()
    };
    let is_shown = comes(|| off() == 0);
    let left = off();
    kill(&mut windows);
    assert!(is_shown, "{left} pixels of 153600 are others");
}

#[test]
fn what_cannot_be_captured_is_refused_with_what_to_do() {
    let folder = Folder::new();
    let rig = folder.holding("two.toml", TWO.as_bytes());
    let out = folder.name("out");
    let warp =
        |source: &'static str| ["panels", "warp", &rig, source, "--out", &out].map(String::from);
    let refuse = |code, source, words: &[&str]| {
        let arguments = warp(source);
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        refused(code, &arguments, words);
    };
    refuse(
        1,
        "lavfi:no_such_filter",
        &["lavfi:no_such_filter", "lavfi:testsrc2"],
    );
    refuse(
        1,
        "v4l2:/dev/no-such",
        &["v4l2:/dev/no-such", "v4l2-ctl --list-devices"],
    );
    refused(
        2,
        &["panels", "warp", &rig, "world:valley"],
        &["--out DIR", "--window"],
    );
    let both = [
        "panels",
        "warp",
        &rig,
        "world:valley",
        "--window",
        "--out",
        &out,
    ];
    refused(2, &both, &["--window"]);
    assert!(!Path::new(&out).exists());
    let graph = json(&[
        "panels",
        "warp",
        &rig,
        "lavfi:testsrc2=size=65x49",
        "--frames",
        "1",
        "--out",
        &out,
    ]);
    assert_eq!(
        (&graph["frames"], &graph["source"]),
        (&1.into(), &serde_json::json!([65, 49]))
    );
}

#[test]
fn a_graph_neither_writes_nor_fetches_and_is_not_mistaken_for_a_file() {
    let folder = Folder::new();
    let rig = folder.holding("two.toml", TWO.as_bytes());
    let [out, written] = ["out", "written"].map(|name| folder.name(name));
    for (graph, filter) in [
        (
            format!("testsrc2,metadata=print:file={written}"),
            "metadata",
        ),
        (
            format!("testsrc2,'meta'data=print:file={written}"),
            "metadata",
        ),
        (
            format!("color[a];movie={written}[b];[a][b]overlay"),
            "movie",
        ),
        ("movie=http\\\\://127.0.0.1\\\\:1/a.mkv".to_owned(), "movie"),
    ] {
        let graph = format!("lavfi:{graph}");
        let warp = ["panels", "warp", &rig, &graph, "--out", &out];
        refused(
            1,
            &warp,
            &["lavfi:", &format!("{filter:?}"), "lavfi:testsrc2"],
        );
        assert!(!Path::new(&written).exists(), "{graph}");
    }
    // A file of such a name may be meant.
    folder.holding("lavfi:testsrc2", b"a file");
    let here = |source: &str| {
        let mut warp = command(&["panels", "warp", &rig, source, "--out", &out]);
        warp.current_dir(folder.name(""));
        finish(warp)
    };
    assert_refused(&here("lavfi:testsrc2"), 2, &["./lavfi:testsrc2", "file"]);
    assert_refused(
        &here("./lavfi:testsrc2"),
        1,
        &["./lavfi:testsrc2", "not a video"],
    );
    // The source of a picture is not written over.
    let source = folder.name("A.png");
    json(&[
        "panels", "pattern", "grid", "--size", "64x48", "--out", &source,
    ]);
    let before = std::fs::read(&source).unwrap();
    let warp = ["panels", "warp", &rig, &source, "--out", &folder.name(".")];
    refused(2, &warp, &["A.png", "is what is read"]);
    assert_eq!(std::fs::read(&source).unwrap(), before);
}

#[test]
fn what_is_live_is_warped_until_it_is_stopped() {
    let folder = Folder::new();
    let rig = folder.holding("two.toml", TWO.as_bytes());
    let out = folder.name("out");
    let graph = "lavfi:testsrc2=size=64x48";
    let mut warp = command(&["panels", "warp", &rig, graph, "--out", &out, "--json"]);
    let warp = warp.stdout(Stdio::piped()).spawn().unwrap();
    // A picture stands under its name only when it is whole.
    let third = Path::new(&out).join("A").join("frame_00002.png");
    let begun = Instant::now();
    while !third.exists() && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let id = warp.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let ended = warp.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    let told: Value = serde_json::from_slice(&ended.stdout).unwrap();
    assert!(told["frames"].as_u64().unwrap() >= 3, "{told}");
}
