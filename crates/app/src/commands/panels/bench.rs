//! What does it cost to fill any number of panels?

use crate::commands::panels::filter_name::FilterName;
use crate::commands::panels::rig_args::{RigArgs, source_size};
use crate::commands::panels::warp::args::WarpModeName;
use crate::commands::panels::warp::laid::seed_map;
use crate::commands::panels::warp::source::opaque;
use crate::report::output::{self, WrongUsage, out_of_range};
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::view::panel::fit::covered;
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::placement::Placement;
use foveal_core::view::panel::rig::{MOST_PANELS, Panel};
use foveal_core::view::panel::seed::{SeedTexel, panels_by_fill_rate};
use foveal_media::generate::placed::GeneratedWorld;
use foveal_render::gpu::readback::BytesBack;
use foveal_render::gpu::timer::Timer;
use foveal_render::warp::{LoadedPlan, PanelOnSource, SourceTexture, WarpPlan, WarpStyle, Warper};
use foveal_render::{Gpu, RenderError};
use serde::Serialize;
use std::fmt::Write as _;
use std::time::Instant;

/// Columns and rows of the source if none are given: those of seed 002's study.
const SOURCE: [u32; 2] = [1600, 1200];

/// Panels that are timed if none are given.
const PANELS: [u32; 9] = [3, 6, 12, 18, 24, 30, 36, 48, 130];

/// Longest that a row is timed, in seconds.
const LONGEST_S: f64 = 10.0;

/// Pixels of a panel of the model, and texel fetches a pixel as it counts them.
const MODEL_PIXELS: f64 = 480_000.0;
const MODEL_FETCHES: [f64; 2] = [3.0, 4.0];

/// Two bilinear samples of a trilinear one and one for each map, where the model counts 24: its
/// rate counts bilinear samples.
const REAL_SAMPLES: f64 = 4.0;

/// Times how long all panels take, by the device's own clock where it has one.
#[derive(Clone, Debug, Args)]
pub(crate) struct PanelsBenchArgs {
    #[command(flatten)]
    rig: RigArgs,
    /// How many panels: those of the rig, again and again (default: 3,6,12,18,24,30,36,48,130, and
    /// none with --model).
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    panels: Option<Vec<u32>>,
    /// By maps instead of matrices.
    #[arg(long, value_enum)]
    mode: Option<WarpModeName>,
    /// Size of the source as 1600x1200, or a picture or video that has it.
    #[arg(long, value_name = "WxH|FILE")]
    source: Option<String>,
    /// Times that each is drawn, fewer where that takes more than 10 s; the median counts.
    #[arg(long, value_name = "N", default_value = "9")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Say how many panels a fill rate is enough for.
    #[arg(long, value_enum)]
    model: Option<WarpModeName>,
    /// Million texels a second of the model.
    #[arg(long, value_name = "MILLION", default_value = "26400")]
    texel_rate: f64,
    /// One JSON object on stdout.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct PanelsBench {
    adapter: String,
    clock: &'static str,
    rows: Vec<PanelsRow>,
    #[serde(flatten)]
    model: Option<FillModel>,
}

#[derive(Serialize)]
struct PanelsRow {
    panels: u32,
    filter: String,
    /// Null where the device has no clock.
    gpu_ms: Option<f64>,
    /// Null where the device has no room.
    wall_ms: Option<f64>,
    /// Written, and read of source and maps.
    bytes_per_pixel: f64,
    /// Records, grids and maps.
    map_mib: f64,
}

#[derive(Serialize)]
struct FillModel {
    panels_trilinear: f64,
    panels_feline: f64,
    /// With the samples that a pixel takes indeed.
    panels_corrected: f64,
}

