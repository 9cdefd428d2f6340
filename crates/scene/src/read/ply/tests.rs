//! Is a PLY file read alike in all its encodings, and refused where it breaks?

use super::super::files::Nowhere;
use super::super::mangle::cut_and_flip;
use super::super::single::SceneFile;
use super::super::{SceneFormat, Up, read_anything};
use super::read;
use crate::source::SourceScene;

const POSITIONS: [[f64; 3]; 5] = [
    [10_000_000.001, 0.0, 0.0],
    [10_000_001.002, 0.0, 0.0],
    [10_000_001.0, 1.0, 0.0],
    [10_000_000.0, 1.0, -0.003],
    [0.0, 0.0, 9.0],
];
const FACES: [&[i32]; 2] = [&[0, 1, 2, 3], &[4, 1, 0]];

#[derive(Clone, Copy)]
enum Write {
    Text,
    Little,
    Big,
}

/// A square and a triangle with normals and colours, with a list to be skipped.
fn ply(encoding: Write) -> Vec<u8> {
    let name = match encoding {
        Write::Text => "ascii",
        Write::Little => "binary_little_endian",
        Write::Big => "binary_big_endian",
    };
    let header = format!(
        "ply\r\nformat {name} 1.0\r\ncomment made\nelement other 1\nproperty list uchar short l\n\
         element vertex 5\nproperty double x\nproperty float64 y\nproperty double z\n\
         property char nx\nproperty short ny\nproperty float nz\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty ushort alpha\n\
         element face 2\nproperty list uchar int vertex_indices\nend_header\r\n"
    );
    let mut file = header.into_bytes();
    let mut put = |little: &[u8], text: String| match encoding {
        Write::Text => file.extend(text.bytes().chain([b' '])),
        Write::Little => file.extend(little),
        Write::Big => file.extend(little.iter().rev()),
    };
    put(&[2], "2".into());
    put(&7i16.to_le_bytes(), "7".into());
    put(&(-8i16).to_le_bytes(), "-8\n".into());
    for position in POSITIONS {
        for along in position {
            put(&along.to_le_bytes(), along.to_string());
        }
        put(&[0], "0".into());
        put(&0i16.to_le_bytes(), "0".into());
        put(&2f32.to_le_bytes(), "2.0".into());
        for code in [255, 188, 0] {
            put(&[code], code.to_string());
        }
        put(&u16::MAX.to_le_bytes(), format!("{}\n", u16::MAX));
    }
    for face in FACES {
        put(&[face.len() as u8], face.len().to_string());
        for corner in face {
            put(&corner.to_le_bytes(), format!("{corner}\n"));
        }
    }
    file
}

fn scene(bytes: &[u8]) -> SourceScene {
    read(bytes, "a").unwrap()
}

fn refusal(bytes: &[u8]) -> String {
    let fault = read(bytes, "a").unwrap_err();
    fault.in_file("a.ply".as_ref()).to_string()
}

fn text(elements: &str, rows: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{elements}\nend_header\n{rows}").into_bytes()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z";
const FACE: &str = "property list uchar int vertex_index";

#[test]
fn all_encodings_give_the_same_mesh() {
    let [first, others @ ..] = [Write::Text, Write::Little, Write::Big].map(|e| scene(&ply(e)));
    let mesh = &first.meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 1, 0]]);
    assert_eq!(mesh.positions[0].x, 10_000_000.001);
    assert_eq!(mesh.normals[0], [0.0, 0.0, 2.0]);
    let [red, green, blue, alpha] = mesh.colours[0];
    assert_eq!([red, blue, alpha], [1.0, 0.0, 1.0]);
    assert!((green - 0.503).abs() < 1e-3, "{green}");
    assert!(first.materials[0].two_sided);
    for other in &others {
        let other = &other.meshes[0];
        assert_eq!(other.positions, mesh.positions);
        assert_eq!(other.normals, mesh.normals);
        assert_eq!(other.colours, mesh.colours);
        assert_eq!(other.triangles, mesh.triangles);
    }
}

