//! How does a frame become light, and the light of a quarter of a second what two channels see?

use super::strip::ROWS;
use crate::score::constants::LUMINANCE_WEIGHTS;
use crate::score::display::Display;
use crate::score::picture::{Samples, ScorePicture};
use foveal_core::perception::fast::instructions::Instructions;
use rayon::prelude::*;

/// Light that codes give on one display.
pub(super) struct Light {
    display: Display,
    /// Of every 8-bit code of red, green and blue, weighed.
    bits8: [Vec<f32>; 3],
    /// Of every 16-bit code before it is weighed; made when it is first needed.
    bits16: Vec<f32>,
}

impl Light {
    pub(super) fn new(display: &Display) -> Self {
        let weighed = |weight: f64| {
            let light = (0..=255).map(|code| display.light(f64::from(code) / 255.0));
            light.map(|light| (light * weight) as f32).collect()
        };
        Self {
            display: display.clone(),
            bits8: LUMINANCE_WEIGHTS.map(weighed),
            bits16: Vec::new(),
        }
    }

    /// Luminance of every pixel into `out`.
    pub(super) fn fill(&mut self, picture: &ScorePicture, out: &mut [f32]) {
        if matches!(picture.samples(), Samples::Bits16(_)) && self.bits16.is_empty() {
            let light = (0..=65_535).map(|code| self.display.light(f64::from(code) / 65_535.0));
            self.bits16 = light.map(|light| light as f32).collect();
        }
        let columns = picture.size()[0] as usize;
        let rows = out.par_chunks_mut(columns * ROWS).enumerate();
        let this = &*self;
        rows.for_each(|(strip, out)| this.fill_strip(picture, strip * columns * ROWS, out));
    }

    /// The pixels from number `first` on.
    fn fill_strip(&self, picture: &ScorePicture, first: usize, out: &mut [f32]) {
        let weights = LUMINANCE_WEIGHTS.map(|weight| weight as f32);
        match picture.samples() {
            Samples::Bits8(samples) => {
                let [red, green, blue] = &self.bits8;
                for (light, rgb) in out.iter_mut().zip(samples[first * 3..].chunks_exact(3)) {
                    let [r, g, b] = [rgb[0], rgb[1], rgb[2]].map(usize::from);
                    *light = red[r] + green[g] + blue[b];
                }
            }
            Samples::Bits16(samples) => {
                for (light, rgb) in out.iter_mut().zip(samples[first * 3..].chunks_exact(3)) {
                    let parts = [0, 1, 2].map(|k| weights[k] * self.bits16[usize::from(rgb[k])]);
                    *light = parts[0] + parts[1] + parts[2];
                }
            }
            Samples::Float(_) => {
                for (at, light) in out.iter_mut().enumerate() {
                    *light = self.display.luminance(picture.rgb(first + at)) as f32;
                }
            }
        }
    }
}

/// The luminance of the last frames.
pub(super) struct Ring {
    frames: Vec<Vec<f32>>,
    /// How many frames came.
    came: usize,
}

impl Ring {
    /// Room for `length` frames of `pixels`.
    pub(super) fn new(length: usize, pixels: usize) -> Self {
        Self {
            frames: (0..length).map(|_| vec![0.0; pixels]).collect(),
            came: 0,
        }
    }

    /// Where the next frame goes, in place of the oldest.
    pub(super) fn next(&mut self) -> &mut [f32] {
        let slot = self.came % self.frames.len();
        self.came += 1;
        &mut self.frames[slot]
    }

    /// The frame of this age, 0 being the newest; before the first frame that one was shown.
    pub(super) fn aged(&self, age: usize) -> &[f32] {
        let age = age.min(self.came - 1);
        &self.frames[(self.came - 1 - age) % self.frames.len()]
    }

    /// Weighed sums of the frames, one plane for every channel that `out` has.
    pub(super) fn filter(
        &self,
        taps: &[[f32; 2]],
        columns: usize,
        out: &mut [Vec<f32>],
        instructions: Instructions,
    ) {
        let strip = columns * ROWS;
        match out {
            [sustained] => sustained
                .par_chunks_mut(strip)
                .enumerate()
                .for_each(|(n, out)| {
                    instructions.run(
                        #[inline(always)]
                        || self.filter_strip(taps, n * strip, [out, &mut []]),
                    );
                }),
            [sustained, transient] => sustained
                .par_chunks_mut(strip)
                .zip(transient.par_chunks_mut(strip))
                .enumerate()
                .for_each(|(n, (s, t))| {
                    instructions.run(
                        #[inline(always)]
                        || self.filter_strip(taps, n * strip, [s, t]),
                    );
                }),
            _ => unreachable!("one channel or two"),
        }
    }

    #[inline(always)]
    fn filter_strip(&self, taps: &[[f32; 2]], first: usize, [s, t]: [&mut [f32]; 2]) {
        s.fill(0.0);
        t.fill(0.0);
        for (age, [sustained, transient]) in taps.iter().enumerate() {
            let light = &self.aged(age)[first..first + s.len()];
            for (sum, light) in s.iter_mut().zip(light) {
                *sum += sustained * light;
            }
            for (sum, light) in t.iter_mut().zip(light) {
                *sum += transient * light;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn before_the_first_frame_it_was_shown_and_old_frames_go() {
        let mut ring = Ring::new(3, 2);
        for n in 1..=5_u8 {
            ring.next().fill(f32::from(n));
            let ages: Vec<f32> = (0..3).map(|age| ring.aged(age)[0]).collect();
            let wanted = [0, 1, 2].map(|age| f32::from(n.saturating_sub(age).max(1)));
            assert_eq!(ages, wanted);
        }
    }

    #[test]
    fn light_is_that_of_the_display() {
        let display = Display::named("standard_hmd").unwrap();
        let codes: Vec<u8> = (0..64 * 3).map(|n| (n * 37 % 256) as u8).collect();
        let bits16 = codes.iter().map(|&code| u16::from(code) * 257).collect();
        let floats = codes.iter().map(|&code| f32::from(code) / 255.0).collect();
        for samples in [
            Samples::Bits8(codes),
            Samples::Bits16(bits16),
            Samples::Float(floats),
        ] {
            let picture = ScorePicture::new([8, 8], samples).unwrap();
            let mut out = vec![0.0; 64];
            Light::new(&display).fill(&picture, &mut out);
            for (found, wanted) in out.iter().zip(picture.luminance(&display)) {
                assert!((f64::from(*found) / wanted - 1.0).abs() < 1e-6);
            }
        }
    }
}
