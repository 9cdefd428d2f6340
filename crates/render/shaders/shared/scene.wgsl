// Where do clusters lie, and how do objects stand before the eye?
//
// View space is right, down, forward, in metres. A cluster is a block of words: its head, its
// vertices by number, its triangles.

struct Scene {
    clip_from_view: vec4f,
    field: vec4f,
    light: vec3f,
    near: f32,
    up: vec3f,
    tint: f32,
    coarsest: f32,
    culls: u32,
    picture: vec2u,
}

struct Placement {
    view_from_grid: array<vec4f, 3>,
    normal_from_object: array<vec4f, 3>,
    eye_in_grid: vec4f,
    colour: vec4f,
    uv_from_grid: vec4f,
    flags: u32,
    textures: u32,
    unused_pair: vec2u,
}

const NORMALS = 1u;
const COLOURS = 2u;
const UNLIT = 4u;
const MIRRORED = 8u;
const TWO_SIDED = 16u;
const TEXTURED = 32u;

const HEAD_WORDS = 10u;

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<storage, read> placements: array<Placement>;
@group(0) @binding(2) var<storage, read> words: array<u32>;

// A sphere round a cluster and a cone round its normals, on the grid.
struct Bounds {
    centre: vec3f,
    radius: f32,
    axis: vec3f,
    spread: f32,
}

// How many triangles and vertices a cluster has, and its level.
struct Counts {
    triangles: u32,
    vertices: u32,
    level: u32,
}

fn number_at(word: u32) -> f32 {
    return bitcast<f32>(words[word]);
}

fn bounds_of(block: u32) -> Bounds {
    let centre = vec3f(number_at(block), number_at(block + 1u), number_at(block + 2u));
    let axis = vec3f(number_at(block + 4u), number_at(block + 5u), number_at(block + 6u));
    return Bounds(centre, number_at(block + 3u), axis, number_at(block + 7u));
}

fn counts_of(block: u32) -> Counts {
    let counts = words[block + 8u];
    return Counts(counts & 255u, (counts >> 8u) & 255u, counts >> 16u);
}

fn refiner_of(block: u32) -> u32 {
    return words[block + 9u];
}

fn times(rows: array<vec4f, 3>, place: vec4f) -> vec3f {
    return vec3f(dot(rows[0], place), dot(rows[1], place), dot(rows[2], place));
}

// Which of a cluster's vertices is at a corner of its triangles. In a mirror corners come the other
// way round.
fn vertex_at(block: u32, counts: Counts, mirrored: bool, corner: u32) -> u32 {
    let turn = corner % 3u;
    let taken = select(turn, (3u - turn) % 3u, mirrored);
    let triangle = words[block + HEAD_WORDS + counts.vertices + corner / 3u];
    return (triangle >> (8u * taken)) & 255u;
}
