//! What does `prepare` say of its input, in which order, and by which rule was it found?

use crate::scenes::{waves, write_clip};
use crate::support::{Folder, Rgb, done, frame_picture, json};
use serde_json::json;

/// A picture of red, green, blue and alpha.
fn write_rgba(
    folder: &Folder,
    name: &str,
    size: [u32; 2],
    pixel: impl Fn(u32) -> [u8; 4],
) -> String {
    let path = folder.name(name);
    let file = std::fs::File::create(&path).unwrap();
    let mut encoder = png::Encoder::new(file, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    let pixels: Vec<u8> = (0..size[0] * size[1])
        .flat_map(|at| pixel(at % size[0]))
        .collect();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    path
}

#[test]
fn what_is_transparent_is_shown_over_black_and_that_is_said() {
    let folder = Folder::new();
    let colour = [200, 100, 50];
    let strength = |x: u32| [255, 128, 0, 255][(x / 20) as usize];
    let clip = write_rgba(&folder, "a.png", [80, 40], |x| {
        [colour[0], colour[1], colour[2], strength(x)]
    });
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    let said = done(&["prepare", "video", &clip, "--out", &pack, "--codec", "png"]).stderr;
    let line = said.lines().find(|line| line.contains("transparent"));
    let line = line.unwrap_or_else(|| panic!("nothing of transparency in {said}"));
    assert!(
        line.starts_with("warning: ") && line.contains("over black"),
        "{line}"
    );
    done(&["simulate", &pack, "--out", &out, "--policy", "full"]);
    let shown: Rgb = frame_picture(&out, 0);
    for x in [10, 30, 50, 70] {
        let expected = colour.map(|c| f64::from(c) * f64::from(strength(x)) / 255.0);
        for (found, expected) in shown.at([x, 20]).into_iter().zip(expected) {
            let off = (f64::from(found) - expected).abs();
            assert!(off <= 3.0, "column {x}: {found}, expected {expected}");
        }
    }
}

#[test]
fn what_matters_is_said_first_and_marked() {
    let folder = Folder::new();
    let clip = write_rgba(&folder, "a.png", [64, 48], |_| [9, 9, 9, 9]);
    let pack = folder.name("a.pack");
    let said = done(&["prepare", "video", &clip, "--out", &pack]).stderr;
    let lines: Vec<&str> = said.lines().collect();
    assert!(
        lines[0].starts_with("warning: ") && lines[0].contains(".foveal"),
        "{said}"
    );
    let is_warning = |line: &&str| line.starts_with("warning: ");
    let warnings = lines.iter().take_while(|line| is_warning(line)).count();
    assert_eq!(
        warnings,
        lines.iter().filter(|line| is_warning(line)).count(),
        "{said}"
    );
    let ordinary = |word: &str| lines[warnings..].iter().any(|line| line.contains(word));
    assert!(ordinary("treated as flat") && ordinary("4:2:0"), "{said}");
    let estimate = json(&["prepare", "video", &clip, "--dry-run"]);
    let said = |key: &str, word: &str| {
        let said = estimate[key].as_array().unwrap();
        said.iter()
            .any(|said| said.as_str().unwrap().contains(word))
    };
    assert!(
        said("warnings", "over black") && said("notes", "4:2:0"),
        "{estimate}"
    );
    assert!(
        !said("warnings", "4:2:0") && !said("notes", "over black"),
        "{estimate}"
    );
}

#[test]
fn each_eye_of_a_named_pair_is_a_sphere_where_it_has_the_shape_of_one() {
    let folder = Folder::new();
    for (name, size, projection) in [
        ("pano_TB.mkv", [64, 64], "cube"),
        ("market_TB.mkv", [64, 64], "cube"),
        ("market_LR.mkv", [128, 32], "cube"),
        ("film_LR.mkv", [128, 40], "flat"),
        ("pano_TB.mkv", [64, 48], "flat"),
    ] {
        let clip = write_clip(&folder, name, &waves(size, 1));
        let pack = folder.name("a.foveal");
        let ran = done(&["prepare", "video", &clip, "--out", &pack, "--force"]);
        let info = json(&["info", &pack]);
        assert_eq!(
            (&info["eyes"], &info["projection"]),
            (&json!(2), &json!(projection)),
            "{name} {size:?}: {}",
            ran.stderr
        );
        // A name that is believed for the eyes and not for the sphere has that said.
        let doubted = name.contains("pano") && projection == "flat";
        assert_eq!(ran.stderr.contains("2:1 an eye"), doubted, "{}", ran.stderr);
    }
}

#[test]
fn the_help_tells_by_which_rule_an_input_is_taken_for_360_and_for_two_eyes() {
    let help = done(&["prepare", "video", "--help"]).stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "360°: exactly 2:1, and 360, pano, sphere or equirect in the name",
        "or one of two eyes, or at least 3840 pixels wide",
        "180°: 1:1, and 180 or vr180 in the name",
        "Side by side: LR, SBS",
        "One above the other: TB, OU",
    ] {
        assert!(help.contains(words), "no {words:?} in {help}");
    }
}

/// The first "1 things" of a text.
fn wrong_plural(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split([' ', '\n']).collect();
    let bare = |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric()).to_owned();
    let counted = [
        "frame", "picture", "pack", "tile", "level", "unit", "byte", "eye", "file", "gaze",
        "sample", "channel", "change", "decoder", "place", "pixel", "core", "thread",
    ];
    let is_plural = |word: &str| {
        word.strip_suffix('s')
            .is_some_and(|one| counted.contains(&one))
    };
    words.windows(3).find_map(|three| {
        let of_one = bare(three[0]) == "1" && !three[0].ends_with([',', ':', ';']);
        let next = bare(three[1]);
        let wrong = is_plural(&next) || !next.ends_with('s') && is_plural(&bare(three[2]));
        (of_one && wrong && !next.is_empty()).then(|| three.join(" "))
    })
}

#[test]
fn one_of_anything_is_told_in_the_singular() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([16, 16], 1));
    let (pack, run) = (folder.name("a.foveal"), folder.name("run"));
    let log = format!("{run}/session.jsonl");
    let one = ["--levels", "1", "--tile", "16"];
    let prepare = ["prepare", "video", &clip];
    let select = [
        "select",
        "--projection",
        "flat",
        "--size",
        "16x16",
        "--tile",
        "16",
    ];
    for command in [
        &[&prepare[..], &one, &["--dry-run"]].concat()[..],
        &[&prepare[..], &one, &["--out", &pack]].concat(),
        &["info", &pack],
        &["verify", &pack],
        &[
            "simulate",
            &pack,
            "--renderer",
            "none",
            "--out",
            &run,
            "--frames",
            "9",
        ],
        &["replay", &log],
        &["score", &clip, &clip, "--display", "standard_fhd"],
        &[&select[..], &["--levels", "1", "--random-gazes", "1"]].concat(),
        &[&select[..], &["--levels", "1", "--gaze", "0,0"]].concat(),
    ] {
        let ran = done(command);
        let said = format!("{}\n{}", ran.stdout, ran.stderr);
        assert_eq!(wrong_plural(&said), None, "{command:?}: {said}");
    }
}
