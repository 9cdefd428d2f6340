//! Is an MPCDI read in whichever way a program wrote and packed it?

use super::foreign::{FRUSTUM, SET, as_is, document, noted, read, warp, zipped};

#[test]
fn an_archive_that_holds_its_folder_is_read_by_names_from_the_document() {
    let map = warp(as_is);
    let text = |path: &str| {
        document(
            FRUSTUM,
            &format!("<files>{}</files>", SET.replace("a.pfm", path)),
        )
    };
    let plain = text("a.pfm");
    let expected = read(&zipped(&[("mpcdi.xml", plain.as_bytes()), ("a.pfm", &map)])).unwrap();
    let cases = [
        ("show/mpcdi.xml", "maps/a.pfm", "show/maps/a.pfm"),
        ("show/mpcdi.xml", "maps\\a.pfm", "Show/Maps/A.PFM"),
        ("show\\mpcdi.xml", "a.pfm", "show\\a.pfm"),
        ("show/xml/mpcdi.xml", "../maps/./a.pfm", "show/maps/a.pfm"),
        ("show/mpcdi.xml", "show/a.pfm", "show/a.pfm"),
        ("show/mpcdi.xml", "/a.pfm", "show/a.pfm"),
    ];
    for (name, path, at) in cases {
        let text = text(path);
        let files: [(&str, &[u8]); 4] = [
            ("__MACOSX/._mpcdi.xml", b"\0\x05\x16\x07"),
            ("settings.xml", b"<settings/>"),
            (name, text.as_bytes()),
            (at, &map),
        ];
        let found = noted(&zipped(&files), None);
        let found = found.unwrap_or_else(|error| panic!("{path}: {error}"));
        assert_eq!((&found.rig, found.notes.len()), (&expected, 0), "{path}");
    }
    // What the writer's machine called it is the file of that name, and that is said.
    let text = text("C:\\work\\out\\a.pfm");
    let files: [(&str, &[u8]); 2] = [("x/a.xml", text.as_bytes()), ("x/y/a.pfm", &map)];
    let found = noted(&zipped(&files), None).unwrap();
    assert_eq!(found.rig, expected);
    assert!(found.notes[0].contains("elsewhere"), "{:?}", found.notes);
}

#[test]
fn what_other_programs_write_round_a_document_changes_nothing() {
    let text = document(FRUSTUM, "");
    let expected = read(text.as_bytes()).unwrap();
    let wide = |from: fn(u16) -> [u8; 2]| -> Vec<u8> {
        let marked = format!("\u{feff}{text}");
        marked.encode_utf16().flat_map(from).collect()
    };
    let cases = [
        text.replace('\n', "\r\n").into_bytes(),
        wide(u16::to_le_bytes),
        wide(u16::to_be_bytes),
        text.replace("<MPCDI", "<!DOCTYPE MPCDI SYSTEM \"mpcdi.dtd\">\n<MPCDI")
            .into_bytes(),
        text.replace(">20<", ">20,0<").into_bytes(),
        text.replace("xSize=\"1\"", "xSize=\"1.0000001\"")
            .into_bytes(),
        text.replace("\"8\"", "\"8.0\"").into_bytes(),
    ];
    for bytes in cases {
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        assert_eq!(read(&bytes).as_ref(), Ok(&expected), "{shown}");
    }
    let mut latin = text
        .replace("?>", " encoding=\"ISO-8859-1\"?><!-- @ -->")
        .into_bytes();
    let at = latin.iter().position(|it| *it == b'@').unwrap();
    latin[at] = 0xe9;
    assert_eq!(read(&latin), Ok(expected));
}

#[test]
fn regions_of_other_resolutions_are_placed_by_their_shares() {
    let region = |id: &str, x: f64, pixels: u32| {
        format!(
            "<region id=\"{id}\" xResolution=\"{pixels}\" yResolution=\"6\" x=\"{x}\" y=\"0\" \
             xSize=\"0.5\" ySize=\"1\">{FRUSTUM}</region>"
        )
    };
    let of = |profile: &str, regions: &[String]| {
        let text = format!(
            "<MPCDI profile=\"{profile}\"><display><buffer id=\"b\" xResolution=\"16\" \
             yResolution=\"6\">{}</buffer></display></MPCDI>",
            regions.concat()
        );
        noted(text.as_bytes(), None).unwrap()
    };
    for profile in ["2d", "3d"] {
        let even = of(profile, &[region("a", 0.0, 8), region("b", 0.5, 8)]);
        assert_eq!(even.notes, Vec::<String>::new());
        let fewer = of(profile, &[region("a", 0.0, 4), region("b", 0.5, 4)]);
        assert_eq!(fewer.notes.len(), 2, "{:?}", fewer.notes);
        let more = of(profile, &[region("a", 0.0, 12), region("b", 0.5, 12)]);
        assert!(
            more.notes[2].contains("\"b\" lies over \"a\""),
            "{:?}",
            more.notes
        );
        for found in [&fewer, &more] {
            for (own, even) in found.rig.panels.iter().zip(&even.rig.panels) {
                assert_eq!([own.output.x, own.output.y], [even.output.x, even.output.y]);
                assert_eq!(own.view.field, even.view.field);
            }
        }
    }
    let twice = of("3d", &[region("a", 0.0, 8), region("A", 0.5, 8)]);
    assert_eq!(twice.rig.panels[1].id, "A-2");
    assert!(twice.notes[0].contains("there twice"), "{:?}", twice.notes);
}
