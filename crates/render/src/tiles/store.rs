//! Which tiles are on the GPU, and which of them may be shown together?

use crate::gpu::buffers::{filled, written};
use crate::idle::IdleUnits;
use crate::params::TileParams;
use crate::tiles::atlas::{Atlas, SlotPlace};
use crate::tiles::atlas_shape::AtlasShape;
use crate::tiles::halving::{HalvedBy, NewTile, TileHalving};
use crate::tiles::level_map::{LEVEL_BITS, contains, level_in, shown_map};
#[cfg(not(target_arch = "wasm32"))]
use crate::tiles::read_tile::read_planes;
use crate::{error::RenderError, gpu::device::Gpu, tiles::reduce::pyramid};
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
#[cfg(not(target_arch = "wasm32"))]
use foveal_core::view::picture::plane_size;
use foveal_core::view::picture::{Colour, Picture};
use std::collections::{HashMap, HashSet};

/// The GPU's copy of the resident tiles.
///
/// All tiles of a picture come from one source frame: a tile of the atlas is shown only in the
/// frame that it was uploaded for, and its place falls back to the coarsest level until then.
pub struct TileStore {
    gpu: Gpu,
    grid: TileGrid,
    colour: Colour,
    atlas: Atlas,
    /// What makes averages of tiles on the GPU; where there is none, `upload` makes them.
    halving: Option<TileHalving>,
    tables: Tables,
    resident: HashMap<Tile, Resident>,
    base_frames: Vec<Option<u32>>,
    free: Vec<SlotPlace>,
    /// Those that are there and not shown.
    idle: IdleUnits<Tile>,
    /// Those of frames that gave way and are not reported yet.
    evicted: Vec<(Tile, u32)>,
    frame: u32,
    clock: u64,
    map_is_stale: bool,
    /// Counts the textures made, so that code that binds them notices a growth.
    generation: u64,
}

/// A tile in a slot.
#[derive(Clone, Copy, Debug)]
struct Resident {
    slot: SlotPlace,
    frame: u32,
    touched: u64,
    is_shown: bool,
    /// Whether the slot also holds its averages, for which a frame waits.
    is_halved: bool,
}

/// What the shaders look up: the uniform, and what is shown over every cell.
struct Tables {
    params: wgpu::Buffer,
    cells: wgpu::Buffer,
    sent: Vec<u32>,
}

impl TileStore {
    /// An empty store whose atlas grows to at most `layers` texture layers (256 at most).
    pub(crate) fn new(
        gpu: &Gpu,
        grid: &TileGrid,
        colour: Colour,
        layers: u32,
    ) -> Result<Self, RenderError> {
        let atlas = Atlas::new(gpu, AtlasShape::new(grid), layers)?;
        let mut store = Self {
            gpu: gpu.clone(),
            grid: *grid,
            colour,
            tables: Tables::new(gpu, grid, colour),
            free: atlas.slots().collect(),
            atlas,
            halving: None,
            resident: HashMap::new(),
            idle: IdleUnits::default(),
            evicted: Vec::new(),
            base_frames: vec![None; grid.tiles_in_level(grid.coarsest()) as usize],
            frame: 0,
            clock: 0,
            map_is_stale: true,
            generation: 0,
        };
        store.halve_by(HalvedBy::fastest(gpu));
        Ok(store)
    }

    /// Chooses what makes the averages of tiles, in place of what takes less time on this adapter.
    ///
    /// # Panics
    /// Tiles were uploaded already.
    pub fn halve_by(&mut self, by: HalvedBy) {
        assert!(
            self.resident.is_empty(),
            "tiles came before what halves them"
        );
        self.halving = match by {
            HalvedBy::Gpu => Some(TileHalving::new(&self.gpu, self.colour)),
            HalvedBy::Cpu => None,
        };
    }

    /// From now on source frame `frame` is shown: only tiles uploaded for it are.
    pub fn begin_frame(&mut self, frame: u32) {
        self.map_is_stale |= frame != self.frame;
        self.frame = frame;
    }

    /// Makes `tile` of source frame `frame` resident, in place of the same tile of another frame.
    ///
    /// At the bound of the atlas the tile that was uploaded longest ago makes room.
    pub fn upload(&mut self, tile: Tile, frame: u32, picture: &Picture) -> Result<(), RenderError> {
        check(&self.grid, tile, picture)?;
        self.map_is_stale = true;
        if tile.level == self.grid.coarsest() {
            self.write(self.atlas.texel_of_base(tile), picture);
            self.base_frames[self.grid.rank(tile) as usize] = Some(frame);
            return Ok(());
        }
        let slot = self.slot_for(tile);
        let texel = self.atlas.texel_of_slot(slot);
        let is_halved = self.halving.is_none();
        match is_halved {
            true => self.write_halved(tile, texel, picture),
            false => self.write(texel, picture),
        }
        self.clock += 1;
        let touched = self.clock;
        self.resident.insert(
            tile,
            Resident {
                slot,
                frame,
                touched,
                is_shown: true,
                is_halved,
            },
        );
        self.idle.remove(tile);
        Ok(())
    }

