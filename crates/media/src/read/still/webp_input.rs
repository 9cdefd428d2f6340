//! How is an animated WebP read, which FFmpeg does not decode?
//!
//! Its pictures are decoded one by one, as stills, and laid over each other here. The published
//! decoder leaves trails where a picture that covers a part should vanish.

use std::io::Cursor;
use std::ops::Range;
use std::path::Path;

use foveal_core::view::picture::{Colour, Matrix};
use image_webp::WebPDecoder;

use crate::error::MediaError;
use crate::plain_file::{first_bytes, read_plain};
use crate::read::film::mended::Mended;
use crate::read::options::TimedPicture;
use crate::read::source::{SourceInfo, Transparency};
use crate::read::still::animation_canvas::{Canvas, Cover};
use crate::read::still::still_tags::StillTags;

/// Most bytes of a file, and most pixels of its pictures.
const MOST_BYTES: u64 = 256 << 20;
const MOST_PIXELS: u64 = 1 << 27;
/// How long browsers show a picture without a duration, in milliseconds.
const UNSAID_MS: u32 = 100;
/// Bytes of a file's header, and of a picture's header before its data.
const RIFF_HEAD: usize = 12;
const FRAME_HEAD: usize = 16;
/// Bytes by which a file may be shorter than it says: the last byte may only pad it to an even
/// length.
const PADDING: u64 = 1;
/// How its planes are made of red, green and blue: as FFmpeg's are.
const COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: false,
};

/// An open animation, read from front to back.
pub(crate) struct WebPInput {
    film: WebPFilm,
    info: SourceInfo,
    canvas: Canvas,
    /// Decoded to learn whether it can be seen through.
    first: Option<Vec<u8>>,
    taken: usize,
    begins_ms: u64,
    mended: Mended,
}

/// The parts of a file.
struct WebPFilm {
    file: Vec<u8>,
    size: [u32; 2],
    has_alpha: bool,
    /// The pictures that are complete.
    frames: Vec<WebPFrame>,
    why_cut: Option<String>,
}

/// A picture: how it covers the canvas, for how long, and where in the file it lies.
#[derive(Clone)]
struct WebPFrame {
    cover: Cover,
    /// Milliseconds.
    shown_ms: u32,
    parts: Range<usize>,
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
        let no_frames = |reason: String| MediaError::NoFrames {
            path: path.to_owned(),
            reason,
        };
        let file = read_plain(path, MOST_BYTES)
            .map_err(|error| broken(format!("an animated WebP of {bytes} bytes: {error}")))?;
        let film = WebPFilm::of(file).map_err(broken)?;
        let missing = || film.why_cut.clone().unwrap_or("it is empty".to_owned());
        if film.frames.is_empty() {
            return Err(no_frames(missing()));
        }
        let first = film.decoded(0);
        // A damaged picture is mended and counted, unless there is no other.
        let is_any = || (1..film.frames.len()).any(|number| film.decoded(number).is_ok());
        if let Err(reason) = &first
            && !is_any()
        {
            return Err(no_frames(reason.clone()));
        }
        let mut canvas = Canvas::new(film.size);
        canvas.draw(film.frames[0].cover, first.as_deref().ok());
        let is_transparent = canvas.is_clear();
        let mended = Mended {
            breaks_off: film.why_cut.clone(),
            is_transparent,
            ..Mended::default()
        };
        Ok(Some(Self {
            info: film.info(bytes, is_transparent),
            canvas: Canvas::new(film.size),
            film,
            first: first.ok(),
            taken: 0,
            begins_ms: 0,
            mended,
        }))
    }

    /// What is known of it.
    pub(crate) fn info(&self) -> &SourceInfo {
        &self.info
    }

    /// What was mended so far.
    pub(crate) fn mended(&self) -> Mended {
        self.mended.clone()
    }

    /// How long the last picture is shown, in nanoseconds.
    pub(crate) fn last_ns(&self) -> Option<i64> {
        let last = self.film.frames.get(self.taken.checked_sub(1)?)?;
        Some(i64::from(last.shown_ms) * 1_000_000)
    }

    /// The next picture; in place of a damaged one the picture before stays.
    pub(crate) fn next_frame(&mut self) -> Option<TimedPicture> {
        let frame = self.film.frames.get(self.taken)?.clone();
        let time_ns = self.begins_ms as i64 * 1_000_000;
        let pixels = match self.first.take() {
            Some(first) => Ok(first),
            None => self.film.decoded(self.taken),
        };
        if pixels.is_err() {
            self.mended.damaged += 1;
            let first = (self.taken as u64, time_ns);
            self.mended.first_damaged.get_or_insert(first);
        }
        self.canvas.draw(frame.cover, pixels.as_deref().ok());
        self.mended.is_transparent |= self.canvas.is_clear();
        self.taken += 1;
        self.begins_ms += u64::from(frame.shown_ms);
        Some(TimedPicture {
            picture: self.canvas.over_black(COLOUR),
            time_ns,
        })
    }
}

