//! Do pictures of odd sizes keep their last column and row?

use crate::scenes::{picture, write_clip};
use crate::support::{Folder, Rgb, done, frame_picture, json};
use foveal_core::view::picture::Picture;

const SIZE: [u32; 2] = [101, 67];

/// Dark, but for a bright last column and a bright last row.
fn framed() -> Picture {
    picture(SIZE, |plane, x, y| match plane {
        0 if x == SIZE[0] - 1 || y == SIZE[1] - 1 => 220,
        0 => 40,
        _ => 128,
    })
}

/// Whether the last column and row are bright, and the ones before are not.
fn is_framed(shown: &Rgb) -> bool {
    let [width, height] = SIZE;
    let bright = |x: u32, y: u32| shown.at([x, y])[1] > 150;
    let columns = (2..width - 4).all(|x| bright(x, height - 1) && !bright(x, height - 3));
    let rows = (2..height - 4).all(|y| bright(width - 1, y) && !bright(width - 3, y));
    shown.size == SIZE && columns && rows && bright(width - 1, height - 1)
}

#[test]
fn every_codec_and_cut_keeps_the_last_column_and_row_of_an_odd_picture() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "odd.mkv", &[framed(), framed()]);
    let ways: [&[&str]; 6] = [
        &[],
        &["--codec", "h264"],
        &["--codec", "hevc", "--tile", "64"],
        &["--codec", "jpeg", "--quality", "q95"],
        &["--codec", "png", "--grid", "3x2"],
        &["--preset", "kastner-2016", "--codec", "png"],
    ];
    for (number, way) in ways.into_iter().enumerate() {
        let pack = folder.name(&format!("{number}.foveal"));
        let flat = ["--projection", "flat", "--fast", "--out", &pack];
        done(&[&["prepare", "video", &clip], &flat[..], way].concat());
        let info = json(&["info", &pack]);
        assert_eq!((&info["width"], &info["height"]), (&101.into(), &67.into()));
        let out = folder.name(&format!("out-{number}"));
        let how = ["--policy", "full", "--renderer", "cpu", "--out", &out];
        done(&[&["simulate", &pack], &how[..]].concat());
        assert!(is_framed(&frame_picture(&out, 1)), "{way:?}");
    }
}
