//! How does a picture get into a file and out of one?

use crate::report::output::{write_new, write_soon};
use anyhow::{Context, bail};
use foveal_media::plain_file::open_plain;
use foveal_render::RgbaImage;
use png::{ColorType, Compression, Transformations};
use std::io::BufReader;
use std::path::Path;

/// Writes a picture as PNG, without its alpha, whole or not at all.
pub(crate) fn write_png(path: &Path, image: &RgbaImage) -> anyhow::Result<()> {
    let mut bytes = Vec::new();
    encode_png(image, Compression::Fast, &mut bytes)?;
    write_soon(path, &bytes)
}

/// The same under a name that nothing has.
pub(crate) fn write_new_png(path: &Path, image: &RgbaImage) -> anyhow::Result<()> {
    let mut bytes = Vec::new();
    encode_png(image, Compression::Fast, &mut bytes)?;
    write_new(path, &bytes)
}

/// Most pixels of a picture that is read: 8K.
const MOST_PIXELS: u64 = 7680 * 4320;

/// A picture out of a file, without its alpha.
pub(crate) struct RgbPicture {
    /// Columns and rows.
    pub(crate) size: [u32; 2],
    /// 8-bit sRGB, row by row.
    pub(crate) rgb: Vec<[u8; 3]>,
}

impl RgbPicture {
    /// The same to draw on, opaque.
    pub(crate) fn image(&self) -> RgbaImage {
        let opaque = |&[r, g, b]: &[u8; 3]| [r, g, b, 255];
        RgbaImage {
            size: self.size,
            pixels: self.rgb.iter().flat_map(opaque).collect(),
        }
    }
}

/// Reads a PNG file of any colour type and depth.
pub(crate) fn read_png(path: &Path) -> anyhow::Result<RgbPicture> {
    let name = path.display();
    let (file, _) = open_plain(path).with_context(|| format!("{name}: no PNG file there"))?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let mut reader = decoder
        .read_info()
        .with_context(|| format!("{name}: no PNG file"))?;
    let [w, h] = [reader.info().width, reader.info().height];
    if u64::from(w) * u64::from(h) > MOST_PIXELS {
        bail!("{name}: {w}x{h} pixels; give a picture of at most {MOST_PIXELS} pixels");
    }
    let bytes = reader.output_buffer_size();
    let mut samples = vec![0; bytes.with_context(|| format!("{name}: too large"))?];
    let frame = reader.next_frame(&mut samples);
    let frame = frame.with_context(|| format!("{name}: the PNG file is damaged"))?;
    let rgb: Vec<[u8; 3]> = match frame.color_type {
        ColorType::Grayscale => samples.iter().map(|&g| [g; 3]).collect(),
        ColorType::GrayscaleAlpha => samples.chunks_exact(2).map(|p| [p[0]; 3]).collect(),
        ColorType::Rgba => samples
            .chunks_exact(4)
            .map(|p| [p[0], p[1], p[2]])
            .collect(),
        _ => samples
            .chunks_exact(3)
            .map(|p| [p[0], p[1], p[2]])
            .collect(),
    };
    if rgb.len() as u64 != u64::from(w) * u64::from(h) {
        bail!(
            "{name}: the PNG file is damaged: {} of {w}x{h} pixels",
            rgb.len()
        );
    }
    Ok(RgbPicture { size: [w, h], rgb })
}

/// A picture as the bytes of a PNG file, a third smaller than [`write_png`] makes it.
pub(crate) fn png_bytes(image: &RgbaImage) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_png(image, Compression::Balanced, &mut bytes)?;
    Ok(bytes)
}

fn encode_png(
    image: &RgbaImage,
    compression: Compression,
    out: impl std::io::Write,
) -> anyhow::Result<()> {
    let mut encoder = png::Encoder::new(out, image.size[0], image.size[1]);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(compression);
    let mut writer = encoder.write_header()?;
    let rgb: Vec<u8> = image
        .pixels
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    writer.write_image_data(&rgb)?;
    Ok(writer.finish()?)
}
