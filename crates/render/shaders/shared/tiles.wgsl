// Which texel holds the sample of a level at a place?
//
// Places are level-0 pixels of a face. The samples of a level are evenly spaced over a segment: the
// whole face in a pyramid, one cell in a grid, whose cells begin a new row of samples each.

struct Level {
    span: vec2f,
    tiles: vec2u,
    scale: f32,
    chroma_offset: f32,
    first_slot: u32,
    unused: u32,
}

struct Tiles {
    levels: array<Level, 8>,
    size: vec2f,
    segment: vec2f,
    cells: vec2u,
    base_step: vec2u,
    slot: vec2u,
    slots_across: vec2u,
    segments: vec2u,
    coarsest: u32,
    octaves: u32,
    growth: f32,
    coarsest_scale: f32,
    unused: vec2u,
    rgb_from_yuv: array<vec4f, 3>,
}

@group(0) @binding(0) var<uniform> tiles: Tiles;
// Slot + 1 of every tile, level by level; 0 for a tile that is not in the atlas.
@group(0) @binding(1) var<storage, read> slots: array<u32>;
// Finest level shown over every cell.
@group(0) @binding(2) var<storage, read> level_map: array<u32>;
@group(0) @binding(3) var atlas_luma: texture_2d_array<f32>;
@group(0) @binding(4) var atlas_chroma: texture_2d_array<f32>;
@group(0) @binding(5) var base_luma: texture_2d_array<f32>;
@group(0) @binding(6) var base_chroma: texture_2d_array<f32>;

const LUMA = 0u;
const CHROMA = 1u;

// Level-0 pixels from one sample to the next.
fn pitch_of(plane: u32, level: u32) -> f32 {
    return tiles.levels[level].scale * f32(1u + plane);
}

// Where a sample lies within the pitch that it stands for, 0 to 1.
fn offset_of(plane: u32, level: u32) -> vec2f {
    return vec2f(select(0.5, tiles.levels[level].chroma_offset, plane == CHROMA), 0.5);
}

fn cell_index(face: u32, cell: vec2u) -> u32 {
    return (face * tiles.cells.y + cell.y) * tiles.cells.x + cell.x;
}

fn tile_at(level: u32, place: vec2f) -> vec2u {
    let tile = vec2u(max(place / tiles.levels[level].span, vec2f(0.0)));
    return min(tile, tiles.levels[level].tiles - 1u);
}

// Finest level shown at a place.
fn level_at(face: u32, place: vec2f) -> u32 {
    return level_map[cell_index(face, tile_at(0u, place))];
}

// A tile on the GPU: what it covers, in level-0 pixels, and its top left luma texel.
struct Source {
    level: u32,
    low: vec2f,
    high: vec2f,
    corner: vec2u,
    layer: u32,
}

// The tile of `level` at a place; it must be resident.
fn source_at(level: u32, face: u32, place: vec2f) -> Source {
    let lattice = tiles.levels[level];
    let tile = tile_at(level, place);
    let low = vec2f(tile) * lattice.span;
    let high = min(low + lattice.span, tiles.size);
    if (level == tiles.coarsest) {
        return Source(level, low, high, tile * tiles.base_step, face);
    }
    let rank = (face * lattice.tiles.y + tile.y) * lattice.tiles.x + tile.x;
    let slot = max(slots[lattice.first_slot + rank], 1u) - 1u;
    let in_layer = tiles.slots_across.x * tiles.slots_across.y;
    let layer = slot / in_layer;
    let at = slot - layer * in_layer;
    let row = at / tiles.slots_across.x;
    let corner = vec2u(at - row * tiles.slots_across.x, row) * tiles.slot;
    return Source(level, low, high, corner, layer);
}

// Start of the segment around a place.
fn segment_start(place: vec2f) -> vec2f {
    let last = vec2f(tiles.segments) - 1.0;
    return clamp(floor(place / tiles.segment), vec2f(0.0), last) * tiles.segment;
}

// Mip of the tile that has the spacing of `level`.
fn mip_of(source: Source, level: u32) -> u32 {
    return (level - source.level) * tiles.octaves;
}

// The texel of sample (0, 0) of a segment, at the spacing of `level`, as if the tile held it.
fn first_texel(source: Source, plane: u32, level: u32, start: vec2f) -> vec2i {
    let corner = vec2i((source.corner >> vec2u(plane)) >> vec2u(mip_of(source, level)));
    return corner - vec2i(floor((source.low - start) / pitch_of(plane, level)));
}

// One sample: Y, or U and V.
fn load(source: Source, plane: u32, texel: vec2i, mip: u32) -> vec2f {
    if (source.level == tiles.coarsest) {
        if (plane == LUMA) {
            return textureLoad(base_luma, texel, source.layer, 0).xy;
        }
        return textureLoad(base_chroma, texel, source.layer, 0).xy;
    }
    if (plane == LUMA) {
        return textureLoad(atlas_luma, texel, source.layer, mip).xy;
    }
    return textureLoad(atlas_chroma, texel, source.layer, mip).xy;
}

// The sample of `level` that covers a place. A finer tile there gives the average of its samples,
// a coarser one the sample of its own level.
fn fetch(plane: u32, level: u32, face: u32, place: vec2f) -> vec2f {
    let resident = level_at(face, place);
    let shown = max(resident, level);
    let source = source_at(select(resident, shown, shown == tiles.coarsest), face, place);
    let start = segment_start(place);
    let sample = vec2i(floor((place - start) / pitch_of(plane, shown)));
    let texel = first_texel(source, plane, shown, start) + sample;
    return load(source, plane, texel, mip_of(source, shown));
}
