//! How does a drawn sphere turn, seen as the faces of a cube?
//!
//! A camera turns evenly about the vertical: every frame is the same sphere a little further on,
//! by a part of a pixel, sampled at the places of the faces at once. What is on the faces so moves
//! as it does before a camera, across their borders too.

use super::pan::STEP;
use crate::parallel::in_parallel;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::CUBE_FACES;
use std::f64::consts::{PI, TAU};

/// Parts of a sample that places are rounded to.
const PARTS: u32 = 256;
/// Rows in one part of the work.
const ROWS: usize = 32;
/// The faces of a picture row by row, as FFmpeg's filter v360 lays them out in `c3x2`: right, left,
/// top; bottom, front, back.
const LAYOUT: [[usize; 3]; 2] = [[1, 3, 4], [5, 0, 2]];
/// Faces that are looked up by themselves; the other upright ones are the front a quarter on.
const LOOKED_UP: [usize; 3] = [0, 4, 5];

/// A clip of a cube in pictures of three columns and two rows of faces.
pub struct Turn {
    sphere: Picture,
    side: u32,
    /// For luma and for chroma, where the samples of the front, the top and the bottom look.
    places: [[Places; 3]; 2],
}

/// Column and row in an equirectangular plane of every sample of a face, in parts of a sample.
type Places = Vec<[u32; 2]>;

impl Turn {
    /// A turning `sphere`, an equirectangular picture, on faces of `side` pixels. Takes 30 bytes a
    /// pixel of one face.
    ///
    /// ```
    /// use foveal_core::view::picture::Picture;
    /// use foveal_media::generate::Turn;
    /// let turn = Turn::new(Picture::filled(64, 32, [90, 128, 128]), 16);
    /// assert_eq!(turn.frame(3), Picture::filled(48, 32, [90, 128, 128]));
    /// ```
    ///
    /// # Panics
    /// When the face has an odd side, or the sphere's width is no multiple of 8: a quarter turn
    /// must be whole samples of chroma.
    #[must_use]
    pub fn new(sphere: Picture, side: u32) -> Self {
        assert!(side.is_multiple_of(2), "faces of {side} pixels");
        assert!(sphere.width.is_multiple_of(8), "{} pixels", sphere.width);
        let of_plane = |p: usize| {
            let face = if p == 0 { side } else { side / 2 };
            LOOKED_UP.map(|index| places(index, face, sphere.plane_size(p)))
        };
        let places = [of_plane(0), of_plane(1)];
        Self {
            sphere,
            side,
            places,
        }
    }

    /// Width and height of its pictures in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [3 * self.side, 2 * self.side]
    }

    /// Frame `number`; by all cores.
    #[must_use]
    pub fn frame(&self, number: u32) -> Picture {
        let [width, height] = self.size();
        Picture {
            width,
            height,
            planes: [0, 1, 2].map(|p| self.plane(p, number)),
        }
    }

    fn plane(&self, p: usize, number: u32) -> Vec<u8> {
        let (side, sampling) = match p {
            0 => (self.side as usize, 1.0),
            _ => (self.side as usize / 2, 2.0),
        };
        let width = self.sphere.plane_size(p)[0];
        let moved = (f64::from(number) * STEP / sampling * f64::from(PARTS)) as u32;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let bands = in_parallel(cores, (2 * side).div_ceil(ROWS), |band| {
            let rows = band * ROWS..((band + 1) * ROWS).min(2 * side);
            let mut out = Vec::with_capacity(rows.len() * 3 * side);
            for row in rows {
                for face in LAYOUT[row / side] {
                    let upright = if face < 4 { face as u32 } else { 0 };
                    let quarters = upright * (width / 4) * PARTS;
                    let places = &self.places[usize::from(p > 0)][face.saturating_sub(3)];
                    let row = &places[row % side * side..][..side];
                    out.extend(
                        row.iter()
                            .map(|place| self.sample(p, [place[0] + quarters + moved, place[1]])),
                    );
                }
            }
            out
        });
        bands.concat()
    }

    /// Between the four samples of plane `p` round a place; columns go on round the sphere.
    #[inline]
    fn sample(&self, p: usize, [x, y]: [u32; 2]) -> u8 {
        let [width, height] = self.sphere.plane_size(p);
        let column = |x: u32| (x % width) as usize;
        let columns = [column(x / PARTS), column(x / PARTS + 1)];
        let rows = [y / PARTS, (y / PARTS + 1).min(height - 1)];
        let across = rows.map(|row| {
            let line = &self.sphere.planes[p][row as usize * width as usize..][..width as usize];
            let [a, b] = columns.map(|column| u32::from(line[column]));
            a * (PARTS - x % PARTS) + b * (x % PARTS)
        });
        let sum = across[0] * (PARTS - y % PARTS) + across[1] * (y % PARTS);
        ((sum + PARTS * PARTS / 2) / (PARTS * PARTS)) as u8
    }
}

/// Where the samples of a face of `side` samples look in an equirectangular plane.
fn places(face: usize, side: u32, [width, height]: [u32; 2]) -> Places {
    let axes = CUBE_FACES[face];
    let tangent = |index: u32| (f64::from(index) + 0.5) * 2.0 / f64::from(side) - 1.0;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = in_parallel(cores, side as usize, |y| {
        let place = |x: u32| {
            let ray = axes.at([tangent(x), tangent(y as u32)]).normalize();
            let u = libm::atan2(ray.x, -ray.z) / TAU + 0.5;
            let v = 0.5 - libm::asin(ray.y.clamp(-1.0, 1.0)) / PI;
            let column = (u * f64::from(width) - 0.5).rem_euclid(f64::from(width));
            let row = (v * f64::from(height) - 0.5).clamp(0.0, f64::from(height - 1));
            [column, row].map(|k| (k * f64::from(PARTS)).round() as u32)
        };
        (0..side).map(place).collect::<Places>()
    });
    rows.concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::GeneratedScene;
    use crate::generate::tests::psnr;
    use crate::sphere::{Coverage, CubeSampler};
    use crate::surround::cube_layout::CubeLayout;

    #[test]
    fn the_faces_are_those_that_a_sphere_would_be_resampled_to() {
        let sphere = GeneratedScene::panorama([512, 256]).frame(0);
        let sampler = CubeSampler::new([512, 256], 128, Coverage::Full, false);
        let expected = sampler.cube_from_equirect(&sphere, 2);
        let turn = Turn::new(sphere, 128);
        let layout = CubeLayout::of_size(turn.size()).unwrap();
        let faces = layout.split(&turn.frame(0), false);
        for (index, (face, expected)) in faces.iter().zip(&expected).enumerate() {
            for p in 0..3 {
                let found = psnr(&face.planes[p], &expected.planes[p]);
                assert!(found > 32.0, "face {index}, plane {p}: {found} dB");
            }
        }
    }

    #[test]
    fn a_quarter_turn_brings_the_right_face_to_the_front() {
        let turn = Turn::new(GeneratedScene::panorama([320, 160]).frame(0), 80);
        let layout = CubeLayout::of_size(turn.size()).unwrap();
        // 32 frames of 2.5 pixels are a quarter of 320.
        let [before, after] = [0, 32].map(|number| layout.split(&turn.frame(number), false));
        for face in 0..4 {
            assert_eq!(after[face], before[(face + 1) % 4], "face {face}");
        }
        assert_ne!(after[4], before[4]);
    }
}
