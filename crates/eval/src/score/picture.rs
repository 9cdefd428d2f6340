//! What is a picture that is scored?

use super::display::Display;
use super::error::ScoreError;

/// Red, green and blue of every pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct ScorePicture {
    size: [u32; 2],
    samples: Samples,
}

/// Three samples a pixel: red, green, blue.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Codes of 8 bits.
    Bits8(Vec<u8>),
    /// Codes of 16 bits.
    Bits16(Vec<u16>),
    /// From 0 to 1.
    Float(Vec<f32>),
}

impl Samples {
    fn len(&self) -> usize {
        match self {
            Self::Bits8(samples) => samples.len(),
            Self::Bits16(samples) => samples.len(),
            Self::Float(samples) => samples.len(),
        }
    }
}

impl ScorePicture {
    /// A picture of `size` pixels.
    ///
    /// # Errors
    /// When there are not three samples a pixel, or one is not a number from 0 to 1.
    pub fn new(size: [u32; 2], samples: Samples) -> Result<Self, ScoreError> {
        let wanted = size[0] as usize * size[1] as usize * 3;
        if samples.len() != wanted || wanted == 0 {
            let expected = format!("{wanted} for {}x{} pixels, at least 3", size[0], size[1]);
            return Err(ScoreError::field(
                "number of samples",
                samples.len(),
                expected,
            ));
        }
        if let Samples::Float(floats) = &samples
            && let Some(at) = floats.iter().position(|v| !(0.0..=1.0).contains(v))
        {
            let pixel = (at / 3) as u32;
            return Err(ScoreError::Sample {
                place: [pixel % size[0], pixel / size[0]],
                channel: at % 3,
                found: floats[at],
            });
        }
        Ok(Self { size, samples })
    }

    /// An 8-bit picture.
    ///
    /// # Errors
    /// When there are not three samples a pixel.
    pub fn from_rgb8(size: [u32; 2], rgb: Vec<u8>) -> Result<Self, ScoreError> {
        Self::new(size, Samples::Bits8(rgb))
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Its samples.
    #[must_use]
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// Red, green and blue of pixel number `at`, from 0 to 1.
    #[must_use]
    pub fn rgb(&self, at: usize) -> [f64; 3] {
        let of = |channel: usize| match &self.samples {
            Samples::Bits8(samples) => f64::from(samples[at * 3 + channel]) / 255.0,
            Samples::Bits16(samples) => f64::from(samples[at * 3 + channel]) / 65_535.0,
            Samples::Float(samples) => f64::from(samples[at * 3 + channel]),
        };
        [of(0), of(1), of(2)]
    }

    /// Luma of pixel number `at` (ITU-R BT.709 weights of code values), from 0 to 1.
    #[must_use]
    pub fn luma(&self, at: usize) -> f64 {
        let [r, g, b] = self.rgb(at);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// Luminance of every pixel on a display, in cd/m².
    #[must_use]
    pub fn luminance(&self, display: &Display) -> Vec<f64> {
        let pixels = self.samples.len() / 3;
        (0..pixels)
            .map(|at| display.luminance(self.rgb(at)))
            .collect()
    }

    /// Refuses a picture of another size.
    pub(crate) fn expect_size(&self, expected: [u32; 2]) -> Result<(), ScoreError> {
        if self.size == expected {
            return Ok(());
        }
        Err(ScoreError::Size {
            found: self.size,
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_are_no_light_are_refused_by_their_place() {
        for bad in [f32::NAN, f32::INFINITY, -0.1, 1.5] {
            let mut floats = vec![0.5; 4 * 3 * 3];
            floats[(2 * 4 + 1) * 3 + 2] = bad;
            let error = ScorePicture::new([4, 3], Samples::Float(floats)).unwrap_err();
            let message = error.to_string();
            assert!(message.contains("column 1, row 2, channel 2"), "{message}");
        }
        let message = ScorePicture::from_rgb8([4, 4], vec![0; 47]).unwrap_err();
        assert!(message.to_string().contains("48 for 4x4"), "{message}");
    }

    #[test]
    fn every_kind_of_sample_gives_the_same_light() {
        let display = Display::named("standard_fhd").unwrap();
        let codes = [0_u8, 51, 255, 102, 153, 204];
        let bits16 = codes.map(|code| u16::from(code) * 257).to_vec();
        let floats = codes.map(|code| f32::from(code) / 255.0).to_vec();
        let light = |samples| {
            ScorePicture::new([2, 1], samples)
                .unwrap()
                .luminance(&display)
        };
        let wanted = light(Samples::Bits8(codes.to_vec()));
        assert_eq!(wanted, light(Samples::Bits16(bits16)));
        let floats = light(Samples::Float(floats));
        assert!(
            floats
                .iter()
                .zip(&wanted)
                .all(|(a, b)| (a - b).abs() < 1e-4)
        );
    }
}
