//! Is what OBJ files say about looks shown, or reported?

use std::collections::BTreeMap;

use super::super::files::Files;
use super::read;
use crate::source::SourceScene;

/// A square of a material, with or without texture coordinates.
fn square(name: &str, has_uvs: bool) -> String {
    let uvs = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let face = match has_uvs {
        true => format!("{uvs}f 1/1 2/2 3/3 4/4\n"),
        false => "f 1 2 3 4\n".to_owned(),
    };
    format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl {name}\n{face}")
}

/// A PNG of one texel.
fn png_of(texel: [u8; 4]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&texel).unwrap();
    drop(writer);
    bytes
}

fn scene(obj: &str, mtl: &[u8]) -> SourceScene {
    let files = [
        ("a.mtl", mtl.to_vec()),
        ("a.png", png_of([255; 4])),
        ("leaf.png", png_of([255, 255, 255, 90])),
        ("two  blanks.png", png_of([255; 4])),
    ];
    read(obj.as_bytes(), "a", &mut Files(BTreeMap::from(files))).unwrap()
}

/// Asserts that something was mended this many times, and reported in these words.
#[track_caller]
fn assert_told(scene: &SourceScene, name: &str, times: u64, words: &str) {
    assert_eq!(
        scene.repairs.get(name),
        Some(&times),
        "{name}: {:?}",
        scene.repairs
    );
    let has = |it: &String| it.contains(words);
    assert!(
        scene.remarks.iter().any(has),
        "{words}: {:?}",
        scene.remarks
    );
}

#[test]
fn the_last_of_two_materials_of_one_name_is_shown_whole() {
    let twice = scene(
        &square("m", true),
        b"newmtl m\nKd 1 0 0\nmap_Kd a.png\nnewmtl m\nKd 0 1 0\n",
    );
    assert_eq!(twice.materials[0].colour, [0.0, 1.0, 0.0, 1.0]);
    assert!(twice.materials[0].texture.is_none());
    assert_told(&twice, "materials_defined_twice", 1, "\"m\"");
    let same = scene(
        &square("m", true),
        b"newmtl m\nKd 1 0 0\nnewmtl m\nKd 1 0 0\n",
    );
    assert!(same.repairs.is_empty() && same.remarks.is_empty());
}

#[test]
fn materials_are_found_by_other_capitals_and_blanks() {
    for name in ["WOOD (1)", "wood_(1)", "Wood\t (1)"] {
        let found = scene(&square(name, false), b"newmtl Wood_(1)\nKd 1 0 0\n");
        assert_eq!(found.materials[0].colour, [1.0, 0.0, 0.0, 1.0], "{name}");
        assert_told(&found, "materials_found_by_case", 1, "capitals or blanks");
    }
    let blanks = scene(&square("my  wood", false), b"newmtl my\twood\nKd 1 0 0\n");
    assert_eq!(blanks.materials[0].colour, [1.0, 0.0, 0.0, 1.0]);
    assert!(blanks.repairs.is_empty(), "{:?}", blanks.repairs);
    let none = scene(&square("stone", false), b"newmtl wood\nKd 1 0 0\n");
    assert_told(&none, "materials_not_found", 1, "\"stone\"");
    let null = scene(&square("(null)", false), b"newmtl wood\nKd 1 0 0\n");
    assert!(null.repairs.is_empty(), "{:?}", null.repairs);
}

#[test]
fn a_picture_on_what_has_no_coordinates_is_told() {
    let bare = scene(&square("m", false), b"newmtl m\nmap_Kd a.png\n");
    assert_told(&bare, "textures_without_coordinates", 1, "material \"m\"");
    let half = square("m", true) + "f 1 3 4\n";
    let half = scene(&half, b"newmtl m\nmap_Kd a.png\n");
    assert_told(&half, "textures_without_coordinates", 1, "material \"m\"");
    assert!(half.meshes[0].uvs.iter().flatten().all(|it| *it <= 1.0));
    let good = scene(&square("m", true), b"newmtl m\nmap_Kd two  blanks.png\n");
    assert!(good.repairs.is_empty(), "{:?}", good.repairs);
}

#[test]
fn what_is_half_transparent_is_told() {
    for mtl in [
        "newmtl m\nd 0.3\n",
        "newmtl m\nTr 0.7\n",
        "newmtl m\nmap_d a.png\n",
        "newmtl m\nmap_Kd leaf.png\n",
    ] {
        let told = scene(&square("m", true), mtl.as_bytes());
        assert_told(&told, "drawn_opaque", 1, "1 material, the first \"m\"");
    }
    for mtl in ["newmtl m\nd 1\nTr 0\n", "newmtl m\nmap_Kd a.png\n"] {
        let told = scene(&square("m", true), mtl.as_bytes());
        assert!(told.repairs.is_empty(), "{mtl}: {:?}", told.repairs);
    }
}

