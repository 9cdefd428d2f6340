//! How is a Radiance picture (`.hdr`) read?
//!
//! Greg Ward, "Real Pixels", Graphics Gems II: red, green and blue share an exponent. Rows are
//! stored as they are, with runs of whole pixels, or with runs of each component.

use std::path::Path;

use av::format::Pixel;
use ffmpeg_next as av;

use crate::error::MediaError;
use crate::ffmpeg::start;
use crate::plain_file::{first_bytes, read_plain};
use crate::read::frame::new_frame;
use crate::read::orientation::Orientation;
use crate::read::still::decoded_still::DecodedStill;
use crate::read::still::still_tags::StillTags;

/// What its files begin with.
const HEADS: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];
/// Most bytes of a file and of its header, and most pixels.
const MOST_BYTES: u64 = 1 << 30;
const MOST_HEADER: usize = 1 << 16;
const MOST_PIXELS: usize = 1 << 27;
/// Most pixels for each byte of a file that is meant.
const MOST_A_BYTE: usize = 1 << 12;
/// Widths of rows whose components may be stored one after another.
const BY_COMPONENT: std::ops::Range<usize> = 8..1 << 15;

/// Red, green and blue of Radiance from X, Y and Z of CIE, whose equal parts are white (G. Ward,
/// "Real Pixels", Graphics Gems II, 1991, and the primaries of Radiance).
const RGB_FROM_XYZ: [[f32; 3]; 3] = [
    [2.5653, -1.1668, -0.3984],
    [-1.0221, 1.9783, 0.0438],
    [0.0747, -0.2519, 1.1772],
];

/// Red, green, blue and exponent of every pixel, row by row from above.
struct Radiance {
    size: [usize; 2],
    pixels: Vec<[u8; 4]>,
    /// Whether pixels are X, Y and Z of CIE.
    is_xyz: bool,
    orientation: Orientation,
}

/// Reads a Radiance picture; `None` for any other file.
pub(crate) fn open(path: &Path, bytes: u64) -> Result<Option<DecodedStill>, MediaError> {
    let head = first_bytes(path, 16).unwrap_or_default();
    if !HEADS.iter().any(|it| head.starts_with(it)) {
        return Ok(None);
    }
    let broken = |reason: String| MediaError::NoFrames {
        path: path.to_owned(),
        reason,
    };
    let file = read_plain(path, MOST_BYTES).map_err(|error| broken(error.to_string()))?;
    let still = Radiance::of(&file).and_then(|it| it.still(bytes));
    still.map(Some).map_err(broken)
}

/// Reads any bytes as a Radiance picture; `true` if they are one: for fuzzing and tests.
#[must_use]
pub fn read_any_radiance(bytes: &[u8]) -> bool {
    Radiance::of(bytes).is_ok()
}

impl Radiance {
    fn of(file: &[u8]) -> Result<Self, String> {
        let mut rest = file;
        let mut line = || {
            let end = rest.iter().take(MOST_HEADER).position(|it| *it == b'\n');
            let (line, after) = rest.split_at(end.ok_or("its header has no end")?);
            rest = &after[1..];
            Ok::<_, String>(String::from_utf8_lossy(line).trim().to_owned())
        };
        // Variables, an empty line, then the size.
        let (mut lines, mut is_xyz) = (0, false);
        loop {
            let line = line()?;
            lines += 1;
            if line.is_empty() {
                break;
            }
            if line.to_ascii_uppercase().starts_with("FORMAT=") {
                is_xyz = line.contains("xyze");
                if !is_xyz && !line.contains("rgbe") {
                    return Err(format!("its samples are {line}, not 32-bit_rle_rgbe"));
                }
            }
            if lines > 1000 {
                return Err("its header has no end".to_owned());
            }
        }
        let size = line()?;
        let (size, orientation) = size_of(&size).ok_or_else(|| {
            let short: String = size.chars().take(40).collect();
            format!("{short:?} is not a size as \"-Y 512 +X 1024\"")
        })?;
        if size[0].saturating_mul(size[1]) > MOST_PIXELS {
            let [w, h] = size;
            return Err(format!("it has {w}x{h} pixels, more than {MOST_PIXELS}"));
        }
        if size[0] * size[1] / MOST_A_BYTE > rest.len() {
            return Err("it ends within the picture".to_owned());
        }
        let mut pixels = Vec::new();
        for _ in 0..size[1] {
            read_row(&mut rest, size[0], &mut pixels).ok_or("it ends within the picture")?;
        }
        Ok(Self {
            size,
            pixels,
            is_xyz,
            orientation,
        })
    }

    fn still(&self, bytes: u64) -> Result<DecodedStill, String> {
        start();
        let mut frame = new_frame(Pixel::GBRPF32LE, self.size.map(|side| side as u32))?;
        for (plane, component) in [(2, 0), (0, 1), (1, 2)] {
            let stride = frame.stride(plane);
            let rows = frame.data_mut(plane).chunks_mut(stride);
            for (row, pixels) in rows.zip(self.pixels.chunks(self.size[0])) {
                for (sample, pixel) in row.chunks_exact_mut(4).zip(pixels) {
                    let own = [0, 1, 2].map(|k| light_of(pixel[k], pixel[3]));
                    let light = match self.is_xyz {
                        true => (0..3).map(|k| RGB_FROM_XYZ[component][k] * own[k]).sum(),
                        false => own[component],
                    };
                    sample.copy_from_slice(&light.to_le_bytes());
                }
            }
        }
        let tags = StillTags {
            orientation: self.orientation,
            ..StillTags::default()
        };
        DecodedStill::of(&frame, tags, ("radiance", bytes))
    }
}

