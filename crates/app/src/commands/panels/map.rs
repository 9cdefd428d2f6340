//! Where do pixels of panels land in the source, one by one and as files?

use super::rig_args::{RigArgs, source_size};
use crate::report::output::{self, WrongUsage};
use anyhow::Context;
use clap::{Args, ValueEnum};
use foveal_core::view::panel::fit::SourceFit;
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::panel::seed::SeedTexel;
use foveal_scene::rig::write_mpcdi;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// How maps are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MapFormat {
    /// Two PNG files of 16 bits, whole source pixels and 65,536ths, and one of 8-bit derivatives.
    Seed,
    /// Portable float maps: shares of the source to the right and down, not a number where nothing
    /// is shown.
    Pfm,
    /// A file that other programs read, with a buffer for each surface: frusta, maps within these,
    /// and fades and black as pictures.
    Mpcdi,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct MapArgs {
    #[command(flatten)]
    rig: RigArgs,
    /// Size of the source as 1600x1200, or a picture or video that has it; as needed if not given.
    #[arg(long, value_name = "WxH|FILE")]
    source: Option<String>,
    /// Pixel of a panel: its id, column and row, from 0; may be given several times.
    #[arg(long, value_name = "ID:I,J", value_parser = parse_at)]
    at: Vec<PanelPixel>,
    /// Folder for a map of each panel.
    #[arg(long, value_name = "DIR", requires = "format")]
    out: Option<PathBuf>,
    /// How maps are written.
    #[arg(long, value_enum, requires = "out")]
    format: Option<MapFormat>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// A pixel that was asked for.
#[derive(Clone, Debug)]
struct PanelPixel {
    panel: String,
    pixel: [u32; 2],
}

/// Reads `ID:I,J`.
fn parse_at(text: &str) -> anyhow::Result<PanelPixel> {
    let expected = "expected a panel's id, a column and a row as L:100,200";
    let (panel, pixel) = text.rsplit_once(':').context(expected)?;
    let (column, row) = pixel.split_once(',').context(expected)?;
    let number = |word: &str| word.trim().parse::<u32>().context(expected);
    Ok(PanelPixel {
        panel: panel.to_owned(),
        pixel: [number(column)?, number(row)?],
    })
}

#[derive(Debug, Serialize)]
struct MapReport {
    points: Vec<PointReport>,
    /// That were written.
    files: Vec<String>,
    /// What of the panels they have no place for.
    left_out: Vec<String>,
}

/// A pixel's place in the source and its changes; nothing where it shows nothing.
#[derive(Debug, Serialize)]
struct PointReport {
    panel: String,
    i: u32,
    j: u32,
    u: Option<f64>,
    v: Option<f64>,
    du_dx: Option<f64>,
    du_dy: Option<f64>,
    dv_dx: Option<f64>,
    dv_dy: Option<f64>,
    sigma_max: Option<f64>,
    sigma_min: Option<f64>,
}

impl PointReport {
    fn of(asked: &PanelPixel, map: &PixelMap<'_>) -> Self {
        let found = map.of_pixel(asked.pixel);
        let change = |k: usize, l: usize| found.map(|it| it.jacobian[k][l]);
        Self {
            panel: asked.panel.clone(),
            i: asked.pixel[0],
            j: asked.pixel[1],
            u: found.map(|it| it.place[0]),
            v: found.map(|it| it.place[1]),
            du_dx: change(0, 0),
            du_dy: change(0, 1),
            dv_dx: change(1, 0),
            dv_dy: change(1, 1),
            sigma_max: found.map(|it| it.sigma()[0]),
            sigma_min: found.map(|it| it.sigma()[1]),
        }
    }

    fn text(&self) -> String {
        let Self { panel, i, j, .. } = self;
        match (self.u, self.v, self.sigma_max, self.sigma_min) {
            (Some(u), Some(v), Some(most), Some(least)) => {
                format!("{panel} {i},{j}: {u:.6}, {v:.6}; a step is {least:.6} to {most:.6} pixels")
            }
            _ => format!("{panel} {i},{j}: shows nothing"),
        }
    }
}

fn panel_of<'a>(panels: &[&'a Panel], asked: &PanelPixel) -> Result<&'a Panel, WrongUsage> {
    let Some(panel) = panels.iter().find(|it| it.id == asked.panel) else {
        let ids = panels.iter().map(|it| it.id.as_str()).take(16);
        let ids = ids.collect::<Vec<_>>().join(", ");
        return Err(WrongUsage(format!(
            "--at {}: there is no such panel before this eye; give one of {ids}, or another --eye",
            asked.panel
        )));
    };
    let [w, h] = panel.view.size;
    if asked.pixel[0] >= w || asked.pixel[1] >= h {
        return Err(WrongUsage(format!(
            "--at {}:{},{}: the panel has {w} x {h} pixels; count them from 0",
            asked.panel, asked.pixel[0], asked.pixel[1]
        )));
    }
    Ok(panel)
}

