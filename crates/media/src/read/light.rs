//! How do samples that count light, or follow another curve, become those of a display?
//!
//! Displays expect the curve of sRGB (IEC 61966-2-1). OpenEXR, Radiance and float maps count light
//! itself; a PNG may name another power (gAMA).

use av::color::TransferCharacteristic;
use av::format::Pixel;
use av::frame::Video;
use ffmpeg_next as av;

use crate::read::convert::{Converter, Layout};
use crate::read::frame::{has_alpha, new_frame};

/// Largest value of a sample of 16 bits.
const FULL: f64 = 65_535.0;
/// A share of the pixels below this is none.
const FEW: f64 = 0.0005;

/// Formats of floating-point samples, and the planes that hold red, green, blue and alpha.
const FLOATS: [(Pixel, &[usize]); 6] = [
    (Pixel::GBRPF32LE, &[2, 0, 1]),
    (Pixel::GBRPF32BE, &[2, 0, 1]),
    (Pixel::GBRAPF32LE, &[2, 0, 1, 3]),
    (Pixel::GBRAPF32BE, &[2, 0, 1, 3]),
    (Pixel::GRAYF32LE, &[0, 0, 0]),
    (Pixel::GRAYF32BE, &[0, 0, 0]),
];

/// The planes of red, green, blue and alpha of a format of floating-point samples.
fn float_planes(format: Pixel) -> Option<&'static [usize]> {
    let found = FLOATS.iter().find(|it| it.0 == format);
    found.map(|it| it.1)
}

fn is_big_endian(format: Pixel) -> bool {
    [Pixel::GBRPF32BE, Pixel::GBRAPF32BE, Pixel::GRAYF32BE].contains(&format)
}

/// Makes frames whose samples are light to some power those of a display.
pub(crate) struct Lighting {
    /// A sample is light to this power; 1 where it is light itself.
    power: f64,
    /// What becomes of each sample of 16 bits.
    table: Vec<u16>,
    to_words: Option<Converter>,
}

impl Lighting {
    /// For frames like the first one of an input, and what a person should know of it; none for
    /// frames that follow the curve of displays already. `power` is what the file says of its
    /// samples, where FFmpeg does not.
    pub(crate) fn of(first: &Video, power: Option<f64>) -> Option<(Self, String)> {
        use TransferCharacteristic::{Linear, Unspecified};
        let told = first.color_transfer_characteristic();
        let is_float = float_planes(first.format()).is_some();
        let counts_light = is_float && matches!(told, Unspecified | Linear);
        let power = match power {
            None if counts_light || is_rgb(first.format()) && told == Linear => 1.0,
            power => power?,
        };
        let table = (0..=u16::MAX).map(|code| to_word(shown(f64::from(code) / FULL, power)));
        let lighting = Self {
            power,
            table: table.collect(),
            to_words: None,
        };
        let note = match power == 1.0 {
            true => "its samples count light itself (linear): converted to sRGB".to_owned(),
            false => format!(
                "its samples are light to the power of {power:.3} (gAMA): converted to sRGB"
            ),
        };
        let odd = Odd::of(first);
        Some((lighting, note + &odd.told()))
    }

    /// The frame, whose layout is `from`, in red, green, blue and alpha of 16 bits.
    pub(crate) fn frame(&mut self, frame: &Video, from: Layout) -> Result<Video, String> {
        if let Some(planes) = float_planes(frame.format()) {
            return self.of_floats(frame, planes);
        }
        let has_alpha = has_alpha(frame);
        let to = Layout {
            format: match has_alpha {
                true => Pixel::RGBA64LE,
                false => Pixel::RGB48LE,
            },
            full_range: true,
            ..from
        };
        if self.to_words.as_ref().is_none_or(|it| it.from() != from) {
            self.to_words = Some(Converter::new(from, to)?);
        }
        let Some(converter) = &mut self.to_words else {
            return Err("a conversion is missing".to_owned());
        };
        let mut words = converter.run(frame)?;
        let (stride, samples) = (words.stride(0), if has_alpha { 4 } else { 3 });
        for row in words.data_mut(0).chunks_mut(stride) {
            for pixel in row[..from.size[0] as usize * samples * 2].chunks_exact_mut(2 * samples) {
                for code in pixel.chunks_exact_mut(2).take(3) {
                    let word = self.table[usize::from(u16::from_le_bytes([code[0], code[1]]))];
                    code.copy_from_slice(&word.to_le_bytes());
                }
            }
        }
        Ok(words)
    }

