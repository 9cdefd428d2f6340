// footprints: how much of the view would each unit refine, and how far from the gaze?
//
// Reads: the image of units. Writes: sums for every unit. Size: the image.

struct Gazed {
    // Tangents of the field of view to the left, right, up and down.
    field: vec4f,
    // In view space: right, down, forward; of unit length.
    gaze: vec3f,
    unused: f32,
}

@group(0) @binding(0) var<uniform> gazed: Gazed;
@group(0) @binding(1) var units: texture_2d<u32>;
// For every unit: 64ths of the pixel straight ahead that its pixels fill together, their number,
// the sum of their angles to the gaze, and by how much the least of these is below MOST_ANGLE.
@group(0) @binding(2) var<storage, read_write> sums: array<atomic<u32>>;

// All angles are in sixteenths of a degree.
const PARTS_OF_RADIAN = 916.7324722;
const MOST_ANGLE = 4095u;

fn ray_of(place: vec2f) -> vec3f {
    let x = mix(-gazed.field.x, gazed.field.y, place.x);
    let y = mix(-gazed.field.z, gazed.field.w, place.y);
    return vec3f(x, y, 1.0);
}

@compute @workgroup_size(8, 8)
fn footprints(@builtin(global_invocation_id) pixel: vec3u) {
    let size = textureDimensions(units);
    if (any(pixel.xy >= size)) {
        return;
    }
    let at = 4u * textureLoad(units, pixel.xy, 0).x;
    if (at / 4u >= arrayLength(&sums) / 4u) {
        return;
    }
    let ray = ray_of((vec2f(pixel.xy) + 0.5) / vec2f(size));
    let reach = length(ray);
    let angle = atan2(length(cross(ray, gazed.gaze)), dot(ray, gazed.gaze));
    let parts = min(u32(angle * PARTS_OF_RADIAN + 0.5), MOST_ANGLE);
    atomicAdd(&sums[at], u32(64.0 / (reach * reach * reach) + 0.5));
    atomicAdd(&sums[at + 1u], 1u);
    atomicAdd(&sums[at + 2u], parts);
    atomicMax(&sums[at + 3u], MOST_ANGLE - parts);
}
