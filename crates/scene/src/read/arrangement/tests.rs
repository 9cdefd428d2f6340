//! Does a scene file put files where it says, and is what is wrong in it refused by its place?

use std::path::PathBuf;

use glam::DVec3;
use proptest::prelude::*;

use super::super::{ReadOptions, read, read_any_arrangement};
use super::keys::{KEYS, Keys};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const STL: &str =
    "solid a\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 3\nendloop\nendsolid\n";

/// A folder with two 3D files and a scene file.
struct Site(PathBuf);

impl Site {
    fn new(name: &str, text: &str) -> Self {
        let name = format!("foveal-site-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(path.join("models")).unwrap();
        std::fs::write(path.join("a.obj"), OBJ).unwrap();
        std::fs::write(path.join("models/b.stl"), STL).unwrap();
        std::fs::write(path.join("site.toml"), text).unwrap();
        Self(path)
    }

    fn read(&self) -> Result<crate::source::SourceScene, String> {
        let file = self.0.join("site.toml");
        let scene = read(&[&file], &ReadOptions::default());
        scene.map_err(|error| error.to_string())
    }
}

impl Drop for Site {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const SITE: &str = r##"
background = "#ff0080"
light = [0, 2, 0]

[[input]]
file = "a.obj"
name = "tree"
place = [
    { translation = [5, 0, 0] },
    { rotation_deg = [0, 90, 0], scale = 2 },
    { rotation_deg = [90, 0, 90], scale = [1.0, 3.0, 1.0], translation = [0, 0, 1] },
]

[[input]]
file = "models/b.stl"
up = "y"
"##;

#[test]
fn files_stand_in_all_their_places_before_a_background_and_in_a_light() {
    let scene = Site::new("places", SITE).read().unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["tree", "b"]);
    let tree = &scene.objects[0].placements;
    let ends = tree
        .iter()
        .map(|it| it.transform_point3(DVec3::new(1.0, 1.0, 0.0)));
    // About x, then y, then z, right-handed.
    let wanted = [[6.0, 1.0, 0.0], [0.0, 2.0, -2.0], [0.0, 1.0, 4.0]];
    for (found, wanted) in ends.zip(wanted) {
        assert!(found.distance(DVec3::from_array(wanted)) < 1e-9, "{found}");
    }
    assert_eq!(tree.len(), 3);
    // One without a place stands as it is, with y up where it says so.
    assert_eq!(scene.objects[1].placements, [glam::DAffine3::IDENTITY]);
    let background = scene.background.unwrap();
    assert_eq!(background[..2], [1.0, 0.0]);
    assert!((background[2] - 0.2159).abs() < 1e-3, "{background:?}");
    assert_eq!(scene.light, Some(DVec3::new(0.0, 2.0, 0.0)));
    assert_eq!(scene.bytes as usize, SITE.len() + OBJ.len() + STL.len());
    assert_eq!(scene.hashes.len(), 3);
}

#[test]
fn points_stand_in_all_their_places_too() {
    let place = "place = [{ translation = [0, 2, 0], scale = 0.5 }, {}]";
    let site = Site::new("cloud", &format!("[[input]]\nfile = \"p.ply\"\n{place}"));
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
                property float z\nend_header\n0 0 0\n1 0 0\n";
    std::fs::write(site.0.join("p.ply"), text).unwrap();
    let cloud = &site.read().unwrap().clouds[0];
    let half = cloud.placements[0].matrix3 * DVec3::X;
    assert_eq!(cloud.placements.len(), 2);
    let lengths = [half.length(), cloud.placements[1].matrix3.x_axis.length()];
    assert!(
        (2.0 * lengths[0] / lengths[1] - 1.0).abs() < 1e-9,
        "{lengths:?}"
    );
    let lift = cloud.placements[0].translation.y - 0.5 * cloud.placements[1].translation.y;
    assert!((lift - 2.0).abs() < 1e-9, "{lift}");
}

#[test]
fn what_is_not_said_is_as_usual() {
    let scene = Site::new("bare", "[[input]]\nfile = \"a.obj\"")
        .read()
        .unwrap();
    assert_eq!((scene.background, scene.light), (None, None));
    assert_eq!(scene.look(), Default::default());
    assert_eq!(scene.objects[0].name, "a");
}

/// A scene file with `more` after its one input.
fn with(more: &str) -> String {
    format!("[[input]]\nfile = \"a.obj\"\n{more}")
}

fn assert_refused(all: &[(&str, String, &str)]) {
    for (name, text, said) in all {
        let error = Site::new(name, text).read().unwrap_err();
        assert!(error.contains(said), "{name}: {error}");
        assert!(error.contains("; "), "it says what to do next: {error}");
    }
}

#[test]
fn a_key_that_there_is_not_is_refused_with_its_line_and_the_nearest_name() {
    assert_refused(&[
        (
            "key",
            "bakground = \"#fff\"".to_owned(),
            "line 1: there is no key \"bakground\"; the nearest is \"background\"",
        ),
        (
            "inner",
            with("plcae = []"),
            "line 3: there is no key \"plcae\"; the nearest is \"place\"",
        ),
        (
            "deep",
            with("place = [{ translate = [1, 2, 3] }]"),
            "the nearest is \"translation\"",
        ),
        ("table", with("[other]"), "there is no key \"other\""),
    ]);
}

#[test]
fn numbers_and_types_that_are_none_are_refused_by_their_place() {
    let place = |text: &str| with(&format!("place = [{text}]"));
    let before = |text: &str| format!("{text}\n{}", with(""));
    assert_refused(&[
        ("type", place("{ translation = [1, 2] }"), "line 3: "),
        (
            "scale",
            place("{ scale = \"2\" }"),
            "expected a number, or three in brackets",
        ),
        (
            "zero",
            place("{}, { scale = [1, 0, 1] }"),
            "input 1, place 2: numbers must be",
        ),
        (
            "large",
            place("{ translation = [inf, 0, 0] }"),
            "input 1, place 1: numbers",
        ),
        ("up", with("up = \"x\""), "line 3: unknown variant `x`"),
        (
            "code",
            before("background = \"#12345g\""),
            "background: \"#12345g\" is no colour like #8fb0d0",
        ),
        ("dark", before("light = [0, 0, 0]"), "light: "),
        (
            "none",
            "light = [0, 1, 0]".to_owned(),
            "input: there is none",
        ),
        (
            "nameless",
            "[[input]]\nup = \"y\"".to_owned(),
            "missing field `file`",
        ),
        ("toml", "input = [".to_owned(), "line 1: "),
    ]);
}

#[test]
fn files_that_are_missing_elsewhere_or_no_3d_files_are_refused_by_name() {
    let file = |name: &str| format!("[[input]]\nfile = \"{name}\"");
    assert_refused(&[
        (
            "missing",
            file("c.glb"),
            "site.toml: its file \"c.glb\" cannot be read",
        ),
        (
            "out",
            file("../a.obj"),
            "file \"../a.obj\": does not lie in the folder",
        ),
        (
            "itself",
            file("site.toml"),
            "input 1: \"site.toml\" is not a 3D file",
        ),
    ]);
}

#[test]
fn what_is_wrong_in_a_file_is_said_of_that_file() {
    let site = Site::new("there", "[[input]]\nfile = \"a.obj\"");
    std::fs::write(site.0.join("a.obj"), "v 0 0 nan\nf 1 1 1").unwrap();
    let error = site.read().unwrap_err();
    assert!(
        error.contains("a.obj: there is nothing to draw") && error.contains("NaN"),
        "{error}"
    );
}

#[test]
fn a_small_file_cannot_put_objects_into_places_without_end() {
    let many = "{},".repeat(1100);
    let text = format!("[[input]]\nfile = \"a.gltf\"\nplace = [{many}]");
    let site = Site::new("many", &text);
    let nodes = vec!["{\"mesh\":0}"; 1100].join(",");
    let roots: Vec<String> = (0..1100).map(|it| it.to_string()).collect();
    let gltf = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{}]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "buffers":[{{"byteLength":36,"uri":"a.bin"}}]}}"#,
        roots.join(",")
    );
    std::fs::write(site.0.join("a.gltf"), gltf).unwrap();
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    std::fs::write(site.0.join("a.bin"), corners.map(f32::to_le_bytes).concat()).unwrap();
    let error = site.read().unwrap_err();
    assert!(error.contains("more than 262144 places"), "{error}");
}

#[test]
fn the_schema_has_the_keys_that_are_read() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/formats/scene.schema.json"
    );
    let schema: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_keys(&schema, &KEYS);
}

fn assert_keys(schema: &serde_json::Value, keys: &Keys) {
    let said: Vec<&String> = schema["properties"].as_object().unwrap().keys().collect();
    let mut names = keys.names.to_vec();
    names.sort_unstable();
    assert_eq!(said, names);
    assert_eq!(schema["additionalProperties"], false);
    for (table, keys) in keys.tables {
        assert_keys(&schema["properties"][table]["items"], keys);
    }
}

proptest! {
    #[test]
    fn no_text_panics(text in "\\PC{0,80}", at in 0..SITE.len(), byte in any::<u8>()) {
        read_any_arrangement(text.as_bytes());
        let mut changed = SITE.as_bytes().to_vec();
        changed[at] = byte;
        read_any_arrangement(&changed);
        read_any_arrangement(&changed[..at]);
    }
}

#[test]
fn deep_brackets_are_refused() {
    assert!(!read_any_arrangement(
        format!("light = {}", "[".repeat(100_000)).as_bytes()
    ));
    assert!(read_any_arrangement(SITE.as_bytes()));
}
