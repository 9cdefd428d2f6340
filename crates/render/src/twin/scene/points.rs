//! How do the points of units become part of a picture?

use super::draw_points::{CloudInView, Splat, draw_point_refiners, draw_points, place_splat};
use super::layer::{Canvas, TwinFrame, TwinLayer};
use crate::error::RenderError;
use crate::points::cubes::standing;
use crate::points::units::CloudUnits;
use crate::scene::coming::{Coming, Refiners};
use crate::scene::phase::{Go, Phase};
use crate::twin::shared::raster::{Fragment, Sides, rasterise};
use foveal_core::content::payload::PayloadView;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use glam::Vec2;
use std::collections::HashSet;
use std::sync::Arc;

/// The units of clouds in main memory, and what draws them.
pub(crate) struct TwinPoints {
    units: CloudUnits,
    objects: Vec<SceneObject>,
}

impl TwinPoints {
    /// No unit of these objects.
    pub(crate) fn new(objects: &[SceneObject]) -> Self {
        Self {
            units: CloudUnits::new(objects),
            objects: objects.to_vec(),
        }
    }

    /// Calls `each` for every pixel that a point covers in front of all before it.
    fn cover(
        &self,
        frame: &TwinFrame<'_>,
        canvas: &mut Canvas,
        each: impl Fn(&mut Canvas, &Splat, &Fragment),
    ) {
        let (view, size) = (frame.view, canvas.size);
        let standing = standing(&self.units, &self.objects);
        let cloud = CloudInView {
            cubes: standing.iter().map(|it| it.seen_by(view)).collect(),
            half_pixel: Vec2::from(view.size.map(|side| 1.0 / side.max(1) as f32)),
        };
        for (number, cube) in (0..).zip(&standing) {
            let there = self.units.unit(cube.unit);
            let of = there.and_then(|(note, _)| self.units.cloud(note.object));
            let (Some((_, placed)), Some(of)) = (there, of) else {
                continue;
            };
            for point in placed.drawn() {
                let splat = place_splat(frame.scene, &cloud, number, (point, of));
                for triangle in [[0, 1, 2], [3, 2, 1]] {
                    let triangle = triangle.map(|corner: usize| splat.corners[corner]);
                    rasterise(triangle, size, Sides::Both, |covered| {
                        if canvas.pass(covered) {
                            each(canvas, &splat, &covered.fragment());
                        }
                    });
                }
            }
        }
    }
}

impl TwinLayer for TwinPoints {
    fn takes(&self, coming: &Coming<'_>) -> bool {
        matches!(coming.payload, PayloadView::Points(_))
    }

    fn upload(&mut self, coming: &Coming<'_>) -> Result<(), RenderError> {
        let PayloadView::Points(payload) = coming.payload else {
            return Err(RenderError::OtherKind);
        };
        if !self.units.show(coming.unit) {
            self.units.insert(coming, payload)?;
        }
        Ok(())
    }

    fn remove(&mut self, unit: UnitId) -> bool {
        let is_there = self.units.unit(unit).is_some();
        self.units.remove(unit);
        is_there
    }

    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        for unit in self.units.to_go(wanted) {
            self.units.hide(unit);
        }
        self.units.set_idle(staying);
    }

    fn show(&mut self, unit: UnitId) -> bool {
        self.units.show(unit)
    }

    fn set_refiners(&mut self, refiners: &Arc<Refiners>) {
        self.units.set_refiners(refiners);
    }

    fn coarsest(&self) -> u8 {
        self.units.coarsest()
    }

    fn draw(&self, frame: &TwinFrame<'_>, phase: Phase, go: Go, canvas: &mut Canvas) {
        if go == Go::First {
            return;
        }
        match phase {
            Phase::Opaque => self.cover(frame, canvas, |canvas, splat, fragment| {
                canvas.paint(fragment, draw_points(splat));
            }),
            Phase::Transparent => {}
            Phase::Ids => self.cover(frame, canvas, |canvas, splat, fragment| {
                canvas.mark(fragment, draw_point_refiners(splat));
            }),
        }
    }
}
