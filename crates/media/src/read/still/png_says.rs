//! What does a PNG say of its samples and of the way it is to be looked at?
//!
//! Of its chunks up to its end: what lies behind that belongs to something else.

use std::io::{Read, Seek, SeekFrom};

/// What begins every PNG.
const PNG: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// Bytes of a chunk's length, name and checksum.
const CHUNK: u64 = 12;
/// Most chunks that are looked at, and most bytes of EXIF.
const MOST_CHUNKS: u32 = 1 << 16;
const MOST_EXIF: u32 = 1 << 20;
/// The power of light that sRGB comes close to, and by how much another is the same.
const USUAL: f64 = 1.0 / 2.2;
const ALIKE: f64 = 0.02;
/// Powers that can be meant.
const POWERS: std::ops::RangeInclusive<f64> = 0.2..=2.5;
/// H.273's numbers of curves: light itself, PQ and HLG.
const LINEAR: u8 = 8;
const HDR: [u8; 2] = [16, 18];

/// What its chunks say.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PngSays {
    pub(crate) exif: Option<Vec<u8>>,
    /// A sample is light to this power, where that is not what displays expect.
    pub(crate) power: Option<f64>,
    /// Whether its samples follow PQ or HLG.
    pub(crate) is_hdr: bool,
}

impl PngSays {
    /// Of a file; nothing where it is no PNG.
    pub(crate) fn read(file: &mut (impl Read + Seek)) -> Self {
        let mut says = Self::default();
        let mut colours = Colours::default();
        // What was read counts, wherever the file ends.
        let _ = says.take(file, &mut colours);
        says.is_hdr = colours.curve.is_some_and(|it| HDR.contains(&it));
        says.power = match colours {
            Colours {
                curve: Some(LINEAR),
                ..
            } => Some(1.0),
            Colours {
                curve: None,
                has_profile: false,
                power,
            } => power,
            _ => None,
        };
        says
    }

    fn take(&mut self, file: &mut (impl Read + Seek), colours: &mut Colours) -> Option<()> {
        let mut at = file.seek(SeekFrom::Start(0)).ok()?;
        let mut head = [0; 8];
        file.read_exact(&mut head).ok()?;
        if head != PNG {
            return None;
        }
        at += PNG.len() as u64;
        for _ in 0..MOST_CHUNKS {
            file.seek(SeekFrom::Start(at)).ok()?;
            file.read_exact(&mut head).ok()?;
            let length = u32::from_be_bytes(*head.first_chunk()?);
            let mut four = [0; 4];
            match &head[4..] {
                b"IEND" => return Some(()),
                b"sRGB" | b"iCCP" => colours.has_profile = true,
                b"gAMA" if length == 4 => {
                    file.read_exact(&mut four).ok()?;
                    let power = f64::from(u32::from_be_bytes(four)) / 1e5;
                    let is_other = POWERS.contains(&power) && (power - USUAL).abs() > ALIKE;
                    colours.power = is_other.then_some(power);
                }
                b"cICP" if length == 4 => {
                    file.read_exact(&mut four).ok()?;
                    colours.curve = Some(four[1]);
                }
                b"eXIf" if length <= MOST_EXIF => {
                    let mut exif = Vec::new();
                    file.take(u64::from(length)).read_to_end(&mut exif).ok()?;
                    self.exif = Some(exif);
                }
                _ => {}
            }
            at += CHUNK + u64::from(length);
        }
        None
    }
}

/// What chunks say of the curve, of which the one that says most counts.
#[derive(Default)]
struct Colours {
    /// The number of a curve (cICP).
    curve: Option<u8>,
    /// Whether it says that it is sRGB, or has an ICC profile.
    has_profile: bool,
    power: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn png(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let chunk = |(name, inside): &(&[u8; 4], &[u8])| {
            let length = (inside.len() as u32).to_be_bytes();
            [&length[..], &name[..], inside, &[0; 4]].concat()
        };
        [PNG.to_vec(), chunks.iter().flat_map(chunk).collect()].concat()
    }

    fn says(chunks: &[(&[u8; 4], &[u8])]) -> PngSays {
        PngSays::read(&mut Cursor::new(png(chunks)))
    }

    #[test]
    fn the_chunk_that_says_most_of_the_curve_counts() {
        let gamma = |power: u32| power.to_be_bytes();
        assert_eq!(says(&[(b"gAMA", &gamma(100_000))]).power, Some(1.0));
        assert_eq!(says(&[(b"gAMA", &gamma(45_455))]).power, None);
        // No power can be meant.
        assert_eq!(says(&[(b"gAMA", &gamma(0))]).power, None);
        let profiled = [(b"gAMA", &gamma(100_000)[..]), (b"sRGB", &[0][..])];
        assert_eq!(says(&profiled).power, None);
        let told = [
            (b"gAMA", &gamma(100_000)[..]),
            (b"cICP", &[9, 16, 0, 1][..]),
        ];
        assert_eq!((says(&told).power, says(&told).is_hdr), (None, true));
        assert_eq!(says(&[(b"cICP", &[1, 8, 0, 1])]).power, Some(1.0));
        // Behind the end nothing counts.
        let behind = [(b"IEND", &[][..]), (b"eXIf", &[1, 2][..])];
        assert_eq!(says(&behind), PngSays::default());
        assert_eq!(says(&[(b"eXIf", &[1, 2])]).exif, Some(vec![1, 2]));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in any::<prop::sample::Index>(), byte in any::<u8>(),
        ) {
            let mut bytes = png(&[(b"gAMA", &[0; 4]), (b"cICP", &[0; 4]), (b"eXIf", &[7; 9])]);
            let at = at.index(bytes.len());
            bytes[at] = byte;
            PngSays::read(&mut Cursor::new(&bytes));
            PngSays::read(&mut Cursor::new(&bytes[..at]));
        }
    }
}