pub(crate) fn run(args: &MapArgs) -> anyhow::Result<()> {
    if args.at.is_empty() && args.out.is_none() {
        let what = "panels map needs --at ID:I,J, or --out DIR with --format";
        return Err(WrongUsage(what.to_owned()).into());
    }
    let source = source_size(args.source.as_deref())?;
    let rig = args.rig.read()?;
    let panels = args.rig.panels(&rig);
    let asked = args.at.iter().map(|at| Ok((at, panel_of(&panels, at)?)));
    let asked: Vec<(&PanelPixel, &Panel)> = asked.collect::<Result<_, WrongUsage>>()?;
    let found = args.rig.fit(&rig, &panels, source)?;
    let points = asked
        .iter()
        .map(|(at, panel)| PointReport::of(at, &map_of(panel, &found)));
    let points: Vec<PointReport> = points.collect();
    let (mut files, mut left_out) = (Vec::new(), Vec::new());
    if let (Some(out), Some(format)) = (&args.out, args.format) {
        if format == MapFormat::Seed && found.size.iter().any(|side| *side > 65_535) {
            let [w, h] = found.size;
            let what = format!("--format seed holds 65535 columns and rows, not {w} x {h}");
            return Err(WrongUsage(format!("{what}; give a smaller --source, or pfm")).into());
        }
        std::fs::create_dir_all(out)
            .with_context(|| format!("{}: cannot be made a folder", out.display()))?;
        match format {
            MapFormat::Mpcdi => {
                let name = args.rig.rig.file_stem().unwrap_or_default();
                let path = out.join(name).with_added_extension("mpcdi");
                left_out = write_whole_rig(&path, &panels)?;
                if rig.screen.is_some() {
                    left_out.push("the screen that the source fills".to_owned());
                }
                files.push(path.display().to_string());
            }
            _ => {
                for panel in &panels {
                    files.extend(write_map(out, format, &map_of(panel, &found))?);
                }
            }
        }
    }
    let mut text = String::new();
    for point in &points {
        let _ = writeln!(text, "{}", point.text());
    }
    for file in &files {
        let _ = writeln!(text, "{file}");
    }
    for what in &left_out {
        let _ = writeln!(text, "left out: {what}");
    }
    let report = MapReport {
        points,
        files,
        left_out,
    };
    output::result(args.json, &report, &text)
}

fn map_of<'a>(panel: &'a Panel, found: &'a SourceFit) -> PixelMap<'a> {
    PixelMap {
        panel,
        placement: &found.placement,
        size: found.size,
    }
}

/// Writes an MPCDI, and reports what it leaves out.
fn write_whole_rig(path: &Path, panels: &[&Panel]) -> anyhow::Result<Vec<String>> {
    let written = write_mpcdi(panels)
        .map_err(|what| WrongUsage(format!("--format mpcdi: {what}; write --format pfm")))?;
    output::write_out(path, &written.bytes)?;
    Ok(written.left_out)
}

/// Writes a panel's map, and returns its files.
fn write_map(out: &Path, format: MapFormat, map: &PixelMap<'_>) -> anyhow::Result<Vec<String>> {
    let id = &map.panel.id;
    let mut files = Vec::new();
    let mut write = |ending: &str, bytes: &[u8]| {
        let path = out.join(format!("{id}{ending}"));
        output::write_out(&path, bytes)?;
        files.push(path.display().to_string());
        anyhow::Ok(())
    };
    match format {
        MapFormat::Pfm | MapFormat::Mpcdi => write(".pfm", &pfm(map))?,
        MapFormat::Seed => {
            let size = map.panel.view.size;
            let texels = pixels(size).map(|pixel| SeedTexel::of(map, pixel));
            let texels: Vec<SeedTexel> = texels.collect();
            let two = |part: fn(&SeedTexel) -> [u16; 2]| {
                let all = texels.iter().flat_map(|it| {
                    let [u, v] = part(it);
                    [u, v, 0]
                });
                all.flat_map(u16::to_be_bytes).collect::<Vec<u8>>()
            };
            let change = texels.iter().flat_map(|it| it.change);
            // An offset of 128: pictures have no negative numbers.
            let change: Vec<u8> = change.map(|it| (i16::from(it) + 128) as u8).collect();
            let (rgb, deep) = (png::ColorType::Rgb, png::BitDepth::Sixteen);
            write(".whole.png", &png_of(size, rgb, deep, &two(|it| it.whole))?)?;
            write(
                ".fraction.png",
                &png_of(size, rgb, deep, &two(|it| it.fraction))?,
            )?;
            let (four, flat) = (png::ColorType::Rgba, png::BitDepth::Eight);
            write(".derivative.png", &png_of(size, four, flat, &change)?)?;
        }
    }
    Ok(files)
}

/// Columns and rows, row by row.
fn pixels([columns, rows]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]))
}

fn png_of(
    [w, h]: [u32; 2],
    colour: png::ColorType,
    depth: png::BitDepth,
    bytes: &[u8],
) -> anyhow::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, w, h);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()?;
    Ok(file)
}

/// A portable float map, its lowest row first.
fn pfm(map: &PixelMap<'_>) -> Vec<u8> {
    let [w, h] = map.panel.view.size;
    let mut file = format!("PF\n{w} {h}\n-1.0\n").into_bytes();
    for row in (0..h).rev() {
        for column in 0..w {
            let place = map.of_pixel([column, row]).map(|it| it.place);
            let share = |k: usize| match place {
                Some(place) => (place[k] / f64::from(map.size[k])) as f32,
                None => f32::NAN,
            };
            for value in [share(0), share(1), 0.0] {
                file.extend(value.to_le_bytes());
            }
        }
    }
    file
}
