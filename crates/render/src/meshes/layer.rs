//! How do the clusters of units become part of a picture on the GPU?

use crate::error::RenderError;
use crate::gpu::compute::{Compute, Dispatch, record};
use crate::gpu::device::Gpu;
use crate::gpu::room::TakenBytes;
use crate::idle::IdleUnits;
use crate::meshes::hiding::{Hiding, depth_bytes_of};
use crate::meshes::lists::DrawList;
use crate::meshes::memory::UnitMemory;
use crate::meshes::pass::ClusterPass;
use crate::meshes::units::{MeshUnits, Moved, Undrawn};
use crate::scene::coming::{Coming, Refiners};
use crate::scene::kind::{Frame, KindLayer};
use crate::scene::params::SceneStyle;
use crate::scene::phase::{Go, Phase};
use crate::scene::placements::Placements;
use crate::shaders;
use foveal_core::content::payload::PayloadView;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// Most workgroups along one side of a dispatch.
const MOST_WORKGROUPS: u32 = 65_535;
/// Fewer clusters are drawn sooner than it is found out which are hidden.
const LEAST_HIDING: u32 = 4096;

/// The units of meshes on the GPU, and what draws them.
pub(crate) struct MeshLayer {
    gpu: Gpu,
    units: MeshUnits,
    memory: UnitMemory,
    placements: Arc<Placements>,
    /// Clusters that are seen from outside, and from both sides.
    lists: [DrawList; 2],
    is_two_sided: Vec<bool>,
    /// Whether units came, went or lie elsewhere since the lists were made.
    is_stale: bool,
    triangles: u64,
    cull: Compute,
    hiding: Hiding,
    /// Whether the depths of the picture that is drawn are kept for the next one.
    hides: bool,
    goes_twice: bool,
    colours: ClusterPass,
    refiners: Option<ClusterPass>,
    /// What each list is drawn with.
    bound: Option<[wgpu::BindGroup; 2]>,
}

impl MeshLayer {
    /// No unit of these objects, which stand there.
    ///
    /// # Errors
    /// The objects stand in more places than the device binds.
    pub(crate) fn new(
        gpu: &Gpu,
        objects: &[SceneObject],
        placements: &Arc<Placements>,
    ) -> Result<Self, RenderError> {
        Ok(Self {
            gpu: gpu.clone(),
            units: MeshUnits::new(objects.len()),
            memory: UnitMemory::new(gpu)?,
            placements: Arc::clone(placements),
            lists: [DrawList::new(gpu)?, DrawList::new(gpu)?],
            is_two_sided: objects.iter().map(|it| it.two_sided).collect(),
            is_stale: false,
            triangles: 0,
            cull: Compute::new(gpu, &shaders::cull_clusters()),
            hiding: Hiding::new(gpu, placements.bytes())?,
            hides: false,
            goes_twice: false,
            colours: ClusterPass::new(gpu, Phase::Opaque),
            refiners: None,
            bound: None,
        })
    }

    /// Number of clusters that may be seen, each where it stands.
    fn clusters(&self) -> u32 {
        self.lists.iter().map(DrawList::count).sum()
    }

    /// Makes the lists of the clusters that are drawn of the units that are there.
    fn fill_lists(&mut self) -> Result<(), RenderError> {
        let mut clusters = [Vec::new(), Vec::new()];
        let mut counts = [0_u64; 2];
        for drawn in self.units.drawn() {
            let Some(block) = self.memory.block(drawn.unit, drawn.cluster) else {
                continue;
            };
            let object = drawn.note.object;
            let placements = self.placements.of(object);
            let triangles = drawn.placed.clusters[drawn.cluster].triangles.len();
            let list = usize::from(self.is_two_sided[usize::from(object)]);
            counts[list] += triangles as u64 * placements.len() as u64;
            clusters[list].extend(placements.map(|placement| [block, placement]));
        }
        for (k, list) in self.lists.iter_mut().enumerate() {
            list.fill(&self.gpu, &clusters[k], counts[k])?;
        }
        self.triangles = counts.iter().sum();
        Ok(())
    }

    /// Records what finds the clusters that a go draws, the first or the second.
    fn cull(&self, encoder: &mut wgpu::CommandEncoder, go: usize, frame: &Frame<'_>) {
        let lists = self.lists.iter().filter(|list| list.count() > 0);
        let dispatches: Vec<_> = lists.map(|list| self.culling(list, go, frame)).collect();
        record(encoder, "cull_clusters", None, &dispatches);
    }

    /// The pass that finds the clusters of a list that a go draws.
    fn culling(&self, list: &DrawList, go: usize, frame: &Frame<'_>) -> Dispatch {
        let [_, words] = self.memory.buffers();
        let bindings = [
            (0, frame.scene.as_entire_binding()),
            (1, frame.placements.as_entire_binding()),
            (2, words.as_entire_binding()),
            (3, list.candidates()),
            (4, list.shown().as_entire_binding()),
            (5, list.arguments(go).as_entire_binding()),
            (6, list.corners().as_entire_binding()),
            (7, self.hiding.view.as_entire_binding()),
            (8, self.hiding.placements.as_entire_binding()),
            (9, self.hiding.depths()),
        ];
        let across = list.count().min(MOST_WORKGROUPS);
        let size = [across, list.count().div_ceil(across)];
        self.cull.over(&self.gpu, size, [1; 2], &bindings)
    }

