//! What does each panel of a rig show of one source?

use crate::commands::panels::comparing::{PanelJudge, PanelScore};
use crate::commands::panels::filter_name::FilterName;
use crate::commands::panels::rig_args::{PlacementName, RigArgs, source_size};
use crate::commands::panels::sent::{SentLayout, as_seen};
use crate::commands::panels::warp_device::WarpDevice;
use crate::commands::panels::warp_source::{EyePart, PanelSource, StereoName, opaque};
use crate::options::renderer::RendererName;
use crate::report::output::{self, WrongUsage, out_of_range};
use crate::report::picture_file::write_png;
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use foveal_core::units::counted;
use foveal_core::view::panel::fit::{SourceFit, SourceSize};
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::rig::{Panel, Rig};
use foveal_core::view::panel::seed::SeedTexel;
use foveal_core::view::panel::share::multi_probe_share;
use foveal_core::view::surface::Eye;
use foveal_media::generate::FRAMES_PER_SECOND;
use foveal_render::RgbaImage;
use foveal_render::warp::{PanelOnSource, WarpPlan};
use glam::DVec3;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Most of Feline's samples of a pixel.
const MOST_PROBES: u32 = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WarpModeName {
    /// As seed 002's program: two maps of 16.16 bits a panel, and derivatives of 8.
    Seed,
}

/// Fills all panels of a rig from one source.
///
/// A world is drawn for each eye, as large as no panel magnifies it unless --source is given; a
/// file lies where all panels of --eye see it.
#[derive(Clone, Debug, Args)]
pub(crate) struct WarpArgs {
    #[command(flatten)]
    rig: RigArgs,
    /// A picture, a video file, world:valley or world:gratings.
    source_name: String,
    /// The folder for ID.png a panel, as the eye sees it, and atlas.png, as it is sent; moving
    /// sources give ID/frame_00000.png and so on.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How the source is filtered (default: auto; with --mode seed trilinear).
    #[arg(long, value_enum)]
    filter: Option<FilterName>,
    /// By maps instead of matrices; the source then lies as in seed 002 unless --placement says
    /// otherwise.
    #[arg(long, value_enum)]
    mode: Option<WarpModeName>,
    /// Stop after this many frames (default: all of a video, 1 of a world).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// How the two eyes' pictures lie in the source.
    #[arg(long, value_enum, default_value = "mono")]
    stereo: StereoName,
    /// How far a mono source lies before the head (default: infinitely far).
    #[arg(long, value_name = "METRES")]
    distance: Option<f64>,
    /// Size of a world's picture for each eye as 1600x1200, or a picture or video that has it
    /// (default: as many pixels as are needed).
    #[arg(long, value_name = "WxH|FILE")]
    source: Option<String>,
    /// Also draw each panel of a world directly, compare, and write both beside each other to
    /// DIR/compare.
    #[arg(long)]
    compare: bool,
    /// Paint pixels of which Feline takes more than one sample.
    #[arg(long)]
    show_anisotropy: bool,
    /// What draws.
    #[arg(long, value_enum, default_value = "gpu")]
    renderer: RendererName,
    /// One JSON object on stdout.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct WarpResult {
    frames: u32,
    /// Frames of the source that were not drawn: none of files and worlds.
    dropped: u32,
    filter: String,
    placement: &'static str,
    adapter: String,
    /// Columns and rows of the source, of both eyes.
    source: [u32; 2],
    multi_probe_share: f64,
    panels: Vec<WarpedPanel>,
}

#[derive(Serialize)]
struct WarpedPanel {
    id: String,
    #[serde(flatten)]
    score: Option<PanelScore>,
}

/// Where each panel's part of the source lies.
struct Laid {
    placement: &'static str,
    size: [u32; 2],
    parts: Vec<EyePart>,
}

