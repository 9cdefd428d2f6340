//! Where on the GPU do the vertices and clusters of units lie?
//!
//! A vertex lies there once, with the unit that it came with; the clusters of later units name it,
//! so that it is moved there for all.
//! A cluster is a block of words: a head, its vertices by their places in the pool, its triangles.
//! `shaders/shared/scene.wgsl` reads both.

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::pool::{Pool, most_bound};
use crate::gpu::room::TakenBytes;
use crate::meshes::bounds::ClusterBounds;
use crate::meshes::units::{MeshUnits, Moved};
use crate::scene::coming::Refiners;
use foveal_core::content::mesh::cut::{PlacedCluster, PlacedUnit, VertexOrigin};
use foveal_core::content::mesh::payload::{MeshUnit, MeshVertex};
use foveal_core::pack::unit::UnitId;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the pools are called.
const VERTICES: &str = "vertices of meshes";
const WORDS: &str = "clusters of meshes";
/// Bytes of a vertex.
const VERTEX_BYTES: u64 = 16;
/// Bytes of a word.
const WORD_BYTES: u64 = 4;
/// Words before the vertices of a cluster.
const HEAD_WORDS: u32 = 10;
/// The word of a head that says which unit refines the cluster.
const REFINER_WORD: u32 = 9;
/// Stands for no unit.
pub(crate) const NO_UNIT: u32 = u32::MAX;

/// Bytes of GPU memory that a unit takes.
#[must_use]
pub fn unit_bytes(payload: &MeshUnit) -> u64 {
    let clusters = payload.clusters.iter();
    let words = clusters.map(|it| words_of(it.vertices.len(), it.triangles.len()));
    payload.vertices.len() as u64 * VERTEX_BYTES + u64::from(words.sum::<u32>()) * WORD_BYTES
}

fn words_of(vertices: usize, triangles: usize) -> u32 {
    HEAD_WORDS + (vertices + triangles) as u32
}

/// Where a unit lies.
struct Span {
    /// The first of its own vertices, which lie in a row.
    first: u32,
    /// Number of its own vertices.
    own: u32,
    /// The first word of each cluster, in a row; last, where the row ends.
    blocks: Vec<u32>,
    /// Whether it is drawn: what is not counts as free.
    is_used: bool,
}

impl Span {
    /// Bytes of vertices and clusters.
    fn bytes(&self) -> u64 {
        let words = match self.blocks[..] {
            [first, .., end] => u64::from(end - first),
            _ => 0,
        };
        words * WORD_BYTES + u64::from(self.own) * VERTEX_BYTES
    }
}

/// The units on the GPU.
pub(crate) struct UnitMemory {
    gpu: Gpu,
    vertices: Pool,
    words: Pool,
    spans: BTreeMap<UnitId, Span>,
    used_bytes: u64,
    refiners: Arc<Refiners>,
}

