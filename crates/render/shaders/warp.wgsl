// Which light does a pixel of a panel send, that all panels together show one source?
//
// One quad a panel in an atlas. A panel's matrix knows its place in the source and how the panel
// is scanned out, so pixels here are those that are sent. See shared/filters.wgsl, and
// shared/fading.wgsl for panels that overlap.

// Pixels from which on a residual says that nothing is lit: less than an unlit node adds to any
// pixel of its cells.
const UNLIT: f32 = 1e5;

struct Panel {
    // Columns of the matrix that turns (column, row, 1) into a ray of the source: right, down,
    // forward.
    right: vec3f,
    projection: u32,
    down: vec3f,
    // Light that is sent where the picture is black.
    black: f32,
    corner: vec3f,
    // Which of `blends` is this panel's, from 1 on; 0 where none is.
    blend: u32,
    origin: vec2u,
    size: vec2u,
    // Texels of the source from what the projection makes of a ray.
    scale: vec2f,
    offset: vec2f,
    // The part of the source that may be taken, in texels.
    low: vec2f,
    high: vec2f,
    gain: vec3f,
    // Where in `grids` the panel's grid begins.
    grid: u32,
    // Pixels from one node of the grid to the next; 0 where there is no grid.
    cell: u32,
    // Grids of the panel: one, or one a colour.
    channels: u32,
    // Where in `grids` the shares of light begin that pixels keep, plus 1; 0 where they keep all.
    alpha: u32,
    // Which of `sights` is that of the panel's source.
    sight: u32,
}

// How rays of a source stand in the world.
struct Sight {
    world_from_source: mat3x3f,
    source_from_world: mat3x3f,
}

struct Warp {
    atlas: vec2f,
    // What the eye makes of a point straight ahead, right and down, in radians: a line from here
    // to the other side, as long as the filter takes it to be.
    spread: vec2f,
    // 0 bilinear, 1 trilinear, 2 bicubic, 3 anisotropic, 4 Feline, 5 by the stretch.
    filter_by: u32,
    // Index of the coarsest level of the source.
    last: f32,
    most_probes: f32,
    // Whether pixels of more than one of Feline's samples are painted.
    paints: u32,
    // Whether the device's own anisotropic filter is taken.
    by_device: u32,
    unused: u32,
}

// The same as `filter_by`, known when the pipeline is built: software draws every branch of what is
// not.
override pipeline_filter: u32 = 5u;
// Whether there is a spread, known as early.
override pipeline_blurs: bool = false;

@group(0) @binding(0) var<uniform> warping: Warp;
@group(0) @binding(4) var<storage, read> panels: array<Panel>;
// Numbers of f32 as their bits, or the maps of seed 002.
@group(0) @binding(7) var<storage, read> grids: array<u32>;
@group(0) @binding(8) var<storage, read> sights: array<Sight>;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) panel: u32,
}

// A pixel after distortion, and how that moves with one pixel to the right and one down.
struct MovedPixel {
    pixel: vec2f,
    right: vec2f,
    down: vec2f,
}

@vertex
fn place_panel(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) index: u32,
) -> Corner {
    let beside = vec2f(vec2u(corner & 1u, corner >> 1u));
    let at = vec2f(panels[index].origin) + beside * vec2f(panels[index].size);
    let share = at / warping.atlas;
    return Corner(vec4f(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0), index);
}

// Columns and rows of nodes of a panel's grid.
fn nodes_of(index: u32) -> vec2u {
    let cell = panels[index].cell;
    return (panels[index].size + cell - 1u) / cell + 1u;
}

fn node(index: u32, at: vec2u, channel: u32) -> vec2f {
    let nodes = nodes_of(index);
    let k = panels[index].grid + 2u * ((channel * nodes.y + at.y) * nodes.x + at.x);
    return vec2f(bitcast<f32>(grids[k]), bitcast<f32>(grids[k + 1u]));
}

// Where light comes from that is seen in a pixel, in ideal pixels.
fn moved_by(index: u32, pixel: vec2f, channel: u32) -> MovedPixel {
    if (panels[index].cell == 0u) {
        return MovedPixel(pixel, vec2f(1.0, 0.0), vec2f(0.0, 1.0));
    }
    let cell = f32(panels[index].cell);
    let most = vec2f(nodes_of(index)) - 2.0;
    let low = clamp(floor(pixel / cell), vec2f(0.0), most);
    let part = pixel / cell - low;
    let at = vec2u(low);
    let a = node(index, at, channel);
    let b = node(index, at + vec2u(1u, 0u), channel);
    let c = node(index, at + vec2u(0u, 1u), channel);
    let d = node(index, at + vec2u(1u, 1u), channel);
    let by = mix(mix(a, b, part.x), mix(c, d, part.x), part.y);
    let right = mix(b - a, d - c, part.y) / cell;
    let down = mix(c - a, d - b, part.x) / cell;
    return MovedPixel(pixel + by, vec2f(1.0, 0.0) + right, vec2f(0.0, 1.0) + down);
}

