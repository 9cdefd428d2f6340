//! Does the value of a step follow what is known of eyes?

use super::*;
use crate::perception::parameters::Model;
use crate::units::Radians;
use crate::view::axes::{Axes, direction_from_yaw_pitch};
use crate::view::eye_view::Field;

const SIZE: [u32; 2] = [72, 50];
const MODELS: [Model; 2] = [Model::Paper, Model::Default];
const STATES: [EyeState; 3] = [EyeState::Steady, EyeState::Landed, EyeState::Jumping];

fn onlooker(yaw_deg: f64, state: EyeState) -> Onlooker {
    let degrees = Radians::from_degrees;
    Onlooker {
        view: EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::across(degrees(40.0), SIZE),
            size: SIZE,
            eye: Default::default(),
        },
        gaze: Gaze {
            direction: direction_from_yaw_pitch(degrees(yaw_deg), Radians(0.0)),
            spread: Radians(0.0),
        },
        state,
    }
}

/// Seeded noise, blurred `octaves` times, so that levels look like levels.
fn level(octaves: u32) -> Pyramid {
    let mut seed = 7_u32;
    let mut luminance: Vec<f64> = (0..SIZE[0] * SIZE[1])
        .map(|_| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            5.0 + 90.0 * f64::from(seed >> 8) / f64::from(1 << 24)
        })
        .collect();
    let mut chain = vec![SIZE];
    for _ in 0..octaves {
        let (coarse, size) =
            crate::perception::measures::pyramid::halved(&luminance, chain[chain.len() - 1]);
        luminance = coarse;
        chain.push(size);
    }
    for pair in chain.windows(2).rev() {
        luminance = doubled(&luminance, pair[1], pair[0]);
    }
    Pyramid::of(luminance, SIZE)
}

fn value(model: Model, onlooker: &Onlooker, before: &Pyramid, after: &Pyramid) -> Vec<f64> {
    let parameters = Parameters::of(model);
    onlooker.step_map(
        &parameters,
        &parameters.weights(onlooker.state),
        before,
        after,
    )
}

#[test]
fn identical_pictures_do_not_pop() {
    let picture = level(1);
    for state in STATES {
        let onlooker = onlooker(3.0, state);
        let popping = Weights {
            popping: 1.0,
            ..Weights::default()
        };
        let parameters = Parameters::default();
        let map = onlooker.step_map(&parameters, &popping, &picture, &picture);
        assert!(map.iter().all(|&p| p == 0.0));
        assert!(
            value(Model::Default, &onlooker, &picture, &picture)
                .iter()
                .all(|&v| v == 0.0)
        );
    }
}

#[test]
fn the_map_of_a_saccade_does_not_depend_on_the_gaze() {
    let (coarse, fine) = (level(2), level(1));
    for model in MODELS {
        let at = |yaw| value(model, &onlooker(yaw, EyeState::Jumping), &coarse, &fine);
        assert_eq!(at(0.0), at(15.0));
        let at = |yaw| value(model, &onlooker(yaw, EyeState::Steady), &coarse, &fine);
        assert_ne!(at(0.0), at(15.0));
    }
}

#[test]
fn several_steps_are_worth_the_sum_of_the_single_ones() {
    let levels = [level(0), level(1), level(2)];
    let ids: Vec<u32> = (0..SIZE[0] * SIZE[1]).map(|i| i % SIZE[0] / 24).collect();
    for (model, state) in MODELS.into_iter().flat_map(|m| STATES.map(|s| (m, s))) {
        let parameters = Parameters::of(model);
        let onlooker = onlooker(-6.0, state);
        let gains = onlooker.unit_gains(&parameters, &levels, &ids, 3);
        let first = value(model, &onlooker, &levels[1], &levels[0]);
        let second = value(model, &onlooker, &levels[2], &levels[1]);
        let both: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a + b).collect();
        for (unit, sum) in sums_per_unit(&both, &ids, 3).into_iter().enumerate() {
            let steps = gains[0][unit] + gains[1][unit];
            assert!(
                (sum - steps).abs() < 1e-9 * sum.abs(),
                "{model:?} {state:?}"
            );
        }
    }
}

#[test]
fn pixels_of_no_unit_count_for_nobody() {
    let values = [1.0, 2.0, 4.0, 8.0];
    assert_eq!(
        sums_per_unit(&values, &[0, NO_UNIT, 2, 0], 3),
        [9.0, 0.0, 4.0]
    );
}

#[test]
fn a_pixel_at_the_gaze_is_worth_most_and_value_falls_away_from_it() {
    // The same fine grating everywhere: only the eye differs.
    let grating = |contrast: f64| {
        let pixels = 0..SIZE[0] * SIZE[1];
        let luminance =
            pixels.map(|i| 40.0 * (1.0 + contrast * [1.0, 1.0, -1.0, -1.0][i as usize % 4]));
        Pyramid::of(luminance.collect(), SIZE)
    };
    let mut onlooker = onlooker(0.0, EyeState::Steady);
    onlooker.view.field = Field::across(Radians::from_degrees(12.0), SIZE);
    let map = value(Model::Default, &onlooker, &grating(0.0), &grating(0.3));
    let row = &map[25 * 72..][..72];
    let block = |first: usize| row[first..first + 8].iter().sum::<f64>();
    assert!(block(32) > block(44) && block(44) > block(56));
    assert!(block(56) > 0.0);
}

#[test]
fn popping_needs_less_change_on_a_plain_ground_than_on_a_busy_one() {
    let grating = |contrast: f64| {
        let pixels = 0..SIZE[0] * SIZE[1];
        let luminance =
            pixels.map(|i| 40.0 * (1.0 + contrast * [1.0, 1.0, -1.0, -1.0][i as usize % 4]));
        Pyramid::of(luminance.collect(), SIZE)
    };
    let popping = Weights {
        popping: 1.0,
        ..Weights::default()
    };
    let onlooker = onlooker(0.0, EyeState::Steady);
    for model in MODELS {
        let sum = |before, after| {
            let pictures = (grating(before), grating(after));
            let parameters = Parameters::of(model);
            let map = onlooker.step_map(&parameters, &popping, &pictures.0, &pictures.1);
            map.iter().sum::<f64>()
        };
        assert!(sum(0.0, 0.2) > sum(0.2, 0.4) && sum(0.2, 0.4) > sum(0.4, 0.6));
    }
}

#[test]
fn pixels_are_denser_per_degree_towards_the_border_and_fill_the_view() {
    let onlooker = onlooker(0.0, EyeState::Steady);
    let ppd = |x, y| onlooker.spot([x, y]).ppd.0;
    assert!(ppd(0.5, 25.0) > ppd(36.0, 25.0));
    let mut square_degrees = 0.0;
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let ppd = ppd(f64::from(x) + 0.5, f64::from(y) + 0.5);
            square_degrees += 1.0 / (ppd * ppd);
        }
    }
    // Solid angle of a rectangle: 4 asin(ab / sqrt((1 + a²)(1 + b²))).
    let (a, b) = (onlooker.view.field.right, onlooker.view.field.up);
    let exact = 4.0 * libm::asin(a * b / ((1.0 + a * a) * (1.0 + b * b)).sqrt());
    let exact = exact * (180.0 / core::f64::consts::PI) * (180.0 / core::f64::consts::PI);
    assert!((square_degrees / exact - 1.0).abs() < 1e-4);
}
