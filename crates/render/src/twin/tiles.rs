//! Which sample of a level lies at a place? Twin of `shaders/shared/tiles.wgsl`.

use crate::error::RenderError;
use crate::level_map::level_map;
use crate::params::{LevelParams, SlotShape, TileParams};
use crate::reduce::{Samples, pyramid};
use crate::residency::check;
use foveal_core::asset::picture::{Colour, Picture};
use foveal_core::asset::tile_grid::{Tile, TileGrid};
use glam::{IVec2, UVec2, Vec2};
use std::collections::{BTreeMap, BTreeSet};

/// Resident tiles in main memory, under the rules of [`crate::TileStore`].
#[derive(Clone, Debug)]
pub struct TwinTiles {
    pub(super) grid: TileGrid,
    pub(super) params: TileParams,
    resident: BTreeMap<Tile, (u32, [Vec<Samples>; 3])>,
    frame: u32,
    level_map: Vec<u32>,
}

impl TwinTiles {
    /// No tiles yet; what the coarsest level lacks is drawn as code 0 in every plane.
    #[must_use]
    pub fn new(grid: &TileGrid, colour: Colour) -> Self {
        Self {
            grid: *grid,
            params: TileParams::new(grid, colour, &SlotShape::new(grid)),
            resident: BTreeMap::new(),
            frame: 0,
            level_map: level_map(grid, []),
        }
    }

    /// From now on source frame `frame` is shown: only tiles uploaded for it are.
    pub fn begin_frame(&mut self, frame: u32) {
        self.frame = frame;
        self.map_levels();
    }

    /// Makes `tile` of source frame `frame` resident, in place of the same tile of another frame.
    pub fn upload(&mut self, tile: Tile, frame: u32, picture: &Picture) -> Result<(), RenderError> {
        check(&self.grid, tile, picture)?;
        let planes = [0, 1, 2].map(|p| pyramid(&self.grid, tile, picture, p));
        self.resident.insert(tile, (frame, planes));
        self.map_levels();
        Ok(())
    }

    /// Evicts every tile that is not in `wanted`; the coarsest level always stays.
    pub fn retain(&mut self, wanted: &[Tile]) {
        let wanted: BTreeSet<Tile> = wanted.iter().copied().collect();
        let coarsest = self.grid.coarsest();
        self.resident
            .retain(|tile, _| tile.level == coarsest || wanted.contains(tile));
        self.map_levels();
    }

    /// The finest level shown over every cell: face-major, then rows, then columns.
    #[must_use]
    pub fn level_map(&self) -> &[u32] {
        &self.level_map
    }

    /// The samples of a resident tile.
    #[must_use]
    pub fn read_tile(&self, tile: Tile) -> Option<Picture> {
        let (_, planes) = self.resident.get(&tile)?;
        let [width, height] = planes[0].first()?.size;
        Some(Picture {
            width,
            height,
            planes: [0, 1, 2].map(|p: usize| planes[p][0].codes.clone()),
        })
    }

    fn map_levels(&mut self) {
        let shown = self
            .resident
            .iter()
            .filter(|(_, (frame, _))| *frame == self.frame);
        self.level_map = level_map(&self.grid, shown.map(|(&tile, _)| tile));
    }

    pub(super) fn level(&self, level: u32) -> &LevelParams {
        &self.params.levels[level as usize]
    }

