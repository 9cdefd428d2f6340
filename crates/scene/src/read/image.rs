//! How is the picture of a texture read, and which are too large to be?
//!
//! Row by row where its format has rows. What can only be decoded whole, all but a PNG whose rows
//! are not interlaced, takes memory for all of it and may be no larger than that allows.

mod bmp;
pub(super) mod hidden;
pub(super) mod pictures;
mod tga;
pub(super) mod transparent;
mod webp;

use foveal_core::content::images::shape::MOST_SIDE;
use foveal_core::units::counted;
use png::{ColorType, Decoder, Limits, Reader, Transformations};
use std::fmt;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Most texels of a picture.
const MOST_TEXELS: u64 = 1 << 28;
/// Most texels that a byte of a file can hold: of a PNG's deflate, which packs 1032 to 1, at eight
/// texels a byte, and of a progressive JPEG of one colour.
const MOST_TEXELS_A_BYTE: u64 = 1 << 14;
/// So many may always be: a WebP of one colour has some dozens of bytes.
const MOST_FREE_TEXELS: u64 = 1 << 22;
/// Bytes that a picture may take that is decoded whole, besides eight for each of its file.
const MOST_WHOLE: u64 = 220 << 20;
const MOST_WHOLE_A_BYTE: u64 = 8;
/// What a PNG's decoder may allocate besides the picture.
const MOST_PNG_BYTES: usize = 64 << 20;
/// Columns and rows that are read of any head.
const MOST_TOLD: usize = 65_535;
/// Bytes of memory a texel, of what is decoded whole: of a TGA as stored and as shown; of
/// a BMP as its runs give it, and as shown; of a WebP also the planes or transforms of its
/// codec, and what an animation is drawn on.
const BYTES_OF_TGA: u64 = 8;
const BYTES_OF_BMP: u64 = 5;
const BYTES_OF_WEBP: u64 = 12;

/// The first bytes of every PNG.
const PNG: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Why bytes are no picture that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFault {
    /// They are not a format that is read, or end in their head; of which other format, where that
    /// is known.
    NotOne(Option<&'static str>),
    /// It has another number of columns and rows than a texture can have.
    Size([u32; 2]),
    /// So many texels do not fit into so many bytes.
    Claims([u32; 2], u64),
    /// It can only be decoded whole, and takes more than the second number of bytes.
    Whole([u32; 2], u64),
}

impl fmt::Display for PictureFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotOne(None) => write!(out, "is no whole PNG, JPEG, WebP, BMP or TGA"),
            Self::NotOne(Some(other)) => {
                write!(out, "is {other}, which is not read: save it as PNG or JPEG")
            }
            Self::Size([columns, rows]) => write!(
                out,
                "has {columns} x {rows} texels, and at most {MOST_SIDE} fit along a side: make it \
                 smaller"
            ),
            Self::Claims([columns, rows], bytes) => write!(
                out,
                "announces {columns} x {rows} texels, which do not fit into its {}",
                counted(*bytes, "byte")
            ),
            Self::Whole([columns, rows], most) => write!(
                out,
                "has {columns} x {rows} texels that can only be decoded at once, in more than \
                 {} MB: save it as a PNG that is not interlaced, or smaller",
                most / 1_000_000
            ),
        }
    }
}

/// Columns and rows of a picture; `None` where the bytes are no picture, or too large a one.
/// Allocates nothing for the picture.
pub(crate) fn size_of(bytes: &[u8]) -> Option<[u32; 2]> {
    measured(bytes).ok()
}

/// The same, with what is wrong.
pub(crate) fn measured(bytes: &[u8]) -> Result<[u32; 2], PictureFault> {
    let header = image_header(bytes).ok_or_else(|| PictureFault::NotOne(other_format(bytes)))?;
    let size = header.size;
    let texels = u64::from(size[0]) * u64::from(size[1]);
    if !size.iter().all(|side| (1..=MOST_SIDE).contains(side)) || texels > MOST_TEXELS {
        return Err(PictureFault::Size(size));
    }
    let file_bytes = bytes.len() as u64;
    if texels > MOST_FREE_TEXELS.max(file_bytes * MOST_TEXELS_A_BYTE) {
        return Err(PictureFault::Claims(size, file_bytes));
    }
    let most = MOST_WHOLE + MOST_WHOLE_A_BYTE * file_bytes;
    match texels * header.whole_bytes_a_texel > most {
        true => Err(PictureFault::Whole(size, most)),
        false => Ok(size),
    }
}

