//! Where do pixels look that light known points in space?
//!
//! VESA, MPCDI 2.0, profiles a3 and sl: a float map of points, x to the right, y up and z against
//! the way that people look, as nDisplay takes them; none where nothing is lit.

use foveal_core::units::Radians;
use foveal_core::view::axes::{Axes, yaw_pitch_from_direction};
use glam::DVec3;

use super::super::entries::{PoseEntry, PoseOrder, TangentsEntry};
use super::super::pfm::{FloatMap, NO_POINT};
use super::warp_map::{PairAt, WarpMap};

/// Least cosine of the angle from the middle to a pixel: 85°, all that a flat panel reaches.
const LEAST_COSINE: f64 = 0.087_155_7;

/// What a map of points makes of a region.
pub(super) struct SpaceMap {
    /// Where the flat panel round all pixels looks, upright.
    pub(super) yaw_pitch: [Radians; 2],
    /// Tangents from there to its sides: left, right, up and down, outward.
    pub(super) tangents: [f64; 4],
    /// The places of pixels on it.
    pub(super) map: WarpMap,
}

impl SpaceMap {
    /// Reads the map of a region of `size`, for an eye at a place of the map's own units and axes.
    /// Lines come from above, or from below where the picture would else be upside down.
    pub(super) fn read(map: &FloatMap<'_>, size: [u32; 2], eye: DVec3) -> Result<Self, String> {
        let point = |line: usize, column: usize| {
            let point = DVec3::from(map.triple(line, column));
            let is_one = point.abs().max_element() >= NO_POINT;
            if is_one { point } else { DVec3::NAN }
        };
        Self::of((size, eye), &point, WarpMap::by_lines)
    }

    /// The same of points by row and column, the first row uppermost; not a number where none is
    /// lit.
    pub(super) fn from_above(
        size: [u32; 2],
        eye: DVec3,
        point: &dyn Fn(usize, usize) -> DVec3,
    ) -> Result<Self, String> {
        Self::of((size, eye), point, WarpMap::from_above)
    }

    fn of(
        (size, eye): ([u32; 2], DVec3),
        point: &dyn Fn(usize, usize) -> DVec3,
        map_of: impl Fn([u32; 2], PairAt<'_>) -> Result<WarpMap, String>,
    ) -> Result<Self, String> {
        let [w, h] = size.map(|side| side as usize);
        let ray = |line: usize, column: usize| {
            let way = point(line, column) - eye;
            let ray = way.is_finite().then(|| way.try_normalize()).flatten();
            ray.unwrap_or(DVec3::NAN)
        };
        let all = || (0..h).flat_map(|line| (0..w).map(move |column| (line, column)));
        let lit = || {
            all()
                .map(|(line, column)| ray(line, column))
                .filter(|it| it.is_finite())
        };
        let middle = lit().sum::<DVec3>().try_normalize();
        let middle = middle.ok_or("has no point before the eye")?;
        let (yaw, pitch) = yaw_pitch_from_direction(middle);
        let axes = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
        if let Some(worst) = lit().map(|it| it.dot(axes.forward)).min_by(f64::total_cmp)
            && worst < LEAST_COSINE
        {
            let angle = worst.clamp(-1.0, 1.0).acos().to_degrees();
            return Err(format!(
                "looks {angle:.0}° away from its middle, and a panel reaches 85°: split the region"
            ));
        }
        // To the right and up of the middle.
        let tangents = |ray: DVec3| {
            let far = ray.dot(axes.forward);
            [ray.dot(axes.right) / far, -ray.dot(axes.down) / far]
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for at in lit().map(tangents) {
            low = [0, 1].map(|k| low[k].min(at[k]));
            high = [0, 1].map(|k| high[k].max(at[k]));
        }
        // Pixels reach as far beyond their centres as their neighbours' are apart.
        let beyond = [0, 1].map(|k| {
            let steps = f64::from(size[k].max(2) - 1);
            0.5 * (high[k] - low[k]).max(1e-5) / steps
        });
        let low = [0, 1].map(|k| low[k] - beyond[k]);
        let high = [0, 1].map(|k| high[k] + beyond[k]);
        let share = |line: usize, column: usize| {
            let at = tangents(ray(line, column));
            [0, 1].map(|k| (at[k] - low[k]) / (high[k] - low[k]))
        };
        Ok(Self {
            yaw_pitch: [yaw, pitch],
            tangents: [-low[0], high[0], high[1], -low[1]],
            map: map_of(size, &share)?,
        })
    }

    /// The flat panel round all that its pixels look at.
    pub(super) fn around(&self) -> (PoseEntry, TangentsEntry) {
        let [yaw, pitch] = self.yaw_pitch.map(|it| Some(it.to_degrees()));
        let pose = PoseEntry {
            order: Some(PoseOrder::YawPitchRoll),
            roll: Some(0.0),
            pitch,
            yaw,
            quaternion: None,
        };
        let [left, right, up, down] = self.tangents;
        let tangents = TangentsEntry {
            left,
            right,
            up,
            down,
        };
        (pose, tangents)
    }
}
