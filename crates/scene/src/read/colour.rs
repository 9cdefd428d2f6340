//! How much light does a code value of a file give, and which one stands for all light?

use super::sound::count;
use super::text::shortened;
use crate::source::{Repairs, SourceScene};

/// Up to here a colour of a material is brighter than white by mistake. Beyond, it is written from
/// 0 to 255.
const MOST_LIGHT: f64 = 16.0;
/// Up to here it is brighter than white by rounding.
const CUT_LIGHT: f64 = 1.01;

/// How parts of a material's colour, which should be from 0 to 1, are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Brightness {
    AsSaid,
    /// Brighter than white by this much: cut.
    Cut(f64),
    /// Read as codes up to 255; this is the largest.
    Codes(f64),
}

impl Brightness {
    /// For red, green and blue, and what may be an alpha.
    pub(super) fn of(parts: [f64; 3], alpha: f64) -> Self {
        let most = parts[0].max(parts[1]).max(parts[2]);
        if most > MOST_LIGHT || most > CUT_LIGHT && alpha > MOST_LIGHT {
            Self::Codes(most)
        } else if most > CUT_LIGHT {
            Self::Cut(most)
        } else {
            Self::AsSaid
        }
    }

    /// The value that counts as full light.
    pub(super) fn full(self) -> f64 {
        match self {
            Self::Codes(_) => BYTE,
            _ => 1.0,
        }
    }

    /// The name under which it is counted, and what a person should know about `what`.
    pub(super) fn told(self, what: &str) -> Option<(&'static str, String)> {
        match self {
            Self::AsSaid => None,
            Self::Cut(most) => {
                let told = format!("{what} reaches {most}, brighter than white: cut to 1");
                Some(("colours_cut", told))
            }
            Self::Codes(most) => {
                let told = format!("{what} reaches {most}: 255 counts as full light");
                Some(("colours_rescaled", told))
            }
        }
    }
}

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

/// The largest codes of colours of a few bits.
const LARGEST: [f64; 5] = [1.0, 255.0, 1023.0, 4095.0, 65_535.0];
const BYTE: f64 = LARGEST[1];
const TWO_BYTES: f64 = LARGEST[4];
/// Of codes of sixteen bits, so few are darker than pictures are.
const DARK: f64 = 16_384.0;

/// How large the colours of a file are.
///
/// A kind of number does not say which of its values stands for all light: codes of 8 bits are
/// written as `float` and `int`, those of 12 bits as `ushort`, and some of a file may be others.
#[derive(Clone, Debug, Default)]
pub(super) struct Depth {
    /// Number of colours whose largest part is at most one of [`LARGEST`] but above the one
    /// before; the last are beyond. Black says nothing.
    counts: [u64; LARGEST.len() + 1],
    most: f64,
    /// Whether a colour of parts up to 1 has such that are no whole numbers.
    has_fractions: bool,
    is_negative: bool,
}

impl Depth {
    /// Takes a colour into account; parts that are no number are skipped.
    pub(super) fn add(&mut self, parts: [f64; 3]) {
        let most = parts[0].max(parts[1]).max(parts[2]);
        self.is_negative |= parts.iter().any(|it| *it < 0.0);
        if most > 0.0 && most.is_finite() {
            // Sums that should be 1 are so only nearly.
            let is_within = |largest: &f64| most <= largest * (1.0 + 1e-6);
            let place = LARGEST.iter().position(is_within);
            self.counts[place.unwrap_or(LARGEST.len())] += 1;
            self.most = self.most.max(most);
            self.has_fractions |= most <= 1.0 && parts.iter().any(|it| it.fract() != 0.0);
        }
    }

    /// That of codes of a cloud.
    fn of_codes(codes: &[[u16; 3]]) -> Self {
        let mut depth = Self::default();
        let (mut most, mut black) = (0, 0);
        for [red, green, blue] in codes {
            let code = *red.max(green).max(blue);
            black += u64::from(code == 0);
            let above = [code > 1, code > 255, code > 1023, code > 4095];
            let place: usize = above.iter().map(|it| usize::from(*it)).sum();
            depth.counts[place] += 1;
            most = most.max(code);
        }
        depth.counts[0] -= black;
        depth.most = f64::from(most);
        depth
    }