/// The format of a picture that is not read, by its first bytes.
fn other_format(bytes: &[u8]) -> Option<&'static str> {
    let begins: [(&[u8], &str); 12] = [
        (b"GIF8", "a GIF"),
        (b"DDS ", "a DDS"),
        (b"\xabKTX 20", "a KTX2"),
        (b"\xabKTX 11", "a KTX"),
        (b"II*\0", "a TIFF"),
        (b"MM\0*", "a TIFF"),
        (b"v/1\x01", "an OpenEXR"),
        (b"#?RADIANCE", "a Radiance HDR"),
        (b"8BPS", "a PSD"),
        (b"\0\0\0\x0cjP  ", "a JPEG 2000"),
        (b"sB", "a Basis Universal file"),
        (
            b"version https://git-lfs",
            "a pointer of Git LFS, whose file was not fetched",
        ),
    ];
    let begun = begins.iter().find(|(first, _)| bytes.starts_with(first));
    match (begun, bytes.get(4..12)) {
        (Some((_, name)), _) => Some(name),
        (None, Some(b"ftypavif" | b"ftypavis")) => Some("an AVIF"),
        (None, Some(b"ftypheic" | b"ftypheix" | b"ftypmif1")) => Some("a HEIC"),
        _ => None,
    }
}

/// Whether the header of a picture allows texels that are not opaque.
pub(crate) fn may_have_alpha(bytes: &[u8]) -> bool {
    let Some(header) = image_header(bytes).filter(|_| size_of(bytes).is_some()) else {
        return false;
    };
    match header.format {
        Format::Jpeg => false,
        Format::Png => png_decoder(bytes).read_info().is_ok_and(|it| {
            matches!(
                it.output_color_type().0,
                ColorType::Rgba | ColorType::GrayscaleAlpha
            )
        }),
        Format::Bmp | Format::WebP | Format::Tga => true,
    }
}

/// All samples of a picture, and how many a texel has.
type Samples = (Vec<u8>, ColorType);

/// Whether a picture moves, so that only its first one is shown.
pub(crate) fn is_animated(bytes: &[u8]) -> bool {
    webp::is_animated(bytes)
}

/// What is wrong with a picture that is shown all the same.
pub(crate) fn damage(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(&PNG) {
        return damage_of_png(&bytes[PNG.len()..]);
    }
    let is_clear = || catch_unwind(AssertUnwindSafe(|| tga::is_clear(bytes))).unwrap_or(false);
    let is_tga = image_header(bytes).is_some_and(|it| it.format == Format::Tga);
    (is_tga && is_clear()).then_some("has an alpha of 0 everywhere, and is shown opaque")
}

/// What is wrong with chunks of a PNG, each a length, four letters, contents and a sum (ISO 15948).
fn damage_of_png(chunks: &[u8]) -> Option<&'static str> {
    let mut rest = chunks;
    while let Some((head, behind)) = rest.split_at_checked(8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let chunk = behind.split_at_checked(length);
        let Some((contents, (sum, behind))) =
            chunk.and_then(|(contents, behind)| Some((contents, behind.split_at_checked(4)?)))
        else {
            break;
        };
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&head[4..]);
        hasher.update(contents);
        if sum != hasher.finalize().to_be_bytes() {
            return Some("has sums that do not fit to its bytes, and may show damage");
        }
        if &head[4..] == b"IEND" {
            return None;
        }
        rest = behind;
    }
    Some("lacks its end, or a part of it")
}

/// How a picture is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Jpeg,
    Bmp,
    WebP,
    Tga,
}

/// What the head of a picture says.
struct ImageHeader {
    format: Format,
    size: [u32; 2],
    /// Bytes of a texel where all of them are in memory at once; 0 where they need not be.
    whole_bytes_a_texel: u64,
}

fn image_header(bytes: &[u8]) -> Option<ImageHeader> {
    if bytes.starts_with(&PNG) {
        let reader = png_decoder(bytes).read_info().ok()?;
        let about = reader.info();
        return Some(ImageHeader {
            format: Format::Png,
            size: [about.width, about.height],
            whole_bytes_a_texel: if about.interlaced { 4 } else { 0 },
        });
    }
    let whole = |format, size, whole_bytes_a_texel| ImageHeader {
        format,
        size,
        whole_bytes_a_texel,
    };
    if bytes.starts_with(b"\xff\xd8") {
        return jpeg(bytes);
    }
    if let Some(size) = bmp::size(bytes) {
        return Some(whole(Format::Bmp, size, BYTES_OF_BMP));
    }
    if let Some(size) = webp::size(bytes) {
        return Some(whole(Format::WebP, size, BYTES_OF_WEBP));
    }
    let known = other_format(bytes).is_none();
    let size = known.then(|| tga::size(bytes)).flatten()?;
    Some(whole(Format::Tga, size, BYTES_OF_TGA))
}