    /// What draws a phase, where there is anything to draw in it.
    fn pass(&self, phase: Phase) -> Option<&ClusterPass> {
        match phase {
            Phase::Opaque => Some(&self.colours),
            Phase::Transparent => None,
            Phase::Ids => self.refiners.as_ref(),
        }
    }

    /// Binds what each list is drawn with in a frame.
    fn bind(&self, frame: &Frame<'_>) -> Option<[wgpu::BindGroup; 2]> {
        let (pass, textures) = (self.pass(frame.phase)?, frame.textures?);
        let [vertices, words] = self.memory.buffers();
        let buffers = [frame.scene, frame.placements, words, vertices];
        Some([0, 1].map(|k| pass.bind(&self.gpu, buffers, self.lists[k].shown(), textures)))
    }
}

impl KindLayer for MeshLayer {
    fn takes(&self, coming: &Coming<'_>) -> bool {
        matches!(coming.payload, PayloadView::Mesh(_))
    }

    fn upload(&mut self, coming: &Coming<'_>, allowed: TakenBytes) -> Result<bool, RenderError> {
        let PayloadView::Mesh(payload) = coming.payload else {
            return Err(RenderError::OtherKind);
        };
        if self.show(coming.unit) || !self.units.insert(coming, payload)? {
            return Ok(true);
        }
        if let Err(error) = self.memory.insert(&mut self.units, coming.unit, allowed) {
            self.units.remove(coming.unit);
            return Err(error);
        }
        self.is_stale = true;
        Ok(true)
    }

    fn remove(&mut self, unit: UnitId) -> bool {
        let was_there = self.units.remove(unit);
        if was_there {
            self.memory.remove(unit);
            self.is_stale = true;
        }
        was_there
    }

    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        let Undrawn { hidden, gone } = self.units.keep(wanted, staying);
        self.is_stale |= !hidden.is_empty() || !gone.is_empty();
        for unit in hidden {
            self.memory.use_for_drawing(unit, false);
        }
        gone.into_iter().for_each(|unit| self.memory.remove(unit));
    }

    fn show(&mut self, unit: UnitId) -> bool {
        let is_there = self.units.show(unit);
        if is_there {
            self.memory.use_for_drawing(unit, true);
            // It may have been on its way when it was drawn last.
            let moved = Moved {
                vertices: [unit].into(),
                bounds: vec![unit],
            };
            self.memory.rewrite(&self.units, &moved);
            self.is_stale = true;
        }
        is_there
    }

    fn idle(&mut self) -> Option<&mut IdleUnits<UnitId>> {
        Some(&mut self.units.idle)
    }

    fn taken(&self) -> TakenBytes {
        self.memory.taken()
    }

    fn table_bytes(&self) -> u64 {
        let lists: u64 = self.lists.iter().map(DrawList::bytes).sum();
        lists + self.hiding.table_bytes()
    }

    fn picture_bytes(&self, size: [u32; 2]) -> u64 {
        let coming = match self.clusters() >= LEAST_HIDING {
            true => depth_bytes_of(size),
            false => 0,
        };
        coming.max(self.hiding.depth_bytes())
    }

    fn give_back(&mut self, must: bool) -> Result<(), RenderError> {
        self.is_stale |= self.memory.give_back(&mut self.units, must)?;
        Ok(())
    }

    fn set_refiners(&mut self, refiners: &Arc<Refiners>) {
        self.memory.set_refiners(refiners);
    }

    fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) {
        let moved = self.units.morph(shares);
        self.memory.rewrite(&self.units, &moved);
    }

    fn coarsest(&self) -> u8 {
        self.units.coarsest()
    }

    fn goes_twice(&mut self, size: [u32; 2], style: &SceneStyle) -> Result<bool, RenderError> {
        self.hides = style.culls.hidden && self.clusters() >= LEAST_HIDING;
        if self.hides {
            self.hiding.fit(&self.gpu, size)?;
        }
        self.goes_twice = self.hides && self.hiding.is_there;
        Ok(self.goes_twice)
    }

    fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RenderError> {
        if self.is_stale {
            self.fill_lists()?;
            self.is_stale = false;
        }
        self.lists.iter().for_each(|list| list.begin(&self.gpu));
        self.cull(encoder, 0, frame);
        if frame.phase == Phase::Ids && self.refiners.is_none() {
            self.refiners = Some(ClusterPass::new(&self.gpu, Phase::Ids));
        }
        self.bound = self.bind(frame);
        Ok(())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, phase: Phase, go: Go) {
        let (Some(clusters), Some(bound)) = (self.pass(phase), &self.bound) else {
            return;
        };
        let lists = self.lists.iter().zip(bound);
        match go {
            Go::Only | Go::First => clusters.draw(pass, 0, lists),
            Go::Second if self.goes_twice => clusters.draw(pass, 1, lists),
            Go::Second => {}
        }
    }

    fn take_depths(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
        depths: &wgpu::TextureView,
    ) {
        if !self.hides {
            return;
        }
        self.hiding.record(&self.gpu, encoder, depths);
        self.hiding.take(encoder, frame.scene, frame.placements);
        if self.goes_twice {
            self.lists.iter().for_each(|list| list.go_on(encoder));
            self.cull(encoder, 1, frame);
        }
    }

    fn triangles(&self) -> u64 {
        self.triangles
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn clusters_drawn(&self) -> Result<[u32; 2], RenderError> {
        let mut drawn = [0; 2];
        for list in &self.lists {
            for (sum, count) in drawn.iter_mut().zip(list.clusters_drawn(&self.gpu)?) {
                *sum += count;
            }
        }
        Ok(drawn)
    }
}
