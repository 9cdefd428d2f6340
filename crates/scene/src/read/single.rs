//! How does one 3D file become a scene?

mod sheets;

use std::path::Path;

use super::error::{Fault, ReadError};
use super::files::{NamedFile, OnDisk};
use super::image::hidden;
use super::mends::{self, Mends};
use super::place::{self, ReadOptions, Up};
use super::search::Folder;
use super::text::{shortened, utf8_of};
use super::{gltf, las, obj, outliers, ply, sound, stl};
use crate::source::{SourceMesh, SourceScene};

/// How a scene is written in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneFormat {
    /// glTF 2.0, as `.gltf`, or as `.glb` or `.vrm`: the file's first bytes decide.
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
    /// The format that a file's ending names, in capitals or not.
    #[must_use]
    pub fn of(file: &Path) -> Option<Self> {
        let ending = file.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "glb" | "gltf" | "vrm" => Some(Self::Gltf),
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "las" | "laz" => Some(Self::Las),
            _ => None,
        }
    }

    /// The format that the first bytes of a file show; none where these say nothing.
    fn of_content(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [b'g', b'l', b'T', b'F', ..] => Some(Self::Gltf),
            [b'L', b'A', b'S', b'F', ..] => Some(Self::Las),
            [b'p', b'l', b'y', b'\n' | b'\r', ..] => Some(Self::Ply),
            _ if is_binary_stl(bytes) => Some(Self::Stl),
            _ => {
                let head = &bytes[..bytes.len().min(MOST_HEAD)];
                let mut lines = head.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
                let is_text = head
                    .iter()
                    .all(|byte| *byte >= b' ' || byte.is_ascii_whitespace());
                let is_vertex = |line: &[u8]| line.starts_with(b"v ") && line.len() > 6;
                (is_text && lines.any(is_vertex)).then_some(Self::Obj)
            }
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Gltf => "glTF",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Las => "LAS",
        }
    }

    pub(super) fn up(self) -> Up {
        match self {
            Self::Stl | Self::Las => Up::Z,
            Self::Gltf | Self::Obj | Self::Ply => Up::Y,
        }
    }
}

/// So many bytes at the beginning of a file show whether it is OBJ.
const MOST_HEAD: usize = 1024;

/// Whether a file is as long as a binary STL file of as many triangles as it says.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|it| it.try_into().ok());
    let count = count.map_or(0, |it| u64::from(u32::from_le_bytes(it)));
    count > 0 && bytes.len() as u64 == 84 + 50 * count
}

/// Reads a 3D file, whose objects without a name are called as the file is.
pub(super) fn read_file(path: &Path, options: &ReadOptions) -> Result<SourceScene, ReadError> {
    if SceneFormat::of(path).is_none() {
        return Err(unknown_ending(path));
    }
    let mut folder = OnDisk::of(path, options.allow_outside);
    let named = NamedFile {
        path: path.to_owned(),
        bytes: folder.read_scene()?,
        folder,
    };
    read_named(named, None, options.up)
}

/// The same of a 3D file that another named, which may say what objects without a name are called.
pub(super) fn read_named(
    named: NamedFile,
    name: Option<&str>,
    up: Option<Up>,
) -> Result<SourceScene, ReadError> {
    let NamedFile {
        path,
        bytes,
        mut folder,
    } = named;
    let ending = SceneFormat::of(&path).ok_or_else(|| unknown_ending(&path))?;
    let format = SceneFormat::of_content(&bytes).unwrap_or(ending);
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
        .map_err(|fault| fault.in_file(&path))?;
    one.bytes = folder.bytes;
    one.hashes = folder.hashes;
    for (name, times) in folder.repairs {
        sound::count(&mut one.repairs, &name, times as usize);
    }
    folder.remarks.into_iter().for_each(|it| one.remark(it));
    if format != ending {
        one.remark(format!(
            "{:?} holds {}, whatever its name says, and is read as that",
            shortened(&path.file_name().unwrap_or_default().to_string_lossy()),
            format.name()
        ));
        sound::count(&mut one.repairs, "files_of_another_format", 1);
    }
    Ok(one)
}

fn unknown_ending(path: &Path) -> ReadError {
    ReadError::UnknownEnding {
        path: path.to_owned(),
    }
}

/// A file that is in memory.
pub(super) struct SceneFile<'a> {
    /// What objects without a name are called.
    pub(super) name: &'a str,
    pub(super) format: SceneFormat,
    pub(super) up: Up,
    pub(super) bytes: &'a [u8],
}

