//! Does the GPU find the value that the twin in double precision finds?

use crate::common::levels::{Content, levels, scattered};
use crate::common::{difference, read_png, turned, write_png};
use foveal_core::perception::eye::Gaze;
use foveal_core::perception::importance::{Onlooker, sums_per_unit};
use foveal_core::perception::measures::pyramid::Pyramid;
use foveal_core::perception::parameters::{EyeState, Model, Parameters};
use foveal_core::units::Radians;
use foveal_core::view::axes::direction_from_yaw_pitch;
use foveal_render::importance::{Importance, UnitIds, upload_picture};
use foveal_render::{Gpu, RenderError, RgbaImage};

const MODELS: [Model; 2] = [Model::Paper, Model::Default];
const STATES: [EyeState; 3] = [EyeState::Steady, EyeState::Landed, EyeState::Jumping];

fn onlooker(size: [u32; 2], state: EyeState, spread_deg: f64) -> Onlooker {
    let degrees = Radians::from_degrees;
    let across = 50.0 * f64::from(size[0]) / f64::from(size[0].max(size[1]));
    Onlooker {
        view: turned([20.0, -15.0, 10.0], across, size),
        gaze: Gaze {
            direction: direction_from_yaw_pitch(degrees(24.0), degrees(-10.0)),
            spread: degrees(spread_deg),
        },
        state,
    }
}

/// Level pictures and units, on both sides.
struct Case {
    pictures: Vec<wgpu::Texture>,
    images: Vec<RgbaImage>,
    ids: Vec<u32>,
    unit_ids: UnitIds,
}

impl Case {
    fn new(gpu: &Gpu, images: Vec<RgbaImage>, (ids, units): (Vec<u32>, usize)) -> Self {
        Self {
            pictures: images
                .iter()
                .map(|image| upload_picture(gpu, image).unwrap())
                .collect(),
            unit_ids: UnitIds::upload(gpu, images[0].size, &ids, units).unwrap(),
            images,
            ids,
        }
    }

    fn found(&self, importance: &mut Importance, onlooker: &Onlooker) -> Vec<Vec<f64>> {
        let levels: Vec<_> = self.pictures.iter().collect();
        let found = importance.run(&levels, &self.unit_ids, onlooker);
        found.unwrap().per_step
    }

    /// What the twin finds; without what popping takes away where only the gained is asked for.
    fn expected(
        &self,
        parameters: &Parameters,
        onlooker: &Onlooker,
        gained: bool,
    ) -> Vec<Vec<f64>> {
        let pyramids: Vec<Pyramid> = self.images.iter().map(|i| pyramid(parameters, i)).collect();
        let mut weights = parameters.weights(onlooker.state);
        if gained {
            weights.popping = weights.popping.max(0.0);
        }
        let steps = pyramids.windows(2).map(|pair| {
            let map = onlooker.step_map(parameters, &weights, &pair[1], &pair[0]);
            sums_per_unit(&map, &self.ids, self.unit_ids.units)
        });
        steps.collect()
    }
}

fn pyramid(parameters: &Parameters, image: &RgbaImage) -> Pyramid {
    let rgb: Vec<[u8; 3]> = image
        .pixels
        .chunks_exact(4)
        .map(|p| [p[0], p[1], p[2]])
        .collect();
    Pyramid::of(parameters.luminance_from_rgb(&rgb), image.size)
}

