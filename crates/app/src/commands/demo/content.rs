//! What does the demo play, and what of it is left from an earlier run?

use crate::report::output;
use crate::run::kept_pack::{kept, plan_of, write_pack};
use crate::run::scene_clip::write_scene;
use anyhow::bail;
use foveal_media::generate::GeneratedScene;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::prepare::{PreparationPlan, PrepareSettings, Remarks};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Most frames that are prepared and played of every content.
pub(super) const FRAMES: u32 = 64;
/// Pixels of the generated 360° scene, equirectangular.
const SPHERE_SIZE: [u32; 2] = [4096, 2048];
/// Pixels of the generated flat scene.
const WIDE_SIZE: [u32; 2] = [1920, 1080];
/// The clip that `make demo` fetches, its length, and whose it is.
const SAMPLE: &str = "bigbuckbunny.mp4";
const SAMPLE_BYTES: u64 = 1_055_736;
const SAMPLE_LICENCE: &str = "Big Buck Bunny, (c) Blender Foundation, CC BY 3.0";

/// One thing to play.
#[derive(Clone, Debug)]
pub(super) struct DemoContent {
    /// Name of its pack and folders, without ending; no two share one.
    pub(super) name: String,
    /// The video file.
    source: PathBuf,
    /// What draws the video file, when it is not the user's.
    scene: Option<([u32; 2], GeneratedScene)>,
}

/// Content as a pack, and how it became one.
pub(super) struct Prepared {
    pub(super) name: String,
    pub(super) file: Arc<PackFile>,
    /// Whose work it is, where that must be said.
    pub(super) licence: Option<&'static str>,
    /// Whether the source may have more frames than are played.
    pub(super) cut_short: bool,
    /// Whether the program drew it.
    pub(super) generated: bool,
    /// How long preparing took; `None` when the pack of an earlier run was still good.
    pub(super) took: Option<Duration>,
    /// What `auto` found and what is lost.
    pub(super) remarks: Remarks,
}

/// The inputs, or a generated flat clip without any, then the generated 360° scene.
pub(super) fn contents(inputs: &[PathBuf], out: &Path) -> anyhow::Result<Vec<DemoContent>> {
    let sphere = DemoContent::generated(
        "generated-360",
        SPHERE_SIZE,
        GeneratedScene::panorama(SPHERE_SIZE),
        out,
    );
    let mut all = Vec::new();
    if inputs.is_empty() {
        let scene = GeneratedScene::wide(WIDE_SIZE);
        all.push(DemoContent::generated(
            "generated-wide",
            WIDE_SIZE,
            scene,
            out,
        ));
    }
    let mut names = vec![sphere.name.clone()];
    for input in inputs {
        if same_file(input, &sphere.source) {
            bail!(
                "--input {}: the demo itself writes this file; leave the option out",
                input.display()
            );
        }
        let name = unused_name(input, &names);
        names.push(name.clone());
        all.push(DemoContent {
            name,
            source: input.clone(),
            scene: None,
        });
    }
    all.push(sphere);
    Ok(all)
}

fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// The input's name without its ending, with a number where it is taken.
fn unused_name(input: &Path, taken: &[String]) -> String {
    let stem = input.file_stem().unwrap_or_default().to_string_lossy();
    let numbered = (2..).map(|number| format!("{stem}-{number}"));
    std::iter::once(stem.to_string())
        .chain(numbered)
        .find(|name| !taken.contains(name))
        .unwrap_or_default()
}

impl DemoContent {
    /// A scene that is drawn into a video under `out`.
    pub(super) fn generated(name: &str, size: [u32; 2], scene: GeneratedScene, out: &Path) -> Self {
        Self {
            name: name.to_owned(),
            source: out.join(format!("{name}.mkv")),
            scene: Some((size, scene)),
        }
    }

    /// Refuses an input that cannot be prepared, before anything long begins.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        if self.scene.is_none() {
            self.plan()?;
        }
        Ok(())
    }

    /// Makes the pack under `out`, or finds that the one there is still good.
    pub(super) fn prepare(&self, out: &Path) -> anyhow::Result<Prepared> {
        let pack = out.join(format!("{}.foveal", self.name));
        let begun = Instant::now();
        let kept = kept(&self.source, &pack, &settings()?);
        let plan = match (&kept, &self.scene) {
            (Some(plan), _) => {
                output::say(&format!("{}: already prepared, used again", pack.display()));
                plan.clone()
            }
            (None, scene) => {
                if let Some((size, scene)) = scene {
                    write_scene(scene, *size, FRAMES, &self.source)?;
                }
                let plan = self.plan()?;
                let most = u64::from(FRAMES);
                let length = plan.frames.map(|frames| frames.min(most));
                write_pack(&self.source, &pack, &plan, length)?;
                plan
            }
        };
        let file = PackFile::open(&pack)?;
        let source = &plan.description.source;
        let is_sample = source.name == SAMPLE && source.bytes == SAMPLE_BYTES;
        Ok(Prepared {
            name: self.name.clone(),
            licence: is_sample.then_some(SAMPLE_LICENCE),
            cut_short: plan.frames.is_none_or(|of| of > u64::from(FRAMES))
                && file.pack().description().frames == FRAMES,
            generated: self.scene.is_some(),
            took: kept.is_none().then(|| begun.elapsed()),
            remarks: plan.remarks,
            file: Arc::new(file),
        })
    }

    fn plan(&self) -> anyhow::Result<PreparationPlan> {
        plan_of(&self.source, &settings()?)
    }
}

fn settings() -> anyhow::Result<PrepareSettings> {
    Ok(PrepareSettings {
        jobs: output::jobs(None)?,
        most_frames: Some(FRAMES),
        ..PrepareSettings::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_inputs_of_one_name_get_two_names() -> anyhow::Result<()> {
        let inputs = ["a/clip.mp4", "b/clip.mp4", "c/generated-360.mkv"].map(PathBuf::from);
        let all = contents(&inputs, Path::new("out"))?;
        let names: Vec<&str> = all.iter().map(|content| content.name.as_str()).collect();
        assert_eq!(
            names,
            ["clip", "clip-2", "generated-360-2", "generated-360"]
        );
        Ok(())
    }

    #[test]
    fn without_an_input_a_flat_clip_is_drawn() -> anyhow::Result<()> {
        let all = contents(&[], Path::new("out"))?;
        let names: Vec<&str> = all.iter().map(|content| content.name.as_str()).collect();
        assert_eq!(names, ["generated-wide", "generated-360"]);
        Ok(())
    }
}
