//! Which sample of a level lies at a place? Twin of `shaders/shared/tiles.wgsl`.

use crate::error::RenderError;
use crate::params::TileParams;
use crate::tiles::level_map::shown_map;
use crate::tiles::reduce::pyramid;
use crate::tiles::samples::Samples;
use crate::tiles::store::check;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::view::picture::{Colour, Picture};
use glam::{IVec2, UVec2, Vec2};
use std::collections::{BTreeMap, BTreeSet};

/// Resident tiles in main memory, under the rules of [`crate::TileStore`].
#[derive(Clone, Debug)]
pub struct TwinTiles {
    pub(crate) grid: TileGrid,
    pub(crate) params: TileParams,
    colour: Colour,
    resident: BTreeMap<Tile, (u32, [Vec<Samples>; 3])>,
    /// Those that are there and not shown.
    hidden: BTreeSet<Tile>,
    frame: u32,
    level_map: Vec<u32>,
}

impl TwinTiles {
    /// No tiles yet; what the coarsest level lacks is drawn as code 0 in every plane.
    #[must_use]
    pub fn new(grid: &TileGrid, colour: Colour) -> Self {
        Self {
            grid: *grid,
            params: TileParams::new(grid, colour),
            colour,
            resident: BTreeMap::new(),
            hidden: BTreeSet::new(),
            frame: 0,
            level_map: shown_map(grid, []),
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
        let planes = [0, 1, 2].map(|p| pyramid(&self.grid, tile, picture, p, self.colour));
        self.resident.insert(tile, (frame, planes));
        self.hidden.remove(&tile);
        self.map_levels();
        Ok(())
    }

    /// Evicts every tile that is not in `wanted`; the coarsest level always stays.
    pub fn retain(&mut self, wanted: &[Tile]) {
        self.keep(wanted, &[]);
    }

    /// Shows only these tiles and the coarsest level; of the others those stay that are `staying`.
    pub fn keep(&mut self, shown: &[Tile], staying: &[Tile]) {
        let [shown, staying] =
            [shown, staying].map(|it| it.iter().copied().collect::<BTreeSet<_>>());
        let coarsest = self.grid.coarsest();
        let is_shown = |tile: &Tile| tile.level == coarsest || shown.contains(tile);
        self.resident
            .retain(|tile, _| is_shown(tile) || staying.contains(tile));
        let hides = |tile: &&Tile| !is_shown(tile);
        self.hidden = self.resident.keys().filter(hides).copied().collect();
        self.map_levels();
    }

    /// Shows a tile again that stayed; `false` where it did not.
    pub fn show(&mut self, tile: Tile) -> bool {
        self.hidden.remove(&tile);
        self.map_levels();
        self.resident.contains_key(&tile)
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
        let [width, height] = planes[0].first()?.extent.size;
        Some(Picture {
            width,
            height,
            planes: [0, 1, 2].map(|p: usize| planes[p][0].codes.clone()),
        })
    }

    /// Tiles that hold another source frame than the one shown, or none: the twin of
    /// [`crate::TileStore::wrong_frame_tiles`].
    #[must_use]
    pub fn wrong_frame_tiles(&self) -> usize {
        let base = self.grid.tiles_of(self.grid.coarsest());
        let missing = base.filter(|t| !self.resident.contains_key(t));
        let held = self.shown().filter(|(_, frame)| *frame != self.frame);
        missing.count() + held.count()
    }

    /// The tiles that are not hidden, with their frames.
    fn shown(&self) -> impl Iterator<Item = (Tile, u32)> {
        let tiles = self
            .resident
            .iter()
            .map(|(tile, (frame, _))| (*tile, *frame));
        tiles.filter(|(tile, _)| !self.hidden.contains(tile))
    }

    fn map_levels(&mut self) {
        let shown = self.shown().filter(|(_, frame)| *frame == self.frame);
        let entries = shown.map(|(tile, _)| (tile, u32::from(tile.level)));
        self.level_map = shown_map(&self.grid, entries);
    }

    pub(crate) fn size(&self) -> Vec2 {
        Vec2::from(self.params.size)
    }
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Plane {
    Luma,
    Chroma,
}

pub(crate) fn scale_of(tiles: &TwinTiles, level: u32) -> f32 {
    (1 << (level * tiles.params.octaves)) as f32
}

pub(crate) fn pitch_of(tiles: &TwinTiles, plane: Plane, level: u32) -> f32 {
    scale_of(tiles, level) * if plane == Plane::Chroma { 2.0 } else { 1.0 }
}

pub(crate) fn offset_of(tiles: &TwinTiles, plane: Plane, level: u32) -> Vec2 {
    let chroma = 0.5 - (0.5 - tiles.params.chroma_offset) / scale_of(tiles, level);
    Vec2::new(if plane == Plane::Chroma { chroma } else { 0.5 }, 0.5)
}

pub(crate) fn cell_at(tiles: &TwinTiles, place: Vec2) -> UVec2 {
    let cell = (place / Vec2::from(tiles.params.cell))
        .max(Vec2::ZERO)
        .as_uvec2();
    cell.min(UVec2::from(tiles.params.cells) - 1)
}

/// The level shown at a cell; the twin's tiles are found by it and need no slot.
pub(crate) fn shown_in(tiles: &TwinTiles, face: u32, cell: UVec2) -> u32 {
    let [columns, rows] = tiles.params.cells;
    tiles.level_map[((face * rows + cell.y) * columns + cell.x) as usize]
}

/// A tile in memory and what it covers, in level-0 pixels.
#[derive(Clone, Copy)]
pub(crate) struct SourceTile<'a> {
    pub(crate) level: u32,
    pub(crate) low: Vec2,
    pub(crate) high: Vec2,
    tile: Tile,
    /// Looked up once, not for every sample; `None` where the tile is not resident.
    planes: Option<&'a [Vec<Samples>; 3]>,
}

pub(crate) fn source_at(tiles: &TwinTiles, level: u32, face: u32, place: Vec2) -> SourceTile<'_> {
    let is_base = level == tiles.params.coarsest;
    let finer_span =
        Vec2::from(tiles.params.cell) * (1 << (level * tiles.params.span_octaves)) as f32;
    let span = if is_base {
        Vec2::from(tiles.params.base_span)
    } else {
        finer_span
    };
    let last = ((tiles.size() - 0.5) / span).floor();
    let tile = (place / span).floor().clamp(Vec2::ZERO, last);
    let low = tile * span;
    let high = (low + span).min(tiles.size());
    let tile = Tile {
        level: level as u8,
        face: face as u8,
        x: tile.x as u16,
        y: tile.y as u16,
    };
    SourceTile {
        level,
        low,
        high,
        tile,
        planes: tiles.resident.get(&tile).map(|(_, planes)| planes),
    }
}

