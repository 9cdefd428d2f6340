//! Are pictures shown right whose files or kinds other programs stumble over?

use super::film_file::coded;
use super::stills;
use crate::support::{Folder, Rgb, refused};
use ffmpeg_next::format::Pixel;
use image_webp::{ColorType, WebPEncoder};
use serde_json::Value;
use std::slice::from_ref;

/// What is reported of a picture, and what is seen of it.
pub(super) fn seen(folder: &Folder, file: &str, view: &str) -> (Value, Rgb) {
    let (told, shown, _) = stills::seen(folder, file, view);
    (told, shown)
}

pub(super) fn remarks(told: &Value) -> String {
    told["remarks"].to_string()
}

pub(super) fn refuses(folder: &Folder, name: &str, bytes: &[u8], words: &[&str]) {
    let file = folder.holding(name, bytes);
    let out = folder.name("never.foveal");
    refused(1, &["prepare", "video", &file, "--out", &out], words);
}

/// Red, green, blue and yellow quarters.
pub(super) fn quarters(side: u32) -> Vec<u8> {
    let colours = [[250, 0, 0], [0, 250, 0], [0, 0, 250], [250, 250, 0]];
    let of = |x: u32, y: u32| colours[usize::from(x >= side / 2) + 2 * usize::from(y >= side / 2)];
    (0..side)
        .flat_map(|y| (0..side).flat_map(move |x| of(x, y)))
        .collect()
}

pub(super) fn assert_quarters(shown: &Rgb, of: &str) {
    let [w, h] = shown.size;
    for ([x, y], lit) in [
        ([1, 1], [true, false, false]),
        ([3, 1], [false, true, false]),
        ([1, 3], [false, false, true]),
        ([3, 3], [true, true, false]),
    ] {
        let found = shown.at([w * x / 4, h * y / 4]);
        assert_eq!(found.map(|it| it > 128), lit, "{of}: {x} {y} {found:?}");
    }
}

fn assert_grey(shown: &Rgb, code: u8, of: &str) {
    let found = shown.at([shown.size[0] / 2, shown.size[1] / 2]);
    assert!(
        found.iter().all(|it| it.abs_diff(code) < 4),
        "{of}: {found:?}"
    );
}

/// An entry of a TIFF: tag, kind (3 of two bytes, 4 of four), values.
type Entry = (u16, u16, Vec<u32>);

