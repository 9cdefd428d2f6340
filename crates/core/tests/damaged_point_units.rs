//! Does a unit of points that is damaged do harm?

use crate::point_units;
use foveal_core::content::points::payload::{CloudPoint, PointAttributes, PointUnit};
use foveal_core::view::random::Random;

const ALL: PointAttributes = PointAttributes {
    colours: true,
    intensities: true,
    classes: true,
};

fn unit(count: usize) -> Vec<u8> {
    let mut random = Random::new(4);
    let mut point = || CloudPoint {
        place: [0; 3].map(|_| 100 + (random.unit() * 4096.0) as u32),
        colour: [0; 3].map(|_| (random.unit() * 256.0) as u16),
        intensity: (random.unit() * 9.0) as u16,
        class: 2,
    };
    let mut unit = PointUnit {
        corner: [100; 3],
        bits: 12,
        cells: 5,
        points: (0..count).map(|_| point()).collect(),
        corrections: vec![[1, 2, -3]; count / 4],
    };
    unit.write(ALL).unwrap()
}

#[test]
fn no_flipped_and_no_missing_byte_panics_or_shows_what_was_not_sent() {
    let mut random = Random::new(6);
    for count in [0, 1, 40] {
        let good = unit(count);
        point_units::parse_anything(&good);
        for at in 0..good.len() {
            point_units::parse_anything(&good[..at]);
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[at] ^= 1 << bit;
                point_units::parse_anything(&bad);
            }
        }
        for _ in 0..3000 {
            let mut bad = good.clone();
            for _ in 0..4 {
                let at = (random.unit() * bad.len() as f64) as usize;
                bad[at] = (random.unit() * 256.0) as u8;
            }
            point_units::parse_anything(&bad);
        }
    }
}
