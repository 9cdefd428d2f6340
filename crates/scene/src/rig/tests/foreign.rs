//! Is a rig that goes through another program's file the same rig, and is what is damaged refused?

use std::io::{Cursor, Write};
use std::sync::Arc;

use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::distortion::Distortion;
use foveal_core::view::panel::fit::{PlacementRule, SourceFit, fit};
use foveal_core::view::panel::lens::{Bulge, RadialPolynomial};
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::rig::{Panel, Rig, Scanout};
use glam::DVec3;
use proptest::prelude::*;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::super::interchange::mpcdi::{self, MpcdiRig};
use super::super::pfm;
use super::super::places::RigSyntax;
use super::super::{parse_rig, read_any_mpcdi, write_mpcdi, write_rig};
use super::{EXAMPLES, example, one, toml};

/// Pixels of the source by which a map may be another.
const SAME: f64 = 1e-5;

pub(super) fn nothing(_: &str) -> Result<Vec<u8>, String> {
    Err("is not there".to_owned())
}

pub(super) fn read(bytes: &[u8]) -> Result<Rig, String> {
    noted(bytes, None).map(|found| found.rig)
}

pub(super) fn noted(bytes: &[u8], eye: Option<[f64; 3]>) -> Result<MpcdiRig, String> {
    mpcdi::read(bytes, &nothing, eye).map_err(|fault| fault.to_string())
}

/// Places that a panel shows of a source, by columns and rows as they are sent.
fn shown(panel: &Panel, found: &SourceFit) -> Vec<Option<[f64; 2]>> {
    let map = PixelMap {
        panel,
        placement: &found.placement,
        size: found.size,
    };
    let seen = panel.scanout.seen_from_sent(panel.view.size);
    let [w, h] = panel.sent_size();
    let tried = |side: u32| {
        (0..side)
            .step_by((side as usize / 23).max(1))
            .chain([side - 1])
    };
    let pixels = tried(h).flat_map(|row| tried(w).map(move |column| [column, row]));
    let all = pixels.map(|at| {
        let place = seen * DVec3::new(f64::from(at[0]) + 0.5, f64::from(at[1]) + 0.5, 1.0);
        Some(map.at([place.x, place.y])?.place)
    });
    all.collect()
}

/// The most pixels by which two panels show other places.
fn apart(a: &Panel, b: &Panel, found: &SourceFit) -> f64 {
    assert_eq!(a.sent_size(), b.sent_size());
    let both = shown(a, found).into_iter().zip(shown(b, found));
    let apart = both.map(|it| match it {
        (Some(a), Some(b)) => (a[0] - b[0]).hypot(a[1] - b[1]),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    });
    apart.fold(0.0, f64::max)
}

fn assert_comes_back(panels: &[&Panel], found: &SourceFit) {
    let file = write_mpcdi(panels).unwrap().bytes;
    let back = read(&file).unwrap();
    assert_eq!(back.panels.len(), panels.len());
    for own in panels {
        let back = back.panels.iter().find(|it| it.id == own.id).unwrap();
        let place = |it: &Panel| {
            (
                it.id.clone(),
                it.output.surface.clone(),
                [it.output.x, it.output.y],
            )
        };
        assert_eq!(place(back), place(own));
        // What fades comes back as a picture.
        if own.blend <= 0.0 {
            assert_eq!(back.alpha_as_sent(), own.alpha_as_sent());
        }
        let off = apart(own, back, found);
        assert!(off < SAME, "{}: {off} pixels", own.id);
    }
    // Of ours, too, with its maps next to it.
    let files = write_rig(&back, "rig").unwrap();
    let beside = |name: &str| {
        let file = files.iter().find(|it| it.0 == name);
        file.map(|it| it.1.clone())
            .ok_or_else(|| "is not there".to_owned())
    };
    let ours = parse_rig(&files[0].1, RigSyntax::Toml, &beside).unwrap();
    for (own, ours) in back.panels.iter().zip(&ours.panels) {
        assert_eq!((&ours.id, &ours.output), (&own.id, &own.output));
        assert_eq!((ours.scanout, &ours.alpha), (own.scanout, &own.alpha));
        let off = apart(own, ours, found);
        assert!(off < SAME, "{}: {off} pixels", own.id);
    }
}

