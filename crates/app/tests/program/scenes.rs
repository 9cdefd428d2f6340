//! Which clips do the tests show, and what must be seen of them?

use crate::support::{Folder, Rgb};
use foveal_core::gaze::sample::HeadPose;
use foveal_core::units::Radians;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Matrix, Picture, plane_size};
use foveal_core::view::surface::Surface;
use foveal_media::generate::{numbered_tiles, read_number};
use foveal_media::sphere::equirect_from_cube;
use foveal_media::{ClipCodec, ClipFormat, ClipWriter};
use std::path::Path;

/// Limited-range BT.709 with chroma on the left.
pub(crate) const VIDEO: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: true,
};

/// Writes pictures as a lossless clip of 25 frames a second.
pub(crate) fn write_clip(folder: &Folder, name: &str, pictures: &[Picture]) -> String {
    let ticks: Vec<u64> = (0..pictures.len() as u64).collect();
    write_clip_at(folder, name, pictures, [25, 1], &ticks)
}

/// Writes pictures as a lossless clip, each shown at its tick of the frame rate.
pub(crate) fn write_clip_at(
    folder: &Folder,
    name: &str,
    pictures: &[Picture],
    frame_rate: [i32; 2],
    ticks: &[u64],
) -> String {
    let path = folder.name(name);
    let format = ClipFormat {
        codec: ClipCodec::Ffv1,
        size: [pictures[0].width, pictures[0].height],
        frame_rate,
        colour: VIDEO,
    };
    let mut clip = ClipWriter::create(Path::new(&path), &format).unwrap();
    for (picture, tick) in pictures.iter().zip(ticks) {
        clip.push_at(picture, *tick).unwrap();
    }
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

/// Level-0 pixels on a side of what repeats the number of the frame: a tile of the packs here.
pub(crate) const CELL: u32 = 64;

/// An equirectangular clip for cubes of `face` pixels whose every cell carries its frame's number.
pub(crate) fn numbered_sphere(face: u32, frames: u32) -> Vec<Picture> {
    let numbered = |frame| {
        let side = numbered_tiles([face; 2], CELL, u64::from(frame));
        let cube = [0; 6].map(|_| side.clone());
        equirect_from_cube(&cube, [4 * face, 2 * face], 2)
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

/// The number that each cell carries which a picture shows whole, by face, column and row: `None`
/// where it cannot be read.
pub(crate) fn read_numbers(
    image: &Rgb,
    surface: &Surface,
    view: &EyeView,
) -> Vec<([u32; 3], Option<u32>)> {
    let [columns, rows] = surface.size.map(|side| side / CELL);
    let cells = (0..surface.faces())
        .flat_map(|face| (0..rows).map(move |row| [face, row]))
        .flat_map(|[face, row]| (0..columns).map(move |column| [face, column, row]));
    let shown = |cell| Some((cell, read_number(&shown_cell(image, surface, view, cell)?)));
    cells.filter_map(shown).collect()
}

/// A cell as a picture shows it, turned back to its face; `None` where some of it is out of view.
fn shown_cell(
    image: &Rgb,
    surface: &Surface,
    view: &EyeView,
    [face, column, row]: [u32; 3],
) -> Option<Picture> {
    let mut cell = Picture::filled(CELL, CELL, [0, 128, 128]);
    for (y, line) in (0..).zip(cell.planes[0].chunks_exact_mut(CELL as usize)) {
        for (x, luma) in (0..).zip(line) {
            let place = [column * CELL + x, row * CELL + y].map(|k| f64::from(k) + 0.5);
            let [x, y] = view.place(surface.direction(face, place))?;
            let [w, h] = view.size.map(f64::from);
            if !(0.0..w).contains(&x) || !(0.0..h).contains(&y) {
                return None;
            }
            let [r, g, b] = image.at([x as u32, y as u32]).map(f64::from);
            *luma = (0.2126 * r + 0.7152 * g + 0.0722 * b) as u8;
        }
    }
    Some(cell)
}
