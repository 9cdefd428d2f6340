//! Does a rig file give the panels that it describes, and is what is wrong refused by its place?

mod fades;
mod foreign;
mod lenient;
mod meshes;
mod points;
mod refused;
mod walls;
mod writers;

use std::path::{Path, PathBuf};

use foveal_core::view::panel::distortion::{Distortion, GREEN};
use foveal_core::view::panel::fit::{FitError, PlacementRule, fit};
use foveal_core::view::panel::rig::{Panel, Rig, Scanout};
use foveal_core::view::surface::Eye;
use glam::DVec3;
use proptest::prelude::*;

use super::places::RigSyntax;
use super::{parse_rig, read_any_pfm, read_any_rig, read_rig, rig_schema};

const EXAMPLES: [&str; 6] = ["three", "six", "twelve", "wall-2x2", "dome-4", "lens"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn example_text(name: &str) -> String {
    std::fs::read_to_string(root().join(format!("examples/panels/{name}.toml"))).unwrap()
}

fn example(name: &str) -> Rig {
    read_rig(&root().join(format!("examples/panels/{name}.toml"))).unwrap()
}

fn parsed(text: &str, syntax: RigSyntax) -> Result<Rig, String> {
    let nothing = |_: &str| Err("is not there".to_owned());
    parse_rig(text.as_bytes(), syntax, &nothing).map_err(|fault| fault.to_string())
}

fn toml(text: &str) -> Result<Rig, String> {
    parsed(text, RigSyntax::Toml)
}

/// The same file in the other language.
fn json_of(text: &str) -> String {
    let value: toml::Value = toml::from_str(text).unwrap();
    serde_json::to_string_pretty(&value).unwrap()
}

#[test]
fn every_example_is_read_and_has_the_panels_it_describes() {
    let counts = [6, 12, 24, 4, 4, 2];
    for (name, count) in EXAMPLES.iter().zip(counts) {
        let rig = example(name);
        assert_eq!(rig.panels.len(), count, "{name}");
        let same = parsed(&json_of(&example_text(name)), RigSyntax::Json);
        assert_eq!(same.unwrap(), rig, "{name}");
        assert!(read_any_rig(example_text(name).as_bytes()));
    }
    let three = example("three");
    let ids: Vec<&str> = three.panels.iter().map(|it| it.id.as_str()).collect();
    assert_eq!(ids, ["L", "C", "R", "L.right", "C.right", "R.right"]);
    let corner = three.panels[0].corners()[0];
    let wanted = DVec3::new(-0.942194856, 0.3375, -0.561042648);
    assert!(corner.distance(wanted) < 1e-9, "{corner}");
    // Twins stand next to what they mirror, before the other eye.
    assert_eq!(three.panels[3].output.x, 2400);
    assert_eq!(three.panels[3].view.position.x, 0.0315);
    assert_eq!(three.seen_by(Some(Eye::Right)).len(), 3);
    assert_eq!(example("wall-2x2").seen_by(Some(Eye::Right)).len(), 4);
    let names = |rig: &Rig| {
        rig.panels[..3]
            .iter()
            .map(|it| it.id.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&example("twelve")), ["r0c0", "r0c1", "r0c2"]);
    let lens = &example("lens").panels[0];
    assert_eq!(
        (lens.scanout, lens.sent_size()),
        (Scanout::Rot90, [1600, 1440])
    );
}

#[test]
fn mirrored_panels_mirror_every_ray() {
    for name in ["three", "twelve", "lens"] {
        let rig = example(name);
        let half = rig.panels.len() / 2;
        for (own, twin) in rig.panels[..half].iter().zip(&rig.panels[half..]) {
            assert_eq!(twin.id, format!("{}.right", own.id));
            let [w, h] = own.view.size.map(f64::from);
            for place in [[0.0, 0.0], [100.25, 17.0], [w / 2.0, h / 3.0], [w, h]] {
                for channel in 0..3 {
                    let ray = own.ray_at(place, channel).unwrap().ray.normalize();
                    let there = twin.ray_at([w - place[0], place[1]], channel).unwrap();
                    let mirrored = DVec3::new(-ray.x, ray.y, ray.z);
                    assert!(there.ray.normalize().distance(mirrored) < 1e-12, "{name}");
                }
            }
        }
    }
}

#[test]
fn every_example_is_fitted_and_only_a_dome_needs_a_curved_source() {
    for name in EXAMPLES {
        let rig = example(name);
        let panels = rig.seen_by(Some(Eye::Left));
        let found = fit(&panels, PlacementRule::Auto, None).unwrap();
        let is_plane = ["three", "six", "wall-2x2", "lens"].contains(&name);
        assert_eq!(found.name == "plane", is_plane, "{name}: {}", found.name);
        assert!(
            found.panels.iter().all(|it| it.sigma_min >= 0.999),
            "{name}"
        );
        assert!(found.map_error < 0.1, "{name}: {}", found.map_error);
    }
    // The seed's plane cannot serve what looks 90° away; the panel is named.
    let rig = example("dome-4");
    let panels: Vec<&Panel> = rig.panels.iter().collect();
    let error = fit(&panels, PlacementRule::Seed, None).unwrap_err();
    assert!(matches!(&error, FitError::Beyond { panel, .. } if panel == "west" || panel == "east"));
    assert!(
        error.to_string().contains("--placement equirect"),
        "{error}"
    );
}

/// A rig of one panel, with more lines.
fn one(lines: &str) -> String {
    format!("format = \"tiled-view/1\"\n[[panel]]\nid = \"a\"\npixels = [80, 60]\n{lines}\n")
}

#[test]
fn poses_say_the_same_by_angles_and_by_quaternion() {
    let forward = |pose: &str| {
        let rig = toml(&one(&format!("size = [1, 1]\npose = {pose}"))).unwrap();
        rig.panels[0].view.axes
    };
    let [sin, cos] = [20.0_f64.to_radians().sin(), 20.0_f64.to_radians().cos()];
    // 40° to the right is a right-handed turn by -40° about y.
    let turned = forward(&format!(
        "{{ quaternion = [0, {}, 0, {}] }}",
        -3.0 * sin,
        3.0 * cos
    ));
    for order in ["seed002", "yaw-pitch-roll"] {
        let angles = forward(&format!("{{ order = \"{order}\", yaw = 40 }}"));
        assert!(angles.forward.distance(turned.forward) < 1e-12);
        assert!(angles.right.distance(turned.right) < 1e-12);
    }
    let up = forward("{ order = \"yaw-pitch-roll\", yaw = 40, pitch = 10 }")
        .forward
        .y;
    let down = forward("{ order = \"seed002\", pitch = 10 }").forward.y;
    assert!(up > 0.17 && down < -0.17);
}

#[test]
fn the_written_schema_is_that_of_the_program() {
    let path = root().join("docs/formats/tiled-view.schema.json");
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    let told = rig_schema();
    assert!(
        written == told,
        "docs/formats/tiled-view.schema.json is not what `panels schema` prints:\n{told}"
    );
}

/// A map of 4 x 3 pixels, each at its own place but for one.
fn pfm_bytes(odd: f32) -> Vec<u8> {
    let mut bytes = b"PF\n4 3\n-1.0\n".to_vec();
    for row in (0..3).rev() {
        for column in 0..4 {
            let x = if (column, row) == (3, 2) {
                odd
            } else {
                (column as f32 + 0.5) / 4.0
            };
            for value in [x, (row as f32 + 0.5) / 3.0, 0.0] {
                bytes.extend(value.to_le_bytes());
            }
        }
    }
    bytes
}

#[test]
fn maps_of_floats_are_read_where_they_fit_and_unlit_pixels_stay_dark() {
    let text = "format = \"tiled-view/1\"\n[[panel]]\nid = \"a\"\npixels = [4, 3]\nsize = [1, 1]\n\
        distortion = { model = \"pfm\", file = \"a.pfm\" }\n";
    let read = |bytes: Vec<u8>| {
        let beside = move |_: &str| Ok(bytes.clone());
        parse_rig(text.as_bytes(), RigSyntax::Toml, &beside).map_err(|fault| fault.to_string())
    };
    let rig = read(pfm_bytes(f32::NAN)).unwrap();
    let panel = &rig.panels[0];
    assert!(matches!(panel.distortion, Distortion::Grid(_)));
    let bent = |place| panel.distortion.ideal(&panel.view, place, GREEN);
    let place = bent([1.5, 1.5]).unwrap().place;
    assert!((place[0] - 1.5).abs() < 1e-6 && (place[1] - 1.5).abs() < 1e-6);
    assert_eq!(bent([3.5, 2.5]), None);
    assert!(
        read(pfm_bytes(f32::INFINITY))
            .unwrap_err()
            .contains("at column 3, line 0")
    );
    let mut other = pfm_bytes(0.9);
    other[3] = b'5';
    assert!(read(other).is_err(), "numbers of a larger map are missing");
    for cut in 0..pfm_bytes(0.9).len() {
        assert!(!read_any_pfm(&pfm_bytes(0.9)[..cut]));
    }
    assert!(read_any_pfm(&pfm_bytes(0.875)));
    let windows = [&b"PF\r\n4 3\r\n-1.0\r\n"[..], &pfm_bytes(0.875)[12..]].concat();
    assert!(read_any_pfm(&windows));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_text_panics(
        text in "\\PC{0,80}",
        name in 0..EXAMPLES.len(),
        share in 0.0..1.0f64,
        byte in any::<u8>(),
    ) {
        read_any_rig(text.as_bytes());
        let whole = example_text(EXAMPLES[name]);
        for whole in [json_of(&whole), whole] {
            let at = (share * whole.len() as f64) as usize;
            let mut changed = whole.as_bytes().to_vec();
            changed[at] = byte;
            read_any_rig(&changed);
            read_any_rig(&changed[..at]);
        }
        read_any_pfm(text.as_bytes());
    }
}

#[test]
fn deep_brackets_are_refused() {
    for bracket in ["[", "{\"panel\":["] {
        assert!(!read_any_rig(bracket.repeat(50_000).as_bytes()));
        assert!(!read_any_rig(
            format!("panel = {}", bracket.repeat(50_000)).as_bytes()
        ));
    }
}
