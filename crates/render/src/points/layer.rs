//! How do the points of units become part of a picture on the GPU?

use crate::error::RenderError;
use crate::gpu::buffers::{storage, written};
use crate::gpu::device::Gpu;
use crate::gpu::pool::most_bound;
use crate::points::cubes::{StandingCube, standing};
use crate::points::memory::{BLOCK, PointMemory, placed_bytes};
use crate::points::params::{CloudViewParams, CubeParams};
use crate::points::pass::PointPass;
use crate::points::units::{CloudUnits, ComingPoints};
use crate::scene::params::SceneStyle;
use crate::scene::phase::Phase;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use std::collections::{HashMap, HashSet};

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
    colours: PointPass,
    refiners: Option<PointPass>,
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
            colours: PointPass::new(gpu, Phase::Opaque),
            refiners: None,
        })
    }

    /// Adds a unit; one that is there stays as it is. Its blocks may bring those in use to `most`
    /// bytes, and all to `room`.
    ///
    /// # Errors
    /// It does not fit to what is there or into that memory: nothing changed then.
    pub(crate) fn upload(
        &mut self,
        coming: &ComingPoints<'_>,
        [most, room]: [u64; 2],
    ) -> Result<(), RenderError> {
        if !self.units.insert(coming)? {
            return Ok(());
        }
        let there = self.units.unit(coming.unit);
        let cloud = self.units.cloud(coming.object);
        let (Some((_, placed)), Some(cloud)) = (there, cloud) else {
            return Ok(());
        };
        let bytes = self.memory.used_bytes() + placed_bytes(placed);
        let fits = bytes <= most && self.memory.insert(coming.unit, (placed, cloud), room);
        if !fits {
            self.units.remove(coming.unit);
            return Err(RenderError::NoRoom { bytes, most });
        }
        self.rewrite(coming.refines.map(|(parent, _)| parent));
        self.is_stale = true;
        Ok(())
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

    /// Takes a unit away.
    ///
    /// # Panics
    /// No other that is there may need it.
    pub(crate) fn remove(&mut self, unit: UnitId) {
        if self.units.unit(unit).is_some() {
            let changed = self.units.remove(unit);
            self.memory.remove(unit);
            self.rewrite(changed);
            self.is_stale = true;
        }
    }

    /// Takes all units away but those that are wanted, what these need, and roots.
    pub(crate) fn retain(&mut self, wanted: &HashSet<UnitId>) {
        for unit in self.units.to_go(wanted) {
            self.remove(unit);
        }
    }

    /// From now on these are the units that would refine octants of others.
    pub(crate) fn set_refiners(&mut self, refiners: HashMap<(UnitId, u8), UnitId>) {
        self.units.set_refiners(refiners);
        self.is_stale = true;
    }

    /// Moves all points together, so that nothing is kept for more.
    ///
    /// # Errors
    /// The device cannot bind as many.
    pub(crate) fn pack(&mut self) -> Result<(), RenderError> {
        self.memory.pack(&self.units)
    }

    /// Bytes of points, in use and all.
    pub(crate) fn point_bytes(&self) -> [u64; 2] {
        [self.memory.used_bytes(), self.memory.bytes()]
    }

    /// Bytes of GPU memory: points, in use or kept for more, and tables.
    pub(crate) fn gpu_bytes(&self) -> u64 {
        self.memory.bytes() + self.seen_cubes.size() + self.shown.size()
    }

    /// The coarsest level that was ever there.
    pub(crate) fn coarsest(&self) -> u8 {
        self.units.coarsest()
    }

    /// Writes what a picture of `view` is drawn by.
    ///
    /// # Errors
    /// More than the device binds.
    pub(crate) fn prepare(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<(), RenderError> {
        if std::mem::take(&mut self.is_stale) {
            self.cubes = standing(&self.units, &self.objects);
        }
        let params = CloudViewParams {
            half_pixel: view.size.map(|side| 1.0 / side.max(1) as f32),
            unused_pair: [0.0; 2],
        };
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&params));
        let seen: Vec<CubeParams> = self.cubes.iter().map(|it| it.seen_by(view)).collect();
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
        self.count = blocks.len() as u32;
        let gpu = &self.gpu;
        fit(
            gpu,
            &mut self.seen_cubes,
            "cubes of points",
            bytemuck::cast_slice(&seen),
        )?;
        fit(
            gpu,
            &mut self.shown,
            "blocks of points",
            bytemuck::cast_slice(&blocks),
        )
    }

    /// Makes what draws this, where it was not drawn before.
    pub(crate) fn ready(&mut self, phase: Phase) {
        if phase == Phase::Ids && self.refiners.is_none() {
            self.refiners = Some(PointPass::new(&self.gpu, phase));
        }
    }

    /// Draws what was prepared, where there is a pass that does.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        phase: Phase,
        scene_view: &wgpu::Buffer,
    ) {
        let points = match phase {
            Phase::Opaque => Some(&self.colours),
            Phase::Ids => self.refiners.as_ref(),
        };
        let Some(points) = points.filter(|_| self.count > 0) else {
            return;
        };
        let memory = self.memory.buffer();
        let buffers = [
            scene_view,
            &self.seen_cubes,
            &self.shown,
            memory,
            &self.view,
        ];
        let bound = points.bind(&self.gpu, buffers);
        points.draw(pass, &bound, self.count * CORNERS);
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
