// Which texel holds the sample of a level at a place?
//
// Places are level-0 pixels of a face. The samples of a level are evenly spaced over a segment: the
// whole face in a pyramid, one cell in a grid, whose cells begin a new row of samples each.

struct Tiles {
    size: vec2f,
    segment: vec2f,
    cell: vec2f,
    base_span: vec2f,
    cells: vec2u,
    segments: vec2u,
    base_step: vec2u,
    base_face: vec2u,
    base_across: vec2u,
    slot: vec2u,
    coarsest: u32,
    octaves: u32,
    span_octaves: u32,
    growth: f32,
    coarsest_scale: f32,
    chroma_offset: f32,
    // Faces of one eye; those of the other follow.
    faces_of_an_eye: u32,
    // Of the pixels of a cube's faces: 0 gnomonic, 1 equi-angular.
    mapping: u32,
    rgb_from_yuv: array<vec4f, 3>,
}

@group(0) @binding(0) var<uniform> tiles: Tiles;
// The finest tile shown over every cell: its level, then column, row and layer of its slot.
@group(0) @binding(1) var<storage, read> cells: array<u32>;
@group(0) @binding(2) var atlas_luma: texture_2d_array<f32>;
@group(0) @binding(3) var atlas_chroma: texture_2d_array<f32>;

const LUMA = 0u;
const CHROMA = 1u;

// Level-0 pixels under a pixel of a level, on a side.
fn scale_of(level: u32) -> f32 {
    return f32(1u << (level * tiles.octaves));
}

// Level-0 pixels from one sample to the next.
fn pitch_of(plane: u32, level: u32) -> f32 {
    return scale_of(level) * f32(1u + plane);
}

// Where a sample lies within the pitch that it stands for, 0 to 1. Averaging draws chroma that
// sits on the left towards the middle.
fn offset_of(plane: u32, level: u32) -> vec2f {
    let chroma = 0.5 - (0.5 - tiles.chroma_offset) / scale_of(level);
    return vec2f(select(0.5, chroma, plane == CHROMA), 0.5);
}

fn cell_at(place: vec2f) -> vec2u {
    return min(vec2u(max(place / tiles.cell, vec2f(0.0))), tiles.cells - 1u);
}

// What is shown at a cell, level and slot in one.
fn shown_in(face: u32, cell: vec2u) -> u32 {
    return cells[(face * tiles.cells.y + cell.y) * tiles.cells.x + cell.x];
}

fn level_in(shown: u32) -> u32 {
    return shown & 15u;
}

// A tile on the GPU: what it covers, in level-0 pixels, and its top left luma texel.
struct SourceTile {
    level: u32,
    low: vec2f,
    high: vec2f,
    corner: vec2u,
    layer: u32,
}

// Left, top and layer of a face of the coarsest level. (Halves keep the quotients of whole numbers
// off their borders.)
fn base_place(face: u32) -> vec3u {
    let across = vec2f(tiles.base_across);
    let layer = floor((f32(face) + 0.5) / (across.x * across.y));
    let in_layer = f32(face) - layer * across.x * across.y;
    let row = floor((in_layer + 0.5) / across.x);
    let at = vec2u(vec2f(in_layer - row * across.x, row));
    return vec3u(at * tiles.base_face, u32(layer));
}

// The tile of `level` at a place, where `shown` is shown: that tile, or the coarsest.
fn source_at(level: u32, face: u32, place: vec2f, shown: u32) -> SourceTile {
    let is_base = level == tiles.coarsest;
    let finer_span = tiles.cell * f32(1u << (level * tiles.span_octaves));
    let span = select(finer_span, tiles.base_span, is_base);
    let last = floor((tiles.size - 0.5) / span);
    let tile = clamp(floor(place / span), vec2f(0.0), last);
    let low = tile * span;
    let high = min(low + span, tiles.size);
    let slot = vec2u(shown >> 4u, shown >> 12u) & vec2u(255u);
    let base = base_place(face);
    let corner = select(slot * tiles.slot, base.xy + vec2u(tile) * tiles.base_step, is_base);
    return SourceTile(level, low, high, corner, select(shown >> 20u, base.z, is_base));
}

// Start of the segment around a place.
fn segment_start(place: vec2f) -> vec2f {
    let last = vec2f(tiles.segments) - 1.0;
    return clamp(floor(place / tiles.segment), vec2f(0.0), last) * tiles.segment;
}

// Mip of the tile that has the spacing of `level`.
fn mip_of(source: SourceTile, level: u32) -> u32 {
    return (level - source.level) * tiles.octaves;
}

// The texel of sample (0, 0) of a segment, at the spacing of `level`, as if the tile held it.
fn first_texel(source: SourceTile, plane: u32, level: u32, start: vec2f) -> vec2i {
    let corner = vec2i((source.corner >> vec2u(plane)) >> vec2u(mip_of(source, level)));
    return corner - vec2i(floor((source.low - start) / pitch_of(plane, level)));
}

// One sample: Y, or U and V.
fn load(source: SourceTile, plane: u32, texel: vec2i, mip: u32) -> vec2f {
    if (plane == LUMA) {
        return textureLoad(atlas_luma, texel, source.layer, mip).xy;
    }
    return textureLoad(atlas_chroma, texel, source.layer, mip).xy;
}

// The sample of `level` that covers a place. A finer tile there gives the average of its samples,
// a coarser one the sample of its own level.
fn fetch(plane: u32, level: u32, face: u32, place: vec2f) -> vec2f {
    let shown = shown_in(face, cell_at(place));
    let resident = level_in(shown);
    let given = max(resident, level);
    let is_base = given == tiles.coarsest;
    let source = source_at(select(resident, given, is_base), face, place, shown);
    let start = segment_start(place);
    let sample = vec2i(floor((place - start) / pitch_of(plane, given)));
    let texel = first_texel(source, plane, given, start) + sample;
    return load(source, plane, texel, mip_of(source, given));
}
