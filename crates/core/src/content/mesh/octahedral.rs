//! How does a direction fit into two bytes?
//!
//! The sphere is folded onto an octahedron, and that onto a square: Meyer et al. 2010, "On
//! floating-point normal vectors".

/// Largest value of a coordinate.
const MOST: f32 = 127.0;

/// A direction as two signed bytes, the nearest by each coordinate; what has no length counts as
/// straight up.
#[must_use]
pub fn octahedral_from_direction([x, y, z]: [f32; 3]) -> [i8; 2] {
    let sum = x.abs() + y.abs() + z.abs();
    if !(sum > 0.0 && sum.is_finite()) {
        return octahedral_from_direction([0.0, 1.0, 0.0]);
    }
    let [u, v] = [x / sum, y / sum];
    let [u, v] = if z < 0.0 { folded([u, v]) } else { [u, v] };
    [u, v].map(|it| libm::rintf(it * MOST) as i8)
}

/// The unit direction that two signed bytes stand for.
#[must_use]
pub fn direction_from_octahedral([u, v]: [i8; 2]) -> [f32; 3] {
    let [u, v] = [u, v].map(|it| (f32::from(it) / MOST).max(-1.0));
    let z = 1.0 - u.abs() - v.abs();
    let [x, y] = if z < 0.0 { folded([u, v]) } else { [u, v] };
    let length = libm::sqrtf(x * x + y * y + z * z);
    [x / length, y / length, z / length]
}

/// The lower half of the octahedron, folded outwards over the corners of the square.
fn folded([u, v]: [f32; 2]) -> [f32; 2] {
    [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_comes_back_within_a_degree() {
        for step in 0..2000 {
            // Fibonacci spiral over the sphere.
            let z = 1.0 - (f64::from(step) + 0.5) / 1000.0;
            let (ring, turn) = (libm::sqrt(1.0 - z * z), f64::from(step) * 2.399_963);
            let there = [ring * libm::cos(turn), ring * libm::sin(turn), z].map(|it| it as f32);
            let back = direction_from_octahedral(octahedral_from_direction(there));
            let dot: f32 = there.iter().zip(back).map(|(a, b)| a * b).sum();
            assert!(dot > 0.999_85, "{there:?} comes back as {back:?}");
        }
    }

    #[test]
    fn what_has_no_direction_points_up() {
        let up = octahedral_from_direction([0.0, 1.0, 0.0]);
        assert_eq!(octahedral_from_direction([0.0; 3]), up);
        assert_eq!(octahedral_from_direction([f32::NAN; 3]), up);
        assert_eq!(direction_from_octahedral(up), [0.0, 1.0, 0.0]);
    }
}
