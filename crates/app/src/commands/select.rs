//! What would be chosen, without content?

use crate::gaze_source::{GazeChoice, GazeSource, TrackerOptions, ViewerModel, parse_gaze};
use crate::options::panels::{
    NamedPanel, PanelsOptions, SAMPLES_ONE_VIEW, ShownRig, around_the_head,
};
use crate::options::policy::{
    CutOptions, MappingName, PolicyOptions, ViewOptions, check_thresholds, parse_size,
};
use crate::options::preset::SystemPreset;
use crate::options::showing::EyeName;
use crate::options::unused::Given;
use crate::report::output::{self, WrongUsage, out_of_range};
use anyhow::bail;
use clap::{Args, ValueEnum};
use foveal_core::content::demand::Demand;
use foveal_core::content::head::ContentHead;
use foveal_core::content::opened::ContentFacts;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::demand::VideoDemand;
use foveal_core::content::video::grid::tile_grid::TileGrid;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::moment::Moment;
use foveal_core::units::{Radians, Seconds, counted};
use foveal_core::view::axes::yaw_pitch_from_direction;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::head_pose::HeadPose;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::random::Random;
use foveal_core::view::surface::{Projection, Surface};
use foveal_render::sample_count;
use glam::DVec3;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProjectionName {
    Flat,
    Cube,
    Equirect,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct SelectArgs {
    /// How the content surrounds the eye.
    #[arg(long, value_enum)]
    projection: ProjectionName,
    /// Cube: pixels on a side of a face.
    #[arg(long, value_name = "PX")]
    face_size: Option<u32>,
    /// Cube: how pixels lie over a face (default: equi-angular, and what a preset has).
    #[arg(long, value_enum)]
    mapping: Option<MappingName>,
    /// Flat and equirect: pixels of the picture.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Faces that the share is counted over (Kastner 2016 counts four of six).
    #[arg(long, value_name = "N")]
    source_faces: Option<u32>,
    #[command(flatten)]
    cut: CutOptions,
    #[command(flatten)]
    policy: PolicyOptions,
    /// Cut and choose as a published system does.
    #[arg(long, value_enum, value_name = "NAME")]
    preset: Option<SystemPreset>,
    #[command(flatten)]
    view: ViewOptions,
    #[command(flatten)]
    panels: PanelsOptions,
    /// Whose panels, of a rig for two eyes.
    #[arg(long, value_enum, default_value = "left", requires = "panels")]
    eye: EyeName,
    /// YAW,PITCH in degrees (to the right and up), or any other gaze at its beginning: center,
    /// scan, trace:FILE, head:FILE, udp:PORT, ws:URL or osc:PORT.
    #[arg(
        long,
        value_name = "G",
        default_value = "center",
        allow_hyphen_values = true
    )]
    #[arg(value_parser = parse_gaze)]
    gaze: GazeChoice,
    #[command(flatten)]
    tracker: TrackerOptions,
    /// Select for this many gazes, uniform on the content.
    #[arg(long, value_name = "N", conflicts_with = "gaze")]
    random_gazes: Option<u32>,
    /// Seed of the random gazes and of the scan path.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What one gaze takes.
#[derive(Debug, Serialize)]
struct One {
    pixels: u64,
    pixels_share: f64,
    level_histogram: Vec<u32>,
}

/// What many gazes take.
#[derive(Debug, Serialize)]
struct Many {
    gazes: usize,
    pixels_mean: f64,
    pixels_share_mean: f64,
    pixels_share_p95: f64,
    pixels_share_max: f64,
    level_histogram_mean: Vec<f64>,
}

/// Either, and the panels that it was chosen for.
#[derive(Debug, Serialize)]
struct Selected<T> {
    #[serde(flatten)]
    result: T,
    #[serde(skip_serializing_if = "Option::is_none")]
    panels: Option<Vec<NamedPanel>>,
}

/// What bounds what is worth choosing.
enum Bounding {
    /// Nothing: all of it is in view.
    Nothing,
    /// A view that is turned to each gaze.
    View(EyeView),
    /// Panels of a head that is.
    Panels(Vec<MountedPanel>, Vec<NamedPanel>),
}

/// Most random gazes of one run.
const MOST_GAZES: u32 = 1_000_000;

