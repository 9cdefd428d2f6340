//! Does each eye get its own picture, and the dark where a panorama has no face?

use crate::scenes::{noise, write_clip};
use crate::support::{Folder, Rgb, done, frame_picture, json, refused};
use foveal_core::view::picture::Picture;
use serde_json::json;

const FRAMES: u32 = 2;

/// Different noise for each of several clips.
fn parts(size: [u32; 2], count: u32) -> Vec<Vec<Picture>> {
    let part = |part: u32| (0..FRAMES).map(|f| noise(size, part * 100 + f)).collect();
    (0..count).map(part).collect()
}

/// Pictures next to each other.
fn beside(parts: &[Picture]) -> Picture {
    let planes = [0, 1, 2].map(|p| {
        let [width, rows] = parts[0].plane_size(p).map(|side| side as usize);
        let line = |y: usize| {
            let of = move |part: &Picture| part.planes[p][y * width..][..width].to_vec();
            parts.iter().flat_map(of).collect::<Vec<u8>>()
        };
        (0..rows).flat_map(line).collect()
    });
    Picture {
        width: parts[0].width * parts.len() as u32,
        height: parts[0].height,
        planes,
    }
}

fn all_beside(parts: &[Vec<Picture>]) -> Vec<Picture> {
    let frame = |f: usize| beside(&parts.iter().map(|part| part[f].clone()).collect::<Vec<_>>());
    (0..FRAMES as usize).map(frame).collect()
}

/// Prepares a clip and plays it; returns the folder of pictures.
fn shown(folder: &Folder, clip: &str, how: &[&str], play: &[&str]) -> String {
    let name = std::path::Path::new(clip)
        .file_stem()
        .unwrap()
        .to_str()
        .unwrap();
    let pack = folder.name(&format!("{name}.foveal"));
    let cut = ["--tile", "32", "--levels", "3", "--quality", "8"];
    done(&[&["prepare", "video", clip, "--out", &pack], how, &cut[..]].concat());
    done(&["verify", &pack]);
    let out = folder.name(&format!("{name}-{}", play.last().unwrap()));
    let view = ["--gaze", "20,10", "--view", "120x80", "--out", &out];
    done(&[&["simulate", &pack], play, &view[..]].concat());
    out
}

fn left_and_right(both: &Rgb) -> [Rgb; 2] {
    let [w, h] = [both.size[0] / 2, both.size[1]];
    [0, w].map(|from| {
        let place = |at: u32| both.at([from + at % w, at / w]);
        Rgb {
            size: [w, h],
            pixels: (0..w * h).flat_map(place).collect(),
        }
    })
}

#[test]
fn each_eye_is_shown_what_its_half_alone_shows() {
    for (projection, packed, size) in [
        ("flat", "cube", [96, 64]),
        ("equirect", "cube", [256, 128]),
        ("half-equirect", "cube", [128, 128]),
        ("equirect", "equirect", [256, 128]),
        ("half-equirect", "equirect", [128, 128]),
    ] {
        let folder = Folder::new();
        let eyes = parts(size, 2);
        let both = write_clip(&folder, "pair_LR.mkv", &all_beside(&eyes));
        // What is bought for two eyes together may be more than one of them asks for alone.
        let policy = match packed {
            "equirect" => "viewport",
            _ => "perceptual",
        };
        let how = ["--projection", projection, "--pack-projection", packed];
        let out = shown(&folder, &both, &how, &["--policy", policy, "--eye", "both"]);
        let info = json(&["info", &folder.name("pair_LR.foveal")]);
        assert_eq!(info["eyes"], json!(2), "{info}");
        for (name, (eye, seen)) in ["l.mkv", "r.mkv"]
            .into_iter()
            .zip(eyes.iter().zip(left_and_right(&frame_picture(&out, 1))))
        {
            let alone = write_clip(&folder, name, eye);
            let alone = shown(
                &folder,
                &alone,
                &how,
                &["--policy", policy, "--eye", "right"],
            );
            assert_eq!(
                frame_picture(&alone, 1).difference(&seen),
                0,
                "{projection} {packed} {name}"
            );
        }
    }
}

#[test]
fn four_faces_are_a_panorama_that_is_black_above() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "market_cube.mkv", &all_beside(&parts([64, 64], 4)));
    let out = shown(&folder, &clip, &[], &["--fov", "140"]);
    let info = json(&["info", &folder.name("market_cube.foveal")]);
    assert_eq!(
        [&info["projection"], &info["faces"]],
        [&json!("cube"), &json!(4)]
    );
    let picture = frame_picture(&out, 0);
    assert_eq!(picture.at([60, 0]), [0, 0, 0]);
    assert_ne!(picture.at([60, 40]), [0, 0, 0]);
}

#[test]
fn frames_that_hold_no_two_eyes_or_no_cube_are_refused() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "odd.mkv", &parts([66, 50], 1)[0]);
    let prepare = ["prepare", "video", &clip, "--out", "never.foveal"];
    refused(
        1,
        &[&prepare[..], &["--stereo", "sbs"]].concat(),
        &["two equal eyes", "ffmpeg -i"],
    );
    refused(
        1,
        &[&prepare[..], &["--projection", "cube"]].concat(),
        &["66x50", "3x2"],
    );
}