pub(crate) fn run(args: &PanelsBenchArgs) -> anyhow::Result<()> {
    args.check()?;
    let rig = args.rig.read()?;
    let panels = args.rig.panels(&rig);
    let size = source_size(args.source.as_deref())?
        .told()
        .unwrap_or(SOURCE);
    let fit = args.rig.fit(&rig, &panels, Some(size))?;
    let gpu = Gpu::open_blocking().context("panels bench draws on a GPU")?;
    let picture = GeneratedWorld::gratings(0).placed(0, &fit.placement, size);
    let stage = Stage {
        warper: Warper::new(&gpu),
        source: SourceTexture::new(&gpu, size, true)?,
        timer: Timer::new(&gpu),
        gpu,
    };
    stage.source.write(&stage.gpu, &opaque(&picture))?;
    let filters: &[FilterName] = match args.mode {
        None => &[FilterName::Auto, FilterName::Trilinear, FilterName::Feline],
        Some(WarpModeName::Seed) => &[FilterName::Trilinear, FilterName::Feline],
    };
    let maps = match args.mode {
        None => Vec::new(),
        Some(WarpModeName::Seed) => seed_maps(&panels, &fit.placement, size),
    };
    let mut rows = Vec::new();
    for count in args.counts() {
        let many = Many::of(&stage.gpu, &panels, *count)?;
        let plan = many.plan(&fit.placement, size, &maps);
        let loaded = match stage.warper.load(&plan) {
            Err(error) if is_for_lack_of_room(&error) => {
                output::say(&format!("{count} panels are not drawn: {error}"));
                None
            }
            loaded => Some(loaded?),
        };
        for filter in filters {
            let style = WarpStyle {
                filter: filter.of_pass().unwrap_or_default(),
                paints: false,
            };
            let (gpu_ms, wall_ms) = match &loaded {
                Some(loaded) => stage.timed(loaded, &style, args.runs)?,
                None => (None, None),
            };
            let maps = many.map_bytes(*filter, args.mode, &plan);
            rows.push(PanelsRow {
                panels: *count,
                filter: filter.name(),
                gpu_ms,
                wall_ms,
                bytes_per_pixel: 4.0
                    + many.source_bytes(&fit.placement, size)
                    + maps / many.pixels(),
                map_mib: maps / f64::from(1 << 20),
            });
        }
    }
    let result = PanelsBench {
        adapter: stage.gpu.adapter_name().to_owned(),
        clock: if stage.timer.is_some() { "gpu" } else { "wall" },
        rows,
        model: args.model.map(|_| args.modelled()),
    };
    output::result(args.json, &result, &result.text())
}

impl PanelsBenchArgs {
    fn check(&self) -> anyhow::Result<()> {
        let most = MOST_PANELS as u32;
        if let Some(wrong) = self.counts().iter().find(|it| !(1..=most).contains(*it)) {
            bail!(out_of_range(
                "--panels",
                wrong,
                &format!("numbers of 1 to {most}")
            ));
        }
        if !(self.texel_rate > 0.0 && self.texel_rate.is_finite()) {
            let range = "million texels a second, as 26400";
            bail!(out_of_range("--texel-rate", self.texel_rate, range));
        }
        Ok(())
    }

    /// How many panels are timed, in turn.
    fn counts(&self) -> &[u32] {
        match (&self.panels, self.model) {
            (Some(panels), _) => panels,
            (None, Some(_)) => &[],
            (None, None) => &PANELS,
        }
    }

    fn modelled(&self) -> FillModel {
        let texels = self.texel_rate * 1e6;
        let [trilinear, feline] =
            MODEL_FETCHES.map(|fetches| panels_by_fill_rate(texels, MODEL_PIXELS, fetches));
        FillModel {
            panels_trilinear: trilinear,
            panels_feline: feline,
            panels_corrected: texels / (MODEL_PIXELS * REAL_SAMPLES * 60.0),
        }
    }
}

/// Whether fewer panels would be drawn.
fn is_for_lack_of_room(error: &RenderError) -> bool {
    matches!(
        error,
        RenderError::TooMuch { .. } | RenderError::OutOfMemory { .. }
    )
}

/// The seed's maps of panels before all of a source.
fn seed_maps(panels: &[&Panel], placement: &Placement, size: [u32; 2]) -> Vec<Vec<SeedTexel>> {
    let on = |panel: &&Panel| {
        seed_map(&PanelOnSource {
            panel,
            placement,
            part: [0, 0, size[0], size[1]],
            origin: [0; 2],
        })
    };
    panels.iter().map(on).collect()
}

/// What is drawn with, and from.
struct Stage {
    gpu: Gpu,
    warper: Warper,
    source: SourceTexture,
    timer: Option<Timer>,
}

impl Stage {
    /// Median milliseconds by the device's clock, and until it is done.
    fn timed(
        &self,
        plan: &LoadedPlan,
        style: &WarpStyle,
        runs: u32,
    ) -> anyhow::Result<(Option<f64>, Option<f64>)> {
        let (mut by_gpu, mut by_wall) = (Vec::new(), Vec::new());
        let begun = Instant::now();
        // The first one warms up.
        for run in 0..=runs {
            if run > 1 && begun.elapsed().as_secs_f64() > LONGEST_S {
                break;
            }
            let start = Instant::now();
            let mut encoder = self.gpu.encoder("bench");
            let timer = self.timer.as_ref();
            self.warper
                .record(&mut encoder, plan, &self.source, style, timer);
            let stamps = BytesBack::buffer(&self.gpu, Timer::BYTES);
            if let Some(timer) = timer {
                timer.copy(&mut encoder, &stamps, 0);
            }
            self.gpu.submit(encoder);
            let bytes = BytesBack::map(stamps).wait(&self.gpu)?;
            let wall = start.elapsed();
            if run > 0 {
                let between = timer.and_then(|it| it.tick().between(&bytes));
                by_gpu.extend(between.map(|it| it.as_secs_f64() * 1000.0));
                by_wall.push(wall.as_secs_f64() * 1000.0);
            }
        }
        Ok((median(by_gpu), median(by_wall)))
    }
}

