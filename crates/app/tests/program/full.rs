//! Does the `full` policy show the source itself?

use crate::scenes::{noise, picture, write_clip};
use crate::support::{Folder, Rgb, done, frame_picture};
use foveal_core::view::picture::{Colour, Picture};
use foveal_media::{ClipCodec, ClipFormat, ClipWriter, VideoInput};
use std::path::Path;

/// Largest difference of a channel in 255ths: two roundings, and the 8-bit weights of a software
/// driver.
const ROUNDING: u8 = 2;

/// Red, green and blue of a place by the definition of the matrix and the range.
fn rgb(yuv: [f64; 3], colour: Colour) -> [f64; 3] {
    let [kr, kb] = colour.matrix.luma_weights().map(f64::from);
    let [black, luma, chroma] = if colour.full_range {
        [0.0, 255.0, 255.0]
    } else {
        [16.0, 219.0, 224.0]
    };
    let y = (yuv[0] - black) / luma;
    let [u, v] = [yuv[1], yuv[2]].map(|code| (code - 128.0) / chroma);
    let red = y + 2.0 * (1.0 - kr) * v;
    let blue = y + 2.0 * (1.0 - kb) * u;
    let green = (y - kr * red - kb * blue) / (1.0 - kr - kb);
    [red, green, blue].map(|c| c.clamp(0.0, 1.0) * 255.0)
}

/// The chroma sample before a pixel on one axis, the one after it, and the weight of the latter.
///
/// Samples of 4:2:0 lie in the middle of the pixels that they cover, or, on the left, in the middle
/// of the first; beyond the outermost the outermost repeats.
fn chroma_taps(at: u32, size: u32, left: bool) -> (usize, usize, f64) {
    let count = size.div_ceil(2);
    let centre = |sample: u32| {
        let covered = f64::from((size - 2 * sample).min(2));
        let offset = if left { 0.5 } else { 1.0 };
        f64::from(2 * sample) + f64::min(offset, covered / 2.0)
    };
    let place = f64::from(at) + 0.5;
    let after = (0..count).find(|sample| centre(*sample) > place);
    match after {
        Some(0) => (0, 0, 0.0),
        None => ((count - 1) as usize, (count - 1) as usize, 0.0),
        Some(high) => {
            let weight = (place - centre(high - 1)) / (centre(high) - centre(high - 1));
            (high as usize - 1, high as usize, weight)
        }
    }
}

/// The picture converted pixel by pixel, with bilinear chroma.
fn converted(source: &Picture, colour: Colour, [x, y]: [u32; 2]) -> [f64; 3] {
    let luma = source.planes[0][(y * source.width + x) as usize];
    let (left, right, across) = chroma_taps(x, source.width, colour.chroma_left);
    let (up, down, along) = chroma_taps(y, source.height, false);
    let columns = source.plane_size(1)[0] as usize;
    let chroma = |p: usize| {
        let at = |row: usize, column: usize| f64::from(source.planes[p][row * columns + column]);
        let mix = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
        let upper = mix(at(up, left), at(up, right), across);
        mix(upper, mix(at(down, left), at(down, right), across), along)
    };
    rgb([f64::from(luma), chroma(1), chroma(2)], colour)
}

/// Prepares a file with PNG tiles, shows it with every finest tile, and compares every picture with
/// the source, for both renderers.
fn assert_shows_the_source(folder: &Folder, file: &str, cut: &[&str]) {
    let pack = folder.name("full.foveal");
    let flat = ["--codec", "png", "--projection", "flat"];
    done(&[&["prepare", "video", file, "--out", &pack], &flat[..], cut].concat());
    for renderer in ["gpu", "cpu"] {
        let out = folder.name(renderer);
        let how = ["--policy", "full", "--renderer", renderer];
        done(&[&["simulate", &pack, "--out", &out], &how[..]].concat());
        let mut input = VideoInput::open(Path::new(file)).unwrap();
        let colour = input.info().colour;
        let mut frame = 0;
        while let Some(source) = input.next_frame().unwrap() {
            let shown = frame_picture(&out, frame);
            assert_alike(&shown, &source.picture, colour);
            frame += 1;
        }
    }
}

fn assert_alike(shown: &Rgb, source: &Picture, colour: Colour) {
    assert_eq!(shown.size, [source.width, source.height]);
    for place in shown.places() {
        let expected = converted(source, colour, place);
        for (found, expected) in shown.at(place).into_iter().zip(expected) {
            let off = (f64::from(found) - expected).abs();
            assert!(
                off <= f64::from(ROUNDING),
                "{place:?} of {:?}: {:?}, expected {expected:.1}",
                shown.size,
                shown.at(place)
            );
        }
    }
}

#[test]
fn the_full_policy_shows_the_source_of_any_size() {
    for size in [[160, 96], [131, 77], [129, 128], [65, 1], [2, 3], [1, 1]] {
        let folder = Folder::new();
        let clip = write_clip(&folder, "a.mkv", &[noise(size, 0), noise(size, 1)]);
        assert_shows_the_source(&folder, &clip, &["--tile", "32"]);
    }
}

#[test]
fn the_full_policy_shows_the_source_through_a_grid() {
    for (size, grid) in [([160, 96], "4x3"), ([131, 77], "3x2")] {
        let folder = Folder::new();
        let clip = write_clip(&folder, "a.mkv", &[noise(size, 0)]);
        let cut = ["--grid", grid, "--levels", "3", "--level-ratio", "4"];
        assert_shows_the_source(&folder, &clip, &cut);
    }
}

#[test]
fn a_grey_source_is_shown_as_its_luma_alone() {
    let folder = Folder::new();
    let grey = picture([101, 67], |p, x, y| match p {
        0 => 16 + ((x * 7 + y * 13) % 220) as u8,
        _ => 128,
    });
    let clip = write_clip(&folder, "a.mkv", std::slice::from_ref(&grey));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&[
        "prepare", "video", &clip, "--out", &pack, "--codec", "png", "--tile", "32",
    ]);
    done(&["simulate", &pack, "--out", &out, "--policy", "full"]);
    let shown = frame_picture(&out, 0);
    for [x, y] in shown.places() {
        let luma = f64::from(grey.planes[0][(y * 101 + x) as usize]);
        let expected = (luma - 16.0) / 219.0 * 255.0;
        for found in shown.at([x, y]) {
            assert!(
                (f64::from(found) - expected).abs() <= 1.0,
                "{x},{y}: {found}"
            );
        }
    }
}

#[test]
fn full_range_with_chroma_between_the_pixels_is_shown_as_it_is() {
    let folder = Folder::new();
    let path = folder.name("a.mov");
    let format = ClipFormat {
        codec: ClipCodec::Mjpeg(2),
        size: [90, 61],
        frame_rate: [25, 1],
        colour: Colour {
            full_range: true,
            chroma_left: false,
            ..crate::scenes::VIDEO
        },
    };
    let mut clip = ClipWriter::create(Path::new(&path), &format).unwrap();
    clip.push(&noise([90, 61], 0)).unwrap();
    clip.finish().unwrap();
    let info = VideoInput::open(Path::new(&path)).unwrap().info().clone();
    assert!(info.colour.full_range && !info.colour.chroma_left);
    assert_shows_the_source(&folder, &path, &["--tile", "32"]);
}
