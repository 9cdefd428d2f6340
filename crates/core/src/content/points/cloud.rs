//! What does a pack say about a cloud of points?

use super::payload::PointAttributes;
use crate::pack::PackError;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A cloud of points, on the grid of its file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloud {
    /// Number of all points.
    pub count: u64,
    /// Length of a step along each axis, in the object's space.
    pub scale: [f64; 3],
    /// Where the file's coordinates are 0, in the object's space.
    pub offset: [f64; 3],
    /// The file's coordinates of the place [0, 0, 0].
    pub least: [i64; 3],
    /// What its points have.
    pub attributes: PointAttributes,
    /// Bits of a code of a colour: 8 or 16.
    pub colour_bits: u8,
    /// What a code of eight bits was multiplied by in the file.
    pub colour_times: u16,
    /// The intensity that is white; larger ones are too.
    pub most_intensity: u16,
}

impl Default for Cloud {
    fn default() -> Self {
        Self {
            count: 0,
            scale: [1.0; 3],
            offset: [0.0; 3],
            least: [0; 3],
            attributes: PointAttributes::default(),
            colour_bits: 8,
            colour_times: 1,
            most_intensity: 0,
        }
    }
}

impl Cloud {
    /// A place on its grid, in the object's space: as the file says by whole numbers.
    #[must_use]
    pub fn at(&self, place: [u32; 3]) -> DVec3 {
        let along = |axis: usize| {
            let steps = self.least[axis] + i64::from(place[axis]);
            steps as f64 * self.scale[axis] + self.offset[axis]
        };
        DVec3::from_array([0, 1, 2].map(along))
    }

    /// A code of a colour as one of eight bits.
    #[must_use]
    pub fn shown_code(&self, code: u16) -> u8 {
        match self.colour_bits {
            8 => code.min(255) as u8,
            _ => (code >> 8) as u8,
        }
    }

    /// The grey of an intensity, as a code of a colour of this cloud.
    pub(crate) fn grey_of(&self, intensity: u16) -> u16 {
        let most = u32::from(self.most_intensity).max(1);
        let white = if self.colour_bits == 8 { 255 } else { 65535 };
        // The square root, about as a display encodes light.
        let share = f64::from(intensity) / f64::from(most);
        (libm::sqrt(share.min(1.0)) * f64::from(white)) as u16
    }

    pub(crate) fn check(&self) -> Result<(), PackError> {
        let wrong = |field: &str, found: String, expected: &str| {
            let field = format!("objects.points.{field}");
            Err(PackError::new(&field, found, expected))
        };
        let is_step = |it: &f64| *it > 0.0 && *it <= 1e12;
        if !(self.scale.iter().all(is_step) && self.offset.iter().all(|it| it.abs() <= 1e15)) {
            let found = format!("{:?}, {:?}", self.scale, self.offset);
            return wrong("scale, offset", found, "a finite grid");
        }
        if self.least.iter().any(|it| it.unsigned_abs() > 1 << 40) {
            return wrong("least", format!("{:?}", self.least), "below 2^40");
        }
        match self.colour_bits {
            8 | 16 => Ok(()),
            bits => wrong("colour_bits", bits.to_string(), "8 or 16"),
        }
    }
}
