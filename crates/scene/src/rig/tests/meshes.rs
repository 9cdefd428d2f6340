//! Is a warp mesh the display that a player of meshes fills, and is one that folds refused?

use foveal_core::view::panel::fit::{PlacementRule, fit};
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::rig::{Panel, Rig, Scanout};
use proptest::prelude::*;

use super::super::interchange::mesh;
use super::super::places::RigSyntax;
use super::super::{parse_rig, read_any_mesh, write_rig};

/// A mesh of 5 x 4 nodes on a display of 4:3, by what x and y from 0 to 1 show.
fn text(shows: impl Fn([f64; 2]) -> [f64; 3]) -> String {
    let mut text = "2\n5 4\n".to_owned();
    for (row, column) in (0..4).flat_map(|row| (0..5).map(move |column| (row, column))) {
        let at = [f64::from(column) / 4.0, f64::from(row) / 3.0];
        let [u, v, i] = shows(at);
        let (x, y) = ((2.0 * at[0] - 1.0) * 4.0 / 3.0, 2.0 * at[1] - 1.0);
        text.push_str(&format!("{x} {y} {u} {v} {i}\n"));
    }
    text
}

fn read(text: &str) -> Result<Rig, String> {
    let read = mesh::read(text.as_bytes()).map(|(rig, _)| rig);
    read.map_err(|fault| fault.to_string())
}

/// What a pixel shows of a picture of 400 x 300 pixels.
fn shown(rig: &Rig, pixel: [u32; 2]) -> Option<[f64; 2]> {
    let panels: Vec<&Panel> = rig.panels.iter().collect();
    let rule = PlacementRule::Screen(rig.screen.unwrap());
    let found = fit(&panels, rule, Some([400, 300])).unwrap();
    let map = PixelMap {
        panel: panels[0],
        placement: &found.placement,
        size: found.size,
    };
    Some(map.of_pixel(pixel)?.place)
}

fn near(found: Option<[f64; 2]>, wanted: [f64; 2]) {
    let found = found.unwrap();
    let off = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
    assert!(off < 1e-4, "{found:?}, not {wanted:?}");
}

#[test]
fn a_display_shows_what_its_mesh_says_of_the_whole_picture() {
    let even = read(&text(|[x, y]| [x, y, 1.0])).unwrap();
    let panel = &even.panels[0];
    assert_eq!(
        (panel.view.size, panel.scanout),
        ([1440, 1080], Scanout::Normal)
    );
    assert!(panel.distortion.is_none() && panel.alpha.is_none());
    near(shown(&even, [0, 0]), [200.0 / 1440.0, 150.0 / 1080.0]);
    // A part of the picture stays that part, and half the light is half the light.
    let part = read(&text(|[x, y]| [0.25 + x / 2.0, 0.5 + y / 4.0, 0.5])).unwrap();
    near(
        shown(&part, [0, 1079]),
        [100.0 + 100.0 / 1440.0, 150.0 - 37.5 / 1080.0],
    );
    assert_eq!(part.panels[0].alpha.as_ref().unwrap().at([7, 9]), 32_768);
    // Seen from behind.
    let mirrored = read(&text(|[x, y]| [1.0 - x, y, 1.0])).unwrap();
    assert_eq!(mirrored.panels[0].scanout, Scanout::FlipX);
    near(shown(&mirrored, [0, 0]), [200.0 / 1440.0, 150.0 / 1080.0]);
    // Where a node has a share below 0 nothing is drawn.
    let dark = read(&text(|[x, y]| {
        [x * 0.9, y, if x + y == 0.0 { -1.0 } else { 1.0 }]
    }))
    .unwrap();
    assert_eq!(shown(&dark, [100, 1000]), None);
    assert!(shown(&dark, [900, 100]).is_some());
}

