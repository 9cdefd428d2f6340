//! Is what is wrong in a rig file refused with its line and key?

use super::super::places::RigSyntax;
use super::{json_of, one, parsed, toml};

/// What is wrong, and what the message names. `line` of JSON is another.
type Wrong<'a> = (&'a str, &'a [&'a str]);

/// Lines of one panel.
const LINES: [Wrong<'_>; 16] = [
    (
        "size = [1, 1]\nalpha = \"a.png\"",
        &["line 6", "panel[1].alpha", "is not there"],
    ),
    (
        "sizes = [1, 1]",
        &["line 5", "\"sizes\"", "nearest is \"size\""],
    ),
    ("size = [0, 1]", &["line 5", "panel[1].size", "above 0"]),
    ("size = [nan, 1]", &["line 5", "panel[1].size"]),
    ("size = [inf, 1]", &["line 5", "panel[1].size"]),
    (
        "size = \"big\"",
        &["line 5", "panel[1].size", "invalid type"],
    ),
    ("", &["line 2", "panel[1]", "either size or tangents"]),
    (
        "size = [1, 1]\ntangents = { left = 1, right = 1, up = 1, down = 1 }",
        &["size or tangents"],
    ),
    (
        "size = [1, 1]\npose = { yaw = 3 }",
        &["line 6", "panel[1].pose", "order"],
    ),
    (
        "size = [1, 1]\npose = { order = \"seed002\", yaw = nan }",
        &["line 6", "panel[1].pose.yaw"],
    ),
    (
        "size = [1, 1]\npose = { quaternion = [0, 0, 0, 0] }",
        &["line 6", "panel[1].pose.quaternion", "no turn"],
    ),
    (
        "size = [1, 1]\neye = \"lefft\"",
        &["line 6", "\"lefft\"", "\"left\""],
    ),
    ("size = [1, 1]\nblend = -1", &["line 6", "panel[1].blend"]),
    (
        "size = [1, 1]\ngain = [1, nan, 1]",
        &["line 6", "panel[1].gain"],
    ),
    ("size = [1, 1]\nblack = 2", &["line 6", "panel[1].black"]),
    (
        "size = [1, 1]\noutput = { x = -1 }",
        &["line 6", "panel[1].output.x"],
    ),
];

/// Optics of one panel.
const OPTICS: [Wrong<'_>; 12] = [
    (
        "model = \"bulge\", b = 0.6, sign = \"toward-eye\"",
        &["distortion", "folds"],
    ),
    (
        "model = \"bulge\", b = 1.5, sign = \"toward-eye\"",
        &["distortion", "folds"],
    ),
    ("model = \"bulge\", b = 0.1", &["line 6", "distortion.sign"]),
    (
        "model = \"bulge\", sign = \"toward-eye\"",
        &["line 6", "distortion.b"],
    ),
    (
        "model = \"bulge\", k = [1, 1, 1]",
        &["line 6", "distortion.k", "has no k"],
    ),
    (
        "model = \"polynomial\", coefficients = []",
        &["line 6", "distortion.coefficients"],
    ),
    (
        "model = \"polynomial\", coefficients = [nan]",
        &["line 6", "distortion.coefficients"],
    ),
    (
        "model = \"brown-conrady\", k = [-9, 0, 0]",
        &["line 6", "folds"],
    ),
    (
        "model = \"grid\", columns = 2, rows = 2",
        &["line 6", "distortion.points", "0 are not"],
    ),
    (
        "model = \"pfm\", file = \"a.pfm\"",
        &["line 6", "distortion.file", "is not there"],
    ),
    (
        "model = \"pfm\", red = { file = \"a.pfm\" }",
        &["line 6", "distortion", "together"],
    ),
    ("model = \"lens\"", &["line 6", "\"lens\"", "docs/formats"]),
];

/// Outputs of a second panel of 80 x 60 pixels, where the first has its own at 0, 0.
const OUTPUTS: [Wrong<'_>; 3] = [
    (
        "{ x = 79 }",
        &["line 11", "panel[2].output", "over that of \"a\""],
    ),
    (
        "{ x = 80, monitor = \"DP-1\" }",
        &["line 11", "panel[2].output", "two monitors"],
    ),
    (
        "{ surface = \"a/b\" }",
        &["line 11", "panel[2].output.surface", "names no file"],
    ),
];