#[test]
fn examples_written_and_read_are_the_same_maps_within_a_hundred_thousandth_of_a_pixel() {
    for name in EXAMPLES {
        let rig = example(name);
        let panels: Vec<&Panel> = rig.panels.iter().collect();
        let found = fit(&panels, PlacementRule::Auto, None).unwrap();
        assert_comes_back(&panels, &found);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn panels_that_are_turned_bent_and_dimmed_come_back(
        scanout in 0..Scanout::ALL.len(),
        angles in [-60.0..60.0f64, -40.0..40.0, -170.0..170.0],
        reach in [0.2..0.9f64, 0.2..0.9, 0.2..0.9, 0.2..0.9],
        bend in -0.15..0.15f64,
        bulges in any::<bool>(),
    ) {
        let [yaw, pitch, roll] = angles;
        let [left, right, up, down] = reach;
        let lines = format!(
            "pose = {{ order = \"yaw-pitch-roll\", yaw = {yaw}, pitch = {pitch}, roll = {roll} }}\n\
             tangents = {{ left = {left}, right = {right}, up = {up}, down = {down} }}"
        );
        let mut rig = toml(&one(&lines)).unwrap();
        let panel = &mut rig.panels[0];
        panel.scanout = Scanout::ALL[scanout];
        let lens = RadialPolynomial { centre: [0.02, -0.01], coefficients: vec![1.0, 0.0, bend] };
        panel.distortion = match bulges {
            true => Distortion::Bulge(Bulge { height: bend }),
            false => Distortion::Polynomial(Box::new([lens.clone(), lens.clone(), lens])),
        };
        let shares = (0..80 * 60).map(|k| (k * 7919 % 65_536) as u16).collect();
        panel.alpha = Some(Arc::new(AlphaMap::new(panel.view.size, shares)));
        let panels = [&*panel];
        let found = fit(&panels, PlacementRule::Equirect, None).unwrap();
        assert_comes_back(&panels, &found);
    }
}

/// A zip of files.
pub(super) fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

pub(super) const FRUSTUM: &str = "<frustum><yaw>10</yaw><pitch>5</pitch><roll>-3</roll>\
    <rightAngle>20</rightAngle><leftAngle>-25</leftAngle><upAngle>15</upAngle>\
    <downAngle>-12</downAngle></frustum>";
pub(super) const SET: &str = "<fileset region=\"a\"><geometryWarpFile><path>a.pfm</path>\
    <interpolation>linear</interpolation></geometryWarpFile></fileset>";

/// A document of one region of 8 x 6 pixels, what stands in it, and what stands in the end.
pub(super) fn document(within: &str, after: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<MPCDI profile=\"3d\" geometry=\"1\" version=\"2.0\">\n\
         <display><buffer id=\"b\" xResolution=\"8\" yResolution=\"6\">\n\
         <region id=\"a\" xResolution=\"8\" yResolution=\"6\" x=\"0\" y=\"0\" xSize=\"1\" \
         ySize=\"1\">{within}</region></buffer></display>\n{after}</MPCDI>"
    )
}

/// A map of 8 x 6 pixels that shows three quarters of the frustum; a pair of shares right and up
/// can be changed.
pub(super) fn warp(change: impl Fn(u32, u32, [f64; 2]) -> [f64; 2]) -> Vec<u8> {
    pfm::written([8, 6], |line, column| {
        let x = (f64::from(column) + 0.5) / 8.0;
        let y = 1.0 - (f64::from(line) + 0.5) / 6.0;
        change(
            line,
            column,
            [0.125 + 0.75 * x * (0.9 + 0.1 * x), 0.125 + 0.75 * y],
        )
    })
}

pub(super) fn as_is(_: u32, _: u32, pair: [f64; 2]) -> [f64; 2] {
    pair
}

