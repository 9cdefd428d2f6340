//! How long does a decision take to weigh, against the same formula through Fourier transforms?

use crate::fft_importance::FftImportance;
use crate::timing::{TimedRow, timed};
use foveal_core::perception::fast::FastImportance;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::measures::pyramid::{doubled, half_size, halved};
use foveal_core::perception::parameters::Parameters;
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use serde::Serialize;

/// Level pictures of one decision.
pub const LEVELS: usize = 5;
/// Pixels of a unit's side.
const UNIT: u32 = 64;

/// Importance by both ways, on the same pictures, one after the other.
#[derive(Clone, Debug, Serialize)]
pub struct ImportanceTimes {
    /// Columns and rows of the pictures.
    pub size_px: [u32; 2],
    /// Level pictures.
    pub levels: usize,
    /// Units that values are added up for.
    pub units: usize,
    /// The pyramid, then the Fourier transforms.
    pub rows: Vec<TimedRow>,
    /// How many times longer the Fourier transforms take.
    pub ratio: f64,
}

/// What a decision is made about: level pictures, units and an onlooker.
pub struct Decision {
    /// 8-bit luma, the finest first.
    pub luma: Vec<Vec<u8>>,
    /// Unit of every pixel.
    pub unit_ids: Vec<u32>,
    /// Number of units.
    pub units: usize,
    /// Who looks.
    pub onlooker: Onlooker,
}

impl Decision {
    /// Natural-like noise (every octave as strong as the next) of `size`, each level with half the
    /// detail of the one before, seen on a desk screen (48° across).
    #[must_use]
    pub fn generated(size: [u32; 2]) -> Self {
        let mut fine = natural_noise(size);
        let luma = (0..LEVELS).map(|level| {
            if level > 0 {
                fine = without_finest(natural_noise(size), size, level);
            }
            fine.iter()
                .map(|v| (v + 128.0).clamp(0.0, 255.0) as u8)
                .collect()
        });
        let luma = luma.collect();
        let columns = size[0].div_ceil(UNIT);
        let view = EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::across(Radians::from_degrees(48.0), size),
            size,
            eye: Default::default(),
        };
        Self {
            luma,
            unit_ids: (0..size[0] * size[1])
                .map(|i| i % size[0] / UNIT + i / size[0] / UNIT * columns)
                .collect(),
            units: (columns * size[1].div_ceil(UNIT)) as usize,
            onlooker: Onlooker::at_rest(&view),
        }
    }

    /// The level pictures as slices.
    #[must_use]
    pub fn pictures(&self) -> Vec<&[u8]> {
        self.luma.iter().map(Vec::as_slice).collect()
    }
}

fn natural_noise(size: [u32; 2]) -> Vec<f64> {
    let mut seed = 3_u32;
    let mut sizes = vec![size];
    while sizes[sizes.len() - 1][0] > 4 {
        sizes.push(half_size(sizes[sizes.len() - 1]));
    }
    let mut coarse = sizes[sizes.len() - 1];
    let mut sum = vec![0.0; (coarse[0] * coarse[1]) as usize];
    for &size in sizes.iter().rev() {
        sum = doubled(&sum, coarse, size);
        for value in &mut sum {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *value += (f64::from(seed >> 8) / f64::from(1 << 24) - 0.5) * 60.0;
        }
        coarse = size;
    }
    sum
}

fn without_finest(mut picture: Vec<f64>, size: [u32; 2], octaves: usize) -> Vec<f64> {
    let mut sizes = vec![size];
    for _ in 0..octaves {
        let (coarse, coarse_size) = halved(&picture, sizes[sizes.len() - 1]);
        picture = coarse;
        sizes.push(coarse_size);
    }
    for pair in sizes.windows(2).rev() {
        picture = doubled(&picture, pair[1], pair[0]);
    }
    picture
}

/// Times a decision at `size`, `runs` times each way, on the calling thread.
#[must_use]
pub fn time_importance(size: [u32; 2], runs: usize) -> ImportanceTimes {
    let decision = Decision::generated(size);
    let (parameters, onlooker) = (Parameters::default(), decision.onlooker);
    let weights = parameters.weights(onlooker.state);
    let pictures = decision.pictures();
    let mut gains = vec![0.0; decision.units * (LEVELS - 1)];

    let mut fast = FastImportance::new(&parameters, &onlooker.view, LEVELS);
    let pyramid = timed("pyramid, f32, one thread", runs, || {
        fast.look(&onlooker, &weights);
        fast.unit_gains(&pictures, &decision.unit_ids, &mut gains);
    });
    // The transforms get the eye's sensitivities for nothing.
    let mut fft = FftImportance::new(&parameters, &onlooker.view, LEVELS);
    fft.look(&onlooker, &weights);
    let fourier = timed("Fourier transforms, f32, one thread", runs, || {
        fft.unit_gains(&pictures, &decision.unit_ids, &mut gains);
    });
    ImportanceTimes {
        size_px: size,
        levels: LEVELS,
        units: decision.units,
        ratio: fourier.median_ms / pyramid.median_ms,
        rows: vec![pyramid, fourier],
    }
}