pub(crate) fn run(args: &SelectArgs, given: &Given) -> anyhow::Result<()> {
    let is_flat = args.projection == ProjectionName::Flat;
    let named = args.policy.named();
    given.say_unused((&ContentFacts::VIDEO, is_flat), (named, Policy::Acuity));
    let rig = args.panels.read(args.eye)?;
    let args = &args.before(rig.as_ref())?;
    let panels = rig.map(|rig| rig.panels);
    let surface = args.surface()?;
    let args = &args.with_preset(&surface);
    let levels = args.cut.levels.unwrap_or(5);
    let grid = TileGrid::new(surface, args.cut.cut(&surface), levels, args.cut.ratio())
        .map_err(|error| WrongUsage(error.to_string()))?;
    let config = args.config(&grid)?;
    let bounding = args.bounding(&surface, config.policy, panels)?;
    let samples = match config.policy {
        Policy::Sampled => Some(sample_count(&config, &args.view.eye_view(&surface)?)),
        _ => None,
    };
    let mut demand = VideoDemand::of_head(&ContentHead::of_video(grid), &config);
    let faces = args.faces(&surface)?;
    let source = f64::from(faces) * f64::from(surface.size[0]) * f64::from(surface.size[1]);
    let mut choose = |gaze: GazeSample| {
        let moment = Moment::new(gaze, bounding.views(&gaze, &surface));
        let chosen = demand.needed(0, &moment).record;
        let pixels = samples.map_or(chosen.samples, u64::from);
        One {
            pixels,
            pixels_share: pixels as f64 / source,
            level_histogram: chosen.per_level,
        }
    };
    let panels = bounding.names();
    match args.random_gazes {
        Some(count) if !(1..=MOST_GAZES).contains(&count) => {
            bail!(out_of_range(
                "--random-gazes",
                count,
                &format!("1 to {MOST_GAZES}")
            ))
        }
        Some(count) => {
            let mut random = Random::new(args.seed);
            let gazes = (0..count).map(|_| random_gaze(&surface, &mut random));
            let result = summarise(gazes.map(choose).collect());
            let text = result.text();
            output::result(args.json, &Selected { result, panels }, &text)
        }
        None => {
            let start = Seconds(0.0);
            let viewer = ViewerModel::default();
            let gaze = args.tracker.read_as(&args.gaze)?;
            let mut source = GazeSource::new(&gaze, &surface, args.seed, start, &viewer)?;
            let result = choose(source.look(start).gaze);
            let text = result.text();
            output::result(args.json, &Selected { result, panels }, &text)
        }
    }
}

impl SelectArgs {
    /// These options with those that panels stand for.
    fn before(&self, rig: Option<&ShownRig>) -> anyhow::Result<Self> {
        let mut with = self.clone();
        if let Some(rig) = rig {
            let shape = self
                .size
                .filter(|_| self.projection == ProjectionName::Flat);
            if let Some(screen) = self.panels.screen(rig, shape)? {
                with.view.screen = screen;
            }
            if self.preset.is_none() {
                with.policy = self.policy.seen_by_many(&rig.panels);
            }
        }
        Ok(with)
    }

    /// These options with those that the preset stands for.
    fn with_preset(&self, surface: &Surface) -> Self {
        let mut with = self.clone();
        if let Some(preset) = self.preset {
            with.cut = preset.cut(&self.cut);
            with.policy = preset.policy(&self.policy, surface.projection);
        }
        // Without content no unit can be weighed.
        with.policy = with
            .policy
            .under(with.policy.named().unwrap_or(Policy::Acuity));
        with
    }

    /// How levels are chosen; refuses what needs content.
    fn config(&self, grid: &TileGrid) -> anyhow::Result<PolicyConfig> {
        let config = self.policy.config()?;
        check_thresholds(&config, grid)?;
        if config.needs_cues() {
            bail!(WrongUsage(
                "--noise-threshold asks for the variance of a pack's cells: foveal simulate PACK \
                 --policy grid --noise-threshold V; without content give --noisy-cells N"
                    .to_owned()
            ));
        }
        if config.policy.spends_a_budget() {
            bail!(WrongUsage(format!(
                "--policy {0} weighs the units of a pack: foveal simulate PACK --policy {0}",
                self.policy.policy().name()
            )));
        }
        // Every gaze is chosen for by itself: none is steadied by the one before.
        Ok(PolicyConfig {
            steadiness: Radians(0.0),
            together: self.panels.panels.is_some(),
            ..config.without_signatures()
        })
    }

    /// Faces that the share is counted over.
    fn faces(&self, surface: &Surface) -> anyhow::Result<u32> {
        match self.source_faces {
            None => Ok(surface.faces()),
            Some(faces) if (1..=surface.faces()).contains(&faces) => Ok(faces),
            Some(faces) => {
                let range = format!("1 to {}", surface.faces());
                bail!(out_of_range("--source-faces", faces, &range))
            }
        }
    }

    fn mapping(&self) -> MappingName {
        match self.preset {
            Some(preset) => preset.mapping(self.mapping),
            None => self.mapping.unwrap_or(MappingName::EquiAngular),
        }
    }

    fn surface(&self) -> anyhow::Result<Surface> {
        Ok(match self.projection {
            ProjectionName::Cube => Surface::cube(
                self.face_size
                    .ok_or_else(|| wrong("--projection cube needs --face-size PX"))?,
            )
            .mapped(self.mapping().mapping()),
            ProjectionName::Flat => {
                let size = self.size_of_picture("flat")?;
                Surface::flat(size, self.view.screen)
            }
            ProjectionName::Equirect => Surface::equirect(self.size_of_picture("equirect")?),
        })
    }

