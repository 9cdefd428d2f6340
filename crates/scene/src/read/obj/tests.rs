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
    assert!(scene.remarks[1].contains("drawn opaque: 1 material"));
    assert_eq!(
        (scene.remarks.len(), scene.repairs["missing_images"]),
        (2, 1)
    );
    assert_eq!(scene.clouds[0].places.len(), 1);
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

/// The triangles of a text whose first lines are a square, and what was mended.
fn with_square(rest: &str) -> (usize, SourceScene) {
    let text = format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n{rest}");
    let scene = read_anything_of(&text);
    (scene.meshes[0].triangles.len(), scene)
}

fn read_anything_of(text: &str) -> SourceScene {
    assert!(read_anything(SceneFormat::Obj, text.as_bytes()), "{text:?}");
    read(text.as_bytes(), "a", &mut Nowhere).unwrap()
}

#[test]
fn what_cannot_be_costs_its_face_and_is_told_with_its_line() {
    for (rest, name, place) in [
        ("f 1 2 9\n", "triangles_out_of_range", "in line 6"),
        ("f 0 1 4\n", "triangles_out_of_range", "in line 6"),
        ("f -5 1 2\n", "triangles_out_of_range", "in line 6"),
        ("f a 1 2\n", "triangles_out_of_range", "in line 6"),
        (
            "f -9223372036854775808 1 1\n",
            "triangles_out_of_range",
            "in line 6",
        ),
        ("v 9 9\nv 1,5 0 0\n", "decimal_commas", "in line 7"),
        ("v 9 9\n", "coordinates_made", "in line 6"),
    ] {
        let (triangles, scene) = with_square(rest);
        assert_eq!(triangles, 2, "{rest:?}");
        assert_eq!(scene.repairs[name], 1, "{rest:?}");
        assert!(
            scene.remarks.iter().any(|it| it.contains(place)),
            "{rest:?}: {:?}",
            scene.remarks
        );
    }
}

#[test]
fn normals_and_places_on_textures_that_are_not_there_cost_nothing_else() {
    for (face, name) in [
        ("f 1//1 2//1 3//1\n", "normals_not_found"),
        ("f 1/7 2/7 3/7\n", "uvs_not_found"),
    ] {
        let (triangles, scene) = with_square(face);
        assert_eq!((triangles, scene.repairs[name]), (3, 3), "{face}");
    }
    let (triangles, scene) = with_square("f 1/0/0 2/0/0 3/0/0\n");
    assert_eq!((triangles, scene.remarks.len()), (3, 0));
}

#[test]
fn faces_may_stand_before_vertices_in_capitals_and_before_comments() {
    let late = "f 1/1 2/1 3/1 # first\nF 2 3 -1#x\nv 0 0 0\nV 1 0 0\nv 0 1 0 # last\nvt 0 0\n";
    let scene = read_anything_of(late);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(scene.repairs["triangles_out_of_range"], 1);
}

#[test]
fn faces_that_count_from_0_are_read_so() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 0/0 1/0 2/0\nf 0 2.0 3\n";
    let scene = read_anything_of(text);
    assert_eq!(scene.meshes[0].triangles.len(), 2);
    assert_eq!(scene.meshes[0].positions[0], glam::DVec3::ZERO);
    assert_eq!(scene.repairs["faces_from_zero"], 1);
    assert!(!scene.repairs.contains_key("uvs_not_found"));
}

#[test]
fn materials_may_be_named_before_their_library_and_before_a_comment() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl dull red # x\nf 1 2 3\nmtllib a.mtl\n";
    let scene = scene(text);
    assert_eq!(scene.materials[0].name, "dull red");
    let told: Vec<_> = scene.repairs.keys().collect();
    assert_eq!(told, ["drawn_opaque"]);
}

#[test]
fn points_or_vertices_alone_are_a_cloud_with_colours() {
    let of_points =
        "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv nan 0 0 0 0 1\nv 5 5 5 nan 1 1\np 1 2 3\np 9\n";
    let scene = read_anything_of(of_points);
    assert_eq!(scene.clouds[0].colours, [[65_535, 0, 0], [0, 65_535, 0]]);
    assert_eq!(scene.repairs["points_without_place"], 2);
    assert_eq!(scene.repairs["unused_vertices"], 2);
    let alone = read_anything_of(&of_points.replace("p ", "# "));
    assert_eq!(alone.clouds[0].places.len(), 3);
    assert_eq!(alone.clouds[0].colours[2], [65_535; 3]);
    assert_eq!(alone.repairs["colours_made"], 1);
    let lined = read_anything_of(&of_points.replace("p 1 2 3\np 9", "l 1 4"));
    assert_eq!(lined.clouds[0].places.len(), 1);
}

#[test]
fn a_library_that_breaks_loses_its_line_and_says_which() {
    let text = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mtl = "NEWMTL a\nKd red\nKD 0.5 0.5 0.5 # grey\n";
    let scene = read(text.as_bytes(), "a", &mut files(mtl)).unwrap();
    assert!(scene.materials[0].colour[0] < 0.3);
    assert_eq!(scene.repairs["lines_broken"], 1);
    assert!(
        scene.remarks[0].contains("line 2 of \"a.mtl\""),
        "{:?}",
        scene.remarks
    );
}

#[test]
fn libraries_outside_the_folder_are_left_out_by_name() {
    for name in ["../a.mtl", "/etc/passwd"] {
        let text = format!("mtllib {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let scene = read(text.as_bytes(), "a", &mut Nowhere).unwrap();
        let remarks = scene.remarks.join("\n");
        assert!(remarks.contains(name), "{remarks}");
    }
}

#[test]
fn a_file_without_faces_is_no_scene() {
    assert!(!read_anything(
        SceneFormat::Obj,
        b"v 0 0 0\nv 1 0 0\nl 1 2\n"
    ));
    assert!(!read_anything(SceneFormat::Obj, b"v 0 0 0\nf 1 2 3\n"));
    assert!(!read_anything(SceneFormat::Obj, b""));
}
