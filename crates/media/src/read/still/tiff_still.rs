//! How is a TIFF read that FFmpeg draws black or refuses?
//!
//! JPEG in it, BigTIFF, tiles and floating-point samples are decoded by the published crate; what
//! that does not read either is refused by its kind.

use std::io::{BufReader, ErrorKind, Seek};
use std::path::Path;

use av::format::Pixel;
use av::frame::Video;
use ffmpeg_next as av;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::{ColorType, TiffError};

use crate::error::MediaError;
use crate::ffmpeg::start;
use crate::plain_file::open_plain;
use crate::read::frame::new_frame;
use crate::read::orientation::Orientation;
use crate::read::still::decoded_still::DecodedStill;
use crate::read::still::still_tags::StillTags;
use crate::read::still::tiff_head::TiffHead;

/// Most pixels of a picture, and most bytes of its samples.
const MOST_PIXELS: u64 = 1 << 28;
const MOST_BYTES: usize = 1 << 31;
/// Floating-point samples are light where none is below this and at most this share above 1.
const LEAST_LIGHT: f32 = -0.01;
const MOST_BRIGHT: f64 = 0.5;

const CONVERT: &str = "convert it with `magick FILE OUT.png` or `gdal_translate -of PNG FILE \
                       OUT.png`";
const SCALE: &str = "convert it with `gdal_translate -of PNG -ot Byte -scale FILE OUT.png`, which \
                     makes its least value black and its greatest white";

/// Why a picture is not read.
enum Refusal {
    /// What it is instead, and what to do.
    Kind(String, &'static str),
    Broken(String),
}

/// Reads a TIFF that FFmpeg does not show as it is; `None` for any other file.
pub(crate) fn open(path: &Path, bytes: u64) -> Result<Option<DecodedStill>, MediaError> {
    let Ok((file, _)) = open_plain(path) else {
        return Ok(None);
    };
    let mut file = BufReader::new(file);
    let Some(head) = TiffHead::read(&mut file) else {
        return Ok(None);
    };
    if head.is_for_ffmpeg() && !head.is_multiplied() {
        return Ok(None);
    }
    let still = decoded(&mut file, &head).and_then(|frame| {
        let tags = tags_of(path, &head);
        DecodedStill::of(&frame, tags, ("tiff", bytes)).map_err(Refusal::Broken)
    });
    let path = path.to_owned();
    match still {
        Ok(still) => Ok(Some(still)),
        // FFmpeg multiplies once more, which darkens edges and no more.
        Err(_) if head.is_for_ffmpeg() => Ok(None),
        Err(Refusal::Broken(reason)) => Err(MediaError::NoFrames { path, reason }),
        Err(Refusal::Kind(found, next)) => Err(MediaError::Unsupported {
            path,
            field: "the kind of picture",
            found,
            next,
        }),
    }
}

/// Why FFmpeg found no picture in a TIFF that is whole, by its kind; none for another file.
pub(crate) fn kind_refused(path: &Path, bytes: u64) -> Option<MediaError> {
    let (file, _) = open_plain(path).ok()?;
    let head = TiffHead::read(&mut BufReader::new(file))?;
    (!head.is_cut(bytes)).then(|| MediaError::Unsupported {
        path: path.to_owned(),
        field: "the kind of picture",
        found: head.kind(),
        next: CONVERT,
    })
}

fn tags_of(path: &Path, head: &TiffHead) -> StillTags {
    let orientation = Orientation::from_exif(head.orientation).unwrap_or_default();
    StillTags {
        orientation,
        ..StillTags::of(path)
    }
}

fn decoded(file: &mut BufReader<std::fs::File>, head: &TiffHead) -> Result<Video, Refusal> {
    start();
    let kind = || Refusal::Kind(head.kind(), CONVERT);
    let why = |error: TiffError| match error {
        TiffError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            Refusal::Broken("it ends within the picture".to_owned())
        }
        TiffError::FormatError(error) => Refusal::Broken(error.to_string()),
        TiffError::IoError(error) => Refusal::Broken(error.to_string()),
        _ => kind(),
    };
    let [w, h] = head.size;
    if w == 0 || h == 0 {
        return Err(Refusal::Broken("it has no pixels".to_owned()));
    }
    if w.saturating_mul(h) > MOST_PIXELS {
        let found = format!("{} of {w}x{h} pixels, more than {MOST_PIXELS}", head.kind());
        return Err(Refusal::Kind(found, "scale it down first"));
    }
    if head.is_apart() {
        return Err(kind());
    }
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MOST_BYTES;
    limits.intermediate_buffer_size = MOST_BYTES;
    file.rewind()
        .map_err(|error| Refusal::Broken(error.to_string()))?;
    let mut decoder = Decoder::new(file).map_err(why)?.with_limits(limits);
    if head.number > 0 {
        decoder.seek_to_image(head.number).map_err(why)?;
    }
    let colour = decoder.colortype().map_err(why)?;
    let (w, h) = decoder.dimensions().map_err(why)?;
    let samples = decoder.read_image().map_err(why)?;
    let layout = Samples {
        colour,
        size: [w, h],
        is_multiplied: head.is_multiplied(),
    };
    match samples {
        DecodingResult::U8(codes) => layout.words(&codes, |code| u16::from(code) * 257),
        DecodingResult::U16(codes) => layout.words(&codes, |code| code),
        DecodingResult::F16(codes) => {
            let codes: Vec<f32> = codes.into_iter().map(f32::from).collect();
            layout.floats(&codes, head)
        }
        DecodingResult::F32(codes) => layout.floats(&codes, head),
        DecodingResult::F64(codes) => {
            let codes: Vec<f32> = codes.into_iter().map(|it| it as f32).collect();
            layout.floats(&codes, head)
        }
        _ => return Err(Refusal::Kind(head.kind(), SCALE)),
    }
    .ok_or_else(kind)?
}