#[test]
fn colours_of_vertices_show_on_black_and_as_zbrush_paints_them() {
    let coloured = square("m", false).replace(" 0\nv", " 0 1 0 0\nv");
    let black = scene(&coloured, b"newmtl m\nKd 0 0 0\n");
    assert_eq!(black.materials[0].colour, [1.0; 4]);
    assert_told(&black, "black_under_colours", 1, "\"m\"");
    let plain = scene(&square("m", false), b"newmtl m\nKd 0 0 0\n");
    assert_eq!(plain.materials[0].colour[..3], [0.0; 3]);
    let painted = square("m", false) + "#MRGB ffff0000ff00ff00\n#MRGB ff0000ffffffffff\n";
    let told = scene(&painted, b"newmtl m\nKd 1 1 1\n");
    let colours = &told.meshes[0].colours;
    assert_eq!(colours[0], [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(colours[2], [0.0, 0.0, 1.0, 1.0]);
    assert!(told.repairs.is_empty() && told.remarks.is_empty());
    let few = scene(&painted.replace("ff00ff00", ""), b"newmtl m\nKd 1 1 1\n");
    assert_told(&few, "colours_of_another_number", 1, "3 for 4");
}

#[test]
fn colours_by_numbers_of_cie_are_converted_and_spectra_told() {
    let red = scene(
        &square("m", false),
        b"newmtl m\nKd xyz 0.4124 0.2126 0.0193\n",
    );
    let [r, g, b, _] = red.materials[0].colour;
    assert!(r > 0.99 && g < 0.01 && b < 0.01, "{:?}", red.materials[0]);
    let grey = scene(&square("m", false), b"newmtl m\nKd spectral a.rfl 0.5\n");
    assert_eq!(grey.materials[0].colour[..3], [0.5; 3]);
    assert_told(&grey, "spectra_left_out", 1, "spectra");
}

#[test]
fn pictures_that_should_be_changed_are_told() {
    let told = scene(&square("m", true), b"newmtl m\nmap_Kd -mm 0.5 0.1 a.png\n");
    assert!(told.materials[0].texture.is_some());
    assert_told(&told, "texture_options_left_out", 1, "-mm");
    let usual = scene(
        &square("m", true),
        b"newmtl m\nmap_Kd -mm 0 1 -t 0 0 0 a.png\n",
    );
    assert!(usual.repairs.is_empty());
}

#[test]
fn a_library_that_is_no_text_or_says_nothing_is_told() {
    let packed = scene(&square("m", false), b"PK\x03\x04\x14\0\0\0\x08\0");
    assert_told(&packed, "material_files_missing", 1, "it is not text");
    let page = scene(&square("m", false), b"<html>404</html>\n");
    assert!(page.remarks.iter().any(|it| it.contains("no `newmtl`")));
}

#[test]
fn faces_with_commas_blanks_and_comments_are_read_as_meant() {
    let vertices = "v 0 0 0 // first\nv 1 0 0\nv 1 1 0\nvt 0 0\n";
    for face in [
        "f 1,2,3",
        "f 1 /1 2 /1 3 /1",
        "f 1, 2, 3",
        "f 1/1,2/1,3/1 // c",
        "f (1;2;3)",
        "f 1\\1 2\\1 3\\1",
    ] {
        let told = scene(&format!("{vertices}{face}\n"), b"");
        assert_eq!(told.meshes[0].triangles, [[0, 1, 2]], "{face}");
        assert!(told.repairs["faces_with_odd_signs"] > 0, "{face}");
    }
    for face in ["f 1 2 3 // c", "f 1 2 3 //", "f 1//2 2//1 3//1 # c"] {
        let told = scene(&format!("vn 0 0 1\nvn 0 0 1\n{vertices}{face}\n"), b"");
        assert_eq!(told.meshes[0].triangles, [[0, 1, 2]], "{face}");
        assert!(told.remarks.is_empty(), "{face}: {:?}", told.remarks);
    }
    let merged = scene(&format!("{vertices}<<<<<<< ours\n=======\nf 1 2 3\n"), b"");
    assert_told(&merged, "lines_broken", 2, "in line 5");
}
