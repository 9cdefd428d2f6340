//! Is an MPCDI that breaks a few rules read as it was meant, and is that reported?

use super::super::interchange::mpcdi;
use super::foreign::{FRUSTUM, SET, as_is, document, noted, warp, zipped};

/// What a document with its map becomes, and the notes about it.
fn told(text: &[u8], map: &[u8]) -> Result<mpcdi::MpcdiRig, String> {
    noted(&zipped(&[("mpcdi.xml", text), ("a.pfm", map)]), None)
}

/// The usual document.
fn usual() -> String {
    document(FRUSTUM, &format!("<files>{SET}</files>"))
}

/// Asserts that a document and a map are read as the usual ones, with one note that has these
/// words.
fn assert_mended(text: &[u8], map: &[u8], words: &str) {
    let expected = told(usual().as_bytes(), &warp(as_is)).unwrap();
    assert!(expected.notes.is_empty(), "{:?}", expected.notes);
    let found = told(text, map).unwrap();
    assert_eq!(found.rig.panels, expected.rig.panels, "{words}");
    assert_eq!(found.notes.len(), 1, "{words}: {:?}", found.notes);
    assert!(found.notes[0].contains(words), "{words}: {:?}", found.notes);
}

#[test]
fn files_of_a_region_that_is_called_so_in_other_letters_are_its_own() {
    let map = warp(as_is);
    for name in ["A", " a ", "\u{a0}A"] {
        let text = usual().replace("region=\"a\"", &format!("region=\"{name}\""));
        match name.trim_matches(' ') {
            "a" => assert!(told(text.as_bytes(), &map).unwrap().notes.is_empty()),
            _ => assert_mended(text.as_bytes(), &map, "are used for \"a\""),
        }
    }
    // Files of an unknown region are reported, and so is the region left without files.
    let text = usual().replace("region=\"a\"", "region=\"zz\"");
    let found = told(text.as_bytes(), &map).unwrap();
    assert!(
        found
            .notes
            .iter()
            .any(|it| it.contains("\"zz\" are left out"))
    );
    let two = usual().replace(
        "</region>",
        "</region><region id=\"A\" xResolution=\"8\" yResolution=\"6\" x=\"0\" y=\"0\" \
         xSize=\"1\" ySize=\"1\"><frustum><yaw>0</yaw><pitch>0</pitch><roll>0</roll>\
         <rightAngle>20</rightAngle><leftAngle>-20</leftAngle><upAngle>15</upAngle>\
         <downAngle>-15</downAngle></frustum></region>",
    );
    let found = told(two.as_bytes(), &map).unwrap();
    let all = found.notes.join("\n");
    // The files of the other region are not its own: it is reported to have none.
    assert!(found.rig.panels[1].distortion.is_none(), "{all}");
    assert!(all.contains("has no files"), "{all}");
}

#[test]
fn a_document_with_marks_that_break_xml_is_read_and_told() {
    let map = warp(as_is);
    let text = usual();
    let mend = |text: String, words: &str| assert_mended(text.as_bytes(), &map, words);
    mend(format!("\u{feff}\n \n{text}"), "before its XML declaration");
    mend(format!("\n{text}"), "before its XML declaration");
    let named = |name: &str| text.replace("<MPCDI ", &format!("<MPCDI name=\"{name}\" "));
    mend(named("L & R"), "1 ampersand without an entity");
    mend(named("L&R; &amp; &#38; &c"), "2 ampersands");
    mend(named("a\u{1}b"), "1 control character");
    let latin: Vec<u8> = named("W\u{e4}nde").chars().map(|it| it as u8).collect();
    assert_mended(&latin, &map, "Latin-1");
    // Valid entities need no mend.
    let sound = named("a &lt; &#x41; &amp; b");
    assert!(told(sound.as_bytes(), &map).unwrap().notes.is_empty());
    // A fault is reported with its own line.
    let broken = format!("\n\n{}", text.replace("xSize=\"1\"", "xSize=\"-7\""));
    let error = told(broken.as_bytes(), &map).unwrap_err();
    assert!(
        error.contains("line 6") && error.contains("share"),
        "{error}"
    );
}