fn median(mut all: Vec<f64>) -> Option<f64> {
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied()
}

/// Panels of a rig, again and again, in a square of an atlas.
struct Many<'a> {
    placed: Vec<(&'a Panel, [u32; 2])>,
}

impl<'a> Many<'a> {
    fn of(gpu: &Gpu, panels: &[&'a Panel], count: u32) -> anyhow::Result<Self> {
        let side = |k: usize| panels.iter().map(|it| it.sent_size()[k]).max().unwrap_or(1);
        let cell = [side(0), side(1)];
        let most = gpu.device.limits().max_texture_dimension_2d;
        let fits = cell.map(|side| most / side);
        if fits[0] * fits[1] < count {
            bail!(WrongUsage(format!(
                "--panels {count}: {} panels of {}x{} pixels fit into an atlas of this device, \
                 which draws {most} pixels on a side (its max_texture_dimension_2d); give fewer",
                fits[0] * fits[1],
                cell[0],
                cell[1]
            )));
        }
        let square = f64::from(count) * f64::from(cell[1]) / f64::from(cell[0]);
        let columns = (square.sqrt().ceil() as u32).clamp(count.div_ceil(fits[1]), fits[0]);
        let place = |k: u32| {
            let panel = panels[k as usize % panels.len()];
            (panel, [k % columns * cell[0], k / columns * cell[1]])
        };
        Ok(Self {
            placed: (0..count).map(place).collect(),
        })
    }

    /// By maps of the panels of the rig, or by matrices where there are none.
    fn plan(&self, placement: &Placement, size: [u32; 2], maps: &[Vec<SeedTexel>]) -> WarpPlan {
        let on = |(panel, origin): &(&'a Panel, [u32; 2])| PanelOnSource {
            panel,
            placement,
            part: [0, 0, size[0], size[1]],
            origin: *origin,
        };
        let all: Vec<PanelOnSource<'_>> = self.placed.iter().map(on).collect();
        let plan = WarpPlan::new(&all);
        match maps.is_empty() {
            true => plan,
            false => {
                let maps = maps.iter().map(Vec::as_slice).cycle();
                plan.by_seed_maps(&maps.take(all.len()).collect::<Vec<_>>())
            }
        }
    }

    fn pixels(&self) -> f64 {
        self.placed.iter().map(|it| it.0.pixels()).sum()
    }

    /// Bytes of maps: as the seed counts them, or what the pass reads.
    fn map_bytes(&self, filter: FilterName, mode: Option<WarpModeName>, plan: &WarpPlan) -> f64 {
        match (mode, filter) {
            (None, _) => plan.bytes() as f64,
            (Some(WarpModeName::Seed), FilterName::Feline) => 12.0 * self.pixels(),
            (Some(WarpModeName::Seed), _) => 8.0 * self.pixels(),
        }
    }

    /// Bytes of the source that a pixel reads first: neighbours share what is magnified, and what
    /// is minified is read from a level about as fine as the panel.
    fn source_bytes(&self, placement: &Placement, size: [u32; 2]) -> f64 {
        let bytes = self.placed.iter().map(|(panel, _)| {
            let map = PixelMap {
                panel,
                placement,
                size,
            };
            4.0 * covered(&map).min(panel.pixels())
        });
        bytes.sum::<f64>() / self.pixels()
    }
}

impl PanelsBench {
    fn text(&self) -> String {
        let mut text = format!("{} (clock: {})\n", self.adapter, self.clock);
        for row in &self.rows {
            let told = |ms: Option<f64>| ms.map_or("-".to_owned(), |ms| format!("{ms:.3}"));
            let [gpu, wall] = [row.gpu_ms, row.wall_ms].map(told);
            let _ = writeln!(
                text,
                "{:>5} panels  {:<11}  GPU {gpu:>9} ms  wall {wall:>9} ms  {:>5.2} B/pixel  maps \
                 {:.2} MiB",
                row.panels, row.filter, row.bytes_per_pixel, row.map_mib
            );
        }
        if let Some(model) = &self.model {
            let _ = writeln!(
                text,
                "by the seed's model {:.2} panels trilinear, {:.2} Feline; as sampled {:.0}",
                model.panels_trilinear, model.panels_feline, model.panels_corrected
            );
        }
        text
    }
}
