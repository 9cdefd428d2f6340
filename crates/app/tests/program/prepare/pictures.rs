//! Is a single picture prepared as a picture, laid as its own tags say?

use crate::scenes::{waves, write_clip};
use crate::support::{Folder, Rgb, done, frame_picture, json, refused};
use serde_json::{Value, json};

/// Red, green and blue of every pixel.
struct Photo {
    size: [u32; 2],
    rgb: Vec<u8>,
}

/// What a file says besides its pixels.
#[derive(Clone, Default)]
struct Tags {
    exif: Option<Vec<u8>>,
    xmp: Option<String>,
}

impl Photo {
    fn new([width, height]: [u32; 2], colour: impl Fn(u32, u32) -> [u8; 3]) -> Self {
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self {
            size: [width, height],
            rgb: rows.flat_map(|(x, y)| colour(x, y)).collect(),
        }
    }

    /// Soft waves that differ everywhere.
    fn of_waves(size: [u32; 2]) -> Self {
        Self::new(size, |x, y| {
            let [x, y] = [x, y].map(f64::from);
            let wave = |a: f64, b: f64| (128.0 + 90.0 * (a * x + b * y).sin()) as u8;
            [wave(0.05, 0.03), wave(0.02, -0.06), wave(0.011, 0.05)]
        })
    }

    /// Detail of all sizes down to a pixel, edges and grain.
    fn of_grain(size: [u32; 2]) -> Self {
        let noise = |x: u32, y: u32, seed: u32| {
            let mut n = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ (seed << 20);
            for _ in 0..3 {
                n = (n ^ (n >> 15)).wrapping_mul(0x2c1b_3c6d);
            }
            f64::from(n >> 8) / f64::from(1 << 24) - 0.5
        };
        Self::new(size, |x, y| {
            let octaves = (0..7).map(|o| noise(x >> o, y >> o, o) * 9.0 * f64::from(1 + o));
            let edge = if (x / 37 + y / 23) % 3 == 0 {
                45.0
            } else {
                0.0
            };
            let code = 100.0 + octaves.sum::<f64>() + edge;
            [code * 1.05, code, code * 0.9].map(|c| c.clamp(0.0, 255.0) as u8)
        })
    }

    /// The part of it that begins at a place.
    fn cut(&self, [left, top]: [u32; 2], size: [u32; 2]) -> Self {
        Self::new(size, |x, y| self.at([x + left, y + top]))
    }

    fn at(&self, [x, y]: [u32; 2]) -> [u8; 3] {
        let place = ((y * self.size[0] + x) * 3) as usize;
        [0, 1, 2].map(|c| self.rgb[place + c])
    }

    fn jpeg(&self, folder: &Folder, name: &str, tags: &Tags) -> String {
        let mut bytes = Vec::new();
        let encoder = jpeg_encoder::Encoder::new(&mut bytes, 95);
        let [w, h] = self.size.map(|side| side as u16);
        encoder
            .encode(&self.rgb, w, h, jpeg_encoder::ColorType::Rgb)
            .unwrap();
        let mut segments = Vec::new();
        let mut segment = |head: &[u8], body: &[u8]| {
            segments.extend([0xff, 0xe1]);
            segments.extend(((head.len() + body.len() + 2) as u16).to_be_bytes());
            segments.extend(head);
            segments.extend(body);
        };
        if let Some(exif) = &tags.exif {
            segment(b"Exif\0\0", exif);
        }
        if let Some(xmp) = &tags.xmp {
            segment(b"http://ns.adobe.com/xap/1.0/\0", xmp.as_bytes());
        }
        bytes.splice(2..2, segments);
        folder.holding(name, &bytes)
    }

    fn png(&self, folder: &Folder, name: &str, tags: &Tags) -> String {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgb);
        if let Some(xmp) = &tags.xmp {
            let name = "XML:com.adobe.xmp".to_owned();
            encoder.add_itxt_chunk(name, xmp.clone()).unwrap();
        }
        let mut writer = encoder.write_header().unwrap();
        if let Some(exif) = &tags.exif {
            writer.write_chunk(png::chunk::eXIf, exif).unwrap();
        }
        writer.write_image_data(&self.rgb).unwrap();
        writer.finish().unwrap();
        folder.holding(name, &bytes)
    }
}

