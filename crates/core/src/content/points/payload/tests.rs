//! Do units of points come back as they were written?

use super::*;
use crate::view::random::Random;

const ALL: PointAttributes = PointAttributes {
    colours: true,
    intensities: true,
    classes: true,
};

/// Points on a bent surface, in a cube of these bits.
fn unit(bits: u8, count: usize) -> PointUnit {
    let mut random = Random::new(5);
    let corner = [7, 1 << 20, 0];
    let side = 2_f64.powi(i32::from(bits)) - 1.0;
    let mut point = || {
        let [u, v, w] = [0; 3].map(|_| random.unit());
        let height = 0.5 + 0.4 * (5.0 * u).sin() * v + 0.01 * w;
        let at = [u, v, height].map(|it| it * side);
        CloudPoint {
            place: [0, 1, 2].map(|k| corner[k] + at[k] as u32),
            colour: [200.0 * u, 255.0 * v, 90.0 + 20.0 * w].map(|it| it as u16),
            intensity: (60_000.0 * w) as u16,
            class: (3.0 * u) as u8,
        }
    };
    PointUnit {
        corner,
        bits,
        cells: 6,
        points: (0..count).map(|_| point()).collect(),
        corrections: vec![[1, -2, 3], [-70_000, 0, 5]],
    }
}

fn sorted(points: &[CloudPoint]) -> Vec<CloudPoint> {
    let mut points = points.to_vec();
    points.sort_unstable();
    points
}

#[test]
fn a_unit_comes_back_as_it_was_written() {
    for bits in [12, 0, 31, 21, 22, 3] {
        for count in [0, 1, 2, 700] {
            let mut unit = unit(bits, count);
            let before = sorted(&unit.points);
            let bytes = unit.write(ALL).unwrap();
            assert_eq!(PointUnit::parse(&bytes, ALL).unwrap(), unit, "{bits:?}");
            assert_eq!(sorted(&unit.points), before);
        }
    }
}

#[test]
fn any_order_of_the_points_gives_the_same_bytes() {
    let mut straight = unit(12, 300);
    let mut reversed = straight.clone();
    reversed.points.reverse();
    assert_eq!(straight.write(ALL).unwrap(), reversed.write(ALL).unwrap());
}

#[test]
fn what_is_the_same_for_all_points_takes_no_bytes() {
    let bare = PointAttributes {
        colours: true,
        ..PointAttributes::default()
    };
    let mut unit = unit(12, 4000);
    for point in &mut unit.points {
        (point.intensity, point.class) = (0, 0);
    }
    let all = unit.write(ALL).unwrap().len();
    assert!(all <= unit.write(bare).unwrap().len() + 6, "{all}");
}

#[test]
fn a_thousand_points_on_a_flat_ground_take_few_bits() {
    let mut random = Random::new(1);
    let mut any = |most: f64| (random.unit() * most) as u32;
    let points = (0..8000).map(|_| CloudPoint {
        place: [any(8192.0), any(8192.0), 4000 + any(8.0)],
        ..CloudPoint::default()
    });
    let mut unit = PointUnit {
        bits: 13,
        points: points.collect(),
        ..PointUnit::default()
    };
    let bytes = unit.write(PointAttributes::default()).unwrap().len();
    // Cells of 2^13 places for each, whose order need not be stored, and three bits of height.
    assert!(bytes * 8 < 8000 * 19, "{} bits", bytes * 8 / 8000);
}

#[test]
fn points_beside_the_cube_are_not_written() {
    let mut beside = unit(12, 9);
    beside.points[4].place[1] += 4096;
    assert!(beside.write(ALL).is_err());
    let mut beyond = unit(12, 0);
    beyond.corner[0] = u32::MAX;
    assert!(beyond.write(ALL).is_err());
}

#[test]
fn no_bytes_panic_and_what_is_read_lies_in_its_cube() {
    let mut random = Random::new(8);
    for bits in [12, 31] {
        let bytes = unit(bits, 90).write(ALL).unwrap();
        for at in 0..bytes.len() {
            let _ = PointUnit::parse(&bytes[..at], ALL);
            for _ in 0..4 {
                let mut bad = bytes.clone();
                bad[at] ^= 1 + (random.unit() * 255.0) as u8;
                if let Ok(read) = PointUnit::parse(&bad, ALL) {
                    assert!(read.points.iter().all(|it| read.has_inside(it.place)));
                }
            }
        }
    }
}

#[test]
fn a_small_unit_is_the_vector_of_the_documents() {
    let point = |place, colour| CloudPoint {
        place,
        colour,
        ..CloudPoint::default()
    };
    let mut unit = PointUnit {
        corner: [8, 0, 8],
        bits: 3,
        cells: 1,
        points: vec![
            point([9, 3, 15], [50, 10, 20]),
            point([10, 1, 8], [60, 12, 24]),
            point([15, 7, 9], [40, 8, 16]),
        ],
        corrections: vec![[-150, 0, 1]],
    };
    let colours = PointAttributes {
        colours: true,
        ..PointAttributes::default()
    };
    let bytes = unit.write(colours).unwrap();
    let hex: String = bytes.iter().map(|it| format!("{it:02x}")).collect();
    let documents = include_str!("../../../../../../docs/formats/pack.md");
    let told: String = documents.split_whitespace().collect();
    assert!(told.contains(&hex), "{hex}");
    assert_eq!(unit.points[0].place, [10, 1, 8]);
}
