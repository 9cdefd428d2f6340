//! Where on the GPU do the points of units lie?
//!
//! In blocks of 64, which need not lie in a row: nothing is ever in too small pieces.
//! `shaders/draw_points.wgsl` reads them.

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::pool::Pool;
use crate::gpu::room::TakenBytes;
use crate::points::units::CloudUnits;
use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::points::cut::{PlacedPoints, ShownPoint};
use foveal_core::pack::unit::UnitId;
use std::collections::{BTreeMap, BTreeSet};

const POINTS: &str = "points of clouds";
/// Points of a block.
pub(crate) const BLOCK: usize = 64;
/// Words of a point.
const WORDS: usize = 3;
/// Bytes of a block.
pub(crate) const BLOCK_BYTES: u64 = (4 * WORDS * BLOCK) as u64;
/// Blocks of a new pool.
const FIRST_BLOCKS: u32 = 64;

/// The units on the GPU.
pub(crate) struct PointMemory {
    gpu: Gpu,
    pool: Pool,
    blocks: BTreeMap<UnitId, Vec<u32>>,
    /// Those of them that are not drawn: their blocks count as free.
    idle: BTreeSet<UnitId>,
    used: u64,
}

/// Bytes of the blocks of a unit.
pub(crate) fn placed_bytes(placed: &PlacedPoints) -> u64 {
    placed.drawn().len().div_ceil(BLOCK) as u64 * BLOCK_BYTES
}

impl PointMemory {
    /// No unit.
    ///
    /// # Errors
    /// The device binds next to nothing.
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            gpu: gpu.clone(),
            pool: Pool::new(gpu, POINTS, BLOCK_BYTES, Some(FIRST_BLOCKS))?,
            blocks: BTreeMap::new(),
            idle: BTreeSet::new(),
            used: 0,
        })
    }

    /// All blocks.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        self.pool.buffer()
    }

    /// Bytes of the blocks that are in use, and of all.
    pub(crate) fn taken(&self) -> TakenBytes {
        TakenBytes {
            used: self.used * BLOCK_BYTES,
            held: self.pool.bytes(),
        }
    }

    /// The blocks of a unit, in order.
    pub(crate) fn blocks(&self, unit: UnitId) -> &[u32] {
        self.blocks.get(&unit).map_or(&[], Vec::as_slice)
    }

    /// Bytes of the blocks in which nothing lies.
    pub(crate) fn free_bytes(&self) -> u64 {
        u64::from(self.pool.free()) * BLOCK_BYTES
    }

    /// From now on a unit that is there is drawn, or is not and counts as free.
    pub(crate) fn use_for_drawing(&mut self, unit: UnitId, is_used: bool) {
        let blocks = self.blocks(unit).len() as u64;
        match is_used {
            true if self.idle.remove(&unit) => self.used += blocks,
            false if blocks > 0 && self.idle.insert(unit) => self.used -= blocks,
            _ => {}
        }
    }

    /// Finds blocks for a unit, in a pool of at most `most_bytes`, and writes it there; `false`
    /// where there are none.
    pub(crate) fn insert(
        &mut self,
        unit: UnitId,
        (placed, cloud): (&PlacedPoints, &Cloud),
        most_bytes: u64,
    ) -> bool {
        let count = placed.drawn().len().div_ceil(BLOCK) as u32;
        let mut taken = Vec::with_capacity(count as usize);
        match self.pool.take(&self.gpu, count, most_bytes) {
            Some(first) => taken.extend(first..first + count),
            None => taken.extend((0..count).map_while(|_| self.pool.take(&self.gpu, 1, 0))),
        }
        if taken.len() < count as usize {
            taken
                .iter()
                .for_each(|block| self.pool.give_back(*block, 1));
            return false;
        }
        self.used += u64::from(count);
        self.blocks.insert(unit, taken);
        self.write(unit, placed, cloud);
        true
    }

    /// Writes the points of a unit that is there.
    pub(crate) fn write(&self, unit: UnitId, placed: &PlacedPoints, cloud: &Cloud) {
        let words: Vec<u32> = placed.drawn().flat_map(|it| words_of(it, cloud)).collect();
        for (block, words) in self.blocks(unit).iter().zip(words.chunks(BLOCK * WORDS)) {
            self.pool.write(&self.gpu, *block, words);
        }
    }

    /// Forgets a unit.
    pub(crate) fn remove(&mut self, unit: UnitId) {
        self.use_for_drawing(unit, false);
        self.idle.remove(&unit);
        let blocks = self.blocks.remove(&unit).unwrap_or_default();
        blocks
            .into_iter()
            .for_each(|block| self.pool.give_back(block, 1));
    }

    /// Moves all into a pool of no more bytes than they take.
    ///
    /// # Errors
    /// The device cannot bind as many.
    pub(crate) fn pack(&mut self, units: &CloudUnits) -> Result<(), RenderError> {
        let all = self.blocks.values().map(|blocks| blocks.len() as u32);
        let blocks = all.sum::<u32>().max(FIRST_BLOCKS);
        self.pool = Pool::new(&self.gpu, POINTS, BLOCK_BYTES, Some(blocks))?;
        let there: Vec<UnitId> = std::mem::take(&mut self.blocks).into_keys().collect();
        self.used = 0;
        let idle = std::mem::take(&mut self.idle);
        for unit in there {
            let placed = units.unit(unit).or_else(|| units.hidden(unit));
            let cloud = placed.and_then(|(note, _)| units.cloud(note.object));
            if let (Some((_, placed)), Some(cloud)) = (placed, cloud) {
                self.insert(unit, (placed, cloud), 0);
            }
        }
        for unit in idle {
            self.use_for_drawing(unit, false);
        }
        Ok(())
    }
}

/// A point as the shaders read it.
fn words_of(point: &ShownPoint, cloud: &Cloud) -> [u32; WORDS] {
    let [x, y, z] = point.place.map(u32::from);
    let [r, g, b] = point.colour.map(|code| cloud.shown_code(code));
    [x | y << 16, z, u32::from_le_bytes([r, g, b, 255])]
}
