//! Are files of 360° cameras shown as what they are, or refused by name?

use super::film_file::Film;
use crate::scenes::{picture, waves, write_clip};
use crate::support::{Folder, done, json, refused};
use foveal_core::view::picture::Picture;

/// Two discs of waves over black.
fn fisheyes(size: [u32; 2], frames: u32) -> Vec<Picture> {
    let discs = |it: &Picture| {
        picture(size, |p, x, y| {
            let scale = if p == 0 { 1 } else { 2 };
            let [x, y] = [x, y].map(|k| f64::from(k * scale));
            let radius = f64::from(size[0]) / 4.0;
            let near = [1.0, 3.0]
                .iter()
                .any(|quarter| (x - quarter * radius).hypot(y - f64::from(size[1]) / 2.0) < radius);
            let at = (y as u32 / scale * (it.width / scale) + x as u32 / scale) as usize;
            match (near, p) {
                (true, _) => it.planes[p][at].max(60),
                (false, 0) => 16,
                (false, _) => 128,
            }
        })
    };
    waves(size, frames).iter().map(discs).collect()
}

fn refuse(folder: &Folder, file: &str, words: &[&str]) {
    let out = folder.name("raw.foveal");
    refused(1, &["prepare", "video", file, "--out", &out], words);
    assert!(!std::path::Path::new(&out).exists());
    let flat = ["--projection", "flat", "--fast", "--no-loss", "--force"];
    done(&[&["prepare", "video", file, "--out", &out][..], &flat].concat());
    std::fs::remove_file(&out).unwrap();
}

#[test]
fn raw_files_of_cameras_are_refused_by_name_with_what_converts_them() {
    let folder = Folder::new();
    let film = folder.name("GS010001.mp4");
    Film {
        size: [192, 64],
        frames: 2,
        ..Film::default()
    }
    .write(&film, |n, _, x, y| (n + x * y) as u8);
    let gopro = folder.name("GS010001.360");
    std::fs::rename(&film, &gopro).unwrap();
    refuse(&folder, &gopro, &["GoPro", "v360=eac"]);
    let two = fisheyes([128, 64], 1);
    let square = fisheyes([64, 64], 1);
    let jpeg = folder.name("IMG_1.jpg");
    let rgb = vec![90; 128 * 64 * 3];
    let encoder = jpeg_encoder::Encoder::new_file(&jpeg, 90).unwrap();
    encoder
        .encode(&rgb, 128, 64, jpeg_encoder::ColorType::Rgb)
        .unwrap();
    let bytes = std::fs::read(&jpeg).unwrap();
    let insp = folder.holding("IMG_20250101_00_001.INSP", &bytes);
    refuse(&folder, &insp, &["Insta360", "v360=dfisheye"]);
    // Renamed, it still ends as the camera wrote it.
    let trailer = [&bytes[..], b"8db42d694ccc418790edff439fe026bf"].concat();
    let renamed = folder.holding("pano_360.jpg", &trailer);
    refuse(&folder, &renamed, &["Insta360", "v360=dfisheye"]);
    for (name, pictures, words) in [
        ("VID_1_00_1.insv", &two, ["Insta360", "-vf v360=dfisheye"]),
        ("VID_2_00_1.insv", &square, ["Insta360", "hstack"]),
    ] {
        let clip = write_clip(&folder, "x.mkv", pictures);
        let film = folder.name(name);
        std::fs::rename(&clip, &film).unwrap();
        refuse(&folder, &film, &words);
    }
    // Other cameras give no name away; what they show does.
    let gear = write_clip(&folder, "360_0001.mkv", &fisheyes([256, 128], 1));
    refuse(&folder, &gear, &["two fisheyes", "v360=dfisheye"]);
    let theta = write_clip(&folder, "R0010001.mkv", &fisheyes([320, 180], 1));
    refuse(&folder, &theta, &["two fisheyes", "v360=dfisheye"]);
}

#[test]
fn a_name_is_believed_by_whole_words() {
    let folder = Folder::new();
    for (name, projection) in [
        ("atmosphere.mkv", "flat"),
        ("hispano-suiza.mkv", "flat"),
        ("my_pano.mkv", "cube"),
        ("Sphere-2.mkv", "cube"),
    ] {
        let clip = write_clip(&folder, name, &waves([128, 64], 1));
        let pack = folder.name("a.foveal");
        let prepare = [
            "prepare", "video", &clip, "--out", &pack, "--force", "--fast",
        ];
        done(&[&prepare[..], &["--no-loss"]].concat());
        assert_eq!(json(&["info", &pack])["projection"], projection, "{name}");
    }
}

fn boxed(name: &[u8; 4], contents: &[u8]) -> Vec<u8> {
    let length = (contents.len() as u32 + 8).to_be_bytes();
    [&length[..], name, contents].concat()
}

/// Puts a box into the description of the only track of an MP4 whose index comes last.
fn with_box(bytes: &[u8], added: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let mut at = bytes.windows(4).rposition(|it| it == b"moov").unwrap() - 4;
    let grow = |bytes: &mut Vec<u8>, at: usize| {
        let length = u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
        let longer = (length + added.len() as u32).to_be_bytes();
        bytes[at..at + 4].copy_from_slice(&longer);
        length as usize
    };
    grow(&mut bytes, at);
    for name in [b"trak", b"mdia", b"minf", b"stbl", b"stsd"] {
        let found = bytes[at + 8..]
            .windows(4)
            .position(|it| it == name)
            .unwrap();
        at += 8 + found - 4;
        grow(&mut bytes, at);
    }
    let entry = at + 16;
    let length = grow(&mut bytes, entry);
    let end = entry + length;
    bytes.splice(end..end, added.iter().copied());
    bytes
}

#[test]
fn a_part_of_a_sphere_lies_where_the_bounds_of_its_metadata_put_it() {
    let folder = Folder::new();
    let film = folder.name("part.mp4");
    Film {
        size: [96, 64],
        frames: 2,
        ..Film::default()
    }
    .write(&film, |_, p, _, _| [200, 128, 128][p]);
    let bytes = std::fs::read(&film).unwrap();
    // A quarter is missing at the top and the bottom, a quarter at the left and the right.
    for (bounds, covered, front) in [
        ([1u32 << 30; 4], "180° x 90°", 0.0),
        ([0, 1 << 31, 0, 0], "360° x 90°", 0.0),
        ([0, 0, 1 << 30, 0], "270° x 180°", 45.0),
    ] {
        let numbers: Vec<u8> = bounds.iter().flat_map(|it| it.to_be_bytes()).collect();
        let equi = boxed(b"equi", &[&[0; 4][..], &numbers].concat());
        let prhd = boxed(b"prhd", &[0; 16]);
        let proj = boxed(b"proj", &[prhd, equi].concat());
        let sv3d = boxed(b"sv3d", &[boxed(b"svhd", &[0; 5]), proj].concat());
        let part = folder.holding("bounds.mp4", &with_box(&bytes, &sv3d));
        let pack = folder.name("part.foveal");
        let prepare = [
            "prepare", "video", &part, "--out", &pack, "--force", "--fast",
        ];
        let told = json(&[&prepare[..], &["--no-loss"]].concat());
        let said = told["remarks"].to_string();
        assert!(said.contains(covered), "{bounds:?}: {said}");
        assert_eq!(told["projection"], "cube");
        assert!(
            (told["front_deg"].as_f64().unwrap() - front).abs() < 2.0,
            "{told}"
        );
    }
}