impl WebPFilm {
    /// Takes a file apart, as far as it goes. The error says why that is impossible.
    fn of(file: Vec<u8>) -> Result<Self, String> {
        let word = |at: usize| Some(u32::from_le_bytes(*file.get(at..)?.first_chunk()?));
        let told = u64::from(word(4).unwrap_or(0)) + 8;
        let is_told = told > RIFF_HEAD as u64;
        let there = file.len() as u64;
        let mut why_cut = (is_told && told > there + PADDING).then_some("it ends too early");
        // Bytes after the end do not belong to it.
        let end = if is_told { told.min(there) } else { there } as usize;
        let (mut size, mut flags) = (None, 0);
        let mut frames = Vec::new();
        let mut at = RIFF_HEAD;
        while let Some((name, inside)) = chunk(&file[..end], at) {
            at = inside.end + inside.len() % 2;
            if inside.end > end {
                why_cut = Some("it ends within a picture");
                break;
            }
            match name {
                b"VP8X" => {
                    flags = file[inside.clone()].first().copied().unwrap_or(0);
                    size = pair_at(&file[inside], 4).map(|it| it.map(|side| side + 1));
                }
                b"ANMF" => frames.extend(WebPFrame::of(&file, inside)),
                _ => {}
            }
        }
        let size = size.ok_or("an animated WebP without its size")?;
        let [w, h] = size.map(u64::from);
        if w * h > MOST_PIXELS {
            return Err(format!(
                "an animated WebP of {w}x{h} pixels, more than {MOST_PIXELS}"
            ));
        }
        Ok(Self {
            size,
            has_alpha: flags & 0x10 != 0,
            frames,
            why_cut: why_cut.map(str::to_owned),
            file,
        })
    }

    /// Red, green, blue and alpha of a picture by itself.
    fn decoded(&self, number: usize) -> Result<Vec<u8>, String> {
        let frame = &self.frames[number];
        let [w, h] = frame.cover.size.map(u64::from);
        if w * h > MOST_PIXELS {
            return Err("it is too large".to_owned());
        }
        let still = frame.as_still(&self.file)?;
        let decoder = WebPDecoder::new(Cursor::new(still));
        let mut decoder = decoder.map_err(|error| error.to_string())?;
        decoder.set_memory_limit(MOST_BYTES as usize);
        let length = decoder.output_buffer_size().ok_or("it is too large")?;
        if decoder.dimensions() != frame.cover.size.into() {
            return Err("it is of another size than it says".to_owned());
        }
        let mut pixels = vec![0; length];
        let read = decoder.read_image(&mut pixels);
        read.map_err(|error| error.to_string())?;
        if decoder.has_alpha() {
            return Ok(pixels);
        }
        let opaque = |it: &[u8]| [it[0], it[1], it[2], 255];
        Ok(pixels.chunks_exact(3).flat_map(opaque).collect())
    }

    fn info(&self, bytes: u64, is_transparent: bool) -> SourceInfo {
        let frames = self.frames.len() as u64;
        let length_ms = self.frames.iter().map(|it| u64::from(it.shown_ms)).sum();
        let names = ("webp", if self.has_alpha { "rgba" } else { "rgb24" });
        SourceInfo {
            // As many pictures a second as on average.
            frame_rate: reduced(frames * 1000, length_ms),
            frames: Some(frames),
            frames_told: Some(frames),
            seconds: Some(length_ms as f64 / 1e3),
            transparency: is_transparent.then_some(Transparency::OverBlack),
            looks_still: frames == 1,
            ..SourceInfo::of_still(self.size, COLOUR, names, StillTags::default(), bytes)
        }
    }
}

impl WebPFrame {
    /// The picture whose bytes lie there; none where they are too few.
    fn of(file: &[u8], inside: Range<usize>) -> Option<Self> {
        let head = &file[inside.clone()];
        let at = pair_at(head, 0)?.map(|half| 2 * half);
        let size = pair_at(head, 6)?.map(|side| side + 1);
        let [a, b, c, flags] = *head.get(12..)?.first_chunk()?;
        let shown_ms = u32::from_le_bytes([a, b, c, 0]);
        Some(Self {
            cover: Cover {
                at,
                size,
                blends: flags & 2 == 0,
                vanishes: flags & 1 != 0,
            },
            shown_ms: if shown_ms == 0 { UNSAID_MS } else { shown_ms },
            parts: inside.start + FRAME_HEAD..inside.end,
        })
    }

