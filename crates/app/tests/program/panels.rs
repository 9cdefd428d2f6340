//! Does `foveal panels` find where a source lies before many displays, and refuse what is no rig?

use crate::results::agrees;
use crate::support::{Folder, Rgb, done, json, refused};
use serde_json::Value;

/// A rig that is shipped.
fn example(name: &str) -> String {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    format!("{root}/examples/panels/{name}.toml")
}

fn near(value: &Value, wanted: f64, tolerance: f64) {
    let found = value.as_f64().unwrap();
    assert!((found - wanted).abs() <= tolerance, "{found}, not {wanted}");
}

#[test]
fn a_source_is_placed_as_the_seed_does_and_better() {
    let three = example("three");
    let seed = ["--placement", "seed", "--source", "1600x1200"];
    let fit = json(&[&["panels", "fit", &three], &seed[..]].concat());
    near(&fit["s_z"], -1.077_261_440_646_962_5, 1e-9);
    near(&fit["tan_x"], 1.679_364_055_042_270_4, 1e-9);
    near(&fit["tan_y"], 1.259_523_041_281_703, 1e-9);
    near(&fit["half_width"], 1.809_114_141_305_561, 1e-9);
    near(&fit["half_height"], 1.356_835_605_979_170_9, 1e-9);
    near(&fit["need_megapixels"], 10.21, 0.2);
    near(&fit["seen_share"], 0.353, 0.003);
    near(&fit["panels"][0]["density"], 0.644_f64.sqrt(), 1e-3);
    assert_eq!(fit["placement"], "seed");
    assert_eq!(fit["map_error_px"], 0.0);
    let names = |key: &str| -> Vec<&str> {
        let panels = fit["panels"].as_array().unwrap().iter();
        panels.map(|it| it[key].as_str().unwrap()).collect()
    };
    assert_eq!(names("id"), ["L", "C", "R"]);
    assert_eq!(names("eye"), ["left"; 3]);
    let plane = json(&["panels", "fit", &three, "--placement", "plane"]);
    assert!(
        plane["need_megapixels"].as_f64().unwrap() <= 4.98,
        "{plane}"
    );
    // A picture's aspect tips nothing over either.
    let folder = Folder::new();
    let wide = folder.name("wide.png");
    done(&[
        "panels",
        "pattern",
        "grid",
        "--size",
        "1920x1080",
        "--out",
        &wide,
    ]);
    let dome = json(&["panels", "fit", &example("dome-4"), "--source", &wide]);
    assert!(
        dome["axis"]["pitch_deg"].as_f64().unwrap().abs() < 1e-6,
        "{dome}"
    );
    assert!(
        dome["axis"]["roll_deg"].as_f64().unwrap().abs() < 1e-6,
        "{dome}"
    );
    let round = json(&["panels", "fit", &example("dome-4"), "--eye", "right"]);
    assert_eq!(round["tan_x"], Value::Null);
    assert_eq!(round["panels"][0]["eye"], "both");
    // Both eyes by one source: 6 panels; of a bent one the error of its map.
    let both = json(&["panels", "fit", &three, "--eye", "both"]);
    assert_eq!(both["panels"][5]["id"], "R.right");
    let lens = json(&["panels", "fit", &example("lens")]);
    let error = lens["map_error_px"].as_f64().unwrap();
    assert!(error > 0.0 && error < 0.1, "{error}");
    agrees("panels fit", &[&fit, &plane, &round, &lens]);
    let text = done(&[&["panels", "fit", &three], &seed[..]].concat()).stdout;
    assert!(text.contains("megapixels needed"), "{text}");
}

