//! Are layouts of displays read as other programs write them, and are mends reported?

use crate::support::{Folder, json, refused};
use serde_json::Value;

/// What `panels import` reports about a file.
fn imported(folder: &Folder, file: &str) -> Value {
    let out = folder.name("rig.toml");
    let _ = std::fs::remove_file(&out);
    json(&["panels", "import", file, "--out", &out])
}

fn remarks(told: &Value) -> String {
    let all = told["remarks"].as_array().unwrap().iter();
    all.map(|it| it.as_str().unwrap())
        .collect::<Vec<_>>()
        .join("\n")
}

/// A mesh of 3 x 2 nodes, a line each, by what u, v and i are.
fn mesh(node: impl Fn(f64, f64) -> String) -> String {
    let mut text = "2\n3 2\n".to_owned();
    for (y, x) in [-1.0, 1.0]
        .into_iter()
        .flat_map(|y| [-1.0, 0.0, 1.0].map(|x| (y, x)))
    {
        text += &format!("{x} {y} {}\n", node((x + 1.0) / 2.0, (y + 1.0) / 2.0));
    }
    text
}

#[test]
fn a_mesh_that_counts_light_in_bytes_or_has_holes_is_told_of() {
    let folder = Folder::new();
    let told = |text: String| imported(&folder, &folder.holding("dome.data", text.as_bytes()));
    let plain = told(mesh(|u, v| format!("{u} {v} 1")));
    assert_eq!(plain["remarks"].as_array().unwrap().len(), 0);
    let bytes = told(mesh(|u, v| format!("{u} {v} {}", 255.0 - 127.0 * u)));
    assert!(remarks(&bytes).contains("divided by 255"), "{bytes}");
    assert!(bytes["files"].to_string().contains("alpha"), "{bytes}");
    let holed = mesh(|u, v| format!("{u} {v} 1")).replacen("-1 -1 0 0 1", "nan nan nan nan -1", 1);
    assert!(remarks(&told(holed)).contains("1 node"));
    let pixels = mesh(|u, v| format!("{} {} 1", u * 640.0, v * 480.0));
    let file = folder.holding("pixels.data", pixels.as_bytes());
    let out = folder.name("never.toml");
    refused(
        1,
        &["panels", "import", &file, "--out", &out],
        &["u reaches 640 and v 480", "divide them"],
    );
}

#[test]
fn an_mpcdi_whose_files_are_named_in_other_letters_keeps_its_maps() {
    let folder = Folder::new();
    let region = |id: &str, x: f64| {
        format!(
            "<region id=\"{id}\" xResolution=\"4\" yResolution=\"4\" x=\"{x}\" y=\"0\" \
             xsize=\"0.5\" ysize=\"1\"/>"
        )
    };
    let set = |id: &str| {
        format!(
            "<fileset region=\"{id}\"><geometryWarpFile><path>w.pfm</path></geometryWarpFile>\
             </fileset>"
        )
    };
    let mut map = b"PF\n4 4\n-1.0\n".to_vec();
    for (line, column) in (0..4_u8).flat_map(|line| (0..4_u8).map(move |column| (line, column))) {
        let [x, y] = [column, line].map(|at| (f32::from(at) + 0.5) / 4.4);
        let node = if column == 3 { [-1.0; 3] } else { [x, y, 0.0] };
        map.extend(node.map(f32::to_le_bytes).as_flattened());
    }
    map.extend([0; 5]);
    folder.holding("w.pfm", &map);
    let text = |sets: &str, buffer: &str| {
        format!(
            "\n<?xml version=\"1.0\"?><MPCDI profile=\"2d\" name=\"A & B\"><display>{buffer}{}{}\
             </buffer></display><files>{sets}</files></MPCDI>",
            region("Left", 0.0),
            region("Right", 0.5)
        )
    };
    let buffer = "<buffer xResolution=\"8\" yResolution=\"4\">";
    let both = [set("left"), set("RIGHT")].concat();
    let file = folder.holding("a.xml", text(&both, buffer).as_bytes());
    let told = imported(&folder, &file);
    assert_eq!(told["files"].as_array().unwrap().len(), 3, "{told}");
    for words in [
        "region \"left\" are used for \"Left\"",
        "region \"RIGHT\" are used for \"Right\"",
        "1 ampersand",
        "before its XML declaration",
        "5 bytes after its floats",
    ] {
        assert!(remarks(&told).contains(words), "{words}: {told}");
    }
    let one = [set("left"), set("middle")].concat();
    let file = folder.holding("b.xml", text(&one, buffer).as_bytes());
    let told = imported(&folder, &file);
    for words in ["\"middle\" are left out", "\"Right\" has no files"] {
        assert!(remarks(&told).contains(words), "{words}: {told}");
    }
    let none = "<buffer xResolution=\"0\" yResolution=\"0\">";
    let file = folder.holding("c.xml", text(&both, none).as_bytes());
    assert!(remarks(&imported(&folder, &file)).contains("is treated as missing"));
}

