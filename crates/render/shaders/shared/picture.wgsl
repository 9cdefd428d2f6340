// Which colour does a place show, from whatever tiles are resident?
//
// Reconstruction without a border: the shown footprint (footprint.wgsl) changes without a step over
// the content; it lies between two levels, and each level is a continuous picture of its own,
// interpolated between samples that are looked up by position, whichever tile they come from.

// Where four samples around a place lie in one tile, if they do.
struct Footing {
    inside: bool,
    texel: vec2i,
    weight: vec2f,
}

fn footing(source: Source, plane: u32, level: u32, place: vec2f) -> Footing {
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
fn view_inside(source: Source, plane: u32, level: u32, at: Footing) -> vec2f {
    let mip = mip_of(source, level);
    let a = load(source, plane, at.texel, mip);
    let b = load(source, plane, at.texel + vec2i(1, 0), mip);
    let c = load(source, plane, at.texel + vec2i(0, 1), mip);
    let d = load(source, plane, at.texel + vec2i(1, 1), mip);
    return mix(mix(a, b, at.weight.x), mix(c, d, at.weight.x), at.weight.y);
}

// A level at a place, each sample looked up for itself.
fn view_across(plane: u32, level: u32, face: u32, place: vec2f) -> vec2f {
    let x_axis = axis_of(plane, level, 0u);
    let y_axis = axis_of(plane, level, 1u);
    let x = bracket(x_axis, place.x, beyond_edges(face, x_axis, 0u));
    let y = bracket(y_axis, place.y, beyond_edges(face, y_axis, 1u));
    let a = fetch_tap(plane, level, face, x.low, y.low);
    let b = fetch_tap(plane, level, face, x.high, y.low);
    let c = fetch_tap(plane, level, face, x.low, y.high);
    let d = fetch_tap(plane, level, face, x.high, y.high);
    return mix(mix(a, b, x.weight), mix(c, d, x.weight), y.weight);
}

// Y, U and V of one level at a place whose own tile is `own`.
fn level_view(level: u32, face: u32, place: vec2f, own: Source) -> vec3f {
    var source = own;
    if (level == tiles.coarsest && own.level != level) {
        source = source_at(level, face, place);
    }
    var luma: vec2f;
    let luma_at = footing(source, LUMA, level, place);
    if (luma_at.inside) {
        luma = view_inside(source, LUMA, level, luma_at);
    } else {
        luma = view_across(LUMA, level, face, place);
    }
    var chroma: vec2f;
    let chroma_at = footing(source, CHROMA, level, place);
    if (chroma_at.inside) {
        chroma = view_inside(source, CHROMA, level, chroma_at);
    } else {
        chroma = view_across(CHROMA, level, face, place);
    }
    return vec3f(luma.x, chroma);
}

// Red, green and blue at a place, for an output pixel of the given footprint.
fn picture_at(face: u32, place: vec2f, display: f32) -> vec3f {
    let own = source_at(level_at(face, place), face, place);
    let footprint = shown_footprint(face, place, display, tiles.levels[own.level].scale);
    let shown = level_of(footprint);
    var level = floor(shown);
    var blend = shown - level;
    if (blend > 1023.0 / 1024.0) {
        level = level + 1.0;
        blend = 0.0;
    }
    var yuv = level_view(u32(level), face, place, own);
    if (blend >= 1.0 / 1024.0) {
        let coarser = level_view(u32(level) + 1u, face, place, own);
        yuv = mix(yuv, coarser, blend);
    }
    return rgb_from_yuv(yuv);
}
