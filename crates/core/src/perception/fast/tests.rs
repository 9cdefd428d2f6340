//! Does the fast path say what the clear one says?

use super::*;
use crate::perception::eye::Gaze;
use crate::perception::importance::NO_UNIT;
use crate::perception::measures::pyramid::{Pyramid, doubled, halved};
use crate::perception::parameters::{EyeState, Model};
use crate::units::Radians;
use crate::view::axes::{Axes, direction_from_yaw_pitch};
use crate::view::eye_view::Field;

/// Seeded noise of all octaves, each as strong as the next (natural) or white alone.
fn picture(size: [u32; 2], natural: bool) -> Vec<f64> {
    let mut seed = 3_u32;
    let mut noise = |size: [u32; 2]| -> Vec<f64> {
        (0..size[0] * size[1])
            .map(|_| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
            })
            .collect()
    };
    let mut sizes = vec![size];
    while natural && sizes[sizes.len() - 1][0] > 4 {
        sizes.push(half_size(sizes[sizes.len() - 1]));
    }
    let mut coarse = sizes[sizes.len() - 1];
    let mut sum = vec![0.0; (coarse[0] * coarse[1]) as usize];
    for &size in sizes.iter().rev() {
        let fine = if size == coarse {
            sum
        } else {
            doubled(&sum, coarse, size)
        };
        sum = fine
            .iter()
            .zip(noise(size))
            .map(|(a, b)| a + b * 60.0)
            .collect();
        coarse = size;
    }
    sum
}

/// Levels as 8-bit luma, the finest first.
fn levels(size: [u32; 2], natural: bool, count: usize) -> Vec<Vec<u8>> {
    let mut fine = picture(size, natural);
    (0..count)
        .map(|_| {
            let luma = fine
                .iter()
                .map(|v| (v + 128.0).clamp(0.0, 255.0) as u8)
                .collect();
            let (coarse, coarse_size) = halved(&fine, size);
            let (coarser, coarser_size) = halved(&coarse, coarse_size);
            fine = doubled(
                &doubled(&coarser, coarser_size, coarse_size),
                coarse_size,
                size,
            );
            luma
        })
        .collect()
}

fn onlooker(size: [u32; 2], fov_deg: f64, spread_deg: f64, state: EyeState) -> Onlooker {
    let degrees = Radians::from_degrees;
    Onlooker {
        view: EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::across(degrees(fov_deg), size),
            size,
            eye: Default::default(),
        },
        gaze: Gaze {
            direction: direction_from_yaw_pitch(degrees(fov_deg / 9.0), degrees(-1.3)),
            spread: degrees(spread_deg),
        },
        state,
    }
}

/// Largest difference of a unit's value, relative to the size of that unit's terms.
fn worst(parameters: &Parameters, onlooker: &Onlooker, luma: &[Vec<u8>], unit: u32) -> f64 {
    let [w, h] = onlooker.view.size;
    let columns = w.div_ceil(unit);
    let units = (columns * h.div_ceil(unit)) as usize;
    let ids: Vec<u32> = (0..w * h)
        .map(|i| {
            if i % 97 == 0 {
                NO_UNIT
            } else {
                i % w / unit + i / w / unit * columns
            }
        })
        .collect();
    let of = |luma: &Vec<u8>| Pyramid::of(parameters.luminance_from_luma(luma), [w, h]);
    let pyramids: Vec<Pyramid> = luma.iter().map(of).collect();
    let exact = onlooker.unit_gains(parameters, &pyramids, &ids, units);

    let weights = parameters.weights(onlooker.state);
    let steps = luma.len() - 1;
    let mut fast = FastImportance::new(parameters, &onlooker.view, luma.len());
    let pictures: Vec<&[u8]> = luma.iter().map(Vec::as_slice).collect();
    let mut run = |weights: &Weights| {
        let mut gains = vec![0.0; units * steps];
        fast.look(onlooker, weights);
        fast.unit_gains(&pictures, &ids, &mut gains);
        gains
    };
    let found = run(&weights);
    // Terms of both signs may cancel: errors are measured against their sizes.
    let scale = run(&Weights {
        popping: weights.popping.abs(),
        ..weights
    });
    let exact = exact.into_iter().flatten();
    exact
        .zip(found.into_iter().zip(scale))
        .map(|(exact, (found, scale))| (exact - found).abs() / scale)
        .fold(0.0, f64::max)
}

