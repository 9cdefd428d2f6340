//! Meshes as text and triangles: OBJ, PLY, STL.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[
    Format {
        name: "OBJ, with MTL",
        read: "Vertices, normals, texture coordinates, faces, points and materials (`.obj`, \
               `.mtl`).",
        rows: &[
            Finding {
                found: "concave faces, holes behind a bridge, faces that are not quite flat",
                outcome: Read,
                told: "cut into triangles; convex faces are fans",
            },
            Finding {
                found: "UTF-16; a byte order mark; lines that end in CR, LF or both",
                outcome: Read,
                told: "as UTF-8; what is neither is Latin-1",
            },
            Finding {
                found: "keywords in capitals, comments at the end of a line, `1/1/0`, faces before \
                        vertices, `usemtl` before its `mtllib`",
                outcome: Read,
                told: "as it is meant",
            },
            Finding {
                found: "points (`p`), or vertices alone, with colours or without",
                outcome: Read,
                told: "a cloud",
            },
            Finding {
                found: "a face that names a vertex that does not exist",
                outcome: Mended,
                told: "left out, `triangles_out_of_range`",
            },
            Finding {
                found: "faces that count vertices from 0",
                outcome: Mended,
                told: "read so, `faces_from_zero`",
            },
            Finding {
                found: "a vertex that is NaN, infinite or no number",
                outcome: Mended,
                told: "its triangles or its point are left out, `triangles_without_place`, \
                       `points_without_place`; one in no face is an `unused_vertices`",
            },
            Finding {
                found: "a normal that is NaN, or that does not exist",
                outcome: Mended,
                told: "made from the faces, `normals_made`, `normals_not_found`",
            },
            Finding {
                found: "texture coordinates that are NaN, or that do not exist",
                outcome: Mended,
                told: "those of neighbours, `uvs_made`; none, `uvs_not_found`",
            },
            Finding {
                found: "colours that are NaN",
                outcome: Mended,
                told: "white, `colours_made`",
            },
            Finding {
                found: "`0,5`; a vertex of two coordinates",
                outcome: Mended,
                told: "0.5, `decimal_commas`; the third is 0, `coordinates_made`",
            },
            Finding {
                found: "a face whose outline crosses itself",
                outcome: Mended,
                told: "filled as well as can be, `faces_crossing_themselves`",
            },
            Finding {
                found: "concave faces of some ten thousand corners",
                outcome: Mended,
                told: "fans, `faces_too_large`",
            },
            Finding {
                found: "a line of a material that says no colour",
                outcome: Mended,
                told: "left out, `lines_broken`",
            },
            Finding {
                found: "`f 1,2,3`; `1 /1`; `// comments`",
                outcome: Mended,
                told: "as it is meant, `faces_with_odd_signs`",
            },
            Finding {
                found: "`usemtl` that differs from `newmtl` in capitals or blanks; two different \
                        materials of one name",
                outcome: Mended,
                told: "that material, `materials_found_by_case`; the last, \
                       `materials_defined_twice`",
            },
            Finding {
                found: "a material that does not exist; a library that is not text",
                outcome: Mended,
                told: "white, `materials_not_found`, `material_files_missing`",
            },
            Finding {
                found: "`Kd 0 0 0` under colours of vertices; colours that ZBrush painted \
                        (`#MRGB`); `Kd xyz`",
                outcome: Read,
                told: "these colours: `black_under_colours`, `colours_of_another_number`",
            },
            Finding {
                found: "`Kd spectral`; `-mm` or `-t` of a picture",
                outcome: Remarked,
                told: "grey, `spectra_left_out`; as it is, `texture_options_left_out`",
            },
            Finding {
                found: "`d`, `Tr`, `map_d`, a picture with an alpha",
                outcome: Remarked,
                told: "opaque, `drawn_opaque`",
            },
            Finding {
                found: "`d 0` or `Tr 1`; `d` and `Tr` that differ",
                outcome: Mended,
                told: "not drawn, `triangles_hidden`, unless nothing else is there; `d` counts, \
                       `opacities_said_twice`",
            },
            Finding {
                found: "a face with fewer than three corners, as at the end of a cut file; in any \
                        format",
                outcome: Mended,
                told: "left out, `faces_under_three_corners`",
            },
            Finding {
                found: "a picture on faces without texture coordinates",
                outcome: Remarked,
                told: "one colour, `textures_without_coordinates`",
            },
            Finding {
                found: "colours of vertices from 0 to 255",
                outcome: Mended,
                told: "the largest code counts as full light, `colours_rescaled`",
            },
            Finding {
                found: "triangles so far from all others that the grid of the mesh would have no \
                        detail",
                outcome: Mended,
                told: "an object with a grid of its own, `outlier_triangles`, with a remark",
            },
            Finding {
                found: "`Kd 128 64 200`; a `Kd` beyond 1",
                outcome: Mended,
                told: "255 counts as full light, `colours_rescaled`; cut, `colours_cut`",
            },
            Finding {
                found: "`map_Ka` without `map_Kd`; `Kd 0 0 0` with `Ke`",
                outcome: Mended,
                told: "that picture, `pictures_of_other_kinds`; the light, \
                       `lights_shown_as_colours`",
            },
            Finding {
                found: "faces that are there again, reversed, in any format",
                outcome: Remarked,
                told: "one surface with two sides; with another look, each from its own side: \
                       `two_sided_faces`",
            },
            Finding {
                found: "`mtllib` and `map_Kd` with the folders of another machine",
                outcome: Mended,
                told: "the file of that name next to the model, as of [textures](#textures); \
                       without one the shape comes in its colour",
            },
            Finding {
                found: "`1.0f`; numbers of Fortran (`1.0D+00`)",
                outcome: Read,
                told: "as meant",
            },
            Finding {
                found: "numbers without a blank between them (`0.5-0.3`) where the line has too \
                        few",
                outcome: Mended,
                told: "read one by one, `numbers_without_blanks`; else the line is left out, \
                       `lines_broken`",
            },
            Finding {
                found: "`call` of another file; `usemap`",
                outcome: Remarked,
                told: "left out, `files_left_out`; not drawn, `missing_images`",
            },
            Finding {
                found: "materials of no file that exists, next to a `.mtl` with the name of the \
                        model",
                outcome: Mended,
                told: "that file, `files_found_elsewhere`",
            },
            Finding {
                found: "vertices that all are black, in any format; a scene less than 2 nm \
                        across",
                outcome: Remarked,
                told: "drawn black, `black_surfaces`; too small to be looked at",
            },
            Finding {
                found: "a Git LFS pointer, web page, archive or model of another format under \
                        this name, in any format",
                outcome: Refused,
                told: "the message says what it is and what to do",
            },
            Finding {
                found: "lines, curves, free-form surfaces",
                outcome: Remarked,
                told: "left out, `lines_left_out`, `curves_left_out`",
            },
            Finding {
                found: "lines alone, or triangles without any area",
                outcome: Refused,
                told: "there is nothing to show",
            },
        ],
    },
    Format {
        name: "PLY meshes",
        read: "Text and both binary orders (`.ply`). A file without faces is a cloud, below.",
        rows: PLY,
    },
    Format {
        name: "STL",
        read: "Text and binary (`.stl`).",
        rows: STL,
    },
];

