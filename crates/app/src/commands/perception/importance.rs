//! What is going from one picture to another worth to the eye, and where?

use crate::commands::perception::look::{LookOptions, read_picture};
use crate::commands::perception::sheet::sheet;
use crate::report::colour_ramp::fire;
use crate::report::output;
use crate::report::picture_file::{RgbPicture, write_png};
use anyhow::bail;
use clap::{Args, ValueEnum};
use foveal_core::perception::fast::FastImportance;
use foveal_core::perception::gain::Weights;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::luminance::grey_from_rgb;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_render::RgbaImage;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StateName {
    /// Changes are seen, where the gaze is.
    Fixation,
    /// Nothing is seen: the same map whatever the gaze.
    Saccade,
    /// Up to 100 ms after a saccade: errors are seen, changes hardly.
    Landed,
}

/// Writes three heat maps: FILE.png is the value, FILE-eccentricity.png what the eye resolves,
/// FILE-popping.png the change that it sees. Black is nothing, then violet, orange and light yellow
/// as in a fire, the lightest being the largest of the map; blue is below 0.
#[derive(Clone, Debug, Args)]
pub(crate) struct ImportanceArgs {
    /// What is shown, a PNG.
    before: PathBuf,
    /// What would be shown, a PNG of the same size.
    after: PathBuf,
    #[command(flatten)]
    look: LookOptions,
    /// What the eye does.
    #[arg(long, value_enum, default_value = "fixation")]
    mode: StateName,
    /// Where the heat map of the value goes; the others are written next to it.
    #[arg(long, value_name = "FILE.png")]
    out: PathBuf,
    /// Write FILE-..-update.png too, the picture with the quarter of its pixels updated that each
    /// map puts first (in a fixation, popping least), and FILE-sheet.png: what is shown, what would
    /// be, the update by value; eccentricity, popping, value.
    #[arg(long)]
    updates: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    mode: EyeState,
    gaze_px: [f64; 2],
    fov_deg: f64,
    parameters: Parameters,
    maps: Vec<MapRow>,
    sheet_file: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct MapRow {
    name: &'static str,
    file: PathBuf,
    update_file: Option<PathBuf>,
    mean: f64,
    least: f32,
    most: f32,
    /// Share of the pixels whose value is above 0.
    positive_share: f64,
}

pub(crate) fn run(args: &ImportanceArgs) -> anyhow::Result<()> {
    let parameters = args.look.parameters()?;
    for name in ["value", "eccentricity", "popping", "sheet"] {
        for ending in ["", "-update"] {
            let file = beside(&args.out, name, ending);
            output::spare_inputs(&file, [args.before.as_path(), args.after.as_path()])?;
        }
    }
    let (before, after) = (read_picture(&args.before)?, read_picture(&args.after)?);
    if before.size != after.size {
        let ([a, b], [c, d]) = (before.size, after.size);
        let name = args.after.display();
        bail!("{name}: {c}x{d} pixels where the other has {a}x{b}; give pictures of one size");
    }
    let state = match args.mode {
        StateName::Fixation => EyeState::Steady,
        StateName::Saccade => EyeState::Jumping,
        StateName::Landed => EyeState::Landed,
    };
    let onlooker = args.look.onlooker(before.size, state)?;
    let (mut maps, mut heats, mut updates) = (Vec::new(), Vec::new(), Vec::new());
    for (name, weights, worst_first) in terms(&parameters, state) {
        let map = map(&parameters, &onlooker, &weights, [&after, &before]);
        let file = beside(&args.out, name, "");
        let heat = heat(&map, before.size);
        write_png(&file, &heat)?;
        heats.push(heat);
        let update_file = args.updates.then(|| beside(&args.out, name, "-update"));
        if let Some(file) = &update_file {
            let update = update(&map, worst_first, &before, &after);
            write_png(file, &update)?;
            updates.push(update);
        }
        maps.push(row(name, file, update_file, &map));
    }
    let sheet_file = match (&heats[..], &updates[..]) {
        ([value, eccentricity, popping], [update, ..]) => {
            let shown = [before.image(), after.image()];
            let panels = [&shown[0], &shown[1], update, eccentricity, popping, value];
            let file = beside(&args.out, "sheet", "");
            write_png(&file, &sheet(panels))?;
            Some(file)
        }
        _ => None,
    };
    let report = Report {
        mode: state,
        gaze_px: args.look.gaze(),
        fov_deg: args.look.fov(),
        parameters,
        maps,
        sheet_file,
    };
    output::result(args.json, &report, &text(&report))
}

/// The maps, and whether a smaller number is better.
fn terms(parameters: &Parameters, state: EyeState) -> [(&'static str, Weights, bool); 3] {
    let none = Weights::default();
    let acuity = Weights {
        acuity: 1.0,
        ..none
    };
    let popping = Weights {
        popping: 1.0,
        ..none
    };
    [
        ("value", parameters.weights(state), false),
        ("eccentricity", acuity, false),
        ("popping", popping, state == EyeState::Steady),
    ]
}

fn map(
    parameters: &Parameters,
    onlooker: &Onlooker,
    weights: &Weights,
    levels: [&RgbPicture; 2],
) -> Vec<f32> {
    let luma = levels.map(|picture| grey_from_rgb(&picture.rgb));
    let mut importance = FastImportance::new(parameters, &onlooker.view, luma.len());
    importance.look(onlooker, weights);
    let mut maps = [vec![0.0; luma[0].len()]];
    importance.maps(&[&luma[0], &luma[1]], &mut maps);
    let [map] = maps;
    map
}

/// `heat.png` for the value, `heat-popping.png` and so on next to it.
fn beside(out: &Path, name: &str, ending: &str) -> PathBuf {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let part = if name == "value" {
        String::new()
    } else {
        format!("-{name}")
    };
    out.with_file_name(format!("{stem}{part}{ending}.png"))
}

fn row(name: &'static str, file: PathBuf, update_file: Option<PathBuf>, map: &[f32]) -> MapRow {
    let count = map.len() as f64;
    MapRow {
        name,
        file,
        update_file,
        mean: map.iter().map(|&v| f64::from(v)).sum::<f64>() / count,
        least: map.iter().copied().fold(f32::INFINITY, f32::min),
        most: map.iter().copied().fold(f32::NEG_INFINITY, f32::max),
        positive_share: map.iter().filter(|&&v| v > 0.0).count() as f64 / count,
    }
}

fn heat(map: &[f32], size: [u32; 2]) -> RgbaImage {
    let most = map
        .iter()
        .fold(f32::MIN_POSITIVE, |most, v| most.max(v.abs()));
    let mut image = RgbaImage::black(size);
    for (pixel, value) in image.pixels.chunks_exact_mut(4).zip(map) {
        // The root keeps what is small in sight.
        let share = (value.abs() / most).sqrt();
        let colour = if *value < 0.0 {
            [0.1, 0.35, 1.0].map(|part| (part * share * 255.0_f32).round() as u8)
        } else {
            fire(share)
        };
        pixel[..3].copy_from_slice(&colour);
    }
    image
}

/// The first picture with the second in the quarter of the pixels that come first.
fn update(map: &[f32], worst_first: bool, before: &RgbPicture, after: &RgbPicture) -> RgbaImage {
    let sign = if worst_first { -1.0 } else { 1.0 };
    let mut order: Vec<usize> = (0..map.len()).collect();
    order.sort_by(|&a, &b| (sign * map[b]).total_cmp(&(sign * map[a])));
    let mut image = before.image();
    for &pixel in &order[..map.len() / 4] {
        image.pixels[pixel * 4..][..3].copy_from_slice(&after.rgb[pixel]);
    }
    image
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    for map in &report.maps {
        let (file, share) = (map.file.display(), 100.0 * map.positive_share);
        let [least, mean, most] = [f64::from(map.least), map.mean, f64::from(map.most)];
        let range = format!("{least:.4} to {most:.4}, mean {mean:.4}");
        let _ = writeln!(
            text,
            "{file}: {}, {range}, above 0 in {share:.1} %",
            map.name
        );
    }
    text
}
