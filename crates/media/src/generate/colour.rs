//! What are colours of the generated world made of?

/// Gamma-coded red, green and blue in 0..=1.
pub(super) type Rgb = [f32; 3];

/// Between two colours, `t` of the second.
#[inline]
pub(super) fn mix([r, g, b]: Rgb, [red, green, blue]: Rgb, t: f32) -> Rgb {
    [r + (red - r) * t, g + (green - g) * t, b + (blue - b) * t]
}

/// A colour, `by` times as bright.
#[inline]
pub(super) fn scaled([r, g, b]: Rgb, by: f32) -> Rgb {
    [r * by, g * by, b * by]
}