pub(crate) fn run(args: &WarpArgs) -> anyhow::Result<()> {
    args.check()?;
    let rig = args.rig.read()?;
    let mut source = PanelSource::open(&args.source_name)?;
    args.check_source(&source)?;
    let all = args.rig.panels(&rig);
    // A comparison judges the warp alone: what dims or fades a panel is left out of both.
    let plain: Vec<Panel> = all.iter().map(|panel| args.judged(panel)).collect();
    let panels: Vec<&Panel> = plain.iter().collect();
    let laid = args.lay(&rig, &panels, &source)?;
    let layout = SentLayout::of(&panels);
    let plan = args.plan(&panels, &laid, &layout);
    let filter = args.filter_name();
    let device = WarpDevice::open(
        args.renderer,
        plan,
        laid.size,
        (filter, args.show_anisotropy),
    )?;
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("--out {}: the folder cannot be made", args.out.display()))?;
    let several = source.moves() && (args.frames.is_some() || source.world().is_none());
    let most = match source.world() {
        Some(_) => args.frames.unwrap_or(1),
        None => args.frames.unwrap_or(u32::MAX),
    };
    let mut judges = args.judges(&panels, several)?;
    let mut frames = 0;
    while frames < most {
        let Some(picture) = source.frame(frames, &laid.parts)? else {
            break;
        };
        let atlas = device.fill(&picture)?;
        let file = |name: &str| match several {
            true => args.out.join(name).join(format!("frame_{frames:05}.png")),
            false => args.out.join(format!("{name}.png")),
        };
        for (name, surface) in layout.surfaces(&atlas) {
            write_picture(&file(&name), &surface)?;
        }
        for (k, panel) in panels.iter().enumerate() {
            let seen = as_seen(panel, &atlas, layout.origins[k]);
            write_picture(&file(&panel.id), &seen)?;
            if let (Some(judge), Some(world)) = (judges.get_mut(k), source.world()) {
                let placement = &laid.of(panel).placement;
                let direct = opaque(&world.on_panel(u64::from(frames), panel, placement));
                judge.frame(&direct, &seen)?;
                let sheet = file(&format!("compare/{}", panel.id));
                write_picture(&sheet, &seen.beside(&direct))?;
            }
        }
        frames += 1;
    }
    let result = WarpResult {
        frames,
        dropped: 0,
        filter: filter.name(),
        placement: laid.placement,
        adapter: device.name().to_owned(),
        source: laid.size,
        multi_probe_share: laid.multi_probe_share(&panels),
        panels: warped(&panels, &judges)?,
    };
    output::result(args.json, &result, &result.text(args))
}

fn warped(panels: &[&Panel], judges: &[PanelJudge]) -> anyhow::Result<Vec<WarpedPanel>> {
    let scores = judges.iter().map(|judge| judge.score().map(Some));
    let scores = scores.chain(std::iter::repeat_with(|| Ok(None)));
    panels
        .iter()
        .zip(scores)
        .map(|(panel, score)| {
            Ok(WarpedPanel {
                id: panel.id.clone(),
                score: score?,
            })
        })
        .collect()
}

fn write_picture(path: &std::path::Path, image: &RgbaImage) -> anyhow::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
    }
    write_png(path, image)
}

impl WarpArgs {
    fn check(&self) -> anyhow::Result<()> {
        if let Some(distance) = self.distance
            && !(0.05..=1e6).contains(&distance)
        {
            bail!(out_of_range(
                "--distance",
                distance,
                "0.05 to 1000000 metres"
            ));
        }
        if self.distance.is_some() && self.stereo != StereoName::Mono {
            bail!(WrongUsage(
                "--distance: each eye has its own picture, which tells how far things are; leave \
                 --stereo or --distance"
                    .to_owned()
            ));
        }
        Ok(())
    }

