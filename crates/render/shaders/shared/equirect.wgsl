// What surrounds the one picture of the whole sphere? Itself.
//
// Columns are even in yaw, rows in pitch. Over its sides it goes on at the other one, over a pole
// half a turn away. Towards the poles a step along a row is short, so that whole rows of cells lie
// near each other there: what is near is near on the sphere.

const PI = 3.1415926535897932;

// Sine of a share of half a turn, 0 to 1: Abramowitz and Stegun 1964, 4.3.97, within 2e-9.
fn sine_of(share: f32) -> f32 {
    let x = PI * min(share, 1.0 - share);
    let s = x * x;
    let high = -0.0001984090 + s * (0.0000027526 - s * 0.0000000239);
    return x + x * s * (-0.1666666664 + s * (0.0083333315 + s * high));
}

// Angles of two vectors, each `along` its first axis and `across` it, -pi to pi.
fn turns_of(along: vec2f, across: vec2f) -> vec2f {
    let most = max(max(abs(along), abs(across)), vec2f(1e-30));
    let low = arc_tangent(min(abs(along), abs(across)) / most);
    let steep = select(low, 0.5 * PI - low, abs(across) > abs(along));
    let back = select(steep, PI - steep, along < vec2f(0.0));
    return select(back, -back, across < vec2f(0.0));
}

// Where a place that may lie beyond the borders lies on the picture.
fn closed(place: vec2f) -> vec2f {
    let over_pole = place.y < 0.0 || place.y > tiles.size.y;
    let folded = select(2.0 * tiles.size.y - place.y, -place.y, place.y < 0.0);
    let y = select(place.y, folded, over_pole);
    let turned = place.x + select(0.0, 0.5 * tiles.size.x, over_pole);
    let x = turned - floor(turned / tiles.size.x) * tiles.size.x;
    return vec2f(select(0.0, x, x < tiles.size.x), y);
}

// The footprint is that of the pixel's solid angle on squares as wide as a row is high, or as its
// columns are apart where that is more.
fn seen_by(pixel: vec2f) -> SeenPlace {
    let ray = view.content_from_pixel * vec3f(pixel, 1.0);
    let across = cross(view.content_from_pixel[0], view.content_from_pixel[1]);
    let away = length(ray);
    let level = length(ray.xz);
    let angles = turns_of(vec2f(-ray.z, level), vec2f(ray.x, ray.y));
    let share = 0.5 + angles * vec2f(0.5, -1.0) / PI;
    let pitch = PI * vec2f(2.0 * level / away, 1.0) / tiles.size;
    let footprint = sqrt(abs(dot(ray, across)) / away) / (away * max(pitch.x, pitch.y));
    return SeenPlace(true, view.first_face, closed(share * tiles.size), footprint);
}

// Columns and rows between a place and others of its row and column, as they are seen.
fn seen_apart(place: vec2f, apart: vec2f) -> vec2f {
    return vec2f(apart.x * sine_of(clamp(place.y / tiles.size.y, 0.0, 1.0)), apart.y);
}

// The footprint with the cells of one row, from column `start` on, that are near on the sphere.
fn widened_row(face: u32, place: vec2f, row: u32, start: u32, count: u32, known: f32) -> f32 {
    let low_row = f32(row) * tiles.cell.y;
    let nearest = clamp(place.y, low_row, min(low_row + tiles.cell.y, tiles.size.y));
    let level = sqrt(sine_of(place.y / tiles.size.y) * sine_of(nearest / tiles.size.y));
    var widest = known;
    for (var k = 0u; k < count; k = k + 1u) {
        let column = (start + k) % tiles.cells.x;
        let low = f32(column) * tiles.cell.x;
        let high = min(low + tiles.cell.x, tiles.size.x);
        let from_middle = abs(place.x - 0.5 * (low + high));
        let around = min(from_middle, tiles.size.x - from_middle);
        let aside = max(around - 0.5 * (high - low), 0.0);
        let chord = tiles.size.x / PI * sine_of(aside / tiles.size.x) * level;
        let away = length(vec2f(chord, place.y - nearest));
        let scale = scale_of(level_in(shown_in(face, vec2u(column, row))));
        widest = max(widest, scale - away / tiles.growth);
    }
    return widest;
}

// The footprint with the cells over the borders nearby, and with those that only a step along the
// short rows near a pole lies between.
fn widened_across(face: u32, place: vec2f, known: f32) -> f32 {
    let reach = tiles.growth * (tiles.coarsest_scale - known);
    if (reach <= 0.0) {
        return known;
    }
    let to_pole = min(place.y, tiles.size.y - place.y) - reach;
    let half_turn = 0.5 * tiles.size.x;
    let level = sine_of(clamp(to_pole / tiles.size.y, 0.0, 0.5));
    let half = min(0.5 * PI * reach / max(level, 1e-6), half_turn);
    let around = vec2f(half, reach);
    let low = place - around;
    let high = place + around;
    let from_cell = cell_at(low);
    let to_cell = cell_at(high);
    let within = all(low >= vec2f(0.0)) && all(high < tiles.size) && half < half_turn;
    if (within && all(from_cell == to_cell)) {
        return known;
    }
    let start = cell_at(closed(vec2f(low.x, place.y))).x;
    let count = min(u32(2.0 * half / tiles.cell.x) + 3u, tiles.cells.x);
    var widest = known;
    for (var row = from_cell.y; row <= to_cell.y; row = row + 1u) {
        widest = widened_row(face, place, row, start, count, widest);
    }
    return widest;
}

// A place beyond an edge: what lies there.
struct Beside {
    face: u32,
    place: vec2f,
}

fn beside_edge(face: u32, place: vec2f) -> Beside {
    return Beside(face, clamp(closed(place), vec2f(0.5), tiles.size - 0.5));
}

fn last_tap(axis: Axis) -> Tap {
    return tap_at(axis, axis.last_segment, samples_in(axis, axis.last_segment) - 1);
}

// How far beyond the low and the high border the next sample lies: at the sides, the other
// border's; over a pole, the same row's.
fn beyond_edges(face: u32, axis: Axis, k: u32) -> vec2f {
    let depths = vec2f(tap_at(axis, 0, 0).centre, axis.size - last_tap(axis).centre);
    return select(depths.yx, depths, k == 1u);
}

// Over a pole the border row goes on half a turn away, where it is interpolated again.
fn corner_sample(
    corner: u32, plane: u32, level: u32, face: u32, place: vec2f, x: Bracket, y: Bracket,
) -> vec2f {
    let right = (corner & 1u) != 0u;
    let below = (corner & 2u) != 0u;
    let row = tap_of(y, below);
    let axis = axis_of(plane, level, 0u);
    let turned = closed(vec2f(place.x + 0.5 * tiles.size.x, place.y)).x;
    var along = x;
    if (row.beyond != 0) {
        along = bracket(axis, turned, beyond_edges(face, axis, 0u));
    }
    let column = tap_of(along, right);
    var within = column.within;
    within = select(within, last_tap(axis).within, column.beyond < 0);
    within = select(within, tap_at(axis, 0, 0).within, column.beyond > 0);
    let weight = weight_of(along, right) * weight_of(y, below);
    return fetch(plane, level, face, vec2f(within, row.within)) * weight;
}
