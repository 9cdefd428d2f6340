//! How is a portable float map (`.pfm`) read, whose rows run upwards?
//!
//! Paul Debevec's format: `PF` or `Pf`, columns and rows, a number that is below 0 where the low
//! byte of samples comes first, then the rows from below. FFmpeg reads it upside down.

use std::path::Path;

use av::format::Pixel;
use av::frame::Video;
use ffmpeg_next as av;

use crate::error::MediaError;
use crate::ffmpeg::start;
use crate::plain_file::{first_bytes, read_plain};
use crate::read::frame::new_frame;
use crate::read::still::decoded_still::DecodedStill;
use crate::read::still::still_tags::StillTags;

/// Most bytes of a file and of its header, and most pixels.
const MOST_BYTES: u64 = 1 << 31;
const MOST_HEADER: usize = 256;
const MOST_PIXELS: usize = 1 << 27;

/// Reads a portable float map; `None` for any other file.
pub(crate) fn open(path: &Path, bytes: u64) -> Result<Option<DecodedStill>, MediaError> {
    let head = first_bytes(path, MOST_HEADER as u64).unwrap_or_default();
    if header(&head).is_none() {
        return Ok(None);
    }
    let broken = |reason: String| MediaError::NoFrames {
        path: path.to_owned(),
        reason,
    };
    let file = read_plain(path, MOST_BYTES).map_err(|error| broken(error.to_string()))?;
    let still = FloatMap::of(&file).and_then(|map| {
        let frame = map.frame()?;
        DecodedStill::of(&frame, StillTags::default(), ("pfm", bytes))
    });
    still.map(Some).map_err(broken)
}

/// Reads any bytes as a portable float map; `true` if they are one: for fuzzing and tests.
#[must_use]
pub fn read_any_float_map(bytes: &[u8]) -> bool {
    FloatMap::of(bytes).is_ok()
}

struct Header {
    /// Samples of a pixel: 1 or 3.
    samples: usize,
    size: [usize; 2],
    is_low_first: bool,
    bytes: usize,
}

/// The header, where it is one.
fn header(file: &[u8]) -> Option<Header> {
    let samples = match file.get(..3)? {
        [b'P', b'F', end] if end.is_ascii_whitespace() => 3,
        [b'P', b'f', end] if end.is_ascii_whitespace() => 1,
        _ => return None,
    };
    let mut at = 3;
    let mut word = || {
        let rest = file.get(at..file.len().min(MOST_HEADER))?;
        let begin = rest.iter().position(|it| !it.is_ascii_whitespace())?;
        let length = rest[begin..].iter().position(u8::is_ascii_whitespace)?;
        at += begin + length + 1;
        std::str::from_utf8(&rest[begin..begin + length]).ok()
    };
    let size = [word()?.parse().ok()?, word()?.parse().ok()?];
    let scale: f64 = word()?.parse().ok()?;
    (scale != 0.0).then_some(Header {
        samples,
        size,
        is_low_first: scale < 0.0,
        bytes: at,
    })
}

struct FloatMap<'a> {
    header: Header,
    /// Its samples, from the lowest row up.
    samples: &'a [u8],
}

impl<'a> FloatMap<'a> {
    fn of(file: &'a [u8]) -> Result<Self, String> {
        let header = header(file).ok_or("its header is broken")?;
        let [w, h] = header.size;
        let pixels = w.saturating_mul(h);
        if pixels == 0 || pixels > MOST_PIXELS {
            return Err(format!("it has {w}x{h} pixels, not 1 to {MOST_PIXELS}"));
        }
        let from = header.bytes;
        let samples = file.get(from..from + 4 * pixels * header.samples);
        Ok(Self {
            samples: samples.ok_or("it ends within the picture")?,
            header,
        })
    }

    fn frame(&self) -> Result<Video, String> {
        start();
        let [w, h] = self.header.size;
        let (format, planes): (_, &[usize]) = match self.header.samples {
            1 => (Pixel::GRAYF32LE, &[0]),
            _ => (Pixel::GBRPF32LE, &[2, 0, 1]),
        };
        let mut frame = new_frame(format, [w as u32, h as u32])?;
        let row_bytes = 4 * w * self.header.samples;
        for (sample, plane) in planes.iter().enumerate() {
            let stride = frame.stride(*plane);
            let rows = frame.data_mut(*plane).chunks_mut(stride).take(h);
            for (to, from) in rows.zip(self.samples.chunks_exact(row_bytes).rev()) {
                let pixels = from.chunks_exact(4 * self.header.samples);
                for (to, pixel) in to.chunks_exact_mut(4).zip(pixels) {
                    to.copy_from_slice(&pixel[4 * sample..][..4]);
                    if !self.header.is_low_first {
                        to.reverse();
                    }
                }
            }
        }
        Ok(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn map(head: &str, floats: &[f32]) -> Vec<u8> {
        let floats: Vec<u8> = floats.iter().flat_map(|it| it.to_le_bytes()).collect();
        [head.as_bytes(), &floats].concat()
    }

    #[test]
    fn rows_are_read_from_below() {
        let file = map("Pf\n1 2\n-1.0\n", &[0.25, 0.75]);
        let frame = FloatMap::of(&file).unwrap().frame().unwrap();
        let sample = |row: usize| {
            let at = row * frame.stride(0);
            f32::from_le_bytes(*frame.data(0)[at..].first_chunk().unwrap())
        };
        assert_eq!([sample(0), sample(1)], [0.75, 0.25]);
        for end in 0..file.len() {
            assert!(!read_any_float_map(&file[..end]), "{end}");
        }
        assert!(!read_any_float_map(&map(
            "PF\n9999999 9999999\n-1\n",
            &[0.0]
        )));
        assert!(!read_any_float_map(&map("PF\n1 1\n0\n", &[0.0; 3])));
        assert!(read_any_float_map(&map("PF 1 1 1.0\n", &[0.0; 3])));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
            let mut file = map("PF\n2 2\n-1.0\n", &[0.5; 12]);
            let at = at.index(file.len());
            file[at] = byte;
            let _ = read_any_float_map(&file);
        }
    }
}
