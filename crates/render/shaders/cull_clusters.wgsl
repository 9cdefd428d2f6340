// cull_clusters: which clusters can be seen, and which triangles have they?
//
// Reads: clusters, placements, all clusters that may be seen. Writes: those that meet the field of
// view and do not show their back, in any order; their corners and how many these are. Size: the
// clusters, one a workgroup.

// As `draw_indexed_indirect` reads them, then the number of clusters.
struct Arguments {
    corners: atomic<u32>,
    instances: u32,
    first_corner: u32,
    first_vertex: u32,
    first_instance: u32,
    clusters: atomic<u32>,
}

// The block of each cluster and its placement.
@group(0) @binding(3) var<storage, read> candidates: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> shown: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> arguments: Arguments;
// The number of a cluster among those shown, then of its vertex, in the low bits.
@group(0) @binding(6) var<storage, read_write> corners: array<u32>;

const WORKGROUP = 64u;
const VERTEX_BITS = 7u;

// Whether the cluster is seen, its number and its first corner.
var<workgroup> reserved: vec3u;

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

fn is_seen(block: u32, placement: u32) -> bool {
    let bounds = bounds_of(block);
    let meets = meets_field(placement, bounds) && !shows_back(placement, bounds);
    return scene.culls == 0u || meets;
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
    let candidate = candidates[number];
    let counts = counts_of(candidate.x);
    if (lane == 0u) {
        reserved = vec3u(0u);
        if (is_seen(candidate.x, candidate.y)) {
            let cluster = atomicAdd(&arguments.clusters, 1u);
            let first = atomicAdd(&arguments.corners, 3u * counts.triangles);
            shown[cluster] = candidate;
            reserved = vec3u(1u, cluster << VERTEX_BITS, first);
        }
    }
    let own = workgroupUniformLoad(&reserved);
    if (own.x == 0u) {
        return;
    }
    let mirrored = (placements[candidate.y].flags & MIRRORED) != 0u;
    for (var corner = lane; corner < 3u * counts.triangles; corner = corner + WORKGROUP) {
        corners[own.z + corner] = own.y | vertex_at(candidate.x, counts, mirrored, corner);
    }
}
