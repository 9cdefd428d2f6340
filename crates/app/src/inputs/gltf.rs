//! glTF 2.0 and GLB.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[Format {
    name: "glTF",
    read: "glTF 2.0 as `.gltf` with its files, or `.glb` (`.vrm`): meshes, points, base colours \
           and their textures, unlit materials, instances, quantised numbers.",
    rows: &[
        Finding {
            found: "buffers packed by Draco or meshopt",
            outcome: Read,
            told: "unpacked",
        },
        Finding {
            found: "data URIs in several lines, with blanks, in capitals, with the base64 of \
                    addresses or without its `=`",
            outcome: Read,
            told: "as meant",
        },
        Finding {
            found: "a file that is really called `a%20b.bin`; `byteStride` 0; JSON of a `.glb` \
                    filled up with zeros; a version that is a number, or none",
            outcome: Read,
            told: "as meant",
        },
        Finding {
            found: "JSON that breaks its rules: `81.0` for a count, line breaks in texts, `null`, \
                    -1 for nothing, commas too many, comments, `NaN`, numbers in quotes",
            outcome: Mended,
            told: "`repairs.json_mended`, with a remark",
        },
        Finding {
            found: "members given twice; lists that are too short (`baseColorFactor`, `scale`, \
                    `rotation`, `translation`); `[]` for `{}`; names in small letters, \
                    `TEXCOORD` without a number; kinds by name (`FLOAT`)",
            outcome: Mended,
            told: "the last counts; filled up; as meant: `repairs.json_mended`, with a remark. \
                   What cannot be read is left out by itself",
        },
        Finding {
            found: "numbers of 64 or 16 bits, signed indices; a stride that is too small; a \
                    buffer view without a length",
            outcome: Mended,
            told: "as in OpenGL, `repairs.components_of_another_kind`, \
                   `indices_of_another_kind`; packed tightly, `strides_mended`; up to the end of \
                   the buffer, `views_without_length`",
        },
        Finding {
            found: "colour factors up to 255; colours of vertices that are eight-bit codes \
                    in sixteen bits",
            outcome: Mended,
            told: "the largest code counts as full light, `repairs.colours_rescaled`",
        },
        Finding {
            found: "a texture on a part without its texture coordinates",
            outcome: Remarked,
            told: "one colour, `repairs.textures_without_coordinates`",
        },
        Finding {
            found: "`alphaMode` BLEND",
            outcome: Remarked,
            told: "opaque, `repairs.drawn_opaque`; the mask of a picture (MASK) is cut out",
        },
        Finding {
            found: "a factor of alpha of 0 with BLEND, or below `alphaCutoff` with MASK",
            outcome: Mended,
            told: "not drawn, `repairs.triangles_hidden`, unless nothing else is there",
        },
        Finding {
            found: "a node with a matrix and also a translation, rotation or scale",
            outcome: Mended,
            told: "the matrix counts, `repairs.nodes_placed_twice`",
        },
        Finding {
            found: "`CESIUM_RTC`",
            outcome: Remarked,
            told: "everything is placed at its centre",
        },
        Finding {
            found: "a buffer or picture named as on another machine (`C:\\..`, `../`, other \
                    capitals)",
            outcome: Mended,
            told: "the file of that name next to the model is used: \
                   `repairs.files_found_elsewhere`, `repairs.files_found_by_case`, with a remark",
        },
        Finding {
            found: "colours of vertices in whole numbers that are not said to be normalised, or \
                    real ones up to 255",
            outcome: Mended,
            told: "the largest code counts as full light, `repairs.colours_not_normalised`",
        },
        Finding {
            found: "`KHR_materials_pbrSpecularGlossiness`",
            outcome: Remarked,
            told: "diffuse factor and texture are drawn, gloss is not",
        },
        Finding {
            found: "extensions that must be understood but change no shape: metadata, lights, \
                    looks of materials, sound, physics",
            outcome: Remarked,
            told: "drawn without them",
        },
        Finding {
            found: "animations and skins",
            outcome: Remarked,
            told: "shown at rest",
        },
        Finding {
            found: "a picture that is missing, damaged or outside the folder",
            outcome: Remarked,
            told: "the surface has its colour alone, `repairs.missing_images`; files outside are \
                   opened with `--allow-outside`",
        },
        Finding {
            found: "triangles so far from all others that the grid of the mesh would have no \
                    detail",
            outcome: Mended,
            told: "an object with a grid of its own, `repairs.outlier_triangles`, with a remark",
        },
        Finding {
            found: "a part, accessor, view or buffer that is missing or cannot be read",
            outcome: Mended,
            told: "the other parts are shown, `repairs.parts_left_out`; without normals, colours \
                   or texture coordinates, `repairs.attributes_left_out`",
        },
        Finding {
            found: "accessors and views that reach beyond their bytes; lists of another length \
                    than that of the vertices",
            outcome: Mended,
            told: "what exists is used: `repairs.accessors_cut`, `views_cut`, \
                   `attributes_of_another_length`",
        },
        Finding {
            found: "a scene, node, mesh, material or sampler that does not exist",
            outcome: Mended,
            told: "scene 0, else left out, white or repeated: `repairs.scenes_not_found`, \
                   `nodes_not_found`, `materials_not_found`, `samplers_not_found`",
        },
        Finding {
            found: "nodes in a circle, or with several parents",
            outcome: Mended,
            told: "shown once, `repairs.nodes_in_themselves`; below each, \
                   `nodes_with_several_parents`",
        },
        Finding {
            found: "a rotation, matrix, skin or list of instances without meaning",
            outcome: Mended,
            told: "left out, `repairs.places_mended`",
        },
        Finding {
            found: "the largest index of its kind (65535) in a strip, fan or list",
            outcome: Mended,
            told: "a new one begins there, `repairs.strips_begun_again`",
        },
        Finding {
            found: "chunks of a `.glb` of kinds that glTF does not have",
            outcome: Read,
            told: "passed over",
        },
        Finding {
            found: "glTF 1.0",
            outcome: Refused,
            told: "the message says so, and what converts it",
        },
        Finding {
            found: "a `.glb` of another length than it says",
            outcome: Mended,
            told: "what exists is read, `repairs.lengths_mended`",
        },
        Finding {
            found: "a black surface that gives off light",
            outcome: Mended,
            told: "shown in the colour of that light, `repairs.lights_shown_as_colours`",
        },
        Finding {
            found: "faces that are there again, reversed",
            outcome: Remarked,
            told: "one surface with two sides; with another look, each from its own side: \
                   `repairs.two_sided_faces`",
        },
        Finding {
            found: "no part that can be read; extensions that must be understood and may change \
                    shapes",
            outcome: Refused,
            told: "what is right cannot be known",
        },
        Finding {
            found: "no triangle and no point",
            outcome: Refused,
            told: "there is nothing to show",
        },
    ],
}];