/// The light of a component.
fn light_of(code: u8, exponent: u8) -> f32 {
    match exponent {
        0 => 0.0,
        exponent => f32::from(code) * libm::exp2f(f32::from(exponent) - 136.0),
    }
}

/// Columns and rows, and how rows lie, by the line of the size.
fn size_of(line: &str) -> Option<([usize; 2], Orientation)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [first, rows, second, columns] = words[..] else {
        return None;
    };
    let counts = [rows, columns].map(|it| it.parse::<usize>().ok().filter(|it| *it > 0));
    let [Some(first_count), Some(second_count)] = counts else {
        return None;
    };
    // The numbers of EXIF for where the first row and column lie.
    let number = match (first, second) {
        ("-Y", "+X") => 1,
        ("-Y", "-X") => 2,
        ("+Y", "-X") => 3,
        ("+Y", "+X") => 4,
        ("+X", "-Y") => 5,
        ("-X", "-Y") => 6,
        ("-X", "+Y") => 7,
        ("+X", "+Y") => 8,
        _ => return None,
    };
    Some(([second_count, first_count], Orientation::from_exif(number)?))
}

/// Reads a row of pixels behind those that are there; none where the bytes end.
fn read_row(rest: &mut &[u8], width: usize, pixels: &mut Vec<[u8; 4]>) -> Option<()> {
    let head: [u8; 4] = *rest.first_chunk()?;
    let told = usize::from(head[2]) << 8 | usize::from(head[3]);
    let is_by_component = BY_COMPONENT.contains(&width) && head[..2] == [2, 2] && told == width;
    if !is_by_component {
        return read_plain_row(rest, width, pixels);
    }
    *rest = &rest[4..];
    let from = pixels.len();
    pixels.resize(from + width, [0; 4]);
    for component in 0..4 {
        let mut at = from;
        while at < from + width {
            let (count, after) = rest.split_first()?;
            let length = usize::from(if *count > 128 { count - 128 } else { *count });
            let own = pixels[from..].get_mut(at - from..at - from + length)?;
            if *count > 128 {
                let (value, after) = after.split_first()?;
                own.iter_mut().for_each(|it| it[component] = *value);
                *rest = after;
            } else {
                let (values, after) = after.split_at_checked(length)?;
                own.iter_mut()
                    .zip(values)
                    .for_each(|(it, value)| it[component] = *value);
                *rest = after;
            }
            // A run of none goes on for ever.
            at += if length == 0 { width + 1 } else { length };
        }
        if at > from + width {
            return None;
        }
    }
    Some(())
}

/// The same of whole pixels, of which 1, 1, 1 repeats the one before.
fn read_plain_row(rest: &mut &[u8], width: usize, pixels: &mut Vec<[u8; 4]>) -> Option<()> {
    let end = pixels.len() + width;
    let mut shift = 0;
    while pixels.len() < end {
        let pixel: [u8; 4] = *rest.first_chunk()?;
        *rest = &rest[4..];
        if pixel[..3] != [1; 3] {
            pixels.push(pixel);
            shift = 0;
            continue;
        }
        let last = *pixels.last()?;
        let count = usize::from(pixel[3]).checked_shl(shift)?;
        shift = (shift + 8).min(24);
        let count = count.min(end - pixels.len());
        pixels.extend(std::iter::repeat_n(last, count));
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(size: &str, body: &[u8]) -> Result<Radiance, String> {
        let head = format!("#?RADIANCE\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n{size}\n");
        Radiance::of(&[head.as_bytes(), body].concat())
    }

    #[test]
    fn rows_are_read_however_they_are_stored() {
        let plain = of("-Y 1 +X 3", &[9, 8, 7, 129, 1, 1, 1, 2]).unwrap();
        assert_eq!(plain.pixels, [[9, 8, 7, 129]; 3]);
        let runs = [2, 2, 0, 9, 137, 5, 137, 6, 137, 7, 4, 1, 2, 3, 4, 133, 128];
        let found = of("-Y 1 +X 9", &runs).unwrap();
        assert_eq!(
            [found.pixels[0], found.pixels[8]],
            [[5, 6, 7, 1], [5, 6, 7, 128]]
        );
        assert_eq!(light_of(128, 129), 1.0);
        let white: f32 = RGB_FROM_XYZ.iter().flatten().sum();
        assert!((white - 3.0).abs() < 1e-3, "{white}");
        assert!(
            Radiance::of(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\x09\x08\x07\x81")
                .unwrap()
                .is_xyz
        );
        for end in 0..runs.len() {
            assert!(of("-Y 1 +X 9", &runs[..end]).is_err(), "{end}");
        }
        assert!(of("-Y 90000 +X 90000", &runs).is_err());
        assert!(of("+Z 1 +X 9", &runs).is_err());
        let turned = of("+X 3 +Y 1", &[9; 12]).unwrap();
        assert_eq!(
            (turned.size, Some(turned.orientation)),
            ([1, 3], Orientation::from_exif(8))
        );
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            body in prop::collection::vec(
                prop::sample::select(&b"\0\x01\x02\x09\x80\x89\xff"[..]), 0..60,
            ),
        ) {
            let _ = of("-Y 3 +X 9", &body);
            let _ = Radiance::of(&body);
        }
    }
}