    pub(super) fn size(&self) -> Vec2 {
        Vec2::from(self.params.size)
    }
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Plane {
    Luma,
    Chroma,
}

pub(super) fn pitch_of(tiles: &TwinTiles, plane: Plane, level: u32) -> f32 {
    tiles.level(level).scale * if plane == Plane::Chroma { 2.0 } else { 1.0 }
}

pub(super) fn offset_of(tiles: &TwinTiles, plane: Plane, level: u32) -> Vec2 {
    let x = match plane {
        Plane::Luma => 0.5,
        Plane::Chroma => tiles.level(level).chroma_offset,
    };
    Vec2::new(x, 0.5)
}

pub(super) fn cell_index(tiles: &TwinTiles, face: u32, cell: UVec2) -> usize {
    let [columns, rows] = tiles.params.cells;
    ((face * rows + cell.y) * columns + cell.x) as usize
}

pub(super) fn tile_at(tiles: &TwinTiles, level: u32, place: Vec2) -> UVec2 {
    let lattice = tiles.level(level);
    let tile = (place / Vec2::from(lattice.span))
        .max(Vec2::ZERO)
        .as_uvec2();
    tile.min(UVec2::from(lattice.tiles) - 1)
}

pub(super) fn level_at(tiles: &TwinTiles, face: u32, place: Vec2) -> u32 {
    tiles.level_map[cell_index(tiles, face, tile_at(tiles, 0, place))]
}

/// A tile in memory and what it covers, in level-0 pixels.
#[derive(Clone, Copy)]
pub(super) struct Source {
    pub(super) level: u32,
    pub(super) low: Vec2,
    pub(super) high: Vec2,
    tile: Tile,
}

pub(super) fn source_at(tiles: &TwinTiles, level: u32, face: u32, place: Vec2) -> Source {
    let lattice = tiles.level(level);
    let tile = tile_at(tiles, level, place);
    let low = tile.as_vec2() * Vec2::from(lattice.span);
    let high = (low + Vec2::from(lattice.span)).min(tiles.size());
    let tile = Tile {
        level: level as u8,
        face: face as u8,
        x: tile.x as u16,
        y: tile.y as u16,
    };
    Source {
        level,
        low,
        high,
        tile,
    }
}

pub(super) fn segment_start(tiles: &TwinTiles, place: Vec2) -> Vec2 {
    let segment = Vec2::from(tiles.params.segment);
    let last = UVec2::from(tiles.params.segments).as_vec2() - 1.0;
    (place / segment).floor().clamp(Vec2::ZERO, last) * segment
}

pub(super) fn mip_of(source: &Source, level: u32) -> u32 {
    level - source.level
}

pub(super) fn first_texel(
    tiles: &TwinTiles,
    source: &Source,
    plane: Plane,
    level: u32,
    start: Vec2,
) -> IVec2 {
    -((source.low - start) / pitch_of(tiles, plane, level))
        .floor()
        .as_ivec2()
}

pub(super) fn load(
    tiles: &TwinTiles,
    source: &Source,
    plane: Plane,
    texel: IVec2,
    mip: u32,
) -> Vec2 {
    let Some((_, planes)) = tiles.resident.get(&source.tile) else {
        return Vec2::ZERO;
    };
    let value = |p: usize| {
        let samples = &planes[p][mip as usize];
        let [columns, rows] = samples.size;
        let inside = texel.cmpge(IVec2::ZERO).all()
            && texel.cmplt(UVec2::from(samples.size).as_ivec2()).all();
        assert!(
            inside,
            "{texel} is outside a tile of {columns}x{rows} samples: {:?}",
            source.tile
        );
        f32::from(samples.codes[(texel.y * columns as i32 + texel.x) as usize]) / 255.0
    };
    match plane {
        Plane::Luma => Vec2::new(value(0), 0.0),
        Plane::Chroma => Vec2::new(value(1), value(2)),
    }
}

pub(super) fn fetch(tiles: &TwinTiles, plane: Plane, level: u32, face: u32, place: Vec2) -> Vec2 {
    let resident = level_at(tiles, face, place);
    let shown = resident.max(level);
    let source_level = if shown == tiles.params.coarsest {
        shown
    } else {
        resident
    };
    let source = source_at(tiles, source_level, face, place);
    let start = segment_start(tiles, place);
    let sample = ((place - start) / pitch_of(tiles, plane, shown))
        .floor()
        .as_ivec2();
    let texel = first_texel(tiles, &source, plane, shown, start) + sample;
    load(tiles, &source, plane, texel, mip_of(&source, shown))
}
