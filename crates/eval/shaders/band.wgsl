// How visible is the difference of two pictures in one band?

struct Looking {
    // Tangents, or angles in degrees, of the gaze.
    place: vec2<f32>,
    // Length of its ray.
    length: f32,
    // Whether an eye looks at a place, and whether by true rays.
    foveated: u32,
    true_rays: u32,
    // Entries of the table over luminance and over frequency.
    luminances: u32,
    frequencies: u32,
    // Whether eccentricity raises frequency in place of an axis of its own.
    raises: u32,
    // Places a log2 of luminance, and the place of 0.
    luminance: vec2<f32>,
    // Places a root of a degree, and the last one.
    root: vec2<f32>,
    // Last places of luminance and frequency.
    most: vec2<f32>,
    // Whether the heat map is wanted.
    keeps_heat: u32,
    spare: u32,
}

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<uniform> looking: Looking;
@group(0) @binding(2) var<storage, read> fine: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> coarse: array<vec4<f32>>;
// Tangents, or angles in degrees, of the columns and then of the rows.
@group(0) @binding(4) var<storage, read> axes: array<f32>;
// Places of frequency in the table.
@group(0) @binding(5) var<storage, read> frequency: array<f32>;
// Log2 of sustained and transient sensitivity.
@group(0) @binding(6) var<storage, read> sensitivity: array<vec2<f32>>;
// Places that eccentricity raises frequency by.
@group(0) @binding(7) var<storage, read> raised: array<f32>;
// Nine numbers a workgroup: by zone sustained and transient sums, then pixels.
@group(0) @binding(8) var<storage, read_write> sums: array<f32>;

// What each pixel adds to the heat map.
@group(0) @binding(9) var<storage, read_write> heat: array<f32>;

const ZONE_BORDERS_DEG = vec2<f32>(5.0, 20.0);
const TINY = 1e-30;
const RIGHT_ANGLE = 1.5707964;
// Log2 of no difference at all.
const NOTHING = -1e9;
const GROUP = 256u;
const NUMBERS = 9u;

var<workgroup> kept: array<array<f32, NUMBERS>, GROUP>;

// The coarser level at a pixel of the finer.
fn expanded(id: vec2<u32>) -> vec4<f32> {
    let across = weights(id.x);
    let down = weights(id.y);
    let middle = vec2<i32>(id / 2u);
    let last = vec2<i32>(level.coarse) - 1;
    var sum = vec4<f32>(0.0);
    for (var y = 0; y < 3; y++) {
        for (var x = 0; x < 3; x++) {
            let at = vec2<u32>(clamp(middle + vec2<i32>(x, y) - 1, vec2<i32>(0), last));
            sum += down[y] * across[x] * coarse[at.y * level.coarse.x + at.x];
        }
    }
    return sum;
}

// Angle of a tangent from 0 to 1: Abramowitz and Stegun 1964, 4.4.49.
fn arc(x: f32) -> f32 {
    let x2 = x * x;
    var sum = 0.002866226;
    sum = sum * x2 - 0.016165737;
    sum = sum * x2 + 0.042909614;
    sum = sum * x2 - 0.07528964;
    sum = sum * x2 + 0.10656264;
    sum = sum * x2 - 0.14208899;
    sum = sum * x2 + 0.19993551;
    sum = sum * x2 - 0.33333145;
    return x * (1.0 + x2 * sum);
}

// Degrees from the gaze.
fn eccentricity(id: vec2<u32>) -> f32 {
    if looking.foveated == 0u {
        return 0.0;
    }
    let place = vec2<f32>(axes[id.x], axes[level.fine.x + id.y]);
    let apart = place - looking.place;
    if looking.true_rays == 0u {
        return sqrt(dot(apart, apart));
    }
    let turned = apart.x * looking.place.y - apart.y * looking.place.x;
    let cross = sqrt(dot(apart, apart) + turned * turned);
    let far = sqrt(1.0 + dot(place, place)) * looking.length;
    let ahead = far + (1.0 + dot(place, looking.place));
    let half = arc(min(cross, ahead) / max(cross, ahead));
    return degrees(2.0 * select(half, RIGHT_ANGLE - half, cross > ahead));
}

