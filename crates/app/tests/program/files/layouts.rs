//! Are layouts of displays read as other programs write them?

use crate::support::{Folder, done, json_of};
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const FRUSTUM: &str = "<frustum><yaw>10</yaw><pitch>5</pitch><roll>-3</roll>\
    <rightAngle>20</rightAngle><leftAngle>-25</leftAngle><upAngle>15</upAngle>\
    <downAngle>-12</downAngle></frustum>";

fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// A buffer of 160 x 60 pixels with two regions side by side, so many columns each.
fn document(columns: u32, files: &str) -> String {
    let region = |id: &str, x: f64| {
        format!(
            "<region id=\"{id}\" xResolution=\"{columns}\" yResolution=\"60\" x=\"{x}\" y=\"0\" \
             xSize=\"0.5\" ySize=\"1\">{FRUSTUM}</region>\n"
        )
    };
    format!(
        "<?xml version=\"1.0\"?>\n<MPCDI profile=\"3d\" version=\"2.0\">\n<display><buffer \
         id=\"wall\" xResolution=\"160\" yResolution=\"60\">\n{}{}</buffer></display>\n{files}\
         </MPCDI>",
        region("a", 0.0),
        region("b", 0.5)
    )
}

/// A float map of 80 x 60 pixels that shows three quarters of what there is.
fn warp() -> Vec<u8> {
    let mut bytes = b"PF\n80 60\n-1\n".to_vec();
    for (row, column) in (0..60).flat_map(|row| (0..80).map(move |column| (row, column))) {
        let x = 0.125 + 0.75 * (f64::from(column) + 0.5) / 80.0;
        let y = 0.125 + 0.75 * (1.0 - (f64::from(row) + 0.5) / 60.0);
        for number in [x, y, 0.0] {
            bytes.extend((number as f32).to_le_bytes());
        }
    }
    bytes
}

/// What `panels import` says, and the rig file that it writes.
fn imported(folder: &Folder, name: &str, bytes: &[u8]) -> (String, String) {
    let file = folder.holding(name, bytes);
    let out = folder.name(&format!("{name}.toml"));
    let ran = done(&["panels", "import", &file, "--out", &out, "--json"]);
    assert!(json_of(&ran)["panels"].as_u64().unwrap() > 0);
    (ran.stderr.clone(), std::fs::read_to_string(&out).unwrap())
}

