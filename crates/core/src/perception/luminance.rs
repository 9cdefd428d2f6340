//! How much light does a code value of a picture give?

use super::parameters::Parameters;

/// Share of Y that linear red, green and blue give: BT.709, the primaries of sRGB.
const RGB_WEIGHTS: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Linear light of an sRGB code value, 0 to 1. IEC 61966-2-1.
#[must_use]
pub fn linear_from_srgb(code: u8) -> f64 {
    let v = f64::from(code) / 255.0;
    if v <= 0.040_45 {
        v / 12.92
    } else {
        libm::pow((v + 0.055) / 1.055, 2.4)
    }
}

/// Linear light of every sRGB code value.
pub(super) fn linear_table() -> [f64; 256] {
    core::array::from_fn(|code| linear_from_srgb(code as u8))
}

/// The grey sRGB code value nearest to the light of every pixel of 8-bit sRGB.
#[must_use]
pub fn grey_from_rgb(rgb: &[[u8; 3]]) -> Vec<u8> {
    let table = linear_table();
    let nearest = |linear: f64| {
        let above = table.partition_point(|&l| l < linear).clamp(1, 255);
        let below_is_nearer = linear - table[above - 1] < table[above] - linear;
        (above - usize::from(below_is_nearer)) as u8
    };
    let light = |pixel: &[u8; 3]| -> f64 {
        let parts = pixel.iter().zip(RGB_WEIGHTS);
        parts.map(|(&code, w)| table[usize::from(code)] * w).sum()
    };
    rgb.iter().map(|pixel| nearest(light(pixel))).collect()
}

impl Parameters {
    /// Luminance in cd/m² that the display gives for a share of its white.
    #[must_use]
    pub fn displayed(&self, linear: f64) -> f64 {
        self.black + (self.peak - self.black) * linear
    }

    /// Luminance in cd/m² of linear red, green and blue, 0 to 1.
    #[must_use]
    pub fn luminance_from_linear(&self, linear: [f64; 3]) -> f64 {
        self.displayed(linear.iter().zip(RGB_WEIGHTS).map(|(l, w)| l * w).sum())
    }

    /// Luminance in cd/m² of every pixel of 8-bit luma (grey sRGB code values).
    #[must_use]
    pub fn luminance_from_luma(&self, luma: &[u8]) -> Vec<f64> {
        let table = self.luma_table();
        luma.iter().map(|&code| table[usize::from(code)]).collect()
    }

    /// Luminance in cd/m² of every pixel of 8-bit sRGB.
    #[must_use]
    pub fn luminance_from_rgb(&self, rgb: &[[u8; 3]]) -> Vec<f64> {
        let table = linear_table();
        let linear = |pixel: &[u8; 3]| pixel.map(|code| table[usize::from(code)]);
        let pixels = rgb.iter();
        let pixels = pixels.map(|pixel| self.luminance_from_linear(linear(pixel)));
        pixels.collect()
    }

    /// Luminance in cd/m² of every code value of 8-bit luma.
    #[must_use]
    pub fn luma_table(&self) -> [f64; 256] {
        core::array::from_fn(|code| self.displayed(linear_from_srgb(code as u8)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_values_have_the_light_of_srgb() {
        for (code, expected) in [(0, 0.0), (10, 0.003035), (128, 0.215861), (255, 1.0)] {
            assert!((linear_from_srgb(code) - expected).abs() < 1e-6, "{code}");
        }
    }

    #[test]
    fn grey_gives_the_same_light_as_colour_and_as_luma() {
        let parameters = Parameters::default();
        for code in [0, 1, 77, 200, 255] {
            let grey = parameters.luminance_from_rgb(&[[code; 3]])[0];
            let luma = parameters.luminance_from_luma(&[code])[0];
            assert!((grey - luma).abs() < 1e-9);
            assert_eq!(grey_from_rgb(&[[code; 3]]), [code]);
        }
        assert!((parameters.luminance_from_luma(&[0])[0] - parameters.black).abs() < 1e-12);
    }
}
