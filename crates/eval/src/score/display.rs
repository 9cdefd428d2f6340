//! How much light does a display give for a code value, and how large does it stand before the eye?
//!
//! Mantiuk et al. 2021, display model: a display is its panel, its distance and its photometry.

use super::constants::LUMINANCE_WEIGHTS;
use super::error::ScoreError;
use serde::{Deserialize, Serialize};

/// A display before an eye.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Display {
    /// What it is called.
    pub name: String,
    /// Columns and rows of the panel.
    pub size_px: [u32; 2],
    /// Width and height of the panel over its distance from the eye.
    pub extent: [f64; 2],
    /// Light of white, cd/m².
    pub peak_cd_m2: f64,
    /// Light of black, with what the room adds, cd/m².
    pub black_cd_m2: f64,
    /// From code value to light.
    pub transfer: Transfer,
}

/// From a code value of 0 to 1 to light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transfer {
    /// IEC 61966-2-1.
    Srgb,
    /// A power.
    Gamma(f64),
    /// SMPTE ST 2084: absolute light, from 0.005 cd/m² to the peak.
    Pq,
    /// Light itself.
    Linear,
}

/// Share of the light of a room that a screen reflects.
const REFLECTIVITY: f64 = 0.005;
/// Least light of a code value in PQ, cd/m².
const LEAST_PQ: f64 = 0.005;
/// Distance of the panel of a headset, in metres: only ratios count.
const HEADSET_DISTANCE_M: f64 = 3.0;
/// Metres of an inch.
const INCH_M: f64 = 0.0254;
/// Pixels per degree that a display may have: from a wall of lamps to far beyond the eye.
const PPD: [f64; 2] = [1.0, 500.0];

/// A display as a TOML file describes it; everything is checked by [`DisplayFile::display`].
///
/// ```
/// let text = "name = \"mine\"\nsize_px = [1832, 1920]\nfov_diagonal_deg = 120\n\
///             peak_cd_m2 = 100\ncontrast = 500";
/// let file: foveal_eval::score::display::DisplayFile = toml::from_str(text)?;
/// assert!((file.display()?.ppd() - 14.2).abs() < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DisplayFile {
    /// What it is called.
    pub name: String,
    /// Columns and rows of the panel.
    pub size_px: [u32; 2],
    /// Diagonal of the panel in inches; with `distance_m`, or else `fov_diagonal_deg`.
    pub diagonal_inches: Option<f64>,
    /// Distance from the eye in metres.
    pub distance_m: Option<f64>,
    /// Angle that the diagonal fills, in degrees.
    pub fov_diagonal_deg: Option<f64>,
    /// Light of white, cd/m².
    pub peak_cd_m2: f64,
    /// Light of white over that of black in a dark room; or else `black_cd_m2`.
    pub contrast: Option<f64>,
    /// Light of black in a dark room, cd/m².
    pub black_cd_m2: Option<f64>,
    /// Light of the room, lux.
    #[serde(default)]
    pub ambient_lux: f64,
    /// Share of that light that the screen reflects.
    pub reflectivity: Option<f64>,
    /// `srgb`, `gamma`, `pq` or `linear`.
    #[serde(default)]
    pub transfer: TransferName,
    /// Exponent of `gamma`.
    pub gamma: Option<f64>,
}

/// A [`Transfer`] by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TransferName {
    /// IEC 61966-2-1.
    #[default]
    Srgb,
    /// A power.
    Gamma,
    /// SMPTE ST 2084.
    Pq,
    /// Light itself.
    Linear,
}

/// Photometry of a display without a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photometry {
    /// Light of white, cd/m².
    pub peak_cd_m2: f64,
    /// Light of black in a dark room, cd/m².
    pub black_cd_m2: f64,
    /// Light of the room, lux.
    pub ambient_lux: f64,
}

impl Photometry {
    /// A screen on a desk: 200 cd/m², 1000:1, in a room of 250 lux.
    pub const DESK: Self = Self {
        peak_cd_m2: 200.0,
        black_cd_m2: 0.2,
        ambient_lux: 250.0,
    };
    /// A headset: 100 cd/m², 1000:1, dark.
    pub const HEADSET: Self = Self {
        peak_cd_m2: 100.0,
        black_cd_m2: 0.1,
        ambient_lux: 0.0,
    };
}

