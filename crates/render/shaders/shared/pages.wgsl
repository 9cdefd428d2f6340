// Which colour has a texture somewhere, as far as its pages are there?
//
// A texture is a head in the table, and for each level an entry a page: the place of the finest
// page that is there and shows that part, and its level.

@group(0) @binding(5) var<storage, read> pages: array<u32>;
@group(0) @binding(6) var page_atlas: texture_2d_array<f32>;
@group(0) @binding(7) var page_sampler: sampler;

const TEXTURE_WORDS = 24u;
const FIRST_LEVEL = 8u;
const PAGE_SIDE = 256u;
const NO_PAGE = 0xffffffffu;
const NO_TEXTURE = 0xffffffffu;
const NO_TEXTURE_BYTE = 255u;
const MIRROR = 1u;
const CLAMP = 2u;

// A colour in linear light with alpha, and the level that it is of.
struct Sampled {
    colour: vec4f,
    level: u32,
}

fn page_number(word: u32) -> f32 {
    return bitcast<f32>(pages[word]);
}

fn texture_size(head: u32) -> vec2u {
    return vec2u(pages[head], pages[head + 1u]);
}

// Columns and rows of pages of a level.
fn pages_of(size: vec2u, level: u32) -> vec2u {
    let texels = (size + (1u << level) - 1u) >> vec2u(level);
    return (texels + PAGE_SIDE - 1u) / PAGE_SIDE;
}

// A place within the texture, 0 to 1, that shows what lies outside it.
fn wrapped(wrap: u32, along: f32) -> f32 {
    if (wrap == CLAMP) {
        return clamp(along, 0.0, 1.0);
    }
    if (wrap == MIRROR) {
        return 1.0 - abs(2.0 * fract(0.5 * along) - 1.0);
    }
    return fract(along);
}

// The colour at a place, in texels of level 0: of a level, or a coarser one.
fn sampled(head: u32, level: u32, place: vec2f) -> Sampled {
    let size = texture_size(head);
    let wanted = pages_of(size, level);
    let page = min(vec2u(place / f32(PAGE_SIDE << level)), wanted - 1u);
    let entry = pages[head + FIRST_LEVEL + level] + 2u * (page.y * wanted.x + page.x);
    let lies = pages[entry + 1u];
    if (lies == NO_PAGE) {
        let mean = vec3f(page_number(head + 4u), page_number(head + 5u), page_number(head + 6u));
        return Sampled(vec4f(mean, 1.0), NO_PAGE);
    }
    let found = lies >> 16u;
    let texel = place / f32(1u << found);
    let shown = min(vec2u(texel / f32(PAGE_SIDE)), pages_of(size, found) - 1u);
    let first = vec2f(f32(pages[entry] & 65535u), f32(pages[entry] >> 16u));
    let at = first + texel - vec2f(shown * PAGE_SIDE);
    let across = at / vec2f(textureDimensions(page_atlas));
    let layer = lies & 65535u;
    return Sampled(textureSampleLevel(page_atlas, page_sampler, across, layer, 0.0), found);
}

// The colour at a place of a texture, given how far it moves from one pixel to the next: between
// the two levels whose texels are nearest to a pixel, where both are there.
fn texture_colour(head: u32, uv: vec2f, right: vec2f, down: vec2f) -> vec4f {
    let size = vec2f(texture_size(head));
    let kind = pages[head + 2u];
    let inside = vec2f(wrapped((kind >> 8u) & 255u, uv.x), wrapped(kind >> 16u, uv.y));
    let texels = max(length(right * size), length(down * size));
    let coarsest = f32((kind & 255u) - 1u);
    let detail = clamp(log2(max(texels, 1e-9)), 0.0, coarsest);
    let level = u32(detail);
    let fine = sampled(head, level, inside * size);
    let share = detail - floor(detail);
    if (fine.level != level || share == 0.0) {
        return fine.colour;
    }
    let coarse = sampled(head, level + 1u, inside * size);
    return mix(fine.colour, coarse.colour, share);
}

// The texture of a vertex, by the list of its object.
fn texture_of(list: u32, number: u32) -> u32 {
    if (number == NO_TEXTURE_BYTE) {
        return NO_TEXTURE;
    }
    return TEXTURE_WORDS * pages[list + number];
}

// Whether nothing is drawn where a texture has this alpha.
fn is_cut_out(head: u32, alpha: f32) -> bool {
    return alpha < page_number(head + 3u);
}
