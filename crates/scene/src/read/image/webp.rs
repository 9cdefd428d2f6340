//! How large is a WebP picture, and what are its texels?
//!
//! `image-webp` decodes; the sizes in all of its chunks are read before, as it takes memory for
//! what they claim. Source: Google, "WebP Container Specification".

use image_webp::WebPDecoder;
use png::ColorType;
use std::io::Cursor;

/// Most chunks that are looked at; one of a still has five.
const MOST_CHUNKS: usize = 1 << 16;
/// Bytes of the header of an animation's frame before its chunks.
const FRAME_BYTES: usize = 16;

/// Columns and rows, as large as any chunk claims along each side; none of what is no WebP.
pub(super) fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    if bytes.get(..4)? != b"RIFF" || bytes.get(8..12)? != b"WEBP" {
        return None;
    }
    let mut size: Option<[u32; 2]> = None;
    for (name, says) in chunks(&bytes[12..]).take(MOST_CHUNKS) {
        let inner = match name {
            b"ANMF" => says.get(FRAME_BYTES..).unwrap_or_default(),
            _ => &[],
        };
        let found = chunks(inner).chain([(name, says)]);
        for claimed in found.filter_map(|(name, says)| claimed(name, says)) {
            let [columns, rows] = size.unwrap_or_default();
            size = Some([columns.max(claimed[0]), rows.max(claimed[1])]);
        }
    }
    size
}

/// Whether there are several pictures.
pub(super) fn is_animated(bytes: &[u8]) -> bool {
    size(bytes).is_some()
        && chunks(&bytes[12..])
            .take(MOST_CHUNKS)
            .any(|it| it.0 == b"ANMF")
}

/// All chunks, each with its name.
fn chunks(bytes: &[u8]) -> impl Iterator<Item = (&[u8], &[u8])> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let (name, behind) = rest.split_at_checked(4)?;
        let (length, behind) = behind.split_first_chunk::<4>()?;
        let length = u32::from_le_bytes(*length) as usize;
        let end = length.min(behind.len());
        rest = behind
            .get(length.checked_next_multiple_of(2)?..)
            .unwrap_or_default();
        Some((name, &behind[..end]))
    })
}

/// The size that a chunk claims.
fn claimed(name: &[u8], says: &[u8]) -> Option<[u32; 2]> {
    let word = |at: usize| Some(u32::from_le_bytes(*says.get(at..)?.first_chunk()?));
    match name {
        b"VP8X" => {
            let rows = says.get(7..10)?;
            let rows = u32::from_le_bytes([rows[0], rows[1], rows[2], 0]);
            Some([(word(4)? & 0xff_ffff) + 1, rows + 1])
        }
        b"VP8L" => {
            let both = word(1)?;
            Some([(both & 0x3fff) + 1, (both >> 14 & 0x3fff) + 1])
        }
        b"VP8 " => {
            let both = word(6)?;
            Some([both & 0x3fff, both >> 16 & 0x3fff])
        }
        _ => None,
    }
}

/// All samples, of an animation those of its first picture; none where it is broken.
pub(super) fn decode(bytes: &[u8]) -> Option<(Vec<u8>, ColorType)> {
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).ok()?;
    let told = size(bytes)?;
    let (columns, rows) = decoder.dimensions();
    if [columns, rows] != told {
        return None;
    }
    let mut raw = vec![0; decoder.output_buffer_size()?];
    decoder.read_image(&mut raw).ok()?;
    let kind = if decoder.has_alpha() {
        ColorType::Rgba
    } else {
        ColorType::Rgb
    };
    Some((raw, kind))
}