// The place by the two maps of seed 002, of 16 bits before and 16 after the point, and by its
// third of derivatives of 8 bits up to 4: of the column with column and row, of the row.
fn mapped(index: u32, pixel: vec2f) -> Projected {
    let at = vec2u(pixel);
    let k = panels[index].grid + 3u * (at.y * panels[index].size.x + at.x);
    let whole = vec2f(vec2u(grids[k] >> 16u, grids[k] & 0xffffu));
    let part = vec2f(vec2u(grids[k + 1u] >> 16u, grids[k + 1u] & 0xffffu));
    let steps = 4.0 * unpack4x8snorm(grids[k + 2u]);
    return Projected(true, whole + part / 65536.0, steps.xz, steps.yw);
}

// How far a ray of the source moves to the end of the line that the eye makes of its light: the eye
// is turned to it by Listing's law, the shortest way from straight ahead.
fn spread_by(index: u32, ray: vec3f) -> vec3f {
    let sight = sights[panels[index].sight];
    let seen = sight.world_from_source * ray;
    let direction = normalize(seen);
    let ahead = vec3f(warping.spread.x, -warping.spread.y, 0.0);
    let onto = dot(ahead, direction) / max(1.0 - direction.z, 1e-6);
    let turned = ahead - onto * (direction - vec3f(0.0, 0.0, 1.0));
    return sight.source_from_world * (turned * length(seen));
}

// Light of the source that a pixel sees; colours may see different places.
fn seen_light(index: u32, pixel: vec2f, channel: u32) -> vec3f {
    let moved = moved_by(index, pixel, channel);
    let m = mat3x3f(panels[index].right, panels[index].down, panels[index].corner);
    let projection = panels[index].projection;
    let ray = m * vec3f(moved.pixel, 1.0);
    var seen: Projected;
    if (projection == 4u) {
        seen = mapped(index, pixel);
    } else {
        let by = mat2x3f(m * vec3f(moved.right, 0.0), m * vec3f(moved.down, 0.0));
        seen = projected(projection, ray, by[0], by[1]);
    }
    let scale = panels[index].scale;
    let at = seen.at * scale + panels[index].offset;
    let low = panels[index].low;
    let high = panels[index].high;
    let is_lit = abs(moved.pixel.x) < UNLIT;
    if (!(seen.ahead && is_lit && all(at >= low) && all(at <= high))) {
        return vec3f(0.0);
    }
    let taken = Taken(at, seen.right * scale, seen.down * scale, low, high);
    if (pipeline_blurs) {
        let line = projected(projection, ray, spread_by(index, ray), vec3f(0.0)).right;
        return filtered(widened_by(taken, line * scale));
    }
    return filtered(taken);
}

fn filtered(taken: Taken) -> vec3f {
    let stretch = stretch_of(taken.right, taken.down);
    let probes = probes_of(stretch, warping.most_probes, warping.last);
    let by_device = warping.by_device != 0u;
    let along = Along(warping.most_probes, select(1.0, 0.0, pipeline_blurs), by_device);
    var light: vec3f;
    switch (pipeline_filter) {
        case 0u: { light = light_at(taken, taken.at, 0.0); }
        case 1u: { light = trilinear(taken); }
        case 2u: { light = bicubic(taken); }
        case 3u: { light = anisotropic(taken, along); }
        case 4u: { light = feline(taken, probes); }
        default: { light = automatic(taken, stretch, along); }
    }
    if (warping.paints != 0u && probes.count > 1.0) {
        let warm = min((probes.count - 1.0) / 4.0, 1.0);
        return mix(light, vec3f(1.0, 0.5 * (1.0 - warm), 0.0), 0.5);
    }
    return light;
}

// A panel's share of the light of a pixel, and the black that it adds.
fn share_of(index: u32, pixel: vec2f) -> vec2f {
    let black = panels[index].black;
    if (panels[index].blend == 0u) {
        return vec2f(1.0, black);
    }
    let blend = panels[index].blend - 1u;
    let m = mat3x3f(blends[blend].right, blends[blend].down, blends[blend].corner);
    let green = min(panels[index].channels - 1u, 1u);
    let direction = normalize(m * vec3f(moved_by(index, pixel, green).pixel, 1.0));
    let shared_light = light_shared(blend, direction);
    return vec2f(shared_light.x, black * shared_light.y);
}

// The share of its light that a pixel keeps: two a word, row by row.
fn kept_by(index: u32, pixel: vec2f) -> f32 {
    if (panels[index].alpha == 0u) {
        return 1.0;
    }
    let at = vec2u(pixel);
    let k = at.y * panels[index].size.x + at.x;
    let pair = grids[panels[index].alpha - 1u + k / 2u];
    return f32((pair >> (16u * (k & 1u))) & 0xffffu) / 65535.0;
}

@fragment
fn warp(in: Corner) -> @location(0) vec4f {
    let index = in.panel;
    let pixel = in.position.xy - vec2f(panels[index].origin);
    var light = seen_light(index, pixel, 0u);
    if (panels[index].channels == 3u) {
        light.g = seen_light(index, pixel, 1u).g;
        light.b = seen_light(index, pixel, 2u).b;
    }
    let share = share_of(index, pixel);
    let kept = share.x * kept_by(index, pixel);
    let sent = clamp(light * panels[index].gain * kept, vec3f(0.0), vec3f(1.0));
    return vec4f(share.y + (1.0 - share.y) * sent, 1.0);
}
