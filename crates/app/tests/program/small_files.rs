//! Does a small file take little, whatever it claims, and are the files it names searched for
//! only next to it?
//!
//! Memory is what the program itself measured, or a limit of the system.

use crate::support::{Folder, Ran, assert_refused, command, finish, foveal, glb, json_of};
use serde_json::{Value, json};
use std::os::unix::fs::symlink;
use std::process::Command;

/// A run that may map so many KiB and open so many files.
fn limited(kib: u64, files: u64, arguments: &[&str]) -> Ran {
    let plain = command(arguments);
    let mut limited = Command::new("sh");
    let limits = format!("ulimit -t 60; ulimit -v {kib}; ulimit -n {files}; exec \"$@\"");
    limited.args(["-c", &limits, "sh"]);
    limited.arg(plain.get_program()).args(plain.get_args());
    finish(limited)
}

/// Prepares a scene within 1.5 GB of address space; what it says of it, and on stderr.
fn prepared(folder: &Folder, input: &str) -> (Value, String) {
    let pack = folder.name("pack.foveal");
    let _ = std::fs::remove_file(&pack);
    let ran = limited(
        1_500_000,
        256,
        &["prepare", "scene", input, "--out", &pack, "--json"],
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    (json_of(&ran), ran.stderr)
}

fn peak_mb(said: &Value) -> u64 {
    said["peak_memory_bytes"].as_u64().unwrap() / 1_000_000
}

/// A white PNG of one bit a texel.
fn white([columns, rows]: [u32; 2]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, columns, rows);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().unwrap();
    let row = columns.div_ceil(8) as usize;
    writer
        .write_image_data(&vec![255; row * rows as usize])
        .unwrap();
    drop(writer);
    file
}

/// A square that shows a picture once.
fn square_with(picture: &[u8]) -> Vec<u8> {
    let places = [
        [0.0_f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ];
    let uvs = [[0.0_f32, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.0]];
    let mut binary: Vec<u8> = places
        .as_flattened()
        .iter()
        .flat_map(|it| it.to_le_bytes())
        .collect();
    binary.extend(uvs.as_flattened().iter().flat_map(|it| it.to_le_bytes()));
    binary.extend([0, 1, 2, 1, 3, 2, 0, 0]);
    binary.extend(picture);
    let about = json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
            {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 4},
            {"bufferView": 2, "componentType": 5121, "type": "SCALAR", "count": 6}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 6},
            {"buffer": 0, "byteOffset": 88, "byteLength": picture.len()}],
        "buffers": [{"byteLength": binary.len()}]
    });
    glb(&about, &binary)
}

#[test]
fn a_picture_takes_memory_for_some_of_its_rows_and_one_that_is_too_large_is_named() {
    let folder = Folder::new();
    // Whole, it would take 101 MB: 4 bytes for each of its texels, one for what is decoded, and one
    // for what is halved.
    let long = folder.holding("long.glb", &square_with(&white([2048, 8192])));
    let (said, _) = prepared(&folder, &long);
    assert_eq!(said["texels"], 2048 * 8192, "{said}");
    let small = folder.holding("small.glb", &square_with(&white([64, 64])));
    let (without, _) = prepared(&folder, &small);
    let more = peak_mb(&said) - peak_mb(&without).min(peak_mb(&said));
    assert!(more < 95, "{more} MB more than a small one");
    // What packs 268 million texels into some kilobytes, and what is wider than textures are.
    for (name, size, words) in [
        ("huge.glb", [16_384, 16_384], "has 16384 x 16384 texels"),
        (
            "wide.glb",
            [100_000, 1],
            "has 100000 x 1 texels, and at most 16384",
        ),
    ] {
        let input = folder.holding(name, &square_with(&white(size)));
        let (said, stderr) = prepared(&folder, &input);
        assert!(stderr.contains(words), "{stderr}");
        assert_eq!(said["repairs"]["missing_images"], 1, "{said}");
        assert!(peak_mb(&said) < 150, "{name}: {said}");
    }
    let wide = folder.holding("wide.png", &white([100_000, 1]));
    let ran = foveal(&["prepare", "video", &wide, "--out", &folder.name("w.foveal")]);
    assert_refused(
        &ran,
        1,
        &[
            "wide.png: the picture is 100000x1 pixels",
            "make it smaller",
        ],
    );
}

