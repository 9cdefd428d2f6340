//! How many more bytes than a slow encoder's does each speed take for the same quality?

use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::view::picture::Picture;
use foveal_media::prepare::pyramid::halve_all;
use foveal_media::{EncodeSettings, GroupDecoder, Rate, Speed, VideoInput, encode_group};
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;

/// Sides of the tiles that are coded, pixels: those of spheres and of flat content.
const TILES: [u32; 2] = [256, 512];
/// Frames in a group of the finest level.
const GROUP: usize = 8;
/// Tiles of each size, spread over the picture, at each level from the finest: in the proportion of
/// their pixels.
const PLACES: [u32; 3] = [12, 3, 1];
/// Quantisers between whose results the others are interpolated.
const QUANTISERS: [u8; 5] = [8, 16, 24, 32, 42];
/// The reference's quantiser: equal quality is what it reaches there.
const AT: u8 = 24;

/// Bytes of one speed over those of the reference.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SizeRow {
    pub(super) content: String,
    pub(super) way: &'static str,
    /// Side of the tiles in pixels.
    pub(super) tile: u32,
    /// Luma PSNR at which they are compared.
    pub(super) psnr_db: f64,
    pub(super) bytes_over_reference: f64,
}

/// Codes tiles of the first frames of a clip at every speed, and interpolates the logarithm of
/// bytes over PSNR.
pub(super) fn sizes_at_equal_quality(content: &str, clip: &Path) -> anyhow::Result<Vec<SizeRow>> {
    let mut input = VideoInput::open(clip)?;
    let mut frames = Vec::new();
    while let Some(frame) = input.next_frame()? {
        frames.push(frame.picture);
        if frames.len() == GROUP {
            break;
        }
    }
    let mut rows = Vec::new();
    let mut levels = vec![frames];
    while levels.len() < PLACES.len() {
        let finer = &levels[levels.len() - 1];
        levels.push(halve_all(finer, 2, input.info().colour, 1));
    }
    for tile in TILES {
        let groups = groups_of(&levels, tile);
        if groups.is_empty() {
            continue;
        }
        let reference = curve(&groups, Speed::Reference)?;
        let at = QUANTISERS.iter().position(|q| *q == AT).unwrap_or_default();
        let [psnr_db, log_bytes] = reference[at];
        for (way, speed) in [
            ("default", Speed::Default),
            ("--fast", Speed::Fast),
            ("--small", Speed::Small),
        ] {
            let found = interpolated(&curve(&groups, speed)?, psnr_db);
            rows.push(SizeRow {
                content: content.to_owned(),
                way,
                tile,
                psnr_db,
                bytes_over_reference: (found - log_bytes).exp(),
            });
        }
    }
    Ok(rows)
}

/// A tile of a level over one group of frames.
struct Group {
    level: u8,
    pictures: Vec<Picture>,
}

/// Groups of tiles at places spread evenly, by the frames of each level; none of a level whose
/// picture is smaller than a tile.
fn groups_of(levels: &[Vec<Picture>], tile: u32) -> Vec<Group> {
    let groups = (0..)
        .zip(levels)
        .zip(PLACES)
        .map(|((level, frames), count)| {
            let cut = |corner: &[u32; 2]| Group {
                level,
                pictures: frames
                    .iter()
                    .map(|frame| frame.crop(*corner, [tile; 2]))
                    .collect(),
            };
            let size = frames
                .first()
                .map_or([0; 2], |first| [first.width, first.height]);
            // In a picture hardly larger than a tile places coincide.
            let different: BTreeSet<[u32; 2]> = corners(size, tile, count).into_iter().collect();
            different.iter().map(cut).collect::<Vec<_>>()
        });
    groups.flatten().collect()
}

/// Corners of `count` tiles spread over a picture; none where it is smaller than a tile.
fn corners(size: [u32; 2], tile: u32, count: u32) -> Vec<[u32; 2]> {
    let [Some(across), Some(down)] = size.map(|side| side.checked_sub(tile)) else {
        return Vec::new();
    };
    // Two steps that share no factor with 12 visit all of its columns and rows; few places lie in
    // the middle of theirs.
    let along = |room: u32, n: u32| (room * (2 * n + 1) / (2 * count)) & !1;
    let corner = |n: u32| [along(across, n * 5 % count), along(down, n * 7 % count)];
    (0..count).map(corner).collect()
}

/// PSNR in decibels and the logarithm of bytes at each quantiser.
fn curve(groups: &[Group], speed: Speed) -> anyhow::Result<Vec<[f64; 2]>> {
    QUANTISERS
        .iter()
        .map(|q| point(groups, speed, *q))
        .collect()
}

fn point(groups: &[Group], speed: Speed, quantiser: u8) -> anyhow::Result<[f64; 2]> {
    let (mut bytes, mut squares, mut samples) = (0, 0, 0);
    for Group { level, pictures } in groups {
        let settings = EncodeSettings {
            codec: Codec::Vp9,
            rate: Rate::Quantiser(quantiser),
            frame_rate: [30, 1],
            speed: speed.at_level(*level),
        };
        let units = encode_group(&settings, pictures)?;
        let size = [pictures[0].width, pictures[0].height];
        let mut decoder = GroupDecoder::new(Codec::Vp9, size)?;
        for (unit, picture) in units.iter().zip(pictures) {
            let (decoded, _) = decoder.decode(unit, 0)?;
            let pairs = decoded.planes[0].iter().zip(&picture.planes[0]);
            squares += pairs
                .map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2))
                .sum::<u64>();
            samples += picture.planes[0].len();
            bytes += unit.len();
        }
    }
    let mean = (squares as f64 / samples.max(1) as f64).max(1e-9);
    Ok([10.0 * (255.0 * 255.0 / mean).log10(), (bytes as f64).ln()])
}

/// The second value where the first is `at`, along the line through the nearest two points.
fn interpolated(curve: &[[f64; 2]], at: f64) -> f64 {
    let segment = curve.windows(2).find(|pair| pair[1][0] <= at);
    let [a, b] = match segment.or_else(|| curve.windows(2).last()) {
        Some([a, b]) => [*a, *b],
        _ => return f64::NAN,
    };
    a[1] + (b[1] - a[1]) * (at - a[0]) / (b[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_read_between_and_beyond_its_points() {
        let curve = [[50.0, 10.0], [40.0, 8.0], [30.0, 7.0]];
        for (at, wanted) in [
            (50.0, 10.0),
            (45.0, 9.0),
            (32.0, 7.2),
            (20.0, 6.0),
            (55.0, 11.0),
        ] {
            assert!((interpolated(&curve, at) - wanted).abs() < 1e-9, "{at}");
        }
    }
}
