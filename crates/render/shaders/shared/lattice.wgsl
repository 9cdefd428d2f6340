// Between which two samples does a coordinate lie?
//
// One axis at a time. Inside a segment the samples are a pitch apart; where two segments meet, or a
// sample sticks out of the face, they are closer, and the weights follow their true positions, so
// that the interpolation has no step there.

struct Axis {
    size: f32,
    segment: f32,
    last_segment: i32,
    pitch: f32,
    offset: f32,
}

// A sample: a coordinate that only it covers, its centre, and whether it lies beyond the low (-1)
// or the high (1) border of the face (then the coordinates are those of the border sample).
struct Tap {
    within: f32,
    centre: f32,
    beyond: i32,
}

struct Bracket {
    low: Tap,
    high: Tap,
    weight: f32,
}

// The low or the high sample of a bracket.
fn tap_of(bracket: Bracket, high: bool) -> Tap {
    if (high) {
        return bracket.high;
    }
    return bracket.low;
}

fn weight_of(bracket: Bracket, high: bool) -> f32 {
    return select(1.0 - bracket.weight, bracket.weight, high);
}

fn axis_of(plane: u32, level: u32, k: u32) -> Axis {
    let offset = offset_of(plane, level);
    let last = i32(tiles.segments[k]) - 1;
    return Axis(tiles.size[k], tiles.segment[k], last, pitch_of(plane, level), offset[k]);
}

fn samples_in(axis: Axis, segment: i32) -> i32 {
    let covered = min(axis.segment, axis.size - f32(segment) * axis.segment);
    return i32(ceil(covered / axis.pitch));
}

// The middle of what the sample covers of the face, or its siting if that comes first.
fn tap_at(axis: Axis, segment: i32, sample: i32) -> Tap {
    let start = f32(segment) * axis.segment + f32(sample) * axis.pitch;
    let covered = min(axis.pitch, axis.size - start);
    return Tap(start + 0.5, start + min(axis.offset * axis.pitch, 0.5 * covered), 0);
}

// The two samples around coordinate `at`; `edge` is how far beyond the low and the high border of
// the face the next sample lies.
fn bracket(axis: Axis, at: f32, edge: vec2f) -> Bracket {
    let segment = clamp(i32(floor(at / axis.segment)), 0, axis.last_segment);
    let count = samples_in(axis, segment);
    let along = (at - f32(segment) * axis.segment) / axis.pitch - axis.offset;
    var sample = clamp(i32(floor(along)), -1, count - 1);
    if (sample + 1 < count && at >= tap_at(axis, segment, sample + 1).centre) {
        sample = sample + 1;
    }
    var low = tap_at(axis, segment, max(sample, 0));
    var high = tap_at(axis, segment, min(sample + 1, count - 1));
    var from_centre = low.centre;
    var to_centre = high.centre;
    if (sample < 0 && segment > 0) {
        let count_before = samples_in(axis, segment - 1);
        low = tap_at(axis, segment - 1, count_before - 1);
        // The last sample of a cell may have its centre beyond the cell.
        if (at < low.centre) {
            high = low;
            low = tap_at(axis, segment - 1, max(count_before - 2, 0));
        }
        from_centre = low.centre;
        to_centre = high.centre;
    } else if (sample < 0) {
        low.beyond = -1;
        from_centre = -edge.x;
    }
    if (sample == count - 1 && segment < axis.last_segment) {
        high = tap_at(axis, segment + 1, 0);
        to_centre = high.centre;
    } else if (sample == count - 1) {
        high.beyond = 1;
        to_centre = axis.size + edge.y;
    }
    let distance = max(to_centre - from_centre, 0.001);
    return Bracket(low, high, clamp((at - from_centre) / distance, 0.0, 1.0));
}