#[test]
fn places_of_a_scene_file_are_counted_while_they_are_read() {
    let folder = Folder::new();
    folder.holding("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let head = "[[input]]\nfile = \"a.obj\"\nplace = [";
    // A parser that keeps all of it takes a gigabyte.
    let many = folder.holding(
        "many.toml",
        format!("{head}{}]", "{},".repeat(3_000_000)).as_bytes(),
    );
    let pack = folder.name("a.foveal");
    let prepare = ["prepare", "scene", &many, "--out", &pack];
    let ran = limited(600_000, 256, &prepare);
    assert_refused(&ran, 1, &["many.toml", "line 3", "more than 262144 places"]);
    let other = format!(
        "[[input]]\nfile = \"a.obj\"\nother = [{}]",
        "[],".repeat(3_000_000)
    );
    let other = folder.holding("other.toml", other.as_bytes());
    let ran = limited(600_000, 256, &["prepare", "scene", &other, "--out", &pack]);
    assert_refused(&ran, 1, &["other.toml", "line 3", "words besides places"]);
    // Some that fit into a pack, each with all that a place can say.
    let place = "{ translation = [1, 2, 3], rotation_deg = [0, 90, 0], scale = [1, 1, 2] },\n";
    let text = format!("{head}{}]", place.repeat(8000));
    let honest = folder.holding("honest.toml", text.as_bytes());
    let few = folder.holding("few.toml", format!("{head}{place}]").as_bytes());
    let [honest, few] = [honest, few].map(|input| prepared(&folder, &input).0);
    assert_eq!(honest["placements"].as_u64(), Some(8000), "{honest}");
    let more =
        honest["peak_memory_bytes"].as_u64().unwrap() - few["peak_memory_bytes"].as_u64().unwrap();
    // Reading takes at most ten times the file, a place in the scene some hundred bytes. Tables
    // that only many places need take the rest, however many there are.
    let most = 10 * text.len() as u64 + 8000 * 200 + (32 << 20);
    assert!(more < most, "{more}");
}

#[test]
fn meshes_of_the_same_accessors_are_one() {
    let folder = Folder::new();
    let columns = 100_u32;
    let at = |row: u32, column: u32| row * columns + column;
    let places = (0..columns * columns).flat_map(|it| {
        let [x, y] = [it % columns, it / columns].map(|it| it as f32);
        [x, y, (it % 7) as f32 / 9.0]
    });
    let mut binary: Vec<u8> = places.flat_map(f32::to_le_bytes).collect();
    let begin = binary.len();
    for (row, column) in (1..columns).flat_map(|row| (1..columns).map(move |column| (row, column)))
    {
        let [a, b, c, d] = [
            at(row - 1, column - 1),
            at(row - 1, column),
            at(row, column - 1),
            at(row, column),
        ];
        binary.extend([a, b, c, b, d, c].iter().flat_map(|it| it.to_le_bytes()));
    }
    let mesh = json!({"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]});
    let node = |number: usize| json!({"mesh": number, "translation": [number, 0, 0]});
    let about = |count: usize| {
        json!({
            "asset": {"version": "2.0"},
            "nodes": (0..count).map(node).collect::<Vec<_>>(),
            "meshes": vec![&mesh; count],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "type": "VEC3",
                 "count": columns * columns},
                {"bufferView": 1, "componentType": 5125, "type": "SCALAR",
                 "count": (binary.len() - begin) / 4}],
            "bufferViews": [
                {"buffer": 0, "byteLength": begin},
                {"buffer": 0, "byteOffset": begin, "byteLength": binary.len() - begin}],
            "buffers": [{"byteLength": binary.len()}]
        })
    };
    let [one, thousand] = [1, 1000].map(|count| {
        let input = folder.holding("grid.glb", &glb(&about(count), &binary));
        prepared(&folder, &input).0
    });
    assert_eq!(thousand["objects"], one["objects"], "{thousand}");
    assert_eq!(thousand["placements"], 1000, "{thousand}");
    let more = peak_mb(&thousand).saturating_sub(peak_mb(&one));
    assert!(more < 30, "{more} MB for 999 places");
}

#[test]
fn messages_are_bounded_whatever_they_quote() {
    let folder = Folder::new();
    let digits = "9".repeat(4_000_000);
    let long = folder.holding("long.obj", format!("v {digits} 0 0\n").as_bytes());
    let odd = folder.holding("odd.obj", format!("v x{digits} 0 0\n").as_bytes());
    let pack = folder.name("a.foveal");
    for input in [&long, &odd] {
        let ran = foveal(&["prepare", "scene", input, "--out", &pack, "--json"]);
        assert_refused(&ran, 1, &["nothing to draw", "the first is vertex 1"]);
        assert!(
            ran.stderr.len() < 1000 && ran.stdout.len() < 1000,
            "{}",
            ran.stderr.len()
        );
    }
    let title = format!("[{digits}]\ntitle = \"a\"\n");
    for text in [
        &title,
        &format!("[a]\n{digits} = 1\n"),
        &format!("[a]\ntitle = {digits}\n"),
    ] {
        let about = folder.holding("about.toml", text.as_bytes());
        let out = folder.name("site");
        let ran = foveal(&[
            "export", "site", &pack, "--about", &about, "--out", &out, "--json",
        ]);
        assert_eq!(ran.code, Some(1), "{:?}", ran.code);
        assert!(
            ran.stderr.len() < 10_000 && ran.stdout.len() < 10_000,
            "{}",
            ran.stderr.len()
        );
    }
    let word = format!("--{}", &digits[..100_000]);
    let ran = foveal(&["info", &word]);
    assert!(
        ran.code == Some(2) && ran.stderr.len() < 10_000,
        "{}",
        ran.stderr.len()
    );
}

#[test]
fn where_memory_ends_a_message_says_so() {
    let folder = Folder::new();
    let places = (0..400_000).map(|it| format!("v {} {} {}\n", it % 631, it / 631, it % 7));
    let faces = (1..399_000).map(|it| {
        let [right, below] = [it + 1, it + 631];
        format!("f {it} {right} {below}\nf {right} {} {below}\n", below + 1)
    });
    let text: String = places.chain(faces).collect();
    let input = folder.holding("large.obj", text.as_bytes());
    let pack = folder.name("a.foveal");
    let ran = limited(
        400_000,
        256,
        &["prepare", "scene", &input, "--out", &pack, "--json"],
    );
    assert_refused(&ran, 1, &["no memory left", "ulimit -v"]);
    let error = &json_of(&ran)["error"];
    assert!(
        error["next"].as_str().unwrap().contains("ulimit -v"),
        "{error}"
    );
    // As after a kill: nothing has the final name.
    assert!(!folder.join("a.foveal").exists(), "{:?}", folder.names());
}

#[test]
fn nothing_outside_its_folder_is_read_by_whatever_names_it_through_a_link() {
    let [folder, inside] = [Folder::new(), Folder::new()];
    let map = folder.holding("secret.png", &white([80, 60]));
    let obj = folder.holding("secret.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let own = inside.holding("own.png", &white([80, 60]));
    for (to, link) in [(&map, "map.png"), (&obj, "part.obj"), (&own, "near.png")] {
        symlink(to, inside.name(link)).unwrap();
    }
    let pack = inside.name("a.foveal");
    let scene = inside.holding("scene.toml", b"[[input]]\nfile = \"part.obj\"\n");
    let ran = foveal(&["prepare", "scene", &scene, "--out", &pack]);
    assert_refused(&ran, 1, &["part.obj", "does not lie in the folder"]);
    let rig = |map: &str| {
        let text = format!(
            "format = \"tiled-view/1\"\n[[panel]]\nid = \"a\"\npixels = [80, 60]\nsize = [1, 1]\n\
             alpha = \"{map}\"\n"
        );
        inside.holding("rig.toml", text.as_bytes())
    };
    let ran = foveal(&["panels", "fit", &rig("map.png")]);
    assert_refused(
        &ran,
        1,
        &["panel[1].alpha", "names no file in the rig file's folder"],
    );
    // What stays in the folder is followed.
    for name in ["own.png", "near.png"] {
        let ran = foveal(&["panels", "fit", &rig(name)]);
        assert!(!ran.stderr.contains("names no file"), "{ran:?}");
    }
    let text = "<MPCDI profile=\"2d\"><display><buffer id=\"b\" xResolution=\"80\" \
                yResolution=\"60\"><region id=\"r\" x=\"0\" y=\"0\" xSize=\"1\" ySize=\"1\">\
                <fileset><alphaMap><path>map.png</path></alphaMap></fileset></region></buffer>\
                </display></MPCDI>";
    let wall = inside.holding("wall.xml", text.as_bytes());
    let ran = foveal(&["panels", "fit", &wall]);
    assert_refused(
        &ran,
        1,
        &["map.png", "names no file in the rig file's folder"],
    );
}