/// A TIFF of one strip, or of tiles where its entries say so; `is_big` in BigTIFF.
fn tiff(entries: &[Entry], parts: &[Vec<u8>], is_big: bool) -> Vec<u8> {
    let is_tiled = entries.iter().any(|it| it.0 == 322);
    let [places, lengths] = if is_tiled { [324, 325] } else { [273, 279] };
    let mut all = entries.to_vec();
    let begin = if is_big { 16 } else { 8 };
    let mut at = begin;
    let begins = parts.iter().map(|it| {
        at += it.len() as u32;
        at - it.len() as u32
    });
    all.push((places, 4, begins.collect()));
    all.push((lengths, 4, parts.iter().map(|it| it.len() as u32).collect()));
    all.sort_by_key(|it| it.0);
    let data = parts.concat();
    let of = |kind: u16, value: u32| match kind {
        3 => value.to_le_bytes()[..2].to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    let wide = if is_big { 8 } else { 4 };
    let number = |value: u64| value.to_le_bytes()[..wide].to_vec();
    let directory = u64::from(begin) + data.len() as u64;
    let mut bytes = match is_big {
        true => [&b"II\x2b\0\x08\0\0\0"[..], &number(directory)].concat(),
        false => [&b"II\x2a\0"[..], &number(directory)].concat(),
    };
    bytes.extend(data);
    let count = if is_big { 8 } else { 2 };
    bytes.extend(&(all.len() as u64).to_le_bytes()[..count]);
    let mut behind = directory + (count + all.len() * (4 + 2 * wide) + wide) as u64;
    let mut far = Vec::new();
    for (tag, kind, values) in &all {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(number(values.len() as u64));
        let mut own: Vec<u8> = values.iter().flat_map(|it| of(*kind, *it)).collect();
        if own.len() > wide {
            bytes.extend(number(behind));
            behind += own.len() as u64;
            far.extend(own);
        } else {
            own.resize(wide, 0);
            bytes.extend(own);
        }
    }
    bytes.extend(number(0));
    bytes.extend(far);
    bytes
}

fn entries(side: u32, samples: u32, more: &[(u16, u32)]) -> Vec<Entry> {
    let bits = vec![8; samples as usize];
    let mut all = vec![
        (256, 4, vec![side]),
        (257, 4, vec![side]),
        (258, 3, bits),
        (262, 3, vec![if samples == 1 { 1 } else { 2 }]),
        (277, 3, vec![samples]),
        (278, 4, vec![side]),
    ];
    for (tag, value) in more {
        all.retain(|it| it.0 != *tag);
        all.push((*tag, 3, vec![*value]));
    }
    all
}

fn jpeg(side: u32) -> Vec<u8> {
    let grey = |p: usize, x: u32, y: u32| match p {
        0 => [220, 150, 90, 40][usize::from(x >= side / 2) + 2 * usize::from(y >= side / 2)],
        _ => 128,
    };
    coded("mjpeg", (Pixel::YUVJ420P, [side, side]), grey)
}

#[test]
fn a_tiff_that_ffmpeg_draws_black_or_refuses_is_shown_right() {
    let folder = Folder::new();
    let rgb = quarters(32);
    // Tiles of 16 x 16: each is a quarter of the picture.
    let tile = |k: usize| quarters(4)[3 * [0, 2, 8, 10][k]..][..3].repeat(256);
    let tiles = [0, 1, 2, 3].map(tile);
    let sides = [(322, 16), (323, 16)];
    let float = |code: u8| (f32::from(code) / 250.0).to_le_bytes();
    let floats: Vec<u8> = rgb.iter().flat_map(|code| float(*code)).collect();
    let of_floats: Vec<Entry> = {
        let mut all = entries(32, 3, &[]);
        all.retain(|it| it.0 != 258);
        all.push((258, 3, vec![32; 3]));
        all.push((339, 3, vec![3; 3]));
        all
    };
    let inverse: Vec<u8> = rgb
        .chunks(3)
        .flat_map(|it| [255 - it[0], 255 - it[1], 255 - it[2], 0])
        .collect();
    let big_ink = entries(32, 4, &[(262, 5)]);
    let alpha: Vec<u8> = rgb
        .chunks(3)
        .flat_map(|it| [it[0], it[1], it[2], 255])
        .collect();
    for (name, file) in [
        ("big", tiff(&entries(32, 3, &[]), from_ref(&rgb), true)),
        ("tiles", tiff(&entries(32, 3, &sides), &tiles, false)),
        ("big tiles", tiff(&entries(32, 3, &sides), &tiles, true)),
        ("floats", tiff(&of_floats, &[floats], false)),
        ("ink", tiff(&big_ink, &[inverse], true)),
        (
            "multiplied",
            tiff(&entries(32, 4, &[(338, 1)]), &[alpha], false),
        ),
        ("plain", tiff(&entries(32, 3, &[]), from_ref(&rgb), false)),
    ] {
        let (told, shown) = seen(&folder, &folder.holding("a.tif", &file), "32x32");
        assert_quarters(&shown, name);
        assert_eq!(
            remarks(&told).contains("linear"),
            name == "floats",
            "{told}"
        );
    }
    // JPEG in a TIFF: luma and chroma, of a strip and of tiles, each a whole JPEG.
    let ycc = [(259, 7), (262, 6)];
    for (name, more, parts) in [
        ("strip", &ycc[..], vec![jpeg(32)]),
        (
            "tile",
            &[ycc[0], ycc[1], (322, 32), (323, 32)],
            vec![jpeg(32)],
        ),
    ] {
        let file = tiff(&entries(32, 3, more), &parts, false);
        let (_, shown) = seen(&folder, &folder.holding("a.tif", &file), "32x32");
        let found = [[8, 8], [24, 8], [8, 24], [24, 24]].map(|at| shown.at(at)[1]);
        assert!(
            found
                .into_iter()
                .zip([220, 150, 90, 40])
                .all(|(it, code)| it.abs_diff(code) < 12),
            "{name}: {found:?}"
        );
    }
}

#[test]
fn a_tiff_of_a_kind_that_nothing_here_reads_is_named_with_what_converts_it() {
    let folder = Folder::new();
    let with = |more: &[(u16, u32)]| tiff(&entries(32, 3, more), &[quarters(32)], false);
    for (more, word) in [
        (&[(259, 50_000)][..], "ZSTD"),
        (&[(259, 6)], "old style"),
        (&[(259, 34_887)], "LERC"),
        (&[(262, 8)], "L*a*b*"),
    ] {
        refuses(&folder, "a.tif", &with(more), &[word, "magick"]);
    }
    let heights: Vec<u8> = (0..32 * 32)
        .flat_map(|k| (k as f32).to_le_bytes())
        .collect();
    let mut of_floats = entries(32, 1, &[(339, 3)]);
    of_floats.retain(|it| it.0 != 258);
    of_floats.push((258, 3, vec![32]));
    let heights = tiff(&of_floats, &[heights], false);
    refuses(
        &folder,
        "a.tif",
        &heights,
        &["from 0 to 1023", "gdal_translate", "-scale"],
    );
    let whole = with(&[]);
    refuses(&folder, "a.tif", &whole[..40], &["cut short"]);
    // Of two pages the first is shown, and that is said.
    let mut pages = whole.clone();
    let end = pages.len() - 6 - 4;
    let second = tiff(&entries(32, 3, &[]), &[quarters(32)], false);
    let directory = u32::from_le_bytes(*second[4..].first_chunk().unwrap()) as usize;
    pages[end..end + 4].copy_from_slice(&(whole.len() as u32).to_le_bytes());
    pages.extend(&second[directory..]);
    let (told, shown) = seen(&folder, &folder.holding("a.tif", &pages), "32x32");
    assert_quarters(&shown, "pages");
    assert!(remarks(&told).contains("first of 2 pages"), "{told}");
}

/// A PNG of one grey, with a chunk before its data.
fn grey_png(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 32, 32);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    for (name, inside) in chunks {
        writer
            .write_chunk(png::chunk::ChunkType(**name), inside)
            .unwrap();
    }
    writer.write_image_data(&[128; 32 * 32 * 3]).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn samples_that_count_light_are_shown_as_bright_as_they_are_meant() {
    let folder = Folder::new();
    let hdr = |mantissa: u8, exponent: u8| {
        let head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32 +X 32\n";
        let pixel = [mantissa, mantissa, mantissa, exponent];
        [&head[..], &pixel.repeat(32 * 32)].concat()
    };
    let floats = [0.5f32.to_le_bytes(); 32 * 32 * 3].concat();
    let pfm = [&b"PF\n32 32\n-1.0\n"[..], &floats].concat();
    let [linear, mac, usual] = [100_000u32, 55_556, 45_455].map(u32::to_be_bytes);
    for (name, file, code, word) in [
        ("a.hdr", hdr(128, 128), 188, "linear"),
        (
            "bright.hdr",
            hdr(128, 150),
            255,
            "100.0 % of its pixels are brighter",
        ),
        ("a.pfm", pfm, 188, "linear"),
        ("linear.png", grey_png(&[(b"gAMA", &linear)]), 188, "linear"),
        ("mac.png", grey_png(&[(b"gAMA", &mac)]), 147, "gAMA"),
        ("usual.png", grey_png(&[(b"gAMA", &usual)]), 128, ""),
        (
            "srgb.png",
            grey_png(&[(b"gAMA", &linear), (b"sRGB", &[0])]),
            128,
            "",
        ),
        (
            "cicp.png",
            grey_png(&[(b"cICP", &[1, 8, 0, 1])]),
            188,
            "linear",
        ),
        (
            "pq.png",
            grey_png(&[(b"cICP", &[9, 16, 0, 1])]),
            128,
            "high dynamic range",
        ),
        (
            "hlg.png",
            grey_png(&[(b"cICP", &[9, 18, 0, 1])]),
            128,
            "high dynamic range",
        ),
    ] {
        let (told, shown) = seen(&folder, &folder.holding(name, &file), "32x32");
        assert_grey(&shown, code, name);
        assert!(remarks(&told).contains(word), "{name}: {told}");
        let is_converted = remarks(&told).contains("converted to sRGB");
        assert_eq!(is_converted, code != 128, "{told}");
    }
    let upwards: Vec<u8> = quarters(32)
        .chunks(3 * 32)
        .rev()
        .flatten()
        .flat_map(|code| (f32::from(*code) / 255.0).to_le_bytes())
        .collect();
    let upwards = [&b"PF\n32 32\n-1.0\n"[..], &upwards].concat();
    let (_, shown) = seen(&folder, &folder.holding("quarters.pfm", &upwards), "32x32");
    assert_quarters(&shown, "pfm");
    refuses(
        &folder,
        "cut.hdr",
        &hdr(128, 128)[..300],
        &["ends within the picture"],
    );
}

#[test]
fn what_lies_behind_a_png_or_a_wrong_length_of_a_webp_costs_nothing() {
    let folder = Folder::new();
    let behind = [grey_png(&[]), vec![7; 5000]].concat();
    let (told, shown) = seen(&folder, &folder.holding("a.png", &behind), "32x32");
    assert_grey(&shown, 128, "behind");
    assert_eq!(told["repairs"], serde_json::json!({}), "{told}");
    let mut webp = Vec::new();
    WebPEncoder::new(&mut webp)
        .encode(&quarters(32), 32, 32, ColorType::Rgb8)
        .unwrap();
    for told_length in [webp.len() as u32 + 92, u32::MAX, 9] {
        let mut wrong = webp.clone();
        wrong[4..8].copy_from_slice(&told_length.to_le_bytes());
        let (told, shown) = seen(&folder, &folder.holding("a.webp", &wrong), "32x32");
        assert_quarters(&shown, &told_length.to_string());
        assert_eq!(
            told["repairs"]["broken_tags"].is_number(),
            told_length != 9,
            "{told}"
        );
    }
    let cut = &webp[..webp.len() - 20];
    refuses(&folder, "cut.webp", cut, &["cut.webp"]);
}

/// A GIF of pictures of one colour each, at their places on a screen.
fn gif(screen: [u16; 2], pictures: &[([u16; 4], bool)]) -> Vec<u8> {
    let mut bytes = b"GIF89a".to_vec();
    bytes.extend(screen.iter().flat_map(|side| side.to_le_bytes()));
    bytes.extend(b"\x80\0\0\0\0\0\xff\xff\xff");
    for (place, is_white) in pictures {
        bytes.extend(b"\x21\xf9\x04\x04\x14\0\0\0\x2c");
        bytes.extend(place.iter().flat_map(|side| side.to_le_bytes()));
        bytes.extend(b"\0\x02");
        let mut bits = Vec::new();
        for _ in 0..place[2] * place[3] {
            // A clear, then the pixel by itself, of three bits each.
            bits.extend([0, 0, 1, u8::from(*is_white), 0, 0]);
        }
        bits.extend([1, 0, 1]);
        let byte = |eight: &[u8]| (0..).zip(eight).fold(0, |sum, (at, bit)| sum | bit << at);
        let packed: Vec<u8> = bits.chunks(8).map(byte).collect();
        for block in packed.chunks(255) {
            bytes.push(block.len() as u8);
            bytes.extend(block);
        }
        bytes.push(0);
    }
    bytes.push(0x3b);
    bytes
}

#[test]
fn a_gif_shows_all_of_its_pictures_whatever_screen_it_gives() {
    let folder = Folder::new();
    for (screen, told_of) in [
        ([32, 32], false),
        ([16, 16], true),
        ([0, 0], true),
        ([8, 40], true),
    ] {
        let file = gif(screen, &[([0, 0, 32, 32], true), ([24, 24, 8, 8], false)]);
        let (told, shown) = seen(&folder, &folder.holding("a.gif", &file), "32x32");
        let right = [32, 32.max(u32::from(screen[1]))];
        assert_eq!([&told["width"], &told["height"]], right, "{told}");
        assert_eq!(
            remarks(&told).contains("does not hold its pictures"),
            told_of,
            "{told}"
        );
        assert!(shown.at([20, 16])[1] > 240, "{screen:?}");
        // Two pictures of 0.2 s each.
        assert_eq!(
            (&told["frames"], &told["fps"]),
            (&2.into(), &5.0.into()),
            "{told}"
        );
    }
}

#[test]
fn an_icon_shows_its_largest_picture() {
    let folder = Folder::new();
    let picture = |side: u32, grey: u8| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, side, side);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        writer
            .write_image_data(&[grey].repeat(3 * (side * side) as usize))
            .unwrap();
        writer.finish().unwrap();
        bytes
    };
    let pictures = [
        (16u8, picture(16, 40)),
        (64, picture(64, 200)),
        (32, picture(32, 90)),
    ];
    let mut icon = vec![0, 0, 1, 0, 3, 0];
    let mut at = 6 + 16 * 3;
    for (side, bytes) in &pictures {
        icon.extend([*side, *side, 0, 0, 1, 0, 24, 0]);
        icon.extend((bytes.len() as u32).to_le_bytes());
        icon.extend((at as u32).to_le_bytes());
        at += bytes.len();
    }
    icon.extend(pictures.iter().flat_map(|it| it.1.clone()));
    let (told, shown) = seen(&folder, &folder.holding("a.ico", &icon), "64x64");
    assert_eq!([&told["width"], &told["height"]], [64, 64], "{told}");
    assert_grey(&shown, 200, "icon");
    assert!(remarks(&told).contains("largest of its 3"), "{told}");
    assert!(!remarks(&told).contains("sound"), "{told}");
}