    /// Where there is alpha, colours are multiplied by it, and so they look over black.
    fn of_floats(&self, frame: &Video, planes: &[usize]) -> Result<Video, String> {
        let [w, h] = [frame.width(), frame.height()];
        let mut words = new_frame(Pixel::RGB48LE, [w, h])?;
        let stride = words.stride(0);
        let rows = words.data_mut(0).chunks_mut(stride).take(h as usize);
        for (y, row) in rows.enumerate() {
            for (x, pixel) in row.chunks_exact_mut(6).enumerate().take(w as usize) {
                for (code, plane) in pixel.chunks_exact_mut(2).zip(planes) {
                    let value = f64::from(float_at(frame, *plane, [x, y]));
                    let word = to_word(shown(value, self.power));
                    code.copy_from_slice(&word.to_le_bytes());
                }
            }
        }
        Ok(words)
    }
}

fn float_at(frame: &Video, plane: usize, [x, y]: [usize; 2]) -> f32 {
    let at = y * frame.stride(plane) + 4 * x;
    let four = frame
        .data(plane)
        .get(at..)
        .and_then(|it| it.first_chunk::<4>());
    let four = four.copied().unwrap_or_default();
    match is_big_endian(frame.format()) {
        true => f32::from_be_bytes(four),
        false => f32::from_le_bytes(four),
    }
}

/// Shares of the pixels of a frame of floating-point samples that displays cannot show.
#[derive(Default)]
struct Odd {
    /// Brighter than white, or not a number.
    bright: f64,
    missing: f64,
    is_clear: bool,
}

impl Odd {
    fn of(frame: &Video) -> Self {
        let Some(planes) = float_planes(frame.format()) else {
            return Self::default();
        };
        let [w, h] = [frame.width() as usize, frame.height() as usize];
        let one = 1.0 / (w * h).max(1) as f64;
        let mut odd = Self::default();
        for at in (0..h).flat_map(|y| (0..w).map(move |x| [x, y])) {
            let sample = |plane: &usize| float_at(frame, *plane, at);
            let colours = &planes[..3];
            odd.bright += one * f64::from(u8::from(colours.iter().any(|it| sample(it) > 1.0)));
            odd.missing += one * f64::from(u8::from(colours.iter().any(|it| sample(it).is_nan())));
            odd.is_clear |= planes.get(3).is_some_and(|it| sample(it) < 1.0);
        }
        odd
    }

    fn told(&self) -> String {
        let mut told = String::new();
        if self.bright > FEW {
            let percent = 100.0 * self.bright;
            told +=
                &format!("; {percent:.1} % of its pixels are brighter than white and shown white");
        }
        if self.missing > 0.0 {
            let percent = 100.0 * self.missing;
            told += &format!("; {percent:.1} % of its pixels are not numbers and shown black");
        }
        if self.is_clear {
            told += "; what is transparent in it is shown over black";
        }
        told
    }
}

/// The code value from 0 to 1 that shows a sample that is light to a power.
fn shown(sample: f64, power: f64) -> f64 {
    let sample = if sample.is_nan() {
        0.0
    } else {
        sample.clamp(0.0, 1.0)
    };
    let light = if power == 1.0 {
        sample
    } else {
        libm::pow(sample, 1.0 / power)
    };
    match light <= 0.003_130_8 {
        true => 12.92 * light,
        false => 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055,
    }
}

fn to_word(share: f64) -> u16 {
    (share * FULL).round() as u16
}

#[allow(unsafe_code)] // The descriptor's flags have no safe call.
fn is_rgb(format: Pixel) -> bool {
    // SAFETY: descriptors are static constants of libavutil.
    let flags = format
        .descriptor()
        .map_or(0, |it| unsafe { (*it.as_ptr()).flags });
    flags & av::ffi::AV_PIX_FMT_FLAG_RGB as u64 != 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_becomes_the_code_value_of_srgb_and_any_sample_one_from_0_to_1() {
        let code = |light: f64, power: f64| (shown(light, power) * 255.0).round();
        assert_eq!([0.0, 0.5, 1.0].map(|it| code(it, 1.0)), [0.0, 188.0, 255.0]);
        // The usual power is nearly the curve itself.
        assert!((code(0.5, 0.454_55) - 127.5).abs() <= 1.5);
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30, -3.0];
        assert_eq!(odd.map(|it| code(it, 1.0)), [0.0, 255.0, 0.0, 255.0, 0.0]);
    }
}
