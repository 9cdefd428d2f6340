// What do the two channels see of a frame of some age?

struct Tap {
    // Weights of the sustained and the transient channel.
    weights: vec2<f32>,
    // Whether this is the first frame that is added.
    is_first: u32,
    spare: u32,
}

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<uniform> tap: Tap;
@group(0) @binding(2) var<storage, read> reference: array<f32>;
@group(0) @binding(3) var<storage, read> test: array<f32>;
// Sustained reference and test, transient reference and test.
@group(0) @binding(4) var<storage, read_write> planes: array<vec4<f32>>;

@compute @workgroup_size(16, 16)
fn temporal(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.fine.x || id.y >= level.fine.y {
        return;
    }
    let at = id.y * level.fine.x + id.x;
    let frame = vec2<f32>(reference[at], test[at]);
    let added = vec4<f32>(frame * tap.weights.x, frame * tap.weights.y);
    if tap.is_first == 1u {
        planes[at] = added;
    } else {
        planes[at] += added;
    }
}
