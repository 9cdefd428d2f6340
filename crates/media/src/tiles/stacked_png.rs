//! How does a picture of three planes lie in one grey PNG?
//!
//! The PNG is 8-bit grey, as wide as the picture, and as high as the picture plus twice its chroma
//! planes: the rows of Y, then those of U, then those of V. A chroma row begins at the left and is
//! filled up with zeros.

use std::io::Cursor;

use foveal_core::view::picture::{Picture, plane_size};

/// Bytes that a PNG reader may use beyond the picture itself, for its tables and text.
const READER_ALLOWANCE: usize = 1 << 20;

/// Height of the PNG that holds a picture of this size.
fn stacked_height([width, height]: [u32; 2]) -> u32 {
    height + 2 * plane_size(width, height, 1)[1]
}

/// The picture as a PNG file; lossless.
pub(crate) fn png_from_picture(
    picture: &Picture,
    compression: png::Compression,
) -> Result<Vec<u8>, String> {
    let size = [picture.width, picture.height];
    let row = picture.width as usize;
    let mut grey = Vec::with_capacity(row * stacked_height(size) as usize);
    for p in 0..3 {
        let width = picture.plane_size(p)[0] as usize;
        for samples in picture.planes[p].chunks_exact(width) {
            grey.extend_from_slice(samples);
            grey.resize(grey.len() + row - width, 0);
        }
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, picture.width, stacked_height(size));
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(compression);
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(&grey).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(file)
}

/// The picture of `size` that the PNG file holds; refuses any other size or format.
pub(crate) fn picture_from_png(file: &[u8], size: [u32; 2]) -> Result<Picture, String> {
    let row = size[0] as usize;
    let wanted = [size[0], stacked_height(size)];
    let bytes = row * wanted[1] as usize;
    let limits = png::Limits {
        bytes: 4 * bytes + READER_ALLOWANCE,
    };
    let decoder = png::Decoder::new_with_limits(Cursor::new(file), limits);
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let header = reader.info();
    if [header.width, header.height] != wanted {
        let [w, h] = wanted;
        return Err(format!(
            "the PNG is {} x {}, expected {w} x {h}",
            header.width, header.height
        ));
    }
    if reader.output_color_type() != (png::ColorType::Grayscale, png::BitDepth::Eight) {
        return Err(format!(
            "the PNG is {:?}, expected 8-bit grey",
            reader.output_color_type()
        ));
    }
    let mut grey = vec![0; bytes];
    reader.next_frame(&mut grey).map_err(|e| e.to_string())?;
    let mut rows = grey.chunks_exact(row);
    let planes = [0, 1, 2].map(|p| {
        let [w, h] = plane_size(size[0], size[1], p).map(|n| n as usize);
        rows.by_ref()
            .take(h)
            .flat_map(|samples| &samples[..w])
            .copied()
            .collect()
    });
    Ok(Picture {
        width: size[0],
        height: size[1],
        planes,
    })
}