#[test]
fn no_cut_and_no_flip_of_a_byte_panics() {
    for encoding in [Write::Text, Write::Little, Write::Big] {
        cut_and_flip(SceneFormat::Ply, &ply(encoding));
    }
}

#[test]
fn strips_of_triangles_turn_every_second_one() {
    let elements = format!(
        "element vertex 4\n{XYZ}\nelement tristrips 1\nproperty list int int vertex_indices"
    );
    let bytes = text(
        &elements,
        "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n",
    );
    let triangles = [[0, 1, 2], [1, 3, 2], [0, 1, 2]];
    assert_eq!(scene(&bytes).meshes[0].triangles, triangles);
}

#[test]
fn a_cut_file_shows_its_whole_rows_and_says_that_others_are_missing() {
    for encoding in [Write::Text, Write::Little, Write::Big] {
        let whole = ply(encoding);
        let cut = scene(&whole[..whole.len() - 8]);
        assert_eq!(cut.meshes[0].triangles.len(), 2);
        assert_eq!(cut.repairs["rows_missing"], 1);
        assert!(
            cut.remarks[0].contains("is face 1 of 2"),
            "{:?}",
            cut.remarks
        );
    }
    // Without faces the vertices are points.
    let whole = ply(Write::Little);
    let cut = scene(&whole[..whole.len() - 40]);
    assert_eq!(cut.clouds[0].places.len(), 4);
    assert_eq!(cut.clouds[0].colours[0][2], 0);
    assert_eq!(cut.repairs["rows_missing"], 3);
    let elements = format!("element vertex 3\n{XYZ}");
    let cut = scene(&text(&elements, "0 0 0\n1 0 0\n1 0"));
    assert_eq!(cut.clouds[0].places.len(), 2);
    assert!(refusal(b"ply\nformat ascii 1.0\n").contains("before `end_header`"));
}

#[test]
fn counts_beyond_the_file_take_no_time() {
    for count in ["3", "18446744073709551615"] {
        let elements = format!("element vertex {count}\n{XYZ}");
        assert_eq!(scene(&text(&elements, "0 0 0\n")).clouds[0].places.len(), 1);
    }
    let rowless = text("element vertex 18446744073709551615\nelement face 9", "");
    assert!(refusal(&rowless).contains("no `x` and `y`"));
    let rowless = format!("element vertex 1\n{XYZ}\nelement face 18446744073709551615");
    assert!(!read_anything(SceneFormat::Ply, &text(&rowless, "0 0 0\n")));
    let elements = format!("element vertex 1\n{XYZ}\nelement face 1\n{FACE}");
    let long = scene(&text(&elements, "0 0 0\n200 0 0 0\n"));
    assert_eq!((long.clouds.len(), long.repairs["rows_missing"]), (1, 1));
}

#[test]
fn the_wrong_end_first_is_refused() {
    let little = String::from_utf8_lossy(&ply(Write::Little)[..60]).into_owned();
    assert!(little.contains("binary_little_endian"));
    let at = little.find("little").unwrap();
    let mut wrong = ply(Write::Little);
    wrong.splice(at..at + 6, *b"big");
    assert!(!read_anything(SceneFormat::Ply, &wrong));
}

