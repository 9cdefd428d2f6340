//! How many trilinear probes cover what a pixel sees of the source, where, and how heavy is each?
//!
//! Feline: McCormack et al. 1999, *Feline: Fast Elliptical Lines for Anisotropic Texture Mapping*,
//! the simple form, by singular values in place of an ellipse and an arc tangent.

use super::pixel_map::singular_values;

/// Default of the most probes that Feline takes.
pub const MOST_PROBES: u32 = 16;
/// How fast weights fall along the major axis: McCormack et al. 1999.
const ALPHA: f64 = 2.0;

/// Equal steps along the major axis of an ellipse, all at one level of the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probes {
    /// Half the long axis of the ellipse, in source pixels, at least 1.
    pub major: f64,
    /// Half the short one, widened where there are fewer probes than wanted.
    pub minor: f64,
    /// Radians from the source's columns to the long axis, towards its rows.
    pub angle: f64,
    /// How many probes the ellipse asks for.
    pub wanted: f64,
    /// How many there are.
    pub count: u32,
    /// Level of the source's mips, 0 the finest.
    pub level: f64,
    /// Source pixels from probe to probe; 0 of one.
    pub step: [f64; 2],
}

impl Probes {
    /// The probes of a pixel: its Jacobian, at most so many, of a source whose coarsest mip is
    /// `last`.
    ///
    /// ```
    /// use foveal_core::view::panel::footprint::Probes;
    ///
    /// let probes = Probes::of([[4.0, 0.0], [0.0, 1.0]], 16, 10.0);
    /// assert_eq!((probes.count, probes.level, probes.step), (7, 0.0, [1.0, 0.0]));
    /// ```
    #[must_use]
    pub fn of(jacobian: [[f64; 2]; 2], most: u32, last: f64) -> Self {
        let [[ux, uy], [vx, vy]] = jacobian;
        let (a, b, c) = (ux * ux + uy * uy, ux * vx + uy * vy, vx * vx + vy * vy);
        let angle = libm::atan2(2.0 * b, a - c) / 2.0;
        let [major, minor] = singular_values(jacobian).map(|radius| radius.max(1.0));
        let wanted = 2.0 * major / minor - 1.0;
        let mut count = (libm::floor(wanted + 0.5)).min(f64::from(most.max(1))) as u32;
        let mut narrow = minor;
        if f64::from(count) < wanted {
            narrow = 2.0 * major / f64::from(count + 1);
        }
        let mut level = libm::log2(narrow);
        if level > last {
            (level, count) = (last, 1);
        }
        let step = match count {
            1 => [0.0; 2],
            _ => {
                let step = 2.0 * (major - narrow) / f64::from(count - 1);
                [libm::cos(angle) * step, libm::sin(angle) * step]
            }
        };
        Self {
            major,
            minor: narrow,
            angle,
            wanted,
            count,
            level,
            step,
        }
    }

    /// Places of the probes from the pixel's, in source pixels: a probe in the middle and steps to
    /// both sides of an odd count, half steps of an even one.
    pub fn offsets(self) -> impl Iterator<Item = [f64; 2]> {
        self.halves().map(move |n| self.step.map(|it| n / 2.0 * it))
    }

    /// What each probe counts, 1 together.
    #[must_use]
    pub fn weights(self) -> Vec<f64> {
        let [x, y] = self.step;
        let step = (x * x + y * y).sqrt() / self.major;
        let raw = self.halves().map(|n| {
            let d = n / 2.0 * step;
            libm::exp(-ALPHA * d * d)
        });
        let raw: Vec<f64> = raw.collect();
        let sum: f64 = raw.iter().sum();
        raw.into_iter().map(|weight| weight / sum).collect()
    }

    /// Half steps from the middle: -(count - 1) to count - 1 by 2.
    fn halves(self) -> impl Iterator<Item = f64> {
        (0..self.count).map(move |k| 2.0 * f64::from(k) - f64::from(self.count - 1))
    }
}