impl UnitMemory {
    /// No unit.
    ///
    /// # Errors
    /// The device binds next to nothing.
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            gpu: gpu.clone(),
            vertices: Pool::new(gpu, VERTICES, VERTEX_BYTES, None)?,
            words: Pool::new(gpu, WORDS, WORD_BYTES, None)?,
            spans: BTreeMap::new(),
            used_bytes: 0,
            refiners: Arc::default(),
        })
    }

    /// The vertices, then the clusters.
    pub(crate) fn buffers(&self) -> [&wgpu::Buffer; 2] {
        [self.vertices.buffer(), self.words.buffer()]
    }

    /// Bytes of the units that are there, and of both pools.
    pub(crate) fn taken(&self) -> TakenBytes {
        TakenBytes {
            used: self.used_bytes,
            held: self.vertices.bytes() + self.words.bytes(),
        }
    }

    /// The first word of a cluster of a unit that is there.
    pub(crate) fn block(&self, unit: UnitId, cluster: usize) -> Option<u32> {
        self.spans.get(&unit)?.blocks.get(cluster).copied()
    }

    /// Writes a unit that is among `units` to the GPU, within the bytes that are left for all;
    /// where what is free lies in too small pieces, all that is there is packed again.
    ///
    /// # Errors
    /// It does not fit: nothing changed then.
    pub(crate) fn insert(
        &mut self,
        units: &mut MeshUnits,
        unit: UnitId,
        left: TakenBytes,
    ) -> Result<(), RenderError> {
        let Some((_, placed)) = units.unit(unit) else {
            return Ok(());
        };
        let bytes = self.used_bytes + placed_bytes(placed).iter().sum::<u64>();
        let most = left.used;
        if bytes > most {
            return Err(RenderError::NoRoom { bytes, most });
        }
        // What is not drawn gives way before anything grows.
        while !self.has_place(units, unit) {
            let Some(idle) = units.give_way() else { break };
            self.remove(idle);
        }
        if self.place(units, unit, left.held).is_none() {
            self.pack(units, left.held)?;
        }
        self.used_bytes = bytes;
        Ok(())
    }

    /// Whether what is free has a place for a unit among `units`.
    fn has_place(&self, units: &MeshUnits, unit: UnitId) -> bool {
        let bytes = units.unit(unit).map(|(_, placed)| placed_bytes(placed));
        bytes.is_none_or(|[vertices, words]| {
            self.vertices.has_place((vertices / VERTEX_BYTES) as u32)
                && self.words.has_place((words / WORD_BYTES) as u32)
        })
    }

    /// From now on a unit that is there is drawn, or is not and counts as free.
    pub(crate) fn use_for_drawing(&mut self, unit: UnitId, is_used: bool) {
        let Some(span) = self.spans.get_mut(&unit) else {
            return;
        };
        let was_used = std::mem::replace(&mut span.is_used, is_used);
        match (was_used, is_used) {
            (false, true) => self.used_bytes += span.bytes(),
            (true, false) => self.used_bytes -= span.bytes(),
            _ => {}
        }
    }

    /// Forgets a unit that no other needs.
    pub(crate) fn remove(&mut self, unit: UnitId) {
        self.use_for_drawing(unit, false);
        if let Some(span) = self.spans.remove(&unit) {
            self.vertices.give_back(span.first, span.own);
            if let [first, .., end] = span.blocks[..] {
                self.words.give_back(first, end - first);
            }
        }
    }

    /// From now on these units refine clusters, of units that are there or come.
    pub(crate) fn set_refiners(&mut self, refiners: &Arc<Refiners>) {
        self.refiners = Arc::clone(refiners);
        for ((unit, cluster), refiner) in refiners.iter() {
            if let Some(block) = self.block(*unit, usize::from(*cluster)) {
                let word = block + REFINER_WORD;
                self.words.write(&self.gpu, word, &[refiner.0]);
            }
        }
    }

    /// Leaves as much room to others as it can where it `must`, else where it takes much more than
    /// it needs. Whether anything lies elsewhere then.
    ///
    /// # Errors
    /// None that it did not have before.
    pub(crate) fn give_back(
        &mut self,
        units: &mut MeshUnits,
        must: bool,
    ) -> Result<bool, RenderError> {
        let TakenBytes { used, held } = self.taken();
        let packs = must || held > used + used / 4;
        if packs {
            self.pack(units, 0)?;
        }
        Ok(packs)
    }

    /// Rewrites all units that are drawn or about to be, one after the other, in pools of so many
    /// bytes, but of an eighth more than they need at least.
    fn pack(&mut self, units: &mut MeshUnits, most: u64) -> Result<(), RenderError> {
        while let Some(idle) = units.give_way() {
            self.remove(idle);
        }
        let most_bound = most_bound(&self.gpu);
        let mut needed = [0; 2];
        for (_, _, placed) in units.all() {
            let bytes = placed_bytes(placed);
            needed = [0, 1].map(|k| needed[k] + bytes[k]);
        }
        let bytes = needed[0] + needed[1];
        if needed.iter().any(|it| *it > most_bound) {
            let most = 2 * most_bound;
            return Err(RenderError::NoRoom { bytes, most });
        }
        let most = most.max(bytes + bytes / 8);
        let places = |needed: u64, place_bytes: u64| {
            let share = u128::from(most) * u128::from(needed) / u128::from(bytes.max(1));
            let share = (share as u64).min(most_bound);
            Some(share.div_ceil(place_bytes) as u32)
        };
        let vertices = places(needed[0], VERTEX_BYTES);
        self.vertices = Pool::new(&self.gpu, VERTICES, VERTEX_BYTES, vertices)?;
        let words = places(needed[1], WORD_BYTES);
        self.words = Pool::new(&self.gpu, WORDS, WORD_BYTES, words)?;
        self.spans.clear();
        for (unit, _, _) in units.all() {
            let placed = self.place(units, unit, 0);
            assert!(placed.is_some(), "unit {} fits no more once packed", unit.0);
            if let Some(span) = self.spans.get_mut(&unit) {
                span.is_used = units.is_drawn(unit);
            }
        }
        Ok(())
    }

    /// Writes what moved of units that are there.
    pub(crate) fn rewrite(&self, units: &MeshUnits, moved: &Moved) {
        for unit in &moved.vertices {
            if let Some(span) = self.spans.get(unit) {
                self.write_vertices(units, *unit, span.first);
            }
        }
        for unit in &moved.bounds {
            let (Some(span), Some((note, placed))) = (self.spans.get(unit), units.unit(*unit))
            else {
                continue;
            };
            for (number, cluster) in placed.clusters.iter().enumerate() {
                let head = head_words(cluster, &note.bounds(number), note.level);
                self.words.write(&self.gpu, span.blocks[number], &head);
            }
        }
    }

    /// Writes the new vertices of a unit as they are now.
    fn write_vertices(&self, units: &MeshUnits, unit: UnitId, first: u32) {
        let vertices = units.new_vertices_now(unit).iter();
        let packed: Vec<u32> = vertices.flat_map(vertex_words).collect();
        self.vertices.write(&self.gpu, first, &packed);
    }

    /// Finds a place for a unit in pools of up to `most` bytes together and writes it there; `None`
    /// where there is none.
    fn place(&mut self, units: &MeshUnits, unit: UnitId, most: u64) -> Option<()> {
        let (note, placed) = units.unit(unit)?;
        let mut vertices = self.staying(placed)?;
        let [_, bytes] = placed_bytes(placed);
        let own_count = own_vertices(placed).len() as u32;
        let count = (bytes / WORD_BYTES) as u32;
        let room = most.saturating_sub(self.words.bytes());
        let first = self.vertices.take(&self.gpu, own_count, room)?;
        let room = most.saturating_sub(self.vertices.bytes());
        let Some(block) = self.words.take(&self.gpu, count, room) else {
            self.vertices.give_back(first, own_count);
            return None;
        };
        self.write_vertices(units, unit, first);
        vertices.extend(first..first + own_count);
        let mut blocks = vec![block];
        let mut words = Vec::with_capacity(count as usize);
        for (number, cluster) in placed.clusters.iter().enumerate() {
            let refiner = self.refiners.get(&(unit, number as u8));
            words.extend(head_words(cluster, &note.bounds(number), note.level));
            words.push(refiner.map_or(NO_UNIT, |it| it.0));
            words.extend(cluster.vertices.iter().map(|it| vertices[usize::from(*it)]));
            let triangle = |[a, b, c]: &[u8; 3]| u32::from_le_bytes([*a, *b, *c, 0]);
            words.extend(cluster.triangles.iter().map(triangle));
            blocks.push(block + words.len() as u32);
        }
        self.words.write(&self.gpu, block, &words);
        let span = Span {
            first,
            own: own_count,
            blocks,
            is_used: true,
        };
        self.spans.insert(unit, span);
        Some(())
    }

    /// Where the vertices that stay lie, in their order: with the units that they came with.
    fn staying(&self, placed: &PlacedUnit) -> Option<Vec<u32>> {
        let of = |it: &VertexOrigin| Some(self.spans.get(&it.unit)?.first + u32::from(it.number));
        placed.origins.iter().map(of).collect()
    }
}

