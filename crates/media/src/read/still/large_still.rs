//! How is a still read that is too large for FFmpeg?
//!
//! FFmpeg refuses pictures beyond 268 million pixels. PNG is read row by row, JPEG at once; both
//! become planes two rows at a time, so that nothing larger than the file's own samples is held.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use foveal_core::units::counted;
use foveal_core::view::picture::{Colour, Matrix, Picture};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::error::MediaError;
use crate::plain_file::open_plain;
use crate::read::deliver::over;
use crate::read::source::SourceInfo;
use crate::read::still::still_tags::StillTags;
use crate::write::picture_from_rgba::PlanesOfRows;

/// Most pixels of a picture, with its margin of 128 a side, that FFmpeg's decoders take.
const MOST_OF_FFMPEG: u64 = (i32::MAX / 8) as u64;
/// Most pixels of a still: the planes of one take 1.5 GiB.
const MOST_PIXELS: u64 = 1 << 30;
/// Longest side of a still in pixels.
const MOST_SIDE: usize = 1 << 17;
/// How its planes are made of red, green and blue: as FFmpeg's are.
const COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: false,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Png,
    Jpeg,
}

/// An open still, read once.
pub(crate) struct LargeStill {
    path: PathBuf,
    kind: Kind,
    info: SourceInfo,
    is_read: bool,
    has_seen_through: bool,
}

impl LargeStill {
    /// Opens a PNG or JPEG file that FFmpeg would refuse for its size; `None` for any other file.
    pub(crate) fn open(path: &Path) -> Result<Option<Self>, MediaError> {
        let Some(still) = Self::open_any(path) else {
            return Ok(None);
        };
        let [w, h] = [still.info.width, still.info.height].map(u64::from);
        if (w + 128) * (h + 128) < MOST_OF_FFMPEG {
            return Ok(None);
        }
        if w * h > MOST_PIXELS {
            return Err(MediaError::Unsupported {
                path: path.to_owned(),
                field: "the picture's size",
                found: format!("{w}x{h} pixels, more than {MOST_PIXELS}"),
                next: "scale it down first",
            });
        }
        Ok(Some(still))
    }

    /// Opens a PNG or JPEG file of any size; `None` where its head is of neither.
    pub(crate) fn open_any(path: &Path) -> Option<Self> {
        let bytes = std::fs::metadata(path).ok()?.len();
        let png = || Some((Kind::Png, head_of_png(path)?));
        let (kind, size) = png().or_else(|| Some((Kind::Jpeg, head_of_jpeg(path)?)))?;
        let codec = match kind {
            Kind::Png => "png",
            Kind::Jpeg => "mjpeg",
        };
        let mut tags = StillTags::of(path);
        tags.notes.extend(tags.power.map(|power| {
            format!(
                "its samples are light to the power of {power:.3} (gAMA), which is passed over in \
                 a picture as large: it looks darker or brighter than it is meant"
            )
        }));
        let size = tags.orientation.turned_size(size);
        let info = SourceInfo::of_still(size, COLOUR, (codec, "rgb24"), tags, bytes);
        Some(Self {
            path: path.to_owned(),
            kind,
            info,
            is_read: false,
            has_seen_through: false,
        })
    }

    /// Whether pixels of it, once read, can be seen through.
    pub(crate) fn has_seen_through(&self) -> bool {
        self.has_seen_through
    }

    /// What is known of it.
    pub(crate) fn info(&self) -> &SourceInfo {
        &self.info
    }

    /// The picture; `None` when it has been read. The error says what is wrong with the file.
    pub(crate) fn picture(&mut self) -> Result<Option<Picture>, MediaError> {
        if std::mem::replace(&mut self.is_read, true) {
            return Ok(None);
        }
        // Width and height change places back as they did.
        let orientation = self.info.tags.orientation;
        let size = orientation.turned_size([self.info.width, self.info.height]);
        let read = match self.kind {
            Kind::Png => read_png(&self.path, size, &mut self.has_seen_through),
            Kind::Jpeg => read_jpeg(&self.path, size),
        };
        let read = read.map(|picture| orientation.turned(picture));
        read.map(Some).map_err(|reason| MediaError::Broken {
            path: self.path.clone(),
            frame: 0,
            seconds: 0.0,
            reason,
        })
    }
}

