//! Which way up does a file want its pictures shown?

use foveal_core::view::picture::Picture;

/// The elements of a display matrix below this are taken as zero; 16.16 fixed point, so 0.01.
const NEARLY_ZERO: f64 = 655.0;
/// A matrix that leaves less of an area than this share of its largest element squared leaves none.
const FLAT: f64 = 1e-3;

/// One of the eight ways to lay a picture on its screen: first transpose, then mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct Orientation {
    /// Rows become columns.
    pub(crate) transpose: bool,
    /// Then left and right change places.
    pub(crate) mirror_x: bool,
    /// Then top and bottom change places.
    pub(crate) mirror_y: bool,
}

impl Orientation {
    /// The nearest to the 36 bytes of a display matrix (row vectors, 16.16 fixed point, native
    /// order), and what is odd about that where it asks for something else.
    pub(crate) fn from_display_matrix(bytes: &[u8]) -> (Self, Option<String>) {
        let element = |i: usize| {
            let word = bytes.get(4 * i..4 * i + 4)?;
            Some(f64::from(i32::from_ne_bytes(word.try_into().ok()?)))
        };
        let all = [0, 1, 3, 4].map(|i| element(i).unwrap_or(0.0));
        let [a, b, c, d] = all;
        let largest = all.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
        let zero = |n: f64| n.abs() < NEARLY_ZERO;
        if (a * d - b * c).abs() < FLAT * largest * largest || all.into_iter().all(zero) {
            let what = match all.into_iter().all(zero) {
                true => "is of zeros",
                false => "leaves no area of a picture",
            };
            let odd = format!("its display matrix {what}; pictures are shown as they are stored");
            return (Self::default(), Some(odd));
        }
        let transpose = b.abs() + c.abs() > a.abs() + d.abs();
        let ([x, y], rest) = match transpose {
            true => ([c, b], [a, d]),
            false => ([a, d], [b, c]),
        };
        let nearest = Self {
            transpose,
            mirror_x: x < 0.0,
            mirror_y: y < 0.0,
        };
        let odd = rest.iter().any(|it| !zero(*it)).then(|| {
            let degrees = b.atan2(a).to_degrees();
            format!(
                "its display matrix turns pictures by {degrees:.1}°, or slants them; they are \
                 shown by the nearest quarter of a turn"
            )
        });
        (nearest, odd)
    }

    /// From the number that EXIF has for it, 1 to 8.
    pub(crate) fn from_exif(number: u32) -> Option<Self> {
        let [transpose, mirror_x, mirror_y] = match number {
            1 => [false, false, false],
            2 => [false, true, false],
            3 => [false, true, true],
            4 => [false, false, true],
            5 => [true, false, false],
            6 => [true, true, false],
            7 => [true, true, true],
            8 => [true, false, true],
            _ => return None,
        };
        Some(Self {
            transpose,
            mirror_x,
            mirror_y,
        })
    }

    /// This, and then another.
    pub(crate) fn then(self, next: Self) -> Self {
        let [mirror_x, mirror_y] = match next.transpose {
            true => [self.mirror_y, self.mirror_x],
            false => [self.mirror_x, self.mirror_y],
        };
        Self {
            transpose: self.transpose != next.transpose,
            mirror_x: mirror_x != next.mirror_x,
            mirror_y: mirror_y != next.mirror_y,
        }
    }

    /// Whether pictures stay as they are.
    pub(crate) fn is_upright(self) -> bool {
        self == Self::default()
    }

    /// Width and height after turning.
    pub(crate) fn turned_size(self, [width, height]: [u32; 2]) -> [u32; 2] {
        if self.transpose {
            [height, width]
        } else {
            [width, height]
        }
    }

    /// A picture whose chroma lies between its luma samples, turned.
    pub(crate) fn turned(self, picture: Picture) -> Picture {
        if self.is_upright() {
            return picture;
        }
        let [width, height] = self.turned_size([picture.width, picture.height]);
        let planes = [0, 1, 2].map(|p| {
            let size = picture.plane_size(p);
            let from = (&picture.planes[p][..], size[0] as usize);
            let mut to = vec![0; picture.planes[p].len()];
            let stride = self.turned_size(size)[0] as usize;
            self.turn(from, size, (&mut to, stride));
            to
        });
        Picture {
            width,
            height,
            planes,
        }
    }

