// Which colour does a pixel of a view get when every level has a texture of its own?
//
// Kastner 2016, section 4.2: one texture a level that holds the whole surface, of which only the
// tiles in use are kept up to date; the level of a pixel's cell picks the texture, and nothing is
// filtered across levels. Reads the level of every cell and the textures.

@group(0) @binding(5) var luma_0: texture_2d_array<f32>;
@group(0) @binding(6) var luma_1: texture_2d_array<f32>;
@group(0) @binding(7) var luma_2: texture_2d_array<f32>;
@group(0) @binding(8) var luma_3: texture_2d_array<f32>;
@group(0) @binding(9) var luma_4: texture_2d_array<f32>;
@group(0) @binding(10) var luma_5: texture_2d_array<f32>;
@group(0) @binding(11) var luma_6: texture_2d_array<f32>;
@group(0) @binding(12) var luma_7: texture_2d_array<f32>;
@group(0) @binding(13) var chroma_0: texture_2d_array<f32>;
@group(0) @binding(14) var chroma_1: texture_2d_array<f32>;
@group(0) @binding(15) var chroma_2: texture_2d_array<f32>;
@group(0) @binding(16) var chroma_3: texture_2d_array<f32>;
@group(0) @binding(17) var chroma_4: texture_2d_array<f32>;
@group(0) @binding(18) var chroma_5: texture_2d_array<f32>;
@group(0) @binding(19) var chroma_6: texture_2d_array<f32>;
@group(0) @binding(20) var chroma_7: texture_2d_array<f32>;

fn load_luma(level: u32, texel: vec2i, face: u32) -> f32 {
    switch level {
        case 0u: { return textureLoad(luma_0, texel, face, 0).x; }
        case 1u: { return textureLoad(luma_1, texel, face, 0).x; }
        case 2u: { return textureLoad(luma_2, texel, face, 0).x; }
        case 3u: { return textureLoad(luma_3, texel, face, 0).x; }
        case 4u: { return textureLoad(luma_4, texel, face, 0).x; }
        case 5u: { return textureLoad(luma_5, texel, face, 0).x; }
        case 6u: { return textureLoad(luma_6, texel, face, 0).x; }
        default: { return textureLoad(luma_7, texel, face, 0).x; }
    }
}

fn load_chroma(level: u32, texel: vec2i, face: u32) -> vec2f {
    switch level {
        case 0u: { return textureLoad(chroma_0, texel, face, 0).xy; }
        case 1u: { return textureLoad(chroma_1, texel, face, 0).xy; }
        case 2u: { return textureLoad(chroma_2, texel, face, 0).xy; }
        case 3u: { return textureLoad(chroma_3, texel, face, 0).xy; }
        case 4u: { return textureLoad(chroma_4, texel, face, 0).xy; }
        case 5u: { return textureLoad(chroma_5, texel, face, 0).xy; }
        case 6u: { return textureLoad(chroma_6, texel, face, 0).xy; }
        default: { return textureLoad(chroma_7, texel, face, 0).xy; }
    }
}

// The texel of a level's texture whose sample covers a place.
fn texel_at(plane: u32, level: u32, place: vec2f) -> vec2i {
    let pitch = pitch_of(plane, level);
    let start = segment_start(place);
    let segment = floor(start / tiles.segment + 0.5);
    let step = ceil(min(tiles.segment, tiles.size) / pitch);
    return vec2i(segment * step + floor((place - start) / pitch));
}

@fragment
fn reconstruct_textures(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    if (!seen.inside) {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let level = level_in(shown_in(seen.face, cell_at(seen.place)));
    let luma = load_luma(level, texel_at(LUMA, level, seen.place), seen.face);
    let chroma = load_chroma(level, texel_at(CHROMA, level, seen.place), seen.face);
    return vec4f(rgb_from_yuv(vec3f(luma, chroma)), 1.0);
}
