//! What kind of TIFF is it, and who reads it?
//!
//! TIFF 6.0 and BigTIFF. FFmpeg's decoder draws some kinds black and calls others damaged.

use std::collections::HashSet;
use std::io::{Read, Seek, SeekFrom};

use foveal_core::units::counted;

/// Most pages that are counted, and most entries of one.
const MOST_PAGES: u32 = 4096;
const MOST_ENTRIES: u64 = 4096;
/// Most values of an entry that are read.
const MOST_VALUES: u64 = 1 << 16;
/// How samples may be compressed: JPEG as it is stored today, and what FFmpeg reads (fax, LZW,
/// Deflate twice, PackBits, and none).
pub(crate) const JPEG: u16 = 7;
const OF_FFMPEG: [u16; 8] = [1, 2, 3, 4, 5, 8, 32_773, 32_946];
const NAMES: [(u16, &str); 14] = [
    (6, "JPEG in the old style"),
    (JPEG, "JPEG"),
    (9, "JBIG"),
    (34_661, "JBIG"),
    (32_809, "ThunderScan"),
    (33_003, "JPEG 2000"),
    (33_005, "JPEG 2000"),
    (34_712, "JPEG 2000"),
    (34_676, "LogLuv"),
    (34_677, "LogLuv"),
    (34_887, "LERC"),
    (34_925, "LZMA"),
    (50_000, "ZSTD"),
    (50_001, "WebP"),
];
/// What samples may be: numbers with a sign, and floating-point numbers.
const SIGNED: u16 = 2;
const FLOATS: u16 = 3;
/// Kinds of colour: CIE L*a*b* in three ways.
const LAB: [u16; 3] = [8, 9, 10];
/// Kinds of colour up to this one are shown: those of TIFF 6.0.
const MOST_COLOUR: u16 = 8;
/// Kinds of pictures: a smaller one of another, and a mask of one.
const SMALLER: u64 = 1;
const MASK: u64 = 4;
/// Samples of more bits are measurements.
const MOST_BITS: u16 = 16;
/// An extra sample that is alpha by which colours are multiplied already.
const MULTIPLIED: u16 = 1;

/// What the first picture of full size of a file is, else the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TiffHead {
    is_big: bool,
    /// Columns and rows.
    pub size: [u64; 2],
    bits: u16,
    compression: u16,
    colour: u16,
    samples: u16,
    format: u16,
    is_planar: bool,
    is_tiled: bool,
    extra: Option<u16>,
    /// EXIF's number, 1 to 8.
    pub(crate) orientation: u32,
    /// Pictures of full size.
    pub(crate) pages: u32,
    /// Where the last of its coded data ends.
    end: u64,
    /// Whether the picture is a smaller one of another, as of raw files of cameras.
    is_preview: bool,
    /// The number of its directory, counted from 0.
    pub(crate) number: usize,
}

/// Reads numbers of a file at places in it.
struct Places<'a, F> {
    file: &'a mut F,
    is_big: bool,
    is_low_first: bool,
}