/// The text is refused, and the message names all that it should; in JSON too, if that can say it.
fn assert_refused(text: &str, names: &[&str]) {
    let has_none = text.contains("nan") || text.contains("inf,");
    let json = (!has_none).then(|| (RigSyntax::Json, json_of(text)));
    for (syntax, text) in [(RigSyntax::Toml, text.to_owned())].into_iter().chain(json) {
        let error = parsed(&text, syntax).unwrap_err();
        for name in names {
            let is_line = syntax == RigSyntax::Json && name.starts_with("line");
            let name = if is_line { "line " } else { *name };
            assert!(error.contains(name), "{error}: no {name:?}\n{text}");
        }
        assert!(error.contains("docs/formats/panels.md"), "{error}");
    }
}

#[test]
fn what_is_wrong_with_a_panel_is_refused_with_its_line_and_key() {
    for (lines, names) in LINES {
        assert_refused(&one(lines), names);
    }
    for (optics, names) in OPTICS {
        let lines = format!("size = [1, 1]\ndistortion = {{ {optics} }}");
        assert_refused(&one(&lines), names);
    }
}

#[test]
fn what_is_wrong_with_a_whole_rig_is_refused_with_its_line_and_key() {
    let two = |id: &str, output: &str| {
        let first = one("size = [1, 1]\noutput = { x = 0, y = 0 }");
        let panel = format!("[[panel]]\nid = {id:?}\npixels = [80, 60]\nsize = [1, 1]\n");
        format!("{first}{panel}output = {output}\n")
    };
    for (output, names) in OUTPUTS {
        assert_refused(&two("b", output), names);
    }
    assert_refused(&two("A", "{ x = 80 }"), &["line 8", "panel[2].id", "twice"]);
    let sound = one("size = [1, 1]");
    assert_refused("format = \"tiled-view/1\"\n", &["missing field `panel`"]);
    assert_refused(
        "format = \"tiled-view/1\"\npanel = []\n",
        &["line 2", "panel", "none"],
    );
    assert_refused(
        "format = \"tiled-view/2\"\npanel = []\n",
        &["line 1", "format"],
    );
    assert_refused(
        &format!("mirror = true\n{sound}"),
        &["line 1", "mirror", "left"],
    );
    assert_refused(
        &format!("screen = [0, 1]\n{sound}"),
        &["line 1", "screen", "no width and height"],
    );
    assert_refused(&format!("ipd_mm = -1\n{sound}"), &["line 1", "ipd_mm"]);
    for broken in [
        "",
        "panel = [",
        "\"a\" = 3\n= 4",
        "{",
        "[1, 2]",
        "{\"panel\": [{]}",
    ] {
        for syntax in [RigSyntax::Toml, RigSyntax::Json] {
            assert!(parsed(broken, syntax).is_err(), "{broken}");
        }
    }
}

#[test]
fn ids_that_name_no_file_are_refused() {
    for id in [
        "",
        ".",
        "..",
        "a/b",
        "a\\\\b",
        "../a",
        ".a",
        "a:b",
        "atlas",
        "a\\u0000b",
        "a.",
    ] {
        let text = one("size = [1, 1]").replace("\"a\"", &format!("\"{id}\""));
        let error = toml(&text).unwrap_err();
        assert!(error.contains("line 3, panel[1].id"), "{id}: {error}");
    }
}

#[test]
fn more_than_1024_panels_are_refused_with_their_twins() {
    let panels = |count: usize| {
        let one = |k| {
            format!("[[panel]]\nid = \"p{k}\"\neye = \"left\"\npixels = [8, 6]\nsize = [1, 1]\n")
        };
        let all: String = (0..count).map(one).collect();
        format!("format = \"tiled-view/1\"\n{all}")
    };
    assert_eq!(toml(&panels(1024)).unwrap().panels.len(), 1024);
    assert!(toml(&panels(1025)).unwrap_err().contains("more than 1024"));
    let mirrored = format!("mirror = true\n{}", panels(513));
    assert!(toml(&mirrored).unwrap_err().contains("with twins"));
    assert_eq!(
        toml(&format!("mirror = true\n{}", panels(512)))
            .unwrap()
            .panels
            .len(),
        1024
    );
}