#[test]
fn pixels_land_where_the_seed_s_do_and_maps_of_them_are_files() {
    let folder = Folder::new();
    let three = example("three");
    let seed = ["--placement", "seed", "--source", "1600x1200"];
    let base = [&["panels", "map", &three], &seed[..]].concat();
    let at = ["--at", "L:0,0", "--at", "R:100,200"];
    let map = json(&[&base[..], &at].concat());
    let [first, second] = [0, 1].map(|k| &map["points"][k]);
    near(&first["u"], 0.850_798, 1e-6);
    near(&first["v"], 314.077_106, 1e-6);
    near(&first["du_dx"], 1.700_618, 2e-6);
    near(&first["sigma_max"], 1.745_346, 2e-6);
    near(&second["u"], 940.017_456, 1e-6);
    near(&second["dv_dx"], -0.033_570, 2e-6);
    let out = folder.name("maps");
    let write = |format: &str| json(&[&base[..], &["--out", &out, "--format", format]].concat());
    let pfm = write("pfm");
    let bytes = std::fs::read(format!("{out}/L.pfm")).unwrap();
    assert!(bytes.starts_with(b"PF\n800 600\n-1.0\n"));
    let pixels = &bytes[16..];
    assert_eq!(pixels.len(), 800 * 600 * 12);
    let upper_left = &pixels[599 * 800 * 12..];
    let share = f32::from_le_bytes([upper_left[0], upper_left[1], upper_left[2], upper_left[3]]);
    assert!((share * 1600.0 - 0.850_798).abs() < 1e-4, "{share}");
    write("seed");
    let mut names = folder_names(&out);
    names.retain(|name| name.starts_with("C."));
    assert_eq!(
        names,
        ["C.derivative.png", "C.fraction.png", "C.pfm", "C.whole.png"]
    );
    let mpcdi = write("mpcdi");
    let told = mpcdi["left_out"][0].as_str().unwrap();
    assert_eq!(told, "the eye that looks at a panel: L, C, R");
    agrees("panels map", &[&map, &pfm, &mpcdi]);
}

