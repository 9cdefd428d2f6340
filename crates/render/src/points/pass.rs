//! How are points drawn?

use crate::gpu::device::Gpu;
use crate::scene::corner_pass::{Bindings, CornerPass};
use crate::scene::phase::Phase;
use crate::shaders::{Shader, of_units};

/// View, cubes, blocks, points, and the view's pixels.
const BINDINGS: Bindings = &[(0, true), (3, false), (4, false), (5, false), (6, true)];

/// The pass that draws points of clouds: their colours, or which units would refine them.
#[must_use]
pub fn draw_points() -> Shader {
    let steps = &[
        ["place_splat", "draw_points"],
        ["place_splat", "draw_point_refiners"],
    ];
    let text = include_str!("../../shaders/draw_points.wgsl");
    of_units("draw_points", steps, &[text])
}

/// What draws points in a phase.
pub(crate) fn point_pass(gpu: &Gpu, phase: Phase) -> CornerPass {
    CornerPass::new(gpu, &draw_points(), BINDINGS, phase)
}
