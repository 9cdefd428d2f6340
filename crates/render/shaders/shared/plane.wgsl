// What surrounds the one face of flat content? Nothing: its border samples repeat.

fn seen_by(pixel: vec2f) -> SeenPlace {
    let here = view.content_from_pixel * vec3f(pixel, 1.0);
    let right = here + view.content_from_pixel[0];
    let down = here + view.content_from_pixel[1];
    let place = here.xy / here.z;
    let inside = here.z > 0.0 && all(place >= vec2f(0.0)) && all(place < tiles.size);
    let footprint = display_footprint(right.xy / right.z - place, down.xy / down.z - place);
    return SeenPlace(inside, view.first_face, place, footprint);
}

// Columns and rows between places of a face, as they are seen.
fn seen_apart(place: vec2f, apart: vec2f) -> vec2f {
    return apart;
}

fn widened_across(face: u32, place: vec2f, known: f32) -> f32 {
    return known;
}

fn beyond_edges(face: u32, axis: Axis, k: u32) -> vec2f {
    return vec2f(axis.pitch);
}

// A place beyond an edge: what lies there.
struct Beside {
    face: u32,
    place: vec2f,
}

fn beside_edge(face: u32, place: vec2f) -> Beside {
    return Beside(face, clamp(place, vec2f(0.5), tiles.size - 0.5));
}

fn corner_sample(
    corner: u32, plane: u32, level: u32, face: u32, place: vec2f, x: Bracket, y: Bracket,
) -> vec2f {
    let right = (corner & 1u) != 0u;
    let below = (corner & 2u) != 0u;
    let within = vec2f(tap_of(x, right).within, tap_of(y, below).within);
    return fetch(plane, level, face, within) * (weight_of(x, right) * weight_of(y, below));
}
