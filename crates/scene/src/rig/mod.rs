//! What does a rig file say: which displays stand round the eyes, and how is each fed?
//!
//! Normative: docs/formats/panels.md.

mod alpha;
mod checked;
mod distortion;
mod entries;
mod error;
mod interchange;
mod pfm;
mod places;
#[cfg(test)]
mod tests;

use crate::beneath::{Beneath, leads_out};
use crate::plain_bytes::{PlainBytesError, bytes_of, plain_bytes};
use crate::read::{ReadError, ReadOptions, read};
use crate::source::{SourceObject, SourceScene};
use std::cell::RefCell;
use std::path::Path;

use foveal_core::view::panel::rig::{Panel, Rig};
use glam::DVec3;

pub use error::RigError;
pub use interchange::projectors::Projector;
pub use interchange::written_mpcdi::WrittenMpcdi;

use error::{NEXT, RigFault};
use interchange::{mesh, mpcdi, projectors, written_mpcdi, written_toml};
use places::{RigSyntax, RigText};

/// Most bytes of a rig file.
const MOST_BYTES: u64 = 1 << 24;
/// Most bytes of a file that it names, and of an MPCDI: a map of 16,384 x 16,384 pixels would be
/// 3 GB; one of the largest displays is 400 MB.
const MOST_BESIDE: u64 = 1 << 29;

/// How a file describes a rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RigKind {
    Entries(RigSyntax),
    Mpcdi,
    Mesh,
}

impl RigKind {
    fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "toml" => Some(Self::Entries(RigSyntax::Toml)),
            "json" => Some(Self::Entries(RigSyntax::Json)),
            "mpcdi" | "xml" => Some(Self::Mpcdi),
            "data" | "mesh" | "txt" | "csv" => Some(Self::Mesh),
            _ => None,
        }
    }

    fn most_bytes(self) -> u64 {
        match self {
            Self::Mpcdi => MOST_BESIDE,
            _ => MOST_BYTES,
        }
    }
}

/// Reads a rig: our TOML; our JSON where the name ends in `.json`; an MPCDI, zipped or not, where
/// it ends in `.mpcdi` or `.xml`; a warp mesh where it ends in `.data`, `.mesh`, `.txt` or `.csv`.
/// Files that it names lie in its folder.
///
/// Refused are files that break their format, say what cannot be, or have keys that there are not;
/// the error names line and key.
pub fn read_rig(path: &Path) -> Result<Rig, RigError> {
    read_rig_seen_from(path, None).map(|read| read.rig)
}

/// A rig, and what its file says besides that is left out, for people.
#[derive(Clone, Debug, PartialEq)]
pub struct NotedRig {
    /// The rig.
    pub rig: Rig,
    /// A line each.
    pub notes: Vec<String>,
}

/// [`read_rig`], with what is left out. Where an MPCDI has points in space, the eye that sees
/// them is so many metres to the right of, above and behind their origin; without it only points
/// about an eye are taken.
pub fn read_rig_seen_from(path: &Path, eye: Option<[f64; 3]>) -> Result<NotedRig, RigError> {
    let Some(kind) = RigKind::of(path) else {
        return Err(match path.is_dir() {
            true => {
                let next = "give a rig file in it, which ends in .toml or .json, or an .mpcdi";
                RigFault::new("", "is a folder", next).in_file(path)
            }
            false => {
                let what = "is not a rig file that Foveal reads";
                let next = "give one that ends in .toml, .json, .mpcdi, .xml, .data, .mesh, .txt \
                            or .csv (docs/formats/panels.md)";
                RigFault::new("", what, next).in_file(path)
            }
        });
    };
    let most = kind.most_bytes();
    let bytes = plain_bytes(path, most).map_err(|error| match error {
        PlainBytesError::System(error) => {
            let what = format!("cannot be read: {error}");
            RigFault::new("", what, "check the path and the permissions").in_file(path)
        }
        PlainBytesError::Other | PlainBytesError::Large(..) => {
            let what = format!("is not a plain file of at most {most} bytes");
            RigFault::new("", what, NEXT).in_file(path)
        }
    })?;
    let read = |name: &str| -> Result<Vec<u8>, String> { beside(path, name) };
    let plain = |rig| NotedRig {
        rig,
        notes: Vec::new(),
    };
    let found = match kind {
        RigKind::Entries(syntax) => parse_rig(&bytes, syntax, &read).map(plain),
        RigKind::Mpcdi => {
            let others = RefCell::new(Vec::new());
            let read =
                |name: &str| read(name).or_else(|why| near(path, name, &others).ok_or(why)?);
            mpcdi::read(&bytes, &read, eye).map(|found| NotedRig {
                rig: found.rig,
                notes: [found.notes, others.take()].concat(),
            })
        }
        RigKind::Mesh => mesh::read(&bytes).map(|(rig, notes)| NotedRig { rig, notes }),
    };
    found.map_err(|fault| fault.in_file(path))
}

