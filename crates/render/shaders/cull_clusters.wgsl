// cull_clusters: which clusters can be seen, and which triangles have they?
//
// Reads: clusters, placements, all clusters that may be seen, and depths that were drawn. Writes:
// those that meet the field of view, do not show their back and are not hidden, in any order; their
// corners and how many these are. Size: the clusters, one a workgroup.
//
// A picture is drawn in two goes: first what the depths of the picture before do not hide, then
// what the depths of this first go do not hide either. So the picture is that of all clusters.

// As `draw_indexed_indirect` reads them; then the number of clusters, that of those that an earlier
// go found, and 1 in the second go.
struct Arguments {
    corners: atomic<u32>,
    instances: u32,
    first_corner: u32,
    first_vertex: u32,
    first_instance: u32,
    clusters: atomic<u32>,
    first_cluster: u32,
    again: u32,
}

// The block of each cluster and its placement, which is marked where the first go found it hidden.
@group(0) @binding(3) var<storage, read_write> candidates: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> shown: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> arguments: Arguments;
// The number of a cluster among those shown, then of its vertex, in the low bits.
@group(0) @binding(6) var<storage, read_write> corners: array<u32>;
// What the depths are of: the picture before, or the first go of this.
@group(0) @binding(7) var<uniform> drawn_scene: Scene;
@group(0) @binding(8) var<storage, read> drawn_placements: array<Placement>;
@group(0) @binding(9) var<storage, read> depths: array<f32>;

// What is left out: clusters outside the field of view, those that show their backs, those hidden.
const OUTSIDE = 1u;
const BACKS = 2u;
const HIDDEN = 4u;
// Marks a placement.
const MARK = 0x80000000u;
// What rounding takes from a depth at most, as a factor.
const DEPTH_SLACK = 1.0001;

const WORKGROUP = 64u;
const VERTEX_BITS = 7u;

// Whether the cluster is drawn, its number, its first corner and its placement.
var<workgroup> reserved: vec4u;

// Whether a sphere reaches to the inner side of a plane, both on the grid.
fn reaches(plane: vec4f, bounds: Bounds) -> bool {
    let away = dot(plane.xyz, bounds.centre) + plane.w;
    return away >= -bounds.radius * length(plane.xyz);
}

fn meets_field(placement: u32, bounds: Bounds) -> bool {
    let right = placements[placement].view_from_grid[0];
    let down = placements[placement].view_from_grid[1];
    let forward = placements[placement].view_from_grid[2];
    return reaches(right + forward * scene.field.x, bounds)
        && reaches(forward * scene.field.y - right, bounds)
        && reaches(down + forward * scene.field.z, bounds)
        && reaches(forward * scene.field.w - down, bounds)
        && reaches(forward - vec4f(0.0, 0.0, 0.0, scene.near), bounds);
}

// Whether all triangles are seen from behind.
fn shows_back(placement: u32, bounds: Bounds) -> bool {
    let eye = placements[placement].eye_in_grid;
    if (eye.w == 0.0 || (placements[placement].flags & TWO_SIDED) != 0u) {
        return false;
    }
    let away = bounds.centre - eye.xyz;
    return dot(away, bounds.axis) >= bounds.spread * length(away) + bounds.radius;
}

// Whether all that a sphere may hold lies behind what was drawn.
fn is_hidden(placement: u32, bounds: Bounds) -> bool {
    let rows = drawn_placements[placement].view_from_grid;
    let centre = times(rows, vec4f(bounds.centre, 1.0));
    let stretch = vec3f(length(rows[0].xyz), length(rows[1].xyz), length(rows[2].xyz));
    let low = centre - bounds.radius * stretch;
    let high = centre + bounds.radius * stretch;
    if (low.z <= drawn_scene.near) {
        return false;
    }
    let scale = drawn_scene.clip_from_view.xy * vec2f(0.5, -0.5);
    let shift = drawn_scene.clip_from_view.zw * vec2f(0.5, -0.5) + 0.5;
    let size = vec2f(drawn_scene.picture);
    let first = (min(low.xy / low.z, low.xy / high.z) * scale + shift) * size;
    let last = (max(high.xy / low.z, high.xy / high.z) * scale + shift) * size;
    let least = vec2u(clamp(floor(first) - 1.0, vec2f(0.0), size - 1.0));
    let most = vec2u(clamp(floor(last) + 1.0, vec2f(0.0), size - 1.0));
    // The finest level of which two by two depths enclose these pixels.
    let span = max(max(most.x - least.x, most.y - least.y), 2u);
    let level = 32u - countLeadingZeros(span - 1u);
    let sides = depth_sides(drawn_scene.picture, level);
    let start = depth_start(drawn_scene.picture, level);
    let low_at = least >> vec2u(level);
    let high_at = most >> vec2u(level);
    let above = start + low_at.y * sides.x;
    let below = start + high_at.y * sides.x;
    let farthest = min(
        min(depths[above + low_at.x], depths[above + high_at.x]),
        min(depths[below + low_at.x], depths[below + high_at.x]),
    );
    return drawn_scene.near / low.z * DEPTH_SLACK < farthest;
}

fn is_seen(block: u32, placement: u32) -> bool {
    let bounds = bounds_of(block);
    return ((scene.culls & OUTSIDE) == 0u || meets_field(placement, bounds))
        && ((scene.culls & BACKS) == 0u || !shows_back(placement, bounds));
}

// Whether this go draws a candidate.
fn is_drawn(number: u32) -> bool {
    let block = candidates[number].x;
    let placement = candidates[number].y & ~MARK;
    if (arguments.again == 1u) {
        let marked = (candidates[number].y & MARK) != 0u;
        return marked && !is_hidden(placement, bounds_of(block));
    }
    let seen = is_seen(block, placement);
    if ((scene.culls & HIDDEN) == 0u) {
        return seen;
    }
    let hidden = seen && is_hidden(placement, bounds_of(block));
    candidates[number].y = placement | select(0u, MARK, hidden);
    return seen && !hidden;
}

@compute @workgroup_size(64)
fn cull_clusters(
    @builtin(workgroup_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let number = id.y * groups.x + id.x;
    if (number >= arrayLength(&candidates)) {
        return;
    }
    let block = candidates[number].x;
    let counts = counts_of(block);
    if (lane == 0u) {
        reserved = vec4u(0u);
        let placement = candidates[number].y & ~MARK;
        if (is_drawn(number)) {
            let cluster = arguments.first_cluster + atomicAdd(&arguments.clusters, 1u);
            let corner = atomicAdd(&arguments.corners, 3u * counts.triangles);
            shown[cluster] = vec2u(block, placement);
            let first = arguments.first_corner + corner;
            reserved = vec4u(1u, cluster << VERTEX_BITS, first, placement);
        }
    }
    let own = workgroupUniformLoad(&reserved);
    if (own.x == 0u) {
        return;
    }
    let mirrored = (placements[own.w].flags & MIRRORED) != 0u;
    for (var corner = lane; corner < 3u * counts.triangles; corner = corner + WORKGROUP) {
        corners[own.z + corner] = own.y | vertex_at(block, counts, mirrored, corner);
    }
}