const PLY: &[Finding] = &[
    Finding {
        found: "colours of vertices from 0 to 255 as `int`, `float` or `double`, or of another \
                depth than their numbers",
        outcome: Mended,
        told: "the largest code counts as full light, `colours_rescaled`",
    },
    Finding {
        found: "corners of faces under other names (`indices`; `v1`, `v2`, `v3`), or counted from \
                1",
        outcome: Mended,
        told: "as meant, `corners_of_another_name`, `faces_from_one`",
    },
    Finding {
        found: "numbers in the other order of bytes than the header says, so that no coordinate \
                can be meant; of clouds too",
        outcome: Mended,
        told: "in that order, `byte_orders_mended`",
    },
    Finding {
        found: "materials with `material_index`",
        outcome: Read,
        told: "their colours are drawn; others are left out, `materials_left_out`",
    },
    Finding {
        found: "`scalar_Red` and the like of CloudCompare; an alpha below 1",
        outcome: Read,
        told: "colours; drawn opaque, `drawn_opaque`",
    },
    Finding {
        found: "colours of faces",
        outcome: Read,
        told: "drawn; left out with a remark where vertices have colours too",
    },
    Finding {
        found: "triangles so far from all others that the grid of the mesh would have no detail",
        outcome: Mended,
        told: "an object with a grid of its own, `outlier_triangles`, with a remark",
    },
    Finding {
        found: "concave faces, strips of triangles, other lists and elements",
        outcome: Read,
        told: "faces as those of OBJ; the rest is passed over",
    },
    Finding {
        found: "text in UTF-16, lines that end in CR, types in capitals, 64-bit integers, comments \
                between rows",
        outcome: Read,
        told: "as it is meant",
    },
    Finding {
        found: "rows that are missing at the end",
        outcome: Mended,
        told: "the others are shown, `rows_missing`; without any face, vertices are points",
    },
    Finding {
        found: "a face that names a vertex that does not exist",
        outcome: Mended,
        told: "left out, `triangles_out_of_range`",
    },
    Finding {
        found: "vertices that are NaN or infinite, as depth cameras write them",
        outcome: Mended,
        told: "points are left out, `points_without_place`; so are triangles, \
               `triangles_without_place`",
    },
    Finding {
        found: "normals or colours that are NaN",
        outcome: Mended,
        told: "made from the faces, `normals_made`; white, `colours_made`",
    },
    Finding {
        found: "rows of text with more or fewer values than announced",
        outcome: Mended,
        told: "the rest is left out, `rows_too_long`; what is missing is NaN",
    },
    Finding {
        found: "text with another number of vertices than announced before its faces",
        outcome: Mended,
        told: "read by its lines, `rows_missing`, `rows_beyond_count`",
    },
    Finding {
        found: "numbers without a blank between them (`0.5-0.3`) in rows without lists",
        outcome: Mended,
        told: "read one by one, `numbers_without_blanks`",
    },
    Finding {
        found: "edges",
        outcome: Remarked,
        told: "not drawn, `lines_left_out`",
    },
    Finding {
        found: "keywords in capitals, `vertices`, `points`, `faces`, `triangles` for elements; \
                numbers of 16 bits (`half`)",
        outcome: Read,
        told: "as meant",
    },
    Finding {
        found: "vertices without `z`",
        outcome: Mended,
        told: "at 0, `coordinates_made`",
    },
    Finding {
        found: "rows beyond those announced",
        outcome: Mended,
        told: "left out, `rows_left_out`",
    },
    Finding {
        found: "no x and y; no end of the header",
        outcome: Refused,
        told: "there is nothing to show",
    },
];