/// EXIF with an orientation, and a text behind it that can be cut.
fn exif(orientation: u16) -> Vec<u8> {
    let mut bytes = b"MM\0*\0\0\0\x08\0\x02".to_vec();
    bytes.extend([0x01, 0x12, 0, 3, 0, 0, 0, 1]);
    bytes.extend(orientation.to_be_bytes());
    bytes.extend([0, 0]);
    bytes.extend([0x82, 0x98, 0, 2, 0, 0, 0, 8, 0, 0, 0, 38, 0, 0, 0, 0]);
    bytes.extend(b"no one.\0");
    bytes
}

/// An XMP packet with these names and values of a photo sphere.
fn gpano(said: &[(&str, &str)]) -> Option<String> {
    let attributes: Vec<String> = said
        .iter()
        .map(|(name, value)| format!("GPano:{name}=\"{value}\""))
        .collect();
    Some(format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\
         <x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\
         <rdf:Description rdf:about=\"\" \
         xmlns:GPano=\"http://ns.google.com/photos/1.0/panorama/\" {}/>\
         </rdf:RDF></x:xmpmeta><?xpacket end=\"w\"?>",
        attributes.join(" ")
    ))
}

/// The tags of a picture cut out of a sphere.
fn cropped(whole: [u32; 2], at: [u32; 2], size: [u32; 2], more: &[(&str, &str)]) -> Tags {
    let numbers = [whole[0], whole[1], size[0], size[1], at[0], at[1]].map(|n| n.to_string());
    let names = [
        "FullPanoWidthPixels",
        "FullPanoHeightPixels",
        "CroppedAreaImageWidthPixels",
        "CroppedAreaImageHeightPixels",
        "CroppedAreaLeftPixels",
        "CroppedAreaTopPixels",
    ];
    let mut said = vec![("ProjectionType", "equirectangular")];
    said.extend(names.into_iter().zip(numbers.iter().map(String::as_str)));
    for (name, value) in more {
        said.retain(|(other, _)| other != name);
        said.push((name, value));
    }
    Tags {
        xmp: gpano(&said),
        ..Tags::default()
    }
}

/// Prepares without loss, plays, and reads what is seen.
fn seen(folder: &Folder, file: &str, how: &[&str], view: &str) -> Rgb {
    let (pack, out) = (folder.name("seen.foveal"), folder.name("seen"));
    let prepare = ["prepare", "video", file, "--out", &pack, "--force"];
    done(&[&prepare[..], &["--codec", "png", "--levels", "2"], how].concat());
    let play = ["simulate", &pack, "--policy", "full", "--renderer", "cpu"];
    done(&[&play[..], &["--view", view, "--out", &out]].concat());
    frame_picture(&out, 0)
}

#[test]
fn a_picture_is_told_as_a_picture_and_film_as_film() {
    let folder = Folder::new();
    let photo = Photo::of_waves([96, 64]).jpeg(&folder, "a.jpg", &Tags::default());
    let film = write_clip(&folder, "b.mkv", &waves([96, 64], 2));
    let packs = ["a", "b"].map(|name| folder.name(&format!("{name}.foveal")));
    let mut told = Vec::new();
    for (input, pack) in [&photo, &film].into_iter().zip(&packs) {
        let ran = done(&["prepare", "video", input, "--out", pack]);
        let rehearsed = done(&["prepare", "video", input, "--dry-run"]).stdout;
        told.push(
            [
                ran.stdout,
                ran.stderr,
                done(&["info", pack]).stdout,
                rehearsed,
            ]
            .concat(),
        );
    }
    let words_of_film = ["fps", "1 frame", "groups of", "a frame", "0.04 s"];
    assert!(told[0].contains("\na picture\n"), "{}", told[0]);
    for word in words_of_film {
        assert!(!told[0].contains(word), "{word:?} in {}", told[0]);
    }
    assert!(
        told[1].contains("2 frames at 25.000 fps, 0.08 s"),
        "{}",
        told[1]
    );
    let [picture, video] = [&packs[0], &packs[1]].map(|pack| json(&["info", pack]));
    for (key, of_picture, of_video) in [
        ("content", json!("picture"), json!("video")),
        ("fps", Value::Null, json!(25.0)),
        ("seconds", Value::Null, json!(0.08)),
        ("frames", json!(1), json!(2)),
    ] {
        assert_eq!(
            (&picture[key], &video[key]),
            (&of_picture, &of_video),
            "{key}"
        );
    }
    let groups = picture["groups"].as_array().unwrap();
    assert!(groups.iter().all(|group| *group == 1), "{picture}");
    assert!(
        picture["quality"][0].as_u64() < video["quality"][0].as_u64(),
        "a picture is coded finer than film: {picture}"
    );
}