    /// Which value stands for all light, where it would be `usual` by the kind of number: 1 of real
    /// ones.
    pub(super) fn full(&self, usual: f64) -> Full {
        let all = self.counts.iter().sum::<u64>();
        let within = |place: usize| self.counts[..=place].iter().sum::<u64>();
        let is_real = usual <= 1.0;
        let largest = if all == 0 {
            usual
        } else if is_real && (self.most <= 2.0 || 2 * within(0) >= all) {
            // Those beyond are brighter than white.
            1.0
        } else if !is_real && self.most <= 1.0 {
            // Parts of 1, or codes of one bit: of eight bits they would all be black.
            1.0
        } else if !is_real && usual <= BYTE {
            match self.most > usual || self.is_negative {
                true => BYTE,
                false => usual,
            }
        } else if 10 * within(1) >= 9 * all {
            BYTE
        } else if within(2) == all {
            LARGEST[2]
        } else if 1000 * within(3) >= 999 * all {
            LARGEST[3]
        } else if 10 * within(4) >= 9 * all {
            match is_real || self.most > usual || usual > TWO_BYTES {
                true => TWO_BYTES,
                false => usual,
            }
        } else {
            usual.max(TWO_BYTES)
        };
        let is_mixed = largest == TWO_BYTES && 10 * within(1) >= 3 * all;
        Full {
            usual,
            largest,
            wraps: self.is_negative && usual < BYTE && !is_real,
            darkest: (largest == TWO_BYTES && all > 0).then_some(self.most),
            bytes: if is_mixed { within(1) } else { 0 },
        }
    }
}

/// Which value stands for all light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Full {
    usual: f64,
    largest: f64,
    /// Whether negative numbers are codes of 8 bits, wrapped.
    wraps: bool,
    /// The largest part of any colour, of those of sixteen bits.
    darkest: Option<f64>,
    /// Number of colours of 8 bits among those of sixteen.
    bytes: u64,
}

impl Full {
    /// The value itself.
    pub(super) fn largest(&self) -> f64 {
        self.largest
    }

    /// A colour as shares of all light, encoded as it was, from 0 to 1. One far beyond the others
    /// of its file is a code of sixteen bits.
    pub(super) fn shares(&self, parts: [f64; 3]) -> [f64; 3] {
        let full = match self.is_stray(parts) {
            true => TWO_BYTES,
            false => self.largest,
        };
        parts.map(|it| match self.wraps && it < 0.0 {
            true => (it + BYTE + 1.0) / full,
            false => (it / full).clamp(0.0, 1.0),
        })
    }

    /// Whether a colour is of another kind than the others.
    pub(super) fn is_stray(&self, parts: [f64; 3]) -> bool {
        let most = parts[0].max(parts[1]).max(parts[2]);
        self.largest > 1.0 && self.largest < TWO_BYTES && most > 2.0 * self.largest
    }

    /// Counts what of the colours of something was mended, of so many and of so many strays, and
    /// gives what a person should know.
    pub(super) fn tell(
        &self,
        what: &str,
        (colours, strays): (usize, usize),
        repairs: &mut Repairs,
    ) -> Option<String> {
        count(repairs, "colours_of_another_depth", strays);
        if self.largest != self.usual && strays == 0 {
            count(repairs, "colours_rescaled", colours);
        }
        self.remark(what, strays)
    }

    fn remark(&self, what: &str, strays: usize) -> Option<String> {
        let Self { usual, largest, .. } = *self;
        if strays > 0 {
            return Some(format!(
                "colours of {what} reach {largest}, but {strays} of them are beyond: these \
                 count as codes of 16 bits"
            ));
        }
        if largest != usual {
            return Some(format!(
                "colours of {what} reach {largest}, where {usual} would stand for all light: \
                 {largest} counts as it"
            ));
        }
        if self.bytes > 0 {
            return Some(format!(
                "{} colours of {what} are codes of 8 bits among those of 16 bits: they are shown \
                 nearly black",
                self.bytes
            ));
        }
        let dark = self.darkest.filter(|it| *it < DARK)?;
        Some(format!(
            "colours of {what} reach only {dark} of {usual}: they are shown as dark as that"
        ))
    }
}

/// The largest intensity of sixteen bits stands for more than can be measured.
const SATURATED: f64 = TWO_BYTES;

