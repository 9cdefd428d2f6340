//! Under which conditions are pictures scored?

use super::constants::{BAND_CENTRES, LOWEST_BAND_CPD};
use super::display::Display;
use super::error::ScoreError;
use super::pyramid::half_size;
use super::rules::{Mode, ScoreRules};
use super::temporal::taps;

/// Shortest and longest side of a picture that is scored, pixels.
const SIDES: [u32; 2] = [16, 16_384];
/// Slowest and fastest video, frames a second.
const RATES: [f64; 2] = [1.0, 1000.0];
/// Most memory that the frames of a quarter of a second may take, bytes.
const MOST_RING_BYTES: u64 = 8 << 30;

/// What is the same for all frames of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewing {
    /// What shows the pictures.
    pub display: Display,
    /// Columns and rows of the pictures.
    pub size: [u32; 2],
    /// Frames a second; `None` for a still.
    pub fps: Option<f64>,
    /// Whether an eye looks at a place, or at everything at once.
    pub foveated: bool,
    /// Which rules are followed.
    pub rules: ScoreRules,
}

impl Viewing {
    /// Conditions in a mode.
    ///
    /// # Errors
    /// Names what is out of range: the size, the rate, the display's density, or the memory that
    /// both would take.
    pub fn new(
        display: Display,
        size: [u32; 2],
        fps: Option<f64>,
        foveated: bool,
        mode: Mode,
    ) -> Result<Self, ScoreError> {
        let [least, most] = SIDES;
        if !size.iter().all(|side| (least..=most).contains(side)) {
            let found = format!("{}x{}", size[0], size[1]);
            let expected = format!("sides of {least} to {most} pixels");
            return Err(ScoreError::field("the picture's size", found, expected));
        }
        let viewing = Self {
            display: display.checked()?,
            size,
            fps,
            foveated,
            rules: mode.rules(),
        };
        if let Some(fps) = fps {
            if !(RATES[0]..=RATES[1]).contains(&fps) {
                let expected = format!("{} to {}", RATES[0], RATES[1]);
                return Err(ScoreError::field("frames a second", fps, expected));
            }
            let frames = viewing.taps().len() as u64;
            let bytes = frames * u64::from(size[0]) * u64::from(size[1]) * 8;
            if bytes > MOST_RING_BYTES {
                let found = format!("{frames} of {}x{}: {bytes} bytes", size[0], size[1]);
                let expected = format!("smaller pictures or fewer: at most {MOST_RING_BYTES}");
                return Err(ScoreError::field("frames in 250 ms", found, expected));
            }
        }
        Ok(viewing)
    }

    /// Channels that are looked at: the sustained one, and of a video the transient one.
    #[must_use]
    pub fn channels(&self) -> usize {
        1 + usize::from(self.fps.is_some())
    }

    /// Weights of the frames of a quarter of a second, newest first; of a still the still itself.
    #[must_use]
    pub fn taps(&self) -> Vec<[f64; 2]> {
        match self.fps {
            Some(fps) => taps(fps, self.rules.sampling),
            None => vec![[1.0, 0.0]],
        }
    }

    /// Centre frequencies of the bands that are scored, finest first, cycles per degree: as many as
    /// it takes to get to 0.5, or as the picture has.
    #[must_use]
    pub fn bands(&self) -> Vec<f64> {
        let finest = self.display.ppd() / 2.0;
        let most = self.size[0].min(self.size[1]).ilog2() as usize - 1;
        let mut bands = Vec::new();
        while bands.len() < most {
            let share = match bands.len() {
                0 => BAND_CENTRES[0],
                n => BAND_CENTRES[1] / f64::from(1 << (n - 1)),
            };
            bands.push(finest * share);
            if finest * share <= LOWEST_BAND_CPD {
                break;
            }
        }
        bands
    }

    /// Columns and rows of every level: one for every band, and the one below the last.
    #[must_use]
    pub fn levels(&self) -> Vec<[usize; 2]> {
        let mut levels = vec![self.size.map(|side| side as usize)];
        for _ in self.bands() {
            levels.push(half_size(levels[levels.len() - 1]));
        }
        levels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewing(name: &str, size: [u32; 2], fps: Option<f64>) -> Result<Viewing, ScoreError> {
        Viewing::new(Display::named(name).unwrap(), size, fps, true, Mode::Compat)
    }

    #[test]
    fn displays_have_as_many_bands_as_published() {
        for (name, bands) in [
            ("standard_4k", 7),
            ("standard_fhd", 6),
            ("standard_hmd", 5),
            ("htc_vive_pro", 5),
        ] {
            let viewing = viewing(name, [1024, 1024], None).unwrap();
            assert_eq!(viewing.bands().len(), bands, "{name}");
            assert_eq!(viewing.levels().len(), bands + 1);
        }
    }

    #[test]
    fn small_pictures_have_fewer_bands_and_always_one() {
        for (size, bands) in [([16, 16], 3), ([33, 500], 4), ([64, 64], 5)] {
            let viewing = viewing("standard_4k", size, None).unwrap();
            assert_eq!(viewing.bands().len(), bands, "{size:?}");
        }
    }

    #[test]
    fn what_cannot_be_scored_is_refused_by_its_field() {
        for (size, fps, word) in [
            ([8, 400], None, "size"),
            ([400, 20_000], None, "size"),
            ([400, 400], Some(f64::NAN), "frames a second"),
            ([400, 400], Some(0.0), "frames a second"),
            ([16_000, 16_000], Some(60.0), "250 ms"),
        ] {
            let message = viewing("standard_4k", size, fps).unwrap_err().to_string();
            assert!(
                message.contains(word) && message.contains("give "),
                "{message}"
            );
        }
    }
}
