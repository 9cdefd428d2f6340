//! How is an animated WebP read, which FFmpeg does not decode?

use std::io::Cursor;
use std::path::{Path, PathBuf};

use foveal_core::view::picture::{Colour, Matrix};
use image_webp::WebPDecoder;

use crate::error::MediaError;
use crate::plain_file::{first_bytes, read_plain};
use crate::read::deliver::over;
use crate::read::film::mended::Mended;
use crate::read::options::TimedPicture;
use crate::read::source::{SourceInfo, Transparency};
use crate::read::still::still_tags::StillTags;
use crate::write::picture_from_rgba::picture_from_rgba;

/// Most bytes of a file, and most pixels of its pictures.
const MOST_BYTES: u64 = 256 << 20;
const MOST_PIXELS: u64 = 1 << 27;
/// What browsers show a picture for that says no time, in milliseconds.
const UNSAID_MS: u32 = 100;
/// How its planes are made of red, green and blue: as FFmpeg's are.
const COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: false,
};

/// An open animation, read from front to back.
pub(crate) struct WebPInput {
    path: PathBuf,
    decoder: WebPDecoder<Cursor<Vec<u8>>>,
    info: SourceInfo,
    /// Decoded to learn whether it can be seen through.
    first: Option<Frame>,
    taken: u64,
    begins_ms: u64,
    last_ms: u32,
    is_transparent: bool,
}

/// Red, green, blue and alpha of every pixel, and how long they are shown in milliseconds.
struct Frame {
    rgba: Vec<u8>,
    shown_ms: u32,
}

impl WebPInput {
    /// Opens a WebP file of several pictures; `None` for any other file.
    pub(crate) fn open(path: &Path, bytes: u64) -> Result<Option<Self>, MediaError> {
        let head = first_bytes(path, 64).unwrap_or_default();
        let is_webp = head.starts_with(b"RIFF") && head.get(8..16) == Some(b"WEBPVP8X");
        // A flag of the extended header says that it moves.
        if !is_webp || head.get(20).is_none_or(|flags| flags & 2 == 0) {
            return Ok(None);
        }
        let broken = |reason: String| MediaError::NotVideo {
            path: path.to_owned(),
            reason,
        };
        let file = read_plain(path, MOST_BYTES)
            .map_err(|error| broken(format!("an animated WebP of {bytes} bytes: {error}")))?;
        check(&file).map_err(broken)?;
        let decoder = WebPDecoder::new(Cursor::new(file));
        let mut decoder = decoder.map_err(|error| broken(error.to_string()))?;
        let (width, height) = decoder.dimensions();
        if u64::from(width) * u64::from(height) > MOST_PIXELS || !decoder.is_animated() {
            return Err(broken(format!(
                "an animated WebP of {width}x{height} pixels, more than {MOST_PIXELS}"
            )));
        }
        decoder.set_memory_limit(MOST_BYTES as usize);
        let frames = decoder.num_frames().max(1);
        let length_ms = decoder.loop_duration().clamp(1, 1 << 30);
        let first = next(&mut decoder).map_err(|reason| MediaError::NoFrames {
            path: path.to_owned(),
            reason,
        })?;
        let is_transparent = is_clear(&first.rgba);
        let info = SourceInfo {
            width,
            height,
            frame_rate: match length_ms {
                // As many pictures a second as on average.
                ms if ms > 1 => reduced(u64::from(frames) * 1000, ms),
                _ => [10, 1],
            },
            frames: Some(u64::from(frames)),
            frames_told: Some(u64::from(frames)),
            seconds: Some(length_ms as f64 / 1e3),
            colour: COLOUR,
            spherical: None,
            stereo: None,
            tags: StillTags::default(),
            broken_boxes: Vec::new(),
            camera: None,
            sound: None,
            transparency: is_transparent.then_some(Transparency::OverBlack),
            pixel_aspect: None,
            is_hdr: false,
            is_interlaced: false,
            codec: "webp".to_owned(),
            pixel_format: if decoder.has_alpha() { "rgba" } else { "rgb24" }.to_owned(),
            bytes,
            looks_still: frames == 1,
        };
        Ok(Some(Self {
            path: path.to_owned(),
            decoder,
            info,
            first: Some(first),
            taken: 0,
            begins_ms: 0,
            last_ms: 0,
            is_transparent,
        }))
    }

    /// What is known of it.
    pub(crate) fn info(&self) -> &SourceInfo {
        &self.info
    }

    /// What was mended so far.
    pub(crate) fn mended(&self) -> Mended {
        Mended {
            is_transparent: self.is_transparent,
            ..Mended::default()
        }
    }

    /// How long the last picture is shown, in nanoseconds.
    pub(crate) fn last_ns(&self) -> Option<i64> {
        Some(i64::from(self.last_ms) * 1_000_000)
    }

    pub(crate) fn next_frame(&mut self) -> Result<Option<TimedPicture>, MediaError> {
        let frame = match self.first.take() {
            Some(frame) => frame,
            None if self.taken >= u64::from(self.decoder.num_frames()) => return Ok(None),
            None => next(&mut self.decoder).map_err(|reason| MediaError::Broken {
                path: self.path.clone(),
                frame: self.taken,
                seconds: self.begins_ms as f64 / 1e3,
                reason,
            })?,
        };
        self.is_transparent |= is_clear(&frame.rgba);
        let mut rgba = frame.rgba;
        for pixel in rgba.chunks_exact_mut(4).filter(|pixel| pixel[3] < 255) {
            let alpha = pixel[3];
            pixel[..3]
                .iter_mut()
                .for_each(|code| *code = over(*code, 0, alpha));
        }
        let picture = picture_from_rgba(&rgba, [self.info.width, self.info.height], COLOUR);
        let time_ns = self.begins_ms as i64 * 1_000_000;
        self.taken += 1;
        self.begins_ms += u64::from(frame.shown_ms);
        self.last_ms = frame.shown_ms;
        Ok(Some(TimedPicture { picture, time_ns }))
    }
}

