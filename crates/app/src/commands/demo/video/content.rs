//! What video does the demo play, and what of it is left from an earlier run?

use crate::report::output::{self, WrongUsage};
use crate::run::calibrate::CalibrationExtent;
use crate::run::kept_pack::{calibrate_in_place, kept, plan_of, write_pack};
use crate::run::scene_clip::{write_scene, write_still};
use anyhow::bail;
use foveal_media::generate::GeneratedScene;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::prepare::{PreparationPlan, PrepareSettings};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Most frames that are prepared and played of every film.
pub(crate) const FRAMES: u32 = 64;
/// Pixels of the generated still sphere, equirectangular.
const SPHERE_SIZE: [u32; 2] = [8192, 4096];
/// Pixels of the generated flat film.
const WIDE_SIZE: [u32; 2] = [1920, 1080];
/// The clip that `make demo` fetches, its length, and its licence.
const SAMPLE: &str = "bigbuckbunny.mp4";
const SAMPLE_BYTES: u64 = 1_055_736;
const SAMPLE_LICENCE: &str = "Big Buck Bunny, (c) Blender Foundation, CC BY 3.0";

/// A film or a picture to play.
#[derive(Clone, Debug)]
pub(crate) struct VideoContent {
    /// Name of its pack and folders, without ending; no two share one.
    pub(crate) name: String,
    /// The file.
    source: PathBuf,
    /// What draws that file, if the demo does.
    drawn: Option<Drawn>,
}

/// What the demo draws itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drawn {
    Film([u32; 2], GeneratedScene),
    Still([u32; 2], GeneratedScene),
}

/// Content as a pack, and how it became one.
pub(crate) struct Prepared {
    pub(crate) name: String,
    pub(crate) source: PathBuf,
    pub(crate) file: Arc<PackFile>,
    /// The licence, where it must be named.
    pub(crate) licence: Option<&'static str>,
    /// Whether the program drew it.
    pub(crate) generated: bool,
    /// How long preparing took; `None` when the pack of an earlier run was still good.
    pub(crate) took: Option<Duration>,
    /// How it was prepared: what `auto` found and what is lost.
    pub(crate) plan: PreparationPlan,
}

impl VideoContent {
    /// A file of the user's.
    pub(crate) fn file(name: String, source: PathBuf) -> Self {
        Self {
            name,
            source,
            drawn: None,
        }
    }

    /// A flat film that is drawn under `out`.
    pub(crate) fn wide(out: &Path) -> Self {
        let scene = GeneratedScene::wide(WIDE_SIZE);
        Self {
            name: "generated-wide".to_owned(),
            source: out.join("generated-wide.mkv"),
            drawn: Some(Drawn::Film(WIDE_SIZE, scene)),
        }
    }

    /// A still sphere that is drawn under `out`.
    pub(crate) fn sphere(out: &Path) -> Self {
        let scene = GeneratedScene::panorama(SPHERE_SIZE);
        Self {
            name: "generated-360".to_owned(),
            source: out.join("generated-360.png"),
            drawn: Some(Drawn::Still(SPHERE_SIZE, scene)),
        }
    }

    /// Refuses an input that cannot be prepared, before anything long begins.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        if self.drawn.is_none() {
            self.plan()?;
        }
        Ok(())
    }

    /// Refuses a file that the demo is about to draw.
    pub(crate) fn check_not(&self, input: &Path) -> anyhow::Result<()> {
        if let (Ok(a), Ok(b)) = (input.canonicalize(), self.source.canonicalize())
            && a == b
        {
            bail!(WrongUsage(format!(
                "--clip {}: the demo itself writes this file; leave the option out",
                input.display()
            )));
        }
        Ok(())
    }

    /// Makes a pack under `out`, as far calibrated as is asked for, or finds that the one there is
    /// still good.
    pub(crate) fn prepare(
        &self,
        out: &Path,
        calibrated: Option<CalibrationExtent>,
    ) -> anyhow::Result<Prepared> {
        let pack = out.join(format!("{}.foveal", self.name));
        let begun = Instant::now();
        let kept = kept(&self.source, &pack, &settings()?);
        let plan = match &kept {
            Some(plan) => {
                output::say(&format!("{}: already prepared, used again", pack.display()));
                plan.clone()
            }
            None => {
                self.draw()?;
                let plan = self.plan()?;
                let most = u64::from(FRAMES);
                let length = plan.frames.map(|frames| frames.min(most));
                write_pack(&self.source, &pack, &plan, length)?;
                plan
            }
        };
        if let Some(extent) = calibrated {
            calibrate_in_place(&pack, extent)?;
        }
        let file = PackFile::open(&pack)?;
        let source = &plan.description.source;
        let is_sample = source.name == SAMPLE && source.bytes == SAMPLE_BYTES;
        Ok(Prepared {
            name: self.name.clone(),
            source: self.source.clone(),
            licence: is_sample.then_some(SAMPLE_LICENCE),
            generated: self.drawn.is_some(),
            took: kept.is_none().then(|| begun.elapsed()),
            plan,
            file: Arc::new(file),
        })
    }

    fn draw(&self) -> anyhow::Result<()> {
        match &self.drawn {
            Some(Drawn::Film(size, scene)) => write_scene(scene, *size, FRAMES, &self.source),
            Some(Drawn::Still(_, scene)) => write_still(scene, &self.source),
            None => Ok(()),
        }
    }

    fn plan(&self) -> anyhow::Result<PreparationPlan> {
        plan_of(&self.source, &settings()?)
    }
}

impl Prepared {
    /// Frames that are played.
    pub(crate) fn frames(&self) -> u32 {
        self.file.pack().description().frames
    }

    /// Whether the source has more frames than are played.
    pub(crate) fn is_cut_short(&self) -> bool {
        let all = self.plan.frames;
        all.is_none_or(|of| of > u64::from(FRAMES)) && self.frames() == FRAMES
    }

    /// Bytes of the source file for the time that is played; `None` of what the demo drew, and
    /// where the file does not say how long it is.
    pub(crate) fn source_bytes(&self) -> Option<f64> {
        let all = self.plan.frames.filter(|_| !self.generated)?;
        let share = f64::from(self.frames()) / all.max(1) as f64;
        Some(self.plan.description.source.bytes as f64 * share.min(1.0))
    }
}

fn settings() -> anyhow::Result<PrepareSettings> {
    Ok(PrepareSettings {
        jobs: output::jobs(None)?,
        most_frames: Some(FRAMES),
        ..PrepareSettings::default()
    })
}
