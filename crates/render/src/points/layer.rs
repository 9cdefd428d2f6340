//! How do the points of units become part of a picture on the GPU?

use crate::error::RenderError;
use crate::gpu::buffers::{storage, written};
use crate::gpu::device::Gpu;
use crate::gpu::pool::most_bound;
use crate::gpu::room::TakenBytes;
use crate::idle::IdleUnits;
use crate::points::cubes::{StandingCube, standing};
use crate::points::memory::{BLOCK, PointMemory, placed_bytes};
use crate::points::params::{CloudViewParams, CubeParams};
use crate::points::pass::point_pass;
use crate::points::units::CloudUnits;
use crate::scene::coming::{Coming, Refiners};
use crate::scene::corner_pass::CornerPass;
use crate::scene::kind::{Frame, KindLayer};
use crate::scene::params::SceneStyle;
use crate::scene::phase::{Go, Phase};
use foveal_core::content::payload::PayloadView;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use std::collections::HashSet;
use std::sync::Arc;

/// Corners of the squares of a block.
const CORNERS: u32 = 6 * BLOCK as u32;
/// Bits that count the points of a block.
const COUNT_BITS: u32 = 7;
/// Bytes of a block in the list of those that are drawn.
const ENTRY_BYTES: u64 = 8;

/// The units of clouds on the GPU, and what draws them.
pub(crate) struct PointLayer {
    gpu: Gpu,
    objects: Vec<SceneObject>,
    units: CloudUnits,
    memory: PointMemory,
    cubes: Vec<StandingCube>,
    /// Whether units came or went since the cubes were listed.
    is_stale: bool,
    view: wgpu::Buffer,
    seen_cubes: wgpu::Buffer,
    shown: wgpu::Buffer,
    /// Blocks that the last picture was drawn of.
    count: u32,
    colours: CornerPass,
    refiners: Option<CornerPass>,
    /// What the last picture was drawn with.
    bound: Option<wgpu::BindGroup>,
}

impl PointLayer {
    /// No unit of these objects.
    ///
    /// # Errors
    /// The device binds next to nothing.
    pub(crate) fn new(gpu: &Gpu, objects: &[SceneObject]) -> Result<Self, RenderError> {
        let view_bytes = size_of::<CloudViewParams>() as u64;
        let uniform = wgpu::BufferUsages::UNIFORM;
        Ok(Self {
            gpu: gpu.clone(),
            objects: objects.to_vec(),
            units: CloudUnits::new(objects),
            memory: PointMemory::new(gpu)?,
            cubes: Vec::new(),
            is_stale: false,
            view: written(gpu, "view of clouds", view_bytes, uniform),
            seen_cubes: storage(gpu, "cubes of points", size_of::<CubeParams>() as u64)?,
            shown: storage(gpu, "blocks of points", ENTRY_BYTES)?,
            count: 0,
            colours: point_pass(gpu, Phase::Opaque),
            refiners: None,
            bound: None,
        })
    }

    /// What is not drawn gives way to a unit before anything grows.
    fn make_place(&mut self, unit: UnitId) {
        let there = self.units.unit(unit);
        let bytes = there.map_or(0, |(_, placed)| placed_bytes(placed));
        while self.memory.free_bytes() < bytes {
            let Some(idle) = self.units.give_way() else {
                return;
            };
            self.memory.remove(idle);
        }
    }

    /// Rewrites a unit whose colours changed.
    fn rewrite(&self, unit: Option<UnitId>) {
        let Some(unit) = unit else { return };
        let Some((note, placed)) = self.units.unit(unit) else {
            return;
        };
        if let Some(cloud) = self.units.cloud(note.object) {
            self.memory.write(unit, placed, cloud);
        }
    }

    /// The blocks that a picture is drawn of: the number of each one's cube, then its own and how
    /// many points it has.
    fn seen_blocks(&self, view: &EyeView, style: &SceneStyle) -> Vec<[u32; 2]> {
        let mut blocks: Vec<[u32; 2]> = Vec::new();
        for (number, cube) in (0..).zip(&self.cubes) {
            if style.culls.outside && !cube.is_in_view(view, style.near) {
                continue;
            }
            let count = self.units.unit(cube.unit);
            let mut left = count.map_or(0, |(_, placed)| placed.drawn().len());
            for block in self.memory.blocks(cube.unit) {
                let count = left.min(BLOCK);
                left -= count;
                blocks.push([number, block << COUNT_BITS | count as u32]);
            }
        }
        blocks
    }

    /// What draws a phase, where there is anything to draw in it.
    fn pass(&self, phase: Phase) -> Option<&CornerPass> {
        match phase {
            Phase::Opaque => Some(&self.colours),
            Phase::Transparent => None,
            Phase::Ids => self.refiners.as_ref(),
        }
    }

    /// Binds what a frame is drawn with.
    fn bind(&self, frame: &Frame<'_>) -> Option<wgpu::BindGroup> {
        let memory = self.memory.buffer();
        let buffers = [
            frame.scene,
            &self.seen_cubes,
            &self.shown,
            memory,
            &self.view,
        ];
        let pass = self.pass(frame.phase)?;
        Some(pass.bind(&self.gpu, &buffers))
    }
}