/// Planes that grow by rows.
struct Planes {
    planes: PlanesOfRows,
    /// The even row that waits for the odd one.
    waiting: Vec<u8>,
    rows: u32,
}

impl Planes {
    fn new(size: [u32; 2]) -> Self {
        Self {
            planes: PlanesOfRows::new(size, COLOUR),
            waiting: Vec::new(),
            rows: 0,
        }
    }

    /// Appends a row of `channels` samples a pixel: grey, grey and alpha, RGB or RGBA.
    fn push(&mut self, row: &[u8], channels: usize) {
        self.rows += 1;
        if self.rows.is_multiple_of(2) {
            self.planes.push(&self.waiting, Some(row), channels);
        } else if self.rows == self.planes.picture.height {
            self.planes.push(row, None, channels);
        } else {
            self.waiting.clear();
            self.waiting.extend_from_slice(row);
        }
    }

    fn finish(self) -> Result<Picture, String> {
        let picture = self.planes.picture;
        if picture.is_consistent() {
            return Ok(picture);
        }
        let height = picture.height;
        Err(format!("{} of {height} came", counted(self.rows, "row")))
    }
}

fn png_reader(path: &Path) -> Option<png::Reader<BufReader<File>>> {
    let mut decoder = png::Decoder::new(BufReader::new(open_plain(path).ok()?.0));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    decoder.read_info().ok()
}

fn head_of_png(path: &Path) -> Option<[u32; 2]> {
    let reader = png_reader(path)?;
    Some([reader.info().width, reader.info().height])
}

fn read_png(path: &Path, size: [u32; 2], is_clear: &mut bool) -> Result<Picture, String> {
    let mut reader = png_reader(path).ok_or("its head changed while it was read")?;
    if reader.info().interlaced {
        return Err(
            "it is interlaced; save it without, as with `magick FILE -interlace none OUT`"
                .to_owned(),
        );
    }
    let channels = reader.output_color_type().0.samples();
    let mut planes = Planes::new(size);
    while planes.rows < size[1] {
        match reader.next_row().map_err(|e| e.to_string())? {
            Some(row) if channels.is_multiple_of(2) => {
                let mut pixels = row.data().chunks_exact(channels);
                *is_clear |= pixels.any(|pixel| pixel[channels - 1] < 255);
                planes.push(&over_black(row.data(), channels), channels);
            }
            Some(row) => planes.push(row.data(), channels),
            None => break,
        }
    }
    planes.finish()
}

/// What is seen before black of a row of pixels whose last sample is alpha.
fn over_black(row: &[u8], channels: usize) -> Vec<u8> {
    let pixels = row.chunks_exact(channels);
    let seen = pixels.flat_map(|pixel| {
        let alpha = pixel[channels - 1];
        pixel.iter().map(move |code| over(*code, 0, alpha))
    });
    seen.collect()
}

fn jpeg_decoder(path: &Path) -> Option<JpegDecoder<BufReader<File>>> {
    let options = DecoderOptions::new_safe()
        .set_max_width(MOST_SIDE)
        .set_max_height(MOST_SIDE)
        .set_strict_mode(true)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let file = BufReader::new(open_plain(path).ok()?.0);
    let mut decoder = JpegDecoder::new_with_options(file, options);
    decoder.decode_headers().ok()?;
    Some(decoder)
}

fn head_of_jpeg(path: &Path) -> Option<[u32; 2]> {
    let (w, h) = jpeg_decoder(path)?.dimensions()?;
    Some([u32::try_from(w).ok()?, u32::try_from(h).ok()?])
}