    fn size_of_picture(&self, projection: &str) -> anyhow::Result<[u32; 2]> {
        if self.mapping.is_some() || self.face_size.is_some() {
            let cubes = "--mapping and --face-size are of cubes: leave them out, or give \
                         --projection cube";
            bail!(wrong(cubes));
        }
        let needed = || wrong(&format!("--projection {projection} needs --size WxH"));
        Ok(self.size.ok_or_else(needed)?)
    }

    /// What bounds what is worth choosing: a view only where one was asked for, or needed.
    fn bounding(
        &self,
        surface: &Surface,
        policy: Policy,
        panels: Option<Vec<Panel>>,
    ) -> anyhow::Result<Bounding> {
        if let Some(panels) = panels {
            if policy == Policy::Sampled {
                bail!(wrong(SAMPLES_ONE_VIEW));
            }
            let names = panels.iter().map(NamedPanel::of).collect();
            return Ok(Bounding::Panels(around_the_head(&panels), names));
        }
        if self.view.view.is_some() {
            return self.view.eye_view(surface).map(Bounding::View);
        }
        if policy != Policy::Viewport {
            return Ok(Bounding::Nothing);
        }
        // Without pixels of its own the view is at least as dense as any content.
        let view = self.view.eye_view(surface)?;
        Ok(Bounding::View(EyeView {
            size: [1 << 20; 2],
            field: Field { ..view.field },
            ..view
        }))
    }
}

impl Bounding {
    /// The views, turned so that their middle, or the head's forward, meets the gaze; flat content
    /// stays before the eye.
    fn views(&self, gaze: &GazeSample, surface: &Surface) -> Vec<EyeView> {
        let (yaw, pitch) = yaw_pitch_from_direction(gaze.gaze_in_content);
        let head = HeadPose {
            yaw,
            pitch,
            roll: Radians(0.0),
        };
        match self {
            Self::Nothing => Vec::new(),
            Self::View(view) => vec![match surface.projection {
                Projection::Flat => *view,
                Projection::Cube | Projection::Equirect => EyeView {
                    axes: head.axes(),
                    ..*view
                },
            }],
            Self::Panels(panels, _) => {
                let head = match surface.projection {
                    Projection::Flat => HeadPose::default(),
                    Projection::Cube | Projection::Equirect => head,
                };
                MountedPanel::views_from(panels, &head, DVec3::ZERO)
            }
        }
    }

    fn names(&self) -> Option<Vec<NamedPanel>> {
        match self {
            Self::Panels(_, names) => Some(names.clone()),
            Self::Nothing | Self::View(_) => None,
        }
    }
}

fn wrong(what: &str) -> WrongUsage {
    WrongUsage(what.to_owned())
}

fn random_gaze(surface: &Surface, random: &mut Random) -> GazeSample {
    let forward = GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0));
    let gaze_in_content = match surface.projection {
        Projection::Cube | Projection::Equirect => random.direction(),
        Projection::Flat => {
            let [w, h] = surface.size.map(f64::from);
            surface.direction(0, [w * random.unit(), h * random.unit()])
        }
    };
    GazeSample {
        gaze_in_content,
        ..forward
    }
}

fn summarise(mut all: Vec<One>) -> Many {
    all.sort_by_key(|one| one.pixels);
    let count = all.len() as f64;
    let p95 = (all.len() * 95).div_ceil(100).max(1) - 1;
    let mean = |value: &dyn Fn(&One) -> f64| all.iter().map(value).sum::<f64>() / count;
    let levels = all.first().map_or(0, |one| one.level_histogram.len());
    Many {
        gazes: all.len(),
        pixels_mean: mean(&|one| one.pixels as f64),
        pixels_share_mean: mean(&|one| one.pixels_share),
        pixels_share_p95: all.get(p95).map_or(0.0, |one| one.pixels_share),
        pixels_share_max: all.last().map_or(0.0, |one| one.pixels_share),
        level_histogram_mean: (0..levels)
            .map(|level| mean(&|one| f64::from(one.level_histogram[level])))
            .collect(),
    }
}

impl One {
    fn text(&self) -> String {
        let mut text = format!(
            "{}, {:.2} % of the faces counted at the finest level\n",
            counted(self.pixels, "pixel"),
            self.pixels_share * 100.0
        );
        for (level, tiles) in self.level_histogram.iter().enumerate() {
            let _ = writeln!(text, "level {level}: {}", counted(tiles, "tile"));
        }
        text
    }
}

impl Many {
    fn text(&self) -> String {
        format!(
            "{}: mean {:.2} %, 95th percentile {:.2} %, most {:.2} % of the finest level",
            counted(self.gazes, "gaze"),
            self.pixels_share_mean * 100.0,
            self.pixels_share_p95 * 100.0,
            self.pixels_share_max * 100.0,
        )
    }
}
