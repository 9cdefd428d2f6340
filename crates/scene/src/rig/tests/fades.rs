//! Are fades exported to other programs as pictures that share the light, and is all else said?

use std::io::{Cursor, Read};

use foveal_core::view::panel::rig::{Panel, Rig};
use zip::ZipArchive;

use super::super::interchange::mpcdi::MpcdiRig;
use super::super::write_mpcdi;
use super::foreign::noted;
use super::toml;

/// Two projectors on a wall, each a surface of its own, that overlap by 24 of 96 columns.
const PAIR: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "west"
pixels = [96, 48]
pose = { order = "yaw-pitch-roll", yaw = -60 }
tangents = { left = 0.7, right = 0.1, up = 0.2, down = 0.2 }
output = { surface = "one", monitor = "HDMI-1" }
blend = 8
black = 0.1
[[panel]]
id = "east"
pixels = [96, 48]
pose = { order = "yaw-pitch-roll", yaw = -60 }
tangents = { left = 0.1, right = 0.7, up = 0.2, down = 0.2 }
scanout = "rot180"
output = { surface = "two", monitor = "HDMI-2" }
gain = [1.0, 0.9, 1.0]
blend = 8
black = 0.1
"#;

fn all(rig: &Rig) -> Vec<&Panel> {
    rig.panels.iter().collect()
}

fn entry(file: &[u8], name: &str) -> Vec<u8> {
    let mut zip = ZipArchive::new(Cursor::new(file)).unwrap();
    let mut bytes = Vec::new();
    zip.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
    bytes
}

/// Grey samples of 16 bits.
fn grey(png: &[u8]) -> Vec<f64> {
    let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    let pairs = bytes.chunks(2);
    pairs
        .map(|it| f64::from(u16::from_be_bytes([it[0], it[1]])) / 65_535.0)
        .collect()
}

#[test]
fn fades_become_shares_of_light_and_black_becomes_what_lifts_it() {
    let rig = toml(PAIR).unwrap();
    let file = write_mpcdi(&all(&rig)).unwrap().bytes;
    let [west, east] = ["west", "east"].map(|id| grey(&entry(&file, &format!("{id}.alpha.png"))));
    // The eastern picture is sent upside down.
    for row in 0..48 {
        for k in 0..24 {
            let sum = west[row * 96 + 72 + k] + east[(47 - row) * 96 + 95 - k];
            assert!((sum - 1.0).abs() < 0.01, "{row} {k}: {sum}");
        }
        assert_eq!((west[row * 96], west[row * 96 + 71]), (1.0, 1.0));
        assert!(west[row * 96 + 95] < 0.04);
    }
    let black = grey(&entry(&file, "west.beta.png"));
    assert!((black[0] - 0.1).abs() < 1e-4 && black[95] == 0.0);
}

#[test]
fn a_file_has_a_buffer_for_each_surface_and_round_numbers() {
    let rig = toml(PAIR).unwrap();
    let file = write_mpcdi(&all(&rig)).unwrap().bytes;
    let xml = String::from_utf8(entry(&file, "mpcdi.xml")).unwrap();
    assert_eq!(xml.matches("<buffer ").count(), 2, "{xml}");
    assert!(xml.contains("<yaw>-60</yaw>"), "{xml}");
    for (name, count) in [("<alphaMap>", 2), ("<betaMap>", 2), ("99999", 0)] {
        assert_eq!(xml.matches(name).count(), count, "{name}: {xml}");
    }
    let MpcdiRig { rig: back, notes } = noted(&file, None).unwrap();
    let outputs = back.panels.iter().map(|it| it.output.surface.as_str());
    assert_eq!(outputs.collect::<Vec<_>>(), ["one", "two"]);
    assert!(back.panels.iter().all(|it| it.alpha.is_some()));
    assert_eq!(notes.len(), 2, "{notes:?}");
}

#[test]
fn what_no_mpcdi_tells_is_said_by_panel() {
    let mut rig = toml(PAIR).unwrap();
    rig.panels[0].is_for_both = false;
    let told = write_mpcdi(&all(&rig)).unwrap().left_out;
    let wanted = [
        "the eye that looks at a panel: west",
        "gain: east",
        "the monitor of a surface: west, east",
    ];
    assert_eq!(told, wanted);
    let plain = PAIR.replace("gain = [1.0, 0.9, 1.0]\n", "");
    let plain = plain.replace(", monitor = \"HDMI-1\"", "");
    let rig = toml(&plain.replace(", monitor = \"HDMI-2\"", "")).unwrap();
    assert!(write_mpcdi(&all(&rig)).unwrap().left_out.is_empty());
}

#[test]
fn black_that_is_one_all_over_a_panel_comes_back() {
    let rig = toml(&PAIR.replace("blend = 8\n", "")).unwrap();
    let file = write_mpcdi(&all(&rig)).unwrap().bytes;
    let MpcdiRig { rig: back, notes } = noted(&file, None).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    for panel in &back.panels {
        assert!((panel.black - 0.1).abs() < 1e-4 && panel.alpha.is_none());
    }
}
