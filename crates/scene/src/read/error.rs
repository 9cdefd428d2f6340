//! What can go wrong between a 3D file and a scene, and what should its owner do next?

use std::path::{Path, PathBuf};

use thiserror::Error;

/// What to do about a file that breaks its own format.
pub(super) const EXPORT_AGAIN: &str = "copy the file again if it was cut short, or export it again";

/// What to do where the system refuses to open a file, by what it says.
fn next_after(reason: &str) -> &'static str {
    // Of this program or of all: the path is as it should be.
    match reason.contains("Too many open files") {
        true => "close other programs or files, or allow more with `ulimit -n 4096`",
        false => "check the path and the permissions",
    }
}

/// What a system call said, without the number of the error.
pub(super) fn said(error: &std::io::Error) -> String {
    let text = error.to_string();
    match text.rfind(" (os error ") {
        Some(at) if at > 0 => text[..at].to_owned(),
        _ => text,
    }
}

/// The end of a path's name, in lower case.
fn ending(path: &Path) -> String {
    let ending = path.extension().unwrap_or_default();
    ending.to_string_lossy().to_ascii_lowercase()
}

/// Which programs write what kinds of files, and as what they export them for Foveal.
const CONVERTED: [(&[&str], &str); 4] = [
    (
        &[
            "fbx", "dae", "3ds", "blend", "usd", "usda", "usdc", "usdz", "abc", "x3d", "wrl",
            "3mf", "off", "max", "ma", "mb", "c4d", "skp", "lwo", "x", "dxf", "amf",
        ],
        "open it in Blender or the program that made it, and export it as .glb",
    ),
    (
        &[
            "pcd", "e57", "xyz", "pts", "ptx", "asc", "rcp", "rcs", "fls", "fws", "zfs",
        ],
        "open it in CloudCompare, and save it as .laz or .ply",
    ),
    (
        &["splat", "spz", "ksplat", "sog"],
        "open it in SuperSplat, and export it as .ply that is not compressed",
    ),
    (
        &[
            "step", "stp", "iges", "igs", "ifc", "brep", "fcstd", "dwg", "3dm", "sldprt",
        ],
        "open it in FreeCAD or the program that made it, and export its surfaces as .glb or .stl",
    ),
];

/// What to do with a file of an ending that is not read.
fn next_for_ending(path: &Path) -> String {
    let ending = ending(path);
    let known = CONVERTED.iter().find(|(all, _)| all.contains(&&*ending));
    known.map_or_else(
        || format!("give one that ends in {ENDINGS}, or export it as .glb"),
        |(_, next)| (*next).to_owned(),
    )
}

/// What to do with a file in which nothing can be drawn.
fn next_for_nothing(path: &Path) -> &'static str {
    match ending(path).as_str() {
        "obj" => {
            "a surface needs lines such as `v 0 0 1` for each vertex, and for each face a line \
             such as `f 1 2 3`, which names three vertices or more"
        }
        "las" | "laz" => "export the points again",
        "ply" => "export the surfaces as triangles, or the points with x, y and z",
        _ => "export the surfaces as triangles",
    }
}

/// Why no scene could be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// There is no file to read.
    #[error("scene: no 3D file is given; give one that ends in {ENDINGS}")]
    NoFile,
    /// The ending of the name is not one that is read.
    #[error(
        "{}: is not a 3D file that Foveal reads; {}",
        path.display(), next_for_ending(path)
    )]
    UnknownEnding {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {reason}; {}", path.display(), next_after(reason))]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// The file breaks its format, or says what cannot be.
    #[error("{}: {place}: {what}; {next}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// Where in it: a line, a byte, or the number of an accessor.
        place: String,
        /// What is wrong there.
        what: String,
        /// What to do about it.
        next: String,
    },
    /// The file asks for something that Foveal does not do.
    #[error("{}: {what}, which is not supported; {next}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it asks for.
        what: String,
        /// What to do about it.
        next: String,
    },
    /// A file that this one names is missing or cannot be read.
    #[error(
        "{}: its file \"{name}\" cannot be read: {reason}; put it where this file expects it",
        path.display()
    )]
    Missing {
        /// The file.
        path: PathBuf,
        /// The name that it gives.
        name: String,
        /// What the system said.
        reason: String,
    },
    /// The file has neither triangle nor point.
    #[error(
        "{}: there is nothing to draw: {found}; {}",
        path.display(), next_for_nothing(path)
    )]
    Empty {
        /// The file.
        path: PathBuf,
        /// What it holds instead.
        found: String,
    },
}

/// The endings that are read.
const ENDINGS: &str = ".glb, .gltf, .vrm, .obj, .ply, .stl, .las, .laz or .toml";

/// A [`ReadError`] that does not know its file yet.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Fault {
    Broken {
        place: String,
        what: String,
        next: String,
    },
    Unsupported {
        what: String,
        next: String,
    },
    Missing {
        name: String,
        reason: String,
    },
    Empty {
        found: String,
    },
}

impl Fault {
    /// What breaks the format at `place`.
    pub(super) fn at(place: impl ToString, what: impl ToString) -> Self {
        Self::broken(place, what, EXPORT_AGAIN)
    }

    /// What breaks the format at a line, counted from 1.
    pub(super) fn line(number: usize, what: impl ToString) -> Self {
        Self::at(format!("line {number}"), what)
    }

    pub(super) fn broken(place: impl ToString, what: impl ToString, next: impl ToString) -> Self {
        Self::Broken {
            place: place.to_string(),
            what: what.to_string(),
            next: next.to_string(),
        }
    }

    pub(super) fn unsupported(what: impl ToString, next: impl ToString) -> Self {
        Self::Unsupported {
            what: what.to_string(),
            next: next.to_string(),
        }
    }

    /// What is wrong, in a few words.
    pub(super) fn what(self) -> String {
        match self {
            Self::Broken { place, what, .. } => format!("{place}: {what}"),
            Self::Unsupported { what, .. } => what,
            Self::Missing { reason, .. } => reason,
            Self::Empty { found } => found,
        }
    }

    /// The same, with the name of a file that is missing.
    pub(super) fn told(self) -> String {
        match self {
            Self::Missing { name, reason } => format!("\"{name}\": {reason}"),
            other => other.what(),
        }
    }

    pub(super) fn in_file(self, path: &Path) -> ReadError {
        let path = path.to_owned();
        match self {
            Self::Broken { place, what, next } => ReadError::Broken {
                path,
                place,
                what,
                next,
            },
            Self::Unsupported { what, next } => ReadError::Unsupported { path, what, next },
            Self::Missing { name, reason } => ReadError::Missing { path, name, reason },
            Self::Empty { found } => ReadError::Empty { path, found },
        }
    }
}