#[test]
fn all_that_writers_disagree_in_is_read() {
    let map = warp(as_is);
    let usual = document(FRUSTUM, &format!("<files>{SET}</files>"));
    let expected = read(&zipped(&[("mpcdi.xml", usual.as_bytes()), ("a.pfm", &map)])).unwrap();
    let panel = &expected.panels[0];
    assert!((panel.view.field.left - 25.0_f64.to_radians().tan()).abs() < 1e-12);
    assert!((panel.view.field.down - 12.0_f64.to_radians().tan()).abs() < 1e-12);
    assert!(panel.view.axes.forward.x > 0.1 && panel.view.axes.forward.y > 0.05);
    // Clockwise is positive; here it turns the other way.
    assert!(panel.view.axes.right.y > 0.0);
    assert!(matches!(panel.distortion, Distortion::Grid(_)));
    assert_eq!(
        (panel.id.as_str(), panel.output.surface.as_str()),
        ("a", "b")
    );
    let cases = [
        usual.replace("Resolution", "resolution"),
        usual
            .replace("xResolution", "Xresolution")
            .replace("yResolution", "Yresolution"),
        usual.replace("xSize", "xsize").replace("ySize", "YSIZE"),
        usual.to_lowercase(),
        usual
            .replace("MPCDI", "mpcdi")
            .replace("fileset", "fileSet"),
        document(FRUSTUM, SET),
        document(
            &format!("{FRUSTUM}{}", SET.replace(" region=\"a\"", "")),
            "",
        ),
        document(&format!("{FRUSTUM}<files>{SET}</files>"), ""),
        format!("\u{feff}{usual}"),
        usual.replace("<path>a.pfm</path>", "<path> .\\A.PFM </path>"),
        usual
            .replace("xmlns", "")
            .replace("<MPCDI ", "<MPCDI xmlns=\"urn:vesa\" "),
        usual.replace(" xSize=\"1\" ySize=\"1\"", ""),
        document(FRUSTUM, &format!("<files>{SET}</files>")).replacen(" xResolution=\"8\"", "", 0),
    ];
    for text in cases {
        let name = "data/other.XML";
        let found = read(&zipped(&[(name, text.as_bytes()), ("./a.pfm", &map)]));
        assert_eq!(found.as_ref(), Ok(&expected), "{text}");
    }
    // Bare, with its map next to it.
    let beside = |name: &str| {
        (name == "a.pfm")
            .then(|| map.clone())
            .ok_or_else(String::new)
    };
    let found = mpcdi::read(usual.as_bytes(), &beside, None).unwrap();
    assert_eq!((found.rig, found.notes), (expected, Vec::new()));
    // Regions of a buffer that has no pixels are displays of their own.
    let alone = usual.replacen(" xResolution=\"8\" yResolution=\"6\"", "", 1);
    let found = read(&zipped(&[("a.xml", alone.as_bytes()), ("a.pfm", &map)])).unwrap();
    assert_eq!(found.panels[0].output.surface, "a");
}

#[test]
fn maps_are_read_whichever_way_up_they_lie() {
    let text = document(FRUSTUM, &format!("<files>{SET}</files>"));
    let of = |map: Vec<u8>| {
        let rig = read(&zipped(&[("a.xml", text.as_bytes()), ("a.pfm", &map)])).unwrap();
        rig.panels[0].clone()
    };
    let pixel = |line: u32, column: u32| {
        let map = warp(as_is);
        let map = pfm::FloatMap::of(&map, [8, 6]).unwrap();
        map.pair(line as usize, column as usize)
    };
    let upright = of(warp(as_is));
    assert_eq!(upright.scanout, Scanout::Normal);
    // The lowest line first, as most float maps are.
    let from_below = of(warp(|line, column, _| pixel(5 - line, column)));
    assert_eq!(from_below, upright);
    // Seen from behind.
    let mirrored = of(warp(|line, column, _| pixel(line, 7 - column)));
    assert_eq!(mirrored.scanout, Scanout::FlipX);
    assert_eq!(mirrored.distortion, upright.distortion);
    // Hung from the ceiling.
    let turned = of(warp(|line, column, _| pixel(5 - line, 7 - column)));
    assert_eq!(turned.scanout, Scanout::Normal);
    let first = turned
        .distortion
        .ideal(&turned.view, [0.5, 0.5], 1)
        .unwrap();
    let last = upright
        .distortion
        .ideal(&upright.view, [7.5, 5.5], 1)
        .unwrap();
    assert_eq!(first.place, last.place);
    // Nothing is lit where a number is invalid.
    let holed = of(warp(|line, column, pair| match (line, column) {
        (2, 3) => [f64::NAN; 2],
        _ => pair,
    }));
    assert_eq!(holed.distortion.ideal(&holed.view, [3.5, 2.5], 1), None);
    assert!(holed.distortion.ideal(&holed.view, [6.5, 4.5], 1).is_some());
}