#[test]
fn what_is_no_number_or_no_vertex_costs_its_triangle() {
    let elements = format!("element vertex 4\n{XYZ}\nelement face 2\n{FACE}");
    for (rows, name) in [
        ("0 nan 0\n3 0 1 2\n3 0 1 3\n", "triangles_without_place"),
        (
            "1 0 -nan(ind)\n3 0 1 2\n3 0 1 3\n",
            "triangles_without_place",
        ),
        ("1 0\n3 0 1 2\n3 0 1 3\n", "triangles_without_place"),
        ("1 1 0\n3 0 1 2\n3 0 1 4\n", "triangles_out_of_range"),
        ("1 1 0\n3 0 1 2\n3 0 1 -2\n", "triangles_out_of_range"),
        ("1 1 0\n3 0 1 2\n3 0 1\n", "triangles_out_of_range"),
        ("1 1 0\n3 0 1 2\n4 0 1 3 4.5\n", "triangles_out_of_range"),
        ("1 1 0\n3 0 1 2\n99 0 1 3\n", "lines_broken"),
    ] {
        let bytes = text(&elements, &format!("0 0 0\n0 1 0\n1 0 0\n{rows}"));
        let file = SceneFile {
            name: "a",
            format: SceneFormat::Ply,
            up: Up::Y,
            bytes: &bytes,
        };
        let scene = file.read(&mut Nowhere).unwrap();
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]], "{rows}");
        assert!(
            scene.repairs.contains_key(name),
            "{rows}: {:?}",
            scene.repairs
        );
    }
}

#[test]
fn rows_are_lines_where_the_first_is_one() {
    let elements = format!("element vertex 3\n{XYZ}\nelement face 1\n{FACE}");
    for rows in [
        "0 0 0\n0 1 0\n1 0 0\n3 0 1 2\n",
        "0 0 0 7\n0 1 0 8 8\n1 0 0\n3 0 1 2 99\n",
        "0 0 0 0 1 0 1 0 0 3 0 1 2",
        "0 0\n0 0 1 0\n1 0 0 3\n0 1 2",
        "# a comment\n0 0 0\n\ncomment more\n0 1 0\n1 0 0\n3 0 1 2\n",
        "0 0 0\r0 1 0\r1 0 0\r3 0 1 2\r",
    ] {
        let scene = scene(&text(&elements, rows));
        assert_eq!(scene.meshes[0].positions[1], glam::DVec3::Y, "{rows}");
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]], "{rows}");
        let is_long = rows.contains('8');
        assert_eq!(scene.repairs.contains_key("rows_too_long"), is_long);
    }
}

#[test]
fn rows_beyond_those_announced_are_left_out_and_told() {
    for encoding in [Write::Text, Write::Little, Write::Big] {
        let mut file = ply(encoding);
        assert!(scene(&[&file[..], b"\n \0"].concat()).repairs.is_empty());
        let more: &[u8] = match encoding {
            Write::Text => b"3 0 1 2\n3 0 1 2\n",
            _ => &[3; 26],
        };
        file.extend(more);
        assert_eq!(scene(&file).repairs["rows_left_out"], 2);
    }
}

#[test]
fn headers_of_other_programs_are_read() {
    let plain = format!("element vertex 3\n{XYZ}\nelement face 1\n{FACE}");
    let rows = "0 0 0\n0 1 0\n1 0 0\n3 0 1 2\n";
    let whole = String::from_utf8(text(&plain, rows)).unwrap();
    for changed in [
        whole.replace('\n', "\r\n"),
        whole.replace('\n', "\r"),
        whole.replace("uchar int vertex_index", "UCHAR int64 vertices"),
        whole.replace("ply\n", "PLY\nobj_info made\n"),
    ] {
        let scene = scene(changed.as_bytes());
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]], "{changed}");
        assert!(scene.repairs.is_empty());
    }
}

#[test]
fn headers_without_meaning_are_refused_by_line() {
    for (elements, what) in [
        ("element vertex x", "line 3"),
        ("property float x", "line 3"),
        ("element vertex 1\nproperty quarter x", "line 4"),
        ("element vertex 1\nproperty float x", "no `x` and `y`"),
        (
            &format!("element vertex 1\n{XYZ}\nproperty float w\nelement vertex 1\n{XYZ}"),
            "two",
        ),
    ] {
        let refused = refusal(&text(elements, "0 0 0 0\n0 0 0\n"));
        assert!(refused.contains(what), "{refused}");
    }
    assert!(refusal(b"plx").contains("begins with"));
}