#[test]
fn by_default_the_finest_level_of_a_picture_scores_as_high_as_its_source_without_loss() {
    let folder = Folder::new();
    let photo = Photo::of_grain([512, 320]).png(&folder, "a.png", &Tags::default());
    let pack = |name: &str, how: &[&str]| {
        let pack = folder.name(name);
        done(&[&["prepare", "video", &photo, "--out", &pack], how].concat());
        pack
    };
    let lossless = pack("lossless.foveal", &["--codec", "png"]);
    let picture = pack("picture.foveal", &[]);
    let as_film = pack("film.foveal", &["--quality", "24"]);
    // Over 83°: a pixel is as wide as in a panorama of 2048.
    let view = [
        "--policy", "full", "--view", "512x320", "--screen", "24,0.3",
    ];
    let worst = |pack: &str| {
        let places = [-1, 0, 1].map(|y| [-1, 0, 1].map(|x| [x * 171, y * 107]));
        let jod = |[x, y]: &[i32; 2]| {
            let gaze = format!("--gaze={x},{y}");
            let score = json(&[&["score", &lossless, pack, &gaze], &view[..]].concat());
            score["jod"].as_f64().unwrap()
        };
        places.as_flattened().iter().map(jod).fold(10.0, f64::min)
    };
    let [picture, as_film] = [&picture, &as_film].map(|pack| worst(pack));
    assert!(picture >= 9.8, "{picture}");
    assert!(
        as_film < 9.8,
        "{as_film}: the scene asks nothing of a picture"
    );
}

#[test]
fn exif_stands_a_picture_upright_once() {
    let folder = Folder::new();
    // Red, green above blue, white: where each is seen shows the orientation.
    let quarters = [[220, 30, 30], [30, 200, 30], [30, 30, 220], [240, 240, 240]];
    let photo = Photo::new([96, 64], |x, y| quarters[(x / 48 + y / 32 * 2) as usize]);
    for (number, order) in [
        (1, [0, 1, 2, 3]),
        (2, [1, 0, 3, 2]),
        (3, [3, 2, 1, 0]),
        (4, [2, 3, 0, 1]),
        (5, [0, 2, 1, 3]),
        (6, [2, 0, 3, 1]),
        (7, [3, 1, 2, 0]),
        (8, [1, 3, 0, 2]),
    ] {
        let tags = Tags {
            exif: Some(exif(number)),
            ..Tags::default()
        };
        let [w, h] = if number < 5 { [96, 64] } else { [64, 96] };
        for file in [
            photo.jpeg(&folder, "a.jpg", &tags),
            photo.png(&folder, "a.png", &tags),
        ] {
            let seen = seen(&folder, &file, &[], &format!("{w}x{h}"));
            for (k, from) in (0..).zip(order) {
                let at = [w / 4 + k % 2 * w / 2, h / 4 + k / 2 * h / 2];
                let off = (0..3)
                    .map(|c| seen.at(at)[c].abs_diff(quarters[from][c]))
                    .max();
                assert!(off < Some(12), "{number} {file} {at:?}: {:?}", seen.at(at));
            }
        }
    }
}

