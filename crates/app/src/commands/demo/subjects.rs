//! Which contents does the demo show, in which order?

use crate::commands::demo::scene::content::SceneContent;
use crate::commands::demo::video::content::VideoContent;
use foveal_scene::read::is_scene_file;
use std::path::{Path, PathBuf};

/// One thing to show.
#[derive(Debug)]
pub(super) enum DemoSubject {
    Video(VideoContent),
    Scene(SceneContent),
}

impl DemoSubject {
    /// Refuses an input that cannot be prepared, before anything long begins.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        match self {
            Self::Video(video) => video.check(),
            Self::Scene(scene) => scene.check(),
        }
    }

    #[cfg(test)]
    fn name(&self) -> &str {
        match self {
            Self::Video(video) => &video.name,
            Self::Scene(scene) => &scene.name,
        }
    }
}

/// The inputs; without any the clip or a generated one, a generated sphere and a generated mesh.
pub(super) fn subjects(
    inputs: &[PathBuf],
    clip: Option<&Path>,
    out: &Path,
) -> anyhow::Result<Vec<DemoSubject>> {
    if inputs.is_empty() {
        let (sphere, mesh) = (VideoContent::sphere(out), SceneContent::knot(out));
        let first = match clip {
            None => VideoContent::wide(out),
            Some(clip) => {
                sphere.check_not(clip)?;
                let taken = [sphere.name.clone(), mesh.name.clone()];
                VideoContent::file(unused_name(clip, &taken), clip.to_owned())
            }
        };
        let videos = [first, sphere].map(DemoSubject::Video);
        return Ok(videos
            .into_iter()
            .chain([DemoSubject::Scene(mesh)])
            .collect());
    }
    let (mut all, mut names) = (Vec::new(), Vec::new());
    for input in inputs {
        let name = unused_name(input, &names);
        names.push(name.clone());
        all.push(match is_scene_file(input) {
            true => DemoSubject::Scene(SceneContent::file(name, input.clone())),
            false => DemoSubject::Video(VideoContent::file(name, input.clone())),
        });
    }
    Ok(all)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(inputs: &[&str], clip: Option<&str>) -> Vec<String> {
        let inputs: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
        let all = subjects(&inputs, clip.map(Path::new), Path::new("out")).unwrap();
        all.iter().map(|one| one.name().to_owned()).collect()
    }

    #[test]
    fn two_inputs_of_one_name_get_two_names() {
        let inputs = ["a/clip.mp4", "b/clip.mp4", "c/clip.ply"];
        assert_eq!(names(&inputs, None), ["clip", "clip-2", "clip-3"]);
        let clip = Some("c/generated-360.mkv");
        let drawn = ["generated-360-2", "generated-360", "knot"];
        assert_eq!(names(&[], clip), drawn);
    }

    #[test]
    fn without_an_input_a_film_a_sphere_and_a_mesh_are_drawn() {
        assert_eq!(
            names(&[], None),
            ["generated-wide", "generated-360", "knot"]
        );
    }
}
