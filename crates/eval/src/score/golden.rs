//! Which pairs of pictures have scores that the published package was measured to give?
//!
//! Inputs come from formulas alone; the scores and energies were measured with pyfvvdp 1.2.2
//! (PyTorch 2.15, single precision) on those inputs.

mod case;
mod cases;

use super::error::ScoreError;
use super::picture::ScorePicture;
pub use case::{Golden, GoldenGaze, TestPicture};
use std::f64::consts::PI;

impl Golden {
    /// The case of a name.
    #[must_use]
    pub fn named(id: &str) -> Option<&'static Self> {
        cases::GOLDENS.iter().find(|golden| golden.id == id)
    }

    /// Every case whose reference comes from a formula.
    #[must_use]
    pub fn all() -> &'static [Self] {
        &cases::GOLDENS
    }

    /// The cases whose reference is a photograph, which is no part of this project: stills, asked
    /// by [`Self::pictures_of`].
    #[must_use]
    pub fn of_photograph() -> &'static [Self] {
        &cases::PHOTOGRAPHED
    }

    /// Where the eye looks in a frame.
    #[must_use]
    pub fn gaze_at(&self, frame: u32) -> Option<[f64; 2]> {
        self.gaze.at(frame, self.frames)
    }

    /// Bytes of reference and test of a frame: red, green, blue.
    #[must_use]
    pub fn bytes(&self, frame: u32) -> [Vec<u8>; 2] {
        let reference = scene(self.size, f64::from(frame) * self.speed);
        let test = self.test_of(frame, &reference);
        [reference, test]
    }

    /// Bytes of the test of a frame whose reference is given.
    fn test_of(&self, frame: u32, reference: &[u8]) -> Vec<u8> {
        match self.test {
            TestPicture::Same => reference.to_vec(),
            TestPicture::Pop(from) if frame < from => reference.to_vec(),
            TestPicture::Pop(_) => {
                let all = Foveation {
                    round: [160.0, 120.0],
                    radius: 1e-6,
                    tile: 16,
                    most: 2,
                };
                all.of(self.size, reference)
            }
            TestPicture::Foveated {
                round,
                radius,
                tile,
                late,
            } => {
                let seen = frame.saturating_sub(late);
                let foveation = Foveation {
                    round: round.at(seen, self.frames).unwrap_or_default(),
                    radius,
                    tile,
                    most: 4,
                };
                foveation.of(self.size, reference)
            }
        }
    }

    /// Reference and test of a frame.
    ///
    /// # Errors
    /// Never for the cases of [`Self::all`].
    pub fn pictures(&self, frame: u32) -> Result<[ScorePicture; 2], ScoreError> {
        let [reference, test] = self.bytes(frame);
        Ok([
            ScorePicture::from_rgb8(self.size, reference)?,
            ScorePicture::from_rgb8(self.size, test)?,
        ])
    }

    /// Reference and test of a still whose reference is `photograph`: red, green, blue.
    ///
    /// # Errors
    /// When it does not have three samples a pixel of the case's size.
    pub fn pictures_of(&self, photograph: Vec<u8>) -> Result<[ScorePicture; 2], ScoreError> {
        let reference = ScorePicture::from_rgb8(self.size, photograph.clone())?;
        let test = self.test_of(0, &photograph);
        Ok([reference, ScorePicture::from_rgb8(self.size, test)?])
    }
}

/// A zone plate, two gratings and noise, moved by `shift` pixels: 8-bit red, green, blue.
#[must_use]
pub fn scene(size: [u32; 2], shift: f64) -> Vec<u8> {
    let [w, h] = size.map(f64::from);
    let mut bytes = Vec::with_capacity(size[0] as usize * size[1] as usize * 3);
    for row in 0..size[1] {
        for column in 0..size[0] {
            let (x, y) = (f64::from(column), f64::from(row));
            let moved = x + shift;
            let [across, down] = [x - w / 2.0, y - h / 2.0];
            let plate = (PI * (across * across + down * down) / (4.0 * w)).sin();
            let grating = (2.0 * PI * (moved / 32.0 + y / 80.0)).sin();
            let low = (2.0 * PI * (moved / w + 0.5 * y / h)).sin();
            let key = (moved.floor() as i64).rem_euclid(65_536) as u32;
            let noise = f64::from(hash(key.wrapping_add(row << 16))) / 4_294_967_296.0 - 0.5;
            let base = 0.45 + 0.16 * plate + 0.10 * grating + 0.12 * low + 0.12 * noise;
            for channel in [base + 0.05 * low, base, base - 0.05 * grating] {
                bytes.push((255.0 * channel.clamp(0.0, 1.0) + 0.5).floor() as u8);
            }
        }
    }
    bytes
}

/// Bits of a number well mixed.
fn hash(mut h: u32) -> u32 {
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

/// Tiles that become coarser with their distance from a place.
pub struct Foveation {
    /// Where, pixels.
    pub round: [f64; 2],
    /// Radius of what stays, pixels.
    pub radius: f64,
    /// Side of a tile, pixels.
    pub tile: usize,
    /// Coarsest level.
    pub most: u32,
}

impl Foveation {
    /// A picture of 8-bit red, green, blue foveated.
    #[must_use]
    pub fn of(&self, size: [u32; 2], rgb: &[u8]) -> Vec<u8> {
        let size = size.map(|side| side as usize);
        let levels: Vec<Vec<u8>> = (0..=self.most).map(|n| blocks(size, rgb, 1 << n)).collect();
        let mut out = Vec::with_capacity(rgb.len());
        for y in 0..size[1] {
            for x in 0..size[0] {
                let level = self.level([x / self.tile, y / self.tile]);
                let at = (y * size[0] + x) * 3;
                out.extend_from_slice(&levels[level][at..at + 3]);
            }
        }
        out
    }

    fn level(&self, tile: [usize; 2]) -> usize {
        let side = self.tile as f64;
        let apart = |k: usize| (tile[k] as f64 + 0.5) * side - (self.round[k] + 0.5);
        let distance = apart(0).hypot(apart(1)).max(1e-9);
        let level = (distance / self.radius).log2().floor() + 1.0;
        level.clamp(0.0, f64::from(self.most)) as usize
    }
}

/// Every pixel the rounded mean of its aligned block, beyond the picture its border repeated.
fn blocks([w, h]: [usize; 2], rgb: &[u8], side: usize) -> Vec<u8> {
    let [across, down] = [w, h].map(|length| length.div_ceil(side));
    let count = (side * side) as u32;
    let mean = |block_x: usize, block_y: usize, channel: usize| {
        let mut sum = 0;
        for y in block_y * side..(block_y + 1) * side {
            for x in block_x * side..(block_x + 1) * side {
                let at = y.min(h - 1) * w + x.min(w - 1);
                sum += u32::from(rgb[at * 3 + channel]);
            }
        }
        ((sum + count / 2) / count) as u8
    };
    let means: Vec<[u8; 3]> = (0..across * down)
        .map(|at| [0, 1, 2].map(|channel| mean(at % across, at / across, channel)))
        .collect();
    let mut out = Vec::with_capacity(rgb.len());
    for y in 0..h {
        for x in 0..w {
            out.extend_from_slice(&means[y / side * across + x / side]);
        }
    }
    out
}
