// Which colour does a place show, from whatever tiles are resident?
//
// Reconstruction without a border: the shown footprint (footprint.wgsl) changes without a step over
// the content; it lies between two levels, and each level is a continuous picture of its own,
// interpolated between samples that are looked up by position, whichever tile they come from.
//
// Drawn in two steps: pixels whose samples lie in one tile, then, where nothing was drawn, all
// others. The first are most, and need a tenth of the work.

// Where four samples around a place lie in one tile, if they do.
struct Footing {
    inside: bool,
    texel: vec2i,
    weight: vec2f,
}

fn footing(source: SourceTile, plane: u32, level: u32, place: vec2f) -> Footing {
    let pitch = pitch_of(plane, level);
    let start = segment_start(place);
    let along = (place - start) / pitch - offset_of(plane, level);
    let sample = floor(along);
    let low = start + sample * pitch;
    let inside = all(low >= source.low) && all(low + 2.0 * pitch <= source.high);
    let texel = first_texel(source, plane, level, start) + vec2i(sample);
    return Footing(inside, texel, along - sample);
}

// A level at a place, all four samples from one tile.
fn view_inside(source: SourceTile, plane: u32, level: u32, at: Footing) -> vec2f {
    let mip = mip_of(source, level);
    let a = load(source, plane, at.texel, mip);
    let b = load(source, plane, at.texel + vec2i(1, 0), mip);
    let c = load(source, plane, at.texel + vec2i(0, 1), mip);
    let d = load(source, plane, at.texel + vec2i(1, 1), mip);
    return mix(mix(a, b, at.weight.x), mix(c, d, at.weight.x), at.weight.y);
}

// One of the four samples of a level around a place, looked up for itself, times its weight.
fn corner_across(corner: u32, plane: u32, level: u32, face: u32, place: vec2f) -> vec2f {
    let x_axis = axis_of(plane, level, 0u);
    let y_axis = axis_of(plane, level, 1u);
    let x = bracket(x_axis, place.x, beyond_edges(face, x_axis, 0u));
    let y = bracket(y_axis, place.y, beyond_edges(face, y_axis, 1u));
    return corner_sample(corner, plane, level, face, place, x, y);
}

// How much of the finest level is drawn by a cubic instead of straight lines: all where a
// pixel of the display is at most three quarters of a texel, nothing where it is one or more.
fn cubic_share(display: f32) -> f32 {
    return clamp(4.0 - 4.0 * display, 0.0, 1.0);
}

// Weights of four samples for a place between the middle two: the interpolating cubic of Catmull
// and Rom 1974.
fn cubic_weights(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(
        -0.5 * t * s * s,
        1.0 + t * t * (1.5 * t - 2.5),
        1.0 + s * s * (1.5 * s - 2.5),
        -0.5 * s * t * t,
    );
}

// The finest level's luma in the middle of a pixel that may lie beyond the face's edge: over an
// edge the middles of the neighbour's pixels lie opposite.
fn sample_across(face: u32, middle: vec2f) -> f32 {
    let at = beside_edge(face, middle);
    return fetch(LUMA, 0u, at.face, at.place).x;
}

// One row of four samples of the finest level from one tile.
fn cubic_row(own: SourceTile, texel: vec2i, weights: vec4f) -> f32 {
    let a = load(own, LUMA, texel + vec2i(-1, 0), 0u).x;
    let b = load(own, LUMA, texel, 0u).x;
    let c = load(own, LUMA, texel + vec2i(1, 0), 0u).x;
    let d = load(own, LUMA, texel + vec2i(2, 0), 0u).x;
    return dot(vec4f(a, b, c, d), weights);
}