/// How decoded samples follow each other.
struct Samples {
    colour: ColorType,
    size: [u32; 2],
    is_multiplied: bool,
}

impl Samples {
    /// Samples of a pixel, and which of them are red, green, blue and alpha; none where they are
    /// other colours.
    fn order(&self) -> Option<(usize, &'static [usize])> {
        let order: (usize, &[usize]) = match self.colour {
            ColorType::Gray(_) => (1, &[0, 0, 0]),
            ColorType::GrayA(_) => (2, &[0, 0, 0, 1]),
            ColorType::Multiband { num_samples: 2, .. } => (2, &[0, 0, 0, 1]),
            ColorType::RGB(_) | ColorType::YCbCr(_) => (3, &[0, 1, 2]),
            ColorType::RGBA(_) => (4, &[0, 1, 2, 3]),
            ColorType::CMYK(_) => (4, &[0, 1, 2]),
            _ => return None,
        };
        match order {
            (samples, all) if self.is_multiplied && all.len() == 4 => Some((samples, &all[..3])),
            order => Some(order),
        }
    }

    /// A frame of 16-bit samples, or of 8-bit ones where no more are stored.
    fn words<T: Copy>(
        &self,
        codes: &[T],
        word: impl Fn(T) -> u16,
    ) -> Option<Result<Video, Refusal>> {
        let (samples, order) = self.order()?;
        let is_whole = self.colour.bit_depth() == 8 || self.colour.bit_depth() == 16;
        if !is_whole || codes.len() < samples * self.size[0] as usize * self.size[1] as usize {
            return None;
        }
        let is_small = self.colour.bit_depth() == 8;
        let format = match (order.len(), is_small) {
            (4, true) => Pixel::RGBA,
            (4, false) => Pixel::RGBA64LE,
            (_, true) => Pixel::RGB24,
            (_, false) => Pixel::RGB48LE,
        };
        let bytes = if is_small { 1 } else { 2 };
        let mut frame = match new_frame(format, self.size) {
            Ok(frame) => frame,
            Err(why) => return Some(Err(Refusal::Broken(why))),
        };
        let (stride, width) = (frame.stride(0), self.size[0] as usize);
        let rows = frame.data_mut(0).chunks_mut(stride);
        for (row, own) in rows.zip(codes.chunks_exact(samples * width)) {
            for (to, own) in row
                .chunks_exact_mut(bytes * order.len())
                .zip(own.chunks_exact(samples))
            {
                let mut colours = [0; 4];
                for (colour, from) in colours.iter_mut().zip(order) {
                    *colour = word(own[*from]);
                }
                let colours = match self.colour {
                    ColorType::YCbCr(_) => red_green_blue(colours),
                    ColorType::CMYK(_) => without_ink(colours, word(own[3])),
                    _ => colours,
                };
                for (to, colour) in to.chunks_exact_mut(bytes).zip(colours) {
                    match is_small {
                        true => to[0] = (u32::from(colour) + 128).div_euclid(257) as u8,
                        false => to.copy_from_slice(&colour.to_le_bytes()),
                    }
                }
            }
        }
        Some(Ok(frame))
    }

