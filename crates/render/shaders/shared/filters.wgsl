// How much of a picture does a pixel take, and by which samples?
//
// Places are in texels of the finest level, colours in linear light. See docs/papers.md.

@group(0) @binding(1) var source: texture_2d<f32>;
@group(0) @binding(2) var between: sampler;
@group(0) @binding(3) var stretched: sampler;

// A place in the source, how far it moves with one pixel to the right and one down, and where
// the part of the source begins and ends that may be taken.
struct Taken {
    at: vec2f,
    right: vec2f,
    down: vec2f,
    low: vec2f,
    high: vec2f,
}

// Half axes of the ellipse that a pixel covers, and the direction of the longer.
struct Stretch {
    major: f32,
    minor: f32,
    axis: vec2f,
}

// Feline's samples: how many, how coarse, and the step from one to the next.
struct TakenProbes {
    count: f32,
    level: f32,
    step: vec2f,
    major: f32,
}

// Samples along the longer of both steps: how many at most, how many more would fit at the ends,
// and whether the device takes its own.
struct Along {
    most: f32,
    beyond: f32,
    by_device: bool,
}

// Singular values of the map from pixels to texels.
fn stretch_of(right: vec2f, down: vec2f) -> Stretch {
    let a = right.x * right.x + down.x * down.x;
    let b = right.x * right.y + down.x * down.y;
    let c = right.y * right.y + down.y * down.y;
    let root = sqrt(0.25 * (a - c) * (a - c) + b * b);
    let major = sqrt(max(0.5 * (a + c) + root, 1e-20));
    let minor = abs(right.x * down.y - right.y * down.x) / major;
    var axis = vec2f(1.0, 0.0);
    if (root > 1e-12) {
        let turn = 0.5 * atan2(2.0 * b, a - c);
        axis = vec2f(cos(turn), sin(turn));
    }
    return Stretch(major, minor, axis);
}

// The same, with a line to this place and as far to the other side: the squares of both add up, and
// the steps are along and across what is longest then.
fn widened_by(taken: Taken, line: vec2f) -> Taken {
    let right = taken.right;
    let down = taken.down;
    let a = right.x * right.x + down.x * down.x + line.x * line.x;
    let b = right.x * right.y + down.x * down.y + line.x * line.y;
    let c = right.y * right.y + down.y * down.y + line.y * line.y;
    let root = sqrt(0.25 * (a - c) * (a - c) + b * b);
    let major = sqrt(max(0.5 * (a + c) + root, 1e-20));
    let areas = vec3f(
        right.x * down.y - right.y * down.x,
        right.x * line.y - right.y * line.x,
        down.x * line.y - down.y * line.x,
    );
    let turn = select(0.0, 0.5 * atan2(2.0 * b, a - c), root > 1e-12);
    let axis = vec2f(cos(turn), sin(turn));
    let across = vec2f(-axis.y, axis.x) * (length(areas) / major);
    return Taken(taken.at, axis * major, across, taken.low, taken.high);
}

// Feline's choice, with at most `most` samples from levels up to `last`.
fn probes_of(stretch: Stretch, most: f32, last: f32) -> TakenProbes {
    let major = max(stretch.major, 1.0);
    var minor = max(stretch.minor, 1.0);
    let wanted = 2.0 * major / minor - 1.0;
    var count = min(floor(wanted + 0.5), most);
    if (count < wanted) {
        minor = 2.0 * major / (count + 1.0);
    }
    var level = log2(minor);
    if (level > last) {
        level = last;
        count = 1.0;
    }
    var step = vec2f(0.0);
    if (count > 1.0) {
        step = stretch.axis * (2.0 * (major - minor) / (count - 1.0));
    }
    return TakenProbes(count, level, step, major);
}

// Light at a place of a level, between its texels and between levels.
fn light_at(taken: Taken, at: vec2f, level: f32) -> vec3f {
    let border = vec2f(0.5 * exp2(level));
    let middle = 0.5 * (taken.low + taken.high);
    let low = min(taken.low + border, middle);
    let inside = clamp(at, low, max(taken.high - border, middle));
    let size = vec2f(textureDimensions(source));
    return textureSampleLevel(source, between, inside / size, level).rgb;
}

