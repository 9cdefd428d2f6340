//! How much light does a code value of a file give?

/// Linear light of an sRGB-encoded value from 0 to 1; what is beyond is cut. IEC 61966-2-1.
pub(super) fn linear_from_encoded(value: f64) -> f32 {
    let value = value.clamp(0.0, 1.0);
    let linear = if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    };
    linear as f32
}

/// Linear light of sRGB-encoded red, green and blue with a linear alpha.
pub(super) fn linear_from_rgba([red, green, blue, alpha]: [f64; 4]) -> [f32; 4] {
    let [red, green, blue] = [red, green, blue].map(linear_from_encoded);
    [red, green, blue, alpha.clamp(0.0, 1.0) as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_rises_with_the_code_from_none_to_all() {
        let light: Vec<f32> = (0..=255)
            .map(|code| linear_from_encoded(f64::from(code) / 255.0))
            .collect();
        assert_eq!((light[0], light[255]), (0.0, 1.0));
        assert!(light.windows(2).all(|pair| pair[0] < pair[1]));
        assert!((light[188] - 0.503).abs() < 1e-3);
    }
}
