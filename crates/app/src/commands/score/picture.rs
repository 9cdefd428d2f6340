//! How does a picture file become samples, all of its bits kept?

use crate::report::output;
use anyhow::{Context, bail};
use foveal_eval::score::ScorePicture;
use foveal_eval::score::picture::Samples;
use foveal_media::plain_file::{first_bytes, open_plain};
use foveal_media::{SourceInfo, VideoInput};
use foveal_render::RgbaImage;
use png::{BitDepth, ColorType, Transformations};
use std::io::BufReader;
use std::path::Path;

/// Most pixels of a picture: 16K by 8K.
const MOST_PIXELS: u64 = 1 << 27;
/// What a PNG file begins with.
const PNG_HEAD: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Reads a picture: PNG of any colour type and depth, anything else as FFmpeg gives it.
pub(crate) fn read_picture(path: &Path) -> anyhow::Result<ScorePicture> {
    if is_png(path) {
        return read_png(path);
    }
    let mut input = VideoInput::open(path)?;
    check_source(path, input.info())?;
    let colour = input.info().colour;
    match input.next_frame()? {
        Some(frame) => from_image(&RgbaImage::from_planes(&frame.picture, colour)),
        None => bail!("{}: holds no picture", path.display()),
    }
}

/// Refuses what FFmpeg would bring to 8-bit codes as what it is not.
pub(crate) fn check_source(path: &Path, about: &SourceInfo) -> anyhow::Result<()> {
    let (name, format) = (path.display(), &about.pixel_format);
    if is_floating(format) {
        bail!(
            "{name}: its samples ({format}) are floating point: light or codes, numbers or none; \
             write it as PNG with 16 bits"
        );
    }
    match about.transparency {
        Some(_) if about.looks_still => bail!(
            "{name}: has transparency ({format}), and colour depends on what lies behind; flatten \
             it, or write it as an opaque PNG"
        ),
        Some(what) => output::say(&format!("warning: {name}: {}", what.words())),
        None => {}
    }
    Ok(())
}

/// Whether a pixel format by FFmpeg's name has floating point samples, as `gbrpf32le`.
fn is_floating(format: &str) -> bool {
    ["f16", "f32"].iter().any(|kind| format.contains(kind))
}

/// Whether a file is PNG by its first bytes.
pub(crate) fn is_png(path: &Path) -> bool {
    first_bytes(path, PNG_HEAD.len() as u64).is_ok_and(|head| head == PNG_HEAD)
}

/// A picture that was drawn, without its alpha.
pub(crate) fn from_image(image: &RgbaImage) -> anyhow::Result<ScorePicture> {
    let rgb = image
        .pixels
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]]);
    Ok(ScorePicture::from_rgb8(image.size, rgb.collect())?)
}

fn read_png(path: &Path) -> anyhow::Result<ScorePicture> {
    let name = path.display();
    let (file, _) = open_plain(path).with_context(|| format!("{name}: cannot be opened"))?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    let damaged = || format!("{name}: the PNG file is damaged; write it again");
    let mut reader = decoder.read_info().with_context(damaged)?;
    let size = [reader.info().width, reader.info().height];
    if u64::from(size[0]) * u64::from(size[1]) > MOST_PIXELS {
        bail!(
            "{name}: {}x{} pixels; give at most {MOST_PIXELS}",
            size[0],
            size[1]
        );
    }
    let mut bytes = vec![0; reader.output_buffer_size().with_context(damaged)?];
    let frame = reader.next_frame(&mut bytes).with_context(damaged)?;
    bytes.truncate(frame.buffer_size());
    let samples = match frame.bit_depth {
        BitDepth::Sixteen => {
            let pairs = bytes.chunks_exact(2);
            let codes: Vec<u16> = pairs.map(|b| u16::from_be_bytes([b[0], b[1]])).collect();
            Samples::Bits16(rgb_of(&codes, frame.color_type, u16::MAX, path)?)
        }
        _ => Samples::Bits8(rgb_of(&bytes, frame.color_type, u8::MAX, path)?),
    };
    ScorePicture::new(size, samples).with_context(damaged)
}

/// Red, green and blue of samples of any colour type; refuses what is not opaque.
fn rgb_of<T: Copy + PartialEq>(
    samples: &[T],
    kind: ColorType,
    opaque: T,
    path: &Path,
) -> anyhow::Result<Vec<T>> {
    let channels = kind.samples();
    let has_alpha = channels.is_multiple_of(2);
    if has_alpha
        && samples
            .chunks_exact(channels)
            .any(|p| p[channels - 1] != opaque)
    {
        bail!(
            "{}: has transparent pixels, whose colour depends on what lies behind; flatten it, as \
             with `magick FILE -background black -flatten OUT`",
            path.display()
        );
    }
    let rgb = |p: &[T]| {
        if channels < 3 {
            [p[0]; 3]
        } else {
            [p[0], p[1], p[2]]
        }
    };
    Ok(samples.chunks_exact(channels).flat_map(rgb).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floating_point_is_told_by_the_name_of_a_format() {
        for format in [
            "gbrpf32le",
            "gbrapf32be",
            "grayf32le",
            "rgbaf16le",
            "yaf16be",
        ] {
            assert!(is_floating(format), "{format}");
        }
        for format in [
            "yuv420p",
            "gray16le",
            "rgb48be",
            "nv16",
            "p016le",
            "yuv444p16le",
            "pal8",
        ] {
            assert!(!is_floating(format), "{format}");
        }
    }
}