pub(crate) fn segment_start(tiles: &TwinTiles, place: Vec2) -> Vec2 {
    let segment = Vec2::from(tiles.params.segment);
    let last = UVec2::from(tiles.params.segments).as_vec2() - 1.0;
    (place / segment).floor().clamp(Vec2::ZERO, last) * segment
}

pub(crate) fn mip_of(source: &SourceTile<'_>, level: u32) -> u32 {
    level - source.level
}

pub(crate) fn first_texel(
    tiles: &TwinTiles,
    source: &SourceTile<'_>,
    plane: Plane,
    level: u32,
    start: Vec2,
) -> IVec2 {
    -((source.low - start) / pitch_of(tiles, plane, level))
        .floor()
        .as_ivec2()
}

pub(crate) fn load(source: &SourceTile<'_>, plane: Plane, texel: IVec2, mip: u32) -> Vec2 {
    let Some(planes) = source.planes else {
        return Vec2::ZERO;
    };
    let value = |p: usize| {
        let samples = &planes[p][mip as usize];
        let [columns, rows] = samples.extent.size;
        let inside = texel.cmpge(IVec2::ZERO).all()
            && texel
                .cmplt(UVec2::from(samples.extent.size).as_ivec2())
                .all();
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

pub(crate) fn fetch(tiles: &TwinTiles, plane: Plane, level: u32, face: u32, place: Vec2) -> Vec2 {
    let resident = shown_in(tiles, face, cell_at(tiles, place));
    let given = resident.max(level);
    let is_base = given == tiles.params.coarsest;
    let source = source_at(tiles, if is_base { given } else { resident }, face, place);
    let start = segment_start(tiles, place);
    let sample = ((place - start) / pitch_of(tiles, plane, given))
        .floor()
        .as_ivec2();
    let texel = first_texel(tiles, &source, plane, given, start) + sample;
    load(&source, plane, texel, mip_of(&source, given))
}
