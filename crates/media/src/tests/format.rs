//! Do other pixel formats and images become 8-bit 4:2:0 without changing colour?

use av::format::Pixel;
use ffmpeg_next as av;
use foveal_core::view::picture::{Colour, Matrix, Picture};

use crate::read::source::Transparency;
use crate::tests::scenes::{Scratch, VIDEO, raw, read, read_one, write_raw};

/// Whether Y, U and V are all over the picture what is expected, but for one code value.
fn assert_filled(picture: &Picture, yuv: [u8; 3]) {
    for (plane, wanted) in picture.planes.iter().zip(yuv) {
        let off = plane.iter().map(|v| v.abs_diff(wanted)).max().unwrap();
        assert!(
            off <= 1,
            "{wanted} came as {:?}",
            &plane[..plane.len().min(8)]
        );
    }
}

#[test]
fn ten_bits_become_eight() {
    // 512, the middle of ten bits, is 128; the samples are little-endian words.
    let file = raw("ffv1", "mkv", Pixel::YUV420P10LE, [33, 17]);
    let path = write_raw(&file, 2, |_, _, x, _| if x % 2 == 0 { 0 } else { 2 });
    let (input, picture) = read_one(&path);
    assert_eq!(input.info().pixel_format, "yuv420p10le");
    assert_filled(&picture, [128, 128, 128]);
}

#[test]
fn other_chroma_grids_keep_their_values_and_their_range() {
    for (encoder, format, full_range) in [
        ("ffv1", Pixel::YUV422P, false),
        ("ffv1", Pixel::YUV444P, false),
        ("ffv1", Pixel::YUV410P, false),
        ("mjpeg", Pixel::YUVJ422P, true),
        ("mjpeg", Pixel::YUVJ444P, true),
    ] {
        let path = write_raw(&raw(encoder, "mkv", format, [35, 21]), 2, |_, p, _, _| {
            [90, 60, 200][p]
        });
        let (input, picture) = read_one(&path);
        assert_filled(&picture, [90, 60, 200]);
        assert_eq!(input.info().colour.full_range, full_range, "{format:?}");
    }
}

#[test]
fn rgb_becomes_limited_range_of_the_matrix_that_fits_the_size() {
    let red = |_: u32, _: usize, x: usize, _: usize| if x.is_multiple_of(3) { 255 } else { 0 };
    for (size, matrix, yuv) in [
        ([64, 48], Matrix::Bt601, [81, 90, 240]),
        ([16, 720], Matrix::Bt709, [63, 102, 240]),
        ([1280, 16], Matrix::Bt709, [63, 102, 240]),
    ] {
        let path = write_raw(&raw("png", "mkv", Pixel::RGB24, size), 1, red);
        let (input, picture) = read_one(&path);
        assert_filled(&picture, yuv);
        assert_eq!(input.info().colour, Colour { matrix, ..VIDEO });
    }
    let white = write_raw(&raw("png", "mkv", Pixel::RGB24, [3, 1]), 1, |_, _, _, _| {
        255
    });
    assert_filled(&read_one(&white).1, [235, 128, 128]);
}

#[test]
fn a_palette_follows_the_matrix_like_other_rgb() {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 16, 720);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(vec![0, 0, 0, 255, 0, 0]);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&[1; 16 * 720])
        .unwrap();
    let (input, picture) = read_one(&Scratch::holding("png", &file));
    assert_eq!(input.info().pixel_format, "pal8");
    assert_filled(&picture, [63, 102, 240]);
}

#[test]
fn grey_keeps_its_full_range() {
    let path = write_raw(&raw("png", "png", Pixel::GRAY8, [9, 5]), 1, |_, _, _, _| {
        255
    });
    let (input, picture) = read_one(&path);
    assert_filled(&picture, [255, 128, 128]);
    assert!(input.info().colour.full_range);
}

#[test]
fn what_is_transparent_is_shown_over_black() {
    // White at four strengths in columns of 16, so that chroma is even within each.
    let strength = |x: usize| [0, 128, 7, 255][x / 16 % 4];
    let rgba = |x: usize| if x % 4 == 3 { strength(x / 4) } else { 255 };
    let path = write_raw(
        &raw("png", "mov", Pixel::RGBA, [64, 16]),
        2,
        |_, _, x, _| rgba(x),
    );
    let (input, picture) = read_one(&path);
    let info = input.info();
    assert_eq!(info.transparency, Some(Transparency::OverBlack));
    let mut chroma = picture.planes[1..].iter().flatten();
    assert!(chroma.all(|code| *code == 128));
    for (at, luma) in picture.planes[0].iter().enumerate() {
        let expected = 16.0 + 219.0 * f64::from(strength(at % 64)) / 255.0;
        assert!((f64::from(*luma) - expected).abs() <= 1.5, "{at}: {luma}");
    }
}

#[test]
fn what_a_palette_says_is_transparent_is_black() {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 16, 16);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(vec![0, 0, 0, 255, 0, 0]);
    encoder.set_trns(vec![255, 0]);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&[1; 16 * 16])
        .unwrap();
    let (input, picture) = read_one(&Scratch::holding("png", &file));
    let info = input.info();
    assert_eq!(info.pixel_format, "pal8");
    assert_eq!(info.transparency, Some(Transparency::OverBlack));
    assert_filled(&picture, [16, 128, 128]);
}

#[test]
fn single_images_are_stills_of_one_frame() {
    for (encoder, ending, format) in [
        ("png", "png", Pixel::RGB24),
        ("mjpeg", "jpg", Pixel::YUVJ420P),
        ("bmp", "bmp", Pixel::BGR24),
        ("tiff", "tif", Pixel::RGB24),
    ] {
        for size in [[40, 30], [1, 1], [7, 3]] {
            let path = write_raw(&raw(encoder, ending, format, size), 1, |_, _, _, _| 128);
            let (input, pictures) = read(&path);
            assert_eq!(pictures.unwrap().len(), 1, "{ending}");
            let info = input.info();
            assert!(
                info.looks_still && info.frames == Some(1),
                "{ending} {info:?}"
            );
            assert_eq!([info.width, info.height], size);
            assert_eq!(info.colour.chroma_left, ending != "jpg");
        }
    }
}
