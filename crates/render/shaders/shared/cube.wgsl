// What surrounds a face of the cube?
//
// Faces, their axes and the rule for rays on an edge are those of `cube_face` and `CUBE_FACES` in
// core. A face goes on over its edge on the plane of its neighbour, unfolded about the edge; where
// a panorama has no face above and below, its border samples repeat.

struct Axes {
    forward: vec3f,
    right: vec3f,
    down: vec3f,
}

// A face as the left eye counts it: both eyes' faces lie in the same directions.
fn side_of(face: u32) -> u32 {
    return select(face, face - tiles.faces_of_an_eye, face >= tiles.faces_of_an_eye);
}

// Whether there are faces over the borders of axis k: always at the sides, not always over poles.
fn has_beside(k: u32) -> bool {
    return k == 0u || tiles.faces_of_an_eye == 6u;
}

// The four faces around the horizon are quarter turns of the first; the others look up and down.
fn axes_of(face: u32) -> Axes {
    let side = side_of(face);
    let turn = f32(side);
    let cosine = 1.0 - min(turn, 4.0 - turn);
    let sine = (2.0 - turn) * f32(side & 1u);
    let up = 9.0 - 2.0 * turn;
    let is_polar = side > 3u;
    let forward = select(vec3f(sine, 0.0, -cosine), vec3f(0.0, up, 0.0), is_polar);
    let right = select(vec3f(cosine, 0.0, sine), vec3f(1.0, 0.0, 0.0), is_polar);
    let down = select(vec3f(0.0, -1.0, 0.0), vec3f(0.0, 0.0, -up), is_polar);
    return Axes(forward, right, down);
}

fn cube_face(ray: vec3f) -> u32 {
    let size = abs(ray);
    if (size.z >= size.x && size.z >= size.y) {
        return select(2u, 0u, ray.z < 0.0);
    }
    if (size.x >= size.y) {
        return select(3u, 1u, ray.x > 0.0);
    }
    return select(5u, 4u, ray.y > 0.0);
}

fn tangent_of(axes: Axes, ray: vec3f) -> vec2f {
    return vec2f(dot(ray, axes.right), dot(ray, axes.down)) / dot(ray, axes.forward);
}

fn place_of(tangent: vec2f) -> vec2f {
    return (place_on_face(tangent) + 1.0) * 0.5 * tiles.size;
}

fn seen_by(pixel: vec2f) -> SeenPlace {
    let ray = view.content_from_pixel * vec3f(pixel, 1.0);
    let face = cube_face(ray);
    // A face that there is not has no number: where it would lie is drawn black.
    let axes = axes_of(min(face, tiles.faces_of_an_eye - 1u));
    let place = place_of(tangent_of(axes, ray));
    let right = place_of(tangent_of(axes, ray + view.content_from_pixel[0]));
    let down = place_of(tangent_of(axes, ray + view.content_from_pixel[1]));
    let footprint = display_footprint(right - place, down - place);
    return SeenPlace(face < tiles.faces_of_an_eye, view.first_face + face, place, footprint);
}

// Bit face * 4 + k * 2 + high: whether the neighbour over the low or high border of axis k touches
// the face with a high border of its own.
const TOUCHES_HIGH = 0xf019d5u;

fn touches_high(face: u32, k: u32, high: u32) -> bool {
    return ((TOUCHES_HIGH >> (side_of(face) * 4u + k * 2u + high)) & 1u) != 0u;
}

struct Neighbour {
    face: u32,
    place: vec2f,
    // Which of the neighbour's axes runs along the edge.
    along: u32,
}

// A place on the plane of the neighbour over the low or high border of axis k, with the neighbour
// unfolded into the plane of `face`: depth beyond the edge becomes depth behind it.
fn neighbour(face: u32, place: vec2f, k: u32, high: bool) -> Neighbour {
    let axes = axes_of(face);
    let on_face = place * 2.0 / tiles.size - 1.0;
    let across = select(on_face.x, on_face.y, k == 1u);
    let edge = select(axes.down, axes.right, k == 1u);
    let along = select(on_face.y, on_face.x, k == 1u);
    let side = select(-1.0, 1.0, high);
    let outward = select(axes.right, axes.down, k == 1u) * side;
    let depth = across * side - 1.0;
    let beside = cube_face(outward);
    let beside_axes = axes_of(beside);
    let ray = outward + axes.forward * tangent_on_face(1.0 - depth) + edge * tangent_on_face(along);
    let runs_right = abs(dot(edge, beside_axes.right)) > 0.5;
    let first = face - side_of(face);
    let place_beside = place_of(tangent_of(beside_axes, ray));
    return Neighbour(first + beside, place_beside, select(1u, 0u, runs_right));
}

// Columns and rows between places of a face, as they are seen.
fn seen_apart(place: vec2f, apart: vec2f) -> vec2f {
    return apart;
}

