//! How do files become a scene?

mod arrangement;
mod colour;
mod error;
mod files;
mod gltf;
pub(crate) mod image;
mod las;
#[cfg(test)]
mod mangle;
mod obj;
mod place;
mod ply;
mod sound;
mod stl;
mod text;

use std::path::Path;

pub use error::ReadError;
pub use place::Up;

use crate::source::SourceScene;
use error::Fault;
use files::{Folder, Nowhere, OnDisk};

/// What is to be known of files beside what they say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Which axis points up in all of them; if not given, the one that is usual for the format: z
    /// in STL, LAS and LAZ, y in all others.
    pub up: Option<Up>,
}

/// How a scene is written in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneFormat {
    /// glTF 2.0, as `.gltf` or as `.glb`: the file's first bytes tell.
    Gltf,
    /// Wavefront OBJ with its MTL.
    Obj,
    /// PLY, as text or binary.
    Ply,
    /// STL, as text or binary.
    Stl,
    /// LAS 1.0 to 1.4 or LAZ, with a hierarchy (COPC) or without.
    Las,
}

impl SceneFormat {
    /// The format that a file's ending tells, in capitals or not.
    #[must_use]
    pub fn of(file: &Path) -> Option<Self> {
        let ending = file.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "glb" | "gltf" => Some(Self::Gltf),
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "las" | "laz" => Some(Self::Las),
            _ => None,
        }
    }

    fn up(self) -> Up {
        match self {
            Self::Stl | Self::Las => Up::Z,
            Self::Gltf | Self::Obj | Self::Ply => Up::Y,
        }
    }
}

/// Whether a file's name ends as one that [`read`] reads: .glb, .gltf, .obj, .ply, .stl, .las
/// or .laz.
#[must_use]
pub fn is_scene_file(file: &Path) -> bool {
    SceneFormat::of(file).is_some()
}

/// Reads files into one scene with the objects of all, in their order. A scene file (.toml) stands
/// for those that it names.
///
/// Refused are files that break their format, that name files outside their folder, or that have
/// neither triangle nor point. Memory is a small multiple of the files' bytes, whatever they claim.
///
/// ```
/// use foveal_scene::read::{ReadOptions, read};
///
/// let file = std::env::temp_dir().join(format!("foveal-read-{}.obj", std::process::id()));
/// std::fs::write(&file, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
/// let scene = read(&[&file], &ReadOptions::default())?;
/// assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
/// # std::fs::remove_file(&file)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(inputs: &[&Path], options: &ReadOptions) -> Result<SourceScene, ReadError> {
    if inputs.is_empty() {
        return Err(ReadError::NoFile);
    }
    let mut scene = SourceScene::default();
    for path in inputs {
        scene.append(match is_arrangement(path) {
            true => arrangement::read(path, options)?,
            false => read_file(path, None, options.up)?,
        });
    }
    Ok(scene)
}

/// Whether a file's name ends as that of a scene file: .toml.
fn is_arrangement(file: &Path) -> bool {
    let ending = file.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

/// Reads a 3D file, whose objects without a name are called `name`, else as the file is.
fn read_file(path: &Path, name: Option<&str>, up: Option<Up>) -> Result<SourceScene, ReadError> {
    let format = SceneFormat::of(path).ok_or_else(|| ReadError::UnknownEnding {
        path: path.to_owned(),
    })?;
    let mut folder = OnDisk::of(path);
    let bytes = folder.read_scene(path)?;
    let stem = path.file_stem().map(|stem| stem.to_string_lossy());
    let stem = stem.as_deref().unwrap_or("object");
    let file = SceneFile {
        name: name.unwrap_or(stem),
        format,
        up: up.unwrap_or(format.up()),
        bytes: &bytes,
    };
    let mut one = file
        .read(&mut folder)
        .map_err(|fault| fault.in_file(path))?;
    one.bytes = folder.bytes;
    one.hashes = folder.hashes;
    Ok(one)
}

/// Reads any bytes as a scene file, without what it names; `true` if they are one: for fuzzing and
/// tests.
pub fn read_any_arrangement(bytes: &[u8]) -> bool {
    arrangement::Arrangement::parse(bytes).is_ok()
}

/// Reads any bytes as a format, with no files beside them; `true` if they are a scene. Panics if
/// that scene breaks what [`SourceScene`] promises: for fuzzing and tests.
pub fn read_anything(format: SceneFormat, bytes: &[u8]) -> bool {
    let file = SceneFile {
        name: "anything",
        format,
        up: format.up(),
        bytes,
    };
    let Ok(scene) = file.read(&mut Nowhere) else {
        return false;
    };
    assert!(!(scene.objects.is_empty() && scene.clouds.is_empty()));
    scene.clouds.iter().for_each(sound::assert_sound_cloud);
    for mesh in &scene.meshes {
        sound::assert_sound(mesh, scene.materials.len());
    }
    for object in &scene.objects {
        assert!(object.mesh < scene.meshes.len() && !object.placements.is_empty());
        assert!(object.placements.iter().all(glam::DAffine3::is_finite));
    }
    true
}

/// A file that is in memory.
struct SceneFile<'a> {
    /// What objects without a name are called.
    name: &'a str,
    format: SceneFormat,
    up: Up,
    bytes: &'a [u8],
}

impl SceneFile<'_> {
    fn read(&self, folder: &mut dyn Folder) -> Result<SourceScene, Fault> {
        let mut scene = match self.format {
            SceneFormat::Gltf => gltf::read(self.bytes, self.name, folder),
            SceneFormat::Obj => obj::read(self.bytes, self.name, folder),
            SceneFormat::Ply => ply::read(self.bytes, self.name),
            SceneFormat::Stl => stl::read(self.bytes, self.name),
            SceneFormat::Las => las::read(self.bytes, self.name),
        }?;
        for mesh in &mut scene.meshes {
            sound::make_sound(mesh, &mut scene.repairs);
        }
        scene.leave_out_empty();
        place::turn_up(&mut scene, self.up);
        place::check(&scene)?;
        if scene.objects.is_empty() && scene.clouds.is_empty() {
            return Err(Fault::Empty {
                found: found_instead(&scene),
            });
        }
        Ok(scene)
    }
}

/// What a scene without triangles has, for the message that refuses it.
fn found_instead(scene: &SourceScene) -> String {
    let count = |name: &str| scene.repairs.get(name).copied().unwrap_or(0);
    let what = [
        ("points_left_out", "points"),
        ("lines_left_out", "lines"),
        ("unused_vertices", "vertices in no face"),
        ("zero_area_triangles", "triangles without area"),
    ];
    let found: Vec<String> = what
        .iter()
        .filter(|(name, _)| count(name) > 0)
        .map(|(name, what)| format!("{what} ({})", count(name)))
        .collect();
    if found.is_empty() {
        "no surface stands in the scene".to_owned()
    } else {
        format!("the file has only {}", found.join(" and "))
    }
}

#[cfg(test)]
mod tests;
