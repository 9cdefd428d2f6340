//! Where does a pixel of the content lie before the eye?
//!
//! Flat video is one rectangle at unit distance, 360° video six of them: the same geometry serves
//! both, so eccentricity and density are one formula each.

use super::axes::Axes;
use crate::units::{Ppd, Radians};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// How content surrounds the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Projection {
    /// One rectangle, as on a screen.
    Flat,
    /// Six square faces of a cube around the eye.
    Cube,
}

/// One of the two eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Eye {
    /// The left eye; of content for one eye, that eye.
    #[default]
    Left,
    /// The right eye.
    Right,
}

/// The flat screen that flat content fills, given by what a person can measure.
///
/// Size in inches along the diagonal and distance from the eye in metres; the default is a 24 inch
/// screen at 0.6 m, where 16:9 content fills 47.7° across.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Screen {
    /// Diagonal of the picture in inches.
    pub diagonal_inches: f64,
    /// Distance from the eye in metres.
    pub distance_m: f64,
}

impl Default for Screen {
    fn default() -> Self {
        Self {
            diagonal_inches: 24.0,
            distance_m: 0.6,
        }
    }
}

/// The rectangles at unit distance that content lies on, and their pixels at level 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Flat or cube.
    pub projection: Projection,
    /// Pixels of one face at level 0: columns, rows.
    pub size: [u32; 2],
    /// Half of a face's width and height at unit distance (tangents of the half angles).
    pub tangents: [f64; 2],
    /// Eyes that have a picture of their own, 1 or 2. The faces of the right eye follow those of
    /// the left and lie in the same directions.
    #[serde(default = "one_eye", skip_serializing_if = "is_one_eye")]
    pub eyes: u8,
    /// Faces of a cube that there are, an eye: 6, or the first 4 where the source shows neither
    /// top nor bottom. Flat content ignores it.
    #[serde(default = "all_faces", skip_serializing_if = "are_all_faces")]
    pub cube_faces: u8,
}

/// The number of eyes of content that does not say it.
pub(crate) fn one_eye() -> u8 {
    1
}

/// Whether this is [`one_eye`], so that nothing needs to be written.
pub(crate) fn is_one_eye(eyes: &u8) -> bool {
    *eyes == one_eye()
}

/// The number of faces of a cube that does not say it.
pub(crate) fn all_faces() -> u8 {
    6
}

/// Whether these are [`all_faces`], so that nothing needs to be written.
pub(crate) fn are_all_faces(faces: &u8) -> bool {
    *faces == all_faces()
}

/// The faces of the cube: front, right, back, left, top, bottom.
///
/// The bottom row of the top face and the top row of the bottom face touch the front face.
pub const CUBE_FACES: [Axes; 6] = [
    Axes::FRONT,
    Axes {
        forward: DVec3::X,
        right: DVec3::Z,
        down: DVec3::NEG_Y,
    },
    Axes {
        forward: DVec3::Z,
        right: DVec3::NEG_X,
        down: DVec3::NEG_Y,
    },
    Axes {
        forward: DVec3::NEG_X,
        right: DVec3::NEG_Z,
        down: DVec3::NEG_Y,
    },
    Axes {
        forward: DVec3::Y,
        right: DVec3::X,
        down: DVec3::NEG_Z,
    },
    Axes {
        forward: DVec3::NEG_Y,
        right: DVec3::X,
        down: DVec3::Z,
    },
];

impl Surface {
    /// Flat content of `size` pixels that fills `screen`.
    #[must_use]
    pub fn flat(size: [u32; 2], screen: Screen) -> Self {
        let [w, h] = size.map(f64::from);
        let half_diagonal = screen.diagonal_inches * 0.0254 / 2.0 / screen.distance_m;
        let per_pixel = half_diagonal / (w * w + h * h).sqrt();
        Self {
            projection: Projection::Flat,
            size,
            tangents: [w * per_pixel, h * per_pixel],
            eyes: one_eye(),
            cube_faces: all_faces(),
        }
    }

