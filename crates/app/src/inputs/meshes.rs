//! Meshes as text and triangles: OBJ, PLY, STL.

use super::format::Outcome::{Mended, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[
    Format {
        name: "OBJ, with MTL",
        read: "Vertices, normals, texture coordinates, faces and materials (`.obj`, `.mtl`).",
        rows: &[
            Finding {
                found: "colours of vertices from 0 to 255",
                outcome: Remarked,
                told: "the largest code is taken for all light",
            },
            Finding {
                found: "triangles so far from all others that the grid of the mesh would have no \
                        detail",
                outcome: Mended,
                told: "an object with a grid of its own, `repairs.outlier_triangles`, with a \
                       remark",
            },
            Finding {
                found: "`mtllib` and `map_Kd` with the folders of another machine",
                outcome: Mended,
                told: "the file of that name beside the model, as of [textures](#textures); \
                       without one the shape comes in its colour",
            },
        ],
    },
    Format {
        name: "PLY meshes",
        read: "Text and both binary orders (`.ply`). A file without faces is a cloud, below.",
        rows: &[
            Finding {
                found: "colours of vertices from 0 to 255, or of another depth than their numbers",
                outcome: Remarked,
                told: "the largest code is taken for all light",
            },
            Finding {
                found: "colours of faces",
                outcome: Remarked,
                told: "drawn; left out with a remark where vertices have colours too",
            },
            Finding {
                found: "triangles so far from all others that the grid of the mesh would have no \
                        detail",
                outcome: Mended,
                told: "an object with a grid of its own, `repairs.outlier_triangles`, with a \
                       remark",
            },
        ],
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
