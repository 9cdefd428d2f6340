// What surrounds a face of the cube?
//
// Faces, their axes and the rule for rays on an edge are those of `cube_face` and `CUBE_FACES` in
// core. A face goes on over its edge on the plane of its neighbour, unfolded about the edge.

struct Axes {
    forward: vec3f,
    right: vec3f,
    down: vec3f,
}

// The four faces around the horizon are quarter turns of the first; top and bottom look up and down.
fn axes_of(face: u32) -> Axes {
    let turn = f32(face);
    let cosine = 1.0 - min(turn, 4.0 - turn);
    let sine = (2.0 - turn) * f32(face & 1u);
    let up = 9.0 - 2.0 * turn;
    let is_polar = face > 3u;
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
    return (tangent + 1.0) * 0.5 * tiles.size;
}

fn seen_by(pixel: vec2f) -> Seen {
    let ray = view.content_from_pixel * vec3f(pixel, 1.0);
    let face = cube_face(ray);
    let axes = axes_of(face);
    let place = place_of(tangent_of(axes, ray));
    let right = place_of(tangent_of(axes, ray + view.content_from_pixel[0]));
    let down = place_of(tangent_of(axes, ray + view.content_from_pixel[1]));
    return Seen(true, face, place, display_footprint(right - place, down - place));
}

// Bit face * 4 + k * 2 + high: whether the neighbour over the low or high border of axis k touches
// the face with a high border of its own.
const TOUCHES_HIGH = 0xf019d5u;

fn touches_high(face: u32, k: u32, high: u32) -> bool {
    return ((TOUCHES_HIGH >> (face * 4u + k * 2u + high)) & 1u) != 0u;
}

struct Neighbour {
    face: u32,
    place: vec2f,
}

// A place on the plane of the neighbour over the low or high border of axis k, with the neighbour
// unfolded into the plane of `face`: depth beyond the edge becomes depth behind it.
fn neighbour(face: u32, place: vec2f, k: u32, high: bool) -> Neighbour {
    let axes = axes_of(face);
    let tangent = place * 2.0 / tiles.size - 1.0;
    let across = select(tangent.x, tangent.y, k == 1u);
    let along = select(axes.down * tangent.y, axes.right * tangent.x, k == 1u);
    let side = select(-1.0, 1.0, high);
    let outward = select(axes.right, axes.down, k == 1u) * side;
    let depth = across * side - 1.0;
    let beside = cube_face(outward);
    let ray = outward + axes.forward * (1.0 - depth) + along;
    return Neighbour(beside, place_of(tangent_of(axes_of(beside), ray)));
}

// The footprint with the cells over the edges nearby.
fn widened_across(face: u32, place: vec2f, known: f32) -> f32 {
    let reach = tiles.growth * (tiles.coarsest_scale - known);
    let near_low = place < vec2f(reach);
    let near_high = tiles.size - place < vec2f(reach);
    var borders = select(0u, 1u, near_low.x) | select(0u, 2u, near_high.x)
        | select(0u, 4u, near_low.y) | select(0u, 8u, near_high.y);
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

// How far beyond the low and the high border the next sample lies.
fn beyond_edges(face: u32, axis: Axis, k: u32) -> vec2f {
    let last = tap_at(axis, axis.last_segment, samples_in(axis, axis.last_segment) - 1);
    let low_depth = tap_at(axis, 0, 0).centre;
    let high_depth = axis.size - last.centre;
    let low = select(low_depth, high_depth, touches_high(face, k, 0u));
    let high = select(low_depth, high_depth, touches_high(face, k, 1u));
    return vec2f(low, high);
}

// A sample beyond a border is the neighbour's first one behind it; beyond a corner of the cube,
// where three faces meet, it is the mean of the three samples there.
fn fetch_tap(plane: u32, level: u32, face: u32, x: Tap, y: Tap) -> vec2f {
    var parts = select(0u, 1u, x.beyond != 0) | select(0u, 2u, y.beyond != 0);
    let count = select(1.0, 3.0, parts == 3u);
    parts = parts | select(0u, 4u, parts == 0u || parts == 3u);
    let beyond = 0.5 * tiles.size + (0.5 * tiles.size + 0.5) * vec2f(f32(x.beyond), f32(y.beyond));
    var sum = vec2f(0.0);
    while (parts != 0u) {
        let part = parts & (~parts + 1u);
        parts = parts ^ part;
        var at = Neighbour(face, vec2f(x.within, y.within));
        if (part != 4u) {
            let over_x = part == 1u;
            let place = vec2f(select(x.centre, beyond.x, over_x), select(beyond.y, y.centre, over_x));
            let high = select(y.beyond, x.beyond, over_x) > 0;
            at = neighbour(face, place, select(1u, 0u, over_x), high);
        }
        sum = sum + fetch(plane, level, at.face, at.place);
    }
    return sum / count;
}
