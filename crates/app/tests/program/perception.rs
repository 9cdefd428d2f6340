//! Does the program say what the eye sees, and refuse what cannot be looked at?

use crate::support::{Folder, Rgb, assert_keys, json, refused};

/// A grey PNG file from a function of column and row.
fn picture(folder: &Folder, name: &str, size: [u32; 2], grey: impl Fn(u32, u32) -> u8) -> String {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    let pixels: Vec<u8> = (0..size[1])
        .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
        .map(|(x, y)| grey(x, y))
        .collect();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    folder.holding(name, &bytes)
}

fn stripes(folder: &Folder, name: &str) -> String {
    picture(
        folder,
        name,
        [160, 90],
        |x, _| if x % 4 < 2 { 90 } else { 160 },
    )
}

#[test]
fn the_table_has_the_published_values_and_the_corrected_ones() {
    let ask = |model| {
        json(&[
            "perception",
            "table",
            "--model",
            model,
            "--ecc",
            "0,10",
            "--meridian",
            "temporal",
            "--cpd",
            "1,16",
            "--luminance",
            "100",
        ])
    };
    let near = |value: &serde_json::Value, expected: f64| {
        let value = value.as_f64().unwrap();
        assert!((value / expected - 1.0).abs() < 1e-5, "{value} {expected}");
    };
    let paper = ask("paper");
    near(&paper["acuity"][0]["e_cpd"], 80.066097);
    near(&paper["acuity"][1]["e_cpd"], 9.765679);
    near(&paper["acuity"][1]["density_per_deg2"], 440.4882);
    near(&paper["acuity"][0]["spacing_arcmin"], 0.374690);
    near(&paper["csf"][0]["sensitivity"], 229.953481);
    let default = ask("default");
    near(&default["acuity"][0]["e_cpd"], 65.373694);
    near(&default["csf"][1]["sensitivity"], 5.675);
}

#[test]
fn importance_is_highest_where_the_eye_looks() {
    let folder = Folder::new();
    let plain = picture(&folder, "plain.png", [160, 90], |_, _| 125);
    let stripes = stripes(&folder, "stripes.png");
    let heat = folder.name("heat.png");
    let report = json(&[
        "perception",
        "importance",
        &plain,
        &stripes,
        "--gaze",
        "40,45",
        "--fov",
        "20",
        "--out",
        &heat,
        "--updates",
    ]);
    assert_keys(
        &report,
        &[
            "mode",
            "gaze_px",
            "fov_deg",
            "parameters",
            "maps",
            "sheet_file",
        ],
    );
    assert!(report["maps"][0]["mean"].as_f64().unwrap() > 0.0);
    let light = |path: &str, at| Rgb::read(path).at(at).map(u32::from).iter().sum::<u32>();
    assert!(light(&heat, [40, 45]) > light(&heat, [150, 45]));
    let eccentricity = folder.name("heat-eccentricity.png");
    assert!(light(&eccentricity, [40, 45]) > light(&eccentricity, [150, 45]));
    for name in ["heat-popping.png", "heat-update.png", "heat-sheet.png"] {
        assert!(folder.names().contains(&name.to_owned()), "{name}");
    }
}

#[test]
fn in_a_saccade_the_heat_map_is_the_same_for_every_gaze() {
    let folder = Folder::new();
    let plain = picture(&folder, "plain.png", [160, 90], |_, _| 125);
    let stripes = stripes(&folder, "stripes.png");
    let heat = |gaze: &str, name: &str| {
        let out = folder.name(name);
        json(&[
            "perception",
            "importance",
            &plain,
            &stripes,
            "--gaze",
            gaze,
            "--fov",
            "20",
            "--mode",
            "saccade",
            "--out",
            &out,
        ]);
        Rgb::read(&out)
    };
    assert_eq!(
        heat("10,10", "a.png").difference(&heat("150,80", "b.png")),
        0
    );
}

#[test]
fn the_finest_stripes_are_in_the_finest_band() {
    let folder = Folder::new();
    let grey = |x, _| if x % 2 == 0 { 90 } else { 160 };
    let stripes = picture(&folder, "stripes.png", [160, 90], grey);
    let out = folder.name("bands");
    let report = json(&[
        "perception",
        "bands",
        &stripes,
        "--gaze",
        "80,45",
        "--fov",
        "20",
        "--out",
        &out,
    ]);
    let seen = |band: usize| report["bands"][band]["mean_seen"].as_f64().unwrap();
    // A quarter of 160 pixels over 20 degrees, a little less in the middle.
    assert!((report["bands"][0]["cpd"].as_f64().unwrap() - 2.0).abs() < 0.1);
    assert!((1..4).all(|band| seen(band) < 0.2 * seen(0)), "{report}");
    assert_eq!(Rgb::read(&format!("{out}/band-3.png")).size, [160, 90]);
}

#[test]
fn what_cannot_be_looked_at_is_refused() {
    let folder = Folder::new();
    let a = stripes(&folder, "a.png");
    let small = picture(&folder, "small.png", [16, 16], |_, _| 9);
    let dot = picture(&folder, "dot.png", [1, 1], |_, _| 9);
    let broken = folder.holding("broken.png", b"\x89PNG\r\n\x1a\nno");
    let out = folder.name("heat.png");
    let look = |b: &str, gaze: &str, fov: &str, more: &[&str], code, words: &[&str]| {
        let args = [
            "perception",
            "importance",
            &a,
            b,
            "--gaze",
            gaze,
            "--fov",
            fov,
        ];
        let args = [&args[..], &["--out", &out], more].concat();
        refused(code, &args, words);
    };
    for fov in ["0", "180", "nan", "-20", "inf"] {
        look(&a, "5,5", fov, &[], 2, &["--fov", "1 to 170"]);
    }
    for gaze in ["-1,5", "5,91", "161,5"] {
        look(&a, gaze, "40", &[], 2, &["--gaze", "160x90"]);
    }
    look(
        &a,
        "5,5",
        "40",
        &["--set", "lamda=3"],
        2,
        &["lamda", "lambda"],
    );
    look(&a, "5,5", "40", &["--set", "omega=0"], 2, &["omega"]);
    look(&a, "5,5", "40", &["--set", "omega"], 2, &["NAME=VALUE"]);
    look(&a, "5,5", "40", &["--spread", "nan"], 2, &["--spread"]);
    look(
        &small,
        "5,5",
        "40",
        &[],
        1,
        &["small.png", "16x16", "160x90"],
    );
    look(&dot, "5,5", "40", &[], 1, &["dot.png", "1x1"]);
    look(&broken, "5,5", "40", &[], 1, &["broken.png"]);
    look("/no/such.png", "5,5", "40", &[], 1, &["such.png"]);
    refused(2, &["perception", "table", "--ecc", "nan"], &["--ecc"]);
    refused(2, &["perception", "table", "--cpd", "-1"], &["--cpd"]);
    refused(
        2,
        &["perception", "table", "--luminance", "0"],
        &["--luminance"],
    );
}
