//! Do pixels that light known points look there, and is the light of black read?

use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::rig::{Panel, Scanout};
use glam::DVec3;
use proptest::prelude::*;

use super::foreign::{FRUSTUM, document, noted, zipped};
use super::{one, toml};

/// Pixels of the map, as of [`document`].
const SIZE: [u32; 2] = [8, 6];

/// A fileset of a map of points.
fn fileset(origin: &str, unit: &str) -> String {
    format!(
        "<fileset region=\"a\"><geometryWarpFile><path>a.pfm</path><geometricUnit>{unit}\
         </geometricUnit><originOf3DData>{origin}</originOf3DData></geometryWarpFile></fileset>"
    )
}

/// A float map, lines from above.
fn floats(point: impl Fn(u32, u32) -> DVec3) -> Vec<u8> {
    let [w, h] = SIZE;
    let mut file = format!("PF\n{w} {h}\n-1.0\n").into_bytes();
    for (row, column) in (0..h).flat_map(|row| (0..w).map(move |column| (row, column))) {
        let point = point(row, column).as_vec3().to_array();
        file.extend(point.map(f32::to_le_bytes).as_flattened());
    }
    file
}

fn read(profile: &str, set: &str, map: &[u8], eye: Option<[f64; 3]>) -> Result<Panel, String> {
    let text = document("", set).replace("3d", profile);
    let found = noted(&zipped(&[("a.xml", text.as_bytes()), ("a.pfm", map)]), eye)?;
    assert!(found.notes.is_empty());
    Ok(found.rig.panels[0].clone())
}

/// Where the pixels of a panel of 8 x 6 look that is turned and bent, by row and column.
fn looks(row: u32, column: u32) -> DVec3 {
    let lines = "pose = { order = \"yaw-pitch-roll\", yaw = 35, pitch = 20, roll = 8 }\n\
                 size = [1.2, 0.9]\n\
                 distortion = { model = \"polynomial\", coefficients = [1.0, 0.0, 0.1] }";
    let mut panel = toml(&one(lines)).unwrap().panels[0].clone();
    panel.view.size = SIZE;
    let place = [column, row].map(|k| f64::from(k) + 0.5);
    panel.ray_at(place, GREEN).unwrap().ray.normalize()
}

/// Points of a crooked wall that an eye sees there, from itself.
fn seen(row: u32, column: u32) -> DVec3 {
    looks(row, column) * (3.0 + f64::from((row * 5 + column * 3) % 4))
}

/// The largest angle between where a panel's pixels as sent look and where they should.
fn off(panel: &Panel, expected: impl Fn(u32, u32) -> DVec3) -> f64 {
    let seen_from_sent = panel.scanout.seen_from_sent(panel.view.size);
    let [w, h] = SIZE;
    let all = (0..h).flat_map(|row| (0..w).map(move |column| (row, column)));
    let angles = all.map(|(row, column)| {
        let sent = DVec3::new(f64::from(column) + 0.5, f64::from(row) + 0.5, 1.0);
        let place = seen_from_sent * sent;
        let ray = panel.ray_at([place.x, place.y], GREEN).unwrap().ray;
        ray.normalize().cross(expected(row, column)).length()
    });
    angles.fold(0.0, f64::max)
}

#[test]
fn pixels_look_at_the_points_of_a_map_about_the_eye() {
    let set = fileset("idealEyePoint", "unknown");
    for profile in ["a3", "A3", "sl"] {
        let panel = read(profile, &set, &floats(seen), None).unwrap();
        assert_eq!(panel.scanout, Scanout::Normal);
        assert!(off(&panel, looks) < 1e-6, "{}", off(&panel, looks));
    }
    // The lowest line first; hung from the ceiling; seen from behind.
    let from_below = read(
        "a3",
        &set,
        &floats(|row, column| seen(5 - row, column)),
        None,
    )
    .unwrap();
    assert!(off(&from_below, looks) < 1e-6);
    let turned = |row: u32, column: u32| (5 - row, 7 - column);
    let map = floats(|row, column| seen(turned(row, column).0, turned(row, column).1));
    let hung = read("a3", &set, &map, None).unwrap();
    assert!(off(&hung, |row, column| looks(5 - row, 7 - column)) < 1e-6);
    let map = floats(|row, column| seen(row, 7 - column));
    let behind = read("a3", &set, &map, None).unwrap();
    assert_eq!(behind.scanout, Scanout::FlipX);
    assert!(off(&behind, |row, column| looks(row, 7 - column)) < 1e-6);
    // Nothing is lit where there is no point.
    for none in [DVec3::ZERO, DVec3::NAN] {
        let hole = |row, column| {
            if (row, column) == (2, 3) {
                none
            } else {
                seen(row, column)
            }
        };
        let panel = read("a3", &set, &floats(hole), None).unwrap();
        assert_eq!(panel.ray_at([3.5, 2.5], GREEN), None);
        assert!(panel.ray_at([6.5, 4.5], GREEN).is_some());
    }
}

