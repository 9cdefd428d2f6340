//! How do the clusters of units become part of a picture?

use super::cull_clusters::{DrawnDepths, cull_clusters, is_hidden, is_seen};
use super::draw_clusters::{
    OfCluster, draw_clusters, draw_refiners, place_corner, texture_of_corner, texture_on,
};
use super::layer::{Canvas, TwinFrame, TwinLayer};
use crate::error::RenderError;
use crate::meshes::units::{DrawnCluster, MeshUnits};
use crate::scene::coming::{Coming, Refiners};
use crate::scene::params::TWO_SIDED;
use crate::scene::phase::{Go, Phase};
use crate::scene::placements::Placements;
use crate::twin::shared::raster::{Fragment, Sides, rasterise};
use crate::twin::shared::scene::{SceneInView, triangles_of};
use foveal_core::content::payload::PayloadView;
use foveal_core::pack::unit::UnitId;
use glam::Vec4;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// The units of meshes in main memory, and what draws them.
pub(crate) struct TwinMeshes {
    units: MeshUnits,
    placements: Arc<Placements>,
    refiners: Arc<Refiners>,
}

impl TwinMeshes {
    /// No unit of so many objects, which stand there.
    pub(crate) fn new(objects: usize, placements: &Arc<Placements>) -> Self {
        Self {
            units: MeshUnits::new(objects),
            placements: Arc::clone(placements),
            refiners: Arc::default(),
        }
    }

    /// The clusters that are drawn, each where it stands.
    fn drawn(&self) -> impl Iterator<Item = (DrawnCluster<'_>, u32)> {
        self.units.drawn().flat_map(|block| {
            let placements = self.placements.of(block.note.object);
            placements.map(move |placement| (block, placement))
        })
    }

    fn of_cluster(
        &self,
        scene: &SceneInView,
        block: &DrawnCluster<'_>,
        placement: u32,
    ) -> OfCluster {
        let refiner = self.refiners.get(&(block.unit, block.cluster as u8));
        OfCluster {
            flags: scene.placements[placement as usize].flags,
            level: u32::from(block.note.level),
            refiner: refiner.map_or(u32::MAX, |unit| unit.0),
            textures: scene.placements[placement as usize].textures,
        }
    }

    /// Calls `each` for every pixel that a triangle covers in front of all before it, with the
    /// colour of its texture there.
    fn cover(
        &self,
        frame: &TwinFrame<'_>,
        canvas: &mut Canvas,
        each: impl Fn(&mut Canvas, OfCluster, &Fragment, Vec4),
    ) {
        let (scene, size) = (frame.scene, canvas.size);
        let Some(pages) = frame.pages else {
            return;
        };
        for (block, placement) in self.drawn() {
            let of_cluster = self.of_cluster(scene, &block, placement);
            let sides = match of_cluster.flags & TWO_SIDED != 0 {
                true => Sides::Both,
                false => Sides::Front,
            };
            let corners = cull_clusters(scene, &block, placement);
            let corner = |number| place_corner(scene, &block, placement, number);
            for triangle in corners.as_chunks::<3>().0 {
                let head = texture_of_corner(pages, of_cluster, &block, triangle[0]);
                rasterise(triangle.map(corner), size, sides, |covered| {
                    if !canvas.has_behind(covered) {
                        return;
                    }
                    let fragment = covered.fragment();
                    if let Some(texture) = texture_on(pages, head, &fragment) {
                        canvas.pass(covered);
                        each(canvas, of_cluster, &fragment, texture);
                    }
                });
            }
        }
    }
}

impl TwinLayer for TwinMeshes {
    fn takes(&self, coming: &Coming<'_>) -> bool {
        matches!(coming.payload, PayloadView::Mesh(_))
    }

    fn upload(&mut self, coming: &Coming<'_>) -> Result<(), RenderError> {
        let PayloadView::Mesh(payload) = coming.payload else {
            return Err(RenderError::OtherKind);
        };
        if !self.units.show(coming.unit) {
            self.units.insert(coming, payload)?;
        }
        Ok(())
    }

    fn remove(&mut self, unit: UnitId) -> bool {
        self.units.remove(unit)
    }

    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        self.units.keep(wanted, staying);
    }

    fn show(&mut self, unit: UnitId) -> bool {
        self.units.show(unit)
    }

    fn set_refiners(&mut self, refiners: &Arc<Refiners>) {
        self.refiners = Arc::clone(refiners);
    }

    fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) {
        self.units.morph(shares);
    }

    fn coarsest(&self) -> u8 {
        self.units.coarsest()
    }

    fn draw(&self, frame: &TwinFrame<'_>, phase: Phase, go: Go, canvas: &mut Canvas) {
        if go == Go::Second {
            return;
        }
        match phase {
            Phase::Opaque => self.cover(frame, canvas, |canvas, of_cluster, fragment, texture| {
                let colour = draw_clusters(frame.scene, of_cluster, fragment, texture);
                canvas.paint(fragment, colour);
            }),
            Phase::Transparent => {}
            Phase::Ids => self.cover(frame, canvas, |canvas, of_cluster, fragment, _| {
                canvas.mark(fragment, draw_refiners(of_cluster));
            }),
        }
    }

    fn triangles(&self) -> u64 {
        let triangles = |(block, _): (DrawnCluster<'_>, u32)| u64::from(triangles_of(&block));
        self.drawn().map(triangles).sum()
    }

    fn clusters_seen(&self, scene: &SceneInView) -> [usize; 2] {
        let seen = |it: &(DrawnCluster<'_>, u32)| is_seen(scene, &it.0, it.1);
        [self.drawn().count(), self.drawn().filter(seen).count()]
    }

    fn clusters_hidden(&self, scene: &SceneInView, drawn: &DrawnDepths) -> usize {
        let hidden = |(block, placement): &(DrawnCluster<'_>, u32)| {
            is_seen(scene, block, *placement) && is_hidden(drawn, block, *placement)
        };
        self.drawn().filter(hidden).count()
    }
}
