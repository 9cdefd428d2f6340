//! Which displays need no file?
//!
//! Names and figures are those of the published package, pyfvvdp 1.2.2.

use super::display::{Display, Photometry, Transfer, extent, headset_extent, inches};

/// A display of the published package.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedDisplay {
    /// What it is.
    pub display: Display,
    /// Why nothing is scored on it, and what to give in its place; of most displays `None`.
    pub refused: Option<&'static str>,
}

/// What the package's pictures for a display of linear light hold, and what to do with them.
const HOLDS_LIGHT: &str = "its pictures hold light in cd/m² as floating point numbers, which are \
not read; write them as 16-bit PNG in PQ codes and give standard_hdr_pq, or give a file with \
transfer = \"linear\" whose codes are shares of its peak";

/// How large a display stands before the eye.
enum Diagonal {
    /// Its diagonal in inches and its distance in metres.
    Inches(f64, f64),
    /// The angle that its diagonal fills.
    Degrees(f64),
}

use Diagonal::{Degrees, Inches};

/// Name, panel, how large it stands there; light of white, of black in the dark, and lux.
type Figures = (&'static str, [u32; 2], Diagonal, [f64; 3]);

const FIGURES: [Figures; 14] = [
    (
        "standard_4k",
        UHD,
        Inches(30.0, 0.7472),
        [200.0, 0.2, 250.0],
    ),
    ("standard_fhd", FHD, Inches(24.0, 0.6), [200.0, 0.2, 250.0]),
    ("standard_hmd", VIVE, Degrees(110.0), [100.0, 0.1, 0.0]),
    (
        "standard_phone",
        [2400, 1080],
        Inches(6.0, 0.4),
        [500.0, 0.05, 250.0],
    ),
    (
        "standard_hdr_pq",
        UHD,
        Inches(30.0, 0.7472),
        [1500.0, 0.0015, 10.0],
    ),
    (
        "standard_hdr_linear",
        UHD,
        Inches(30.0, 0.7472),
        [1500.0, 0.0015, 10.0],
    ),
    ("sdr_4k_30", UHD, Inches(30.0, 0.6), [100.0, 0.1, 250.0]),
    ("sdr_fhd_24", FHD, Inches(24.0, 0.6), [100.0, 0.1, 250.0]),
    ("htc_vive_pro", VIVE, Degrees(110.0), [133.3, 0.1, 0.0]),
    (
        "iphone_12_pro",
        [2532, 1170],
        Inches(6.1, inches(20.0)),
        [825.0, 0.0004, 250.0],
    ),
    (
        "ipad_pro_12_9",
        [2732, 2048],
        Inches(12.9, inches(20.0)),
        [600.0, 0.37, 250.0],
    ),
    (
        "macbook_pro_16",
        [3072, 1920],
        Inches(16.0, inches(25.0)),
        [500.0, 0.37, 250.0],
    ),
    (
        "lg_oled_2017_sdr",
        UHD,
        Inches(64.5, inches(101.0)),
        [272.0, 0.014, 100.0],
    ),
    (
        "lg_oled_2017_hdr",
        UHD,
        Inches(64.5, inches(101.0)),
        [754.0, 0.038, 100.0],
    ),
];
const UHD: [u32; 2] = [3840, 2160];
const FHD: [u32; 2] = [1920, 1080];
const VIVE: [u32; 2] = [1440, 1600];

impl NamedDisplay {
    /// All of them, those first that are called standard.
    pub fn all() -> impl Iterator<Item = Self> {
        FIGURES.into_iter().map(Self::of)
    }

    /// The display of a name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|named| named.display.name == name)
    }

    fn of((name, size_px, diagonal, [peak, black, lux]): Figures) -> Self {
        let extent = match diagonal {
            Inches(diagonal, distance) => extent(size_px, inches(diagonal), distance),
            Degrees(angle) => headset_extent(size_px, angle),
        };
        let light = Photometry {
            peak_cd_m2: peak,
            black_cd_m2: black,
            ambient_lux: lux,
        };
        let (transfer, refused) = match name {
            "standard_hdr_pq" => (Transfer::Pq, None),
            "standard_hdr_linear" => (Transfer::Linear, Some(HOLDS_LIGHT)),
            _ => (Transfer::Srgb, None),
        };
        let display = Display {
            transfer,
            ..Display::of(name, size_px, extent, light)
        };
        Self { display, refused }
    }
}

impl Display {
    /// The display of a name, if pictures can be scored on it.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let found = NamedDisplay::find(name)?;
        found.refused.is_none().then_some(found.display)
    }

    /// Names of the displays that need no file.
    #[must_use]
    pub fn names() -> Vec<String> {
        let scored = NamedDisplay::all().filter(|named| named.refused.is_none());
        scored.map(|named| named.display.name).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixels per degree, black with the room's light, peak.
    const WANTED: [(&str, [f64; 3]); 14] = [
        ("standard_4k", [75.4024, 0.597_887, 200.0]),
        ("standard_fhd", [37.8425, 0.597_887, 200.0]),
        ("standard_hmd", [13.1533, 0.1, 100.0]),
        ("standard_phone", [120.5608, 0.447_887, 500.0]),
        ("standard_hdr_pq", [75.4024, 0.017_415_5, 1500.0]),
        ("standard_hdr_linear", [75.4024, 0.017_415_5, 1500.0]),
        ("sdr_4k_30", [60.5480, 0.497_887, 100.0]),
        ("sdr_fhd_24", [37.8425, 0.497_887, 100.0]),
        ("htc_vive_pro", [13.1533, 0.1, 133.3]),
        ("iphone_12_pro", [159.6119, 0.398_287, 825.0]),
        ("ipad_pro_12_9", [92.3915, 0.767_887, 600.0]),
        ("macbook_pro_16", [98.7924, 0.767_887, 500.0]),
        ("lg_oled_2017_sdr", [120.4107, 0.173_155, 272.0]),
        ("lg_oled_2017_hdr", [120.4107, 0.197_155, 754.0]),
    ];

    #[test]
    fn every_display_of_the_package_has_its_published_geometry_and_light() {
        assert_eq!(NamedDisplay::all().count(), WANTED.len());
        for (name, [ppd, black, peak]) in WANTED {
            let display = NamedDisplay::find(name).unwrap().display;
            let found = [display.ppd(), display.black_cd_m2, display.peak_cd_m2];
            for (found, wanted) in found.into_iter().zip([ppd, black, peak]) {
                let off = (found / wanted - 1.0).abs();
                assert!(off < 5e-6, "{name}: {found}, wanted {wanted}");
            }
            display.assert_sound();
        }
        let [across, down] = Display::named("standard_hmd").unwrap().fov_deg();
        assert!((across - 87.39).abs() < 0.005 && (down - 93.42).abs() < 0.005);
    }

    #[test]
    fn a_display_whose_pictures_are_not_read_has_no_score() {
        assert_eq!(Display::named("standard_hdr_linear"), None);
        assert_eq!(Display::named("mine"), None);
        assert_eq!(Display::names().len(), WANTED.len() - 1);
    }
}
