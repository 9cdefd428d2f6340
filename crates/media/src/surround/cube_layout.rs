//! Where in a picture does each face of a cube lie?

use foveal_core::units::counted;
use foveal_core::view::picture::Picture;

/// Faces of a cube in columns and rows of one picture.
///
/// Faces are those of [`foveal_core::view::surface::CUBE_FACES`]: 0 front, 1 right, 2 back, 3 left,
/// 4 top, 5 bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CubeLayout {
    columns: u32,
    rows: u32,
    /// The face at each place, row by row.
    faces: &'static [u8],
    /// Whether top and bottom stand on their heads.
    poles_turned: bool,
    /// Pixels round every face that are not part of it.
    padding: u32,
}

/// Right, left, top; bottom, front, back: `c3x2` and, in one row, `c6x1` of FFmpeg's filter v360,
/// its order `rludfb`. The lower border of the top and the upper border of the bottom touch the
/// front, as in a pack.
const V360: [u8; 6] = [1, 3, 4, 5, 0, 2];
/// A walk round the horizon from the left: left, front, right, back.
const HORIZON: [u8; 4] = [3, 0, 1, 2];

impl CubeLayout {
    /// The layout of a picture of this shape: 3:2 and 6:1 as FFmpeg's filter v360 lays them out,
    /// 1:6 the same in one column, 4:1 the four faces round the horizon. Refuses other shapes and
    /// faces with an odd side, and says what would do.
    pub fn of_size(size: [u32; 2]) -> Result<Self, String> {
        let shapes: [(u32, u32, &'static [u8]); 4] = [
            (3, 2, &V360),
            (6, 1, &V360),
            (1, 6, &V360),
            (4, 1, &HORIZON),
        ];
        let [w, h] = size.map(u64::from);
        let fits =
            |(columns, rows, _): &(u32, u32, _)| w * u64::from(*rows) == h * u64::from(*columns);
        let Some((columns, rows, faces)) = shapes.into_iter().find(fits) else {
            return Err(format!(
                "{w}x{h} pixels are no cube: faces lie in 3x2, 6x1 or 1x6, or in 4x1 without top \
                 and bottom, and are square; cut or scale it first with `ffmpeg -i FILE -vf \
                 crop=.. OUT`"
            ));
        };
        Self {
            columns,
            rows,
            faces,
            poles_turned: false,
            padding: 0,
        }
        .checked(size)
    }

    /// The layout that FFmpeg's spherical metadata names (`AV_SPHERICAL_CUBEMAP`): three columns
    /// and two rows, the upper border of the top to the front and the upper border of the bottom to
    /// the back, and so many pixels round every face that are left out.
    pub fn of_metadata(size: [u32; 2], padding: u32) -> Result<Self, String> {
        let layout = Self {
            columns: 3,
            rows: 2,
            faces: &V360,
            poles_turned: true,
            padding,
        };
        layout.checked(size)
    }

    fn checked(self, size: [u32; 2]) -> Result<Self, String> {
        let step = [self.columns, self.rows];
        let cell = [0, 1].map(|k| size[k] / step[k]);
        let inner = cell[0].checked_sub(self.padding.saturating_mul(2));
        let whole = (0..2).all(|k| cell[k] * step[k] == size[k]) && cell[0] == cell[1];
        if !whole || !cell[0].is_multiple_of(2) {
            let wanted = step.map(|cells| cell[0].next_multiple_of(2) * cells);
            return Err(format!(
                "{}x{} pixels are no {}x{} square faces with even sides; scale it first with \
                 `ffmpeg -i FILE -vf scale={}:{} OUT`",
                size[0], size[1], step[0], step[1], wanted[0], wanted[1],
            ));
        }
        match inner {
            Some(side) if side > 0 && self.padding.is_multiple_of(2) => Ok(self),
            _ => Err(format!(
                "its metadata says {} round each face of {}, which must be an even \
                 number and leave some of the face; have the file written again with the right \
                 one, or without (`ffmpeg -i FILE -c copy OUT.mp4`) and give --projection cube",
                counted(self.padding, "pixel"),
                counted(cell[0], "pixel"),
            )),
        }
    }

    /// Number of faces: 6, or 4 without top and bottom.
    #[must_use]
    pub fn faces(&self) -> u8 {
        self.faces.len() as u8
    }

    /// Pixels on a side of a face in a picture of `size`.
    #[must_use]
    pub fn face_size(&self, size: [u32; 2]) -> u32 {
        size[0] / self.columns - 2 * self.padding
    }

    /// In words, for people: shape and order.
    #[must_use]
    pub fn words(&self) -> String {
        let names = ["front", "right", "back", "left", "top", "bottom"];
        let order: Vec<&str> = self.faces.iter().map(|f| names[usize::from(*f)]).collect();
        format!(
            "{}x{} faces ({})",
            self.columns,
            self.rows,
            order.join(", ")
        )
    }

    /// The faces in the order of a pack. Chroma stays where it lay (`chroma_left`: on the left luma
    /// sample of each pair).
    ///
    /// # Panics
    /// When the picture has another size than the layout was made for.
    #[must_use]
    pub fn split(&self, picture: &Picture, chroma_left: bool) -> Vec<Picture> {
        let cell = picture.width / self.columns;
        let side = self.face_size([picture.width, picture.height]);
        let face = |face: u8| {
            let place = self.faces.iter().position(|at| *at == face);
            let place = place.map_or(0, |place| place as u32);
            let corner = [place % self.columns, place / self.columns];
            let from = corner.map(|k| k * cell + self.padding);
            let upright = picture.crop(from, [side; 2]);
            if self.poles_turned && face > 3 {
                turned(&upright, chroma_left)
            } else {
                upright
            }
        };
        (0..self.faces()).map(face).collect()
    }
}

/// A square picture of even sides turned by half a turn.
fn turned(picture: &Picture, chroma_left: bool) -> Picture {
    let mut turned = picture.clone();
    for (p, plane) in turned.planes.iter_mut().enumerate() {
        plane.reverse();
        if p > 0 && chroma_left {
            // What lay on the left luma sample now lies on the right one: half a sample too far.
            let width = picture.plane_size(p)[0] as usize;
            plane.chunks_exact_mut(width).for_each(half_a_sample_left);
        }
    }
    turned
}

/// The row as seen half a sample further to the left; the first sample stays.
fn half_a_sample_left(row: &mut [u8]) {
    for x in (1..row.len()).rev() {
        row[x] = (u16::from(row[x - 1]) + u16::from(row[x])).div_ceil(2) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame whose places have luma 10, 20, .. in reading order, each face lighter by 5 below.
    fn frame([columns, rows]: [u32; 2], cell: u32) -> Picture {
        let mut frame = Picture::filled(columns * cell, rows * cell, [0, 128, 128]);
        for y in 0..rows * cell {
            for x in 0..columns * cell {
                let place = y / cell * columns + x / cell + 1;
                let below = u32::from(y % cell >= cell / 2);
                let at = (y * columns * cell + x) as usize;
                frame.planes[0][at] = (place * 10 + below * 5) as u8;
            }
        }
        frame
    }

    fn tops(faces: &[Picture]) -> Vec<u8> {
        faces.iter().map(|face| face.planes[0][0]).collect()
    }

    #[test]
    fn faces_are_found_in_every_shape() {
        for (shape, expected) in [
            ([3, 2], vec![50, 10, 60, 20, 30, 40]),
            ([6, 1], vec![50, 10, 60, 20, 30, 40]),
            ([1, 6], vec![50, 10, 60, 20, 30, 40]),
            ([4, 1], vec![20, 30, 40, 10]),
        ] {
            let layout = CubeLayout::of_size(shape.map(|k| k * 8)).unwrap();
            let faces = layout.split(&frame(shape, 8), true);
            assert_eq!(tops(&faces), expected, "{}", layout.words());
            assert!(faces.iter().all(|face| [face.width, face.height] == [8, 8]));
        }
    }

    #[test]
    fn metadata_turns_the_poles_and_leaves_the_padding_out() {
        let layout = CubeLayout::of_metadata([48, 32], 2).unwrap();
        let faces = layout.split(&frame([3, 2], 16), false);
        assert_eq!(tops(&faces), [50, 10, 60, 20, 35, 45]);
        assert!(
            faces
                .iter()
                .all(|face| face.width == 12 && face.is_consistent())
        );
    }

    #[test]
    fn turned_chroma_lies_on_the_left_again() {
        // A ramp along x, sited left: sample k lies at luma 2k. Turned, it falls along x and must
        // lie at luma 2k again: 7 - 2k of the old luma, between the samples of 6 - 2k and 8 - 2k.
        let mut picture = Picture::filled(8, 8, [0, 128, 128]);
        picture.planes[1] = (0..16).map(|at| 100 + at % 4 * 20).collect();
        let turned = turned(&picture, true);
        assert_eq!(turned.planes[1][..4], [160, 150, 130, 110]);
    }

    #[test]
    fn other_shapes_and_odd_faces_are_refused() {
        for size in [[300, 100], [99, 66], [100, 100], [0, 0], [18, 3], [12, 3]] {
            assert!(CubeLayout::of_size(size).is_err(), "{size:?}");
        }
        for (size, padding) in [
            ([48, 32], 8),
            ([48, 32], 1),
            ([47, 32], 0),
            ([48, 32], u32::MAX),
        ] {
            assert!(
                CubeLayout::of_metadata(size, padding).is_err(),
                "{size:?} {padding}"
            );
        }
    }
}
