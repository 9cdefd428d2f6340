// What does a pixel of a view show?

struct View {
    // Turns (column, row, 1) into a homogeneous place on flat content, else into a ray.
    content_from_pixel: mat3x3f,
    // The first face of the eye that looks.
    first_face: u32,
}

@group(0) @binding(4) var<uniform> view: View;

// What a pixel shows: a place on a face in level-0 pixels, and the level-0 pixels under the pixel
// on a side (at least 1).
struct SeenPlace {
    inside: bool,
    face: u32,
    place: vec2f,
    footprint: f32,
}

// Geometric mean of the stretch of the parallelogram that one step right and one step down span.
fn display_footprint(right: vec2f, down: vec2f) -> f32 {
    return sqrt(abs(right.x * down.y - right.y * down.x));
}