#[test]
fn an_mpcdi_that_was_zipped_with_its_folder_is_the_same_layout() {
    let folder = Folder::new();
    let set = "<files><fileset region=\"a\"><geometryWarpFile><path>maps/a.pfm</path>\
               </geometryWarpFile></fileset></files>\n";
    let text = document(80, set);
    let map = warp();
    let flat = [("mpcdi.xml", text.as_bytes()), ("maps/a.pfm", &map[..])];
    let deep = [
        ("show/mpcdi.xml", text.as_bytes()),
        ("show/maps/a.pfm", &map[..]),
        ("__MACOSX/show/._mpcdi.xml", b"\0\x05"),
    ];
    let (said, flat) = imported(&folder, "flat.mpcdi", &zipped(&flat));
    assert!(!said.contains("elsewhere"), "{said}");
    let (said, deep) = imported(&folder, "deep.mpcdi", &zipped(&deep));
    assert!(!said.contains("elsewhere"), "{said}");
    assert_eq!(flat.replace("flat.mpcdi", "deep.mpcdi"), deep);
    let missing = zipped(&[("show/mpcdi.xml", text.as_bytes())]);
    let (said, _) = imported(&folder, "missing.mpcdi", &missing);
    for words in [
        "region \"a\" is left out",
        "maps/a.pfm",
        "not in the archive",
    ] {
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn regions_of_other_resolutions_than_their_shares_are_placed_by_these_and_told() {
    let folder = Folder::new();
    let places = |rig: &str| -> Vec<String> {
        let lines = rig.lines();
        let lines = lines.filter(|line| line.contains("tangents") || line.starts_with("output"));
        lines.map(str::to_owned).collect()
    };
    let (said, even) = imported(&folder, "even.xml", document(80, "").as_bytes());
    assert!(!said.contains("share"), "{said}");
    let (said, fewer) = imported(&folder, "fewer.xml", document(64, "").as_bytes());
    assert!(
        said.contains("placed by its share") && !said.contains("lies over"),
        "{said}"
    );
    assert_eq!(places(&fewer), places(&even));
    // An overlap is reported, and drawn.
    let file = folder.holding("more.xml", document(100, "").as_bytes());
    let out = folder.name("maps");
    let ran = done(&[
        "panels", "map", &file, "--format", "seed", "--source", "320x120", "--out", &out,
    ]);
    assert!(
        ran.stderr.contains("\"b\" lies over \"a\""),
        "{}",
        ran.stderr
    );
    assert!(ran.stderr.contains("80 x 60"), "{}", ran.stderr);
}

#[test]
fn a_warp_mesh_with_comments_and_line_ends_of_windows_is_the_same_mesh() {
    let folder = Folder::new();
    let mut mesh = "2\n5 4\n".to_owned();
    for (row, column) in (0..4).flat_map(|row| (0..5).map(move |column| (row, column))) {
        let [u, v] = [f64::from(column) / 4.0, f64::from(row) / 3.0];
        mesh += &format!("{} {} {} {v} 1\n", 2.0 * u - 1.0, 2.0 * v - 1.0, u * 0.9);
    }
    let (_, plain) = imported(&folder, "mesh.data", mesh.as_bytes());
    let lines = mesh.lines().enumerate();
    let lines: String = lines
        .map(|(number, line)| format!("# line {number}\r\n{line} # as it was\r\n\r\n"))
        .collect();
    let other = Folder::new();
    let (_, commented) = imported(&other, "mesh.data", lines.as_bytes());
    assert_eq!(plain, commented);
}

/// A float map of so many nodes that shows three quarters of what there is, evenly.
fn coarse([columns, lines]: [u32; 2]) -> Vec<u8> {
    let mut bytes = format!("PF\n{columns} {lines}\n-1\n").into_bytes();
    for (line, column) in (0..lines).flat_map(|line| (0..columns).map(move |it| (line, it))) {
        let x = 0.125 + 0.75 * (f64::from(column) + 0.5) / f64::from(columns);
        let y = 0.125 + 0.75 * (1.0 - (f64::from(line) + 0.5) / f64::from(lines));
        for number in [x, y, 0.0] {
            bytes.extend((number as f32).to_le_bytes());
        }
    }
    bytes
}

/// A grey PNG that is darker to the right.
fn fading([columns, rows]: [u32; 2]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, columns, rows);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    let row = (0..columns).map(|column| (255 * (columns - column) / columns) as u8);
    let row: Vec<u8> = row.collect();
    writer.write_image_data(&row.repeat(rows as usize)).unwrap();
    writer.finish().unwrap();
    file
}

/// The floats of a map of 80 x 60 pixels.
fn floats(bytes: &Option<Vec<u8>>) -> Vec<f32> {
    let bytes = bytes.as_ref().unwrap();
    let from = bytes.len() - 80 * 60 * 12;
    let four = |it: &[u8]| f32::from_le_bytes(it.try_into().unwrap());
    bytes[from..].chunks_exact(4).map(four).collect()
}

/// The samples of a PNG, in bytes.
fn grey(file: &Option<Vec<u8>>) -> Vec<u8> {
    let file = Cursor::new(file.clone().unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut samples).unwrap();
    samples
}

#[test]
fn maps_of_other_sizes_than_their_regions_are_brought_to_them_and_told() {
    let folder = Folder::new();
    let set = "<files><fileset region=\"a\"><geometryWarpFile><path>a.pfm</path>\
               </geometryWarpFile><alphaMap><path>a.png</path></alphaMap>\
               <betaMap><path>b.png</path></betaMap></fileset></files>\n";
    let text = document(80, set);
    let import = |name: &str, files: &[(&str, Vec<u8>)]| {
        let mut all: Vec<(&str, &[u8])> = vec![("mpcdi.xml", text.as_bytes())];
        all.extend(files.iter().map(|(name, bytes)| (*name, &bytes[..])));
        let (said, _) = imported(&folder, name, &zipped(&all));
        let beside = |end: &str| std::fs::read(folder.name(&format!("{name}.a.{end}"))).ok();
        (said, beside("pfm"), beside("alpha.png"))
    };
    let black = |size: [u32; 2]| fading([size[0], size[1]]);
    let whole = [
        ("a.pfm", coarse([80, 60])),
        ("a.png", fading([80, 60])),
        ("b.png", black([80, 60])),
    ];
    let (said, map, alpha) = import("whole.mpcdi", &whole);
    assert!(!said.contains("values for"), "{said}");
    for (name, nodes, pixels) in [
        ("coarse.mpcdi", [17, 9], [40, 30]),
        ("fine.mpcdi", [160, 120], [160, 90]),
        ("least.mpcdi", [2, 2], [20, 15]),
    ] {
        let files = [
            ("a.pfm", coarse(nodes)),
            ("a.png", fading(pixels)),
            ("b.png", black(pixels)),
        ];
        let (said, other, shares) = import(name, &files);
        let [w, h] = nodes;
        for words in [
            format!("geometryWarpFile has {w} x {h} values for 80 x 60 pixels"),
            format!("alphaMap has {} x {} values", pixels[0], pixels[1]),
            "betaMap has ".to_owned(),
        ] {
            assert!(said.contains(&words), "{name}: {words}: {said}");
        }
        let far = |(k, (one, other)): (usize, (&f32, &f32))| match k % 3 {
            2 => 0.0,
            _ => (one - other).abs(),
        };
        let pairs = floats(&map);
        let others = floats(&other);
        let far = pairs.iter().zip(&others).enumerate().map(far);
        let most = far.fold(0.0_f32, f32::max);
        assert!(most < 2e-6, "{name}: {most}");
        let (one, other) = (grey(&alpha), grey(&shares));
        assert_eq!(one.len(), other.len());
        let middle = 2 * (80 * 30 + 40);
        assert!(one[middle].abs_diff(other[middle]) < 6, "{name}");
    }
    // What fades a panel may be missing or broken, and the panel is shown.
    let files = [("a.pfm", coarse([80, 60])), ("b.png", b"no PNG".to_vec())];
    let (said, map, alpha) = import("missing.mpcdi", &files);
    assert!(map.is_some() && alpha.is_none());
    for words in [
        "its alphaMap is left out: \"a.png\"",
        "its betaMap is left out: \"b.png\"",
    ] {
        assert!(said.contains(words), "{said}");
    }
}