#[test]
fn alpha_is_read_as_linear_light_and_a_flat_profile_is_a_screen() {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 8, 6);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[128; 8 * 6 * 3]).unwrap();
    writer.finish().unwrap();
    let set = "<fileset region=\"a\"><alphaMap><path>a.png</path><gammaEmbedded>2.2\
        </gammaEmbedded></alphaMap></fileset>";
    let text = document(FRUSTUM, set);
    let rig = read(&zipped(&[("a.xml", text.as_bytes()), ("a.png", &png)])).unwrap();
    let share = rig.panels[0].alpha.as_ref().unwrap().at([3, 3]);
    assert_eq!(
        share,
        ((128.0_f64 / 255.0).powf(2.2) * 65_535.0).round() as u16
    );
    // The right half of a picture of 16 x 6 pixels.
    let flat = "<MPCDI profile=\"2d\"><display><buffer xResolution=\"16\" yResolution=\"6\">\
        <region id=\"a\" x=\"0.5\" y=\"0\" xSize=\"0.5\" ySize=\"1\"/></buffer></display></MPCDI>";
    let rig = read(flat.as_bytes()).unwrap();
    let screen = rig.screen.unwrap();
    let panels: Vec<&Panel> = rig.panels.iter().collect();
    let found = fit(&panels, PlacementRule::Screen(screen), Some([16, 6])).unwrap();
    let map = PixelMap {
        panel: panels[0],
        placement: &found.placement,
        size: found.size,
    };
    let place = map.of_pixel([0, 0]).unwrap().place;
    assert!(
        (place[0] - 8.5).abs() < 1e-9 && (place[1] - 0.5).abs() < 1e-9,
        "{place:?}"
    );
}

/// A wrong document, and what the message names.
type WrongDocument = (String, &'static [&'static str]);

fn wrong_documents() -> [WrongDocument; 14] {
    let sound = document(FRUSTUM, "");
    [
        (sound.replace("MPCDI", "HTML"), &["line 2", "not an MPCDI"]),
        (sound.replace("\"3d\"", "\"4d\""), &["line 2", "is not"]),
        (
            document("", ""),
            &["line 4, region \"a\", frustum", "is unknown"],
        ),
        (
            sound.replace("<roll>-3</roll>", ""),
            &["line 4", "roll", "does not give"],
        ),
        (
            sound.replace(">20<", ">NaN<"),
            &["rightAngle", "not a number"],
        ),
        (
            sound.replace(">20<", ">90<"),
            &["line 4", "rightAngle", "not an angle within 89.9"],
        ),
        (
            sound.replace(">-25<", ">25<").replace(">20<", ">-30<"),
            &["line 4", "leftAngle", "left and down are negative"],
        ),
        (
            sound.replace("y=\"0\"", "y=\"2\""),
            &["line 4", "y", "not a share from 0 to 1"],
        ),
        (
            sound.replace("\"8\"", "\"8.5\""),
            &["line 4", "xResolution", "not a count of pixels"],
        ),
        (
            sound.replace("\"8\"", "\"99999\""),
            &["line 4", "xResolution", "32768"],
        ),
        (
            sound.replace("</region>", ""),
            &["line 4", "expected 'region'"],
        ),
        (
            sound.replace("<MPCDI", "<!DOCTYPE x [<!ENTITY a \"b\">]><MPCDI"),
            &["line 2", "entities"],
        ),
        (
            document(FRUSTUM, SET).replace("3d", "a3"),
            &["line 5", "originOf3DData", "--eye-at"],
        ),
        (
            document(FRUSTUM, "").replace("3d", "sl"),
            &["line 4", "profile sl", "export profile a3"],
        ),
    ]
}

#[test]
fn what_is_wrong_with_a_document_is_refused_by_its_line_and_element() {
    for (text, names) in wrong_documents() {
        let error = read(text.as_bytes()).unwrap_err();
        for name in names {
            assert!(error.contains(name), "{error}: no {name:?}\n{text}");
        }
        assert!(error.contains("; "), "{error}");
    }
}

