//! Does a scene file become a pack that shows what it says, where it says?

use crate::scene::torus;
use crate::support::{Folder, Rgb, done, json, refused};

/// Two tori before a background of its own, lit from the left.
const SITE: &str = r##"
background = "#204060"
light = [-1, 0, 0]

[[input]]
file = "torus.obj"
place = [
    { translation = [-2, 0, 0], rotation_deg = [90, 0, 0] },
    { translation = [2, 0, 0], rotation_deg = [90, 0, 0], scale = 0.5 },
]
"##;

fn first_frame(folder: &Folder, pack: &str, renderer: &str) -> Rgb {
    let out = folder.name(&format!("out_{renderer}"));
    let arguments = [
        "simulate",
        pack,
        "--out",
        &out,
        "--view",
        "320x160",
        "--frames",
        "1",
        "--policy",
        "full",
        "--renderer",
        renderer,
    ];
    done(&arguments);
    Rgb::read(&format!("{out}/frame_00000.png"))
}

#[test]
fn a_scene_file_puts_one_mesh_into_several_places_in_its_light() {
    let folder = Folder::new();
    folder.holding("torus.obj", torus(48, 24).as_bytes());
    let site = folder.holding("site.toml", SITE.as_bytes());
    let pack = folder.name("site.foveal");
    let made = json(&["prepare", "scene", &site, "--out", &pack]);
    assert_eq!(
        (&made["objects"], &made["leaf_triangles"]),
        (&1.into(), &2304.into())
    );
    let again = json(&["prepare", "scene", &site, "--out", &pack]);
    assert_eq!(again["already_there"], true);
    let tried = json(&["verify", &pack, "--cuts", "4", "--orders", "2"]);
    assert_eq!(
        (&tried["ok"], &tried["odd_edges_max"]),
        (&true.into(), &0.into())
    );
    let picture = first_frame(&folder, &pack, "cpu");
    assert_eq!(picture.at([0, 0]), [0x20, 0x40, 0x60]);
    // The first stands to the left and is twice as large.
    let is_shown = |at: &[u32; 2]| picture.at(*at) != [0x20, 0x40, 0x60];
    let shown: Vec<[u32; 2]> = picture.places().filter(is_shown).collect();
    let left = shown.iter().filter(|at| at[0] < 160).count();
    assert!(left > 2 * (shown.len() - left), "{left} of {}", shown.len());
    // Light comes from the left: there the first is lighter than at its right end.
    let first = || shown.iter().filter(|at| at[0] < 170);
    let [least, most] = [first().map(|at| at[0]).min(), first().map(|at| at[0]).max()];
    let light = |columns: std::ops::RangeInclusive<u32>| {
        let of = first().filter(|at| columns.contains(&at[0]));
        let all: Vec<f64> = of.map(|at| f64::from(picture.at(*at)[1])).collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    let [least, most] = [least, most].map(Option::unwrap);
    assert!(light(least..=least + 5) > light(most - 5..=most) + 20.0);
    let drawn = first_frame(&folder, &pack, "gpu");
    assert_eq!(drawn.at([0, 0]), [0x20, 0x40, 0x60]);
    let differing = picture
        .places()
        .filter(|at| picture.at(*at) != drawn.at(*at));
    assert!(differing.count() < 320 * 160 / 100);
}

#[test]
fn another_light_or_file_makes_another_pack_and_what_is_wrong_says_where() {
    let folder = Folder::new();
    folder.holding("torus.obj", torus(12, 8).as_bytes());
    let site = folder.holding("site.toml", SITE.as_bytes());
    let pack = folder.name("site.foveal");
    done(&["prepare", "scene", &site, "--out", &pack]);
    folder.holding("site.toml", SITE.replace("-1, 0, 0", "1, 0, 0").as_bytes());
    refused(
        2,
        &["prepare", "scene", &site, "--out", &pack],
        &["--force"],
    );
    for (from, to, words) in [
        (
            "background",
            "backgruond",
            ["site.toml", "line 2", "\"background\""],
        ),
        (
            "torus.obj",
            "tours.obj",
            ["site.toml", "tours.obj", "put it where"],
        ),
        (
            "torus.obj",
            "../torus.obj",
            ["site.toml", "does not lie in the folder", "put it"],
        ),
        (
            "scale = 0.5",
            "scale = 0",
            ["site.toml", "input 1, place 2", "scene.md"],
        ),
    ] {
        folder.holding("site.toml", SITE.replace(from, to).as_bytes());
        refused(
            1,
            &["prepare", "scene", &site, "--out", &pack, "--force"],
            &words,
        );
    }
    let told = json(&["info", &pack]);
    assert_eq!(told["objects"], 1, "a pack stays where the next fails");
}
