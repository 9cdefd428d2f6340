//! What is the unit worth that would refine what each pixel shows? Twin of
//! `shaders/mark_units.wgsl`.

use crate::twin::shared::ramp::ramp;
use glam::Vec4;

const COVERED: f32 = 0.6;

/// Of a pixel that shows what `unit` would refine.
pub(super) fn mark_units(worths: &[f32], unit: u32) -> Vec4 {
    match worths.get(unit as usize) {
        Some(worth) if *worth >= 0.0 => ramp(1.0 - worth).extend(COVERED),
        _ => Vec4::ZERO,
    }
}