const STL: &[Finding] = &[
    Finding {
        found: "colours of VisCAM and Magics in the last two bytes of triangles, `COLOR=` in the \
                head",
        outcome: Read,
        told: "drawn",
    },
    Finding {
        found: "such bytes that are no colours",
        outcome: Remarked,
        told: "not drawn",
    },
    Finding {
        found: "loops of more than three corners",
        outcome: Read,
        told: "as faces of OBJ",
    },
    Finding {
        found: "`solid` at the start of a binary file, UTF-16, all words in one line, zeros at the \
                end, bytes behind triangles that these count",
        outcome: Read,
        told: "as it is meant",
    },
    Finding {
        found: "triangles without area, or twice",
        outcome: Mended,
        told: "left out, `zero_area_triangles`, `duplicate_triangles`",
    },
    Finding {
        found: "triangles that are NaN or infinite",
        outcome: Mended,
        told: "left out, `triangles_without_place`",
    },
    Finding {
        found: "fewer triangles than announced, or no `endsolid`",
        outcome: Mended,
        told: "those that are whole are shown, `rows_missing`",
    },
    Finding {
        found: "more triangles than announced",
        outcome: Mended,
        told: "shown, `rows_beyond_count`",
    },
    Finding {
        found: "words that STL does not have",
        outcome: Mended,
        told: "their lines are left out, `lines_broken`",
    },
];
