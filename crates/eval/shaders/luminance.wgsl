// How much light does each pixel give?

@group(0) @binding(0) var<uniform> level: Level;
// Red, green and blue of every pixel, four bytes a word.
@group(0) @binding(1) var<storage, read> bytes: array<u32>;
// Light of the 256 codes of red, then of green, then of blue.
@group(0) @binding(2) var<storage, read> light: array<f32>;
@group(0) @binding(3) var<storage, read_write> luminance_out: array<f32>;

fn code(byte: u32) -> u32 {
    return (bytes[byte / 4u] >> (byte % 4u * 8u)) & 255u;
}

@compute @workgroup_size(16, 16)
fn luminance(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.fine.x || id.y >= level.fine.y {
        return;
    }
    let at = id.y * level.fine.x + id.x;
    let red = light[code(at * 3u)];
    let green = light[256u + code(at * 3u + 1u)];
    let blue = light[512u + code(at * 3u + 2u)];
    luminance_out[at] = red + green + blue;
}
