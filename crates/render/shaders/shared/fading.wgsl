// How much of the light does each of several panels give that show one direction?

// How a panel fades into its neighbours.
struct Blend {
    // Columns of the matrix that turns (column, row, 1) into a ray in the world.
    right: vec3f,
    // One over the width of the fade, a radian.
    sharpness: f32,
    down: vec3f,
    // Where in `neighbours` this panel's begin, and how many there are.
    first: u32,
    corner: vec3f,
    count: u32,
    // The field of distances from edges: directions to the right of its chart, down it and to its
    // middle.
    chart_right: vec3f,
    // The most panels that show one direction.
    most: f32,
    chart_down: vec3f,
    // Where in `fields` its nodes begin.
    field: u32,
    chart_axis: vec3f,
    // One over the distance of nodes on the chart.
    per_step: f32,
    // Place of the first node on the chart.
    low: vec2f,
    // Columns and rows of nodes.
    nodes: vec2u,
}

@group(0) @binding(5) var<storage, read> blends: array<Blend>;
@group(0) @binding(6) var<storage, read> neighbours: array<u32>;
// Radians inside the edges that other panels cover, and inside all edges.
@group(0) @binding(9) var<storage, read> fields: array<vec2f>;

// How far inside the covered edges of a blending panel a direction lies, and inside all; below 0
// where the panel's chart ends.
fn inside_edges(blend: u32, direction: vec3f) -> vec2f {
    let scale = 2.0 / max(1.0 + dot(blends[blend].chart_axis, direction), 1e-6);
    let right = dot(blends[blend].chart_right, direction);
    let down = dot(blends[blend].chart_down, direction);
    let at = (vec2f(right, down) * scale - blends[blend].low) * blends[blend].per_step;
    let nodes = blends[blend].nodes;
    if (!(all(at >= vec2f(0.0)) && all(at <= vec2f(nodes - 1u)))) {
        return vec2f(-1.0);
    }
    let low = min(floor(at), vec2f(nodes - 2u));
    let part = at - low;
    let k = blends[blend].field + u32(low.y) * nodes.x + u32(low.x);
    let upper = mix(fields[k], fields[k + 1u], part.x);
    let lower = mix(fields[k + nodes.x], fields[k + nodes.x + 1u], part.x);
    return mix(upper, lower, part.y);
}

// The weight of a blending panel in a direction: 0 at a covered edge, 1 beyond its fade.
fn weight_of(blend: u32, inside: vec2f) -> f32 {
    return clamp(inside.x * blends[blend].sharpness, 0.0, 1.0);
}

// A panel's share of the light of a direction that it shows, and how many panels fewer than most
// show it.
fn light_shared(blend: u32, direction: vec3f) -> vec2f {
    let own = max(weight_of(blend, inside_edges(blend, direction)), 1e-6);
    var sum = own;
    var showing = 1.0;
    let end = blends[blend].first + blends[blend].count;
    for (var k = blends[blend].first; k < end; k = k + 1u) {
        let inside = inside_edges(neighbours[k], direction);
        let other = select(0.0, weight_of(neighbours[k], inside), inside.y > 0.0);
        sum += other;
        showing += select(0.0, 1.0, other > 0.0);
    }
    return vec2f(own / sum, max(blends[blend].most - showing, 0.0));
}
