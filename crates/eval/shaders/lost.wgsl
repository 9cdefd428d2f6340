// How many just-objectionable differences are lost at each pixel?

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<storage, read> heat: array<f32>;
// The sum over all frames.
@group(0) @binding(2) var<storage, read_write> total: array<f32>;

@compute @workgroup_size(16, 16)
fn lost(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.fine.x || id.y >= level.fine.y {
        return;
    }
    let at = id.y * level.fine.x + id.x;
    if heat[at] > 0.0 {
        total[at] += JOD_SCALE * pow(heat[at], JOD_EXPONENT);
    }
}
