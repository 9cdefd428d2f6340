//! Where does a pixel of the content lie before the eye?
//!
//! Flat video is one rectangle at unit distance, 360° video six of them, or one picture whose
//! columns are even in yaw and whose rows are even in pitch: eccentricity and density are one
//! formula each.

use super::axes::{Axes, direction_from_yaw_pitch, yaw_pitch_from_direction};
use super::picture::plane_size;
use super::slant::Slant;
use crate::units::{Ppd, Radians};
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
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
    /// One picture of all directions: columns even in yaw, a whole turn, the middle ahead; rows
    /// even in pitch, from straight up to straight down.
    Equirect,
}

impl Projection {
    /// Whether content lies all around, so that a head turns in it.
    #[must_use]
    pub fn surrounds(self) -> bool {
        self != Self::Flat
    }
}

/// How the pixels of a cube's faces lie over their angles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mapping {
    /// Evenly in the tangents of the angles, as a camera draws them: a face is 1.3 times as sharp
    /// at the middle of an edge as in its middle.
    #[default]
    Gnomonic,
    /// Evenly in the angles themselves (equi-angular cubemaps, 2017, as by EAC video): with a
    /// quarter of an equirectangular picture's width a face, no direction has less than the
    /// density of its equator along the axes of the face.
    EquiAngular,
}

impl Mapping {
    /// Whether this is what is meant where none is named, so that nothing needs to be written.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The tangent at a place of a face from -1 to 1; beyond the edge up to 2.
    #[must_use]
    pub fn tangent(self, place: f64) -> f64 {
        match self {
            Self::Gnomonic => place,
            Self::EquiAngular => libm::tan(place * FRAC_PI_4),
        }
    }

    /// The place from -1 to 1 at a tangent: the inverse of [`Self::tangent`].
    #[must_use]
    pub fn place(self, tangent: f64) -> f64 {
        match self {
            Self::Gnomonic => tangent,
            Self::EquiAngular => libm::atan(tangent) / FRAC_PI_4,
        }
    }

    /// Change of the tangent with the place, at a tangent.
    #[must_use]
    pub fn slope(self, tangent: f64) -> f64 {
        match self {
            Self::Gnomonic => 1.0,
            Self::EquiAngular => FRAC_PI_4 * (1.0 + tangent * tangent),
        }
    }
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
    /// How it stands where it is not square before the head; that is not measured.
    #[serde(skip)]
    pub slant: Option<Slant>,
    /// Half its width and height at unit distance, where content fills it whatever its shape.
    #[serde(skip)]
    pub filled: Option<[f64; 2]>,
}

impl Default for Screen {
    fn default() -> Self {
        Self {
            diagonal_inches: 24.0,
            distance_m: 0.6,
            slant: None,
            filled: None,
        }
    }
}