/// The rig of projectors, and what was mended of the wall that they light, which is a 3D file of
/// triangles, for an eye at a place in the wall's own units: to the right, up and behind. A panel
/// is what a projector lights, as the eye sees it.
///
/// # Errors
/// The file cannot be read or has no triangle, or a projector lights none of it, or more than
/// 85° from the middle of what it lights.
pub fn rig_of_projectors(
    wall: &Path,
    projectors: &[Projector],
    eye: [f64; 3],
) -> Result<NotedRig, RigOfProjectorsError> {
    let scene = read(&[wall], &ReadOptions::default())?;
    let triangles = triangles_of(&scene).map_err(|fault| fault.in_file(wall))?;
    let rig = projectors::rig(&triangles, projectors, eye.into());
    Ok(NotedRig {
        rig: rig.map_err(|fault| fault.in_file(wall))?,
        notes: scene.remarks,
    })
}

/// All triangles of a scene where they stand.
fn triangles_of(scene: &SourceScene) -> Result<Vec<[DVec3; 3]>, RigFault> {
    /// 1.2 GB.
    const MOST_TRIANGLES: usize = 1 << 24;
    let of = |object: &SourceObject| {
        let own = scene.meshes[object.mesh].triangles.len();
        own.saturating_mul(object.placements.len())
    };
    let count = scene.objects.iter().map(of).fold(0, usize::saturating_add);
    if count == 0 || count > MOST_TRIANGLES {
        let what = format!("has {count} triangles, and a wall has 1 to {MOST_TRIANGLES}");
        return Err(RigFault::new("", what, "export the wall alone, as a mesh"));
    }
    let mut triangles = Vec::with_capacity(count);
    for object in &scene.objects {
        let mesh = &scene.meshes[object.mesh];
        for placement in &object.placements {
            let corner = |it: u32| placement.transform_point3(mesh.positions[it as usize]);
            triangles.extend(mesh.triangles.iter().map(|it| it.map(corner)));
        }
    }
    Ok(triangles)
}

