//! Which text makes each shader?
//!
//! Files are joined in the order in which they need each other, after the constants of the metric:
//! no number is written twice.

use crate::score::constants as fit;
use foveal_render::shaders::ComputeShader;

const LEVEL: &str = include_str!("../../../shaders/level.wgsl");
const LUMINANCE: &str = include_str!("../../../shaders/luminance.wgsl");
const TEMPORAL: &str = include_str!("../../../shaders/temporal.wgsl");
const REDUCE: &str = include_str!("../../../shaders/reduce.wgsl");
const BAND: &str = include_str!("../../../shaders/band.wgsl");
const GATHER: &str = include_str!("../../../shaders/gather.wgsl");
const LOST: &str = include_str!("../../../shaders/lost.wgsl");

/// The passes in their order.
#[must_use]
pub fn score_shaders() -> [ComputeShader; 6] {
    let shader = |name, text: &str| ComputeShader {
        name,
        text: [&constants(), LEVEL, text].join("\n"),
    };
    [
        shader("luminance", LUMINANCE),
        shader("temporal", TEMPORAL),
        shader("reduce", REDUCE),
        shader("band", BAND),
        shader("gather", GATHER),
        shader("lost", LOST),
    ]
}

fn constants() -> String {
    let number = |(name, value): (&str, f64)| format!("const {name}: f32 = {value:?};\n");
    let numbers = [
        ("MASKING", fit::MASKING),
        ("DIFFERENCE_EXPONENT", fit::DIFFERENCE_EXPONENT),
        ("SPACE_EXPONENT", fit::SPACE_EXPONENT),
        ("MOST_DIFFERENCE_LOG2", fit::MOST_DIFFERENCE.log2()),
        ("LEAST_ADAPTATION", fit::LEAST_ADAPTATION),
        ("MOST_CONTRAST", fit::MOST_CONTRAST),
        ("SENSITIVITY_FACTOR", fit::SENSITIVITY_FACTOR),
        ("TRANSIENT_WEIGHT", fit::CHANNEL_WEIGHTS[1]),
        ("JOD_SCALE", fit::JOD_SCALE),
        ("JOD_EXPONENT", fit::JOD_EXPONENT),
    ];
    let [sustained, transient] = fit::MASKING_EXPONENTS;
    let numbers: String = numbers.into_iter().map(number).collect();
    format!("{numbers}const MASKING_EXPONENTS = vec2<f32>({sustained:?}, {transient:?});\n")
}
