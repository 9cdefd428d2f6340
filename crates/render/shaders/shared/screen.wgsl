// Which pixels are drawn? All of them: one triangle that covers the picture.
//
// A reconstruct pass draws in two steps, `cover` and `cover_rest`, which lies behind: its depth
// leaves what the first has drawn.

struct View {
    // Turns (column, row, 1) into a homogeneous place on flat content, into a ray on a cube.
    content_from_pixel: mat3x3f,
    // The first face of the eye that looks.
    first_face: u32,
}

@group(0) @binding(4) var<uniform> view: View;

fn corner_at(corner: u32, depth: f32) -> vec4f {
    let x = select(-1.0, 3.0, corner == 1u);
    let y = select(-1.0, 3.0, corner == 2u);
    return vec4f(x, y, depth, 1.0);
}

@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return corner_at(corner, 0.0);
}

@vertex
fn cover_rest(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return corner_at(corner, 0.5);
}

// What a pixel shows: a place on a face in level-0 pixels, and the level-0 pixels under the pixel
// on a side (at least 1).
struct Seen {
    inside: bool,
    face: u32,
    place: vec2f,
    footprint: f32,
}

// Geometric mean of the stretch of the parallelogram that one step right and one step down span.
fn display_footprint(right: vec2f, down: vec2f) -> f32 {
    return max(sqrt(abs(right.x * down.y - right.y * down.x)), 1.0);
}