#[test]
fn files_that_are_no_pictures_are_named_with_what_to_do() {
    let folder = Folder::new();
    for (name, bytes, words) in [
        (
            "a.pdf",
            &b"%PDF-1.4\n1 0 obj\n<<>>\nendobj\n"[..],
            ["PDF", "pdftoppm"],
        ),
        (
            "a.png",
            b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\n",
            ["Git LFS", "git lfs pull"],
        ),
        (
            "b.png",
            b"<!DOCTYPE html>\n<html><body>not found</body></html>\n",
            ["HTML", "download"],
        ),
        (
            "a.mp4",
            b"PK\x03\x04aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
            ["ZIP", "unpack"],
        ),
    ] {
        refuses(&folder, name, bytes, &words);
    }
}

/// A TIFF whose first page is the one of `small`, and whose second is that of `whole`; of both the
/// data begin alike.
fn behind_one_another(small: &[u8], whole: &[u8]) -> Vec<u8> {
    let word = |bytes: &[u8], at: usize| u32::from_le_bytes(*bytes[at..].first_chunk().unwrap());
    let mut own = small[word(small, 4) as usize..].to_vec();
    let count = usize::from(u16::from_le_bytes([own[0], own[1]]));
    let end = 2 + 12 * count;
    own[end..end + 4].copy_from_slice(&whole[4..8]);
    // Its bits stand behind it.
    let bits = (0..count)
        .map(|k| 2 + 12 * k)
        .find(|at| own[*at..*at + 2] == [2, 1]);
    let far = (whole.len() + end + 4) as u32;
    own[bits.unwrap() + 8..][..4].copy_from_slice(&far.to_le_bytes());
    let mut bytes = [whole, &own].concat();
    bytes[4..8].copy_from_slice(&(whole.len() as u32).to_le_bytes());
    bytes
}