    /// Writes the plane `from` (`size` samples, `from_stride` bytes a row) turned into `to`.
    pub(crate) fn turn(
        self,
        (from, from_stride): (&[u8], usize),
        size: [u32; 2],
        (to, to_stride): (&mut [u8], usize),
    ) {
        let [width, height] = self.turned_size(size).map(|n| n as usize);
        for (y, row) in to.chunks_mut(to_stride).take(height).enumerate() {
            let v = if self.mirror_y { height - 1 - y } else { y };
            for (x, sample) in row[..width].iter_mut().enumerate() {
                let u = if self.mirror_x { width - 1 - x } else { x };
                let [column, line] = if self.transpose { [v, u] } else { [u, v] };
                *sample = from[line * from_stride + column];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The display matrix of a clockwise turn: (1, 0) goes to (cos, sin) with y down.
    pub(crate) fn matrix(cos: i32, sin: i32) -> Vec<u8> {
        let one = 1 << 16;
        [
            cos * one,
            sin * one,
            0,
            -sin * one,
            cos * one,
            0,
            0,
            0,
            1 << 30,
        ]
        .iter()
        .flat_map(|n: &i32| n.to_ne_bytes())
        .collect()
    }

    fn turned(cos: i32, sin: i32) -> Vec<u8> {
        let (orientation, odd) = Orientation::from_display_matrix(&matrix(cos, sin));
        assert_eq!(odd, None);
        laid(orientation)
    }

    /// A picture of two rows of three samples, laid.
    fn laid(orientation: Orientation) -> Vec<u8> {
        let mut to = vec![0; 6];
        let stride = orientation.turned_size([3, 2])[0] as usize;
        orientation.turn((&[1, 2, 3, 4, 5, 6], 3), [3, 2], (&mut to, stride));
        to
    }

    #[test]
    fn quarter_turns_move_the_corners_clockwise() {
        assert_eq!(turned(1, 0), [1, 2, 3, 4, 5, 6]);
        assert_eq!(turned(0, 1), [4, 1, 5, 2, 6, 3]);
        assert_eq!(turned(-1, 0), [6, 5, 4, 3, 2, 1]);
        assert_eq!(turned(0, -1), [3, 6, 2, 5, 1, 4]);
    }

    #[test]
    fn exif_numbers_the_eight_ways_by_the_side_that_the_first_row_and_column_show() {
        // Where the first row (1, 2, 3) and the first column (1, 4) of a picture are seen.
        for (number, seen) in [
            (1, [1, 2, 3, 4, 5, 6]),
            (2, [3, 2, 1, 6, 5, 4]),
            (3, [6, 5, 4, 3, 2, 1]),
            (4, [4, 5, 6, 1, 2, 3]),
            (5, [1, 4, 2, 5, 3, 6]),
            (6, [4, 1, 5, 2, 6, 3]),
            (7, [6, 3, 5, 2, 4, 1]),
            (8, [3, 6, 2, 5, 1, 4]),
        ] {
            let orientation = Orientation::from_exif(number).unwrap();
            assert_eq!(laid(orientation), seen, "{number}");
        }
        assert!(
            [0, 9, 65535]
                .map(Orientation::from_exif)
                .iter()
                .all(Option::is_none)
        );
    }

    #[test]
    fn slanted_short_and_empty_matrices_are_the_nearest_that_there_is_and_told() {
        let turned = |degrees: f64, across: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let one = f64::from(1 << 16);
            let all = [
                across * cos,
                across * sin,
                0.0,
                -sin,
                cos,
                0.0,
                0.0,
                0.0,
                1.0,
            ];
            let all: Vec<u8> = all
                .iter()
                .flat_map(|n| ((n * one) as i32).to_ne_bytes())
                .collect();
            Orientation::from_display_matrix(&all)
        };
        for (degrees, number) in [
            (15.0, 1),
            (-44.0, 1),
            (80.0, 6),
            (100.0, 6),
            (170.0, 3),
            (-100.0, 8),
        ] {
            let (nearest, odd) = turned(degrees, 1.0);
            assert_eq!(Some(nearest), Orientation::from_exif(number), "{degrees}");
            assert!(odd.unwrap().contains(&format!("{degrees:.1}°")));
        }
        let (nearest, odd) = turned(10.0, -1.0);
        assert!(Some(nearest) == Orientation::from_exif(2) && odd.is_some());
        for empty in [&[0; 36][..], &[0; 15], &[7; 9]] {
            let (nearest, odd) = Orientation::from_display_matrix(empty);
            assert!(nearest.is_upright() && odd.is_some());
        }
    }
}