    fn check_source(&self, source: &PanelSource) -> anyhow::Result<()> {
        let is_world = source.world().is_some();
        let wrong = |text: String| Err(WrongUsage(text).into());
        match source.size() {
            Some([w, h]) if self.source.is_some() => wrong(format!(
                "--source: {} has its own size, {w}x{h}; leave it out",
                self.source_name
            )),
            _ if self.compare && !is_world => wrong(format!(
                "--compare: {} is a picture already and cannot be drawn directly; give \
                 world:valley or world:gratings",
                self.source_name
            )),
            _ if self.compare && self.show_anisotropy => wrong(
                "--compare: --show-anisotropy paints over what is compared; leave one".to_owned(),
            ),
            _ if is_world && self.stereo != StereoName::Mono => {
                wrong("--stereo: a world is drawn for each eye; leave it out".to_owned())
            }
            _ => Ok(()),
        }
    }

    fn filter_name(&self) -> FilterName {
        self.filter.unwrap_or(match self.mode {
            Some(WarpModeName::Seed) => FilterName::Trilinear,
            None => FilterName::Auto,
        })
    }

    /// Places a source of a size, or of any, before panels.
    fn fit(&self, rig: &Rig, panels: &[&Panel], source: SourceSize) -> anyhow::Result<SourceFit> {
        let mut args = self.rig.clone();
        if self.mode.is_some() && args.placement == PlacementName::Auto {
            args.placement = PlacementName::Seed;
        }
        args.fit(rig, panels, source)
    }

    fn judged(&self, panel: &Panel) -> Panel {
        match self.compare {
            false => panel.clone(),
            true => Panel {
                blend: 0.0,
                alpha: None,
                gain: [1.0; 3],
                black: 0.0,
                ..panel.clone()
            },
        }
    }

    /// Places the source before the eyes: a world for each by itself, a file before all panels.
    fn lay(&self, rig: &Rig, panels: &[&Panel], source: &PanelSource) -> anyhow::Result<Laid> {
        if panels.is_empty() {
            bail!(WrongUsage(format!(
                "{}: no panel is seen by this eye; choose another --eye",
                self.rig.rig.display()
            )));
        }
        let mut laid = match source.size() {
            Some(size) => self.lay_file(rig, panels, size)?,
            None => self.lay_world(rig, panels)?,
        };
        if let Some(distance) = self.distance {
            for it in &mut laid.parts {
                let side = match it.eye {
                    Eye::Left => -0.5,
                    Eye::Right => 0.5,
                };
                let eye = DVec3::X * (side * rig.ipd);
                it.placement = it.placement.seen_from(eye, distance);
            }
        }
        Ok(laid)
    }

    fn lay_file(&self, rig: &Rig, panels: &[&Panel], size: [u32; 2]) -> anyhow::Result<Laid> {
        let [w, h] = size;
        let parts = match self.stereo {
            StereoName::Mono => [[0, 0, w, h]; 2],
            StereoName::Sbs => [[0, 0, w / 2, h], [w / 2, 0, w / 2, h]],
            StereoName::Tb => [[0, 0, w, h / 2], [0, h / 2, w, h / 2]],
        };
        if parts[0].contains(&0) && parts[0][2..].contains(&0) {
            bail!(
                "{}: {w}x{h} pixels have no two halves; leave --stereo",
                self.source_name
            );
        }
        let found = self.fit(rig, panels, SourceSize::Picture([parts[0][2], parts[0][3]]))?;
        let eyes = [Eye::Left, Eye::Right];
        let part = |(eye, part)| EyePart {
            eye,
            placement: found.placement,
            part,
        };
        Ok(Laid {
            placement: found.name,
            size,
            parts: eyes.into_iter().zip(parts).map(part).collect(),
        })
    }

    fn lay_world(&self, rig: &Rig, panels: &[&Panel]) -> anyhow::Result<Laid> {
        let size = source_size(self.source.as_deref())?;
        let mut laid = Laid {
            placement: "",
            size: [0; 2],
            parts: Vec::new(),
        };
        for eye in [Eye::Left, Eye::Right] {
            let of_eye: Vec<&Panel> = panels
                .iter()
                .copied()
                .filter(|it| it.view.eye == eye)
                .collect();
            if of_eye.is_empty() {
                continue;
            }
            let found = self.fit(rig, &of_eye, size)?;
            let [w, h] = found.size;
            // Below what is there: sources are wider than high, and devices draw squares.
            laid.parts.push(EyePart {
                eye,
                placement: found.placement,
                part: [0, laid.size[1], w, h],
            });
            laid.placement = found.name;
            laid.size = [laid.size[0].max(w), laid.size[1] + h];
        }
        Ok(laid)
    }