fn read_jpeg(path: &Path, size: [u32; 2]) -> Result<Picture, String> {
    let mut decoder = jpeg_decoder(path).ok_or("its head changed while it was read")?;
    let samples = decoder.decode().map_err(|e| e.to_string())?;
    let row = size[0] as usize * 3;
    if samples.len() != row * size[1] as usize {
        return Err(format!(
            "{} samples, not red, green and blue",
            samples.len()
        ));
    }
    let mut planes = Planes::new(size);
    samples
        .chunks_exact(row)
        .for_each(|row| planes.push(row, 3));
    planes.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VideoInput;
    use crate::tests::scenes::{Scratch, psnr, raw, write_raw};
    use av::format::Pixel;
    use ffmpeg_next as av;

    fn png(size: [u32; 2], color: png::ColorType, depth: png::BitDepth) -> Scratch {
        let path = Scratch::new("png");
        let file = File::create(&*path).unwrap();
        let mut encoder = png::Encoder::new(file, size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let count = size[0] as usize * color.samples() * depth as usize / 8;
        let wave = |at: usize| (128.0 + 100.0 * (at as f64 * 0.013).sin()) as u8;
        let bytes: Vec<u8> = (0..count * size[1] as usize).map(wave).collect();
        encoder
            .write_header()
            .unwrap()
            .write_image_data(&bytes)
            .unwrap();
        path
    }

    fn alone(path: &Path) -> Picture {
        LargeStill::open_any(path)
            .unwrap()
            .picture()
            .unwrap()
            .unwrap()
    }

    fn by_ffmpeg(path: &Path) -> Picture {
        VideoInput::open(path)
            .unwrap()
            .next_frame()
            .unwrap()
            .unwrap()
            .picture
    }

    #[test]
    fn a_still_read_without_ffmpeg_is_the_picture_that_ffmpeg_reads() {
        use png::{BitDepth, ColorType};
        for (color, depth) in [
            (ColorType::Grayscale, BitDepth::Eight),
            (ColorType::Rgb, BitDepth::Eight),
            (ColorType::Rgba, BitDepth::Eight),
            (ColorType::Rgb, BitDepth::Sixteen),
        ] {
            let path = png([301, 97], color, depth);
            let picture = alone(&path);
            assert!(picture.is_consistent() && LargeStill::open(&path).unwrap().is_none());
            if color != ColorType::Grayscale {
                let quality = psnr(&picture, &by_ffmpeg(&path));
                assert!(quality > 45.0, "{color:?} {depth:?}: {quality}");
            }
        }
    }

    #[test]
    fn a_jpeg_read_without_ffmpeg_has_its_colours() {
        let size = [160, 96];
        let fill = |_: u32, p: usize, x: usize, y: usize| [90 + x / 4 + y / 3, 110, 150][p] as u8;
        let path = write_raw(&raw("mjpeg", "jpg", Pixel::YUVJ420P, size), 1, fill);
        let (picture, source) = (alone(&path), by_ffmpeg(&path));
        assert_eq!([picture.width, picture.height], size);
        // Another range and matrix: only the order of brightness can be compared plainly.
        let [first, last] = [0, picture.planes[0].len() - 1];
        assert!(picture.planes[0][first] + 30 < picture.planes[0][last]);
        assert!(source.planes[0][first] + 30 < source.planes[0][last]);
        assert!(picture.planes[1][0] < 128 && picture.planes[2][0] > 128);
    }

    #[test]
    fn damaged_stills_are_refused_by_name_and_never_panic() {
        let jpeg = write_raw(
            &raw("mjpeg", "jpg", Pixel::YUVJ420P, [64, 48]),
            1,
            |_, _, x, y| (x * 3 + y) as u8,
        );
        let png = png([64, 48], png::ColorType::Rgb, png::BitDepth::Eight);
        for path in [png, jpeg] {
            let good = std::fs::read(&*path).unwrap();
            for turn in 0..200 {
                let mut bad = good.clone();
                let at = turn * 7919 % bad.len();
                bad[at] ^= 0xa5;
                bad.truncate(good.len() - turn * turn % good.len());
                let bad = Scratch::holding("png", &bad);
                if let Some(mut still) = LargeStill::open_any(&bad) {
                    let size = u64::from(still.info.width) * u64::from(still.info.height);
                    let read = if size < 1 << 20 {
                        still.picture()
                    } else {
                        Ok(None)
                    };
                    if let Err(error) = read {
                        assert!(error.to_string().contains("broken at frame 0"), "{error}");
                    }
                }
            }
        }
    }
}