impl Display {
    /// A display of a panel `extent` wide and high, as shares of its distance; sRGB.
    #[must_use]
    pub fn of(name: &str, size_px: [u32; 2], extent: [f64; 2], light: Photometry) -> Self {
        Self {
            name: name.to_owned(),
            size_px,
            extent,
            peak_cd_m2: light.peak_cd_m2,
            black_cd_m2: light.black_cd_m2 + reflected(light.ambient_lux, REFLECTIVITY),
            transfer: Transfer::Srgb,
        }
    }

    /// Pixels per degree in the middle of the panel.
    #[must_use]
    pub fn ppd(&self) -> f64 {
        let pixel = self.extent[0] / f64::from(self.size_px[0]);
        1.0 / (2.0 * (0.5 * pixel).atan()).to_degrees()
    }

    /// Horizontal and vertical field of view in degrees.
    #[must_use]
    pub fn fov_deg(&self) -> [f64; 2] {
        self.extent
            .map(|side| (2.0 * (side / 2.0).atan()).to_degrees())
    }

    /// Light of one channel's code value from 0 to 1, before it is weighed, in cd/m².
    #[must_use]
    pub fn light(&self, code: f64) -> f64 {
        let (peak, black) = (self.peak_cd_m2, self.black_cd_m2);
        let share = match self.transfer {
            Transfer::Srgb if code <= 0.040_45 => code / 12.92,
            Transfer::Srgb => ((code + 0.055) / 1.055).powf(2.4),
            Transfer::Gamma(exponent) => code.powf(exponent),
            Transfer::Linear => code,
            Transfer::Pq => return pq_light(code).clamp(LEAST_PQ, peak) + black,
        };
        (peak - black) * share + black
    }

    /// Luminance of code values from 0 to 1, in cd/m².
    #[must_use]
    pub fn luminance(&self, rgb: [f64; 3]) -> f64 {
        let parts = rgb.into_iter().zip(LUMINANCE_WEIGHTS);
        parts.map(|(code, weight)| weight * self.light(code)).sum()
    }
}

/// Metres of a length in inches.
pub(super) const fn inches(inches: f64) -> f64 {
    inches * INCH_M
}

/// Width and height over distance of a panel of square pixels.
pub(super) fn extent(size: [u32; 2], diagonal_m: f64, distance_m: f64) -> [f64; 2] {
    let size = size.map(f64::from);
    size.map(|side| diagonal_m * side / size[0].hypot(size[1]) / distance_m)
}

/// The same for a panel whose diagonal fills an angle.
pub(super) fn headset_extent(size: [u32; 2], diagonal_deg: f64) -> [f64; 2] {
    let half = (diagonal_deg / 2.0).to_radians().tan() * HEADSET_DISTANCE_M;
    extent(size, 2.0 * half, HEADSET_DISTANCE_M)
}

/// What a screen that scatters light evenly adds to black, cd/m².
fn reflected(lux: f64, reflectivity: f64) -> f64 {
    lux / std::f64::consts::PI * reflectivity
}

/// Absolute light of a code value: SMPTE ST 2084.
fn pq_light(code: f64) -> f64 {
    const M1: f64 = 0.159_301_757_812_5;
    const M2: f64 = 78.843_75;
    const C1: f64 = 0.835_937_5;
    const C2: f64 = 18.851_562_5;
    const C3: f64 = 18.687_5;
    let root = code.max(0.0).powf(1.0 / M2);
    1e4 * ((root - C1).max(0.0) / (C2 - C3 * root)).powf(1.0 / M1)
}

impl DisplayFile {
    /// The display.
    ///
    /// # Errors
    /// Names the field that is out of range, missing, or given with another that says the same.
    pub fn display(&self) -> Result<Display, ScoreError> {
        let side = |side: u32| (16..=65_536).contains(&side);
        if !self.size_px.into_iter().all(side) {
            let found = format!("{:?}", self.size_px);
            return Err(ScoreError::field("size_px", found, "two of 16 to 65536"));
        }
        let display = Display {
            name: self.name.clone(),
            size_px: self.size_px,
            extent: self.extent()?,
            peak_cd_m2: within("peak_cd_m2", self.peak_cd_m2, [1.0, 1e5])?,
            black_cd_m2: self.black()?,
            transfer: self.transfer()?,
        };
        if display.black_cd_m2 >= display.peak_cd_m2 {
            let expected = format!("what leaves black below {} cd/m²", display.peak_cd_m2);
            let found = format!("{} with the room's light", display.black_cd_m2);
            return Err(ScoreError::field("black_cd_m2", found, expected));
        }
        display.checked()
    }

