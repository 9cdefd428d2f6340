// How does a tile look at the next coarser level's spacing?
//
// The mean of the samples in every square of `ratio` x `ratio`, rounded, of luma as light; samples
// that the tile lacks do not count. In whole numbers, so that every device finds the same code.
//
// Reads: one mip of the atlas. Writes: a coarser mip of one layer. Size: each tile, a quad.

struct Halved {
    // What is written: column and row of the first texel, columns and rows.
    first: vec2u,
    size: vec2u,
    // What is read: the tile's texels from `low` up to `high`, that one left out.
    low: vec2u,
    high: vec2u,
    // What a written texel times `ratio` lacks to the first texel of its square.
    shift: vec2i,
    layer: u32,
    ratio: u32,
}

// Whether codes are of luma, known when the pipeline is built.
override pipeline_luma: bool = true;

@group(0) @binding(0) var<storage, read> tiles: array<Halved>;
// Light of the 256 codes, then the codes of light, four in a word.
@group(0) @binding(1) var<storage, read> lights: array<u32>;
@group(0) @binding(2) var finer: texture_2d_array<f32>;

struct Vertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) tile: u32,
}

@vertex
fn place_tile(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) index: u32,
) -> Vertex {
    let tile = tiles[index];
    let at = vec2f(tile.first + vec2u(vertex & 1u, vertex >> 1u) * tile.size);
    let share = at / vec2f(textureDimensions(finer) / tile.ratio);
    return Vertex(vec4f(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0), index);
}

// What the codes of a texel stand for.
fn value_of(codes: vec2u) -> vec2u {
    if (pipeline_luma) {
        return vec2u(lights[codes.x], 0u);
    }
    return codes;
}

// The codes of a mean.
fn codes_of(mean: vec2u) -> vec2u {
    if (pipeline_luma) {
        return vec2u((lights[256u + (mean.x >> 2u)] >> (8u * (mean.x & 3u))) & 255u, 0u);
    }
    return mean;
}

fn codes_at(texel: vec2i, layer: u32) -> vec2u {
    return vec2u(textureLoad(finer, texel, layer, 0).xy * 255.0 + 0.5);
}

@fragment
fn halve_tiles(seen: Vertex) -> @location(0) vec4f {
    let tile = tiles[seen.tile];
    let start = vec2i(seen.position.xy) * i32(tile.ratio) + tile.shift;
    let low = max(start, vec2i(tile.low));
    let high = min(start + i32(tile.ratio), vec2i(tile.high));
    let sides = vec2u(high - low);
    let count = sides.x * sides.y;
    // Half of the count rounds the mean.
    var sum = vec2u(count / 2u);
    for (var y = low.y; y < high.y; y = y + 1) {
        for (var x = low.x; x < high.x; x = x + 1) {
            sum += value_of(codes_at(vec2i(x, y), tile.layer));
        }
    }
    return vec4f(vec2f(codes_of(sum / count)) / 255.0, 0.0, 1.0);
}
