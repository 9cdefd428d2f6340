//! Content with no more to it than its units: one coarse, four middle and sixteen fine ones.

use foveal_core::content::demand::{Chosen, Content, Demand};
use foveal_core::content::head::ContentHead;
use foveal_core::content::policy::{HasTables, Policy, PolicyConfig};
use foveal_core::content::scripted::scripted_head;
use foveal_core::content::unit::Unit;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{Entry, UnitPlace};
use foveal_core::perception::moment::Moment;
use foveal_core::units::Seconds;
use foveal_core::view::axes::angle_between;
use foveal_core::view::surface::Surface;
use foveal_core::view::timeline::Timeline;
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Frames of a group.
const GROUP: u32 = 4;
/// Units of a group.
const UNITS: u32 = 21;

/// A film of so many frames; of one, a still.
#[derive(Clone, Debug, Default)]
pub(crate) struct Film {
    pub(crate) frames: u32,
    /// A unit that will never come.
    pub(crate) lost: Option<UnitId>,
    /// Something that choosing takes has not been loaded.
    pub(crate) lacks: Arc<AtomicBool>,
    policy: Option<Policy>,
}

impl Film {
    pub(crate) fn new(frames: u32, lost: Option<UnitId>) -> Self {
        Self {
            frames,
            lost,
            ..Self::default()
        }
    }
}

/// The units of the group of a frame, the coarse one first.
fn units_at(frame: u32) -> impl Iterator<Item = UnitId> {
    (0..UNITS).map(move |number| UnitId(frame / GROUP * UNITS + number))
}

fn direction(unit: UnitId) -> DVec3 {
    let number = f64::from(unit.0 % UNITS);
    DVec3::new(libm::sin(number), libm::cos(number) * 0.5, -1.0).normalize()
}

impl Content for Film {
    fn name(&self) -> &str {
        "film"
    }

    fn timeline(&self) -> Timeline {
        let times = (0..self.frames).map(|n| i64::from(n) * 40_000_000);
        Timeline::new(&times.collect::<Vec<_>>(), Seconds(0.04))
    }

    fn unit(&self, unit: UnitId) -> Unit {
        let (group, number) = (unit.0 / UNITS, unit.0 % UNITS);
        Unit {
            level: match number {
                0 => 2,
                1..=4 => 1,
                _ => 0,
            },
            bytes: Some(100 + number * 7),
            samples: 1024,
            gpu_bytes: 1536,
            frames: group * GROUP..((group + 1) * GROUP).min(self.frames),
        }
    }

    fn place(&self, unit: UnitId) -> UnitPlace {
        match self.lost == Some(unit) {
            true => UnitPlace::Lost,
            false => UnitPlace::At(Entry::default()),
        }
    }

    fn base(&self, frame: u32) -> Vec<UnitId> {
        units_at(frame).take(1).collect()
    }

    fn coarsest(&self) -> u8 {
        2
    }

    fn at_frame(&self, unit: UnitId, frame: u32) -> UnitId {
        UnitId(frame / GROUP * UNITS + unit.0 % UNITS)
    }

    fn direction(&self, unit: UnitId, _: DVec3) -> DVec3 {
        direction(unit)
    }

    fn finest_samples(&self) -> u64 {
        16 * 1024
    }

    fn has(&self) -> HasTables {
        HasTables {
            signatures: false,
            cues: false,
        }
    }

    fn is_ready(&self, _: &PolicyConfig, _: u32) -> bool {
        !self.lacks.load(Ordering::Relaxed)
    }

    fn demand(self: Arc<Self>, _: &ContentHead, config: &PolicyConfig) -> Box<dyn Demand> {
        Box::new(Self {
            policy: Some(config.policy),
            ..Self::clone(&self)
        })
    }

    fn head(&self) -> ContentHead {
        scripted_head(Surface::cube(1024))
    }
}

impl Demand for Film {
    fn needed(&mut self, frame: u32, moment: &Moment) -> Chosen {
        let reach = match self.policy {
            Some(Policy::Full) => 4.0,
            Some(Policy::Coarsest) | None => 0.0,
            _ => 0.6,
        };
        let gaze = moment.gaze.gaze_in_content;
        let base = UnitId(frame / GROUP * UNITS);
        let is_near =
            |unit: &UnitId| *unit == base || angle_between(gaze, direction(*unit)).0 < reach;
        Chosen {
            units: units_at(frame).filter(is_near).collect(),
            ..Chosen::default()
        }
    }
}