#[test]
fn what_is_wrong_with_a_map_is_refused_and_no_more_is_unpacked_than_it_may_need() {
    let text = document(FRUSTUM, &format!("<files>{SET}</files>"));
    let infinite = |line, column, pair| match (line, column) {
        (2, 3) => [f64::INFINITY, 0.0],
        _ => pair,
    };
    let folded = |_, column: u32, [x, y]: [f64; 2]| match column {
        4 => [x - 0.4, y],
        _ => [x, y],
    };
    let bomb = vec![b'0'; 1 << 24];
    let cases: [(Vec<u8>, &str); 7] = [
        (warp(infinite), "at column 3, line 2, expected -1e6 to 1e6"),
        (warp(folded), "folds rays over"),
        (warp(|_, _, _| [f64::NAN; 2]), "nothing of the panel is lit"),
        (
            pfm::written([1, 8], |_, _| [0.0; 2]),
            "is 1 x 8 pixels, fewer than 2 x 2",
        ),
        (warp(as_is)[..300].to_vec(), "bytes of 576"),
        (bomb, "unpacks to more than the 786688 bytes"),
        (b"P6".to_vec(), "ends within its header"),
    ];
    for (map, what) in cases {
        let error = read(&zipped(&[("a.xml", text.as_bytes()), ("a.pfm", &map)])).unwrap_err();
        assert!(
            error.contains(what) && error.contains("line "),
            "{error}: no {what:?}"
        );
    }
    let error = read(&zipped(&[("a.xml", text.as_bytes())])).unwrap_err();
    assert!(error.contains("\"a.pfm\" is not in the archive"), "{error}");
    let out = text.replace("a.pfm", "../a.pfm");
    let error = read(&zipped(&[("a.xml", out.as_bytes()), ("../a.pfm", b"PF")])).unwrap_err();
    assert!(error.contains("leads out"), "{error}");
    let error = read(&zipped(&[("a.pfm", &warp(as_is))])).unwrap_err();
    assert!(error.contains("no .xml"), "{error}");
    let many = [b"PK".to_vec(), b"PK\x01\x02".repeat(10_001)].concat();
    assert!(read(&many).unwrap_err().contains("more than 10000 files"));
    let blank = vec![b' '; (1 << 24) + 1];
    let error = read(&zipped(&[("a.xml", &blank)])).unwrap_err();
    assert!(error.contains("unpacks to more"), "{error}");
    let large = text
        .replace("\"8\"", "\"30000\"")
        .replace("\"6\"", "\"30000\"");
    let error = read(&zipped(&[("a.xml", large.as_bytes())])).unwrap_err();
    assert!(error.contains("all maps have more than"), "{error}");
}

#[test]
fn a_truncated_or_damaged_archive_is_refused_without_panicking() {
    let text = document(FRUSTUM, &format!("<files>{SET}</files>"));
    let map = warp(as_is);
    let whole = zipped(&[("a.xml", text.as_bytes()), ("a.pfm", &map)]);
    assert!(read_any_mpcdi(&whole) && read_any_mpcdi(document(FRUSTUM, "").as_bytes()));
    for cut in 0..whole.len() {
        assert!(!read_any_mpcdi(&whole[..cut]), "{cut}");
        for bits in [0x01, 0x80, 0xff] {
            let mut changed = whole.clone();
            changed[cut] ^= bits;
            read_any_mpcdi(&changed);
        }
    }
    // A document that breaks off is read where all of its region stands before that.
    let told = text.find("-12<").unwrap() + 4;
    for cut in 0..text.len() {
        let is_read = read_any_mpcdi(&text.as_bytes()[..cut]);
        assert!(!is_read || cut >= told, "{cut}");
    }
    let error = read(&text.as_bytes()[..told - 1]).unwrap_err();
    assert!(error.contains("downAngle"), "{error}");
    assert!(!read_any_mpcdi("<a>".repeat(50_000).as_bytes()));
}

#[test]
fn what_no_frustum_can_tell_is_not_written() {
    let mut rig = toml(&one("size = [40, 1]")).unwrap();
    let lens = RadialPolynomial {
        centre: [0.0; 2],
        coefficients: vec![1.0, 400.0],
    };
    rig.panels[0].distortion = Distortion::Polynomial(Box::new([lens.clone(), lens.clone(), lens]));
    let error = write_mpcdi(&[&rig.panels[0]]).unwrap_err();
    assert!(error.contains("panel a: pixel 0, 0 looks 90°"), "{error}");
}

#[test]
fn an_element_of_very_many_attributes_is_refused_at_once() {
    let attributes: String = (0..300).map(|k| format!(" a{k}=\"\"")).collect();
    for text in [
        format!("<MPCDI{attributes}/>"),
        (0..300).map(|k| format!("<a xmlns:b{k}=\"c\">")).collect(),
    ] {
        let refused = mpcdi::read(text.as_bytes(), &|_| Err(String::new()), None).unwrap_err();
        assert!(refused.to_string().contains("more than 200"), "{refused}");
    }
}