/// What content lies on, rectangles at unit distance or the sphere, and its pixels at level 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Flat, cube or equirectangular.
    pub projection: Projection,
    /// Pixels of one face at level 0: columns, rows.
    pub size: [u32; 2],
    /// Half of a face's width and height at unit distance (tangents of the half angles); of an
    /// equirectangular picture half the angles themselves, in radians.
    pub tangents: [f64; 2],
    /// Eyes that have a picture of their own, 1 or 2. The faces of the right eye follow those of
    /// the left and lie in the same directions.
    #[serde(default = "one_eye", skip_serializing_if = "is_one_eye")]
    pub eyes: u8,
    /// Faces of a cube that there are, an eye: 6, or the first 4 where the source shows neither
    /// top nor bottom. Only of a cube.
    #[serde(default = "all_faces", skip_serializing_if = "are_all_faces")]
    pub cube_faces: u8,
    /// How pixels lie over the faces of a cube. Only of a cube.
    #[serde(default, skip_serializing_if = "Mapping::is_default")]
    pub mapping: Mapping,
    /// How flat content stands that is not square before the head; nothing else does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slant: Option<Slant>,
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
        Self::flat_with_pixels(size, [1, 1], screen)
    }

    /// Flat content whose pixels are `aspect[0]` wide for `aspect[1]` of height, filling `screen`.
    #[must_use]
    pub fn flat_with_pixels(size: [u32; 2], aspect: [u32; 2], screen: Screen) -> Self {
        let [w, h] = [0, 1].map(|k| f64::from(size[k]) * f64::from(aspect[k]));
        let half_diagonal = screen.diagonal_inches * 0.0254 / 2.0 / screen.distance_m;
        let per_unit = half_diagonal / (w * w + h * h).sqrt();
        Self {
            projection: Projection::Flat,
            size,
            tangents: screen.filled.unwrap_or([w * per_unit, h * per_unit]),
            eyes: one_eye(),
            cube_faces: all_faces(),
            mapping: Mapping::Gnomonic,
            slant: screen.slant,
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
            mapping: Mapping::Gnomonic,
            slant: None,
        }
    }

    /// An equirectangular picture of `size` pixels.
    #[must_use]
    pub fn equirect(size: [u32; 2]) -> Self {
        Self {
            projection: Projection::Equirect,
            size,
            tangents: [PI, FRAC_PI_2],
            ..Self::cube(size[0])
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

    /// This surface with its pixels laid out so.
    #[must_use]
    pub fn mapped(self, mapping: Mapping) -> Self {
        Self { mapping, ..self }
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
            Projection::Flat | Projection::Equirect => 1,
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

    /// Whether its faces are planes; else it is the sphere, on which rows are no straight lines.
    #[must_use]
    pub fn is_of_planes(&self) -> bool {
        self.projection != Projection::Equirect
    }

    /// Orientation of a face, of either eye; of an equirectangular picture that of its middle.
    #[must_use]
    pub fn axes(&self, face: u32) -> Axes {
        match self.stands() {
            Some(slant) => slant.axes(),
            None => CUBE_FACES[(face % self.faces_of_an_eye()) as usize],
        }
    }

    /// How flat content stands where it is turned.
    fn stands(&self) -> Option<&Slant> {
        let is_flat = self.projection == Projection::Flat;
        self.slant.as_ref().filter(|_| is_flat)
    }

    /// Tangents, along the axes of a face, of its middle.
    #[must_use]
    pub fn middle(&self) -> [f64; 2] {
        self.stands().map_or([0.0; 2], |slant| slant.middle)
    }

    /// A direction as it would be if the content stood square before the head, its middle ahead.
    #[must_use]
    pub fn as_if_square(&self, direction: DVec3) -> DVec3 {
        let Some(slant) = self.stands() else {
            return direction;
        };
        let axes = slant.axes();
        let depth = direction.dot(axes.forward);
        let x = direction.dot(axes.right) - slant.middle[0] * depth;
        let y = direction.dot(axes.down) - slant.middle[1] * depth;
        DVec3::new(x, -y, -depth).normalize()
    }

    /// Tangent-plane position of a place on a face, `place` in level-0 pixels (0 is the left or top
    /// border, pixel centres lie at +0.5); on an equirectangular picture its angles to the right
    /// and down, in radians.
    #[must_use]
    pub fn tangent(&self, place: [f64; 2]) -> [f64; 2] {
        let (mapping, middle) = (self.mapping(), self.middle());
        [0, 1].map(|k| {
            let place = place[k] * 2.0 / f64::from(self.size[k]) - 1.0;
            mapping.tangent(place) * self.tangents[k] + middle[k]
        })
    }

    /// The place on a face, in level-0 pixels, at a position on its tangent plane: the inverse of
    /// [`Self::tangent`].
    #[must_use]
    pub fn place(&self, tangent: [f64; 2]) -> [f64; 2] {
        let (mapping, middle) = (self.mapping(), self.middle());
        [0, 1].map(|k| {
            let place = mapping.place((tangent[k] - middle[k]) / self.tangents[k]);
            (place + 1.0) / 2.0 * f64::from(self.size[k])
        })
    }

    /// How its pixels lie: evenly but on a cube, whatever the field says.
    pub(crate) fn mapping(&self) -> Mapping {
        match self.projection {
            Projection::Flat | Projection::Equirect => Mapping::Gnomonic,
            Projection::Cube => self.mapping,
        }
    }

    /// Unit direction of a place on a face, in level-0 pixels. An equirectangular picture goes on
    /// over its borders, a turn over and beyond the poles.
    #[must_use]
    pub fn direction(&self, face: u32, place: [f64; 2]) -> DVec3 {
        let tangent = self.tangent(place);
        if self.projection == Projection::Equirect {
            return direction_from_yaw_pitch(Radians(tangent[0]), Radians(-tangent[1]));
        }
        self.axes(face).at(tangent).normalize()
    }

    /// Where a place beyond the borders of an equirectangular picture lies on it, and any other
    /// place as it is.
    #[must_use]
    pub fn closed(&self, place: [f64; 2]) -> [f64; 2] {
        if self.projection != Projection::Equirect {
            return place;
        }
        let [w, h] = self.size.map(f64::from);
        let beyond_pole = !(0.0..=h).contains(&place[1]);
        let x = place[0] + if beyond_pole { w / 2.0 } else { 0.0 };
        let y = match beyond_pole {
            true if place[1] < 0.0 => -place[1],
            true => 2.0 * h - place[1],
            false => place[1],
        };
        let x = x - libm::floor(x / w) * w;
        // Neither border is the picture's: what lies on it is the first column, or the last row.
        [
            if x < w { x } else { 0.0 },
            y.clamp(0.0, h * (1.0 - f64::EPSILON)),
        ]
    }

    /// The face that `direction` meets and the place on it in level-0 pixels: the left eye's, to
    /// which [`Self::first_face`] adds that of another.
    ///
    /// `None` when it looks away from flat content, or at a face that does not exist; outside
    /// flat content the place lies outside [0, size).
    #[must_use]
    pub fn locate(&self, direction: DVec3) -> Option<(u32, [f64; 2])> {
        let face = match self.projection {
            Projection::Flat => 0,
            Projection::Cube => cube_face(direction),
            Projection::Equirect => {
                let (yaw, pitch) = yaw_pitch_from_direction(direction);
                return Some((0, self.closed(self.place([yaw.0, -pitch.0]))));
            }
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
        Some((face, self.place(tangent)))
    }

    /// Density at a place on a face: level-0 pixels per degree along the sparser direction.
    ///
    /// A pixel of a camera's picture at tangent radius r spans `pitch / sqrt(1 + r²)` radians
    /// across the radius and less along it; the wider of the two is what limits the detail. Of an
    /// equi-angular face it is the long axis of the ellipse that a pixel's circle becomes. A row of
    /// an equirectangular picture is denser along itself by one over the cosine of its pitch, so
    /// that from some pitch on the distance of the rows is what limits the detail.
    #[must_use]
    pub fn ppd(&self, place: [f64; 2]) -> Ppd {
        let [a, b] = self.tangent(place);
        let spacing = match (self.projection, self.mapping()) {
            (Projection::Equirect, _) => {
                let [across, down] = self.sides(b);
                across.max(down)
            }
            (_, Mapping::Gnomonic) => self.pitch() / (1.0 + a * a + b * b).sqrt(),
            (_, Mapping::EquiAngular) => {
                let [across, down, both] = self.spans([a, b]);
                let mean = f64::midpoint(across, down);
                let half = (across - down) / 2.0;
                (mean + (half * half + both * both).sqrt()).sqrt()
            }
        };
        Ppd(1.0 / Radians(spacing).to_degrees())
    }

    /// The width and the height of a pixel of an equirectangular picture at an angle down, in
    /// radians.
    fn sides(&self, down: f64) -> [f64; 2] {
        let [across, height] = [0, 1].map(|k| 2.0 * self.tangents[k] / f64::from(self.size[k]));
        [across * libm::cos(down).abs(), height]
    }

    /// By how much a pixel in a direction of a face appears foreshortened: the cosine to the face's
    /// axis; 1 on the sphere.
    #[must_use]
    pub fn foreshortening(&self, face: u32, direction: DVec3) -> f64 {
        match self.is_of_planes() {
            true => direction.dot(self.axes(face).forward),
            false => 1.0,
        }
    }

    /// What a pixel at a place covers, over what a square of [`Self::ppd`] does that is
    /// foreshortened by [`Self::foreshortening`]: 1 for square pixels of a camera's picture.
    #[must_use]
    pub fn shape(&self, place: [f64; 2]) -> f64 {
        match (self.projection, self.mapping()) {
            (Projection::Equirect, _) => {
                let [across, down] = self.sides(self.tangent(place)[1]);
                across.min(down) / across.max(down)
            }
            (_, Mapping::Gnomonic) => 1.0,
            (_, Mapping::EquiAngular) => {
                let [a, b] = self.tangent(place);
                let [across, down, both] = self.spans([a, b]);
                let area = (across * down - both * both).sqrt();
                let side = Radians::from_degrees(1.0 / self.ppd(place).0).0;
                area * (1.0 + a * a + b * b).sqrt() / (side * side)
            }
        }
    }

    /// How a pixel of a face spans angles (squares of radians): its column with itself, its row
    /// with itself, and the two with each other.
    fn spans(&self, [a, b]: [f64; 2]) -> [f64; 3] {
        let pitch = |k: usize, tangent: f64| {
            2.0 * self.tangents[k] / f64::from(self.size[k])
                * self.mapping().slope(tangent / self.tangents[k])
        };
        let [x, y] = [pitch(0, a), pitch(1, b)];
        let length = 1.0 + a * a + b * b;
        let scale = 1.0 / (length * length);
        [
            x * x * (1.0 + b * b) * scale,
            y * y * (1.0 + a * a) * scale,
            -a * b * x * y * scale,
        ]
    }

    /// The wider side of a level-0 pixel in the middle of a face, in tangent units; in radians of
    /// an equirectangular picture.
    #[must_use]
    pub fn pitch(&self) -> f64 {
        let [x, y] = [0, 1].map(|k| 2.0 * self.tangents[k] / f64::from(self.size[k]));
        x.max(y) * self.mapping().slope(0.0)
    }

    /// Pixels of all faces at level 0.
    #[must_use]
    pub fn pixels(&self) -> u64 {
        u64::from(self.faces()) * u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// Bytes of all faces at level 0 as 8-bit 4:2:0 planes.
    #[must_use]
    pub fn bytes_of_planes(&self) -> u64 {
        let [width, height] = self.size;
        let samples = |plane| plane_size(width, height, plane).map(u64::from);
        let face: u64 = (0..3)
            .map(|plane| samples(plane).iter().product::<u64>())
            .sum();
        u64::from(self.faces()) * face
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
mod tests;
