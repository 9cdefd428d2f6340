// Where on a face does an angle lie?
//
// Places on a face run from -1 to 1, beyond its edges up to 2. Gnomonic faces are even in the
// tangent of the angle, equi-angular ones in the angle: `Mapping` in core. Polynomials of
// Abramowitz and Stegun 1964, 4.4.49 and 4.3.101, within 2e-8, as a driver's own functions may be
// far off.

const GNOMONIC = 0u;
const QUARTER = 0.7853981633974483;

// Of tangents from -1 to 1.
fn arc_tangent(x: vec2f) -> vec2f {
    let s = x * x;
    let high = -0.0752896400 + s * (0.0429096138 + s * (-0.0161657367 + s * 0.0028662257));
    let middle = -0.1420889944 + s * (0.1065626393 + s * high);
    let low = -0.3333314528 + s * (0.1999355085 + s * middle);
    return x + x * s * low;
}

fn place_on_face(tangent: vec2f) -> vec2f {
    if (tiles.mapping == GNOMONIC) {
        return tangent;
    }
    let steep = abs(tangent) > vec2f(1.0);
    let x = select(tangent, 1.0 / tangent, steep);
    let place = arc_tangent(x) / QUARTER;
    return select(place, 2.0 * sign(tangent) - place, steep);
}

fn tangent_on_face(place: f32) -> f32 {
    if (tiles.mapping == GNOMONIC) {
        return place;
    }
    let steep = abs(place) > 1.0;
    let x = select(place, 2.0 * sign(place) - place, steep) * QUARTER;
    let s = x * x;
    let high = 0.0245650893 + s * (0.0029005250 + s * 0.0095168091);
    let low = 0.3333314036 + s * (0.1333923995 + s * (0.0533740603 + s * high));
    let tangent = x + x * s * low;
    return select(tangent, 1.0 / tangent, steep);
}
