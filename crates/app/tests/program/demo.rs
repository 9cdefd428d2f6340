//! Does the demo show every kind of input, with plots that can be read?

use crate::results::agrees;
use crate::scene::torus;
use crate::scenes::{waves, write_clip};
use crate::support::{Folder, Rgb, json, refused};
use serde_json::Value;

/// Two small panels before the left eye.
const PAIR: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "L"
eye = "left"
pixels = [64, 48]
pose = { order = "yaw-pitch-roll", yaw = -20 }
size = [0.9, 0.675]
[[panel]]
id = "R"
eye = "left"
pixels = [64, 48]
pose = { order = "yaw-pitch-roll", yaw = 20 }
size = [0.9, 0.675]
"#;

/// A small still of 360°.
fn sphere(folder: &Folder) -> String {
    let size = [128, 64];
    let code = |k: u32| ((k * 37) % 200 + 20) as u8;
    let pixels = (0..size[0] * size[1] * 3).map(code).collect();
    let path = folder.name("round-360.png");
    Rgb { size, pixels }.write(&path);
    path
}

/// What the demo prints, and its page.
fn show(folder: &Folder, inputs: &[&str]) -> (Value, String) {
    let out = folder.name("demo");
    let rig = folder.holding("pair.toml", PAIR.as_bytes());
    let mut arguments = vec![
        "demo",
        "--renderer",
        "cpu",
        "--view",
        "160x100",
        "--out",
        &out,
    ];
    arguments.extend(["--panels", &rig, "--calibrate", "off"]);
    for input in inputs {
        arguments.extend(["--input", input]);
    }
    let shown = json(&arguments);
    let page = std::fs::read_to_string(format!("{out}/report.html")).unwrap();
    (shown, page)
}

#[test]
fn a_film_a_sphere_and_a_mesh_each_get_the_parts_that_fit_them() {
    let folder = Folder::new();
    let film = write_clip(&folder, "film.mkv", &waves([96, 64], 3));
    let mesh = folder.holding("ring.obj", torus(24, 12).as_bytes());
    let (shown, page) = show(&folder, &[&film, &sphere(&folder), &mesh]);
    agrees("demo", &[&shown]);
    for title in [
        "A clip as it is: film",
        "A still sphere in a headset: round-360",
        "A mesh through 4 Mbit/s: ring",
        "2 panels from one source: round-360",
    ] {
        assert!(page.contains(&format!("<h2>{title}</h2>")), "{title}");
    }
    // Each part has pixels or triangles, bytes, time and both scores on its cards.
    let cards: Vec<&str> = page.split("<dl class=\"cards\">").skip(1).collect();
    assert_eq!(cards.len(), 4);
    for part in cards {
        let part = part.split("</dl>").next().unwrap();
        assert!(part.matches("<dt>").count() >= 4, "{part}");
        for word in ["JOD", "against full", "source", "MB", "s</b>"] {
            assert!(part.contains(word), "{word}: {part}");
        }
    }
    every_series_can_be_seen(&page);
    // A ring so small is there at once, and a clip of noise gains nothing on its file.
    assert!(page.contains("Little gained here, because "));

    let alone = show(&folder, &[&mesh]);
    assert_eq!(
        alone.1.matches("<h2>").count(),
        2,
        "one part and how to read it"
    );
    assert!(alone.0["contents"].as_object().unwrap().is_empty());
}

#[test]
fn a_clip_is_for_a_demo_without_other_inputs() {
    let folder = Folder::new();
    let out = folder.name("demo");
    let both = ["demo", "--out", &out, "--clip", "a.mkv", "--input", "b.mkv"];
    refused(2, &both, &["--clip", "--input"]);
    refused(1, &["demo", "--out", &out, "--clip", "a.mkv"], &["a.mkv"]);
}

/// Whether each line of each plot has a stroke that stands out from the page in light and in dark,
/// and a label in the same colour.
fn every_series_can_be_seen(page: &str) {
    let style = between(page, "<style>", "</style>");
    let (light, dark) = style.split_once("prefers-color-scheme: dark").unwrap();
    let plots: Vec<&str> = page.split("<svg ").skip(1).collect();
    assert!(plots.len() >= 4, "{}", plots.len());
    for plot in plots {
        let plot = plot.split("</svg>").next().unwrap();
        let series: Vec<&str> = plot.split("<polyline class=\"line ").skip(1).collect();
        assert!(series.len() >= 2, "{plot}");
        for line in series {
            let name = line.split('"').next().unwrap();
            let points = between(line, "points=\"", "\"");
            assert!(points.split(' ').count() >= 2, "{name}: {points}");
            let label = format!("<text class=\"label {name}\"");
            let labels: Vec<&str> = plot.split(&label).skip(1).collect();
            assert_eq!(labels.len(), 1, "{name}");
            assert_eq!(between(labels[0], ">", "<"), name);
            let stroke = declared(style, &format!("svg .line.{name}"), "stroke");
            assert_eq!(
                declared(style, &format!("svg .label.{name}"), "fill"),
                stroke
            );
            let variable = between(&stroke, "var(--", ")");
            for theme in [light, dark] {
                let [colour, paper] = [variable, "paper"].map(|name| colour_of(theme, name));
                let found = contrast(colour, paper);
                assert!(found >= 3.0, "{name}: {found}");
            }
        }
    }
}

fn between<'a>(text: &'a str, begin: &str, end: &str) -> &'a str {
    let rest = text.split_once(begin).map(|(_, rest)| rest);
    rest.and_then(|rest| rest.split(end).next())
        .unwrap_or_else(|| panic!("no {begin} in {text:.200}"))
}

/// What a rule of a style sheet says of a property; nothing in it may hide what it is for.
fn declared(style: &str, selector: &str, property: &str) -> String {
    let rule = between(style, &format!("\n{selector} {{"), "}");
    assert!(
        !rule.contains("opacity") && !rule.contains("display"),
        "{rule}"
    );
    let mut declarations = rule.split(';').filter_map(|one| one.split_once(':'));
    let found = declarations.find(|(name, _)| name.trim() == property);
    found.map(|(_, value)| value.trim().to_owned()).unwrap()
}

/// Red, green and blue of a variable, 0 to 1.
fn colour_of(theme: &str, name: &str) -> [f64; 3] {
    let hex = between(theme, &format!("--{name}: #"), ";");
    [0, 2, 4].map(|at| f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0)
}

/// Contrast of two colours (WCAG 2.2): 1 to 21; graphics need 3.
fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
    let luminance = |colour: [f64; 3]| {
        let [r, g, b] = colour.map(|c| match c <= 0.04045 {
            true => c / 12.92,
            false => ((c + 0.055) / 1.055).powf(2.4),
        });
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let [a, b] = [a, b].map(luminance);
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}