/// Why projectors and a wall make no rig.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub enum RigOfProjectorsError {
    /// The wall cannot be read.
    Wall(#[from] ReadError),
    /// A projector does not fit to it.
    Projector(#[from] RigError),
}

/// Whether a file is another program's: not our TOML or JSON.
#[must_use]
pub fn is_foreign(path: &Path) -> bool {
    matches!(RigKind::of(path), Some(RigKind::Mpcdi | RigKind::Mesh))
}

/// The MPCDI of panels, with a buffer for each surface, and what it has no place for; or why there
/// is none. Fades and black become pictures.
pub fn write_mpcdi(panels: &[&Panel]) -> Result<WrittenMpcdi, String> {
    written_mpcdi::written(panels)
}

/// The files of a rig that was read from another program's file: `STEM.toml`, and maps next to
/// it; or why there are none.
pub fn write_rig(rig: &Rig, stem: &str) -> Result<Vec<(String, Vec<u8>)>, String> {
    written_toml::written(rig, stem)
}

/// The bytes of a file that lies in the folder of a rig file, or why not.
fn beside(rig: &Path, name: &str) -> Result<Vec<u8>, String> {
    if name.is_empty() {
        return Err("names no file in the rig file's folder".to_owned());
    }
    let opened = Beneath::beside(rig).and_then(|it| it.open(Path::new(name)));
    let file = opened.map_err(|error| match leads_out(&error) {
        true => "names no file in the rig file's folder".to_owned(),
        false => format!("cannot be read: {error}"),
    })?;
    bytes_of(file, MOST_BESIDE).map_err(|error| match error {
        PlainBytesError::System(error) => format!("cannot be read: {error}"),
        PlainBytesError::Other | PlainBytesError::Large(..) => {
            format!("is not a plain file of at most {MOST_BESIDE} bytes")
        }
    })
}

/// The same of a file whose name differs from this one in capitals alone, which is noted; none
/// where there is none.
fn near(rig: &Path, name: &str, notes: &RefCell<Vec<String>>) -> Option<Result<Vec<u8>, String>> {
    let other = Beneath::beside(rig)
        .ok()?
        .in_other_capitals(Path::new(name))?;
    let other = other.to_str()?;
    let note = format!("{name:?} is not there: {other:?} is taken, which differs in capitals");
    let mut notes = notes.borrow_mut();
    if !notes.contains(&note) {
        notes.push(note);
    }
    Some(beside(rig, other))
}

fn parse_rig(
    bytes: &[u8],
    syntax: RigSyntax,
    read: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Rig, RigFault> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let place = format!("byte {}", error.valid_up_to());
        RigFault::new(&place, "is not text in UTF-8", NEXT)
    })?;
    let text = RigText { text, syntax };
    let said: entries::RigEntries = text.parse()?;
    checked::rig(&said, read).map_err(|wrong| text.fault(&wrong))
}

/// Reads any bytes as TOML and as JSON, without the files that they name; `true` if they are a rig.
/// Panics if that rig breaks what it promises: for fuzzing and tests.
pub fn read_any_rig(bytes: &[u8]) -> bool {
    let nothing = |_: &str| Err("is not there".to_owned());
    let both = [RigSyntax::Toml, RigSyntax::Json];
    let found = both.map(|syntax| is_sound(parse_rig(bytes, syntax, &nothing)));
    found.contains(&true)
}

/// Reads any bytes as a portable float map; `true` if they are one of 4 x 3 pixels: for fuzzing and
/// tests.
pub fn read_any_pfm(bytes: &[u8]) -> bool {
    pfm::read(bytes, [4, 3]).is_ok()
}

/// Reads any bytes as an MPCDI, with the same bytes as whatever file it names; `true` if it is one.
/// Panics if its rig breaks what it promises: for fuzzing and tests.
pub fn read_any_mpcdi(bytes: &[u8]) -> bool {
    let itself = |_: &str| Ok(bytes.to_vec());
    let eyes = [None, Some([0.1, -0.2, 3.0])];
    let found = eyes.map(|eye| is_sound(mpcdi::read(bytes, &itself, eye).map(|it| it.rig)));
    found.contains(&true)
}

/// Reads any bytes as a warp mesh; `true` if they are one. Panics if its rig breaks what it
/// promises: for fuzzing and tests.
pub fn read_any_mesh(bytes: &[u8]) -> bool {
    is_sound(mesh::read(bytes).map(|(rig, _)| rig))
}

fn is_sound(found: Result<Rig, RigFault>) -> bool {
    let Ok(rig) = found else {
        return false;
    };
    for panel in &rig.panels {
        assert!(panel.view.field.is_open() && !panel.id.contains('/'));
        assert!(panel.corners().iter().all(|it| it.is_finite()));
    }
    true
}

/// The JSON Schema of rig files, as docs/formats/tiled-view.schema.json has it.
#[must_use]
pub fn rig_schema() -> String {
    let schema = schemars::schema_for!(entries::RigEntries);
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
