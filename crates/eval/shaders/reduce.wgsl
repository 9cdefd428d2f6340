// What does the next coarser level hold?

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<storage, read> fine: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> coarse: array<vec4<f32>>;

// Half-sample symmetric: .. 1 0 | 0 1 .. n-1 | n-1 n-2 ..
fn mirrored(index: i32, length: u32) -> u32 {
    let last = i32(length) - 1;
    var inside = index;
    if inside < 0 {
        inside = -1 - inside;
    }
    if inside > last {
        inside = 2 * last + 1 - inside;
    }
    return u32(clamp(inside, 0, last));
}

fn texel(x: u32, y: i32) -> vec4<f32> {
    return fine[mirrored(y, level.fine.y) * level.fine.x + x];
}

// A column summed up along the rows.
fn upright(x: i32, row: u32) -> vec4<f32> {
    let column = mirrored(x, level.fine.x);
    let y = 2 * i32(row);
    return KERNEL.x * (texel(column, y - 2) + texel(column, y + 2))
        + KERNEL.y * (texel(column, y - 1) + texel(column, y + 1))
        + KERNEL.z * texel(column, y);
}

// The last column: what lies inside, and what the rule of the border repeats.
fn last_column(x: i32, row: u32) -> vec4<f32> {
    let columns = i32(level.fine.x);
    let end = upright(columns - 1, row);
    var sum = KERNEL.x * upright(x - 2, row) + KERNEL.y * upright(x - 1, row)
        + KERNEL.z * upright(x, row);
    if x + 1 < columns {
        sum += KERNEL.y * end;
    }
    if level.beyond == 2u {
        return sum + KERNEL.y * end + KERNEL.x * upright(max(columns - 2, 0), row);
    }
    return sum + KERNEL.x * end;
}

@compute @workgroup_size(16, 16)
fn reduce(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.coarse.x || id.y >= level.coarse.y {
        return;
    }
    let x = 2 * i32(id.x);
    var sum: vec4<f32>;
    if id.x + 1u == level.coarse.x {
        sum = last_column(x, id.y);
    } else {
        sum = KERNEL.x * (upright(x - 2, id.y) + upright(x + 2, id.y))
            + KERNEL.y * (upright(x - 1, id.y) + upright(x + 1, id.y))
            + KERNEL.z * upright(x, id.y);
    }
    coarse[id.y * level.coarse.x + id.x] = sum;
}