#[test]
fn an_eye_that_is_told_sees_points_from_where_it_is_in_any_unit() {
    let eye = [0.3, 1.6, 2.5];
    for (unit, length) in [("m", 1.0), ("mm", 1e-3), ("FT", 0.3048)] {
        let map = floats(|row, column| (seen(row, column) + DVec3::from(eye)) / length);
        for origin in ["floorCenter", "centerOfMass", "idealEyePoint"] {
            let panel = read("a3", &fileset(origin, unit), &map, Some(eye)).unwrap();
            assert!(off(&panel, looks) < 1e-5, "{unit} {}", off(&panel, looks));
        }
    }
}

#[test]
fn points_that_nobody_can_see_are_refused_with_what_to_do() {
    let refused = |set: &str, map: &[u8], eye, words: &[&str]| {
        let error = read("a3", set, map, eye).unwrap_err();
        for word in words {
            assert!(error.contains(word), "{error}: no {word:?}");
        }
    };
    let map = floats(seen);
    let floor = ["originOf3DData", "floorCenter", "--eye-at X,Y,Z", "metres"];
    refused(&fileset("floorCenter", "m"), &map, None, &floor);
    let eye = Some([0.0, 1.0, 0.0]);
    let furlongs = ["geometricUnit", "furlong", "mm, cm, dm"];
    refused(&fileset("floorCenter", "furlong"), &map, eye, &furlongs);
    let set = fileset("idealEyePoint", "m");
    refused(&set, &floats(|_, _| DVec3::NAN), None, &["no point"]);
    let round = floats(|row, column| {
        let angle = f64::from(column) * 0.5;
        DVec3::new(angle.sin(), 0.1 * f64::from(row), -angle.cos())
    });
    refused(&set, &round, None, &["away from its middle", "split"]);
}

/// A grey PNG.
fn grey(code: impl Fn(usize) -> u8) -> Vec<u8> {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().unwrap();
    let codes: Vec<u8> = (0..48).map(code).collect();
    writer.write_image_data(&codes).unwrap();
    writer.finish().unwrap();
    png
}

#[test]
fn an_even_black_is_taken_and_one_that_differs_from_pixel_to_pixel_is_told_of() {
    let set = "<fileset region=\"a\"><betaMap><path>b.png</path><gammaEmbedded>2</gammaEmbedded>\
        </betaMap></fileset>";
    let text = document(FRUSTUM, set);
    let of =
        |png: &[u8]| noted(&zipped(&[("a.xml", text.as_bytes()), ("b.png", png)]), None).unwrap();
    let even = of(&grey(|_| 51));
    assert!((even.rig.panels[0].black - 0.04).abs() < 1e-4 && even.notes.is_empty());
    // What is written of it says so, too, and how a panel fades and is tinted.
    let mut rig = even.rig.clone();
    (rig.panels[0].blend, rig.panels[0].gain) = (0.125, [0.5, 1.0, 2.0]);
    let files = super::super::write_rig(&rig, "a").unwrap();
    let again = toml(core::str::from_utf8(&files[0].1).unwrap()).unwrap();
    let [before, after] = [&rig, &again].map(|it| &it.panels[0]);
    assert!((before.black - after.black).abs() < 1e-12);
    assert!((before.blend - after.blend).abs() < 1e-12);
    assert_eq!(before.gain, after.gain);
    let uneven = of(&grey(|k| k as u8));
    assert_eq!(uneven.rig.panels[0].black, 0.0);
    assert!(
        uneven.notes[0].contains("\"a\": its betaMap"),
        "{:?}",
        uneven.notes
    );
}

proptest! {
    #[test]
    fn no_map_of_points_panics(
        points in prop::collection::vec(prop::array::uniform3(-9.0..9.0f64), 48),
        wild in prop::collection::vec((0..48_usize, any::<f32>()), 0..3),
        ahead in 0.0..40.0f64,
        eye in prop::option::of(prop::array::uniform3(-3.0..3.0f64)),
    ) {
        let mut points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
        for point in &mut points {
            point.z -= ahead;
        }
        for (index, float) in wild {
            points[index].y = float.into();
        }
        let at = |row: u32, column: u32| points[(row * 8 + column) as usize];
        let set = fileset("idealEyePoint", "m");
        let Ok(panel) = read("a3", &set, &floats(at), eye) else {
            return Ok(());
        };
        prop_assert!(panel.view.field.is_open());
    }
}
