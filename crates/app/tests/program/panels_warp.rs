//! Are panels filled from one source as they would be drawn, and sent where they belong?

use crate::results::agrees;
use crate::support::{Folder, Rgb, foveal, json, refused};
use serde_json::Value;

fn rig(name: &str) -> String {
    format!(
        "{}/../../examples/panels/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    )
}

fn warp(rig: &str, source: &str, out: &str, more: &[&str]) -> Value {
    let mut arguments = vec!["panels", "warp", rig, source, "--out", out];
    arguments.extend(more);
    json(&arguments)
}

/// Decibels of the panels that were compared, by their ids.
fn decibels(result: &Value) -> Vec<(String, f64)> {
    let panels = result["panels"].as_array().unwrap().iter();
    panels
        .map(|it| {
            (
                it["id"].as_str().unwrap().to_owned(),
                it["psnr_db"].as_f64().unwrap(),
            )
        })
        .collect()
}

/// Over all panels together.
fn mean(all: &[(String, f64)]) -> f64 {
    let errors = all.iter().map(|(_, db)| 10.0_f64.powf(-db / 10.0));
    -10.0 * (errors.sum::<f64>() / all.len() as f64).log10()
}

#[test]
fn three_panels_look_as_drawn_directly_where_the_source_has_as_many_pixels_as_are_needed() {
    let folder = Folder::new();
    let out = folder.name("three");
    let result = warp(&rig("three"), "world:gratings", &out, &["--compare"]);
    let eye = ["--eye-blur", "-1.5@180", "--source", "320x240"];
    let blurred = warp(&rig("three"), "world:valley", &folder.name("blurred"), &eye);
    agrees("panels warp", &[&result, &blurred]);
    assert_eq!(blurred["eye_blur"]["pupil_mm"], 3.5);
    assert_eq!(result["frames"], 1);
    assert_eq!(result["placement"], "plane");
    assert_eq!(result["need"], result["source"]);
    for (id, db) in decibels(&result) {
        assert!(db >= 48.0, "{id}: {db} dB");
    }
    for panel in result["panels"].as_array().unwrap() {
        assert!(panel["jod"].as_f64().unwrap() > 9.5, "{panel}");
        assert!(panel["ssim"].as_f64().unwrap() > 0.99, "{panel}");
        assert!(panel["flip"].as_f64().unwrap() < 0.05, "{panel}");
    }
    let atlas = Rgb::read(&format!("{out}/atlas.png"));
    assert_eq!(atlas.size, [2400, 600]);
    assert_eq!(Rgb::read(&format!("{out}/C.png")).size, [800, 600]);
    assert_eq!(Rgb::read(&format!("{out}/compare/C.png")).size, [1600, 600]);
}

#[test]
fn a_magnified_panel_gains_six_db_by_cubics() {
    let folder = Folder::new();
    let db = |filter: &str| {
        let more = ["--compare", "--source", "1600x1200", "--filter", filter];
        let more = [&more[..], &["--placement", "seed"]].concat();
        let result = warp(&rig("three"), "world:gratings", &folder.name(filter), &more);
        let all = decibels(&result);
        all.iter().find(|(id, _)| id == "C").unwrap().1
    };
    let [auto, bilinear] = ["auto", "bilinear"].map(db);
    println!("auto {auto:.2} dB, bilinear {bilinear:.2} dB");
    assert!(auto >= bilinear + 6.0, "{auto} {bilinear}");
}

#[test]
fn a_plane_that_is_turned_to_twelve_panels_beats_that_of_the_seed() {
    let folder = Folder::new();
    for (world, least) in [("world:gratings", 10.0), ("world:valley", 6.0)] {
        let db = |placement: &str| {
            let more = [
                "--compare",
                "--source",
                "1920x1440",
                "--placement",
                placement,
            ];
            mean(&decibels(&warp(
                &rig("twelve"),
                world,
                &folder.name(placement),
                &more,
            )))
        };
        let [plane, seed] = ["plane", "seed"].map(db);
        println!("{world}: plane {plane:.2} dB, seed {seed:.2} dB");
        assert!(plane >= seed + least, "{world}: {plane} {seed}");
    }
}

#[test]
fn maps_of_the_seed_give_the_picture_of_the_matrices() {
    let folder = Folder::new();
    let of = |name: &str, more: &[&str]| {
        let mut all = vec![
            "--filter",
            "bilinear",
            "--placement",
            "seed",
            "--source",
            "800x600",
        ];
        all.extend(more);
        warp(&rig("three"), "world:gratings", &folder.name(name), &all);
        Rgb::read(&folder.name(&format!("{name}/atlas.png")))
    };
    let (maps, matrices) = (of("maps", &["--mode", "seed"]), of("matrices", &[]));
    let apart = maps.pixels.iter().zip(&matrices.pixels);
    let apart = apart.map(|(a, b)| a.abs_diff(*b));
    assert!(apart.max() <= Some(1));
}

#[test]
fn worlds_move_and_patterns_are_pictures_that_panels_show() {
    let folder = Folder::new();
    let out = folder.name("moving");
    let more = ["--frames", "2", "--source", "320x240", "--eye", "both"];
    let result = warp(&rig("three"), "world:valley", &out, &more);
    assert_eq!(result["frames"], 2);
    let frame = |n: u32| Rgb::read(&format!("{out}/L.right/frame_0000{n}.png"));
    assert_ne!(frame(0).pixels, frame(1).pixels);
    for name in ["grid", "white", "numbers"] {
        let file = folder.name(&format!("{name}.png"));
        let made = [
            "panels", "pattern", name, "--size", "640x480", "--out", &file,
        ];
        let made = json(&made);
        agrees("panels pattern", &[&made]);
        assert_eq!(made["size"][0], 640);
        let result = warp(
            &rig("three"),
            &file,
            &folder.name(name),
            &["--show-anisotropy"],
        );
        assert!(result["multi_probe_share"].as_f64().is_some());
        assert!(folder.join(name).join("R.png").exists());
    }
}

#[test]
fn frames_are_told_apart_whenever_they_are_asked_for() {
    let folder = Folder::new();
    let still = folder.name("white.png");
    let white = [
        "panels", "pattern", "white", "--size", "64x48", "--out", &still,
    ];
    json(&white);
    for (name, source, size) in [
        ("world", "world:valley", &["--source", "64x48"][..]),
        ("still", &still, &[]),
    ] {
        for (frames, file) in [
            (&[][..], "C.png"),
            (&["--frames", "1"], "C/frame_00000.png"),
        ] {
            let out = folder.name(&format!("{name}{}", frames.len()));
            let result = warp(&rig("three"), source, &out, &[size, frames].concat());
            assert_eq!(result["frames"], 1);
            assert_eq!(
                Rgb::read(&format!("{out}/{file}")).size,
                [800, 600],
                "{name}"
            );
        }
    }
}

/// Three low panels that need more columns than any device holds.
const WIDE: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "west"
pixels = [12800, 4]
pose = { order = "yaw-pitch-roll", yaw = -45 }
size = [0.8, 0.001]
output = { y = 0 }
[[panel]]
id = "ahead"
pixels = [12800, 4]
size = [0.8, 0.001]
output = { y = 4 }
[[panel]]
id = "east"
pixels = [12800, 4]
pose = { order = "yaw-pitch-roll", yaw = 45 }
size = [0.8, 0.001]
output = { y = 8 }
"#;

#[test]
fn a_world_that_needs_more_than_a_device_holds_is_drawn_as_large_as_it_holds_and_that_is_told() {
    let folder = Folder::new();
    let rig = folder.holding("wide.toml", WIDE.as_bytes());
    let of = |renderer: &str| {
        let out = folder.name(renderer);
        let more = ["--renderer", renderer];
        let result = warp(&rig, "world:gratings", &out, &more);
        let side = |key: &str, k: usize| result[key][k].as_u64().unwrap();
        assert_eq!(Rgb::read(&format!("{out}/ahead.png")).size, [12_800, 4]);
        [side("source", 0), side("need", 0)]
    };
    let ([gpu, need], [cpu, same]) = (of("gpu"), of("cpu"));
    assert!(need > 32_768 && need == same && cpu == need, "{need} {cpu}");
    // As many as the device's own limit, a power of two.
    assert!(gpu >= 8192 && gpu < need && gpu.is_power_of_two(), "{gpu}");
    let out = folder.name("named");
    let ran = foveal(&["panels", "warp", &rig, "world:gratings", "--out", &out]);
    let told = ran.stderr;
    assert!(told.contains("pixels that are needed"), "{told}");
}

#[test]
fn an_eye_with_astigmatism_loses_the_lines_along_its_axis_and_no_others() {
    let folder = Folder::new();
    let rig = folder.holding("pair.toml", PAIR.as_bytes());
    // Upright lines to the left, level ones to the right, 30 mrad apart.
    let source = Rgb {
        size: [640, 480],
        pixels: (0..480)
            .flat_map(|y| (0..640).map(move |x| if x < 320 { x } else { y }))
            .flat_map(|along| [if along / 12 % 2 == 0 { 230 } else { 20 }; 3])
            .collect(),
    };
    let file = folder.name("lines.png");
    source.write(&file);
    // Codes from dark to light: of upright lines, and of level ones.
    let contrast = |eye: &[&str]| {
        let out = folder.name("eye");
        warp(&rig, &file, &out, eye);
        let seen = Rgb::read(&format!("{out}/P.png"));
        [20, 100].map(|left| {
            let places = (30..90).flat_map(|y| (left..left + 40).map(move |x| [x, y]));
            let codes: Vec<u8> = places.map(|at| seen.at(at)[1]).collect();
            codes.iter().max().unwrap() - codes.iter().min().unwrap()
        })
    };
    let sharp = contrast(&[]);
    assert!(sharp.iter().all(|it| *it > 190), "{sharp:?}");
    for filter in ["auto", "anisotropic", "feline", "ewa"] {
        let of = |eye: &str| contrast(&["--eye-blur", eye, "--pupil", "5", "--filter", filter]);
        let ([upright, level], [upright_too, level_too]) = (of("-6@180"), of("6@90"));
        println!("{filter}: {upright} {level}, {upright_too} {level_too}");
        assert!(upright > 180 && level < 100, "{filter}: {upright} {level}");
        assert!(
            upright_too < 100 && level_too > 180,
            "{filter}: {upright_too} {level_too}"
        );
    }
}

#[test]
fn the_model_of_the_seed_says_its_numbers() {
    let all = [
        "panels",
        "bench",
        &rig("three"),
        "--panels",
        "3",
        "--runs",
        "1",
        "--model",
        "seed",
    ];
    let result = json(&all);
    agrees("panels bench", &[&result]);
    assert!((result["panels_trilinear"].as_f64().unwrap() - 38.194).abs() < 1e-3);
    assert!((result["panels_feline"].as_f64().unwrap() - 28.646).abs() < 1e-3);
    assert_eq!(result["rows"].as_array().unwrap().len(), 3);
    assert!(result["rows"][0]["map_mib"].as_f64().unwrap() <= 3.0 * 128.0 / 1048576.0);
}

#[test]
fn maps_of_the_seed_that_no_binding_holds_are_drawn_on_any_gpu() {
    let three = rig("three");
    let all = [
        "panels", "bench", &three, "--mode", "seed", "--panels", "3,24",
    ];
    let result = json(&[&all[..], &["--runs", "1", "--source", "320x240"]].concat());
    let rows = result["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    for row in rows {
        assert!(row["wall_ms"].as_f64().is_some(), "{row}");
    }
    // More than the 128 MiB that every device binds at once.
    let maps = 24.0 * 480_000.0 * 12.0 / 1_048_576.0;
    assert!(maps > 128.0 && (rows[3]["map_mib"].as_f64().unwrap() - maps).abs() < 1e-6);
}

/// Two screens of a wall of 164 degrees that overlap and fade, and have some black.
const OVERLAP: &str = r#"
format = "tiled-view/1"
[[panel]]
id = "west"
pixels = [160, 60]
pose = { order = "yaw-pitch-roll", yaw = -38 }
tangents = { left = 0.966, right = 0.966, up = 0.3, down = 0.3 }
output = { surface = "west" }
blend = 10
black = 0.05
[[panel]]
id = "east"
pixels = [160, 60]
pose = { order = "yaw-pitch-roll", yaw = 38 }
tangents = { left = 0.966, right = 0.966, up = 0.3, down = 0.3 }
output = { surface = "east" }
gain = [0.8, 1.0, 1.0]
blend = 10
black = 0.05
"#;

#[test]
fn pictures_that_are_sent_keep_fades_and_black_while_the_warp_is_compared() {
    let folder = Folder::new();
    let rig = folder.holding("overlap.toml", OVERLAP.as_bytes());
    let of = |out: &str, more: &[&str]| {
        let out = folder.name(out);
        let more = [&["--source", "320x120"], more].concat();
        (warp(&rig, "world:gratings", &out, &more), out)
    };
    let ((_, plain), (judged, compared)) = (of("plain", &[]), of("compared", &["--compare"]));
    for name in ["west", "east", "atlas-west", "atlas-east"] {
        let [a, b] = [&plain, &compared].map(|out| Rgb::read(&format!("{out}/{name}.png")));
        assert_eq!(a.pixels, b.pixels, "{name}");
    }
    // What is compared has none of them.
    for (id, db) in decibels(&judged) {
        assert!(db > 25.0, "{id}: {db} dB");
    }
    let sheet = Rgb::read(&format!("{compared}/compare/west.png"));
    let sent = Rgb::read(&format!("{compared}/west.png"));
    assert_eq!(sheet.size, [320, 60]);
    assert_ne!(sheet.at([159, 30]), sent.at([159, 30]));
}

#[test]
fn a_flat_picture_on_a_wide_wall_is_said_to_show_its_middle_band_alone() {
    let folder = Folder::new();
    let rig = folder.holding("wide.toml", OVERLAP.as_bytes());
    let white = folder.name("white.png");
    let of_size = |size: &str| {
        let made = [
            "panels", "pattern", "white", "--size", size, "--out", &white,
        ];
        json(&made);
        let out = folder.name("out");
        foveal(&["panels", "warp", &rig, &white, "--out", &out]).stderr
    };
    let told = of_size("160x90");
    assert!(told.contains("the middle band of the picture"), "{told}");
    assert!(told.contains(":1 would fill them"), "{told}");
    let fits = of_size("320x60");
    assert!(!fits.contains("band"), "{fits}");
}

#[test]
fn the_text_of_a_warp_names_filter_and_device_and_leaves_out_what_is_nothing() {
    let folder = Folder::new();
    let out = folder.name("out");
    let more = ["--source", "64x48"];
    let all = [
        "panels",
        "warp",
        &rig("three"),
        "world:valley",
        "--out",
        &out,
    ];
    let ran = foveal(&[&all[..], &more].concat()).stdout;
    assert!(ran.contains("filter auto, drawn by "), "{ran}");
    assert!(!ran.contains("Feline"), "{ran}");
}

#[test]
fn what_cannot_be_warped_is_refused_in_words() {
    let folder = Folder::new();
    let out = folder.name("out");
    let three = rig("three");
    let white = folder.name("white.png");
    json(&[
        "panels", "pattern", "white", "--size", "64x48", "--out", &white,
    ]);
    let refuse = |source: &str, more: &[&str], words: &str| {
        let mut all = vec!["panels", "warp", &three, source, "--out", &out];
        all.extend(more);
        refused(2, &all, &[words]);
    };
    refuse("world:moon", &[], "world:valley or world:gratings");
    refuse(&white, &["--compare"], "cannot be drawn directly");
    refuse(&white, &["--source", "10x10"], "has its own size, 64x48");
    refuse("world:valley", &["--stereo", "sbs"], "leave it out");
    refuse("world:valley", &["--distance", "0"], "0.05 to 1000000");
    refuse(
        "world:valley",
        &["--compare", "--show-anisotropy"],
        "paints over",
    );
    let size = [
        "panels", "pattern", "grid", "--size", "99999x4", "--out", &white,
    ];
    refused(2, &size, &["16384"]);
    let jpeg = folder.name("white.jpg");
    let jpeg = [
        "panels", "pattern", "white", "--size", "64x48", "--out", &jpeg,
    ];
    refused(2, &jpeg, &["white.jpg", "end it in .png"]);
    let nowhere = ["panels", "warp", &three, "world:valley"];
    refused(2, &nowhere, &["--out DIR", "--window"]);
    for (eye, words) in [
        ("1", "as -1.5@180"),
        ("x@y", "as -1.5@180"),
        ("NaN@90", "no cylinder of -12 to 12"),
        ("1@inf", "no axis of 0 to 360"),
        ("13@90", "no cylinder of -12 to 12"),
        ("1@-5", "no axis of 0 to 360"),
    ] {
        refuse("world:valley", &["--eye-blur", eye], words);
    }
    for (more, words) in [
        (
            &["--filter", "bicubic"][..],
            "auto, anisotropic, feline or ewa",
        ),
        (&["--pupil", "0.5"], "1 to 9 millimetres"),
        (&["--compare"], "not drawn with --compare"),
        (&["--show-anisotropy"], "not drawn with --show-anisotropy"),
        (&["--mode", "seed"], "not drawn with --mode seed"),
    ] {
        refuse(
            "world:valley",
            &[&["--eye-blur", "-1@90"], more].concat(),
            words,
        );
    }
    refuse("world:valley", &["--pupil", "3"], "--eye-blur");
}

/// One panel before each eye, looking ahead.
const PAIR: &str = r#"
format = "tiled-view/1"
mirror = true
[[panel]]
id = "P"
eye = "left"
pixels = [160, 120]
pose = { order = "yaw-pitch-roll" }
tangents = { left = 0.4, right = 0.4, up = 0.3, down = 0.3 }
output = { surface = "main" }
"#;

#[test]
fn each_eye_sees_its_half_of_a_source_for_two_eyes() {
    let folder = Folder::new();
    let rig = folder.holding("pair.toml", PAIR.as_bytes());
    let [red, blue] = [[200_u8, 20, 20], [20, 20, 200]];
    for (stereo, is_left) in [
        ("sbs", (|x: u32, _: u32| x < 64) as fn(u32, u32) -> bool),
        ("tb", |_, y| y < 48),
    ] {
        let source = Rgb {
            size: [128, 96],
            pixels: (0..96)
                .flat_map(|y| (0..128).map(move |x| [x, y]))
                .flat_map(|[x, y]| if is_left(x, y) { red } else { blue })
                .collect(),
        };
        let file = folder.name("halves.png");
        source.write(&file);
        let out = folder.name(stereo);
        warp(&rig, &file, &out, &["--stereo", stereo, "--eye", "both"]);
        for (id, expected) in [("P", red), ("P.right", blue)] {
            let seen = Rgb::read(&format!("{out}/{id}.png"));
            let off = |at: [u32; 2]| {
                let pixel = seen.at(at);
                (0..3)
                    .map(|k| pixel[k].abs_diff(expected[k]))
                    .max()
                    .unwrap()
            };
            assert!(seen.places().all(|at| off(at) <= 1), "{stereo} {id}");
        }
    }
}

#[test]
fn a_source_at_a_distance_lies_apart_for_the_two_eyes_and_a_far_one_does_not() {
    let folder = Folder::new();
    let rig = folder.holding("pair.toml", PAIR.as_bytes());
    let file = folder.name("numbers.png");
    json(&[
        "panels", "pattern", "numbers", "--size", "640x480", "--out", &file,
    ]);
    let pictures = |more: &[&str]| {
        let out = folder.name("distance");
        warp(&rig, &file, &out, &[&["--eye", "both"], more].concat());
        ["P", "P.right"].map(|id| Rgb::read(&format!("{out}/{id}.png")))
    };
    let [left, right] = pictures(&[]);
    assert_eq!(left.difference(&right), 0);
    // At half a metre eyes that are 63 mm apart see it 0.126 of a tangent apart: 25 of 160 columns.
    let [left, right] = pictures(&["--distance", "0.5"]);
    let off = |shift: u32| -> u64 {
        let places = (0..120).flat_map(|y| (40..100).map(move |x| [x, y]));
        let of = |[x, y]: [u32; 2]| {
            let [a, b] = [left.at([x + shift, y])[1], right.at([x, y])[1]];
            u64::from(a.abs_diff(b))
        };
        places.map(of).sum()
    };
    let best = (0..50).min_by_key(|shift| off(*shift)).unwrap();
    assert!((24..=26).contains(&best), "{best} columns");
}