    fn write(&self, texel: [u32; 3], picture: &Picture) {
        let planes = [0, 1, 2].map(|p| (picture.plane_size(p), picture.planes[p].as_slice()));
        self.atlas.planes.write(&self.gpu, texel, 0, planes);
    }

    /// Writes a tile and its averages, made here.
    fn write_halved(&self, tile: Tile, texel: [u32; 3], picture: &Picture) {
        let [y, u, v] = [0, 1, 2].map(|p| pyramid(&self.grid, tile, picture, p, self.colour));
        for (step, ((y, u), v)) in (0..).zip(y.iter().zip(&u).zip(&v)) {
            let mip = step * self.grid.ratio.trailing_zeros();
            let planes = [y, u, v].map(|it| (it.extent.size, it.codes.as_slice()));
            self.atlas.planes.write(&self.gpu, texel, mip, planes);
        }
    }

    /// Evicts every tile that is not in `wanted`; the coarsest level always stays.
    pub fn retain(&mut self, wanted: &[Tile]) {
        self.keep(wanted, &[]);
    }

    /// Shows only these tiles and the coarsest level. Of the others those stay that are `staying`,
    /// first what is to stay longest, until their slots are needed.
    pub fn keep(&mut self, shown: &[Tile], staying: &[Tile]) {
        let [shown, stay] = [shown, staying].map(|it| it.iter().copied().collect::<HashSet<_>>());
        for (tile, resident) in &mut self.resident {
            resident.is_shown &= shown.contains(tile);
        }
        self.map_is_stale = true;
        let stays = |tile: &Tile| shown.contains(tile) || stay.contains(tile);
        let mut gone: Vec<Tile> = self.resident.keys().copied().collect();
        gone.retain(|tile| !stays(tile));
        gone.sort_unstable();
        for tile in gone {
            if let Some(slot) = self.evict(tile) {
                self.free.push(slot);
            }
        }
        let is_idle = |tile: &&Tile| self.resident.get(*tile).is_some_and(|it| !it.is_shown);
        self.idle
            .set(staying.iter().filter(is_idle).copied().collect());
    }

    /// Shows a tile again that stayed; `false` where it did not.
    pub fn show(&mut self, tile: Tile) -> bool {
        let Some(resident) = self.resident.get_mut(&tile) else {
            return false;
        };
        resident.is_shown = true;
        self.idle.remove(tile);
        self.map_is_stale = true;
        true
    }

    /// These do not give way, until others are spared: they are about to be shown again.
    pub fn spare(&mut self, tiles: &[Tile]) {
        self.idle.spare(tiles);
    }

    /// Tiles of frames that stayed and gave way since this was last asked.
    pub fn take_evicted(&mut self) -> Vec<(Tile, u32)> {
        std::mem::take(&mut self.evicted)
    }

    /// The tiles in the atlas, in order.
    #[must_use]
    pub fn resident(&self) -> Vec<Tile> {
        let mut tiles: Vec<Tile> = self.resident.keys().copied().collect();
        tiles.sort_unstable();
        tiles
    }

    /// The finest level shown over every cell: face-major, then rows, then columns.
    #[must_use]
    pub fn level_map(&self) -> Vec<u32> {
        self.shown_map().into_iter().map(level_in).collect()
    }

    /// Tiles that hold another source frame than the one shown, or none: those of the atlas are
    /// not drawn, those of the coarsest level are, as there is nothing else.
    #[must_use]
    pub fn wrong_frame_tiles(&self) -> usize {
        let base = self
            .base_frames
            .iter()
            .filter(|&&f| f != Some(self.frame))
            .count();
        base + self
            .resident
            .values()
            .filter(|r| r.is_shown && r.frame != self.frame)
            .count()
    }

