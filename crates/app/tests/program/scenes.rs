//! Which clips do the tests show, and what must be seen of them?

use crate::support::{Folder, Rgb};
use foveal_core::asset::picture::{Colour, Matrix, Picture, plane_size};
use foveal_core::gaze::sample::HeadPose;
use foveal_core::units::Radians;
use foveal_core::view::axes::direction_from_yaw_pitch;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Surface;
use foveal_media::{ClipCodec, ClipFormat, ClipWriter};
use std::collections::BTreeMap;
use std::path::Path;

/// Limited-range BT.709 with chroma on the left.
pub(crate) const VIDEO: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: true,
};

/// Writes pictures as a lossless clip of 25 frames a second.
pub(crate) fn write_clip(folder: &Folder, name: &str, pictures: &[Picture]) -> String {
    write_clip_at(folder, name, pictures, [25, 1])
}

/// Writes pictures as a lossless clip.
pub(crate) fn write_clip_at(
    folder: &Folder,
    name: &str,
    pictures: &[Picture],
    frame_rate: [i32; 2],
) -> String {
    let path = folder.name(name);
    let format = ClipFormat {
        codec: ClipCodec::Ffv1,
        size: [pictures[0].width, pictures[0].height],
        frame_rate,
        colour: VIDEO,
    };
    let mut clip = ClipWriter::create(Path::new(&path), &format).unwrap();
    pictures.iter().for_each(|p| clip.push(p).unwrap());
    clip.finish().unwrap();
    path
}

/// A picture of samples chosen by plane and place.
pub(crate) fn picture([width, height]: [u32; 2], code: impl Fn(usize, u32, u32) -> u8) -> Picture {
    let planes = [0, 1, 2].map(|p| {
        let [w, h] = plane_size(width, height, p);
        let row = |y| (0..w).map(move |x| (x, y));
        (0..h).flat_map(row).map(|(x, y)| code(p, x, y)).collect()
    });
    Picture {
        width,
        height,
        planes,
    }
}

/// Detail to the last pixel, different in every frame: noise within the limits of the range, with
/// chroma near neutral so that nothing is clipped.
pub(crate) fn noise(size: [u32; 2], frame: u32) -> Picture {
    picture(size, |p, x, y| {
        let mut state = u64::from(x) << 40 ^ u64::from(y) << 16 ^ u64::from(frame) << 4 ^ p as u64;
        for _ in 0..3 {
            state = (state ^ state >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
        let roll = (state >> 56) as u8;
        if p == 0 {
            80 + roll % 96
        } else {
            118 + roll % 21
        }
    })
}

/// A few frames of noise.
pub(crate) fn noisy_clip(size: [u32; 2], frames: u32) -> Vec<Picture> {
    (0..frames).map(|frame| noise(size, frame)).collect()
}

/// Soft moving waves, which code to few bytes.
pub(crate) fn waves(size: [u32; 2], frames: u32) -> Vec<Picture> {
    let wave = |frame: u32| {
        picture(size, move |p, x, y| {
            let across = (f64::from(x + 2 * frame) * [0.11, 0.07, 0.05][p]).sin();
            let down = (f64::from(y + frame) * 0.06).cos();
            (128.0 + 50.0 * across + 40.0 * down) as u8
        })
    };
    (0..frames).map(wave).collect()
}

/// Level-0 pixels on a side of what repeats the number of the frame; a tile of the packs under test.
pub(crate) const CELL: u32 = 64;
/// Level-0 pixels on a side of one bit of it.
const BIT: u32 = 16;

/// Luma of a bit of frame `number` at a place on a face: 16 bits a cell, the number and then its
/// complement.
fn bit_luma(number: u8, place: [f64; 2]) -> u8 {
    let [x, y] = place.map(|k| (k.max(0.0) as u32 % CELL) / BIT);
    let word = u16::from(number) << 8 | u16::from(!number);
    if word >> (y * (CELL / BIT) + x) & 1 == 1 {
        210
    } else {
        50
    }
}

/// A flat clip whose every cell carries the number of its frame.
pub(crate) fn numbered_flat(size: [u32; 2], frames: u8) -> Vec<Picture> {
    let numbered = |number| {
        picture(size, move |p, x, y| match p {
            0 => bit_luma(number, [x, y].map(f64::from)),
            _ => 128,
        })
    };
    (0..frames).map(numbered).collect()
}

/// An equirectangular clip for cubes of `face` pixels whose every cell carries its frame's number.
pub(crate) fn numbered_sphere(face: u32, frames: u8) -> Vec<Picture> {
    let (size, surface) = ([4 * face, 2 * face], Surface::cube(face));
    let place = |x: u32, y: u32| {
        let turn = std::f64::consts::PI * 2.0;
        let yaw = ((f64::from(x) + 0.5) / f64::from(size[0]) - 0.5) * turn;
        let pitch = (0.5 - (f64::from(y) + 0.5) / f64::from(size[1])) * turn / 2.0;
        let direction = direction_from_yaw_pitch(Radians(yaw), Radians(pitch));
        surface.locate(direction).unwrap().1
    };
    let places: Vec<[f64; 2]> = (0..size[1])
        .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
        .map(|(x, y)| place(x, y))
        .collect();
    let numbered = |number| {
        let mut made = Picture::filled(size[0], size[1], [0, 128, 128]);
        made.planes[0] = places.iter().map(|at| bit_luma(number, *at)).collect();
        made
    };
    (0..frames).map(numbered).collect()
}

/// The face, and the place on it, of every pixel of a view that shows any.
pub(crate) fn seen<'a>(
    surface: &'a Surface,
    view: &'a EyeView,
) -> impl Fn([u32; 2]) -> Option<(u32, [f64; 2])> + 'a {
    move |pixel| surface.locate(view.ray(pixel.map(|k| f64::from(k) + 0.5)))
}