#[test]
fn points_without_faces_are_a_cloud_half_a_step_off_at_most() {
    let rows = "0.1 2 3 255 0 7\n-50.25 1e-3 8 1 2 3\n";
    let properties = "property float x\nproperty float y\nproperty float z\n\
                      property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let bytes = text(&format!("element vertex 2\n{properties}"), rows);
    let scene = scene(&bytes);
    assert!(scene.objects.is_empty() && scene.repairs.is_empty());
    let cloud = &scene.clouds[0];
    let told = [[0.1, 2.0, 3.0], [-50.25, 1e-3, 8.0]];
    for (place, told) in cloud.places.iter().zip(told) {
        for k in 0..3 {
            let at = f64::from(place[k]) * cloud.scale[k] + cloud.offset[k];
            assert!(
                (at - told[k]).abs() <= cloud.scale[k] / 2.0,
                "{at} {}",
                told[k]
            );
        }
    }
    assert!(cloud.scale[0] <= 50.35 / f64::from(1 << 20));
    assert_eq!(cloud.colours, [[65_535, 0, 7 * 257], [257, 514, 771]]);
}

#[test]
fn points_that_stand_nowhere_are_left_out_with_their_colours() {
    let properties =
        format!("{XYZ}\nproperty uchar red\nproperty uchar green\nproperty uchar blue");
    let bytes = text(
        &format!("element vertex 3\n{properties}"),
        "1 2 3 1 1 1\nnan 0 0 2 2 2\n4 5 6 3 3 3\n",
    );
    let scene = scene(&bytes);
    assert_eq!(scene.clouds[0].colours, [[257; 3], [771; 3]]);
    assert_eq!(scene.clouds[0].places.len(), 2);
    assert_eq!(scene.repairs["points_without_place"], 1);
    assert!(
        scene.remarks[0].contains("is vertex 1"),
        "{:?}",
        scene.remarks
    );
    let none = text(&format!("element vertex 0\n{properties}"), "");
    assert!(!read_anything(SceneFormat::Ply, &none));
}

#[test]
fn colours_of_faces_part_vertices_and_stay_behind_those_of_vertices() {
    let elements = |of_vertex: &str| {
        format!(
            "element vertex 4\n{XYZ}{of_vertex}\nelement face 2\n{FACE}\nproperty uchar red\n\
             property uchar green\nproperty uchar blue"
        )
    };
    let faces = "3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";
    let rows = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let mesh = &scene(&text(&elements(""), &format!("{rows}{faces}"))).meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(mesh.positions[3], mesh.positions[0]);
    let [red, blue] = [[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]];
    assert_eq!(mesh.colours, [red, red, red, blue, blue, blue]);
    let of_vertex = "\nproperty uchar red\nproperty uchar green\nproperty uchar blue";
    let rows = "0 0 0 0 255 0\n1 0 0 0 255 0\n1 1 0 0 255 0\n0 1 0 0 255 0\n";
    let both = scene(&text(&elements(of_vertex), &format!("{rows}{faces}")));
    assert_eq!(both.meshes[0].colours, [[0.0, 1.0, 0.0, 1.0]; 4]);
    assert!(
        both.remarks[0].contains("faces are left out"),
        "{:?}",
        both.remarks
    );
}

#[test]
fn colours_that_are_no_numbers_are_white_and_compressed_splats_are_refused() {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n\
        property float y\nproperty float z\nproperty float red\nproperty float green\n\
        property float blue\nend_header\n"
        .to_vec();
    for number in [
        0.0,
        0.0,
        0.0,
        128.0,
        0.0,
        f32::NAN,
        1.0,
        0.0,
        0.0,
        255.0,
        0.0,
        51.0,
    ] {
        bytes.extend(number.to_le_bytes());
    }
    let made = scene(&bytes);
    assert_eq!(made.clouds[0].colours, [[65_535; 3], [65_535, 0, 13_107]]);
    assert_eq!(made.repairs["colours_made"], 1);
    let packed = text("element vertex 1\nproperty uint packed_position", "7\n");
    assert!(refusal(&packed).contains("splats are compressed"));
}