impl KindLayer for PointLayer {
    fn takes(&self, coming: &Coming<'_>) -> bool {
        matches!(coming.payload, PayloadView::Points(_))
    }

    fn upload(&mut self, coming: &Coming<'_>, allowed: TakenBytes) -> Result<bool, RenderError> {
        let PayloadView::Points(payload) = coming.payload else {
            return Err(RenderError::OtherKind);
        };
        if self.show(coming.unit) || !self.units.insert(coming, payload)? {
            return Ok(true);
        }
        self.make_place(coming.unit);
        let there = self.units.unit(coming.unit);
        let cloud = self.units.cloud(coming.object);
        let (Some((_, placed)), Some(cloud)) = (there, cloud) else {
            return Ok(true);
        };
        let bytes = self.memory.taken().used + placed_bytes(placed);
        let most = allowed.used;
        let fits = bytes <= most
            && self
                .memory
                .insert(coming.unit, (placed, cloud), allowed.held);
        if !fits {
            self.units.remove(coming.unit);
            return Err(RenderError::NoRoom { bytes, most });
        }
        self.rewrite(coming.part.and(coming.needs.first().copied()));
        self.is_stale = true;
        Ok(true)
    }

    fn remove(&mut self, unit: UnitId) -> bool {
        let is_there = self.units.unit(unit).is_some();
        if is_there {
            let changed = self.units.remove(unit);
            self.memory.remove(unit);
            self.rewrite(changed);
            self.is_stale = true;
        }
        is_there
    }

    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        let stay: HashSet<UnitId> = staying.iter().copied().collect();
        for unit in self.units.to_go(wanted) {
            if !stay.contains(&unit) {
                self.remove(unit);
                continue;
            }
            let changed = self.units.hide(unit);
            self.memory.use_for_drawing(unit, false);
            self.rewrite(changed);
            self.is_stale = true;
        }
        for unit in self.units.set_idle(staying) {
            self.memory.remove(unit);
        }
    }

    fn show(&mut self, unit: UnitId) -> bool {
        let is_there = self.units.show(unit);
        if is_there {
            self.memory.use_for_drawing(unit, true);
            self.rewrite(Some(unit));
            let parent = self.units.unit(unit);
            self.rewrite(parent.and_then(|(_, placed)| placed.parent()));
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
        self.seen_cubes.size() + self.shown.size()
    }

    fn give_back(&mut self, must: bool) -> Result<(), RenderError> {
        match must {
            true => {
                while let Some(idle) = self.units.give_way() {
                    self.memory.remove(idle);
                }
                self.memory.pack(&self.units)
            }
            // It holds little more than it needs.
            false => Ok(()),
        }
    }

    fn set_refiners(&mut self, refiners: &Arc<Refiners>) {
        self.units.set_refiners(refiners);
        self.is_stale = true;
    }

    fn coarsest(&self) -> u8 {
        self.units.coarsest()
    }

    fn prepare(
        &mut self,
        _encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RenderError> {
        if std::mem::take(&mut self.is_stale) {
            self.cubes = standing(&self.units, &self.objects);
        }
        if frame.phase == Phase::Ids && self.refiners.is_none() {
            self.refiners = Some(point_pass(&self.gpu, Phase::Ids));
        }
        let (view, gpu) = (frame.view, &self.gpu);
        let params = CloudViewParams {
            half_pixel: view.size.map(|side| 1.0 / side.max(1) as f32),
            unused_pair: [0.0; 2],
        };
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&params));
        let seen: Vec<CubeParams> = self.cubes.iter().map(|it| it.seen_by(view)).collect();
        let blocks = self.seen_blocks(view, frame.style);
        self.count = blocks.len() as u32;
        let seen = bytemuck::cast_slice(&seen);
        fit(gpu, &mut self.seen_cubes, "cubes of points", seen)?;
        let blocks = bytemuck::cast_slice(&blocks);
        fit(gpu, &mut self.shown, "blocks of points", blocks)?;
        self.bound = self.bind(frame);
        Ok(())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, phase: Phase, go: Go) {
        let hides = go == Go::First;
        if let (Some(points), Some(bound)) = (self.pass(phase), &self.bound)
            && !hides
            && self.count > 0
        {
            points.draw(pass, bound, self.count * CORNERS);
        }
    }
}

/// Writes bytes to a buffer, to a larger one where they do not fit.
fn fit(
    gpu: &Gpu,
    buffer: &mut wgpu::Buffer,
    what: &'static str,
    bytes: &[u8],
) -> Result<(), RenderError> {
    let needed = bytes.len() as u64;
    if needed > buffer.size() {
        let roomy = needed.next_power_of_two().min(most_bound(gpu));
        *buffer = storage(gpu, what, needed.max(roomy))?;
    }
    gpu.queue.write_buffer(buffer, 0, bytes);
    Ok(())
}