impl<F: Read + Seek> Places<'_, F> {
    /// A number of so many bytes, 1 to 8.
    fn number(&mut self, at: u64, bytes: usize) -> Option<u64> {
        let mut all = [0; 8];
        let own = all.get_mut(..bytes)?;
        self.file.seek(SeekFrom::Start(at)).ok()?;
        self.file.read_exact(own).ok()?;
        if self.is_low_first {
            own.reverse();
        }
        Some(own.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    /// Bytes of a place in the file.
    fn place_bytes(&self) -> usize {
        if self.is_big { 8 } else { 4 }
    }

    /// Bytes of a value of the entry at a place, how many values there are, and where they lie.
    fn extent(&mut self, at: u64) -> Option<(usize, u64, u64)> {
        let bytes = match self.number(at.checked_add(2)?, 2)? {
            1 => 1,
            3 => 2,
            4 => 4,
            16 => 8,
            _ => return None,
        };
        let wide = self.place_bytes();
        let count = self.number(at.checked_add(4)?, wide)?;
        let inside = at.checked_add(4 + wide as u64)?;
        let place = match count.checked_mul(bytes as u64)? > wide as u64 {
            true => self.number(inside, wide)?,
            false => inside,
        };
        Some((bytes, count, place))
    }

    /// The first value of the entry at a place.
    fn value(&mut self, at: u64) -> Option<u64> {
        let (bytes, _, place) = self.extent(at)?;
        self.number(place, bytes)
    }

    /// All its values, of a sane number of them.
    fn values(&mut self, at: u64) -> Option<Vec<u64>> {
        let (bytes, count, place) = self.extent(at)?;
        let place_of = |k: u64| place.checked_add(k * bytes as u64);
        let count = count.min(MOST_VALUES);
        (0..count)
            .map(|k| self.number(place_of(k)?, bytes))
            .collect()
    }

    /// Where the entries of a directory lie, and the place of the next one.
    fn directory(&mut self, at: u64) -> Option<(Vec<u64>, u64)> {
        let (head, entry) = if self.is_big { (8, 20) } else { (2, 12) };
        let count = self.number(at, head)?;
        if count > MOST_ENTRIES {
            return None;
        }
        let first = at.checked_add(head as u64)?;
        let end = first.checked_add(count * entry)?;
        let entries = (0..count).map(|k| first + k * entry).collect();
        let next = self.number(end, self.place_bytes());
        Some((entries, next.unwrap_or(0)))
    }
}

impl TiffHead {
    /// Of a file; none where it is no TIFF, or its first directory cannot be read.
    pub fn read(file: &mut (impl Read + Seek)) -> Option<Self> {
        let mut head = [0; 4];
        file.seek(SeekFrom::Start(0)).ok()?;
        file.read_exact(&mut head).ok()?;
        let (is_low_first, is_big) = match &head {
            b"II\x2a\0" => (true, false),
            b"MM\0\x2a" => (false, false),
            b"II\x2b\0" => (true, true),
            b"MM\0\x2b" => (false, true),
            _ => return None,
        };
        let mut places = Places {
            file,
            is_big,
            is_low_first,
        };
        let first = places.number(if is_big { 8 } else { 4 }, places.place_bytes())?;
        let (entries, mut next) = places.directory(first)?;
        let mut found = Self::of_directory(&mut places, &entries)?;
        let mut pages = 1;
        let mut seen = HashSet::from([0, first]);
        while seen.insert(next) && seen.len() < MOST_PAGES as usize {
            let Some((entries, after)) = places.directory(next) else {
                break;
            };
            let kind = kind_of(&mut places, &entries);
            let is_page = kind & (SMALLER | MASK) == 0;
            // Samples of a camera's sensor are no colours.
            let is_better = |it: &Self| {
                let is_larger = (0..2).all(|k| it.size[k] > found.size[k]);
                let is_alike = (0..2).all(|k| it.size[k] >= found.size[k]);
                it.colour <= MOST_COLOUR && (is_larger || is_page && is_alike)
            };
            let other = (kind & MASK == 0 && found.is_preview)
                .then(|| Self::of_directory(&mut places, &entries))
                .flatten()
                .filter(is_better);
            match other {
                Some(whole) => {
                    let number = seen.len() - 2;
                    found = Self {
                        number,
                        is_preview: false,
                        ..whole
                    };
                }
                None => pages += u32::from(is_page),
            }
            next = after;
        }
        found.pages = pages;
        Some(found)
    }

    /// Of a directory with entries at these places.
    fn of_directory(places: &mut Places<'_, impl Read + Seek>, entries: &[u64]) -> Option<Self> {
        let mut found = Self {
            is_big: places.is_big,
            size: [0; 2],
            bits: 1,
            compression: 1,
            colour: 1,
            samples: 1,
            format: 1,
            is_planar: false,
            is_tiled: false,
            extra: None,
            orientation: 1,
            pages: 0,
            end: 0,
            is_preview: false,
            number: 0,
        };
        let (mut begins, mut lengths) = (Vec::new(), Vec::new());
        for at in entries.iter().copied() {
            match places.number(at, 2)? {
                273 | 324 => begins = places.values(at).unwrap_or_default(),
                279 | 325 => lengths = places.values(at).unwrap_or_default(),
                _ => {}
            }
            found.take(places, at);
        }
        let ends = begins
            .iter()
            .zip(&lengths)
            .map(|(at, length)| at.saturating_add(*length));
        found.end = ends.max().unwrap_or(0);
        Some(found)
    }

    fn take(&mut self, places: &mut Places<'_, impl Read + Seek>, at: u64) -> Option<()> {
        let tag = places.number(at, 2)?;
        let value = places.value(at)?;
        let small = u16::try_from(value).ok();
        match tag {
            254 => self.is_preview = value & SMALLER != 0,
            256 => self.size[0] = value,
            257 => self.size[1] = value,
            258 => self.bits = small?,
            259 => self.compression = small?,
            262 => self.colour = small?,
            274 => self.orientation = u32::from(small?),
            277 => self.samples = small?,
            284 => self.is_planar = value == 2,
            322 => self.is_tiled = true,
            338 => self.extra = small,
            339 => self.format = small?,
            _ => {}
        }
        Some(())
    }

    /// Whether FFmpeg shows it as it is.
    pub(crate) fn is_for_ffmpeg(&self) -> bool {
        self.number == 0
            && !self.is_big
            && !self.is_tiled
            && OF_FFMPEG.contains(&self.compression)
            && ![SIGNED, FLOATS].contains(&self.format)
            && self.bits <= MOST_BITS
            && !LAB.contains(&self.colour)
    }

    /// Whether its colours are multiplied by its alpha, as they look over black.
    pub(crate) fn is_multiplied(&self) -> bool {
        self.extra == Some(MULTIPLIED)
    }

    /// Whether each of several samples of a pixel is stored by itself.
    pub(crate) fn is_apart(&self) -> bool {
        self.is_planar && self.samples > 1
    }

    /// Whether coded data lie behind the end of a file of so many bytes.
    pub(crate) fn is_cut(&self, bytes: u64) -> bool {
        self.end > bytes
    }

    /// What kind it is, for people.
    pub(crate) fn kind(&self) -> String {
        let plain = if self.is_big { "BigTIFF" } else { "TIFF" };
        let mut more = match (self.format, self.bits) {
            (FLOATS, bits) => format!(" of {bits}-bit floating-point samples"),
            (SIGNED, bits) => format!(" of {bits}-bit samples with a sign"),
            (_, bits) if bits > MOST_BITS => format!(" of {bits}-bit samples"),
            _ => String::new(),
        };
        if self.is_tiled {
            more += " in tiles";
        }
        if LAB.contains(&self.colour) {
            more += " in L*a*b*";
        }
        if self.is_apart() {
            more += ", each colour by itself";
        }
        match NAMES.iter().find(|it| it.0 == self.compression) {
            Some((_, name)) => more += &format!(", compressed by {name}"),
            None if OF_FFMPEG.contains(&self.compression) => {}
            None => more += &format!(", compressed by method {}", self.compression),
        }
        if more.is_empty() {
            let (samples, bits, colour) = (self.samples, self.bits, self.colour);
            let of = counted(samples, "sample");
            more =
                format!(" of {of} a pixel, of {bits} bits (photometric interpretation {colour})");
        }
        format!("{plain}{more}")
    }

    /// What is said of its other pages, if there are any.
    pub(crate) fn pages_note(&self) -> Option<String> {
        if self.is_preview {
            let what = "its first picture is a smaller one of another that it holds, and is shown; \
                        develop the raw file of a camera with `darktable-cli FILE OUT.png`";
            return Some(what.to_owned());
        }
        if self.number > 0 {
            let what = "its first picture is a smaller one of another, which is shown";
            return Some(what.to_owned());
        }
        (self.pages > 1).then(|| {
            format!(
                "its first of {} pages is shown; `magick FILE PAGE-%d.png` writes each",
                self.pages
            )
        })
    }
}

/// What kind of picture a directory is of: 0, or the sum of [`SMALLER`] and the like.
fn kind_of(places: &mut Places<'_, impl Read + Seek>, entries: &[u64]) -> u64 {
    const KIND: u64 = 254;
    let is_kind = |places: &mut Places<'_, _>, at: u64| places.number(at, 2) == Some(KIND);
    let found = entries.iter().find(|at| is_kind(places, **at)).copied();
    found.and_then(|at| places.value(at)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    /// Directories of entries: tag and value.
    fn tiff(pages: &[&[(u16, u16)]]) -> Vec<u8> {
        let mut bytes = b"II\x2a\0\x08\0\0\0".to_vec();
        for (number, entries) in (1..).zip(pages) {
            bytes.extend((entries.len() as u16).to_le_bytes());
            for (tag, value) in *entries {
                bytes.extend(tag.to_le_bytes());
                bytes.extend([3, 0, 1, 0, 0, 0]);
                bytes.extend(value.to_le_bytes());
                bytes.extend([0, 0]);
            }
            let next = if number == pages.len() {
                0
            } else {
                bytes.len() as u32 + 4
            };
            bytes.extend(next.to_le_bytes());
        }
        bytes
    }

    fn head(pages: &[&[(u16, u16)]]) -> TiffHead {
        TiffHead::read(&mut Cursor::new(tiff(pages))).unwrap()
    }

    #[test]
    fn kinds_that_ffmpeg_shows_wrong_are_told_from_others() {
        let size = [(256, 4), (257, 3), (258, 8), (262, 2), (277, 3)];
        let with = |more: &[(u16, u16)]| head(&[&[&size[..], more].concat()]);
        assert!(with(&[(259, 5)]).is_for_ffmpeg() && with(&[]).is_for_ffmpeg());
        for (tag, value, told) in [
            (259, 7, "JPEG"),
            (259, 6, "old style"),
            (259, 50_000, "ZSTD"),
            (259, 4711, "method 4711"),
            (339, 3, "floating-point"),
            (322, 64, "tiles"),
            (262, 8, "L*a*b*"),
        ] {
            let head = with(&[(tag, value)]);
            assert!(
                !head.is_for_ffmpeg() && head.kind().contains(told),
                "{}",
                head.kind()
            );
        }
    }

    #[test]
    fn pages_are_counted_without_smaller_pictures_and_masks() {
        let page: &[(u16, u16)] = &[(256, 4), (257, 3)];
        let smaller: &[(u16, u16)] = &[(254, 1), (256, 2), (257, 1)];
        assert_eq!(head(&[page]).pages_note(), None);
        assert_eq!(head(&[page, smaller]).pages, 1);
        assert_eq!(head(&[page, smaller, page]).pages, 2);
        // Where a smaller one comes first, the other is meant.
        let behind = head(&[smaller, smaller, page]);
        assert_eq!((behind.number, behind.size, behind.pages), (2, [4, 3], 1));
        assert!(!behind.is_for_ffmpeg());
        assert!(behind.pages_note().unwrap().contains("which is shown"));
        assert_eq!(head(&[smaller, smaller]).number, 0);
        // One that is larger is no smaller one, whatever it says; samples of a sensor stay aside.
        let larger: &[(u16, u16)] = &[(254, 1), (256, 9), (257, 9)];
        assert_eq!(head(&[smaller, larger]).number, 1);
        let sensor: &[(u16, u16)] = &[(256, 9), (257, 9), (262, 32_803)];
        assert_eq!(head(&[smaller, sensor]).number, 0);
        // One that leads back to itself.
        let mut round = tiff(&[page, page]);
        let end = round.len() - 4;
        round[end..].copy_from_slice(&8u32.to_le_bytes());
        assert_eq!(TiffHead::read(&mut Cursor::new(round)).unwrap().pages, 2);
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in any::<prop::sample::Index>(), byte in any::<u8>(), is_big in any::<bool>(),
        ) {
            let mut bytes = tiff(&[&[(256, 4), (258, 8), (259, 7)], &[(254, 1)]]);
            if is_big {
                bytes[2] = 43;
            }
            let at = at.index(bytes.len());
            bytes[at] = byte;
            let _ = TiffHead::read(&mut Cursor::new(&bytes)).map(|it| it.kind());
            let _ = TiffHead::read(&mut Cursor::new(&bytes[..at]));
        }
    }
}
