//! How is the picture of a texture read?

use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::MOST_SIDE;
use png::{ColorType, Decoder, Limits, Transformations};
use std::io::Cursor;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Most texels of a picture.
const MOST_TEXELS: u64 = 1 << 28;
/// Most texels that a byte of a file can hold: of a PNG's deflate, which packs 1032 to 1, at eight
/// texels a byte, and of a progressive JPEG of one colour.
const MOST_TEXELS_A_BYTE: u64 = 1 << 14;
/// What a PNG's decoder may allocate beside the picture.
const MOST_PNG_BYTES: usize = 64 << 20;

/// The first bytes of every PNG.
const PNG: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Columns and rows of a JPEG or PNG; `None` where the bytes are neither, or of too large a
/// picture. Allocates nothing for the picture.
pub(crate) fn size_of(bytes: &[u8]) -> Option<[u32; 2]> {
    let size = match bytes.starts_with(&PNG) {
        true => {
            let reader = png_decoder(bytes).read_info().ok()?;
            [reader.info().width, reader.info().height]
        }
        false => {
            let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), jpeg_options());
            decoder.decode_headers().ok()?;
            let (columns, rows) = decoder.dimensions()?;
            [u32::try_from(columns).ok()?, u32::try_from(rows).ok()?]
        }
    };
    let texels = u64::from(size[0]) * u64::from(size[1]);
    let most = MOST_TEXELS.min(bytes.len() as u64 * MOST_TEXELS_A_BYTE);
    let fits = size.iter().all(|side| (1..=MOST_SIDE).contains(side)) && texels <= most;
    fits.then_some(size)
}

/// The picture of a JPEG or PNG; `None` where it is broken, or [`size_of`] tells no size.
pub(crate) fn decode(bytes: &[u8]) -> Option<TexturePicture> {
    let size = size_of(bytes)?;
    let texels = match bytes.starts_with(&PNG) {
        true => texels_of_png(bytes)?,
        false => texels_of_jpeg(bytes)?,
    };
    let is_whole = texels.len() == size[0] as usize * size[1] as usize;
    is_whole.then_some(TexturePicture { size, texels })
}

fn png_decoder(bytes: &[u8]) -> Decoder<Cursor<&[u8]>> {
    let limits = Limits {
        bytes: MOST_PNG_BYTES,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::normalize_to_color8());
    decoder
}

fn texels_of_png(bytes: &[u8]) -> Option<Vec<[u8; 4]>> {
    let mut reader = png_decoder(bytes).read_info().ok()?;
    let mut raw = vec![0; reader.output_buffer_size()?];
    let frame = reader.next_frame(&mut raw).ok()?;
    raw.truncate(frame.buffer_size());
    let grey = |code: u8, alpha: u8| [code, code, code, alpha];
    Some(match frame.color_type {
        ColorType::Rgba => raw.as_chunks().0.to_vec(),
        ColorType::Rgb => opaque(&raw),
        ColorType::Grayscale => raw.iter().map(|code| grey(*code, 255)).collect(),
        ColorType::GrayscaleAlpha => {
            let texels = raw.as_chunks().0.iter();
            texels.map(|[code, alpha]| grey(*code, *alpha)).collect()
        }
        ColorType::Indexed => return None,
    })
}

fn jpeg_options() -> DecoderOptions {
    DecoderOptions::new_safe()
        .set_max_width(MOST_SIDE as usize)
        .set_max_height(MOST_SIDE as usize)
        .jpeg_set_out_colorspace(ColorSpace::RGB)
}

fn texels_of_jpeg(bytes: &[u8]) -> Option<Vec<[u8; 4]>> {
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), jpeg_options());
    Some(opaque(&decoder.decode().ok()?))
}

fn opaque(rgb: &[u8]) -> Vec<[u8; 4]> {
    let texels = rgb.as_chunks().0.iter();
    texels.map(|[r, g, b]| [*r, *g, *b, 255]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let read = |kind, raw: &[u8]| decode(&png_of([1, 2], kind, raw)).unwrap().texels;
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
        assert_eq!(size_of(b"\xff\xd8\xff\xc0 no picture"), None);
        assert_eq!(decode(&good[..good.len() - 20]), None);
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
}
