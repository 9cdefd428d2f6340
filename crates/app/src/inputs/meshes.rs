//! Meshes as text and triangles: OBJ, PLY, STL.

use super::format::Outcome::Mended;
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[
    Format {
        name: "OBJ, with MTL",
        read: "Vertices, normals, texture coordinates, faces and materials (`.obj`, `.mtl`).",
        rows: &[],
    },
    Format {
        name: "PLY meshes",
        read: "Text and both binary orders (`.ply`). A file without faces is a cloud, below.",
        rows: &[],
    },
    Format {
        name: "STL",
        read: "Text and binary (`.stl`).",
        rows: &[Finding {
            found: "triangles without area",
            outcome: Mended,
            told: "left out, `repairs.degenerate_triangles`",
        }],
    },
];