    /// A frame of floating-point samples, which are light.
    fn floats(&self, codes: &[f32], head: &TiffHead) -> Option<Result<Video, Refusal>> {
        let (samples, order) = self.order()?;
        let is_light = matches!(
            self.colour,
            ColorType::Gray(_) | ColorType::RGB(_) | ColorType::RGBA(_)
        );
        if !is_light || codes.len() < samples * self.size[0] as usize * self.size[1] as usize {
            return None;
        }
        let finite = || codes.iter().copied().filter(|it| it.is_finite());
        let least = finite().fold(f32::INFINITY, f32::min);
        let most = finite().fold(f32::NEG_INFINITY, f32::max);
        let bright = finite().filter(|it| *it > 1.0).count() as f64 / codes.len().max(1) as f64;
        if least < LEAST_LIGHT || bright > MOST_BRIGHT {
            let found = format!(
                "{} from {least} to {most}, not of light from 0 to 1",
                head.kind()
            );
            return Some(Err(Refusal::Kind(found, SCALE)));
        }
        let (format, planes): (_, &[usize]) = match (samples, order.len()) {
            (1, _) => (Pixel::GRAYF32LE, &[0]),
            (_, 4) => (Pixel::GBRAPF32LE, &[2, 0, 1, 3]),
            _ => (Pixel::GBRPF32LE, &[2, 0, 1]),
        };
        let mut frame = match new_frame(format, self.size) {
            Ok(frame) => frame,
            Err(why) => return Some(Err(Refusal::Broken(why))),
        };
        for (plane, from) in planes.iter().zip(order) {
            let stride = frame.stride(*plane);
            let rows = frame.data_mut(*plane).chunks_mut(stride);
            let width = self.size[0] as usize;
            for (row, own) in rows.zip(codes.chunks_exact(samples * width)) {
                for (to, own) in row.chunks_exact_mut(4).zip(own.chunks_exact(samples)) {
                    // Colours are handed on multiplied by alpha.
                    let alpha = if order.len() == 4 && *from < 3 {
                        own[3]
                    } else {
                        1.0
                    };
                    to.copy_from_slice(&(own[*from] * alpha).to_le_bytes());
                }
            }
        }
        Some(Ok(frame))
    }
}

/// Of luma and chroma as JPEG has them (ITU-T T.871), of 16 bits.
fn red_green_blue([y, cb, cr, alpha]: [u16; 4]) -> [u16; 4] {
    let [y, cb, cr] = [y, cb, cr].map(f64::from);
    let [cb, cr] = [cb, cr].map(|it| it - 128.0 * 257.0);
    let all = [
        y + 1.402 * cr,
        y - 0.344_136 * cb - 0.714_136 * cr,
        y + 1.772 * cb,
    ];
    let [r, g, b] = all.map(|it| it.round().clamp(0.0, 65_535.0) as u16);
    [r, g, b, alpha]
}

/// Of cyan, magenta, yellow and black.
fn without_ink([c, m, y, _]: [u16; 4], black: u16) -> [u16; 4] {
    let light = |ink: u16| {
        let product = u32::from(u16::MAX - ink) * u32::from(u16::MAX - black);
        (product / u32::from(u16::MAX)) as u16
    };
    [light(c), light(m), light(y), 0]
}