impl SceneFile<'_> {
    pub(super) fn read(&self, folder: &mut dyn Folder) -> Result<SourceScene, Fault> {
        if self.bytes.is_empty() {
            return Err(Fault::Empty {
                found: "the file has no bytes".to_owned(),
            });
        }
        let text = utf8_of(self.bytes);
        let mut scene = match self.format {
            SceneFormat::Gltf => gltf::read(&text, self.name, folder),
            SceneFormat::Obj => obj::read(&text, self.name, folder),
            SceneFormat::Ply => ply::read(&text, self.name),
            SceneFormat::Stl => stl::read(self.bytes, self.name),
            SceneFormat::Las => las::read(self.bytes, self.name),
        }?;
        let mut mends = Mends::default();
        for object in &scene.objects {
            // A mesh that stands in several places is finite after the first.
            sound::make_finite(&mut scene.meshes[object.mesh], &object.name, &mut mends);
        }
        hidden::leave_out(&mut scene);
        let sound = |mesh| sound::make_sound(mesh, &mut scene.repairs);
        let has_sides: Vec<bool> = scene.meshes.iter_mut().map(sound).collect();
        for number in (0..has_sides.len()).filter(|it| has_sides[*it]) {
            let mut objects = scene.objects.iter();
            let shown = objects.find(|it| it.mesh == number);
            let name = shown.map_or_else(String::new, |it| it.name.clone());
            sheets::join_sides(&mut scene, number, &name);
        }
        mends.tell(self.name, &mut scene);
        self.tell_short_faces(&mut scene);
        tell_black(&mut scene);
        scene.leave_out_empty();
        outliers::part_meshes(&mut scene);
        place::turn_up(&mut scene, self.up);
        place::check_count(&scene)?;
        place::check(&scene)?;
        place::tell_small(&mut scene);
        if scene.clouds.is_empty() && scene.meshes.iter().all(is_flat) {
            let triangles = scene.meshes.iter().map(|it| it.triangles.len()).sum();
            sound::count(&mut scene.repairs, "zero_area_triangles", triangles);
            scene.objects.clear();
        }
        if scene.is_empty() {
            return Err(Fault::Empty {
                found: found_instead(&scene),
            });
        }
        Ok(scene)
    }
}

impl SceneFile<'_> {
    /// Reports faces that were left out as they have too few corners; those of OBJ are reported
    /// with their lines.
    fn tell_short_faces(&self, scene: &mut SourceScene) {
        let times = scene.repairs.get(mends::SHORT_FACE.name).copied();
        if let Some(times) = times.filter(|_| self.format != SceneFormat::Obj) {
            let (name, what) = (shortened(self.name), mends::SHORT_FACE.what);
            scene.remark(format!("{name}: {what}: {times}"));
        }
    }
}

/// Reports surfaces whose vertices all are black, which other programs write for no colour.
fn tell_black(scene: &mut SourceScene) {
    let is_black = |it: &[f32; 4]| it[..3] == [0.0; 3];
    let is_dark = |mesh: &SourceMesh| !mesh.colours.is_empty() && mesh.colours.iter().all(is_black);
    let dark: Vec<bool> = scene.meshes.iter().map(is_dark).collect();
    let mut objects = scene.objects.iter().filter(|it| dark[it.mesh]);
    let Some(first) = objects.next() else {
        return;
    };
    let times = 1 + objects.count();
    let name = shortened(&first.name);
    sound::count(&mut scene.repairs, "black_surfaces", times);
    scene.remark(format!(
        "all vertices of {name:?} are black, as where colours were lost: it is drawn black \
         (such objects: {times})"
    ));
}

/// Whether no triangle of a mesh has any area: their corners lie in lines.
fn is_flat(mesh: &SourceMesh) -> bool {
    mesh.triangles.iter().all(|triangle| {
        let [a, b, c] = triangle.map(|it| mesh.positions[it as usize]);
        let [one, other] = [b - a, c - a];
        let longest = one.length_squared().max(other.length_squared());
        one.cross(other).length() <= NO_AREA * longest
    })
}

/// So much of the square of its longest side is no area of a triangle.
const NO_AREA: f64 = 1e-12;

/// Most remarks in the message that refuses a scene.
const MOST_TOLD: usize = 3;

/// What a scene without triangles has, for the message that refuses it.
fn found_instead(scene: &SourceScene) -> String {
    let count = |name: &str| scene.repairs.get(name).copied().unwrap_or(0);
    let what = [
        ("points_left_out", "points"),
        ("lines_left_out", "lines"),
        ("unused_vertices", "vertices in no face"),
        ("zero_area_triangles", "triangles without area"),
        (
            "triangles_out_of_range",
            "faces of vertices that do not exist",
        ),
        (
            "triangles_without_place",
            "triangles that are NaN or infinite",
        ),
        ("points_without_place", "points that are NaN or infinite"),
        ("lines_broken", "lines that do not belong to its format"),
    ];
    let found: Vec<String> = what
        .iter()
        .filter(|(name, _)| count(name) > 0)
        .map(|(name, what)| format!("{what} ({})", count(name)))
        .collect();
    let found = match found.is_empty() {
        true => "no surface stands in the scene".to_owned(),
        false => format!("the file has only {}", found.join(" and ")),
    };
    // What was mended names places.
    let remarks = scene.remarks.iter().take(MOST_TOLD);
    remarks.fold(found, |all, remark| format!("{all}; {remark}"))
}
