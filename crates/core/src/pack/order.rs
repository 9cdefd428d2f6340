//! In which order do the tiles of a level lie on disk?
//!
//! Along a Hilbert curve, so that tiles that are close in the picture are close in the file and one
//! byte range covers a fovea.

/// Distance along the Hilbert curve of the smallest power-of-two square that holds `side` columns
/// and rows. Hilbert (1891); the usual rotate-and-reflect construction, O(log side).
#[must_use]
pub fn hilbert_distance(side: u32, [mut x, mut y]: [u32; 2]) -> u64 {
    let n = side.max(1).next_power_of_two();
    assert!(x < n && y < n, "({x},{y}) lies outside a square of {n}");
    let mut distance = 0;
    let mut half = n / 2;
    while half > 0 {
        let (right, low) = (u32::from(x & half > 0), u32::from(y & half > 0));
        distance += u64::from(half) * u64::from(half) * u64::from((3 * right) ^ low);
        if low == 0 {
            if right == 1 {
                x = n - 1 - x;
                y = n - 1 - y;
            }
            core::mem::swap(&mut x, &mut y);
        }
        half /= 2;
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_the_picture() {
        let mut places = vec![[0u32; 2]; 256];
        for y in 0..16 {
            for x in 0..16 {
                places[hilbert_distance(16, [x, y]) as usize] = [x, y];
            }
        }
        for pair in places.windows(2) {
            assert_eq!(
                pair[0][0].abs_diff(pair[1][0]) + pair[0][1].abs_diff(pair[1][1]),
                1
            );
        }
    }
}
