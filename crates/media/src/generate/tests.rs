//! Does a scene look the same from everywhere it is drawn, and do numbers survive?

use super::*;
use crate::prepare::pyramid::halve;
use crate::sphere::{Coverage, CubeSampler};
use foveal_core::view::picture::{Colour, Matrix};

const COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: false,
};

pub(super) fn psnr(a: &[u8], b: &[u8]) -> f64 {
    let square = |(&a, &b): (&u8, &u8)| (f64::from(a) - f64::from(b)).powi(2);
    let sum: f64 = a.iter().zip(b).map(square).sum();
    10.0 * (255.0 * 255.0 * a.len() as f64 / sum.max(1e-9)).log10()
}

#[test]
fn a_number_is_read_back_at_every_level() {
    for tile in [128, 256, 512] {
        for number in [0, 1, 77, 2048, 4095, 4096 + 5] {
            let mut clip = numbered_tiles([2 * tile, tile + 40], tile, number);
            let mut side = tile;
            while side >= 8 && side * 16 >= tile {
                let found = read_number(&clip.crop([side, 0], [side; 2]));
                assert_eq!(found, Some((number % 4096) as u32), "tile {tile} at {side}");
                clip = halve(&clip, 2, COLOUR);
                side /= 2;
            }
        }
    }
}

#[test]
fn what_carries_no_number_is_not_read() {
    for luma in [16, 60, 128, 235] {
        assert_eq!(
            read_number(&Picture::filled(64, 64, [luma, 128, 128])),
            None
        );
    }
    assert_eq!(
        read_number(&numbered_tiles([64, 64], 64, 3).crop([0, 0], [6, 6])),
        None
    );
    assert_eq!(read_number(&Picture::default()), None);
    // Two frames mixed half and half: bits that differ are grey.
    let [a, b] = [3, 12].map(|frame| numbered_tiles([64, 64], 64, frame));
    let mut mixed = a;
    for (a, b) in mixed.planes[0].iter_mut().zip(&b.planes[0]) {
        *a = a.midpoint(*b);
    }
    assert_eq!(read_number(&mixed), None);
}

#[test]
fn a_frame_is_the_same_every_time_and_another_one_next() {
    for scene in [
        GeneratedScene::panorama([258, 129]),
        GeneratedScene::wide([250, 141]),
    ] {
        let frame = scene.frame(12);
        assert!(frame.is_consistent());
        assert_eq!(frame, scene.frame(12));
        assert_ne!(frame, scene.frame(13));
    }
}

#[test]
fn a_panorama_closes_at_the_seam_and_the_poles() {
    let frame = GeneratedScene::panorama([1024, 512]).frame(40);
    let luma = |x: usize, y: usize| f64::from(frame.planes[0][y * 1024 + x]);
    let step = |x: usize| {
        (0..512)
            .map(|y| (luma(x, y) - luma((x + 1) % 1024, y)).abs())
            .sum::<f64>()
            / 512.0
    };
    let usual = (0..1023).map(step).fold(0.0, f64::max);
    assert!(step(1023) <= usual, "{} against {usual}", step(1023));
    // Around a pole neighbours are the same place, nearly.
    for y in [0, 511] {
        assert!((0..1024).all(|x| (luma(x, y) - luma((x + 1) % 1024, y)).abs() < 12.0));
    }
}

#[test]
fn a_face_drawn_at_once_agrees_with_the_resampled_panorama() {
    let scene = GeneratedScene::panorama([2048, 1024]);
    let sampler = CubeSampler::new([2048, 1024], 512, Coverage::Full, false);
    let cube = sampler.cube_from_equirect(&scene.frame(5), 2);
    // Half the detail of both, as they are filtered differently near the limit.
    for (face, resampled) in (0..).zip(&cube) {
        let drawn = halve(&scene.cube_face(5, face, 512), 4, COLOUR);
        let quality = psnr(&drawn.planes[0], &halve(resampled, 4, COLOUR).planes[0]);
        println!("face {face}: {quality:.1} dB");
        assert!(quality > 30.0, "face {face}: {quality}");
    }
}

#[test]
fn a_scene_is_full_of_detail() {
    let frame = GeneratedScene::panorama([2048, 1024]).frame(0);
    let coarse = halve(&halve(&frame, 2, COLOUR), 2, COLOUR);
    let mut plain = 0;
    for (tile_y, tile_x) in (0..16).flat_map(|y| (0..32).map(move |x| (y, x))) {
        let tile = frame.crop([tile_x * 64, tile_y * 64], [64; 2]);
        let blurred = coarse.crop([tile_x * 16, tile_y * 16], [16; 2]);
        let mut difference = 0.0;
        for (k, &sample) in tile.planes[0].iter().enumerate() {
            let below = blurred.planes[0][k / 64 / 4 * 16 + k % 64 / 4];
            difference += f64::from(sample.abs_diff(below)) / 4096.0;
        }
        plain += u32::from(difference < 0.5);
    }
    assert!(plain < 512 / 20, "{plain} of 512 tiles hold no fine detail");
}

fn write_png(name: &str, picture: &Picture) {
    let path = std::env::temp_dir().join(name);
    let [w, h] = [picture.width as usize, picture.height as usize];
    let mut rgb = Vec::with_capacity(3 * w * h);
    for y in 0..h {
        for x in 0..w {
            let chroma = y / 2 * w.div_ceil(2) + x / 2;
            let luma = (f32::from(picture.planes[0][y * w + x]) - 16.0) / 219.0;
            let [u, v] =
                [1, 2].map(|p: usize| (f32::from(picture.planes[p][chroma]) - 128.0) / 224.0);
            let (r, b) = (luma + 1.5748 * v, luma + 1.8556 * u);
            let g = (luma - 0.2126 * r - 0.0722 * b) / 0.7152;
            rgb.extend([r, g, b].map(|k| (k * 255.0 + 0.5).clamp(0.0, 255.0) as u8));
        }
    }
    let file = std::fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(file, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&rgb)
        .unwrap();
}

/// `cargo test --release -p foveal-media pictures_to_look_at -- --ignored --nocapture`
#[test]
#[ignore = "writes pictures into the temporary folder"]
fn pictures_to_look_at() {
    let scene = GeneratedScene::panorama([4096, 2048]);
    let frame = scene.frame(100);
    write_png("foveal-panorama.png", &halve(&frame, 2, COLOUR));
    write_png(
        "foveal-panorama-part.png",
        &frame.crop([1600, 500], [1200, 800]),
    );
    write_png("foveal-top.png", &scene.cube_face(100, 4, 1024));
    write_png("foveal-bottom.png", &scene.cube_face(100, 5, 1024));
    let wide = GeneratedScene::wide([3840, 2160]).frame(100);
    write_png("foveal-wide.png", &halve(&wide, 2, COLOUR));
    write_png(
        "foveal-numbered.png",
        &numbered_tiles([512, 256], 128, 1234),
    );
}

/// `cargo test --release -p foveal-media drawing_speed -- --ignored --nocapture`
#[test]
#[ignore = "a measurement"]
fn drawing_speed() {
    for (name, scene) in [
        ("panorama", GeneratedScene::panorama([4096, 2048])),
        ("wide", GeneratedScene::wide([4096, 2048])),
    ] {
        let start = std::time::Instant::now();
        for number in 0..3 {
            std::hint::black_box(scene.frame(number * 100));
        }
        println!(
            "{name}: {:.3} s a frame",
            start.elapsed().as_secs_f64() / 3.0
        );
    }
}