#[test]
fn units_are_worth_what_the_clear_version_says() {
    for (natural, size) in [(false, [150, 90]), (true, [264, 150])] {
        let luma = levels(size, natural, 3);
        for model in [Model::Paper, Model::Default] {
            let parameters = Parameters::of(model);
            // The clear version integrates over the spread at every texel: seconds for a large one.
            let spread = if natural { 0.0 } else { 1.5 };
            for state in [EyeState::Steady, EyeState::Landed] {
                let onlooker = onlooker(size, 8.0, spread, state);
                let worst = worst(&parameters, &onlooker, &luma, 32);
                assert!(
                    worst < 1e-3,
                    "{natural} {model:?} {spread} {state:?}: {worst}"
                );
            }
        }
    }
}

#[test]
fn units_are_worth_what_the_clear_version_says_in_a_saccade() {
    let size = [90, 70];
    let luma = levels(size, true, 2);
    for model in [Model::Paper, Model::Default] {
        let onlooker = onlooker(size, 9.0, 0.0, EyeState::Jumping);
        let worst = worst(&Parameters::of(model), &onlooker, &luma, 32);
        assert!(worst < 1e-3, "{model:?}: {worst}");
    }
}

#[test]
fn wide_views_and_odd_sizes_agree_as_well() {
    let size = [201, 133];
    let luma = levels(size, true, 2);
    let onlooker = onlooker(size, 95.0, 0.0, EyeState::Steady);
    let worst = worst(&Parameters::default(), &onlooker, &luma, 48);
    assert!(worst < 3e-3, "{worst}");
}

#[test]
fn maps_add_up_to_the_values_of_units() {
    let size = [96, 64];
    let luma = levels(size, true, 3);
    let parameters = Parameters::default();
    let onlooker = onlooker(size, 20.0, 0.0, EyeState::Steady);
    let mut fast = FastImportance::new(&parameters, &onlooker.view, 3);
    fast.look(&onlooker, &parameters.weights(onlooker.state));
    let pictures: Vec<&[u8]> = luma.iter().map(Vec::as_slice).collect();
    let mut maps = vec![vec![0.0; 96 * 64]; 2];
    fast.maps(&pictures, &mut maps);
    let mut gains = [0.0; 2];
    fast.unit_gains(&pictures, &[0; 96 * 64], &mut gains);
    for (map, gain) in maps.iter().zip(gains) {
        let sum: f64 = map.iter().map(|&v| f64::from(v)).sum();
        assert!((sum - gain).abs() < 1e-5 * gain.abs());
    }
}

#[test]
fn units_are_worth_the_same_bits_with_all_instructions() {
    let size = [203, 117];
    let luma = levels(size, true, 3);
    let pictures: Vec<&[u8]> = luma.iter().map(Vec::as_slice).collect();
    let ids: Vec<u32> = (0..203 * 117)
        .map(|i| i % 203 / 37 + i / 203 / 50 * 6)
        .collect();
    for model in [Model::Paper, Model::Default] {
        let parameters = Parameters::of(model);
        let onlooker = onlooker(size, 60.0, 0.0, EyeState::Steady);
        let bits = |instructions: Instructions| {
            let mut fast = FastImportance::new(&parameters, &onlooker.view, 3);
            fast.instructions = instructions;
            fast.look(&onlooker, &parameters.weights(onlooker.state));
            let mut gains = [0.0; 36];
            fast.unit_gains(&pictures, &ids, &mut gains);
            gains.map(f64::to_bits)
        };
        assert_eq!(bits(Instructions::widest()), bits(Instructions::least()));
    }
}

#[test]
fn bands_that_are_seen_around_the_gaze_alone_agree_as_well() {
    let size = [1100, 24];
    let luma = levels(size, true, 3);
    let parameters = Parameters::default();
    let onlooker = onlooker(size, 44.0, 0.0, EyeState::Steady);
    let mut fast = FastImportance::new(&parameters, &onlooker.view, 3);
    fast.look(&onlooker, &parameters.weights(onlooker.state));
    let seen = fast.seen_row(0, 12);
    assert!(0 < seen.start && seen.start < seen.end, "{seen:?}");
    let worst = worst(&parameters, &onlooker, &luma, 32);
    assert!(worst < 1e-3, "{worst}");
}