/// Within 1e-3 of every unit's value. A value that terms of both signs all but cancel is held to
/// 5e-5 of what the terms add up to.
fn assert_alike(case: &Case, parameters: &Parameters, onlooker: &Onlooker, found: &[Vec<f64>]) {
    let expected = case.expected(parameters, onlooker, false);
    let gained = std::cell::OnceCell::new();
    let what = format!("{:?} {onlooker:?}", parameters.model);
    let (mut worst, mut cancelled) = (0.0, 0);
    assert_eq!(found.len(), expected.len());
    for (step, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert_eq!(found.len(), expected.len());
        for (unit, (f, e)) in found.iter().zip(expected).enumerate() {
            let apart = (f - e).abs();
            if apart <= 1e-3 * e.abs() {
                worst = f64::max(worst, apart / e.abs().max(f64::MIN_POSITIVE));
                continue;
            }
            let gained = gained.get_or_init(|| case.expected(parameters, onlooker, true));
            let terms = 2.0 * gained[step][unit] - e;
            assert!(
                apart <= 5e-5 * terms,
                "{what} {step} {unit}: {f} {e} of {terms}"
            );
            cancelled += 1;
        }
    }
    println!("{what}: worst {worst:.1e}, cancelled {cancelled}");
}

fn assert_twins(content: Content, size: [u32; 2], count: usize, side: u32, states: &[EyeState]) {
    let gpu = Gpu::open_blocking().unwrap();
    let case = Case::new(&gpu, levels(content, size, count), scattered(size, side));
    for model in MODELS {
        let parameters = Parameters::of(model);
        let mut importance = Importance::new(&gpu, size, &parameters).unwrap();
        for &state in states {
            let onlooker = onlooker(size, state, 0.0);
            let found = case.found(&mut importance, &onlooker);
            assert_alike(&case, &parameters, &onlooker, &found);
        }
    }
}

#[test]
fn noise_is_worth_on_the_gpu_what_it_is_worth_to_the_twin() {
    assert_twins(Content::Random, [37, 53], 4, 3, &STATES);
    assert_twins(Content::Random, [256, 144], 3, 16, &[EyeState::Steady]);
}

#[test]
fn natural_contrast_is_worth_on_the_gpu_what_it_is_worth_to_the_twin() {
    assert_twins(Content::Natural, [37, 53], 4, 3, &STATES);
    assert_twins(Content::Natural, [256, 144], 3, 16, &STATES);
}

#[test]
fn a_checker_is_worth_on_the_gpu_what_it_is_worth_to_the_twin() {
    assert_twins(Content::Checker, [37, 53], 3, 2, &STATES);
    assert_twins(Content::Checker, [256, 144], 3, 16, &[EyeState::Landed]);
}

#[test]
fn pictures_of_every_small_size_are_judged() {
    for size in [[1, 1], [3, 9], [4, 4], [5, 130], [65, 8]] {
        assert_twins(Content::Random, size, 2, 2, &[EyeState::Landed]);
    }
}

#[test]
fn a_spread_gaze_a_dull_display_and_a_gaze_on_a_pixel_are_taken_in() {
    let (gpu, size) = (Gpu::open_blocking().unwrap(), [61, 37]);
    let case = Case::new(&gpu, levels(Content::Natural, size, 3), scattered(size, 4));
    for model in MODELS {
        let mut parameters = Parameters::of(model);
        for (name, value) in [("display_cpd", 1.1), ("omega", 3.0), ("lambda", 0.5)] {
            parameters.set(name, value).unwrap();
        }
        let mut importance = Importance::new(&gpu, size, &parameters).unwrap();
        for spread_deg in [0.3, 7.0, 0.0] {
            let mut onlooker = onlooker(size, EyeState::Steady, spread_deg);
            // The middle of an odd picture is the middle of a pixel.
            onlooker.gaze.direction = onlooker.view.axes.forward;
            let found = case.found(&mut importance, &onlooker);
            assert_alike(&case, &parameters, &onlooker, &found);
        }
    }
}

#[test]
fn a_second_run_gives_the_same_bits() {
    let (gpu, size) = (Gpu::open_blocking().unwrap(), [256, 144]);
    // One unit takes additions from the whole picture, in whatever order they come.
    let case = Case::new(&gpu, levels(Content::Random, size, 5), scattered(size, 200));
    for model in MODELS {
        let parameters = Parameters::of(model);
        let mut importance = Importance::new(&gpu, size, &parameters).unwrap();
        let mut run = |state| case.found(&mut importance, &onlooker(size, state, 1.0));
        let first = STATES.map(&mut run);
        for _ in 0..5 {
            assert_eq!(STATES.map(&mut run), first);
        }
        assert_eq!(first[0].len(), 4);
    }
}