/// A square of text whose faces have these properties and rows.
fn faces(properties: &str, rows: &str) -> SourceScene {
    let count = rows.lines().count();
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
         property float z\nelement face {count}\n{properties}end_header\n0 0 0\n1 0 0\n1 1 0\n\
         0 1 0\n{rows}"
    );
    assert!(read_anything(SceneFormat::Ply, text.as_bytes()), "{text}");
    read(text.as_bytes(), "a").unwrap()
}

#[test]
fn corners_of_faces_are_found_under_other_names() {
    let lists = "property list uchar int indices\n";
    let numbers = "property int v1\nproperty int v2\nproperty int v3\n";
    let other = "property list uchar int texnumbers\nproperty list uchar int vertex_id\n";
    let letters = "property uchar flags\nproperty uint a\nproperty uint b\nproperty uint c\n";
    for (properties, rows) in [
        (lists, "3 0 1 2\n3 0 2 3\n"),
        (numbers, "0 1 2\n0 2 3\n"),
        (other, "2 5 6 3 0 1 2\n2 5 6 3 0 2 3\n"),
        (letters, "9 0 1 2\n9 0 2 3\n"),
    ] {
        let scene = faces(properties, rows);
        let triangles = &scene.meshes[0].triangles;
        assert_eq!(*triangles, [[0, 1, 2], [0, 2, 3]], "{properties}");
        assert_eq!(scene.repairs["corners_of_another_name"], 1);
        assert_eq!(scene.remarks.len(), 1);
    }
}

#[test]
fn faces_that_count_from_1_are_read_so() {
    let list = "property list uchar int vertex_indices\n";
    let scene = faces(list, "3 1 2 3\n3 1 3 4\n");
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(scene.repairs["faces_from_one"], 1);
    // One that names vertex 0 has a fault elsewhere.
    let scene = faces(list, "3 0 1 2\n3 1 3 4\n");
    assert!(!scene.repairs.contains_key("faces_from_one"));
}

#[test]
fn faces_have_the_colours_of_materials_that_they_name() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 2\nproperty list uchar int vertex_indices\n\
        property int material_index\nelement material 2\nproperty uchar ambient_red\n\
        property uchar diffuse_red\nproperty uchar diffuse_green\nproperty uchar diffuse_blue\n\
        end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 0\n3 0 2 3 1\n9 255 0 0\n9 0 0 255\n";
    let scene = read(text.as_bytes(), "a").unwrap();
    let mesh = &scene.meshes[0];
    let colour = |triangle: usize| mesh.colours[mesh.triangles[triangle][0] as usize];
    assert_eq!(colour(0), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(colour(1), [0.0, 0.0, 1.0, 1.0]);
    assert!(scene.repairs.is_empty() && scene.remarks.is_empty());
    let bare = text
        .replace("property int material_index\n", "")
        .replace("2 0\n3", "2\n3");
    let scene = read(bare.replace("3 1\n9", "3\n9").as_bytes(), "a").unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 2);
    assert_eq!(scene.repairs["materials_left_out"], 1);
}

#[test]
fn colours_that_cloudcompare_keeps_as_numbers_are_shown() {
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
        property float z\nproperty float scalar_Red\nproperty float scalar_Green\n\
        property float scalar_Blue\nend_header\n0 0 0 255 0 0\n1 0 0 0 0 255\n";
    let scene = read(text.as_bytes(), "a").unwrap();
    assert_eq!(scene.clouds[0].colours, [[65_535, 0, 0], [0, 0, 65_535]]);
}
