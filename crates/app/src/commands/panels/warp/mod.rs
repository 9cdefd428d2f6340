//! What does each panel of a rig show of one source?

pub(crate) mod args;
mod device;
mod eye;
pub(crate) mod laid;
pub(crate) mod sent;
pub(crate) mod source;
mod window;

use crate::commands::panels::comparing::{PanelJudge, PanelScore};
use crate::gaze_source::interrupted;
use crate::report::output::say_replaced;
use crate::report::output::{self, Counting};
use crate::report::picture_file::write_png;
use crate::run::run_folder::{clear_pictures, other_pictures};
use anyhow::Context;
use args::WarpArgs;
use device::{WarpDevice, most_side, opened};
use eye::EyeReport;
use foveal_core::units::counted;
use foveal_core::view::panel::rig::{Panel, Rig};
use foveal_media::generate::FRAMES_PER_SECOND;
use foveal_render::RgbaImage;
use indicatif::ProgressBar;
use laid::Laid;
use sent::{SentLayout, as_seen};
use serde::Serialize;
use source::{PanelSource, opaque};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Serialize)]
struct WarpResult {
    frames: u32,
    /// Pictures of a live source that newer ones took the place of.
    dropped: u64,
    filter: String,
    placement: &'static str,
    adapter: String,
    /// Columns and rows of the source, of both eyes.
    source: [u32; 2],
    /// Columns and rows that no panel magnifies, of a world whose size is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    need: Option<[u32; 2]>,
    multi_probe_share: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    eye_blur: Option<EyeReport>,
    panels: Vec<WarpedPanel>,
}

#[derive(Serialize)]
struct WarpedPanel {
    id: String,
    #[serde(flatten)]
    score: Option<PanelScore>,
}

/// What a run did.
struct WarpRun {
    frames: u32,
    laid: Laid,
    adapter: String,
    judges: Vec<PanelJudge>,
}

pub(crate) fn run(args: &WarpArgs) -> anyhow::Result<()> {
    args.check()?;
    let rig = args.rig.read()?;
    let mut source = PanelSource::open(&args.source_name)?;
    args.check_source(&source)?;
    let panels = args.rig.panels(&rig);
    args.spare_inputs(&panels)?;
    let ran = match &args.out {
        Some(out) => to_files(args, &rig, &panels, (&mut source, out))?,
        None => {
            let (frames, laid, adapter) = window::run(args, &rig, &panels, &mut source)?;
            WarpRun {
                frames,
                laid,
                adapter,
                judges: Vec::new(),
            }
        }
    };
    let result = WarpResult {
        frames: ran.frames,
        dropped: source.live().map_or(0, |live| live.dropped()),
        filter: args.filter_name().name(),
        placement: ran.laid.placement,
        adapter: ran.adapter,
        source: ran.laid.size,
        need: ran.laid.need,
        eye_blur: args.eye.report(),
        multi_probe_share: ran.laid.multi_probe_share(&panels),
        panels: warped(&panels, &ran.judges)?,
    };
    output::result(args.json, &result, &result.text(args.out.as_deref()))
}

/// What fills panels, from a source that lies somewhere.
struct Filled {
    laid: Laid,
    device: WarpDevice,
    /// Fills the same panels for a comparison, which judges the warp alone: without what dims or
    /// fades them. Nothing where that is the same, or not asked for.
    bare: Option<WarpDevice>,
}

/// Writes what each panel shows of each frame.
fn to_files(
    args: &WarpArgs,
    rig: &Rig,
    panels: &[&Panel],
    (source, out): (&mut PanelSource, &Path),
) -> anyhow::Result<WarpRun> {
    let layout = SentLayout::of(panels);
    let drawer = opened(args.renderer, args.filter_name())?;
    let bare: Vec<Panel> = panels.iter().map(|it| it.undimmed()).collect();
    let bare: Vec<&Panel> = bare.iter().collect();
    let differs = args.compare && bare[..] != *panels;
    let open = |source: &PanelSource| {
        let laid = args.lay(rig, panels, (source, most_side(&drawer)))?;
        let filled_by = |panels: &[&Panel]| {
            let plan = args.plan(panels, &laid, &layout);
            let style = (args.filter_name(), args.show_anisotropy);
            WarpDevice::new(&drawer, plan, laid.size, style)
        };
        let device = filled_by(panels)?;
        let bare = differs.then(|| filled_by(&bare)).transpose()?;
        anyhow::Ok(Filled { laid, device, bare })
    };
    let mut filled = open(source)?;
    args.tell_shrunk(&filled.laid);
    make_folder(out)?;
    let is_world = source.world().is_some();
    let several = args.frames.is_some() || (source.moves() && !is_world);
    let most = args.frames.unwrap_or(if is_world { 1 } else { u32::MAX });
    let stopped = stopped(source)?;
    let mut judges = judges(args, panels, several && source.moves())?;
    let bar = bar_of(source, several.then_some(most));
    let mut frames = 0;
    while frames < most && !stopped.load(Ordering::Relaxed) {
        let Some(frame) = source.frame(frames, &filled.laid.parts)? else {
            break;
        };
        // A window that is captured may have another size now.
        if frame.picture.size != filled.laid.size {
            filled = open(source)?;
        }
        let atlas = filled.device.fill(&frame.picture)?;
        let file = |name: &str| picture_at(out, name, several.then_some(frames));
        if frames == 0 {
            tell_older(out, several, &names_of(&layout, &atlas, panels))?;
        }
        write_surfaces(&layout, &atlas, &file)?;
        let bare = filled.fill_bare(&frame.picture)?;
        for (k, panel) in panels.iter().enumerate() {
            let seen = as_seen(panel, &atlas, layout.origins[k]);
            write_picture(&file(&panel.id), &seen)?;
            let Some((judge, world)) = judges.get_mut(k).zip(source.world()) else {
                continue;
            };
            let seen = as_seen(panel, bare.as_ref().unwrap_or(&atlas), layout.origins[k]);
            let placement = &filled.laid.of(panel).placement;
            let direct = opaque(&world.on_panel(u64::from(frames), panel, placement));
            judge.frame(&direct, &seen)?;
            let name = format!("compare/{}", panel.id);
            write_picture(&file(&name), &seen.beside(&direct))?;
        }
        frames += 1;
        bar.inc(1);
    }
    Ok(WarpRun {
        frames,
        adapter: filled.device.name().to_owned(),
        laid: filled.laid,
        judges,
    })
}

