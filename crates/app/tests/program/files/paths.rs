//! Are files found that a model names as they were called on another machine?

use super::row::{Row, png_of};
use crate::support::{Folder, foveal, json, refused};

const RED: [u8; 3] = [220, 20, 20];

/// A square whose material has the picture of this name.
fn square(folder: &Folder, name: &str, picture: &str) {
    folder.holding(
        &format!("{name}.mtl"),
        format!("newmtl a\nmap_Kd {picture}\n").as_bytes(),
    );
    let library = match name {
        "windows" => "C:\\Users\\me\\models\\windows.mtl".to_owned(),
        _ => format!("{name}.mtl"),
    };
    holding_square(folder, name, &library);
}

fn holding_square(folder: &Folder, name: &str, library: &str) {
    let text = format!(
        "mtllib {library}\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n\
         vt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
    );
    folder.holding(&format!("{name}.obj"), text.as_bytes());
}

#[test]
fn a_picture_is_found_by_its_name_wherever_it_lay() {
    let folder = Folder::new();
    for inner in ["textures", "maps", "lib"] {
        std::fs::create_dir(folder.name(inner)).unwrap();
    }
    folder.holding("wood.png", &png_of(RED, 4));
    folder.holding("two words.png", &png_of(RED, 4));
    folder.holding("textures/stone.PNG", &png_of(RED, 4));
    folder.holding("lib/own.png", &png_of(RED, 4));
    for (name, picture) in [
        ("plain", "wood.png"),
        ("windows", "C:\\work\\tex\\wood.png"),
        ("up", "../textures/wood.png"),
        ("quoted", "\"two words.png\""),
        ("home", "/Volumes/me/wood.png"),
        ("case", "Wood.PNG"),
        ("inner", "D:\\x\\Textures\\Stone.png"),
        ("usual", "stone.PNG"),
        ("percent", "two%20words.png"),
        ("slashes", "sub\\\\wood.png"),
        ("options", "-s 1 1 1 \"..\\tex\\wood.png\""),
    ] {
        square(&folder, name, picture);
    }
    folder.holding("lib/own.mtl", b"newmtl a\nmap_Kd own.png\n");
    holding_square(&folder, "own", "/Volumes/me/lib/own.mtl");
    let names = [
        "plain.obj",
        "windows.obj",
        "up.obj",
        "quoted.obj",
        "home.obj",
        "case.obj",
        "inner.obj",
        "usual.obj",
        "percent.obj",
        "slashes.obj",
        "options.obj",
        "own.obj",
    ];
    let row = Row::of(&folder, &names);
    row.assert_alike(&names);
    let [r, g, b] = row.colours[0];
    assert!(r > 150 && g < 60 && b < 60, "{:?}", row.colours);
    assert_eq!(row.mended("missing_images"), 0, "{}", row.told);
    row.assert_remarks(&["C:", "wood.png", "is used instead"]);
    row.assert_remarks(&["no \"Wood.PNG\"", "\"wood.png\", which is used"]);
    row.assert_remarks(&["Stone.png", "textures/stone.PNG"]);
    assert!(row.mended("files_found_elsewhere") >= 9, "{}", row.told);
    assert_eq!(row.mended("files_found_by_case"), 1, "{}", row.told);
}

#[test]
fn nothing_outside_is_opened_unless_asked_and_the_shape_comes_all_the_same() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.name("models")).unwrap();
    folder.holding("apart.png", &png_of(RED, 4));
    let place = folder.name("models");
    let write = |name: &str, text: &str| std::fs::write(format!("{place}/{name}"), text).unwrap();
    write("a.mtl", "newmtl a\nKd 0.1 0.2 0.3\nmap_Kd ../apart.png\n");
    write(
        "a.obj",
        "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
         f 1/1 2/2 3/3\n",
    );
    let (model, pack) = (format!("{place}/a.obj"), folder.name("a.foveal"));
    let told = json(&["prepare", "scene", &model, "--out", &pack]);
    assert_eq!(
        (&told["texels"], &told["leaf_triangles"]),
        (&0.into(), &1.into())
    );
    let remark = told["remarks"][0].as_str().unwrap();
    assert!(
        remark.contains("../apart.png") && remark.contains("--allow-outside"),
        "{remark}"
    );
    assert_eq!(told["repairs"]["missing_images"], 1);
    let again = json(&["info", &pack]);
    assert_eq!(again["remarks"], told["remarks"]);
    let outside = [
        "prepare",
        "scene",
        &model,
        "--out",
        &pack,
        "--force",
        "--allow-outside",
    ];
    assert_eq!(json(&outside)["texels"], 16);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../apart.png", format!("{place}/link.png")).unwrap();
        write("a.mtl", "newmtl a\nmap_Kd link.png\n");
        let told = json(&["prepare", "scene", &model, "--out", &pack, "--force"]);
        assert_eq!(told["texels"], 0, "a link that leads out");
        assert_eq!(json(&outside)["texels"], 16);
    }
    // Nothing can be shown without vertices.
    write(
        "a.gltf",
        r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"../b.bin"}]}"#,
    );
    let gltf = format!("{place}/a.gltf");
    refused(
        1,
        &["prepare", "scene", &gltf, "--dry-run"],
        &["../b.bin", "--allow-outside"],
    );
    write("a.toml", "[[input]]\nfile = \"../b.obj\"\n");
    folder.holding("b.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let site = format!("{place}/a.toml");
    assert_eq!(
        foveal(&["prepare", "scene", &site, "--dry-run"]).code,
        Some(1)
    );
    let told = json(&["prepare", "scene", &site, "--dry-run", "--allow-outside"]);
    assert_eq!(told["triangles"], 1);
}