#[test]
fn stills_that_hold_other_than_they_say_are_shown_as_meant_and_told() {
    let folder = Folder::new();
    let told = |name: &str, bytes: &[u8]| seen(&folder, &folder.holding(name, bytes), "32x32");
    // A palette of two colours, and pixels of a third.
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 32, 32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(vec![250, 0, 0, 0, 250, 0]);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&[[0; 16], [9; 16]].concat().repeat(32))
        .unwrap();
    drop(writer);
    let (about, shown) = told("a.png", &png);
    assert!(shown.at([8, 16])[0] > 200 && shown.at([24, 16])[0] < 20);
    assert!(
        remarks(&about).contains("512 pixels of it name colours"),
        "{about}"
    );
    let mut webp = Vec::new();
    let encoder = WebPEncoder::new(&mut webp);
    encoder
        .encode(&quarters(32), 32, 32, ColorType::Rgb8)
        .unwrap();
    let canvas = [&b"VP8X\x0a\0\0\0\0\0\0\0\x7f\0\0\x7f\0\0"[..], &webp[12..]].concat();
    let length = (canvas.len() as u32 + 4).to_le_bytes();
    let (about, shown) = told("a.webp", &[b"RIFF", &length[..], b"WEBP", &canvas].concat());
    assert_quarters(&shown, "canvas");
    assert!(
        remarks(&about).contains("128x128 pixels, and its picture is 32x32"),
        "{about}"
    );
    let jpeg = jpeg(32);
    let (about, _) = told("a.jpg", &jpeg[..jpeg.len() - 2]);
    assert_eq!(about["repairs"], serde_json::json!({}), "{about}");
    // A small picture of the whole comes first.
    let whole = tiff(&entries(32, 3, &[]), &[quarters(32)], false);
    let small = tiff(&entries(8, 3, &[(254, 1)]), &[vec![9; 192]], false);
    let (about, shown) = told("a.tif", &behind_one_another(&small, &whole));
    assert_quarters(&shown, "page");
    assert!(
        remarks(&about).contains("smaller one of another, which is shown"),
        "{about}"
    );
    assert!(remarks(&about).contains("rgb24"), "{about}");
    // Where no picture lies, nothing is painted.
    let mut free = gif([32, 32], &[([0, 0, 16, 32], true), ([0, 0, 16, 32], true)]);
    free[11] = 1;
    let (about, shown) = told("a.gif", &free);
    assert!(
        shown.at([8, 16])[0] > 240 && shown.at([24, 16])[0] < 20,
        "{about}"
    );
    let mut bare = gif([32, 32], &[([0, 0, 32, 32], true)]);
    bare[10] = 0;
    bare.drain(13..19);
    refuses(&folder, "bare.gif", &bare, &["1 picture without a palette"]);
    let xyz = b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 32 +X 32\n";
    let pixels = [128, 128, 128, 128].repeat(32 * 32);
    let (_, shown) = told("a.hdr", &[&xyz[..], &pixels].concat());
    assert_grey(&shown, 188, "XYZ");
}