/// Which intensities are black and which white, so that a few that are far from all others leave
/// these their contrast: 0 is black, or the first hundredth where some are negative, and the last
/// hundredth is white, of those that are measured. `None` where none is a number.
pub(super) fn intensities_shown(mut values: Vec<f64>) -> Option<[f64; 2]> {
    values.retain(|it| it.is_finite());
    let measured = values.iter().filter(|it| **it < SATURATED).count();
    if 2 * measured >= values.len() {
        values.retain(|it| *it < SATURATED);
    }
    let last = values.len().checked_sub(1)?;
    let mut at = |place: usize| *values.select_nth_unstable_by(place, f64::total_cmp).1;
    let all = [at(0), at(last)];
    let from = if all[0] < 0.0 { at(last / 100) } else { 0.0 };
    let to = at(last - last / 100);
    match to > from {
        true => Some([from, to]),
        false => Some([from.min(all[0]), all[1]]),
    }
}

/// What stands for no colour at all: a grey as of paper in shade.
const NO_COLOUR: u16 = 176 * 257;

/// The colours of a cloud, which no scan has where all are black: these stand for none. It is grey
/// then, by its intensities where it has some.
pub(super) fn unless_black(
    name: &str,
    colours: Vec<[u16; 3]>,
    intensities: &[u16],
    scene: &mut SourceScene,
) -> Vec<[u16; 3]> {
    if colours.is_empty() || colours.iter().any(|it| *it != [0; 3]) {
        return colours;
    }
    count(&mut scene.repairs, BLACK_COLOURS, colours.len());
    let has_intensities = intensities.iter().any(|it| *it > 0);
    tell_black(name, has_intensities, scene);
    match has_intensities {
        true => Vec::new(),
        false => vec![[NO_COLOUR; 3]; colours.len()],
    }
}

/// Under which name colours are counted that are all black.
pub(super) const BLACK_COLOURS: &str = "black_colours";

/// Reports that all colours of a cloud are black.
pub(super) fn tell_black(name: &str, has_intensities: bool, scene: &mut SourceScene) {
    let instead = match has_intensities {
        true => "as grey by their intensities",
        false => "in one grey",
    };
    scene.remark(format!(
        "the colours of all points of {:?} are black, which stands for no colour: they are shown \
         {instead}",
        shortened(name)
    ));
}

/// Turns encoded colours, with a linear alpha of the same kind, into linear light; gives how many
/// are strays.
pub(super) fn lighten(colours: &mut [[f32; 4]], full: &Full, alpha: f64) -> usize {
    let codes: Vec<f32> = (0..=255)
        .map(|code| linear_from_encoded(f64::from(code) / BYTE))
        .collect();
    let mut strays = 0;
    for colour in colours {
        let parts = [0, 1, 2].map(|k| f64::from(colour[k]));
        strays += usize::from(full.is_stray(parts));
        let is_code = |it: &f32| it.fract() == 0.0 && (0.0..=255.0).contains(it);
        let light = match full.largest == BYTE && colour[..3].iter().all(is_code) {
            true => [0, 1, 2].map(|k| codes[colour[k] as usize]),
            false => full.shares(parts).map(linear_from_encoded),
        };
        let alpha = (f64::from(colour[3]) / alpha).clamp(0.0, 1.0);
        *colour = [light[0], light[1], light[2], alpha as f32];
    }
    strays
}