fn jpeg(bytes: &[u8]) -> Option<ImageHeader> {
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), jpeg_options());
    decoder.decode_headers().ok()?;
    let about = decoder.info()?;
    // Of one in several passes, all coefficients too: two bytes of each component.
    let coefficients = match about.sof.is_sequential_dct() {
        true => 0,
        false => 2 * u64::from(about.components),
    };
    Some(ImageHeader {
        format: Format::Jpeg,
        size: [about.width, about.height].map(u32::from),
        whole_bytes_a_texel: 3 + coefficients,
    })
}

fn png_decoder(bytes: &[u8]) -> Decoder<Cursor<&[u8]>> {
    let limits = Limits {
        bytes: MOST_PNG_BYTES,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::normalize_to_color8());
    // Rows that come are shown, whatever the sums behind them say; `damage` counts these.
    decoder.ignore_checksums(true);
    decoder
}

fn jpeg_options() -> DecoderOptions {
    DecoderOptions::new_safe()
        .set_max_width(MOST_TOLD)
        .set_max_height(MOST_TOLD)
        .jpeg_set_out_colorspace(ColorSpace::RGB)
}

/// A picture whose rows come one after the other, from the top.
pub(crate) struct PictureRows<'a> {
    size: [u32; 2],
    next: u32,
    source: RowSource<'a>,
}

enum RowSource<'a> {
    Png(Box<Reader<Cursor<&'a [u8]>>>),
    /// All samples, and how many a texel has.
    Whole(Vec<u8>, ColorType),
}

impl<'a> PictureRows<'a> {
    /// Begins to read a picture; `None` where it is broken, or [`size_of`] finds no size.
    pub(crate) fn open(bytes: &'a [u8]) -> Option<Self> {
        let size = size_of(bytes)?;
        let whole = |decode: fn(&[u8]) -> Option<Samples>| {
            // A fault of a decoder is one of the picture; what it had made is dropped.
            let decoded = catch_unwind(AssertUnwindSafe(|| decode(bytes)));
            let (raw, kind) = decoded.ok().flatten()?;
            Some(RowSource::Whole(raw, kind))
        };
        let source = match image_header(bytes)?.format {
            Format::Png => {
                let mut reader = Box::new(png_decoder(bytes).read_info().ok()?);
                match reader.info().interlaced {
                    false => RowSource::Png(reader),
                    true => {
                        let mut raw = vec![0; reader.output_buffer_size()?];
                        let frame = reader.next_frame(&mut raw).ok()?;
                        raw.truncate(frame.buffer_size());
                        RowSource::Whole(raw, frame.color_type)
                    }
                }
            }
            Format::Jpeg => {
                // Otherwise what is missing would be grey.
                let options = jpeg_options().set_strict_mode(true);
                let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
                RowSource::Whole(decoder.decode().ok()?, ColorType::Rgb)
            }
            Format::Bmp => whole(|bytes| Some((bmp::decode(bytes)?, ColorType::Rgba)))?,
            Format::WebP => whole(webp::decode)?,
            Format::Tga => whole(|bytes| Some((tga::decode(bytes)?, ColorType::Rgba)))?,
        };
        Some(Self {
            size,
            next: 0,
            source,
        })
    }

    /// The texels of up to so many rows more, row by row; none after the last. `None` where the
    /// picture is broken there.
    pub(crate) fn next(&mut self, rows: u32) -> Option<Vec<[u8; 4]>> {
        let [columns, all] = self.size.map(|side| side as usize);
        let first = self.next as usize;
        let count = (rows as usize).min(all - first);
        let mut texels = Vec::with_capacity(count * columns);
        match &mut self.source {
            RowSource::Png(reader) => {
                let kind = reader.output_color_type().0;
                for _ in 0..count {
                    let row = reader.next_row().ok()??;
                    add_texels(row.data(), kind, &mut texels)?;
                }
                let is_last = count > 0 && first + count == all;
                if is_last && matches!(reader.next_row(), Ok(Some(_))) {
                    return None;
                }
            }
            RowSource::Whole(raw, kind) => {
                let row_bytes = columns * kind.samples();
                let part = raw.get(first * row_bytes..(first + count) * row_bytes)?;
                add_texels(part, *kind, &mut texels)?;
            }
        }
        self.next += count as u32;
        (texels.len() == count * columns).then_some(texels)
    }
}

