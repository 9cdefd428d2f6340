//! Is an OBJ file read with its materials, and refused where it breaks?

use std::collections::BTreeMap;

use super::super::files::{Files, Nowhere};
use super::super::mangle::cut_and_flip;
use super::super::{SceneFormat, read_anything};
use super::read;
use crate::source::SourceScene;

const MTL: &str = "newmtl dull red\nKd 0.5 0 0\nd 0.25\nnewmtl grey\nKd 1\nmap_Kd a.png\n";
const SQUARE: &str = "\
    mtllib a.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\n\
    usemtl dull red\nf 1/1/1 2/1/1 3//1 4//1\n\
    g two\nusemtl grey\nf -4 -1 -2 \\\n -3\nv 5 5 5\np 1\nl 1 2 3\n";

fn files(mtl: &str) -> Files {
    Files(BTreeMap::from([("a.mtl", mtl.as_bytes().to_vec())]))
}

fn scene(text: &str) -> SourceScene {
    read(text.as_bytes(), "a", &mut files(MTL)).unwrap()
}

fn refusal(text: &str) -> String {
    let fault = read(text.as_bytes(), "a", &mut Nowhere).unwrap_err();
    fault.in_file("a.obj".as_ref()).to_string()
}

#[test]
fn groups_become_one_mesh_with_the_materials_of_the_library() {
    let scene = scene(SQUARE);
    let mesh = &scene.meshes[0];
    assert_eq!(scene.meshes.len(), 1);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
    assert_eq!(mesh.materials, [0, 0, 1, 1]);
    assert_eq!(mesh.positions[0], mesh.positions[4]);
    assert_eq!(mesh.normals[0], [0.0, 0.0, 1.0]);
    let [red, grey] = [&scene.materials[0], &scene.materials[1]];
    assert_eq!((red.name.as_str(), red.colour[3]), ("dull red", 0.25));
    assert!((red.colour[0] - 0.214).abs() < 1e-3);
    assert_eq!(grey.colour, [1.0; 4]);
    assert!(grey.two_sided);
    assert!(scene.remarks[0].contains("a.png"), "{:?}", scene.remarks);
    assert_eq!(
        (scene.remarks.len(), scene.repairs["missing_images"]),
        (1, 1)
    );
    assert_eq!(scene.repairs["points_left_out"], 1);
    assert_eq!(scene.repairs["lines_left_out"], 2);
    assert_eq!(scene.repairs["unused_vertices"], 1);
}

#[test]
fn a_library_that_is_missing_leaves_surfaces_white() {
    let scene = read(SQUARE.as_bytes(), "a", &mut Nowhere).unwrap();
    assert!(scene.remarks[0].contains("a.mtl"), "{:?}", scene.remarks);
    assert_eq!(scene.materials[0].colour, [1.0; 4]);
    assert_eq!(scene.repairs["materials_not_found"], 2);
    assert_eq!(scene.repairs["material_files_missing"], 1);
}

#[test]
fn a_library_elsewhere_is_the_one_of_that_name_here_or_none() {
    for name in ["../a.mtl", "/etc/a.mtl", "C:\\x\\A.MTL", "\"a.mtl\""] {
        let scene = scene(&SQUARE.replace("a.mtl", name));
        assert_eq!(scene.materials[0].colour[3], 0.25, "{name}");
    }
    for name in ["../b.mtl", "/etc/passwd"] {
        let scene = scene(&SQUARE.replace("a.mtl", name));
        let told = &scene.remarks[0];
        assert!(
            told.contains(name) && told.contains("does not lie in"),
            "{told}"
        );
    }
}

#[test]
fn black_beneath_a_picture_is_white_and_large_colours_are_codes() {
    let mtl = "newmtl dull red\nKd 255 0 0\nnewmtl grey\nKd 0 0 0\nmap_Kd a.png\n";
    let scene = read(SQUARE.as_bytes(), "a", &mut files(mtl)).unwrap();
    assert_eq!(scene.materials[0].colour, [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(scene.materials[1].colour, [1.0; 4]);
    assert_eq!(scene.repairs["black_under_textures"], 1);
}

#[test]
fn vertices_may_have_colours_and_far_coordinates() {
    let scene = scene("v 1e7 0 0 1 0 0\nv 10000000.001 0 0\nv 0 1 0 1 1 1\nf 1 2 3\n");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.colours, [[1.0, 0.0, 0.0, 1.0], [1.0; 4], [1.0; 4]]);
    assert_eq!(mesh.positions[1].x, 10_000_000.001);
    assert!(mesh.normals.is_empty());
}

#[test]
fn no_cut_and_no_flip_of_a_byte_panics() {
    cut_and_flip(SceneFormat::Obj, SQUARE.as_bytes());
}

#[test]
fn what_cannot_be_is_refused_with_its_line() {
    for (text, what) in [
        ("v 0 0 nan\n", "line 1: a coordinate is nan"),
        ("v 0 0\n", "line 1: a coordinate is missing"),
        ("v 0 0 1e999\n", "line 1: a coordinate is 1e999"),
        (
            "v 0 0 0\n\nf 1 1 2\n",
            "line 3: names vertex 2, but 1 stand",
        ),
        ("v 0 0 0\nf 0 1 1\n", "line 2: names vertex 0"),
        ("v 0 0 0\nf -2 1 1\n", "line 2: names vertex -2"),
        ("v 0 0 0\nf 1//1 1 1\n", "line 2: names normal 1"),
        (
            "v 0 0 0\nf -9223372036854775808 1 1\n",
            "line 2: names vertex",
        ),
        (
            "v 0 0 0\nf a 1 1\n",
            "line 2: \"a\" is no number of a vertex",
        ),
    ] {
        let refused = refusal(text);
        assert!(refused.contains(what), "{text:?}: {refused}");
    }
}

#[test]
fn a_library_that_breaks_is_refused_with_its_name_and_line() {
    let fault = read(b"mtllib a.mtl\n", "a", &mut files("newmtl a\nKd red\n"));
    let refused = fault.unwrap_err().in_file("a.obj".as_ref()).to_string();
    let place = "its \"a.mtl\", line 2: a colour is \"red\"";
    assert!(refused.contains(place), "{refused}");
}

#[test]
fn a_file_without_faces_is_no_scene() {
    assert!(!read_anything(SceneFormat::Obj, b"v 0 0 0\nv 1 0 0\n"));
    assert!(!read_anything(SceneFormat::Obj, b""));
}