#[test]
fn units_without_pixels_are_worth_nothing_and_plain_pictures_change_nothing() {
    let (gpu, size) = (Gpu::open_blocking().unwrap(), [40, 30]);
    let plain = RgbaImage {
        size,
        pixels: [90, 140, 200, 255].repeat(1200),
    };
    let (ids, units) = scattered(size, 8);
    let case = Case::new(&gpu, vec![plain.clone(), plain], (ids, units + 3));
    let mut importance = Importance::new(&gpu, size, &Parameters::default()).unwrap();
    let found = case.found(&mut importance, &onlooker(size, EyeState::Steady, 0.0));
    assert_eq!(found, [vec![0.0; units + 3]]);
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let (gpu, size) = (Gpu::open_blocking().unwrap(), [16, 12]);
    let images = levels(Content::Random, size, 2);
    let mut importance = Importance::new(&gpu, size, &Parameters::default()).unwrap();
    let onlooker = onlooker(size, EyeState::Steady, 0.0);
    let stray = Case::new(&gpu, images.clone(), (vec![5; 192], 5));
    let levels: Vec<_> = stray.pictures.iter().collect();
    let error = importance.run(&levels, &stray.unit_ids, &onlooker);
    assert!(matches!(
        error,
        Err(RenderError::StrayUnits { units: 5, .. })
    ));
    let other = upload_picture(&gpu, &RgbaImage::black([16, 11])).unwrap();
    let error = importance.run(&[levels[0], &other], &stray.unit_ids, &onlooker);
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("level 1") && error.contains("16 x 11"),
        "{error}"
    );
    let mut wide = onlooker;
    wide.view.size = [17, 12];
    let error = importance.run(&levels, &stray.unit_ids, &wide).unwrap_err();
    assert!(error.to_string().contains("view"), "{error}");
    assert!(UnitIds::upload(&gpu, size, &[0; 191], 1).is_err());
}

/// The value of every pixel as a grey of its own, from none to `most`.
fn value_picture(size: [u32; 2], values: &[f64], most: f64) -> RgbaImage {
    let grey = |value: &f64| {
        let code = (value / most).clamp(0.0, 1.0).sqrt() * 255.0 + 0.5;
        [code as u8, code as u8, code as u8, 255]
    };
    RgbaImage {
        size,
        pixels: values.iter().flat_map(grey).collect(),
    }
}

/// Every pixel a unit: the sums are the map of values. `FOVEAL_BLESS=1` rewrites the pictures.
#[test]
fn the_map_of_values_is_still_what_a_person_has_looked_at() {
    let (gpu, size) = (Gpu::open_blocking().unwrap(), [96, 72]);
    let every_pixel = (
        (0..size[0] * size[1]).collect(),
        (size[0] * size[1]) as usize,
    );
    let case = Case::new(&gpu, levels(Content::Natural, size, 3), every_pixel);
    for (name, model, state, most) in [
        ("value_steady", Model::Default, EyeState::Steady, 120.0),
        ("value_jumping", Model::Paper, EyeState::Jumping, 6.5),
    ] {
        let mut importance = Importance::new(&gpu, size, &Parameters::of(model)).unwrap();
        let found = case.found(&mut importance, &onlooker(size, state, 0.0));
        println!(
            "{name}: most {:?}",
            found[0].iter().copied().fold(0.0, f64::max)
        );
        let picture = value_picture(size, &found[0], most);
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
        let path = folder.join(format!("{name}.png"));
        if std::env::var("FOVEAL_BLESS").is_ok_and(|v| v == "1") {
            write_png(&path, &picture);
        }
        let (worst, _) = difference(&picture, &read_png(&path));
        assert!(
            worst <= 2,
            "{name} differs by {worst}; look at it, then bless it"
        );
    }
}
