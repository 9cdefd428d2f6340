//! Content that follows from a script, the same on every machine: for tests, and to compare a
//! browser with this machine.

use crate::content::demand::Demand;
use crate::content::head::ContentHead;
use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::demand::VideoDemand;
use crate::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use crate::content::video::units::VideoUnits;
use crate::pack::unit::UnitId;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::cues::Cues;
use crate::view::surface::Surface;
use std::sync::Arc;

/// A video over a surface in tiles of 256 pixels and five levels.
#[must_use]
pub fn scripted_head(surface: Surface) -> ContentHead {
    ContentHead::of_video(TileGrid {
        surface,
        cut: Cut::Tile(256),
        levels: 5,
        ratio: 2,
    })
}

/// What a viewer wants of that video, whose units have sizes and measures that follow from their
/// numbers.
///
/// # Panics
/// The head must be of a video.
#[must_use]
pub fn scripted_demand(head: &ContentHead, config: &PolicyConfig) -> Box<dyn Demand> {
    match head.video() {
        Some(grid) => Box::new(VideoDemand::new(scripted_units(), *grid, config.clone())),
        None => panic!("{head:?} is no video"),
    }
}

/// The units of that video.
pub(crate) fn scripted_units() -> Arc<dyn VideoUnits> {
    Arc::new(ScriptedUnits)
}

/// The policies that the script goes through, in order.
pub const SCRIPTED_POLICIES: [Policy; 10] = [
    Policy::Acuity,
    Policy::Grid,
    Policy::Distance,
    Policy::Sampled,
    Policy::Viewport,
    Policy::Full,
    Policy::Coarsest,
    Policy::Uniform,
    Policy::Eccentricity,
    Policy::Perceptual,
];

#[derive(Debug)]
struct ScriptedUnits;

impl VideoUnits for ScriptedUnits {
    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        let place = u32::from(tile.face) << 20 | u32::from(tile.y) << 10 | u32::from(tile.x);
        UnitId(place ^ u32::from(tile.level) << 24 ^ (frame / 8) << 27)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        Some((frame / 8 + 1) * 8)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        500 + unit.0.wrapping_mul(2_654_435_761) % 4000
    }

    fn has_signatures(&self) -> bool {
        true
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        let byte = |k: u32| (unit.0.wrapping_mul(2_246_822_519 + 2 * k) >> 24) as u8;
        Some(Signature::from_bytes_v1(core::array::from_fn(|k| {
            byte(k as u32)
        })))
    }

    fn cues(&self, unit: UnitId) -> Option<Cues> {
        let bytes = unit.0.wrapping_mul(3_266_489_917).to_le_bytes();
        Some(Cues::from_bytes(bytes))
    }
}
