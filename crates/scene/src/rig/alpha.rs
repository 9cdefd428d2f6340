//! Which share of its light does a PNG give each pixel of a panel?

use std::io::Cursor;

use foveal_core::view::panel::alpha::AlphaMap;
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

/// Most bytes that a decoder may hold besides the picture.
const MOST_HELD: usize = 1 << 24;

/// Reads a PNG of `size` pixels, of which grey or red counts: to the power of `gamma` it is the
/// share of linear light.
pub(super) fn read(bytes: &[u8], size: [u32; 2], gamma: f64) -> Result<AlphaMap, String> {
    let (found, shares) = shares(bytes, u64::from(size[0]) * u64::from(size[1]), gamma)?;
    match found == size {
        true => Ok(AlphaMap::new(size, shares)),
        false => {
            let ([w, h], [columns, rows]) = (found, size);
            Err(format!(
                "is {w} x {h} pixels, and the panel {columns} x {rows}"
            ))
        }
    }
}

/// The same of a PNG of any size up to `most` pixels, resized to that of the panel, and the size
/// that it has.
pub(super) fn read_any(
    bytes: &[u8],
    size: [u32; 2],
    (most, gamma): (u64, f64),
) -> Result<(AlphaMap, [u32; 2]), String> {
    let (found, shares) = shares(bytes, most, gamma)?;
    let [w, h] = [found, size].map(|it| it.map(|side| side as usize));
    let shares = match found == size {
        true => shares,
        false => {
            let rows = resampled(&shares, w, h[0]);
            let turned = transposed(&rows, [h[0], w[1]]);
            let all = resampled(&turned, [w[1], h[0]], h[1]);
            transposed(&all, [h[1], h[0]])
        }
    };
    Ok((AlphaMap::new(size, shares), found))
}

/// Rows of `from[0]` values, of which there are `from[1]`, made `to` values long: between values it
/// changes evenly, and what is made fewer is averaged.
fn resampled(values: &[u16], from: [usize; 2], to: usize) -> Vec<u16> {
    let step = from[0] as f64 / to as f64;
    let reach = step.max(1.0);
    let last = from[0] - 1;
    let taps = (0..to).map(|at| {
        let middle = (at as f64 + 0.5) * step - 0.5;
        let first = (middle - reach).ceil();
        let count = (middle + reach).floor() - first;
        let weight = |k: usize| 1.0 - (first + k as f64 - middle).abs() / reach;
        let taps = (0..=count.max(0.0) as usize).map(|k| {
            let at = (first + k as f64).clamp(0.0, last as f64) as usize;
            (at, weight(k).max(0.0))
        });
        taps.collect::<Vec<_>>()
    });
    let taps: Vec<Vec<(usize, f64)>> = taps.collect();
    let of_row = |row: &[u16]| -> Vec<u16> {
        let of = |taps: &Vec<(usize, f64)>| {
            let sum: f64 = taps.iter().map(|(at, w)| f64::from(row[*at]) * w).sum();
            let whole: f64 = taps.iter().map(|(_, w)| w).sum();
            (sum / whole).round() as u16
        };
        taps.iter().map(of).collect()
    };
    values.chunks_exact(from[0]).flat_map(of_row).collect()
}

/// Columns become rows, of a picture of so many columns and rows.
fn transposed(values: &[u16], [w, h]: [usize; 2]) -> Vec<u16> {
    (0..w)
        .flat_map(|column| (0..h).map(move |row| values[row * w + column]))
        .collect()
}

/// Columns and rows of a PNG of at most so many pixels, and the share of linear light of each.
fn shares(bytes: &[u8], most: u64, gamma: f64) -> Result<([u32; 2], Vec<u16>), String> {
    let damaged = |error: png::DecodingError| format!("is not a sound PNG: {error}");
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST_HELD });
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let found = [reader.info().width, reader.info().height];
    let [w, h] = found.map(u64::from);
    if w * h > most {
        return Err(format!(
            "is {w} x {h} pixels, more than the {most} it can need"
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
    if shares.len() as u64 != w * h {
        return Err("has not a value for every pixel".to_owned());
    }
    Ok((found, shares))
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
