//! A small cloud on a ball, in two units.

use super::Seeded;
use super::torus::object;
use foveal_core::content::payload::PayloadView;
use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::points::payload::{CloudPoint, PointAttributes, PointUnit};
use foveal_core::content::scene::description::{SceneObject, Shape};
use foveal_core::pack::unit::UnitId;
use foveal_render::Coming;

/// The root of the cloud.
pub const ROOT: UnitId = UnitId(10);
/// The unit that refines it.
pub const FINE: UnitId = UnitId(11);
/// The octant of the root that the finer unit refines: farther along each axis.
pub const OCTANT: u8 = 7;

/// A cloud two metres wide, with its middle at the origin.
pub fn cloud() -> SceneObject {
    let attributes = PointAttributes {
        colours: true,
        ..PointAttributes::default()
    };
    SceneObject {
        two_sided: true,
        unlit: true,
        shape: Shape::Cloud(Cloud {
            scale: [2.0 / 4096.0; 3],
            offset: [-1.0; 3],
            attributes,
            ..Cloud::default()
        }),
        ..object(Default::default())
    }
}

/// Points on a ball of 2^12 places, in a cube of it.
fn ball(corner: [u32; 3], bits: u8, cells: u8, count: usize) -> PointUnit {
    let mut random = Seeded(7);
    let mut unit = PointUnit {
        corner,
        bits,
        cells,
        ..PointUnit::default()
    };
    while unit.points.len() < count {
        let mut any = || f64::from(random.below(20_001)) / 10_000.0 - 1.0;
        let at = glam::DVec3::new(any(), any(), any()).normalize_or_zero();
        let place = (at * 1900.0 + 2048.0).to_array().map(|it| it as u32);
        let point = CloudPoint {
            place,
            colour: place.map(|it| (it / 16) as u16),
            ..CloudPoint::default()
        };
        if unit.has_inside(place) {
            unit.points.push(point);
        }
    }
    unit
}

/// The root, and a unit that refines an octant of it.
pub fn units() -> [PointUnit; 2] {
    let root = ball([0; 3], 12, 5, 900);
    let mut fine = ball([2048; 3], 11, 6, 1500);
    let inside = root.points.iter().filter(|it| fine.has_inside(it.place));
    fine.corrections = vec![[0, 3, -2]; inside.count()];
    [root, fine]
}

pub fn coming<'a>(unit: UnitId, payload: &'a PointUnit, object: u16) -> Coming<'a> {
    Coming {
        unit,
        object,
        level: u8::from(unit == ROOT),
        needs: if unit == FINE { &[ROOT] } else { &[] },
        part: (unit == FINE).then_some(OCTANT),
        payload: PayloadView::Points(payload),
    }
}
