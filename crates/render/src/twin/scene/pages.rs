//! How do layers find the pages of textures?

use super::layer::{Canvas, TwinFrame, TwinLayer};
use crate::error::RenderError;
use crate::scene::coming::Coming;
use crate::scene::phase::{Go, Phase};
use crate::twin::shared::pages::TwinPages;
use foveal_core::content::payload::PayloadView;
use foveal_core::pack::unit::UnitId;
use std::collections::HashSet;

impl TwinLayer for TwinPages {
    fn takes(&self, coming: &Coming<'_>) -> bool {
        matches!(coming.payload, PayloadView::Image(_))
    }

    fn upload(&mut self, coming: &Coming<'_>) -> Result<(), RenderError> {
        let PayloadView::Image(payload) = coming.payload else {
            return Err(RenderError::OtherKind);
        };
        self.insert(coming, payload)
    }

    fn remove(&mut self, _unit: UnitId) -> bool {
        false
    }

    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        self.keep_only(wanted, staying);
    }

    fn show(&mut self, unit: UnitId) -> bool {
        self.table.show_again(unit)
    }

    fn pages(&self) -> Option<&TwinPages> {
        Some(self)
    }

    fn draw(&self, _frame: &TwinFrame<'_>, _phase: Phase, _go: Go, _canvas: &mut Canvas) {}
}