/// Adds the texels that samples of eight bits give.
fn add_texels(samples: &[u8], kind: ColorType, texels: &mut Vec<[u8; 4]>) -> Option<()> {
    let grey = |code: u8, alpha: u8| [code, code, code, alpha];
    match kind {
        ColorType::Rgba => texels.extend(samples.as_chunks::<4>().0),
        ColorType::Rgb => {
            let all = samples.as_chunks().0.iter();
            texels.extend(all.map(|[r, g, b]| [*r, *g, *b, 255]));
        }
        ColorType::Grayscale => texels.extend(samples.iter().map(|code| grey(*code, 255))),
        ColorType::GrayscaleAlpha => {
            let all = samples.as_chunks().0.iter();
            texels.extend(all.map(|[code, alpha]| grey(*code, *alpha)));
        }
        ColorType::Indexed => return None,
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All texels of a picture.
    fn decode(bytes: &[u8]) -> Option<Vec<[u8; 4]>> {
        let mut rows = PictureRows::open(bytes)?;
        let mut all = Vec::new();
        loop {
            match rows.next(3)? {
                some if some.is_empty() => return Some(all),
                some => all.extend(some),
            }
        }
    }

    fn png_of(size: [u32; 2], kind: ColorType, raw: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(kind);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(raw).unwrap();
        drop(writer);
        bytes
    }

    #[test]
    fn a_png_of_any_kind_becomes_its_texels() {
        let read = |kind, raw: &[u8]| decode(&png_of([1, 2], kind, raw)).unwrap();
        assert_eq!(
            read(ColorType::Grayscale, &[7, 8]),
            [[7, 7, 7, 255], [8, 8, 8, 255]]
        );
        let alpha = [7, 1, 8, 2];
        assert_eq!(
            read(ColorType::GrayscaleAlpha, &alpha),
            [[7, 7, 7, 1], [8, 8, 8, 2]]
        );
        let rgb = [1, 2, 3, 4, 5, 6];
        assert_eq!(read(ColorType::Rgb, &rgb), [[1, 2, 3, 255], [4, 5, 6, 255]]);
        let rgba = [1, 2, 3, 9, 4, 5, 6, 8];
        assert_eq!(read(ColorType::Rgba, &rgba), [[1, 2, 3, 9], [4, 5, 6, 8]]);
    }

    #[test]
    fn what_claims_to_be_huge_is_no_picture() {
        let good = png_of([1, 1], ColorType::Rgb, &[1, 2, 3]);
        for size in [[20_000_u32, 1], [16_384, 16_384], [0, 5]] {
            let mut bad = good.clone();
            bad[16..20].copy_from_slice(&size[0].to_be_bytes());
            bad[20..24].copy_from_slice(&size[1].to_be_bytes());
            let crc = crc_of_png(&bad[12..29]);
            bad[29..33].copy_from_slice(&crc.to_be_bytes());
            assert_eq!(size_of(&bad), None, "{size:?}");
            assert_eq!(decode(&bad), None);
        }
        let wide = png_of([100_000, 1], ColorType::Grayscale, &[9; 100_000]);
        let fault = measured(&wide).unwrap_err();
        assert!(fault.to_string().contains("100000 x 1 texels"), "{fault}");
        assert_eq!(size_of(b"\xff\xd8\xff\xc0 no picture"), None);
        assert_eq!(decode(&good[..good.len() - 30]), None);
    }

    #[test]
    fn a_png_whose_rows_all_come_is_shown_whatever_follows_and_that_is_told() {
        let good = png_of([1, 1], ColorType::Rgb, &[1, 2, 3]);
        assert_eq!(damage(&good), None);
        for end in [4, 12, 16] {
            let cut = &good[..good.len() - end];
            assert_eq!(decode(cut).unwrap(), [[1, 2, 3, 255]], "{end}");
            assert!(damage(cut).is_some_and(|it| it.contains("lacks its end")));
        }
        let mut wrong = good;
        let at = wrong.len() - 13;
        wrong[at] ^= 1;
        assert_eq!(decode(&wrong).unwrap(), [[1, 2, 3, 255]]);
        assert!(damage(&wrong).is_some_and(|it| it.contains("sums")));
    }

    /// The checksum of a chunk (ISO 3309).
    fn crc_of_png(bytes: &[u8]) -> u32 {
        let step = |crc: u32, byte: &u8| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                crc >> 1 ^ if crc & 1 > 0 { 0xedb8_8320 } else { 0 }
            })
        };
        !bytes.iter().fold(!0, step)
    }

    fn bmp_of(bits: u16, from_top: bool, texels: &[u8]) -> Vec<u8> {
        let mut file = b"BM".to_vec();
        let rows = if from_top { -2_i32 } else { 2 };
        file.extend(
            [54 + texels.len() as u32, 0, 54, 40, 2]
                .map(u32::to_le_bytes)
                .concat(),
        );
        file.extend(rows.to_le_bytes());
        file.extend([1, bits].map(u16::to_le_bytes).concat());
        file.extend([0; 24]);
        file.extend(texels);
        file
    }

    const RED: [u8; 4] = [255, 0, 0, 255];
    const BLUE: [u8; 4] = [0, 0, 255, 255];

    #[test]
    fn a_bmp_of_any_kind_becomes_its_texels() {
        let [red, blue] = [[0, 0, 255], [255, 0, 0]];
        let row = |texels: [[u8; 3]; 2]| [&texels.concat()[..], &[0; 2]].concat();
        let rows = [row([red, red]), row([blue, red])];
        let from_bottom = [&rows[1][..], &rows[0]].concat();
        let wide = |[b, g, r]: [u8; 3]| [b, g, r, 0];
        let clear = [blue, red, red, red].map(wide).concat();
        for (what, file) in [
            ("from the bottom", bmp_of(24, false, &from_bottom)),
            ("from the top", bmp_of(24, true, &rows.concat())),
            ("without any alpha", bmp_of(32, false, &clear)),
        ] {
            let texels = decode(&file);
            assert_eq!(
                texels.as_deref(),
                Some(&[RED, RED, BLUE, RED][..]),
                "{what}"
            );
            assert_eq!(decode(&file[..file.len() - 9]), None, "{what}, cut");
        }
    }

    fn webp_of(size: [u32; 2], texels: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let encoder = image_webp::WebPEncoder::new(&mut bytes);
        let [columns, rows] = size;
        encoder
            .encode(texels, columns, rows, image_webp::ColorType::Rgb8)
            .unwrap();
        bytes
    }

    #[test]
    fn a_webp_becomes_its_texels_and_one_that_claims_more_than_it_is_does_not() {
        let good = webp_of([2, 1], &[255, 0, 0, 0, 0, 255]);
        assert_eq!(decode(&good), Some(vec![RED, BLUE]));
        assert_eq!(decode(&good[..good.len() - 6]), None);
        // Of one colour it is small all the same.
        let large = webp_of([1500, 1500], &[7; 1500 * 1500 * 3]);
        assert_eq!(size_of(&large), Some([1500; 2]), "{} bytes", large.len());
        let mut bomb = good.clone();
        bomb[21..25].copy_from_slice(&0x0fff_ffff_u32.to_le_bytes());
        assert_eq!(
            measured(&bomb),
            Err(PictureFault::Claims([16_384; 2], bomb.len() as u64))
        );
        // A head that announces less than what follows.
        let mut hidden = b"RIFF\x2c\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\x01\0\0\0\0\0".to_vec();
        hidden.extend(&bomb[12..]);
        assert!(matches!(measured(&hidden), Err(PictureFault::Claims(..))));
    }

    #[test]
    fn no_damaged_picture_panics_or_has_other_texels_than_it_told() {
        let rows = [0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 0, 0];
        let mut tga = vec![0; 18];
        (tga[2], tga[12], tga[14], tga[16]) = (10, 2, 2, 24);
        tga.extend([0x83, 0, 0, 255]);
        let grey: Vec<u8> = (0..=255).collect();
        let files = [
            bmp_of(24, false, &rows),
            bmp_of(32, true, &rows),
            tga,
            webp_of([2, 1], &[255, 0, 0, 0, 0, 255]),
            webp_of([16, 16], &grey.repeat(3)),
            png_of([16, 16], ColorType::Grayscale, &grey),
        ];
        for file in files {
            assert!(crate::read::read_any_picture(&file));
            for end in 0..file.len() {
                crate::read::read_any_picture(&file[..end]);
            }
            for at in 0..file.len() {
                for flip in [0x01, 0x10, 0x80, 0xff] {
                    let mut changed = file.clone();
                    changed[at] ^= flip;
                    crate::read::read_any_picture(&changed);
                }
            }
        }
    }
}