    /// A still file made of its data.
    fn as_still(&self, file: &[u8]) -> Result<Vec<u8>, String> {
        let parts = &file[self.parts.clone()];
        let mut at = 0;
        let (mut alpha, mut coded) = (None, None);
        while let Some((name, inside)) = chunk(parts, at) {
            at = inside.end + inside.len() % 2;
            let whole = parts.get(inside);
            match name {
                b"ALPH" => alpha = whole,
                b"VP8 " | b"VP8L" => coded = whole.map(|whole| (name, whole)),
                _ => {}
            }
        }
        let (name, coded) = coded.ok_or("it lacks its data")?;
        let is_lossless = name == b"VP8L";
        // The decoder would allocate the size that the data give before any check.
        let side = |at: usize| {
            let it = coded.get(at..at + 2)?;
            Some(u32::from(u16::from_le_bytes([it[0], it[1]]) & 0x3fff))
        };
        if !is_lossless && [side(6), side(8)] != self.cover.size.map(Some) {
            return Err("it is of another size than it says".to_owned());
        }
        let alpha = alpha.filter(|_| !is_lossless);
        let flags = if is_lossless || alpha.is_some() {
            0x10
        } else {
            0
        };
        let [w, h] = self.cover.size.map(|side| (side - 1).to_le_bytes());
        let head = [&[flags, 0, 0, 0], &w[..3], &h[..3]].concat();
        let mut body = [&b"WEBP"[..], &written(b"VP8X", &head)].concat();
        body.extend(alpha.map(|it| written(b"ALPH", it)).unwrap_or_default());
        body.extend(written(name, coded));
        Ok(written(b"RIFF", &body))
    }
}

/// Name and contents of the chunk that begins there; it may end after the bytes do.
fn chunk(bytes: &[u8], at: usize) -> Option<(&[u8; 4], Range<usize>)> {
    let name = bytes.get(at..)?.first_chunk()?;
    let length = u32::from_le_bytes(*bytes.get(at + 4..)?.first_chunk()?);
    Some((name, at + 8..at + 8 + length as usize))
}

/// A chunk with these contents.
fn written(name: &[u8; 4], inside: &[u8]) -> Vec<u8> {
    let mut bytes = [&name[..], &(inside.len() as u32).to_le_bytes(), inside].concat();
    bytes.resize(bytes.len() + inside.len() % 2, 0);
    bytes
}

/// Two numbers of three bytes each.
fn pair_at(bytes: &[u8], at: usize) -> Option<[u32; 2]> {
    let [a, b, c, d, e, f] = *bytes.get(at..)?.first_chunk()?;
    Some([[a, b, c, 0], [d, e, f, 0]].map(u32::from_le_bytes))
}

/// A fraction in small numbers.
fn reduced(num: u64, den: u64) -> [i32; 2] {
    let (mut a, mut b) = (num, den);
    while b > 0 {
        (a, b) = (b, a % b);
    }
    [num, den].map(|number| i32::try_from(number / a.max(1)).unwrap_or(i32::MAX))
}

#[cfg(test)]
mod tests {
    use super::written;
    use crate::VideoInput;
    use crate::tests::scenes::{Scratch, read};
    use image_webp::{ColorType, WebPEncoder};
    use proptest::prelude::*;