/// A map of 4 x 4 shares.
fn map() -> Vec<u8> {
    let mut map = b"PF\n4 4\n-1.0\n".to_vec();
    for (line, column) in (0..4_u8).flat_map(|line| (0..4_u8).map(move |column| (line, column))) {
        let [x, y] = [column, line].map(|at| (f32::from(at) + 0.5) / 4.4);
        map.extend([x, y, 0.0].map(f32::to_le_bytes).as_flattened());
    }
    map
}

#[test]
fn an_mpcdi_that_lacks_a_map_or_its_end_keeps_its_other_panels() {
    let folder = Folder::new();
    let text = |left: &str, right: &str| {
        let region = |id: &str, x: &str| {
            format!(
                "<region id=\"{id}\" xResolution=\"4\" yResolution=\"4\" x=\"{x}\" y=\"0\" \
                 xsize=\"0.5\" ysize=\"1\"/>"
            )
        };
        let set = |id: &str, file: &str| {
            format!(
                "<fileset region=\"{id}\"><geometryWarpFile><path>{file}</path>\
                 </geometryWarpFile></fileset>"
            )
        };
        format!(
            "<MPCDI profile=\"2d\"><display><buffer xResolution=\"8\" yResolution=\"4\">{}{}\
             </buffer></display>\n<files>{}{}</files></MPCDI>",
            region("L", "0"),
            region("R", "0.5"),
            set("L", left),
            set("R", right)
        )
    };
    std::fs::create_dir(folder.name("warp")).unwrap();
    folder.holding("warp/w.pfm", &map());
    folder.holding("cut.pfm", &map()[..100]);
    let both = text("warp/w.pfm", "warp/w.pfm");
    for (text, panels, words) in [
        (both.clone(), 2, ""),
        (text("warp/w.pfm", "Warp\\W.PFM"), 2, "differs in capitals"),
        (
            text("warp/w.pfm", "gone.pfm"),
            1,
            "region \"R\" is left out",
        ),
        (text("cut.pfm", "warp/w.pfm"), 1, "region \"L\" is left out"),
        (
            both.replace("0.5", "0,5"),
            2,
            "3 numbers with a decimal comma",
        ),
        (
            both[..both.len() - 30].to_owned(),
            2,
            "breaks off in line 2, within 4 elements",
        ),
        (
            both[..both.find("ysize").unwrap()].to_owned() + "ysize=\"1\"/>",
            1,
            "within 3 elements",
        ),
    ] {
        let file = folder.holding("a.xml", text.as_bytes());
        let told = imported(&folder, &file);
        assert_eq!(told["panels"], panels, "{words}: {told}");
        assert!(remarks(&told).contains(words), "{words}: {told}");
        assert_eq!(remarks(&told).is_empty(), words.is_empty(), "{told}");
    }
    for (text, words) in [
        (text("gone.pfm", "gone.pfm"), "\"gone.pfm\" cannot be read"),
        (text("warp/w.pfm", "../w.pfm"), "names no file in"),
    ] {
        let file = folder.holding("a.xml", text.as_bytes());
        let out = folder.name("never.toml");
        refused(1, &["panels", "import", &file, "--out", &out], &[words]);
    }
}

#[test]
fn what_is_mended_of_a_wall_is_told() {
    let folder = Folder::new();
    let wall = "v -2 -1 -3\nv 2 -1 -3\nv 2 1 -3\nv -2 1 -3\nv nan 0 0\nf 1 2 3 4\nf 1 2 5\n";
    let file = folder.holding("wall.obj", wall.as_bytes());
    let out = folder.name("wall.toml");
    let projector = "p at=0,0,0 pixels=64x32 throw=0.75";
    let told = json(&[
        "panels",
        "import",
        &file,
        "--out",
        &out,
        "--projector",
        projector,
    ]);
    assert!(
        remarks(&told).contains("NaN or infinite are left out: 1"),
        "{told}"
    );
}