    /// Flat content whose pixels are `aspect[0]` wide for `aspect[1]` of height, filling `screen`.
    #[must_use]
    pub fn flat_with_pixels(size: [u32; 2], aspect: [u32; 2], screen: Screen) -> Self {
        let [w, h] = [0, 1].map(|k| f64::from(size[k]) * f64::from(aspect[k]));
        let half_diagonal = screen.diagonal_inches * 0.0254 / 2.0 / screen.distance_m;
        let per_unit = half_diagonal / (w * w + h * h).sqrt();
        Self {
            tangents: [w * per_unit, h * per_unit],
            ..Self::flat(size, screen)
        }
    }

    /// A cube with faces of `face_size` pixels on a side.
    #[must_use]
    pub fn cube(face_size: u32) -> Self {
        Self {
            projection: Projection::Cube,
            size: [face_size; 2],
            tangents: [1.0; 2],
            eyes: one_eye(),
            cube_faces: all_faces(),
        }
    }

    /// This surface with only the four faces round the horizon: towards top and bottom there is
    /// nothing.
    #[must_use]
    pub fn without_poles(self) -> Self {
        Self {
            cube_faces: 4,
            ..self
        }
    }

    /// This surface with a picture for each eye.
    #[must_use]
    pub fn for_two_eyes(self) -> Self {
        Self { eyes: 2, ..self }
    }

    /// Number of faces of all eyes: 1, 4 or 6 an eye.
    #[must_use]
    pub fn faces(&self) -> u32 {
        u32::from(self.eyes) * self.faces_of_an_eye()
    }

    /// Number of faces that one eye has: 1, 4 or 6.
    #[must_use]
    pub fn faces_of_an_eye(&self) -> u32 {
        match self.projection {
            Projection::Flat => 1,
            Projection::Cube => u32::from(self.cube_faces),
        }
    }

    /// The first face of what an eye is shown; where there is one picture both eyes see it.
    #[must_use]
    pub fn first_face(&self, eye: Eye) -> u32 {
        match eye {
            Eye::Right if self.eyes > 1 => self.faces_of_an_eye(),
            _ => 0,
        }
    }

    /// Orientation of a face, of either eye.
    #[must_use]
    pub fn axes(&self, face: u32) -> Axes {
        CUBE_FACES[(face % self.faces_of_an_eye()) as usize]
    }

    /// Tangent-plane position of a place on a face, `place` in level-0 pixels (0 is the left or top
    /// border, pixel centres lie at +0.5).
    #[must_use]
    pub fn tangent(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (place[k] * 2.0 / f64::from(self.size[k]) - 1.0) * self.tangents[k])
    }

    /// Unit direction of a place on a face, in level-0 pixels.
    #[must_use]
    pub fn direction(&self, face: u32, place: [f64; 2]) -> DVec3 {
        self.axes(face).at(self.tangent(place)).normalize()
    }

    /// The face that `direction` meets and the place on it in level-0 pixels: the left eye's, to
    /// which [`Self::first_face`] adds that of another.
    ///
    /// `None` when it looks away from flat content, or at a face that there is not; beside flat
    /// content the place lies outside [0, size).
    #[must_use]
    pub fn locate(&self, direction: DVec3) -> Option<(u32, [f64; 2])> {
        let face = match self.projection {
            Projection::Flat => 0,
            Projection::Cube => cube_face(direction),
        };
        if face >= self.faces_of_an_eye() {
            return None;
        }
        let axes = self.axes(face);
        let depth = direction.dot(axes.forward);
        if depth <= 1e-9 {
            return None;
        }
        let tangent = [
            direction.dot(axes.right) / depth,
            direction.dot(axes.down) / depth,
        ];
        let place =
            [0, 1].map(|k| (tangent[k] / self.tangents[k] + 1.0) / 2.0 * f64::from(self.size[k]));
        Some((face, place))
    }

    /// Density at a place on a face: level-0 pixels per degree along the sparser direction.
    ///
    /// A pixel at tangent radius r spans `pitch / sqrt(1 + r²)` radians across the radius and less
    /// along it; the wider of the two is what limits the detail.
    #[must_use]
    pub fn ppd(&self, place: [f64; 2]) -> Ppd {
        let [a, b] = self.tangent(place);
        let pitch = self.pitch();
        let spacing = Radians(pitch / (1.0 + a * a + b * b).sqrt());
        Ppd(1.0 / spacing.to_degrees())
    }

    /// The wider side of a level-0 pixel at unit distance, in tangent units.
    #[must_use]
    pub fn pitch(&self) -> f64 {
        let [x, y] = [0, 1].map(|k| 2.0 * self.tangents[k] / f64::from(self.size[k]));
        x.max(y)
    }

    /// Pixels of all faces at level 0.
    #[must_use]
    pub fn pixels(&self) -> u64 {
        u64::from(self.faces()) * u64::from(self.size[0]) * u64::from(self.size[1])
    }
}

