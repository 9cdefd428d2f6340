//! What do any bytes say, read as a unit of points? Also the body of a fuzz target.

use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::points::cut::PointCut;
use foveal_core::content::points::payload::{MOST_POINTS, PointAttributes, PointUnit};
use foveal_core::pack::unit::UnitId;

/// Reads bytes as a unit of every kind of cloud, and stands it where it can stand alone.
pub(crate) fn parse_anything(data: &[u8]) {
    for number in 0..8 {
        let attributes = PointAttributes {
            colours: number & 1 != 0,
            intensities: number & 2 != 0,
            classes: number & 4 != 0,
        };
        let Ok(unit) = PointUnit::parse(data, attributes) else {
            continue;
        };
        assert!(unit.points.len().max(unit.corrections.len()) <= MOST_POINTS);
        assert!(unit.points.iter().all(|it| unit.has_inside(it.place)));
        // In another order of the points, maybe, and with shorter codes.
        let mut again = unit.clone();
        let written = again
            .write(attributes)
            .expect("what was read can be written");
        let read = PointUnit::parse(&written, attributes).expect("what was written can be read");
        assert_eq!(read, again);
        let sorted = |mut unit: PointUnit| {
            unit.points.sort_unstable();
            unit
        };
        assert_eq!(sorted(again), sorted(unit.clone()));
        let cloud = Cloud {
            attributes,
            ..Cloud::default()
        };
        let mut cut = PointCut::default();
        let alone = cut.insert(UnitId(0), None, &unit, &cloud);
        assert_eq!(alone.is_ok(), unit.corrections.is_empty());
    }
}