    /// Blocks until the GPU holds what was uploaded: without a draw now and then the copies on
    /// their way would pile up in main memory.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) -> Result<(), RenderError> {
        let mut encoder = self.gpu.encoder("averages of tiles");
        self.halve(&mut encoder);
        self.gpu.submit(encoder);
        self.gpu.settle()
    }

    /// The samples of a tile as the GPU holds them, the coarsest level's included; refuses a tile
    /// that is not resident. Blocks: for reports and trials, not for playing.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn read_tile(&self, tile: Tile) -> Result<Picture, RenderError> {
        let texel = match self.resident.get(&tile) {
            Some(resident) => self.atlas.texel_of_slot(resident.slot),
            None if contains(&self.grid, tile) && tile.level == self.grid.coarsest() => {
                self.atlas.texel_of_base(tile)
            }
            None => return Err(RenderError::NotResident(tile)),
        };
        let [width, height] = self.grid.tile_size(tile);
        let sizes = [0, 1].map(|p| plane_size(width, height, p));
        let planes = read_planes(&self.gpu, &self.atlas.planes, (texel, 0), sizes)?;
        Ok(Picture {
            width,
            height,
            planes,
        })
    }

    /// Bytes of GPU memory allocated for textures and tables.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        let halving = self.halving.as_ref().map_or(0, TileHalving::bytes);
        self.atlas.planes.bytes() + self.tables.bytes() + halving
    }

    /// Sends the tables that changed, and records the averages of tiles that came; call before the
    /// draw.
    pub(crate) fn flush(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.halve(encoder);
        if std::mem::take(&mut self.map_is_stale) {
            let map = self.shown_map();
            self.tables.send(&self.gpu, map);
        }
    }

    fn halve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let Some(halving) = &self.halving else {
            return;
        };
        let new = self.resident.iter_mut().filter(|(_, it)| !it.is_halved);
        let mut new: Vec<NewTile> = new
            .map(|(tile, resident)| {
                resident.is_halved = true;
                (*tile, self.atlas.texel_of_slot(resident.slot))
            })
            .collect();
        let planes = &self.atlas.planes;
        halving.record((&self.gpu, encoder), planes, &self.grid, &mut new);
    }

    /// What the shaders look up at a cell: the level, and where the atlas holds its tile.
    fn shown_map(&self) -> Vec<u32> {
        let is_now = |r: &Resident| r.is_shown && r.frame == self.frame;
        let now = self.resident.iter().filter(|(_, r)| is_now(r));
        let entry =
            |[column, row, layer]: SlotPlace| (column | row << 8 | layer << 16) << LEVEL_BITS;
        let entries = now.map(|(&tile, r)| (tile, u32::from(tile.level) | entry(r.slot)));
        shown_map(&self.grid, entries)
    }

    /// Changes whenever the textures do.
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// What the shaders bind, in the order of `shaders/shared/tiles.wgsl`.
    pub(crate) fn bindings(&self) -> ([&wgpu::Buffer; 2], [wgpu::TextureView; 2]) {
        let tables = &self.tables;
        ([&tables.params, &tables.cells], self.atlas.planes.views())
    }

    fn evict(&mut self, tile: Tile) -> Option<SlotPlace> {
        let gone = self.resident.remove(&tile)?;
        self.map_is_stale = true;
        Some(gone.slot)
    }

    fn slot_for(&mut self, tile: Tile) -> SlotPlace {
        if let Some(resident) = self.resident.get(&tile) {
            return resident.slot;
        }
        if self.free.is_empty()
            && let Some(idle) = self.idle.give_way()
        {
            let frame = self.resident.get(&idle).map(|it| it.frame);
            self.evicted.extend(frame.map(|frame| (idle, frame)));
            let slot = self.evict(idle);
            self.free.extend(slot);
        }
        if self.free.is_empty() {
            self.free = self.atlas.grow(&self.gpu);
            self.generation += u64::from(!self.free.is_empty());
        }
        if let Some(slot) = self.free.pop() {
            return slot;
        }
        let oldest = self.resident.iter().min_by_key(|(_, r)| r.touched);
        let oldest = oldest.map(|(&tile, _)| tile);
        let slot = oldest.and_then(|tile| self.evict(tile));
        assert!(
            slot.is_some(),
            "an atlas without a free slot holds at least one tile"
        );
        slot.unwrap_or_default()
    }
}

/// Whether `picture` is what the grid expects at `tile`.
pub(crate) fn check(grid: &TileGrid, tile: Tile, picture: &Picture) -> Result<(), RenderError> {
    if !contains(grid, tile) {
        return Err(RenderError::NoSuchTile(tile));
    }
    let expected = grid.tile_size(tile);
    let found = [picture.width, picture.height];
    if expected != found || !picture.is_consistent() {
        return Err(RenderError::TileSize {
            tile,
            expected,
            found,
            planes: [0, 1, 2].map(|p| picture.planes[p].len()),
        });
    }
    Ok(())
}

impl Tables {
    fn new(gpu: &Gpu, grid: &TileGrid, colour: Colour) -> Self {
        let params = TileParams::new(grid, colour);
        let cells = u64::from(grid.tiles_in_level(0)) * 4;
        Self {
            params: filled(gpu, "tiles", wgpu::BufferUsages::UNIFORM, &[params]),
            cells: written(gpu, "cells", cells, wgpu::BufferUsages::STORAGE),
            sent: Vec::new(),
        }
    }

    fn send(&mut self, gpu: &Gpu, map: Vec<u32>) {
        if map != self.sent {
            gpu.queue
                .write_buffer(&self.cells, 0, bytemuck::cast_slice(&map));
            self.sent = map;
        }
    }

    fn bytes(&self) -> u64 {
        self.params.size() + self.cells.size()
    }
}