/// A view turned by yaw and pitch in degrees.
pub(crate) fn turned(view: &EyeView, yaw: f64, pitch: f64) -> EyeView {
    let head = HeadPose {
        yaw: Radians::from_degrees(yaw),
        pitch: Radians::from_degrees(pitch),
        roll: Radians(0.0),
    };
    EyeView {
        axes: head.axes(),
        ..*view
    }
}

/// The numbers that a picture's cells carry, by face and cell: `None` where bits contradict.
///
/// A bit is read where most of it is seen, from the middle of its square; a cell is read when all
/// its bits are.
pub(crate) fn read_numbers(
    image: &Rgb,
    surface: &Surface,
    view: &EyeView,
) -> BTreeMap<(u32, u32, u32), Option<u8>> {
    let locate = seen(surface, view);
    let bits = (CELL / BIT) as usize;
    let mut sums: BTreeMap<(u32, u32, u32), [(u32, u32); 16]> = BTreeMap::new();
    for pixel in image.places() {
        let Some((face, [x, y])) = locate(pixel) else {
            continue;
        };
        let within = [x, y].map(|k| k.rem_euclid(f64::from(BIT)) / f64::from(BIT));
        if within.iter().any(|k| !(0.25..0.75).contains(k)) {
            continue;
        }
        let cell = [x, y].map(|k| k as u32 / CELL);
        let [column, row] = [x, y].map(|k| (k as u32 % CELL / BIT) as usize);
        let sum = sums.entry((face, cell[0], cell[1])).or_default();
        let (total, count) = &mut sum[row * bits + column];
        *total += u32::from(image.at(pixel)[1]);
        *count += 1;
    }
    let whole = |sum: &[(u32, u32); 16]| sum.iter().all(|(_, count)| *count >= 4);
    let cells = sums.into_iter().filter(|(_, sum)| whole(sum));
    cells.map(|(cell, sum)| (cell, number_of(&sum))).collect()
}

fn number_of(sum: &[(u32, u32); 16]) -> Option<u8> {
    let bit = |(at, (total, count)): (usize, &(u32, u32))| u16::from(total / count > 127) << at;
    let word: u16 = sum.iter().enumerate().map(bit).sum();
    let (number, complement) = ((word >> 8) as u8, word as u8);
    (number == !complement).then_some(number)
}