    /// Pictures of one colour each, shown for so many milliseconds.
    fn animation(pictures: &[([u8; 4], u32)]) -> Vec<u8> {
        let mut body = b"WEBP".to_vec();
        // Moves, and has alpha; 16 x 16.
        body.extend(written(b"VP8X", &[0x12, 0, 0, 0, 15, 0, 0, 15, 0, 0]));
        body.extend(written(b"ANIM", &[0; 6]));
        for (colour, ms) in pictures {
            let mut still = Vec::new();
            let pixels = colour.repeat(256);
            WebPEncoder::new(&mut still)
                .encode(&pixels, 16, 16, ColorType::Rgba8)
                .unwrap();
            let [a, b, c, _] = ms.to_le_bytes();
            let mut frame = vec![0, 0, 0, 0, 0, 0, 15, 0, 0, 15, 0, 0, a, b, c, 2];
            frame.extend(&still[12..]);
            body.extend(written(b"ANMF", &frame));
        }
        written(b"RIFF", &body)
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

    /// A picture of one colour, lossless, that covers a part of 16 x 16.
    fn part(colour: [u8; 4], at: [u8; 2], size: [u8; 2], flags: u8) -> Vec<u8> {
        let mut still = Vec::new();
        let pixels = colour.repeat(usize::from(size[0]) * usize::from(size[1]));
        let [w, h] = size.map(u32::from);
        WebPEncoder::new(&mut still)
            .encode(&pixels, w, h, ColorType::Rgba8)
            .unwrap();
        let [x, y] = at.map(|it| it / 2);
        let [w, h] = size.map(|it| it - 1);
        let mut frame = vec![x, 0, 0, y, 0, 0, w, 0, 0, h, 0, 0, 100, 0, 0, flags];
        frame.extend(&still[12..]);
        written(b"ANMF", &frame)
    }

    fn of_parts(parts: &[Vec<u8>]) -> Vec<u8> {
        let mut body = b"WEBP".to_vec();
        body.extend(written(b"VP8X", &[0x12, 0, 0, 0, 15, 0, 0, 15, 0, 0]));
        body.extend(written(b"ANIM", &[0; 6]));
        written(b"RIFF", &[body, parts.concat()].concat())
    }

    /// Luma in the middle of the four quarters of each picture.
    fn quarters(pictures: &[crate::TimedPicture]) -> Vec<[u8; 4]> {
        let luma = |it: &crate::TimedPicture| {
            let plane = &it.picture.planes[0];
            [[4, 4], [12, 4], [4, 12], [12, 12]].map(|[x, y]| plane[y * 16 + x])
        };
        pictures.iter().map(luma).collect()
    }

    #[test]
    fn what_vanishes_leaves_no_trail_and_what_blends_lies_over_what_is_there() {
        let (white, half) = ([255; 4], [255, 255, 255, 128]);
        let (gone, over) = (1, 0);
        let file = of_parts(&[
            part(white, [0, 0], [8, 8], gone),
            part(white, [8, 0], [8, 8], gone),
            // All of it is clear: only the part before it vanishes.
            part([0; 4], [0, 0], [16, 16], over),
            part(white, [0, 8], [8, 8], over),
            part(half, [8, 8], [8, 8], over),
            // Beyond the canvas.
            part(white, [8, 8], [16, 16], 2),
        ]);
        let (input, pictures) = read(&Scratch::holding("webp", &file));
        let shown = quarters(&pictures.unwrap());
        let (lit, dark) = (235, 16);
        assert_eq!(
            shown[..2],
            [[lit, dark, dark, dark], [dark, lit, dark, dark]]
        );
        assert_eq!(shown[2], [dark; 4]);
        assert_eq!(shown[3], [dark, dark, lit, dark]);
        assert_eq!(shown[4][..3], [dark, dark, lit]);
        assert!((120..132).contains(&shown[4][3]), "{shown:?}");
        assert_eq!(shown[5], [dark, dark, lit, lit]);
        assert_eq!(input.mended().repairs().len(), 0);
    }

    #[test]
    fn whole_pictures_of_a_cut_or_damaged_file_are_shown_and_counted() {
        let pictures = [0, 60, 120, 180].map(|grey| ([grey, grey, grey, 255], 100));
        let whole = animation(&pictures);
        let last = whole.windows(4).rposition(|it| it == b"ANMF").unwrap();
        for end in [whole.len() - 3, last + 9, last + 5, last] {
            let (input, shown) = read(&Scratch::holding("webp", &whole[..end]));
            assert_eq!(shown.unwrap().len(), 3, "{end}");
            assert_eq!(
                input.mended().repairs().into_iter().collect::<Vec<_>>(),
                [("cut_short".to_owned(), 1)]
            );
        }
        let mut damaged = whole.clone();
        let second = whole.windows(4).enumerate().filter(|(_, it)| it == b"VP8L");
        let second = second.map(|(at, _)| at).nth(1).unwrap();
        damaged[second + 8..second + 20].fill(0xff);
        let (input, shown) = read(&Scratch::holding("webp", &damaged));
        assert_eq!(shown.unwrap().len(), 4);
        let mended = input.mended();
        assert_eq!(
            (mended.damaged, mended.first_damaged),
            (1, Some((1, 100_000_000)))
        );
        // Bytes after the end are no damage, and neither is a length that was never written.
        let behind = [&whole[..], b"ANMF\xff\xff\xff\xff"].concat();
        let mut untold = whole.clone();
        untold[4..8].fill(0);
        for file in [behind, untold] {
            let (input, shown) = read(&Scratch::holding("webp", &file));
            assert_eq!(
                (shown.unwrap().len(), input.mended().repairs().len()),
                (4, 0)
            );
        }
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