#[test]
fn a_mesh_becomes_a_rig_file_with_the_same_map() {
    let bent = |[x, y]: [f64; 2]| [x * (0.8 + 0.2 * x), y * (0.9 + 0.1 * x), 1.0 - x * 0.3];
    let rig = read(&text(bent)).unwrap();
    let files = write_rig(&rig, "dome").unwrap();
    let names: Vec<&str> = files.iter().map(|it| it.0.as_str()).collect();
    assert_eq!(names, ["dome.toml", "dome.mesh.alpha.png", "dome.mesh.pfm"]);
    let beside = |name: &str| {
        let file = files.iter().find(|it| it.0 == name);
        file.map(|it| it.1.clone())
            .ok_or_else(|| "is not there".to_owned())
    };
    let back = parse_rig(&files[0].1, RigSyntax::Toml, &beside).unwrap();
    assert_eq!(
        (back.screen, &back.panels[0].alpha),
        (rig.screen, &rig.panels[0].alpha)
    );
    for pixel in [[0, 0], [1439, 0], [0, 1079], [1439, 1079], [700, 300]] {
        let (own, back) = (shown(&rig, pixel).unwrap(), shown(&back, pixel).unwrap());
        assert!(
            (own[0] - back[0]).hypot(own[1] - back[1]) < 1e-6,
            "{own:?} {back:?}"
        );
    }
}

#[test]
fn what_is_no_mesh_or_folds_is_refused_by_its_line() {
    let sound = text(|[x, y]| [x, y, 1.0]);
    let cases: [(String, &str); 11] = [
        (String::new(), "ends before the type"),
        ("2\n5\n".to_owned(), "line 2: is not columns and rows"),
        (
            "2\n5 1\n".to_owned(),
            "line 2: columns and rows are not 2 or more",
        ),
        ("2\n99999 99999\n".to_owned(), "line 2: columns and rows"),
        (
            sound.replacen("1\n", "one\n", 1),
            "line 3: is not x, y, u, v and i",
        ),
        (
            sound
                .replacen(" 1\n", "\n", 1)
                .replacen(" 0 0\n", " 0\n", 1),
            "line 3: is not x, y, u, v and i",
        ),
        (
            text(|[x, y]| [1920.0 * x, 1080.0 * y, 1.0]),
            "u reaches 1920 and v 1080, as pixels of a picture",
        ),
        (
            sound.replacen("1\n", "1e9\n", 1),
            "line 3: a node has numbers above",
        ),
        (
            sound.lines().take(9).collect::<Vec<_>>().join("\n"),
            "ends before x, y",
        ),
        (
            text(|[x, y]| [if x == 0.5 { 0.9 } else { x }, y, 1.0]),
            "the mesh folds over there",
        ),
        (text(|_| [0.5, 0.5, 1.0]), "folds rays over"),
    ];
    for (text, what) in cases {
        let error = read(&text).unwrap_err();
        assert!(error.contains(what), "{error}: no {what:?}");
        assert!(error.contains("docs/formats/panels.md"), "{error}");
    }
    let mut over = "1\n2 400\n".to_owned();
    for row in 0..400 {
        let y = if row % 2 == 0 { -1.0 } else { 1.0 };
        over.push_str(&format!("-1 {y} 0 0 1\n1 {y} 1 1 1\n"));
    }
    assert!(read(&over).unwrap_err().contains("folds"));
}