#[test]
fn resolutions_of_0_and_places_in_pixels_are_taken_for_what_they_mean() {
    let map = warp(as_is);
    let text = usual();
    let none = text.replacen(
        "xResolution=\"8\" yResolution=\"6\"",
        "xResolution=\"0\" yResolution=\"0\"",
        1,
    );
    let found = told(none.as_bytes(), &map).unwrap();
    let all = found.notes.join("\n");
    assert!(
        all.contains("0 as the xResolution of its buffer") && found.notes.len() == 2,
        "{all}"
    );
    assert_eq!(found.rig.panels[0].view.size, [8, 6]);
    let pixels = text.replace("xSize=\"1\" ySize=\"1\"", "xSize=\"8\" ySize=\"6\"");
    assert_mended(pixels.as_bytes(), &map, "counts pixels");
    let none = text.replace(
        "xResolution=\"8\" yResolution=\"6\"",
        "xResolution=\"0\" yResolution=\"0\"",
    );
    assert!(told(none.as_bytes(), &map).is_err());
}

/// A map of 8 x 6 pixels whose floats are changed.
fn changed(change: impl Fn(usize, [f32; 3]) -> [f32; 3]) -> Vec<u8> {
    let mut map = warp(as_is);
    let head = map.len() - 8 * 6 * 12;
    for (number, node) in map[head..].chunks_exact_mut(12).enumerate() {
        let float = |k: usize| f32::from_le_bytes(*node[4 * k..].first_chunk().unwrap());
        let own = change(number, [0, 1, 2].map(float));
        node.copy_from_slice(own.map(f32::to_le_bytes).as_flattened());
    }
    map
}

#[test]
fn float_maps_with_unlit_nodes_pixels_or_more_behind_them_are_read() {
    let text = usual();
    let behind = [warp(as_is), vec![0; 7]].concat();
    assert_mended(text.as_bytes(), &behind, "7 bytes after its floats");
    // The first two nodes are unlit, however that is written.
    let unlit = |none: [f32; 3]| changed(move |at, own| if at < 2 { none } else { own });
    let expected = told(text.as_bytes(), &unlit([f32::NAN; 3])).unwrap();
    for none in [[-1.0; 3], [0.0; 3], [f32::NAN, 0.5, 0.0]] {
        let panel = &told(text.as_bytes(), &unlit(none)).unwrap().rig.panels[0];
        let ideal = |at: [f64; 2]| {
            panel
                .distortion
                .ideal(&panel.view, at, 1)
                .map(|it| it.place)
        };
        let wanted = &expected.rig.panels[0];
        for at in [
            [0.5, 0.5],
            [1.5, 0.5],
            [4.5, 0.5],
            [0.5, 5.5],
            [1.5, 5.5],
            [7.5, 5.5],
        ] {
            let wanted = wanted.distortion.ideal(&wanted.view, at, 1);
            assert_eq!(ideal(at), wanted.map(|it| it.place), "{none:?} {at:?}");
        }
    }
    let pixels = changed(|_, [x, y, _]| [x * 8.0, y * 6.0, 0.0]);
    let found = told(text.as_bytes(), &pixels).unwrap();
    assert!(
        found.notes[0].contains("divided by 8 and 6"),
        "{:?}",
        found.notes
    );
    let panel = &found.rig.panels[0];
    let even = &told(text.as_bytes(), &warp(as_is)).unwrap().rig.panels[0];
    let ideal = |panel: &foveal_core::view::panel::rig::Panel| {
        let found = panel.distortion.ideal(&panel.view, [3.5, 2.5], 1);
        found.unwrap().place
    };
    let (own, wanted) = (ideal(panel), ideal(even));
    assert!(
        (own[0] - wanted[0]).hypot(own[1] - wanted[1]) < 1e-4,
        "{own:?} {wanted:?}"
    );
    // Pixels of another picture.
    let far = changed(|_, [x, y, z]| [x * 1920.0, y * 1080.0, z]);
    let error = told(text.as_bytes(), &far).unwrap_err();
    assert!(error.contains("these are not pixels of 8 x 6"), "{error}");
}
