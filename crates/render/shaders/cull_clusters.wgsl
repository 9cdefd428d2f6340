// cull_clusters: which clusters can be seen?
//
// Reads: bounds of clusters, placements, all clusters that may be seen. Writes: those that meet the
// field of view and do not show their back, in any order, and their number. Size: the clusters, one
// an invocation.

struct Arguments {
    corners: u32,
    shown: atomic<u32>,
    first_corner: u32,
    first_cluster: u32,
}

// The block of each cluster and its placement.
@group(0) @binding(3) var<storage, read> candidates: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> shown: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> arguments: Arguments;

const WORKGROUP = 64u;

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

@compute @workgroup_size(64)
fn cull_clusters(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    let number = id.y * groups.x * WORKGROUP + id.x;
    if (number >= arrayLength(&candidates)) {
        return;
    }
    let candidate = candidates[number];
    let bounds = bounds_of(candidate.x);
    if (meets_field(candidate.y, bounds) && !shows_back(candidate.y, bounds)) {
        shown[atomicAdd(&arguments.shown, 1u)] = candidate;
    }
}
