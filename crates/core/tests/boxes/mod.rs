//! A kind of content that no crate has heard of: what it decides.

use foveal_core::content::demand::{Chosen, Content, Demand, Offer, Record};
use foveal_core::content::head::ContentHead;
use foveal_core::content::policy::{HasTables, PolicyConfig};
use foveal_core::content::unit::Unit;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{Entry, UnitPlace};
use foveal_core::perception::moment::Moment;
use foveal_core::session::log::sha256_hex;
use foveal_core::view::axes::angle_between;
use glam::DVec3;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Boxes of all five levels: the root, eight in it, eight in each of those, and so on.
const BOXES: u32 = 1 + 8 + 64 + 512 + 4096;
const BYTES: u32 = 50;
/// What a box takes on the GPU.
pub(crate) const GPU_BYTES: u64 = 64;
const WORTH: f64 = 100.0;

/// An octree of boxes before the viewer, each of which adds to the one that it is in.
#[derive(Clone, Debug, Default)]
pub(crate) struct Boxes {
    held: BTreeSet<u32>,
    gaze: DVec3,
}

/// Level, centre and half the side of a box; those in box n are 8 n + 1 to 8 n + 8.
pub(crate) fn place_of(number: u32) -> (u8, DVec3, f64) {
    let Some(of_parent) = number.checked_sub(1) else {
        return (4, DVec3::new(0.0, 0.0, -10.0), 4.0);
    };
    let (level, centre, half) = place_of(of_parent / 8);
    let corner = [0, 1, 2].map(|axis| f64::from(of_parent >> axis & 1) - 0.5);
    let centre = centre + half * DVec3::from_array(corner);
    (level - 1, centre, half / 2.0)
}

impl Boxes {
    /// What a box is worth: its size where it is looked at, nothing elsewhere.
    fn value(&self, number: u32) -> f64 {
        let (_, centre, half) = place_of(number);
        let size = (half * 3.0_f64.sqrt() / centre.length())
            .asin()
            .to_degrees();
        let is_near = angle_between(self.gaze, centre.normalize()).to_degrees() < size + 1.0;
        WORTH * size * size * f64::from(u8::from(is_near))
    }

    fn chosen(&self, of: impl Fn(&u32) -> bool) -> Chosen {
        let seen = (1..BOXES).filter(|number| of(number) && self.value(*number) > 0.0);
        let units: Vec<u32> = [0].into_iter().chain(seen).collect();
        let of_level = |level| units.iter().filter(|it| place_of(**it).0 == level).count();
        let places: Vec<u8> = units.iter().flat_map(|it| it.to_le_bytes()).collect();
        let record = Record {
            per_level: (0..5).map(|level| of_level(level) as u32).collect(),
            samples: units.len() as u64,
            sha256: sha256_hex(&places),
        };
        let units = units.into_iter().map(UnitId).collect();
        Chosen { units, record }
    }
}

impl Demand for Boxes {
    fn needed(&mut self, frame: u32, moment: &Moment) -> Chosen {
        self.begin(frame, moment, None);
        self.chosen(|_| true)
    }

    fn buys(&self, budget: Option<u64>) -> bool {
        budget.is_some()
    }

    fn steps(&self) -> Vec<Vec<u32>> {
        // Box n is step n - 1: the root is never bought.
        let parents = (0..BOXES - 1).map(|step| (step / 8).checked_sub(1));
        parents.map(|it| it.into_iter().collect()).collect()
    }

    fn begin(&mut self, _: u32, moment: &Moment, _: Option<u64>) {
        self.gaze = moment.gaze.gaze_in_content;
    }

    fn offers(&mut self) -> Vec<Offer> {
        let offer = |number| Offer {
            is_held: self.held.contains(&number),
            bytes: BYTES,
            value: self.value(number),
        };
        (1..BOXES).map(offer).collect()
    }

    fn buy(&mut self, steps: &[u32]) -> u64 {
        let new = steps.iter().filter(|step| self.held.insert(**step + 1));
        new.count() as u64 * u64::from(BYTES)
    }

    fn bought(&mut self) -> Chosen {
        self.chosen(|number| self.held.contains(number))
    }
}

impl Content for Boxes {
    fn name(&self) -> &str {
        "boxes"
    }

    fn unit(&self, unit: UnitId) -> Unit {
        Unit {
            level: place_of(unit.0).0,
            bytes: Some(BYTES),
            samples: 1,
            gpu_bytes: GPU_BYTES,
            frames: 0..1,
        }
    }

    fn place(&self, _: UnitId) -> UnitPlace {
        UnitPlace::At(Entry::default())
    }

    fn base(&self, _: u32) -> Vec<UnitId> {
        vec![UnitId(0)]
    }

    fn coarsest(&self) -> u8 {
        4
    }

    fn direction(&self, unit: UnitId, _: DVec3) -> DVec3 {
        place_of(unit.0).1.normalize()
    }

    fn finest_samples(&self) -> u64 {
        u64::from(BOXES)
    }

    fn has(&self) -> HasTables {
        HasTables::ALL
    }

    fn demand(self: Arc<Self>, head: &ContentHead, _: &PolicyConfig) -> Box<dyn Demand> {
        assert_eq!(head.other("boxes").unwrap()["levels"], 5);
        Box::new(Self::default())
    }

    fn head(&self) -> ContentHead {
        let about = [("levels".to_owned(), 5.into())];
        ContentHead::of_kind("boxes", about.into_iter().collect())
    }
}