#[test]
fn however_a_program_wrote_the_lines_it_is_the_same_mesh() {
    let sound = text(|[x, y]| [x * 0.9, y, 0.5]);
    let expected = read(&sound).unwrap();
    let last = |it: &str| it.trim_end().rsplit_once(' ').unwrap().0.to_owned();
    let bright = read(&text(|[x, y]| [x * 0.9, y, 1.0])).unwrap();
    let commented: String = sound
        .lines()
        .map(|line| format!("# before\n  {line}\t// behind\n\n"))
        .collect();
    let (head, nodes) = sound.split_at(6);
    let cases = [
        sound.replace('\n', "\r\n"),
        sound.replace('\n', "\r"),
        format!("\u{feff}{sound}"),
        commented,
        format!("; made by hand\n% too\n{}", sound.replace(' ', " \t ")),
        sound.replace(' ', ", "),
        sound.replace(' ', ";"),
        sound.replace('.', ","),
        format!("2 5 4\n{nodes}"),
        format!("2.0\n5.0 4.0\n{nodes}"),
    ];
    assert_eq!(head, "2\n5 4\n");
    for text in cases {
        assert_eq!(read(&text).as_ref(), Ok(&expected), "{text}");
    }
    let without_light: String = nodes.lines().map(|line| last(line) + "\n").collect();
    assert_eq!(read(&format!("{head}{without_light}")), Ok(bright));
    let sixteen: Vec<u8> = format!("\u{feff}{sound}")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(mesh::read(&sixteen).map(|it| it.0), Ok(expected));
    let (_, notes) = mesh::read(format!("{sound}1 2 3 4 5\n").as_bytes()).unwrap();
    assert_eq!(
        notes,
        ["line 23 and what follows come after the nodes and are not read"]
    );
}

#[test]
fn what_is_lit_of_a_mesh_with_holes_is_drawn_and_told() {
    let noted = |text: &str| mesh::read(text.as_bytes()).unwrap();
    let bent = |[x, y]: [f64; 2]| [x * 0.9, y, 1.0 - x * 0.5];
    let (expected, notes) = noted(&text(bent));
    assert!(notes.is_empty());
    // Light in other units.
    for (all, words) in [
        (255.0, "divided by 255"),
        (100.0, "divided by 100"),
        (65_535.0, "65535"),
    ] {
        let counted = text(|at| {
            let [u, v, i] = bent(at);
            [u, v, i * all]
        });
        let (rig, notes) = noted(&counted);
        assert!(notes[0].contains(words), "{notes:?}");
        assert_eq!(rig, expected);
    }
    let (_, notes) = noted(&text(|[x, y]| [x, y, 1.0 + x * 0.2]));
    assert!(notes[0].contains("above 1"), "{notes:?}");
    // The corner node is unlit, however that is written.
    let unlit = text(|[x, y]| [x * 0.9, y, if x + y == 0.0 { -1.0 } else { 1.0 }]);
    let (expected, notes) = noted(&unlit);
    assert!(notes.is_empty());
    let first = unlit.lines().nth(2).unwrap();
    let place = first.rsplitn(4, ' ').nth(3).unwrap();
    for node in [
        "nan nan nan nan -1".to_owned(),
        format!("{place} NaN NaN 1"),
        format!("{place} 0 0 nan"),
        format!("{place} inf -inf 0"),
    ] {
        let (rig, notes) = noted(&unlit.replacen(first, &node, 1));
        assert_eq!(rig.panels[0].alpha, expected.panels[0].alpha, "{node}");
        assert_eq!(shown(&rig, [100, 1000]), None, "{node}");
        assert!(shown(&rig, [900, 100]).is_some(), "{node}");
        assert!(
            notes[0].contains("1 node with a value that is not a number"),
            "{notes:?}"
        );
    }
    // A file that breaks off, and one with the names of its columns.
    let whole = text(bent);
    for cut in [1, 9, 40, 120] {
        let (rig, notes) = noted(&whole[..whole.len() - cut]);
        assert!(shown(&rig, [100, 1000]).is_some());
        assert!(
            cut < 9 || notes[0].contains("missing at the end of the file"),
            "{cut} {notes:?}"
        );
    }
    let named = whole.replacen("5 4\n", "5 4\nx y u v \"i\"\n", 1);
    assert_eq!(noted(&named), noted(&whole));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn no_text_panics(share in 0.0..1.0f64, byte in any::<u8>(), other in "\\PC{0,60}") {
        read_any_mesh(other.as_bytes());
        let whole = text(|[x, y]| [x, y, 1.0]);
        prop_assert!(read_any_mesh(whole.as_bytes()));
        let at = (share * whole.len() as f64) as usize;
        let mut changed = whole.into_bytes();
        changed[at] = byte;
        read_any_mesh(&changed);
        read_any_mesh(&changed[..at]);
    }
}