/// Turns codes of a cloud that are neither of 8 nor of 16 bits, or of both, into such of one kind;
/// counts that, and says what a person should know.
pub(super) fn mend_codes(
    what: &str,
    codes: &mut [[u16; 3]],
    repairs: &mut Repairs,
) -> Option<String> {
    let real = |it: &[u16; 3]| it.map(f64::from);
    let full = Depth::of_codes(codes).full(TWO_BYTES);
    let strays = match full.largest < TWO_BYTES {
        true => codes.iter().filter(|it| full.is_stray(real(it))).count(),
        false => 0,
    };
    // Codes of 8 bits are known as such where all are.
    if full.largest == BYTE && strays == 0 {
        for code in codes.iter_mut().flatten() {
            *code = (*code).min(255);
        }
        return None;
    }
    if full.largest < TWO_BYTES {
        let most = if full.largest == BYTE {
            BYTE
        } else {
            TWO_BYTES
        };
        for code in codes.iter_mut() {
            *code = full.shares(real(code)).map(|it| (it * most).round() as u16);
        }
    }
    full.tell(what, (codes.len(), strays), repairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full(usual: f64, colours: &[[f64; 3]]) -> Full {
        let mut depth = Depth::default();
        colours.iter().for_each(|it| depth.add(*it));
        depth.full(usual)
    }

    #[test]
    fn light_rises_with_the_code_from_none_to_all() {
        let light: Vec<f32> = (0..=255)
            .map(|code| linear_from_encoded(f64::from(code) / 255.0))
            .collect();
        assert_eq!((light[0], light[255]), (0.0, 1.0));
        assert!(light.windows(2).all(|pair| pair[0] < pair[1]));
        assert!((light[188] - 0.503).abs() < 1e-3);
    }

    #[test]
    fn the_largest_codes_tell_what_stands_for_all_light() {
        let largest = |usual, most: f64| {
            let colours = [[0.0, most / 2.0, most], [0.0, 0.0, most / 4.0], [0.0; 3]];
            full(usual, &colours).largest
        };
        assert_eq!(largest(1.0, 1.0), 1.0);
        assert_eq!(largest(1.0, 1.4), 1.0, "brighter than white");
        for usual in [1.0, 65_535.0, f64::from(i32::MAX), f64::from(u32::MAX)] {
            assert_eq!(largest(usual, 255.0), 255.0);
            assert_eq!(largest(usual, 1020.0), 1023.0);
            assert_eq!(largest(usual, 4000.0), 4095.0);
            assert_eq!(largest(usual, 65_000.0), 65_535.0);
        }
        assert_eq!(largest(255.0, 8.0), 255.0, "what is dark stays so");
        assert_eq!(largest(127.0, 200.0), 255.0);
        assert_eq!(largest(f64::from(i32::MAX), 1e9), f64::from(i32::MAX));
        assert_eq!(full(65_535.0, &[]).largest, 65_535.0);
    }

    #[test]
    fn a_few_intensities_far_from_the_others_leave_these_their_contrast() {
        let of = |more: &[f64]| {
            let mut all: Vec<f64> = (0..1000).map(|it| 500.0 + f64::from(it % 100)).collect();
            all.extend(more);
            intensities_shown(all).unwrap()
        };
        assert_eq!(of(&[]), [0.0, 599.0]);
        assert_eq!(of(&[65_535.0; 300]), [0.0, 599.0]);
        assert_eq!(of(&[9000.0, 9000.0, f64::NAN, f64::INFINITY]), [0.0, 599.0]);
        assert_eq!(of(&[-9999.0; 3])[0], 500.0);
        assert_eq!(intensities_shown(vec![7.0; 9]), Some([0.0, 7.0]));
        assert_eq!(intensities_shown(vec![0.0; 9]), Some([0.0, 0.0]));
        assert_eq!(intensities_shown(vec![65_535.0; 9]), Some([0.0, 65_535.0]));
        assert_eq!(intensities_shown(vec![f64::NAN]), None);
    }

    #[test]
    fn one_code_of_sixteen_bits_leaves_those_of_eight_as_they_are() {
        let mut codes = vec![[200, 100, 0]; 60];
        codes.push([51_400, 25_700, 0]);
        let mut repairs = Repairs::new();
        let mut mend = |codes: &mut [[u16; 3]]| mend_codes("points", codes, &mut repairs);
        let remark = mend(&mut codes);
        assert_eq!((codes[0], codes[60]), ([200, 100, 0], [200, 100, 0]));
        assert!(remark.unwrap().contains("1 of them"));
        let mut codes = [[4095, 0, 2048], [100, 3000, 4000]];
        let remark = mend(&mut codes);
        assert_eq!(codes[0], [65_535, 0, 32_776]);
        assert!(remark.unwrap().contains("4095"));
        let mut codes = [[65_535, 0, 300], [200, 300, 9000], [40, 20, 0]];
        let before = codes;
        assert!(mend(&mut codes).is_some(), "dark next to bright");
        assert_eq!(codes, before);
        let mut codes = [[65_535, 0, 300], [400, 300, 9000]];
        assert_eq!(mend(&mut codes), None);
        let counts = [
            ("colours_of_another_depth".to_owned(), 1),
            ("colours_rescaled".to_owned(), 2),
        ];
        assert_eq!(repairs, Repairs::from(counts));
    }
}
