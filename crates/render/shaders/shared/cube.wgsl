// What surrounds a face of the cube?
//
// Faces, their axes and the rule for rays on an edge are those of `cube_face` and `CUBE_FACES` in
// core. A face goes on over its edge on the plane of its neighbour, unfolded about the edge.

struct Axes {
    forward: vec3f,
    right: vec3f,
    down: vec3f,
}

fn axes_of(face: u32) -> Axes {
    let x = vec3f(1.0, 0.0, 0.0);
    let y = vec3f(0.0, 1.0, 0.0);
    let z = vec3f(0.0, 0.0, 1.0);
    switch face {
        case 0u: { return Axes(-z, x, -y); }
        case 1u: { return Axes(x, z, -y); }
        case 2u: { return Axes(z, -x, -y); }
        case 3u: { return Axes(-x, -z, -y); }
        case 4u: { return Axes(y, x, -z); }
        default: { return Axes(-y, x, z); }
    }
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

// A place, and the border of its face that it came over: the low or the high one.
struct Neighbour {
    face: u32,
    place: vec2f,
    high: bool,
}

// A place on the plane of the neighbour over the low or high border of axis k, with the neighbour
// unfolded into the plane of `face`: depth beyond the edge becomes depth behind it.
fn neighbour(face: u32, place: vec2f, k: u32, high: bool) -> Neighbour {
    let axes = axes_of(face);
    let tangent = place * 2.0 / tiles.size - 1.0;
    let side = select(-1.0, 1.0, high);
    let outward = select(axes.right, axes.down, k == 1u) * side;
    let along = select(axes.down, axes.right, k == 1u) * tangent[1u - k];
    let depth = tangent[k] * side - 1.0;
    let beside = cube_face(outward);
    let beside_axes = axes_of(beside);
    let ray = outward + axes.forward * (1.0 - depth) + along;
    let back = dot(axes.forward, beside_axes.right) + dot(axes.forward, beside_axes.down);
    return Neighbour(beside, place_of(tangent_of(beside_axes, ray)), back > 0.0);
}

fn widened_across(face: u32, place: vec2f, known: f32) -> f32 {
    var widest = known;
    for (var border = 0u; border < 4u; border = border + 1u) {
        let k = border / 2u;
        let high = border % 2u == 1u;
        let depth = select(place[k], tiles.size[k] - place[k], high);
        if (depth < tiles.growth * (tiles.coarsest_scale - widest)) {
            let beside = neighbour(face, place, k, high);
            widest = widened(beside.face, beside.place, widest);
        }
    }
    return widest;
}

// How far beyond the low and the high border the next sample lies.
fn beyond_edges(face: u32, axis: Axis, k: u32) -> vec2f {
    let count = samples_in(axis, axis.last_segment);
    let last = tap_at(axis, axis.last_segment, count - 1);
    let depth = vec2f(tap_at(axis, 0, 0).centre, axis.size - last.centre);
    let middle = 0.5 * tiles.size;
    let low = neighbour(face, middle, k, false).high;
    let high = neighbour(face, middle, k, true).high;
    return vec2f(select(depth.x, depth.y, low), select(depth.x, depth.y, high));
}

// A sample beyond a border is the neighbour's first one behind it; beyond a corner of the cube,
// where three faces meet, it is the mean of the three samples there.
fn fetch_tap(plane: u32, level: u32, face: u32, x: Tap, y: Tap) -> vec2f {
    let within = vec2f(x.within, y.within);
    if (x.beyond == 0 && y.beyond == 0) {
        return fetch(plane, level, face, within);
    }
    var sum = vec2f(0.0);
    var count = 0.0;
    if (x.beyond != 0) {
        let edge = select(-0.5, tiles.size.x + 0.5, x.beyond > 0);
        let beside = neighbour(face, vec2f(edge, y.centre), 0u, x.beyond > 0);
        sum = sum + fetch(plane, level, beside.face, beside.place);
        count = count + 1.0;
    }
    if (y.beyond != 0) {
        let edge = select(-0.5, tiles.size.y + 0.5, y.beyond > 0);
        let beside = neighbour(face, vec2f(x.centre, edge), 1u, y.beyond > 0);
        sum = sum + fetch(plane, level, beside.face, beside.place);
        count = count + 1.0;
    }
    if (count > 1.5) {
        sum = sum + fetch(plane, level, face, within);
        count = count + 1.0;
    }
    return sum / count;
}