impl Filled {
    /// What the panels show of a picture without what dims them, where that is compared.
    fn fill_bare(&self, picture: &RgbaImage) -> anyhow::Result<Option<RgbaImage>> {
        let bare = self.bare.as_ref();
        bare.map(|it| it.fill(picture)).transpose()
    }
}

/// A progress bar where there are several pictures, at most so many; it goes when it is dropped.
fn bar_of(source: &PanelSource, several: Option<u32>) -> ProgressBar {
    let Some(most) = several else {
        return ProgressBar::hidden();
    };
    let length = source.length().map(|length| length.min(u64::from(most)));
    output::bar(length, Counting::Frames)
}

/// Where the picture of that name lies: that of a frame, where there are several.
fn picture_at(out: &Path, name: &str, frame: Option<u32>) -> PathBuf {
    match frame {
        Some(frame) => out.join(name).join(format!("frame_{frame:05}.png")),
        None => out.join(format!("{name}.png")),
    }
}

fn make_folder(out: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(out)
        .with_context(|| format!("--out {}: the folder cannot be made", out.display()))
}

/// The names of all pictures of a frame.
fn names_of(layout: &SentLayout, atlas: &RgbaImage, panels: &[&Panel]) -> Vec<String> {
    let surfaces = layout.surfaces(atlas).into_iter().map(|(name, _)| name);
    surfaces
        .chain(panels.iter().map(|panel| panel.id.clone()))
        .collect()
}

/// Removes frames of an older run, and says which pictures in the folder are not of this one.
fn tell_older(out: &Path, several: bool, names: &[String]) -> anyhow::Result<()> {
    if several {
        clear_pictures(out, names.iter().map(String::as_str))?;
    }
    let own: Vec<PathBuf> = match several {
        true => Vec::new(),
        false => names
            .iter()
            .map(|name| out.join(format!("{name}.png")))
            .collect(),
    };
    let others = other_pictures(out, &own);
    if others > 0 {
        output::say(&format!(
            "warning: {}: {} there, which this run does not write",
            out.display(),
            match others {
                1 => "one other picture is".to_owned(),
                _ => format!("{others} other pictures are"),
            }
        ));
    }
    Ok(())
}

/// Whether the user ended what is live, which has no end of its own.
fn stopped(source: &PanelSource) -> anyhow::Result<Arc<AtomicBool>> {
    match source.live() {
        Some(_) => interrupted(),
        None => Ok(Arc::default()),
    }
}

fn write_surfaces(
    layout: &SentLayout,
    atlas: &RgbaImage,
    file: &dyn Fn(&str) -> PathBuf,
) -> anyhow::Result<()> {
    for (name, surface) in layout.surfaces(atlas) {
        write_picture(&file(&name), &surface)?;
    }
    Ok(())
}

fn judges(args: &WarpArgs, panels: &[&Panel], moves: bool) -> anyhow::Result<Vec<PanelJudge>> {
    if !args.compare {
        return Ok(Vec::new());
    }
    let fps = moves.then_some(f64::from(FRAMES_PER_SECOND));
    panels
        .iter()
        .map(|panel| PanelJudge::new(panel, fps))
        .collect()
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

fn write_picture(path: &Path, image: &RgbaImage) -> anyhow::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
    }
    say_replaced(path);
    write_png(path, image)
}

impl WarpResult {
    fn text(&self, out: Option<&Path>) -> String {
        let [w, h] = self.source;
        let mut text = format!(
            "{}, {} of {w}x{h}, filter {}, drawn by {}\n",
            counted(u64::from(self.frames), "frame"),
            self.placement,
            self.filter,
            self.adapter,
        );
        if self.multi_probe_share > 0.0 {
            let percent = 100.0 * self.multi_probe_share;
            let _ = writeln!(
                text,
                "{percent:.1} % of the panel pixels are stretched, and take several samples"
            );
        }
        text.extend(self.eye_blur.iter().map(EyeReport::text));
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
        if let Some(out) = out {
            let _ = writeln!(text, "written to {}", out.display());
        }
        text
    }
}
