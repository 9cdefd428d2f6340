// Which colour does a pixel of a view get from samples round the gaze?
//
// Within the mask, a square of pixels that moves with the gaze, a table gives the nearest sample
// (Kastner 2016, section 4.1.3: two lookups). Where that is blended, its neighbours count too, by
// the weights of Franke and Little (Franke 1982, Scattered data interpolation, Math. Comp. 38):
// ((reach - away) / (reach away))², so that a sample keeps its colour and no border between samples
// is seen. Outside the mask the resident tiles show. Reads samples, tables and the resident tiles.

struct Sparse {
    corner: vec2i,
    side: u32,
    blends: u32,
    spacing_step: f32,
    unused: f32,
    unused_pair: vec2f,
    spacings: array<vec4f, 16>,
}

@group(0) @binding(5) var<uniform> sparse: Sparse;
@group(0) @binding(6) var<storage, read> nearest: array<u32>;
@group(0) @binding(7) var<storage, read> codes: array<u32>;
@group(0) @binding(8) var<storage, read> places: array<u32>;
@group(0) @binding(9) var<storage, read> neighbours: array<u32>;

// Spacings of samples that a neighbour counts over.
const REACH = 2.0;
const NEIGHBOURS = 8u;

// Y, U and V of a sample.
fn colour_of(sample: u32) -> vec3f {
    let code = codes[sample];
    return vec3f(vec3u(code, code >> 8u, code >> 16u) & vec3u(255u)) / 255.0;
}

fn sample_place(sample: u32) -> vec2f {
    return vec2f(vec2u(places[sample], places[sample] >> 16u) & vec2u(65535u));
}

fn spacing(k: u32) -> f32 {
    return sparse.spacings[k / 4u][k % 4u];
}

// How far from a pixel of the mask samples count.
fn reach_at(pixel: vec2f) -> f32 {
    let centre = vec2f(f32(sparse.side / 2u));
    let radius = length(pixel - centre) / sparse.spacing_step;
    let k = min(u32(radius), 62u);
    return REACH * mix(spacing(k), spacing(k + 1u), min(radius - f32(k), 1.0));
}

fn sample_weight(away: f32, reach: f32) -> f32 {
    let share = max(reach - away, 0.0) / (reach * away);
    return share * share;
}

fn blended(pixel: vec2f, own: u32) -> vec3f {
    let colour = colour_of(own);
    let away = length(pixel - sample_place(own));
    if (away == 0.0) {
        return colour;
    }
    let reach = max(reach_at(pixel), 1.5 * away);
    var total = sample_weight(away, reach);
    var sum = colour * total;
    for (var k = 0u; k < NEIGHBOURS; k = k + 1u) {
        let other = neighbours[own * NEIGHBOURS + k];
        if (other == own) {
            break;
        }
        let weight = sample_weight(length(pixel - sample_place(other)), reach);
        total += weight;
        sum += colour_of(other) * weight;
    }
    return sum / total;
}

@fragment
fn interpolate_sparse(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    if (!seen.inside) {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let pixel = vec2i(floor(position.xy)) - sparse.corner;
    if (any(pixel < vec2i(0)) || any(pixel >= vec2i(i32(sparse.side)))) {
        return vec4f(picture_at(seen.face, seen.place, seen.footprint, true).colour, 1.0);
    }
    let own = nearest[u32(pixel.y) * sparse.side + u32(pixel.x)];
    if (sparse.blends == 0u) {
        return vec4f(rgb_from_yuv(colour_of(own)), 1.0);
    }
    return vec4f(rgb_from_yuv(blended(vec2f(pixel), own)), 1.0);
}