#[test]
fn a_cropped_panorama_is_seen_where_it_was_cut_from_and_its_heading_turns_it() {
    let folder = Folder::new();
    let whole = Photo::of_waves([512, 256]);
    for (at, size, heading) in [
        ([128, 64], [256, 128], None),
        ([160, 40], [192, 160], Some(0.0)),
        ([0, 0], [512, 256], Some(90.0)),
        ([128, 64], [256, 128], Some(315.0)),
        ([128, 64], [256, 128], Some(-45.0)),
        // The part lies across the border of the whole.
        ([192, 0], [320, 256], Some(180.0)),
    ] {
        let told = heading.map(|degrees: f64| degrees.to_string());
        let more: Vec<(&str, &str)> = told
            .iter()
            .map(|degrees| ("PoseHeadingDegrees", degrees.as_str()))
            .collect();
        let tags = cropped([512, 256], at, size, &more);
        let part = whole.cut(at, size).png(&folder, "part.png", &tags);
        // The same by hand: black where nothing is, and turned to north.
        let turn = (heading.unwrap_or(0.0) / 360.0 * 512.0).rem_euclid(512.0) as u32;
        let by_hand = Photo::new([512, 256], |x, y| {
            let from = [(x + 512 - turn) % 512, y];
            let inside = |k: usize| from[k] >= at[k] && from[k] < at[k] + size[k];
            if inside(0) && inside(1) {
                whole.at(from)
            } else {
                [0; 3]
            }
        });
        let by_hand = by_hand.png(&folder, "whole.png", &Tags::default());
        let found = seen(&folder, &part, &[], "240x160");
        let expected = seen(&folder, &by_hand, &["--projection", "equirect"], "240x160");
        // Chroma at a border knows nothing of what was black beyond it: 3 % may be off.
        let far: Vec<[u32; 2]> = found
            .places()
            .filter(|at| {
                let [a, b] = [found.at(*at), expected.at(*at)];
                (0..3).any(|c| a[c].abs_diff(b[c]) > 6)
            })
            .collect();
        assert!(
            far.len() < 240 * 160 * 3 / 100,
            "{at:?} {size:?} {heading:?}: {} differ",
            far.len()
        );
        let info = json(&["info", &folder.name("seen.foveal")]);
        assert_eq!(info["projection"], "cube");
    }
}

#[test]
fn whoever_opens_a_cropped_panorama_sees_its_middle_and_says_so() {
    let folder = Folder::new();
    let photo = Photo::of_waves([256, 128]);
    let tags = cropped(
        [1024, 512],
        [384, 192],
        [256, 128],
        &[("PoseHeadingDegrees", "200")],
    );
    let file = photo.jpeg(&folder, "a.jpg", &tags);
    let pack = folder.name("a.foveal");
    let said = done(&["prepare", "video", &file, "--out", &pack]).stderr;
    for words in [
        "GPano",
        "forward is north",
        "200.0°",
        "90° x 45°",
        "1024x512",
    ] {
        assert!(said.contains(words), "no {words:?} in {said}");
    }
    let front = json(&["info", &pack])["front_deg"].as_f64().unwrap();
    assert!((front + 160.0).abs() < 0.5, "{front}");
    // Half the size, the same place: what was scaled lies where it lay.
    let half = Photo::of_waves([128, 64]).jpeg(&folder, "b.jpg", &tags);
    let pack = folder.name("b.foveal");
    let said = done(&["prepare", "video", &half, "--out", &pack]).stderr;
    assert!(
        said.contains("90° x 45°") && said.contains("512x256"),
        "{said}"
    );
}

#[test]
fn a_picture_whose_metadata_asks_to_be_flat_is_flat() {
    let folder = Folder::new();
    let whole = [("ProjectionType", "equirectangular")];
    for (said, projection, words) in [
        (&whole[..], "cube", "360°"),
        (
            &[whole[0], ("UsePanoramaViewer", "False")],
            "flat",
            "UsePanoramaViewer",
        ),
        (&[("ProjectionType", "cylindrical")], "flat", "cylindrical"),
        (&[("UsePanoramaViewer", "True")], "flat", "ProjectionType"),
    ] {
        let tags = Tags {
            xmp: gpano(said),
            ..Tags::default()
        };
        let file = Photo::of_waves([128, 64]).jpeg(&folder, "a.jpg", &tags);
        let pack = folder.name("a.foveal");
        let ran = done(&["prepare", "video", &file, "--out", &pack, "--force"]);
        assert!(ran.stderr.contains(words), "no {words:?} in {}", ran.stderr);
        assert_eq!(json(&["info", &pack])["projection"], projection, "{said:?}");
    }
}

