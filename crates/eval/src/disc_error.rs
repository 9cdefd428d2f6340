//! How far is a picture from another where the eye looks?

use foveal_core::perception::luminance::linear_from_srgb;
use foveal_core::units::Radians;
use foveal_core::view::eye_view::EyeView;
use glam::DVec3;

/// The fovea in tests and figures: the radius of the disc round the gaze, in degrees.
pub const FOVEA_DEG: f64 = 2.5;

/// Which pixels of a view lie in a disc round a gaze, as it is seen: their places, row by row.
#[must_use]
pub fn disc(view: &EyeView, gaze: DVec3, radius: Radians) -> Vec<usize> {
    let seen = view.as_seen();
    let Some(gaze) = view.seen_direction(gaze) else {
        return Vec::new();
    };
    let least = libm::cos(radius.0);
    let [columns, rows] = view.size;
    let inside = (0..rows).flat_map(|y| {
        (0..columns).filter_map(move |x| {
            let ray = seen.ray([f64::from(x) + 0.5, f64::from(y) + 0.5]);
            let is_inside = ray.dot(gaze) >= least * ray.length();
            is_inside.then_some((y * columns + x) as usize)
        })
    });
    inside.collect()
}

/// Root mean square of the difference of linear luminance over these pixels of two pictures of four
/// bytes a pixel, sRGB, divided by the mean luminance of the second there; 0 where nothing differs.
///
/// # Panics
/// A pixel must lie in both.
#[must_use]
pub fn error_over(pixels: impl Iterator<Item = usize>, shown: &[u8], whole: &[u8]) -> f64 {
    let light: Vec<f64> = (0..=255).map(linear_from_srgb).collect();
    let luminance = |picture: &[u8], pixel: usize| {
        let [r, g, b] = [0, 1, 2].map(|channel| light[usize::from(picture[4 * pixel + channel])]);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (mut squares, mut sum, mut count) = (0.0, 0.0, 0.0);
    for pixel in pixels {
        let [shown, whole] = [shown, whole].map(|picture| luminance(picture, pixel));
        squares += (shown - whole) * (shown - whole);
        sum += whole;
        count += 1.0;
    }
    if squares == 0.0 {
        return 0.0;
    }
    libm::sqrt(squares / count) / (sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::axes::Axes;
    use foveal_core::view::eye_view::Field;

    #[test]
    fn a_disc_ahead_is_round_and_as_large_as_its_angle() {
        let view = EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::symmetric([1.0, 1.0]),
            size: [200, 200],
            eye: Default::default(),
        };
        let pixels = disc(&view, DVec3::NEG_Z, Radians::from_degrees(5.0));
        let radius = 100.0 * libm::tan(5_f64.to_radians());
        let expected = core::f64::consts::PI * radius * radius;
        assert!((pixels.len() as f64 / expected - 1.0).abs() < 0.05);
        assert!(disc(&view, DVec3::Z, Radians(0.1)).is_empty());
    }

    #[test]
    fn the_error_is_relative_to_the_light_that_is_there() {
        let grey = |code: u8| [code, code, code, 255].repeat(4);
        assert_eq!(error_over(0..4, &grey(80), &grey(80)), 0.0);
        let error = error_over(0..4, &grey(90), &grey(80));
        let expected = linear_from_srgb(90) / linear_from_srgb(80) - 1.0;
        assert!((error - expected).abs() < 1e-12);
    }
}