    fn extent(&self) -> Result<[f64; 2], ScoreError> {
        let given = (self.diagonal_inches, self.distance_m, self.fov_diagonal_deg);
        match given {
            (Some(inches), Some(distance), None) => {
                let inches = within("diagonal_inches", inches, [0.1, 1e4])?;
                let distance = within("distance_m", distance, [0.01, 1000.0])?;
                Ok(extent(self.size_px, self::inches(inches), distance))
            }
            (None, None, Some(degrees)) => {
                let degrees = within("fov_diagonal_deg", degrees, [1.0, 170.0])?;
                Ok(headset_extent(self.size_px, degrees))
            }
            _ => Err(ScoreError::field(
                "the panel's size",
                "given twice or not at all",
                "diagonal_inches and distance_m, or fov_diagonal_deg alone",
            )),
        }
    }

    fn black(&self) -> Result<f64, ScoreError> {
        let dark = match (self.contrast, self.black_cd_m2) {
            (Some(contrast), None) => self.peak_cd_m2 / within("contrast", contrast, [1.5, 1e8])?,
            (None, Some(black)) => within("black_cd_m2", black, [0.0, 1e4])?,
            _ => {
                let found = "given twice or not at all";
                let expected = "either contrast or black_cd_m2";
                return Err(ScoreError::field("black", found, expected));
            }
        };
        let lux = within("ambient_lux", self.ambient_lux, [0.0, 2e5])?;
        let share = self.reflectivity.unwrap_or(REFLECTIVITY);
        Ok(dark + reflected(lux, within("reflectivity", share, [0.0, 1.0])?))
    }

    fn transfer(&self) -> Result<Transfer, ScoreError> {
        Ok(match (self.transfer, self.gamma) {
            (TransferName::Gamma, Some(gamma)) => {
                Transfer::Gamma(within("gamma", gamma, [0.5, 5.0])?)
            }
            (TransferName::Gamma, None) => {
                return Err(ScoreError::field("gamma", "missing", "0.5 to 5"));
            }
            (_, Some(gamma)) => {
                let expected = "it with transfer = \"gamma\" alone";
                return Err(ScoreError::field("gamma", gamma, expected));
            }
            (TransferName::Srgb, None) => Transfer::Srgb,
            (TransferName::Pq, None) => Transfer::Pq,
            (TransferName::Linear, None) => Transfer::Linear,
        })
    }
}

impl Display {
    /// For tests and fuzzing: whether whatever was accepted gives light and angles.
    ///
    /// # Panics
    /// When it does not.
    pub fn assert_sound(&self) {
        assert!((PPD[0]..=PPD[1]).contains(&self.ppd()), "{self:?}");
        assert!(
            self.fov_deg()
                .iter()
                .all(|angle| *angle > 0.0 && *angle < 180.0),
            "{self:?}"
        );
        let light = [0.0, 0.02, 0.5, 1.0].map(|code| self.light(code));
        assert!(
            light.iter().all(|light| *light >= 0.0 && light.is_finite()),
            "{self:?}"
        );
        assert!(
            light.windows(2).all(|pair| pair[1] >= pair[0]),
            "{self:?}: {light:?}"
        );
    }

    /// Refuses a density that no eye meets.
    pub(crate) fn checked(self) -> Result<Self, ScoreError> {
        within(
            "the display's density in pixels per degree",
            self.ppd(),
            PPD,
        )?;
        Ok(self)
    }
}

