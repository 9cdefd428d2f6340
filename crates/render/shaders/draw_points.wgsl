// draw_points: which colour has each pixel of the nearest point?
//
// Reads: cubes of points where they stand, blocks of points that may be seen. Writes: sRGB codes,
// or the units that would refine what is drawn. Size: a square for each of the points of a block.

struct CloudView {
    half_pixel: vec2f,
    unused_pair: vec2f,
}

// The cube of a unit where it stands. Of octants: the cube that refines one, where it is there, and
// the unit that would.
struct Cube {
    view_from_cube: array<vec4f, 3>,
    spacing: f32,
    level: u32,
    unused_pair: vec2u,
    octants: array<u32, 8>,
    refiners: array<u32, 8>,
}

@group(0) @binding(3) var<storage, read> cubes: array<Cube>;
// A cube; the number of a block of its points, then in the low bits how many there are in it.
@group(0) @binding(4) var<storage, read> blocks: array<vec2u>;
@group(0) @binding(5) var<storage, read> points: array<u32>;
@group(0) @binding(6) var<uniform> cloud: CloudView;

const BLOCK = 64u;
const COUNT_BITS = 7u;
const COUNT_MASK = 127u;
const NONE = 4294967295u;
// The highest bit of a place in a cube.
const HIGHEST = 15u;
// Half a side of a square for each metre between points: it covers those that are not there.
const COVERS = 0.75;

struct Splat {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) colour: vec3f,
    @location(1) @interpolate(flat) refiner: u32,
}

fn octant_at(place: vec3u, bit: u32) -> u32 {
    let far = (place >> vec3u(bit)) & vec3u(1u);
    return far.x | (far.y << 1u) | (far.z << 2u);
}

// The finest cube that is there round a place of a cube, and which of its octants that is.
fn finest_at(first: u32, place: vec3u) -> vec2u {
    var cube = first;
    var octant = octant_at(place, HIGHEST);
    for (var bit = HIGHEST; bit > 0u && cubes[cube].octants[octant] != NONE; bit = bit - 1u) {
        cube = cubes[cube].octants[octant];
        octant = octant_at(place, bit - 1u);
    }
    return vec2u(cube, octant);
}

fn place_in_view(cube: u32, place: vec3u) -> vec3f {
    let at = vec4f(vec3f(place), 1.0);
    let rows = cubes[cube].view_from_cube;
    return vec3f(dot(rows[0], at), dot(rows[1], at), dot(rows[2], at));
}

fn clip_from_view(place: vec3f) -> vec4f {
    let across = place.xy * scene.clip_from_view.xy + place.z * scene.clip_from_view.zw;
    return vec4f(across, scene.near, place.z);
}

// Half a side of the square of a point, at its depth: at least half a pixel.
fn half_side(spacing: f32, depth: f32) -> vec2f {
    let seen = COVERS * spacing * abs(scene.clip_from_view.xy);
    return max(seen, depth * cloud.half_pixel);
}

fn coloured(level: u32, code: vec3f) -> vec3f {
    return mix(code, ramp(f32(level) / scene.coarsest), scene.tint);
}

@vertex
fn place_splat(@builtin(vertex_index) number: u32) -> Splat {
    let block = blocks[number / (6u * BLOCK)];
    let inside = number % (6u * BLOCK);
    var splat: Splat;
    if (inside / 6u >= (block.y & COUNT_MASK)) {
        splat.position = vec4f(2.0, 2.0, 2.0, 1.0);
        return splat;
    }
    let point = 3u * ((block.y >> COUNT_BITS) * BLOCK + inside / 6u);
    let along = points[point];
    let place = vec3u(along & 65535u, along >> 16u, points[point + 1u]);
    let finest = finest_at(block.x, place);
    let at = place_in_view(block.x, place);
    // Two triangles of a square: 0, 1, 2 and 3, 2, 1.
    let corner = min(inside % 6u, 6u - inside % 6u);
    let side = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    splat.position = clip_from_view(at);
    splat.position += vec4f(side * half_side(cubes[finest.x].spacing, at.z), 0.0, 0.0);
    splat.colour = coloured(cubes[finest.x].level, unpack4x8unorm(points[point + 2u]).rgb);
    splat.refiner = cubes[finest.x].refiners[finest.y];
    return splat;
}

@fragment
fn draw_points(splat: Splat) -> @location(0) vec4f {
    return vec4f(splat.colour, 1.0);
}

@fragment
fn draw_point_refiners(splat: Splat) -> @location(0) vec4u {
    return vec4u(splat.refiner, 0u, 0u, 0u);
}
