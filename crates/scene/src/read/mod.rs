//! How do files become a scene?

mod arrangement;
mod colour;
mod error;
mod files;
mod gltf;
mod half;
pub(crate) mod image;
mod las;
#[cfg(test)]
mod mangle;
mod mends;
mod obj;
mod outliers;
mod place;
mod ply;
mod polygon;
mod search;
mod single;
mod sound;
mod stl;
mod text;

use std::path::Path;

pub use error::ReadError;
pub use place::{ReadOptions, Up};

pub use single::SceneFormat;
pub use sound::KEPT;

use crate::source::SourceScene;
use files::Nowhere;
use single::{SceneFile, read_file};

/// Whether a file's name ends as one that [`read`] reads: .glb, .gltf, .vrm, .obj, .ply, .stl,
/// .las or .laz.
#[must_use]
pub fn is_scene_file(file: &Path) -> bool {
    SceneFormat::of(file).is_some()
}

/// Reads files into one scene with the objects of all, in their order. A scene file (.toml) stands
/// for those that it names.
///
/// Refused are files that break their format, or that have neither triangle nor point. A file that
/// one names elsewhere is looked for in its folder; without pictures, surfaces have their colour.
/// Memory is a small multiple of the files' bytes, whatever they claim.
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
            false => read_file(path, options)?,
        });
    }
    image::pictures::leave_out_pictures(&mut scene);
    Ok(scene)
}

/// Number of texels of the pictures that surfaces of a scene may show; of broken ones none.
#[must_use]
pub fn texels(scene: &SourceScene) -> u64 {
    let sizes = scene
        .images
        .iter()
        .filter_map(|it| image::size_of(&it.bytes));
    sizes
        .map(|size| size.map(u64::from).iter().product::<u64>())
        .sum()
}

/// Whether a file's name ends as that of a scene file: .toml.
fn is_arrangement(file: &Path) -> bool {
    let ending = file.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

/// Reads any bytes as a scene file, without what it names; `true` if they are one: for fuzzing and
/// tests.
pub fn read_any_arrangement(bytes: &[u8]) -> bool {
    arrangement::Arrangement::parse(bytes).is_ok()
}

/// Reads any bytes as the picture of a texture; `true` if they are one. Panics if it has another
/// number of texels than it announced: for fuzzing and tests.
pub fn read_any_picture(bytes: &[u8]) -> bool {
    let Some([columns, rows]) = image::size_of(bytes) else {
        return false;
    };
    let Some(mut picture) = image::PictureRows::open(bytes) else {
        return false;
    };
    let mut texels = 0;
    while texels < columns as usize * rows as usize {
        match picture.next(64) {
            Some(some) => texels += some.len(),
            None => return false,
        }
    }
    assert_eq!(texels, columns as usize * rows as usize);
    true
}

/// Reads any bytes as a format, with no files next to them; `true` if they are a scene. Panics if
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
    assert!(!scene.is_empty());
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

#[cfg(test)]
mod tests;