    fn plan(&self, panels: &[&Panel], laid: &Laid, layout: &SentLayout) -> WarpPlan {
        let placed: Vec<PanelOnSource<'_>> = panels
            .iter()
            .zip(&layout.origins)
            .map(|(panel, origin)| PanelOnSource {
                panel,
                placement: &laid.of(panel).placement,
                part: laid.of(panel).part,
                origin: *origin,
            })
            .collect();
        let plan = WarpPlan::new(&placed);
        match self.mode {
            None => plan,
            Some(WarpModeName::Seed) => {
                let maps: Vec<Vec<SeedTexel>> = placed.iter().map(seed_map).collect();
                plan.by_seed_maps(&maps)
            }
        }
    }

    fn judges(&self, panels: &[&Panel], moves: bool) -> anyhow::Result<Vec<PanelJudge>> {
        if !self.compare {
            return Ok(Vec::new());
        }
        let fps = moves.then_some(f64::from(FRAMES_PER_SECOND));
        panels
            .iter()
            .map(|panel| PanelJudge::new(panel, fps))
            .collect()
    }
}

/// The seed's texels of a panel, in the order in which its pixels are sent.
pub(super) fn seed_map(it: &PanelOnSource<'_>) -> Vec<SeedTexel> {
    let [left, top, width, height] = it.part;
    let map = PixelMap {
        panel: it.panel,
        placement: it.placement,
        size: [width, height],
    };
    let back = it.panel.scanout.seen_from_sent(it.panel.view.size);
    let [columns, rows] = it.panel.sent_size();
    let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let texel = |[column, row]: [u32; 2]| {
        let seen = back * DVec3::new(f64::from(column) + 0.5, f64::from(row) + 0.5, 1.0);
        let mut texel = SeedTexel::of(&map, [seen.x as u32, seen.y as u32]);
        // The part of this eye.
        let from = [left, top].map(|k| u16::try_from(k).unwrap_or(u16::MAX));
        texel.whole = [0, 1].map(|k| texel.whole[k].saturating_add(from[k]));
        texel
    };
    pixels.map(texel).collect()
}

impl Laid {
    /// The part that a panel looks at.
    fn of(&self, panel: &Panel) -> &EyePart {
        let own = self.parts.iter().find(|it| it.eye == panel.view.eye);
        own.unwrap_or(&self.parts[0])
    }

    fn multi_probe_share(&self, panels: &[&Panel]) -> f64 {
        let (mut several, mut pixels) = (0.0, 0.0);
        for panel in panels {
            let it = self.of(panel);
            let size = [it.part[2], it.part[3]];
            let share = multi_probe_share(&[*panel], &it.placement, size, MOST_PROBES);
            several += share * panel.pixels();
            pixels += panel.pixels();
        }
        several / pixels
    }
}

impl WarpResult {
    fn text(&self, args: &WarpArgs) -> String {
        let [w, h] = self.source;
        let mut text = format!(
            "{}, {} of {w}x{h}, {} ({}); Feline takes several samples of {:.1} % of pixels\n",
            counted(u64::from(self.frames), "frame"),
            self.placement,
            self.filter,
            self.adapter,
            100.0 * self.multi_probe_share
        );
        for panel in &self.panels {
            let Some(score) = &panel.score else { continue };
            let psnr = score
                .psnr_db
                .map_or("equal".to_owned(), |it| format!("{it:.2} dB"));
            let _ = writeln!(
                text,
                "{:>12}  {psnr}  SSIM {:.4}  FLIP {:.4}  {:.2} JOD",
                panel.id, score.ssim, score.flip, score.jod
            );
        }
        let _ = writeln!(text, "written to {}", args.out.display());
        text
    }
}
