//! What do selection and sessions learn of a scene?

use super::Scene;
use super::demand::SceneDemand;
use crate::content::demand::{Content, Demand};
use crate::content::head::ContentHead;
use crate::content::payload::Payload;
use crate::content::policy::{HasTables, PolicyConfig};
use crate::content::unit::Unit;
use crate::pack::unit::UnitId;
use crate::pack::{PackError, UnitPlace};
use glam::DVec3;
use std::sync::Arc;

impl Content for Scene {
    fn name(&self) -> &str {
        &self.name
    }

    fn unit(&self, unit: UnitId) -> Unit {
        let row = self.pack().row(unit);
        Unit {
            level: self.pack().level_of(unit),
            bytes: Some(self.pack().entry(unit).bytes),
            samples: u64::from(row.samples),
            gpu_bytes: row.gpu_bytes(),
            frames: 0..1,
        }
    }

    fn payload(&self, unit: UnitId, chunk: &[u8]) -> Result<Payload, PackError> {
        self.pack().payload(unit, chunk)
    }

    fn place(&self, unit: UnitId) -> UnitPlace {
        self.pack().index().place(unit)
    }

    fn needs(&self, unit: UnitId) -> &[UnitId] {
        &self.pack().row(unit).needs
    }

    fn base(&self, _frame: u32) -> Vec<UnitId> {
        let units = self.pack().units();
        let is_root = |unit: &UnitId| self.pack().level_of(*unit) == self.coarsest();
        units.take_while(is_root).collect()
    }

    fn stands_in_parts(&self) -> bool {
        true
    }

    fn coarsest(&self) -> u8 {
        self.pack().coarsest()
    }

    fn direction(&self, unit: UnitId, eye: DVec3) -> DVec3 {
        let first = self.stands(unit).first();
        let towards = first.map(|it| it.sphere.centre - eye).unwrap_or_default();
        towards.normalize_or(DVec3::NEG_Z)
    }

    fn finest_samples(&self) -> u64 {
        self.pack().description().finest_samples()
    }

    fn has(&self) -> HasTables {
        HasTables {
            signatures: true,
            cues: false,
        }
    }

    fn demand(self: Arc<Self>, _head: &ContentHead, config: &PolicyConfig) -> Box<dyn Demand> {
        Box::new(SceneDemand::new(self, config))
    }

    fn head(&self) -> ContentHead {
        let about = [
            ("units".to_owned(), self.pack().len().into()),
            (
                "objects".to_owned(),
                self.pack().description().objects.len().into(),
            ),
        ];
        ContentHead::of_kind("scene", about.into_iter().collect())
    }
}