// The footprint with the cells over the edges nearby.
fn widened_across(face: u32, place: vec2f, known: f32) -> f32 {
    let reach = tiles.growth * (tiles.coarsest_scale - known);
    let near_low = place < vec2f(reach);
    let near_high = tiles.size - place < vec2f(reach);
    var borders = select(0u, 1u, near_low.x) | select(0u, 2u, near_high.x)
        | select(0u, 4u, near_low.y) | select(0u, 8u, near_high.y);
    borders = select(borders & 3u, borders, has_beside(1u));
    var widest = known;
    while (borders != 0u) {
        let border = borders & (~borders + 1u);
        borders = borders ^ border;
        let high = (border & 10u) != 0u;
        let beside = neighbour(face, place, select(0u, 1u, border > 2u), high);
        widest = widened(beside.face, beside.place, widest);
    }
    return widest;
}

// A place beyond an edge: what lies there. Beyond a corner of the cube it is what lies beyond the
// farther edge.
struct Beside {
    face: u32,
    place: vec2f,
}

fn beside_edge(face: u32, place: vec2f) -> Beside {
    let beyond = max(-place, place - tiles.size);
    let k = select(0u, 1u, beyond.y > beyond.x && has_beside(1u));
    let depth = select(beyond.x, beyond.y, k == 1u);
    var beside = Beside(face, place);
    if (depth > 0.0) {
        let high = select(place.x, place.y, k == 1u) > 0.0;
        let found = neighbour(face, place, k, high);
        beside = Beside(found.face, found.place);
    }
    beside.place = clamp(beside.place, vec2f(0.5), tiles.size - 0.5);
    return beside;
}

// How far beyond the low and the high border the next sample lies.
fn beyond_edges(face: u32, axis: Axis, k: u32) -> vec2f {
    let last = tap_at(axis, axis.last_segment, samples_in(axis, axis.last_segment) - 1);
    let low_depth = tap_at(axis, 0, 0).centre;
    let high_depth = axis.size - last.centre;
    let low = select(low_depth, high_depth, touches_high(face, k, 0u));
    let high = select(low_depth, high_depth, touches_high(face, k, 1u));
    return vec2f(low, high);
}

// One of the two samples of the neighbour's border that a place beyond the edge lies between, times
// its weight.
fn fetch_beside(plane: u32, level: u32, beside: Neighbour, high: bool) -> vec2f {
    let axis = axis_of(plane, level, beside.along);
    let runs_right = beside.along == 0u;
    let at = select(beside.place.y, beside.place.x, runs_right);
    let between = bracket(axis, at, vec2f(axis.pitch));
    let tap = tap_of(between, high).within;
    let place = select(vec2f(beside.place.x, tap), vec2f(tap, beside.place.y), runs_right);
    return fetch(plane, level, beside.face, place) * weight_of(between, high);
}

// A row of samples beyond one edge is the neighbour's border row, interpolated at the place itself
// and not at this face's samples, so that both faces draw the same where theirs are not opposite.
// Near a corner of the cube, where three faces meet, it is interpolated at the samples, and the
// sample beyond both edges is the mean of the three.
fn corner_sample(
    corner: u32, plane: u32, level: u32, face: u32, place: vec2f, x: Bracket, y: Bracket,
) -> vec2f {
    let right = (corner & 1u) != 0u;
    let below = (corner & 2u) != 0u;
    let x_tap = tap_of(x, right);
    let y_tap = tap_of(y, below);
    let own = fetch(plane, level, face, vec2f(x_tap.within, y_tap.within));
    let weight = vec2f(weight_of(x, right), weight_of(y, below));
    let over_x = x_tap.beyond != 0;
    let over_y = y_tap.beyond != 0 && has_beside(1u);
    if (!over_x && !over_y) {
        return own * (weight.x * weight.y);
    }
    let is_near_corner = (x.low.beyond != 0 || x.high.beyond != 0)
        && (y.low.beyond != 0 || y.high.beyond != 0) && has_beside(1u);
    let is_corner = over_x && over_y;
    let along = select(place, vec2f(x_tap.centre, y_tap.centre), is_near_corner);
    let beyond = 0.5 * tiles.size
        + (0.5 * tiles.size + 0.5) * vec2f(f32(x_tap.beyond), f32(y_tap.beyond));
    // Parts 0 and 1 are the two samples over the edge of x, 2 and 3 those over the edge of y.
    var part = select(2u, 0u, over_x);
    var end = select(2u, 4u, over_y);
    if (!is_near_corner) {
        part = part + select(u32(right), u32(below), over_x);
        end = part + 1u;
    }
    var sum = select(vec2f(0.0), own, is_corner);
    while (part < end) {
        let is_x = part < 2u;
        let at = vec2f(select(along.x, beyond.x, is_x), select(beyond.y, along.y, is_x));
        let high = select(y_tap.beyond, x_tap.beyond, is_x) > 0;
        let beside = neighbour(face, at, select(1u, 0u, is_x), high);
        sum = sum + fetch_beside(plane, level, beside, (part & 1u) != 0u);
        part = part + 1u;
    }
    if (is_near_corner) {
        return sum * (weight.x * weight.y / select(1.0, 3.0, is_corner));
    }
    return sum * select(weight.y, weight.x, over_x);
}