fn within(field: &'static str, found: f64, [least, most]: [f64; 2]) -> Result<f64, ScoreError> {
    if (least..=most).contains(&found) {
        Ok(found)
    } else {
        Err(ScoreError::field(
            field,
            found,
            format!("{least} to {most}"),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(found: f64, wanted: f64, by: f64) -> bool {
        (found - wanted).abs() < by
    }

    #[test]
    fn light_rises_with_code_from_black_to_white_on_every_transfer() {
        let mut display = Display::named("standard_fhd").unwrap();
        for transfer in [
            Transfer::Srgb,
            Transfer::Gamma(2.2),
            Transfer::Pq,
            Transfer::Linear,
        ] {
            display.transfer = transfer;
            let light: Vec<f64> = (0..=100)
                .map(|n| display.light(f64::from(n) / 100.0))
                .collect();
            assert!(
                light.windows(2).all(|pair| pair[1] >= pair[0]),
                "{transfer:?}"
            );
            assert!(close(light[0], display.black_cd_m2, 0.0051), "{transfer:?}");
            assert!(
                close(light[100], 200.0, 0.6),
                "{transfer:?}: {}",
                light[100]
            );
        }
        // SMPTE ST 2084: half of the code range is about 92 cd/m².
        assert!(close(pq_light(0.5), 92.2, 0.1));
    }

    fn file(change: impl Fn(&mut DisplayFile)) -> Result<Display, String> {
        let mut file = DisplayFile {
            name: "mine".to_owned(),
            size_px: [1920, 1080],
            diagonal_inches: Some(24.0),
            distance_m: Some(0.6),
            fov_diagonal_deg: None,
            peak_cd_m2: 200.0,
            contrast: Some(1000.0),
            black_cd_m2: None,
            ambient_lux: 250.0,
            reflectivity: None,
            transfer: TransferName::Srgb,
            gamma: None,
        };
        change(&mut file);
        file.display().map_err(|error| error.to_string())
    }

    #[test]
    fn a_file_gives_the_display_that_it_describes() {
        let mut wanted = Display::named("standard_fhd").unwrap();
        wanted.name = "mine".to_owned();
        let found = file(|_| {}).unwrap();
        assert!(close(found.ppd(), wanted.ppd(), 1e-9));
        assert!(close(found.black_cd_m2, wanted.black_cd_m2, 1e-9));
    }

    proptest! {
        #[test]
        fn whatever_is_accepted_gives_light_and_angles(
            numbers in proptest::collection::vec(any::<f64>(), 9),
            tame in proptest::collection::vec(1e-3..2e3_f64, 9),
            wild in proptest::collection::vec(prop::bool::weighted(0.05), 9),
            given in proptest::collection::vec(any::<bool>(), 4),
            transfer in 0..4_usize,
            size_px in [0..70_000_u32, 0..9000_u32],
        ) {
            let number = |k: usize| if wild[k] { numbers[k] } else { tame[k] };
            let some = |k: usize, there: bool| there.then(|| number(k));
            let names = ["srgb", "gamma", "pq", "linear"];
            let mut text = format!("name = \"x\"\nsize_px = {size_px:?}\n");
            text += &format!("transfer = \"{}\"\n", names[transfer]);
            for (key, value) in [
                ("diagonal_inches", some(0, given[0])),
                ("distance_m", some(1, given[0])),
                ("fov_diagonal_deg", some(2, !given[0])),
                ("peak_cd_m2", some(3, true)),
                ("contrast", some(4, given[1])),
                ("black_cd_m2", some(5, !given[1])),
                ("ambient_lux", some(6, given[2])),
                ("reflectivity", some(7, given[2]).map(|share| share / 2e3)),
                ("gamma", some(8, transfer == 1).map(|exponent| exponent / 400.0)),
            ] {
                if let Some(value) = value {
                    text += &format!("{key} = {value:e}\n");
                }
            }
            if let Ok(file) = toml::from_str::<DisplayFile>(&text)
                && let Ok(display) = file.display()
            {
                display.assert_sound();
            }
        }
    }

    #[test]
    fn what_no_display_has_is_refused_by_its_field() {
        type Change = fn(&mut DisplayFile);
        let cases: [(Change, &str); 9] = [
            (|f| f.size_px = [0, 1080], "size_px"),
            (|f| f.distance_m = None, "the panel's size"),
            (|f| f.fov_diagonal_deg = Some(90.0), "the panel's size"),
            (|f| f.distance_m = Some(f64::NAN), "distance_m"),
            (|f| f.diagonal_inches = Some(0.2), "pixels per degree"),
            (|f| f.peak_cd_m2 = -1.0, "peak_cd_m2"),
            (|f| f.black_cd_m2 = Some(0.1), "black"),
            (|f| f.ambient_lux = 2e5, "black_cd_m2"),
            (|f| f.transfer = TransferName::Gamma, "gamma"),
        ];
        for (change, word) in cases {
            let message = file(change).unwrap_err();
            assert!(message.contains(word), "{message}");
            assert!(message.contains("give "), "{message}");
        }
    }
}
