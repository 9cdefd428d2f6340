//! Which share of its light does a PNG give each pixel of a panel?

use std::io::Cursor;

use foveal_core::view::panel::alpha::AlphaMap;
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

/// Most bytes that a decoder may hold beside the picture.
const MOST_HELD: usize = 1 << 24;

/// Reads a PNG of `size` pixels, of which grey or red counts: to the power of `gamma` it is the
/// share of linear light.
pub(super) fn read(bytes: &[u8], size: [u32; 2], gamma: f64) -> Result<AlphaMap, String> {
    let damaged = |error: png::DecodingError| format!("is no sound PNG: {error}");
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST_HELD });
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let found = [reader.info().width, reader.info().height];
    if found != size {
        let ([w, h], [columns, rows]) = (found, size);
        return Err(format!(
            "is {w} x {h} pixels, and the panel {columns} x {rows}"
        ));
    }
    let length = reader.output_buffer_size().ok_or("is too large")?;
    let mut samples = vec![0; length];
    let frame = reader.next_frame(&mut samples).map_err(damaged)?;
    let channels = match frame.color_type {
        ColorType::Grayscale | ColorType::Indexed => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
    };
    let is_deep = frame.bit_depth == BitDepth::Sixteen;
    let pixels = samples.chunks_exact(channels * if is_deep { 2 } else { 1 });
    let shares: Vec<u16> = pixels
        .map(|pixel| match is_deep {
            true => u16::from_be_bytes([pixel[0], pixel[1]]),
            false => u16::from(pixel[0]) * 257,
        })
        .map(|share| linear(share, gamma))
        .collect();
    if shares.len() != size[0] as usize * size[1] as usize {
        return Err("has not a value for every pixel".to_owned());
    }
    Ok(AlphaMap::new(size, shares))
}

fn linear(share: u16, gamma: f64) -> u16 {
    let most = f64::from(u16::MAX);
    match gamma == 1.0 {
        true => share,
        false => ((f64::from(share) / most).powf(gamma) * most).round() as u16,
    }
}

/// The same as a grey PNG of 16 bits, linear.
pub(super) fn written(alpha: &AlphaMap, size: [u32; 2]) -> Result<Vec<u8>, png::EncodingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size[0], size[1]);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    let bytes = alpha.shares().iter().flat_map(|it| it.to_be_bytes());
    writer.write_image_data(&bytes.collect::<Vec<u8>>())?;
    writer.finish()?;
    Ok(file)
}
