//! Are layouts of displays read right that are written in unusual ways?

use crate::support::{Folder, done, json_of, refused};

/// Number of panels, remarks, and the rig file of an import.
fn imported(folder: &Folder, name: &str, bytes: &[u8]) -> (u64, String, String) {
    let file = folder.holding(name, bytes);
    let out = folder.name(&format!("{name}.toml"));
    let told = json_of(&done(&["panels", "import", &file, "--out", &out, "--json"]));
    let rig = std::fs::read_to_string(&out).unwrap();
    (
        told["panels"].as_u64().unwrap(),
        told["remarks"].to_string(),
        rig,
    )
}

/// Nodes of a mesh of 4 x 3, with this end, in lines that end so.
fn nodes(light: &str, end: &str) -> String {
    let of = |x: u32, y: u32| {
        let (u, v) = (f64::from(x) / 3.0, f64::from(y) / 2.0);
        format!(
            "{:.4} {:.4} {u:.4} {v:.4}{light}{end}",
            u * 3.2 - 1.6,
            v * 2.0 - 1.0
        )
    };
    (0..3).flat_map(|y| (0..4).map(move |x| of(x, y))).collect()
}

#[test]
fn a_warp_mesh_is_the_same_however_its_nodes_stand_in_lines() {
    let folder = Folder::new();
    let usual = format!("2\n4 3\n{}", nodes(" 1", "\n"));
    let (_, told, rig) = imported(&folder, "usual.data", usual.as_bytes());
    assert_eq!(told, "[]");
    let maps = |name: &str| std::fs::read(folder.name(&format!("{name}.mesh.pfm"))).unwrap();
    for (name, text, word) in [
        ("a.data", format!("2\n4 3\n{}", nodes(" 1", " ")), ""),
        ("b.data", format!("2 4 3 {}", nodes(" 1", " ")), ""),
        ("c.data", format!("2\n4 3\n{}", nodes("", " ")), ""),
        ("d.data", format!("2\n4\n3\n{}", nodes(" 1", "\n")), ""),
        (
            "e.data",
            format!("2\n4 3\n{}", nodes(" 0", "\n")),
            "full light",
        ),
        (
            "f.data",
            format!("2\n4 3\n{}", nodes(" -1", "\n")),
            "full light",
        ),
        (
            "g.data",
            format!("2\n4 3\n{}", nodes(" 1 1 1", "\n")),
            "mean of red",
        ),
    ] {
        let (panels, told, found) = imported(&folder, name, text.as_bytes());
        assert_eq!(panels, 1);
        assert!(
            told.contains(word) && (word.is_empty() == (told == "[]")),
            "{name}: {told}"
        );
        assert_eq!(maps(name), maps("usual.data"), "{name}");
        assert_eq!(found.replace(name, "usual.data"), rig, "{name}");
    }
    let short = format!("2\n4 3\n{}", nodes(" 1 1", "\n"));
    let file = folder.holding("short.data", short.as_bytes());
    let out = folder.name("short.toml");
    refused(
        1,
        &["panels", "import", &file, "--out", &out],
        &["x, y, u, v and i"],
    );
}

/// An MPCDI of two regions, with these ids, angles and files.
fn document(ids: [&str; 2], angles: [f64; 4], files: &str) -> String {
    let [left, right, up, down] = angles;
    let frustum = format!(
        "<frustum><yaw>0</yaw><pitch>0</pitch><roll>0</roll><rightAngle>{right}</rightAngle>\
         <leftAngle>{left}</leftAngle><upAngle>{up}</upAngle><downAngle>{down}</downAngle>\
         </frustum>"
    );
    let region = |id: &str, x: f64| {
        format!(
            "<region id=\"{id}\" xResolution=\"80\" yResolution=\"60\" x=\"{x}\" y=\"0\" \
             xSize=\"0.5\" ySize=\"1\">{frustum}</region>"
        )
    };
    format!(
        "<MPCDI profile=\"3d\" version=\"2.0\"><display><buffer id=\"wall\" xResolution=\"160\" \
         yResolution=\"60\">{}{}</buffer></display>{files}</MPCDI>",
        region(ids[0], 0.0),
        region(ids[1], 0.5)
    )
}

#[test]
fn ids_angles_and_files_that_are_unusual_are_used_and_told() {
    let folder = Folder::new();
    let signed = [-25.0, 20.0, 15.0, -12.0];
    let usual = document(["a", "b"], signed, "");
    let (_, told, rig) = imported(&folder, "usual.xml", usual.as_bytes());
    assert_eq!(told, "[]");
    for angles in [[25.0, 20.0, 15.0, -12.0], [-25.0, 20.0, 12.0, -12.0]] {
        let text = document(["a", "b"], angles, "");
        let (_, told, found) = imported(&folder, &format!("{}.xml", angles[3]), text.as_bytes());
        let is_usual = angles[0] < 0.0;
        assert_eq!(told == "[]", is_usual, "{told}");
        assert_eq!(found == rig, !is_usual, "{angles:?}");
        let _ = std::fs::remove_file(folder.name(&format!("{}.xml.toml", angles[3])));
    }
    // One that lies wholly to the right of its axis stays there.
    let aside = document(["a", "b"], [5.0, 30.0, 15.0, -12.0], "");
    let (_, told, _) = imported(&folder, "aside.xml", aside.as_bytes());
    assert_eq!(told, "[]");
    let named = document(["wall/L:1", "wall\\L:1"], signed, "");
    let (panels, told, found) = imported(&folder, "named.xml", named.as_bytes());
    assert_eq!(panels, 2);
    assert!(
        told.contains("wall/L:1") && told.contains("\\\"wall-L-1\\\""),
        "{told}"
    );
    assert!(
        found.contains("wall-L-1\"") && found.contains("wall-L-1-2\""),
        "{found}"
    );
    let set = "<files><fileset region=\"a\"><distortionMap><path>a.pfm</path></distortionMap>\
               </fileset></files>";
    let text = document(["a", "b"], signed, set);
    let (_, told, _) = imported(&folder, "distorted.xml", text.as_bytes());
    assert!(told.contains("distortionMap is not read"), "{told}");
}