/// What a cut of 128 x 64 out of 256 x 128 cannot say as well, and words of the answer.
const NOT_MEANT: [((&str, &str), &[&str]); 11] = [
    (
        ("CroppedAreaImageHeightPixels", "96"),
        &["128 x 96", "128 x 64 pixels"],
    ),
    (
        ("CroppedAreaLeftPixels", "200"),
        &["CroppedAreaLeftPixels 200", "beyond", "256"],
    ),
    (
        ("CroppedAreaTopPixels", "-2"),
        &["CroppedAreaTopPixels -2", "beyond"],
    ),
    (
        ("CroppedAreaImageWidthPixels", "0"),
        &["CroppedAreaImageWidthPixels is 0"],
    ),
    (
        ("CroppedAreaImageWidthPixels", "300"),
        &["300", "beyond FullPanoWidthPixels 256"],
    ),
    (
        ("FullPanoWidthPixels", "wide"),
        &["FullPanoWidthPixels", "\"wide\"", "not a number"],
    ),
    (
        ("FullPanoWidthPixels", "inf"),
        &["FullPanoWidthPixels", "not a number"],
    ),
    (
        ("FullPanoHeightPixels", "4e9"),
        &["4000000000 pixels, more than"],
    ),
    (
        ("PoseHeadingDegrees", "361"),
        &["PoseHeadingDegrees is 361", "more than a turn"],
    ),
    (
        ("PoseHeadingDegrees", "NaN"),
        &["PoseHeadingDegrees", "not a number"],
    ),
    (
        ("PoseRollDegrees", ""),
        &["PoseRollDegrees", "not a number"],
    ),
];

#[test]
fn a_photo_sphere_that_cannot_be_meant_is_refused_with_what_to_do_and_taken_when_told() {
    let folder = Folder::new();
    let photo = Photo::of_waves([128, 64]);
    for (more, words) in NOT_MEANT {
        let tags = cropped([256, 128], [64, 32], [128, 64], &[more]);
        let file = photo.jpeg(&folder, "a.jpg", &tags);
        let pack = folder.name("a.foveal");
        let prepare = ["prepare", "video", &file, "--out", &pack, "--force"];
        let all = [&["a.jpg", "GPano", "--projection"], words].concat();
        refused(1, &prepare, &all);
        assert!(!folder.names().contains(&"a.foveal".to_owned()));
        for told in ["equirect", "flat"] {
            let ran = done(&[&prepare[..], &["--projection", told]].concat());
            assert!(!ran.stderr.contains("GPano"), "{}", ran.stderr);
        }
        std::fs::remove_file(&pack).unwrap();
    }
    let tags = Tags {
        xmp: gpano(&[
            ("ProjectionType", "equirectangular"),
            ("CroppedAreaLeftPixels", "3"),
        ]),
        ..Tags::default()
    };
    let file = photo.png(&folder, "a.png", &tags);
    let out = folder.name("a.foveal");
    refused(
        1,
        &["prepare", "video", &file, "--out", &out],
        &["CroppedAreaLeftPixels", "beyond"],
    );
}

#[test]
fn broken_tags_are_told_and_cost_no_picture() {
    let folder = Folder::new();
    let photo = Photo::of_waves([64, 48]);
    let whole = exif(6);
    let cut = |length: usize| Tags {
        exif: Some(whole[..length].to_vec()),
        ..Tags::default()
    };
    let mut good = gpano(&[("ProjectionType", "equirectangular")]).unwrap();
    good.truncate(good.len() - 60);
    let broken_xmp = Tags {
        xmp: Some(good),
        ..Tags::default()
    };
    let unknown = Tags {
        exif: Some(exif(77)),
        ..Tags::default()
    };
    for (tags, words) in [
        (cut(4), "EXIF"),
        (cut(12), "EXIF"),
        // The orientation is there, what follows it is not.
        (cut(30), "EXIF"),
        (unknown, "orientation is 77"),
        (broken_xmp, "XMP"),
    ] {
        for file in [
            photo.jpeg(&folder, "a.jpg", &tags),
            photo.png(&folder, "a.png", &tags),
        ] {
            let pack = folder.name("a.foveal");
            let ran = done(&["prepare", "video", &file, "--out", &pack, "--force"]);
            assert!(
                ran.stderr.contains(words),
                "{file}: no {words:?} in {}",
                ran.stderr
            );
            done(&["verify", &pack]);
        }
    }
    let pack = folder.name("a.foveal");
    let turned = photo.jpeg(&folder, "a.jpg", &cut(30));
    done(&["prepare", "video", &turned, "--out", &pack, "--force"]);
    let info = json(&["info", &pack]);
    assert_eq!([&info["width"], &info["height"]], [&json!(48), &json!(64)]);
}
