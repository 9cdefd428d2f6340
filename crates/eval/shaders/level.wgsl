// Which two levels does a pass look at?

struct Level {
    // Columns and rows of the finer level, and of the coarser.
    fine: vec2<u32>,
    coarse: vec2<u32>,
    // Samples beyond the right border that the last column takes in.
    beyond: u32,
    // Whether all pixels have one frequency.
    even: u32,
    // What contrast is multiplied by.
    gain: f32,
    // Where the sums of the workgroups of this band begin.
    first_sum: u32,
}

const KERNEL = vec3<f32>(0.05, 0.25, 0.4);

// Shares of three neighbouring samples of the coarser level in one of the finer, along an axis.
fn weights(index: u32) -> vec3<f32> {
    let even = vec3<f32>(2.0 * KERNEL.x, 2.0 * KERNEL.z, 2.0 * KERNEL.x);
    let odd = vec3<f32>(0.0, 2.0 * KERNEL.y, 2.0 * KERNEL.y);
    return select(even, odd, index % 2u == 1u);
}
