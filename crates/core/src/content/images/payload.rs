//! What do the bytes of a page of a texture say?
//!
//! In order, numbers little-endian: a byte with the version in its high four bits and the codec in
//! its low ones (0 JPEG, 1 PNG), the level, the texture and the page's column and row in two bytes
//! each, then the file of the page with its border. Normative: docs/formats/pack.md.

use super::picture::TexturePicture;
use super::shape::{BORDER, PagePlace, SLOT_SIDE, TextureShape};
use crate::content::scene::description::SceneTexture;
use crate::pack::PackError;
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};
use std::io::Cursor;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Version of the layout.
const VERSION: u8 = 1;
/// Bytes before the file.
const HEAD_BYTES: usize = 8;
/// Most bytes that reading a page's PNG allocates.
const MOST_PNG_BYTES: usize = 4 << 20;

/// How the texels of a page are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PageCodec {
    /// Baseline JPEG, 4:4:4, full range; opaque.
    Jpeg,
    /// PNG of eight bits a channel, with alpha or without.
    Png,
}

/// A page of a texture of a scene, with its border.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImagePage {
    /// Number of the texture in the scene's description.
    pub texture: u16,
    /// Which of its pages.
    pub page: PagePlace,
    /// Its texels, with a border of one on each side.
    pub picture: TexturePicture,
}

fn wrong(what: &str, found: impl ToString, expected: impl ToString) -> PackError {
    PackError {
        field: format!("page of a texture, {what}"),
        found: found.to_string(),
        expected: expected.to_string(),
    }
}

/// The payload of a page whose texels are in `file`.
#[must_use]
pub fn page_bytes(texture: u16, page: PagePlace, codec: PageCodec, file: &[u8]) -> Vec<u8> {
    let codec = match codec {
        PageCodec::Jpeg => 0,
        PageCodec::Png => 1,
    };
    let mut bytes = vec![VERSION << 4 | codec, page.level];
    let [column, row] = page.place;
    bytes.extend(
        [texture, column, row]
            .iter()
            .flat_map(|it| it.to_le_bytes()),
    );
    bytes.extend(file);
    bytes
}

impl ImagePage {
    /// Reads a page of one of these textures; takes about a millisecond.
    ///
    /// # Errors
    /// The bytes are no such page.
    pub fn parse(bytes: &[u8], textures: &[SceneTexture]) -> Result<Self, PackError> {
        let Some((head, file)) = bytes.split_at_checked(HEAD_BYTES) else {
            return Err(wrong("head", format!("{} bytes", bytes.len()), HEAD_BYTES));
        };
        if head[0] >> 4 != VERSION {
            return Err(wrong("version", head[0] >> 4, VERSION));
        }
        let [texture, column, row] =
            [2, 4, 6].map(|at| u16::from_le_bytes([head[at], head[at + 1]]));
        let page = PagePlace {
            level: head[1],
            place: [column, row],
        };
        let Some(of) = textures.get(usize::from(texture)) else {
            let expected = format!("fewer than {}", textures.len());
            return Err(wrong("texture", texture, expected));
        };
        let shape = TextureShape { size: of.size };
        let Some(inner) = shape.page_size(page) else {
            return Err(wrong("place", format!("{page:?}"), "one of the texture's"));
        };
        let size = inner.map(|side| side + 2 * BORDER);
        let texels = match head[0] & 15 {
            0 => texels_of_jpeg(file, size)?,
            1 => texels_of_png(file, size)?,
            codec => return Err(wrong("codec", codec, "0, a JPEG, or 1, a PNG")),
        };
        Ok(Self {
            texture,
            page,
            picture: TexturePicture { size, texels },
        })
    }
}

fn check_size(found: [usize; 2], size: [u32; 2]) -> Result<(), PackError> {
    match found == size.map(|side| side as usize) {
        true => Ok(()),
        false => Err(wrong("size", format!("{found:?}"), format!("{size:?}"))),
    }
}

fn texels_of_jpeg(file: &[u8], size: [u32; 2]) -> Result<Vec<[u8; 4]>, PackError> {
    let refused = |error| wrong("JPEG", format!("{error:?}"), "a whole picture");
    let options = DecoderOptions::new_safe()
        .set_max_width(SLOT_SIDE as usize)
        .set_max_height(SLOT_SIDE as usize)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(file), options);
    decoder.decode_headers().map_err(refused)?;
    let found = decoder.dimensions().unwrap_or_default();
    check_size([found.0, found.1], size)?;
    let rgb = decoder.decode().map_err(refused)?;
    texels_of(&rgb, size)
}

fn texels_of_png(file: &[u8], size: [u32; 2]) -> Result<Vec<[u8; 4]>, PackError> {
    let refused = |error| wrong("PNG", error, "a whole picture");
    let limits = Limits {
        bytes: MOST_PNG_BYTES,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(file), limits);
    decoder.set_transformations(Transformations::IDENTITY);
    let mut reader = decoder.read_info().map_err(refused)?;
    let about = reader.info();
    check_size([about.width as usize, about.height as usize], size)?;
    let kind = (about.color_type, about.bit_depth);
    if !matches!(kind, (ColorType::Rgb | ColorType::Rgba, BitDepth::Eight)) {
        return Err(wrong(
            "PNG",
            format!("{kind:?}"),
            "eight bits of RGB or RGBA",
        ));
    }
    let mut raw = vec![0; reader.output_buffer_size().unwrap_or(0)];
    reader.next_frame(&mut raw).map_err(refused)?;
    match kind.0 {
        ColorType::Rgba => Ok(raw.as_chunks().0.to_vec()),
        _ => texels_of(&raw, size),
    }
}

fn texels_of(rgb: &[u8], size: [u32; 2]) -> Result<Vec<[u8; 4]>, PackError> {
    let texels: Vec<[u8; 4]> = rgb
        .as_chunks()
        .0
        .iter()
        .map(|[r, g, b]| [*r, *g, *b, 255])
        .collect();
    match texels.len() == size[0] as usize * size[1] as usize {
        true => Ok(texels),
        false => Err(wrong("texels", texels.len(), format!("{size:?}"))),
    }
}
