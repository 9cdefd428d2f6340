//! How does a drawn picture reach a file?

use crate::output::write_whole;
use foveal_render::RgbaImage;
use png::Compression;
use std::path::Path;

/// Writes a picture as PNG, without its alpha, whole or not at all.
pub(crate) fn write_png(path: &Path, image: &RgbaImage) -> anyhow::Result<()> {
    let mut bytes = Vec::new();
    encode_png(image, Compression::Fast, &mut bytes)?;
    write_whole(path, &bytes)
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
    encoder.set_color(png::ColorType::Rgb);
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