/// The cube face that a direction meets; borders go to the face that comes first.
#[must_use]
pub fn cube_face(direction: DVec3) -> u32 {
    let size = direction.abs();
    let (x, y, z) = (direction.x, direction.y, direction.z);
    if size.z >= size.x && size.z >= size.y {
        if z < 0.0 { 0 } else { 2 }
    } else if size.x >= size.y {
        if x > 0.0 { 1 } else { 3 }
    } else if y > 0.0 {
        4
    } else {
        5
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::direction_from_yaw_pitch;

    #[test]
    fn every_cube_face_has_the_handedness_of_the_world() {
        for axes in CUBE_FACES {
            assert_eq!(axes.right.cross(axes.down), axes.forward);
        }
    }

    #[test]
    fn a_place_on_the_cube_survives_the_way_to_a_direction_and_back() {
        let cube = Surface::cube(64);
        for face in 0..6 {
            for y in 0..64 {
                for x in 0..64 {
                    let place = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                    let found = cube.locate(cube.direction(face, place)).unwrap();
                    assert_eq!(found.0, face);
                    assert!((found.1[0] - place[0]).abs() < 1e-9);
                    assert!((found.1[1] - place[1]).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_desk_screen_fills_about_48_degrees() {
        let screen = Surface::flat([1920, 1080], Screen::default());
        let degrees = Radians(2.0 * libm::atan(screen.tangents[0])).to_degrees();
        assert!((degrees - 47.77).abs() < 0.05, "{degrees}");
    }

    #[test]
    fn density_grows_from_the_centre_of_a_face_to_its_corner() {
        let cube = Surface::cube(4096);
        let centre = cube.ppd([2048.0, 2048.0]).0;
        assert!((centre - 35.74).abs() < 0.01, "{centre}");
        assert!(cube.ppd([0.0, 0.0]).0 > 1.7 * centre);
    }

    #[test]
    fn a_panorama_without_poles_has_nothing_above_and_below() {
        let panorama = Surface::cube(8).without_poles();
        assert_eq!((panorama.faces(), panorama.pixels()), (4, 4 * 64));
        assert_eq!(panorama.locate(DVec3::new(0.1, 1.0, 0.1)), None);
        assert_eq!(panorama.locate(DVec3::new(0.1, -1.0, 0.1)), None);
        assert_eq!(panorama.locate(DVec3::X).map(|found| found.0), Some(1));
    }

    #[test]
    fn the_faces_of_the_right_eye_lie_where_those_of_the_left_do() {
        for surface in [Surface::cube(8), Surface::cube(8).without_poles()] {
            let both = surface.for_two_eyes();
            let right = both.first_face(Eye::Right);
            assert_eq!(
                (both.faces(), right),
                (2 * surface.faces(), surface.faces())
            );
            assert_eq!(surface.first_face(Eye::Right), 0);
            for face in 0..surface.faces() {
                assert_eq!(both.axes(right + face), surface.axes(face));
            }
        }
    }

    #[test]
    fn wide_pixels_fill_the_screen_that_twice_as_many_square_ones_do() {
        let screen = Screen::default();
        let wide = Surface::flat_with_pixels([960, 1080], [2, 1], screen);
        let square = Surface::flat([1920, 1080], screen);
        assert_eq!(wide.tangents, square.tangents);
        assert!(wide.pitch() > 1.9 * square.pitch());
    }

    #[test]
    fn yaw_to_the_right_lands_on_the_right_face() {
        let degrees = Radians::from_degrees;
        let cube = Surface::cube(8);
        let face = |yaw, pitch| {
            cube.locate(direction_from_yaw_pitch(degrees(yaw), degrees(pitch)))
                .unwrap()
                .0
        };
        assert_eq!(face(90.0, 0.0), 1);
        assert_eq!(face(-90.0, 0.0), 3);
        assert_eq!(face(0.0, 80.0), 4);
        assert_eq!(face(0.0, -80.0), 5);
        assert_eq!(face(180.0, 0.0), 2);
    }
}
