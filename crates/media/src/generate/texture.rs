//! Which repeatable patterns cover a plane without aliasing?
//!
//! Every pattern takes `footprint`, the width of a pixel in the plane's units, and fades to its
//! mean as its detail passes the pixel's Nyquist limit.

/// Side of the lattice after which noise repeats; a power of two.
const PERIOD: usize = 256;

/// Random bytes, twice in a row so that sums of two indices need no wrap.
const BYTES: [u8; 2 * PERIOD] = shuffled_bytes();

const fn shuffled_bytes() -> [u8; 2 * PERIOD] {
    let mut bytes = [0; 2 * PERIOD];
    let mut i = 0;
    while i < PERIOD {
        bytes[i] = i as u8;
        i += 1;
    }
    let mut state = 0x2545_f491u32;
    let mut last = PERIOD - 1;
    while last > 0 {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        let other = state as usize % (last + 1);
        let swapped = bytes[last];
        bytes[last] = bytes[other];
        bytes[other] = swapped;
        last -= 1;
    }
    let mut i = 0;
    while i < PERIOD {
        bytes[PERIOD + i] = bytes[i];
        i += 1;
    }
    bytes
}

/// The integer below a number, far cheaper than `f32::floor` without SSE4.
#[inline]
pub(super) fn floor(x: f32) -> i32 {
    let near = x as i32;
    near - i32::from(near as f32 > x)
}

/// A random byte of a cell of the plane.
#[inline]
pub(super) fn byte_at(x: i32, y: i32) -> u8 {
    let wrapped = |k: i32| k as usize & (PERIOD - 1);
    BYTES[usize::from(BYTES[wrapped(x)]) + wrapped(y)]
}

/// A smooth step from 0 at `from` to 1 at `to`.
#[inline]
pub(super) fn step(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) * (1.0 / (to - from))).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// What is left of a pattern of `frequency` cycles a unit under pixels of `footprint` units.
#[inline]
pub(super) fn visible(frequency: f32, footprint: f32) -> f32 {
    1.0 - step(0.3, 0.5, frequency * footprint)
}

/// [`BYTES`] as numbers in 0..=1.
static VALUES: [f32; 2 * PERIOD] = {
    let mut values = [0.0; 2 * PERIOD];
    let mut i = 0;
    while i < 2 * PERIOD {
        values[i] = BYTES[i] as f32 / 255.0;
        i += 1;
    }
    values
};

/// Value noise in 0..1 with one cell a unit.
#[inline]
pub(super) fn noise(x: f32, y: f32) -> f32 {
    let (left, top) = (floor(x), floor(y));
    let (u, v) = (x - left as f32, y - top as f32);
    let (u, v) = (u * u * (3.0 - 2.0 * u), v * v * (3.0 - 2.0 * v));
    let wrapped = |k: i32| k as usize & (PERIOD - 1);
    let near = usize::from(BYTES[wrapped(left)]);
    let next = usize::from(BYTES[wrapped(left + 1)]);
    let along = |row: usize| VALUES[near + row] + (VALUES[next + row] - VALUES[near + row]) * u;
    let (above, below) = (along(wrapped(top)), along(wrapped(top + 1)));
    above + (below - above) * v
}

/// Octaves of noise around 0, within about ±1, each twice as fine as the one before and 0.6 as
/// strong, down to the pixel.
#[inline]
pub(super) fn fractal(x: f32, y: f32, footprint: f32) -> f32 {
    let (mut sum, mut strength, mut frequency) = (0.0, 0.8, 1.0);
    for octave in 0..12 {
        // A cell holds half a cycle.
        let mut seen = 1.0;
        if 0.6 * frequency * footprint > 0.3 {
            seen = visible(0.6 * frequency, footprint);
            if seen <= 0.0 {
                break;
            }
        }
        // Octaves start at different places, so that lattice lines do not add up.
        let shift = octave as f32 * 17.31;
        let value = noise(x * frequency + shift, y * frequency - shift);
        sum += seen * strength * (value - 0.5);
        strength *= 0.6;
        frequency *= 2.03;
    }
    sum
}

/// Coverage of bars `width` wide, one a unit and centred on the integers, by a pixel.
#[inline]
pub(super) fn bars(x: f32, width: f32, footprint: f32) -> f32 {
    let pixel = footprint.max(1e-4);
    let covered = |x: f32| {
        let cell = floor(x);
        cell as f32 * width + (x - cell as f32).min(width)
    };
    let x = x + 0.5 * width;
    (covered(x + 0.5 * pixel) - covered(x - 0.5 * pixel)) / pixel
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_fade_to_their_mean_under_a_wide_pixel() {
        assert_eq!(fractal(3.3, -7.1, 2.0), 0.0);
        assert!((bars(0.3, 0.25, 40.0) - 0.25).abs() < 0.01);
        assert!((bars(5.0, 0.25, 0.01) - 1.0).abs() < 1e-3);
        assert!(bars(5.5, 0.25, 0.01).abs() < 1e-3);
    }

    #[test]
    fn noise_is_continuous() {
        for k in -500..500 {
            let x = k as f32 * 0.01;
            assert!((noise(x, 1.7) - noise(x + 0.01, 1.7)).abs() < 0.02);
        }
    }
}
