//! Is what commands print of scenes as documented?

use super::agrees;
use crate::support::{Folder, json, json_of, refused};
use std::fmt::Write as _;

/// A sheet of squares that is bent, so that it has several levels, and one triangle without area.
fn bent_sheet(folder: &Folder) -> String {
    const SIDE: u32 = 40;
    let mut text = String::new();
    for (x, z) in (0..=SIDE).flat_map(|x| (0..=SIDE).map(move |z| (x, z))) {
        let _ = writeln!(text, "v {x} {} {z}", f64::from(x * x + z) / 40.0);
    }
    for (x, z) in (0..SIDE).flat_map(|x| (0..SIDE).map(move |z| (x, z))) {
        let [a, b] = [x, x + 1].map(|x| x * (SIDE + 1) + z + 1);
        let _ = writeln!(text, "f {a} {} {}\nf {a} {} {b}", a + 1, b + 1, b + 1);
    }
    text += "f 1 1 2\n";
    folder.holding("sheet.obj", text.as_bytes())
}

#[test]
fn a_scene_is_told_of_as_documented() {
    let folder = Folder::new();
    let sheet = bent_sheet(&folder);
    let (pack, out) = (folder.name("sheet.foveal"), folder.name("out"));
    let made = json(&["prepare", "scene", &sheet, "--out", &pack]);
    let dry = json(&["prepare", "scene", &sheet, "--dry-run"]);
    agrees("prepare scene", &[&made, &dry]);
    agrees("scene", &[&json(&["info", &pack])]);

    let tried = json(&["verify", &pack, "--cuts", "5", "--orders", "5"]);
    assert_eq!(tried["odd_edges_max"], tried["source_odd_edges"]);
    let mut bytes = std::fs::read(&pack).unwrap();
    // Chunks lie behind header and description.
    let description = u32::from_le_bytes(bytes[12..16].try_into().unwrap());
    bytes[64 + description as usize + 40] ^= 1;
    let damaged = folder.holding("damaged.foveal", &bytes);
    let mut found = json_of(&refused(
        1,
        &["verify", &damaged, "--json"],
        &["damaged place"],
    ));
    found.as_object_mut().unwrap().remove("error");
    agrees("verified scene", &[&tried, &found]);

    let play = [
        "simulate",
        &pack,
        "--out",
        &out,
        "--gaze",
        "0,0",
        "--frames",
        "2",
        "--pictures",
        "none",
        "--renderer",
        "cpu",
    ];
    let view = ["--view", "96x64", "--fov", "60"];
    let mut run = json(&[&play[..], &view, &["--policy", "full", "--score"]].concat());
    assert_eq!(run["error_all"], 0.0, "{run}");
    // Printed for one version more, under its new name as well.
    run["score"].as_object_mut().unwrap().remove("size");
    let rig = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/panels/three.toml"
    );
    let small = std::fs::read_to_string(rig).unwrap();
    let small = small.replace("[800, 600]", "[96, 72]");
    let rig = folder.holding("small.toml", small.as_bytes());
    let full = ["--panels", &rig, "--policy", "full", "--score"];
    let mut on_panels = json(&[&play[..], &full].concat());
    assert!(on_panels["error_all"].is_null(), "{on_panels}");
    assert_eq!(on_panels["panels"][2]["jod"], 10.0, "{on_panels}");
    on_panels["score"].as_object_mut().unwrap().remove("size");
    agrees("run through a scene", &[&run, &on_panels]);
}