fn folder_names(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let names = entries.map(|it| it.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[test]
fn the_schema_is_that_of_the_documents() {
    let text = done(&["panels", "schema"]).stdout;
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/formats/tiled-view.schema.json"
    );
    assert_eq!(text, std::fs::read_to_string(path).unwrap());
    let told = json(&["panels", "schema"]);
    assert_eq!(told["schema"], text);
    agrees("panels schema", &[&told]);
}

/// A flat wall, 6 wide and 4 high, 3 away.
pub(crate) const WALL: &[u8] = b"v -3 -2 -3\nv 3 -2 -3\nv 3 2 -3\nv -3 2 -3\nf 1 2 3 4\n";

#[test]
fn projectors_before_a_wall_become_a_rig_whose_light_is_even() {
    let folder = Folder::new();
    let wall = folder.holding("wall.obj", WALL);
    let rig = folder.name("wall.toml");
    let import = [
        "panels", "import", &wall, "--out", &rig, "--eye-at", "0,0,0.5",
    ];
    let lit = [
        "--projector",
        "west at=-0.7,0,0 pixels=120x68 throw=1.5 blend=6",
        "--projector",
        "east at=0.7,0,0 look=-2,0,0 pixels=120x68 fov=37 blend=6",
    ];
    let found = json(&[&import[..], &lit].concat());
    agrees("panels import", &[&found]);
    assert_eq!(
        (&found["panels"], found["files"].as_array().unwrap().len()),
        (&Value::from(2), 3)
    );
    let white = folder.name("white.png");
    json(&[
        "panels", "pattern", "white", "--size", "64x36", "--out", &white,
    ]);
    let out = folder.name("out");
    json(&["panels", "warp", &rig, &white, "--out", &out]);
    let west = Rgb::read(&format!("{out}/west.png"));
    // Alone it is white; at its right edge all light is the other's.
    assert_eq!(west.at([10, 34]), [255; 3]);
    assert!(west.at([119, 34])[0] < 60, "{:?}", west.at([119, 34]));
    let refuse = |more: &[&str], words: &[&str]| {
        let out = folder.name("none.toml");
        let all = [&["panels", "import", &wall, "--out", &out], more].concat();
        refused(2, &all, words);
    };
    refuse(&[], &["--projector"]);
    for (projector, words) in [
        ("west", "throw=1.5"),
        ("at=0,0,0 pixels=8x6 throw=1", "expected a name"),
        ("w at=0,0,0 pixels=8x6 throw=0", "throw=0"),
        ("w at=0,0,0 pixels=8x6 throw=1 fov=40", "leave one"),
        (
            "w at=0,0,0 at=1,0,0 pixels=8x6 throw=1",
            "at is given twice",
        ),
        ("w at=0,0 pixels=8x6 throw=1", "at=0,0"),
        ("w at=0,0,nan pixels=8x6 throw=1", "at=0,0,nan"),
    ] {
        refuse(&["--projector", projector], &[words]);
    }
    let away = [&import[..4], &["none.toml", "--projector"]].concat();
    let away = [&away[..], &["w at=0,0,0 look=180,0,0 pixels=8x6 throw=1"]].concat();
    refused(1, &away, &["wall.obj", "projector \"w\"", "lights nothing"]);
    let mpcdi = ["panels", "import", &example("three"), "--out", "none.toml"];
    refused(
        2,
        &[&mpcdi[..], &lit].concat(),
        &["--projector lights a wall"],
    );
}

/// A mesh of 2 x 2 nodes that shows the middle half of the picture, darker to the right.
const MESH: &[u8] = b"2\n2 2\n-1 -1 0.25 0.25 1\n1 -1 0.75 0.25 0.5\n-1 1 0.25 0.75 1\n\
    1 1 0.75 0.75 0.5\n";

#[test]
fn rigs_go_through_files_of_other_programs_and_come_back() {
    let folder = Folder::new();
    let three = example("three");
    let out = folder.name("maps");
    let map = json(&["panels", "map", &three, "--out", &out, "--format", "mpcdi"]);
    let file = map["files"][0].as_str().unwrap();
    assert!(file.ends_with("three.mpcdi"), "{file}");
    let fit = |rig: &str| json(&["panels", "fit", rig, "--placement", "plane"]);
    let ours = folder.name("rigs/back.toml");
    let import = json(&["panels", "import", file, "--out", &ours]);
    assert_eq!(
        (&import["panels"], &import["files"][0]),
        (&Value::from(3), &Value::from(&*ours))
    );
    let wanted = fit(&three)["need_megapixels"].as_f64().unwrap();
    for rig in [file, &ours] {
        near(&fit(rig)["need_megapixels"], wanted, 1e-6);
    }
    let mesh = folder.holding("dome.data", MESH);
    let found = json(&["panels", "fit", &mesh, "--source", "400x300"]);
    assert_eq!(found["placement"], "screen");
    let imported = folder.name("dome.toml");
    let import = json(&["panels", "import", &mesh, "--out", &imported]);
    assert_eq!(import["files"].as_array().unwrap().len(), 3);
    for rig in [&mesh, &imported] {
        let at = ["--source", "400x300", "--at", "mesh:0,0"];
        let map = json(&[&["panels", "map", rig][..], &at].concat());
        near(&map["points"][0]["u"], 100.0 + 100.0 / 1080.0, 1e-4);
        near(&map["points"][0]["v"], 75.0 + 75.0 / 1080.0, 1e-4);
    }
    agrees("panels import", &[&import]);
    refused(
        2,
        &["panels", "import", &three, "--out", &ours],
        &["not an MPCDI", ".mpcdi"],
    );
    refused(
        2,
        &["panels", "import", &mesh, "--out", "a.json"],
        &["--out a.json", ".toml"],
    );
}

/// One region of 9 x 7 pixels that light points, and its black.
const POINTS: &[u8] = br#"<MPCDI profile="a3"><display><buffer><region id="wall"
xResolution="9" yResolution="7"/></buffer></display><fileset region="wall"><geometryWarpFile>
<path>wall.pfm</path><geometricUnit>cm</geometricUnit><originOf3DData>floorCenter</originOf3DData>
</geometryWarpFile><betaMap><path>black.png</path></betaMap></fileset></MPCDI>"#;

#[test]
fn points_in_space_become_the_panel_of_an_eye_that_is_told() {
    let folder = Folder::new();
    // A wall 4 m before the floor's centre, its pixels half a metre apart, up to 3 m high.
    let mut map = b"PF\n9 7\n-1.0\n".to_vec();
    for (row, column) in (0..7_u8).flat_map(|row| (0..9_u8).map(move |column| (row, column))) {
        let across = 50.0 * (f32::from(column) - 4.0);
        let point = [across, 300.0 - 50.0 * f32::from(row), -400.0];
        map.extend(point.map(f32::to_le_bytes).as_flattened());
    }
    folder.holding("wall.pfm", &map);
    let black = Rgb {
        size: [9, 7],
        pixels: (0..9 * 7 * 3).map(|k| k as u8).collect(),
    };
    black.write(&folder.name("black.png"));
    let file = folder.holding("wall.xml", POINTS);
    refused(
        1,
        &["panels", "fit", &file],
        &["originOf3DData", "--eye-at"],
    );
    let out = folder.name("wall.toml");
    let import = ["panels", "import", &file, "--out", &out];
    for eye in ["1,2", "a,b,c", "nan,0,0"] {
        let arguments = [&import[..], &["--eye-at", eye]].concat();
        refused(2, &arguments, &["as 0,1.7,2.5"]);
    }
    // 1.5 m high and 1 m behind the centre: the wall's middle is 5 m ahead, its sides at 0.45.
    let ran = done(&[&import[..], &["--eye-at", "0,1.5,1"]].concat());
    assert!(ran.stderr.contains("betaMap"), "{}", ran.stderr);
    let found = json(&["panels", "fit", &out, "--source", "9x7"]);
    near(&found["axis"]["pitch_deg"], 0.0, 1e-4);
    near(&found["tan_x"], 0.45, 1e-5);
    near(&found["tan_y"], 0.35, 1e-5);
    let at = ["panels", "map", &out, "--source", "9x7", "--at", "wall:2,1"];
    near(&json(&at)["points"][0]["u"], 2.5, 1e-3);
}

#[test]
fn figures_show_a_rig_and_what_its_pixels_take() {
    let folder = Folder::new();
    let out = folder.name("figures");
    let figures = json(&["panels", "figures", &example("three"), "--out", &out]);
    let names = folder_names(&out);
    let wanted = "above.svg filters.png grid.png lines.svg magnification.png panels.svg probes.png \
                  source.svg";
    assert_eq!(names.join(" "), wanted);
    assert_eq!(figures["files"].as_array().unwrap().len(), names.len());
    let svg = std::fs::read_to_string(format!("{out}/source.svg")).unwrap();
    assert!(
        svg.contains("3688 x 1321 pixels") && svg.contains(">R</text>"),
        "{svg}"
    );
    agrees("panels figures", &[&figures]);
}

/// A rig of one panel, with more lines.
fn rig_of(folder: &Folder, name: &str, lines: &str) -> String {
    let text = format!(
        "format = \"tiled-view/1\"\n[[panel]]\nid = \"a\"\neye = \"left\"\npixels = [80, 60]\n\
         {lines}\n"
    );
    folder.holding(name, text.as_bytes())
}

#[test]
fn what_is_no_rig_is_refused() {
    let folder = Folder::new();
    let rig = |name: &str, lines: &str| rig_of(&folder, name, lines);
    let fit = |file: &str, code: i32, words: &[&str]| {
        refused(code, &["panels", "fit", file], words);
    };
    let wrong = rig("wrong.toml", "sizes = [1, 1]");
    fit(
        &wrong,
        1,
        &["wrong.toml", "line 6", "\"size\"", "docs/formats/panels.md"],
    );
    fit(
        &rig("nan.toml", "size = [nan, 1]"),
        1,
        &["nan.toml", "line 6, panel[1].size"],
    );
    fit(
        &folder.name("none.toml"),
        1,
        &["none.toml", "cannot be read"],
    );
    fit(
        &folder.holding("a.bin", b""),
        1,
        &["a.bin", ".toml, .json, .mpcdi"],
    );
    fit(
        &folder.holding("a.txt", b"2\n5 1\n"),
        1,
        &["a.txt", "line 2", "docs/formats/panels.md"],
    );
    fit(
        &folder.holding("a.mpcdi", b"PK\x03\x04"),
        1,
        &["a.mpcdi", "not a whole zip", "export it again"],
    );
    fit(
        &folder.holding("a.json", b"{\"format\": 3}"),
        1,
        &["a.json", "line 1, format"],
    );
}

#[test]
fn what_no_source_fits_and_pixels_that_there_are_not_are_refused() {
    let folder = Folder::new();
    let far = rig_of(
        &folder,
        "far.toml",
        "size = [1, 1]\npose = { order = \"seed002\", yaw = 80 }",
    );
    let seed = ["panels", "fit", &far, "--placement", "seed"];
    refused(1, &seed, &["far.toml", "panel a", "--placement plane"]);
    refused(
        1,
        &["panels", "fit", &far, "--eye", "right"],
        &["far.toml", "--eye"],
    );
    refused(
        1,
        &["panels", "fit", &far, "--source", "0x5"],
        &["--source"],
    );
    refused(2, &["panels", "map", &far], &["--at"]);
    refused(
        2,
        &["panels", "map", &far, "--at", "b:0,0"],
        &["--at b", "one of a"],
    );
    refused(2, &["panels", "map", &far, "--at", "a:80,0"], &["80 x 60"]);
    refused(2, &["panels", "map", &far, "--at", "a:-1,0"], &["--at"]);
    refused(
        2,
        &["panels", "map", &far, "--out", &folder.name("x")],
        &["--format"],
    );
}
