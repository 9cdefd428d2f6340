//! How much contrast has a picture in each frequency band, as the eye sees it?

use crate::commands::perception::look::{LookOptions, read_picture};
use crate::report::output;
use crate::report::picture_file::write_png;
use anyhow::Context;
use clap::Args;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::measures::pyramid::{Band, Pyramid, band_frequency, bands_of};
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::units::counted;
use foveal_render::RgbaImage;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Bands that no picture has more of: each is half as large as the one before.
const MOST_BANDS: usize = 32;
/// Seen contrast, in thresholds, that a shade half way from grey to black or white stands for.
const HALF_SHADE: f64 = 60.0;

/// Writes, for every octave band, contrast times sensitivity where the eye looks: grey where there
/// is nothing to see, lighter and darker where there is (a threshold is barely off grey).
#[derive(Clone, Debug, Args)]
pub(crate) struct BandsArgs {
    /// The picture, a PNG.
    picture: PathBuf,
    #[command(flatten)]
    look: LookOptions,
    /// Folder for band-0.png (the finest), band-1.png, ...
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Bands {
    bands: Vec<BandRow>,
}

#[derive(Debug, Serialize)]
struct BandRow {
    file: PathBuf,
    /// At the middle of the picture.
    cpd: f64,
    /// Mean of seen contrast, in thresholds.
    mean_seen: f64,
}

pub(crate) fn run(args: &BandsArgs) -> anyhow::Result<()> {
    let parameters = args.look.parameters()?;
    let picture = read_picture(&args.picture)?;
    for index in 0..MOST_BANDS {
        output::spare_inputs(&file_of(&args.out, index), [args.picture.as_path()])?;
    }
    let onlooker = args.look.onlooker(picture.size, EyeState::Steady)?;
    let out = &args.out;
    std::fs::create_dir_all(out).with_context(|| format!("{}: no folder", out.display()))?;
    remove_older(out, bands_of(picture.size))?;
    let pyramid = Pyramid::of(parameters.luminance_from_rgb(&picture.rgb), picture.size);
    let middle = onlooker.spot(picture.size.map(|side| f64::from(side) / 2.0));
    let mut bands = Vec::new();
    for (index, band) in pyramid.bands.iter().enumerate() {
        let seen = seen_contrast(&onlooker, &parameters, index, band);
        let file = file_of(out, index);
        write_png(&file, &shaded(&seen, band.size, picture.size))?;
        bands.push(BandRow {
            file,
            cpd: band_frequency(index, middle.ppd).0,
            mean_seen: seen.iter().map(|s| s.abs()).sum::<f64>() / seen.len() as f64,
        });
    }
    let line = |row: &BandRow| {
        let (file, cpd, seen) = (row.file.display(), row.cpd, row.mean_seen);
        format!("{file}: {cpd:.3} cycles per degree, {seen:.2} thresholds on average\n")
    };
    let text: String = bands.iter().map(line).collect();
    output::result(args.json, &Bands { bands }, &text)
}

/// Removes the bands of an older, larger picture, which these would lie among, and says so.
fn remove_older(out: &Path, bands: usize) -> anyhow::Result<()> {
    let files = (bands..MOST_BANDS).map(|index| file_of(out, index));
    let older: Vec<PathBuf> = files.filter(|file| file.is_file()).collect();
    if !older.is_empty() {
        let count = counted(older.len(), "band");
        output::say(&format!(
            "{}: {count} of a larger picture are removed",
            out.display()
        ));
    }
    for file in older {
        std::fs::remove_file(&file).with_context(|| format!("{}: stays", file.display()))?;
    }
    Ok(())
}

fn file_of(out: &Path, index: usize) -> PathBuf {
    out.join(format!("band-{index}.png"))
}

fn seen_contrast(
    onlooker: &Onlooker,
    parameters: &Parameters,
    index: usize,
    band: &Band,
) -> Vec<f64> {
    let width = band.size[0] as usize;
    let texels = band.contrast.iter().enumerate();
    texels
        .map(|(texel, contrast)| {
            let place = onlooker.texel_place(index, [texel % width, texel / width]);
            contrast * onlooker.seen(parameters, index, place).sustained
        })
        .collect()
}

/// A band at the picture's size: bilinear between its texels.
fn shaded(seen: &[f64], band: [u32; 2], size: [u32; 2]) -> RgbaImage {
    let mut image = RgbaImage::black(size);
    // Level k has ceil(size / 2^k) texels of 2^k pixels.
    let texel = (0..31)
        .map(|k| 1u32 << k)
        .find(|&texel| size[0].div_ceil(texel) == band[0])
        .unwrap_or(1);
    let around = |pixel: usize, count: u32| {
        let at = ((pixel as f64 + 0.5) / f64::from(texel) - 0.5).clamp(0.0, f64::from(count - 1));
        let before = at as usize;
        (
            before,
            (before + 1).min(count as usize - 1),
            at - before as f64,
        )
    };
    let mix = |a: f64, b: f64, share: f64| a + (b - a) * share;
    for (i, pixel) in image.pixels.chunks_exact_mut(4).enumerate() {
        let (left, right, across) = around(i % size[0] as usize, band[0]);
        let (above, below, down) = around(i / size[0] as usize, band[1]);
        let row = |y: usize| {
            let row = &seen[y * band[0] as usize..];
            mix(row[left], row[right], across)
        };
        let s = mix(row(above), row(below), down);
        let shade = (127.5 * (1.0 + s / (s.abs() + HALF_SHADE))).round() as u8;
        pixel[..3].fill(shade);
    }
    image
}