// Luma of the finest level by the cubic: 4 rows `within` one tile, else 16 samples, each looked up
// for itself, else nothing. Loops and no branches: software drivers walk both sides of a branch.
fn cubic_luma(
    face: u32, place: vec2f, own: SourceTile, at: Footing, within: bool, across: bool,
) -> f32 {
    let middle = floor(place - 0.5) + 0.5;
    let share = select(place - middle, at.weight, within);
    let x_weights = cubic_weights(share.x);
    let y_weights = cubic_weights(share.y);
    var luma = 0.0;
    var row = 0u;
    let rows = select(0u, 4u, within);
    while (row < rows) {
        let texel = at.texel + vec2i(0, i32(row) - 1);
        luma = luma + y_weights[row] * cubic_row(own, texel, x_weights);
        row = row + 1u;
    }
    var k = 0u;
    let end = select(0u, 16u, across && !within);
    while (k < end) {
        let step = vec2f(f32(k & 3u), f32(k >> 2u)) - 1.0;
        let weight = x_weights[k & 3u] * y_weights[k >> 2u];
        luma = luma + weight * sample_across(face, middle + step);
        k = k + 1u;
    }
    return luma;
}

// What was found at a place: Y, U and V, or in the end red, green and blue.
struct Found {
    colour: vec3f,
    // False where samples from several tiles were needed and not asked for.
    complete: bool,
}

// Y, U and V of one level at a place whose own tile is `own`; samples of several tiles only if
// they may come from `anywhere`; the finest level by a cubic to a share of `cubic`.
fn level_view(
    level: u32, face: u32, place: vec2f, own: SourceTile, anywhere: bool, cubic: f32,
) -> Found {
    var source = own;
    if (level == tiles.coarsest && own.level != level) {
        source = source_at(level, face, place, level);
    }
    let luma_at = footing(source, LUMA, level, place);
    let chroma_at = footing(source, CHROMA, level, place);
    var luma = vec2f(0.0);
    if (luma_at.inside) {
        luma = view_inside(source, LUMA, level, luma_at);
    }
    var chroma = vec2f(0.0);
    if (chroma_at.inside) {
        chroma = view_inside(source, CHROMA, level, chroma_at);
    }
    if (anywhere) {
        var corner = select(0u, 4u, luma_at.inside);
        let end = select(8u, 4u, chroma_at.inside);
        while (corner < end) {
            let plane = corner / 4u;
            let sample = corner_across(corner, plane, level, face, place);
            if (plane == LUMA) {
                luma = luma + sample;
            } else {
                chroma = chroma + sample;
            }
            corner = corner + 1u;
        }
    }
    let is_cubic = level == 0u && cubic > 0.0;
    let low = floor(place - 0.5) - 1.0;
    let within = own.level == 0u && all(low >= own.low) && all(low + 4.0 <= own.high);
    let sharp = cubic_luma(face, place, own, luma_at, is_cubic && within, is_cubic && anywhere);
    luma.x = mix(luma.x, sharp, select(0.0, cubic, is_cubic));
    let complete = anywhere || (luma_at.inside && chroma_at.inside && (within || !is_cubic));
    return Found(vec3f(luma.x, chroma), complete);
}

// Red, green and blue at a place, for an output pixel of the given footprint.
fn picture_at(face: u32, place: vec2f, display: f32, anywhere: bool) -> Found {
    let own_shown = shown_in(face, cell_at(place));
    let own = source_at(level_in(own_shown), face, place, own_shown);
    let footprint = shown_footprint(face, place, display, scale_of(own.level));
    let shown = level_of(footprint);
    var level = u32(shown);
    var blend = shown - f32(level);
    if (blend > 1023.0 / 1024.0) {
        level = level + 1u;
        blend = 0.0;
    }
    let end = level + select(1u, 2u, blend >= 1.0 / 1024.0);
    var weight = select(1.0, 1.0 - blend, end == level + 2u);
    var yuv = vec3f(0.0);
    var complete = true;
    while (level < end) {
        let view = level_view(level, face, place, own, anywhere, cubic_share(display));
        yuv = yuv + view.colour * weight;
        complete = complete && view.complete;
        weight = blend;
        level = level + 1u;
    }
    return Found(rgb_from_yuv(yuv), complete);
}