/// Bytes of the vertices and of the clusters of a unit.
fn placed_bytes(placed: &PlacedUnit) -> [u64; 2] {
    let clusters = placed.clusters.iter();
    let words = clusters.map(|it| words_of(it.vertices.len(), it.triangles.len()));
    let words = u64::from(words.sum::<u32>());
    let own = own_vertices(placed).len() as u64;
    [own * VERTEX_BYTES, words * WORD_BYTES]
}

/// The vertices that came with a unit.
fn own_vertices(placed: &PlacedUnit) -> &[MeshVertex] {
    &placed.vertices[usize::from(placed.staying)..]
}

/// A vertex as the shaders read it.
fn vertex_words(vertex: &MeshVertex) -> [u32; 4] {
    let [x, y, z] = vertex.place.map(u32::from);
    let [nx, ny] = vertex.normal.map(|it| u32::from(it as u8));
    let [r, g, b, _] = vertex.colour;
    let [u, v] = vertex.uv.map(u32::from);
    [
        x | y << 16,
        z | nx << 16 | ny << 24,
        // Nothing is drawn by a vertex' alpha.
        u32::from_le_bytes([r, g, b, vertex.texture]),
        u | v << 16,
    ]
}

/// All words of a cluster's head but the last.
fn head_words(cluster: &PlacedCluster, bounds: &ClusterBounds, level: u8) -> [u32; 9] {
    let counts = [cluster.triangles.len(), cluster.vertices.len()];
    let [triangles, vertices] = counts.map(|it| it as u32);
    let [x, y, z] = bounds.centre.to_array().map(f32::to_bits);
    let [a, b, c] = bounds.axis.to_array().map(f32::to_bits);
    let [radius, spread] = [bounds.radius, bounds.spread].map(f32::to_bits);
    let counts = triangles | vertices << 8 | u32::from(level) << 16;
    [x, y, z, radius, a, b, c, spread, counts]
}
