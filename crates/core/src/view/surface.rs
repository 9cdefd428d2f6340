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
        }
    }

    /// A cube with faces of `face_size` pixels on a side.
    #[must_use]
    pub fn cube(face_size: u32) -> Self {
        Self {
            projection: Projection::Cube,
            size: [face_size; 2],
            tangents: [1.0; 2],
        }
    }

    /// Number of faces: 1 or 6.
    #[must_use]
    pub fn faces(&self) -> u32 {
        match self.projection {
            Projection::Flat => 1,
            Projection::Cube => 6,
        }
    }

    /// Orientation of a face.
    #[must_use]
    pub fn axes(&self, face: u32) -> Axes {
        CUBE_FACES[face as usize]
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

    /// The face that `direction` meets and the place on it in level-0 pixels.
    ///
    /// `None` when it looks away from flat content; beside flat content the place lies outside
    /// [0, size).
    #[must_use]
    pub fn locate(&self, direction: DVec3) -> Option<(u32, [f64; 2])> {
        let face = match self.projection {
            Projection::Flat => 0,
            Projection::Cube => cube_face(direction),
        };
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