fn next(decoder: &mut WebPDecoder<Cursor<Vec<u8>>>) -> Result<Frame, String> {
    let length = decoder.output_buffer_size().ok_or("it is too large")?;
    let mut pixels = vec![0; length];
    let shown_ms = decoder
        .read_frame(&mut pixels)
        .map_err(|error| error.to_string())?;
    let rgba = match decoder.has_alpha() {
        true => pixels,
        false => pixels
            .chunks_exact(3)
            .flat_map(|it| [it[0], it[1], it[2], 255])
            .collect(),
    };
    let shown_ms = if shown_ms == 0 { UNSAID_MS } else { shown_ms };
    Ok(Frame { rgba, shown_ms })
}

fn is_clear(rgba: &[u8]) -> bool {
    rgba.chunks_exact(4).any(|pixel| pixel[3] < 255)
}

/// A fraction in small numbers.
fn reduced(num: u64, den: u64) -> [i32; 2] {
    let (mut a, mut b) = (num, den);
    while b > 0 {
        (a, b) = (b, a % b);
    }
    [num, den].map(|number| i32::try_from(number / a.max(1)).unwrap_or(i32::MAX))
}

/// The chunks that follow each other: name and contents.
fn chunks(mut rest: &[u8]) -> impl Iterator<Item = (&[u8], &[u8])> {
    core::iter::from_fn(move || {
        let (name, length) = (rest.get(..4)?, rest.get(4..8)?);
        let length = u32::from_le_bytes(length.try_into().ok()?) as usize;
        let contents = rest.get(8..8 + length)?;
        rest = rest.get(8 + length + length % 2..).unwrap_or_default();
        Some((name, contents))
    })
}

/// Refuses pictures of another size than their frame, which the decoder would write beyond.
fn check(file: &[u8]) -> Result<(), String> {
    let three = |bytes: &[u8], at: usize| {
        let it = bytes.get(at..at + 3)?;
        Some(u32::from_le_bytes([it[0], it[1], it[2], 0]))
    };
    let frames = chunks(file.get(12..).unwrap_or_default());
    for (_, frame) in frames.filter(|(name, _)| *name == b"ANMF") {
        let size = [6, 9].map(|at| three(frame, at).map(|side| side + 1));
        let parts = chunks(frame.get(16..).unwrap_or_default());
        for (_, coded) in parts.filter(|(name, _)| *name == b"VP8 ") {
            let side = |at: usize| {
                let it = coded.get(at..at + 2)?;
                Some(u32::from(u16::from_le_bytes([it[0], it[1]]) & 0x3fff))
            };
            if [side(6), side(8)] != size {
                return Err("a picture of it is of another size than it says".to_owned());
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::VideoInput;
    use crate::tests::scenes::{Scratch, read};
    use image_webp::{ColorType, WebPEncoder};
    use proptest::prelude::*;

    fn chunk(name: &[u8; 4], contents: &[u8]) -> Vec<u8> {
        let mut bytes = [&name[..], &(contents.len() as u32).to_le_bytes(), contents].concat();
        bytes.resize(bytes.len() + contents.len() % 2, 0);
        bytes
    }

    /// Pictures of one colour each, shown for so many milliseconds.
    fn animation(pictures: &[([u8; 4], u32)]) -> Vec<u8> {
        let mut body = b"WEBP".to_vec();
        // Moves, and has alpha; 16 x 16.
        body.extend(chunk(b"VP8X", &[0x12, 0, 0, 0, 15, 0, 0, 15, 0, 0]));
        body.extend(chunk(b"ANIM", &[0; 6]));
        for (colour, ms) in pictures {
            let mut still = Vec::new();
            let pixels = colour.repeat(256);
            WebPEncoder::new(&mut still)
                .encode(&pixels, 16, 16, ColorType::Rgba8)
                .unwrap();
            let [a, b, c, _] = ms.to_le_bytes();
            let mut frame = vec![0, 0, 0, 0, 0, 0, 15, 0, 0, 15, 0, 0, a, b, c, 2];
            frame.extend(&still[12..]);
            body.extend(chunk(b"ANMF", &frame));
        }
        chunk(b"RIFF", &body)
    }

    #[test]
    fn every_picture_is_shown_as_long_as_it_says() {
        let (white, clear) = ([255; 4], [255, 255, 255, 0]);
        let file = animation(&[(white, 100), (clear, 300), (white, 1500)]);
        let (input, pictures) = read(&Scratch::holding("webp", &file));
        let pictures = pictures.unwrap();
        let times: Vec<i64> = pictures.iter().map(|it| it.time_ns / 1_000_000).collect();
        assert_eq!(times, [0, 100, 400]);
        assert_eq!(input.last_ns(), Some(1_500_000_000));
        let luma = |at: usize| pictures[at].picture.planes[0][0];
        assert_eq!([luma(0), luma(1), luma(2)], [235, 16, 235]);
        assert!(input.mended().is_transparent && input.info().transparency.is_none());
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in 0usize..4000,
            bytes in prop::collection::vec(any::<u8>(), 1..5),
        ) {
            let mut file = animation(&[([9, 99, 200, 255], 40), ([1, 2, 3, 128], 0)]);
            let at = at % file.len();
            let end = (at + bytes.len()).min(file.len());
            file[at..end].copy_from_slice(&bytes[..end - at]);
            let file = Scratch::holding("webp", &file);
            if let Ok(mut input) = VideoInput::open(&file) {
                while let Ok(Some(_)) = input.next_frame() {}
            }
        }
    }
}