// One level, as coarse as the longer step.
fn trilinear(taken: Taken) -> vec3f {
    let step = max(dot(taken.right, taken.right), dot(taken.down, taken.down));
    return light_at(taken, taken.at, max(0.5 * log2(max(step, 1e-20)), 0.0));
}

// How far the cubic undershoots: -0.5 would be Catmull and Rom's.
const UNDERSHOOT: f32 = -0.6;

// Keys' weights of four texels, by the place between the middle two.
fn keys(t: f32) -> vec4f {
    let s = 1.0 - t;
    let outer = UNDERSHOOT * vec2f(t * s * s, s * t * t);
    let first = 1.0 + t * t * ((UNDERSHOOT + 2.0) * t - (UNDERSHOOT + 3.0));
    let second = 1.0 + s * s * ((UNDERSHOOT + 2.0) * s - (UNDERSHOOT + 3.0));
    return vec4f(outer.x, first, second, outer.y);
}

// Sixteen texels by nine samples, each between the middle two texels or on an outer one.
fn bicubic(taken: Taken) -> vec3f {
    let texel = floor(taken.at - 0.5) + 0.5;
    let part = taken.at - texel;
    let wx = keys(part.x);
    let wy = keys(part.y);
    let x = vec3f(-1.0, wx.z / (wx.y + wx.z), 2.0) + texel.x;
    let y = vec3f(-1.0, wy.z / (wy.y + wy.z), 2.0) + texel.y;
    let weight_x = vec3f(wx.x, wx.y + wx.z, wx.w);
    let weight_y = vec3f(wy.x, wy.y + wy.z, wy.w);
    var sum = vec3f(0.0);
    for (var row = 0; row < 3; row = row + 1) {
        for (var column = 0; column < 3; column = column + 1) {
            let weight = weight_x[column] * weight_y[row];
            sum += weight * light_at(taken, vec2f(x[column], y[row]), 0.0);
        }
    }
    return max(sum, vec3f(0.0));
}

// Even samples along the longer of both steps, with one more `beyond` them as
// `EXT_texture_filter_anisotropic` describes; where `by_device`, what the device itself takes.
fn anisotropic(taken: Taken, along: Along) -> vec3f {
    if (along.by_device) {
        let inside = clamp(taken.at, taken.low + 0.5, taken.high - 0.5);
        let size = vec2f(textureDimensions(source));
        let right = taken.right / size;
        return textureSampleGrad(source, stretched, inside / size, right, taken.down / size).rgb;
    }
    let right = length(taken.right);
    let down = length(taken.down);
    let longest = max(right, down);
    let count = clamp(ceil(longest / max(min(right, down), 1e-10)), 1.0, along.most);
    let level = max(log2(max(longest / count, 1e-10)), 0.0);
    let step = select(taken.down, taken.right, right > down) / (count + along.beyond);
    var sum = vec3f(0.0);
    for (var k = 0.0; k < count; k = k + 1.0) {
        let n = k - 0.5 * (count - 1.0);
        sum += light_at(taken, taken.at + n * step, level);
    }
    return sum / count;
}

// Feline: samples along the longer axis, weighted by a Gaussian.
fn feline(taken: Taken, probes: TakenProbes) -> vec3f {
    var sum = vec3f(0.0);
    var weights = 0.0;
    let length = length(probes.step) / probes.major;
    for (var k = 0.0; k < probes.count; k = k + 1.0) {
        let n = k - 0.5 * (probes.count - 1.0);
        let weight = exp(-2.0 * n * n * length * length);
        sum += weight * light_at(taken, taken.at + n * probes.step, probes.level);
        weights += weight;
    }
    return sum / weights;
}

// From here on, in texels along the longer axis, less and less of a pixel is bicubic, and from
// there on none.
const FIRST_MINIFIED: f32 = 1.0;
const ALL_MINIFIED: f32 = 1.5;

// Bicubic where the source is magnified, anisotropic where it is minified.
fn automatic(taken: Taken, stretch: Stretch, along: Along) -> vec3f {
    let share = smoothstep(FIRST_MINIFIED, ALL_MINIFIED, stretch.major);
    if (share <= 0.0) {
        return bicubic(taken);
    }
    if (share >= 1.0) {
        return anisotropic(taken, along);
    }
    return mix(bicubic(taken), anisotropic(taken, along), share);
}