// The row of the table at a luminance, which lies between two.
fn along(row: u32, low: u32, share: f32) -> vec2<f32> {
    let first = row * looking.luminances + low;
    return mix(sensitivity[first], sensitivity[first + 1u], share);
}

// Log2 of the sensitivities of both channels.
fn seen(id: vec2<u32>, adaptation: f32, eccentricity: f32) -> vec2<f32> {
    let scale = looking.luminance;
    let across = clamp(log2(adaptation) * scale.x + scale.y, 0.0, looking.most.x);
    let low = min(u32(across), looking.luminances - 2u);
    let share = across - f32(low);
    let deep = min(sqrt(eccentricity) * looking.root.x, looking.root.y);
    let near = min(u32(deep), u32(looking.root.y) - 1u);
    let deeper = deep - f32(near);
    var place = frequency[select(id.y * level.fine.x + id.x, 0u, level.even == 1u)];
    if looking.raises == 1u {
        place += mix(raised[near], raised[near + 1u], deeper);
    }
    place = clamp(place, 0.0, looking.most.y);
    let row = min(u32(place), looking.frequencies - 2u);
    let between = place - f32(row);
    if looking.raises == 1u {
        return mix(along(row, low, share), along(row + 1u, low, share), between);
    }
    let above = near * looking.frequencies + row;
    let below = above + looking.frequencies;
    let first = mix(along(above, low, share), along(above + 1u, low, share), between);
    let second = mix(along(below, low, share), along(below + 1u, low, share), between);
    return mix(first, second, deeper);
}

// Log2 of the visible difference of the contrasts of reference and test.
fn difference(contrast: vec2<f32>, exponent: f32) -> f32 {
    let apart = abs(contrast.y - contrast.x);
    if apart == 0.0 {
        return NOTHING;
    }
    let mask = MASKING * min(abs(contrast.x), abs(contrast.y));
    let masked = 1.0 + exp2(min(exponent * log2(max(mask, TINY)), 126.0));
    let raw = DIFFERENCE_EXPONENT * log2(max(apart, TINY)) - log2(masked);
    return min(raw, MOST_DIFFERENCE_LOG2);
}

// A difference to a power.
fn power(log2_of: f32, exponent: f32) -> f32 {
    return select(exp2(max(exponent * log2_of, -126.0)), 0.0, log2_of == NOTHING);
}

fn of_pixel(id: vec2<u32>) -> array<f32, NUMBERS> {
    var numbers: array<f32, NUMBERS>;
    if id.x >= level.fine.x || id.y >= level.fine.y {
        return numbers;
    }
    let below = expanded(id);
    let adaptation = max(below.x, LEAST_ADAPTATION);
    let apart = eccentricity(id);
    let strength = exp2(seen(id, adaptation, apart)) * SENSITIVITY_FACTOR * level.gain;
    let detail = (fine[id.y * level.fine.x + id.x] - below) / adaptation;
    let contrast = min(detail, vec4<f32>(MOST_CONTRAST));
    var zone = 0u;
    zone += select(0u, 1u, apart >= ZONE_BORDERS_DEG.x);
    zone += select(0u, 1u, apart >= ZONE_BORDERS_DEG.y);
    let sustained = difference(contrast.xy * strength.x, MASKING_EXPONENTS.x);
    let transient = difference(contrast.zw * strength.y, MASKING_EXPONENTS.y);
    numbers[zone * 2u] = power(sustained, SPACE_EXPONENT);
    numbers[zone * 2u + 1u] = power(transient, SPACE_EXPONENT);
    numbers[6u + zone] = 1.0;
    if looking.keeps_heat == 1u {
        let sum = power(sustained, 1.0) + TRANSIENT_WEIGHT * power(transient, 1.0);
        heat[id.y * level.fine.x + id.x] = sum / level.gain;
    }
    return numbers;
}

@compute @workgroup_size(16, 16)
fn band(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    kept[lane] = of_pixel(id.xy);
    workgroupBarrier();
    for (var stride = GROUP / 2u; stride > 0u; stride /= 2u) {
        if lane < stride {
            for (var k = 0u; k < NUMBERS; k++) {
                kept[lane][k] += kept[lane + stride][k];
            }
        }
        workgroupBarrier();
    }
    if lane < NUMBERS {
        let place = level.first_sum + group.y * groups.x + group.x;
        sums[place * NUMBERS + lane] = kept[0][lane];
    }
}
