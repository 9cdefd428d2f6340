//! What in a tile might draw the eye, in four bytes?
//!
//! The measures that saliency is made of. `docs/formats/pack.md` is normative.

/// Measures of one tile over one group, in 8-bit code values unless said otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cues {
    /// Standard deviation of red, green and blue, the root of the mean of their variances
    /// (Kastner 2016 calls a cell noisy by its RGB variance).
    pub deviation: f64,
    /// Mean gradient of luma, per pixel.
    pub edges: f64,
    /// Mean distance from the tile's mean colour in CIE L*a*b*, in units of ΔE*ab.
    pub colour: f64,
    /// Mean absolute difference of luma between the first and the last picture of the group.
    pub change: f64,
}

/// Largest value of each measure that is stored: deviation, edges, colour, change.
const MOST: [f64; 4] = [128.0, 128.0, 128.0, 255.0];

impl Cues {
    /// Bytes of the cues of a unit in the table.
    pub const BYTES: usize = 4;

    /// The cues as they lie in the table, each as the root of its share of the largest value.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let told = [self.deviation, self.edges, self.colour, self.change];
        core::array::from_fn(|k| ((told[k] / MOST[k]).clamp(0.0, 1.0).sqrt() * 255.0).round() as u8)
    }

    /// The cues that these bytes encode. Every combination of bytes is some.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let [deviation, edges, colour, change] = core::array::from_fn(|k| {
            let root = f64::from(bytes[k]) / 255.0;
            root * root * MOST[k]
        });
        Self {
            deviation,
            edges,
            colour,
            change,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_bytes_are_cues_and_come_back(bytes in any::<[u8; Cues::BYTES]>()) {
            prop_assert_eq!(Cues::from_bytes(bytes).to_bytes(), bytes);
        }
    }

    #[test]
    fn small_measures_are_told_finely() {
        let cues = Cues {
            deviation: 0.5,
            edges: 0.5,
            colour: 0.5,
            change: 0.5,
        };
        let told = Cues::from_bytes(cues.to_bytes());
        assert!((told.deviation - 0.5).abs() < 0.04, "{told:?}");
    }
}
