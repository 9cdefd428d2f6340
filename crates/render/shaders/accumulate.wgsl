// accumulate: what is a step worth to every unit? Chen et al. 2022, Eq. 5.
//
// Reads: the gain of all bands, unit ids, the tables of the eye. Writes: sums of whole quanta, two
// words a unit. Size: the picture's, `RUN` rows an invocation. Whole numbers add up to the same in
// whatever order they come.

@group(0) @binding(5) var<storage, read> gains: array<f32>;
@group(0) @binding(6) var unit_ids: texture_2d<u32>;
// Low and high word of every unit's sum in two's complement; last, how many runs of pixels had an
// id of no unit.
@group(0) @binding(7) var<storage, read_write> sums: array<atomic<u32>>;

const NO_UNIT = 0xffffffffu;
const RUN = 16u;
const WORD = 4294967296.0;

// The value of a pixel from what its bands add up to, in quanta.
fn whole_value(texel: vec2u, bands: f32) -> f32 {
    let position = vec2f(texel) + 0.5;
    var value = bands + eye.constant;
    if (eye.acuity != 0.0) {
        value = value + eye.acuity / place_at(position).spacing;
    }
    if (eye.by_area == 0u) {
        return value * eye.quanta;
    }
    let distance = length(eye.gaze_from_pixel * vec3f(position, 1.0));
    return value * eye.quanta / (distance * distance * distance);
}

fn add(unit: u32, quanta: f32) {
    if (unit == NO_UNIT) {
        return;
    }
    let units = arrayLength(&sums) / 2u - 1u;
    if (unit >= units) {
        atomicAdd(&sums[2u * units], 1u);
        return;
    }
    // Multiples of a power of two take nothing from the fraction: both words are exact.
    let size = round(min(abs(quanta), eye.most_quanta));
    var high = u32(floor(size / WORD));
    var low = u32(size - f32(high) * WORD);
    if (quanta < 0.0) {
        low = ~low + 1u;
        high = ~high + select(0u, 1u, low == 0u);
    }
    let before = atomicAdd(&sums[2u * unit], low);
    let carry = select(0u, 1u, before + low < before);
    atomicAdd(&sums[2u * unit + 1u], high + carry);
}

@compute @workgroup_size(64)
fn accumulate(@builtin(global_invocation_id) id: vec3u) {
    let first = vec2u(id.x, id.y * RUN);
    if (!is_texel(first, band.fine)) {
        return;
    }
    // Neighbours mostly share a unit: one addition for each run of them.
    var unit = NO_UNIT;
    var quanta = 0.0;
    let end = min(first.y + RUN, band.fine.y);
    for (var y = first.y; y < end; y = y + 1u) {
        let texel = vec2u(first.x, y);
        let own = textureLoad(unit_ids, texel, 0).r;
        if (own != unit) {
            add(unit, quanta);
            unit = own;
            quanta = 0.0;
        }
        quanta = quanta + whole_value(texel, gains[index_of(texel, band.fine)]);
    }
    add(unit, quanta);
}
