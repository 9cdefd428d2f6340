// What does the heat map hold of the coarser bands?

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<storage, read> coarse: array<f32>;
@group(0) @binding(2) var<storage, read_write> fine: array<f32>;

@compute @workgroup_size(16, 16)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.fine.x || id.y >= level.fine.y {
        return;
    }
    let across = weights(id.x);
    let down = weights(id.y);
    let middle = vec2<i32>(id.xy / 2u);
    let last = vec2<i32>(level.coarse) - 1;
    var sum = 0.0;
    for (var y = 0; y < 3; y++) {
        for (var x = 0; x < 3; x++) {
            let at = vec2<u32>(clamp(middle + vec2<i32>(x, y) - 1, vec2<i32>(0), last));
            sum += down[y] * across[x] * coarse[at.y * level.coarse.x + at.x];
        }
    }
    fine[id.y * level.fine.x + id.x] += sum;
}
