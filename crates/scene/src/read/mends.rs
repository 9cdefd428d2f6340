//! What was mended in a file, how often, and where first?

use std::collections::BTreeMap;

use super::text::shortened;
use crate::source::SourceScene;

/// A kind of mend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Mend {
    /// Its name in `repairs`.
    pub(super) name: &'static str,
    /// What was found, in the plural, and what was done.
    pub(super) what: &'static str,
}

/// A triangle, or a face, names vertices that are not there.
pub(super) const OUT_OF_RANGE: Mend = Mend {
    name: "triangles_out_of_range",
    what: "faces that name vertices that do not exist are left out",
};
/// A corner is at NaN or infinity.
pub(super) const NO_PLACE: Mend = Mend {
    name: "triangles_without_place",
    what: "triangles with a corner that is NaN or infinite are left out",
};
/// The same of a point.
pub(super) const POINT_WITHOUT_PLACE: Mend = Mend {
    name: "points_without_place",
    what: "points that are NaN or infinite, or do not exist, are left out",
};
/// A place on a texture is NaN or infinity.
pub(super) const UV_MADE: Mend = Mend {
    name: "uvs_made",
    what: "texture coordinates that are no numbers are taken from neighbouring vertices",
};
/// A face names a place on a texture that is not there.
pub(super) const UV_NOT_FOUND: Mend = Mend {
    name: "uvs_not_found",
    what: "texture coordinates that faces name do not exist: left out",
};
/// A face names a normal that is not there.
pub(super) const NORMAL_NOT_FOUND: Mend = Mend {
    name: "normals_not_found",
    what: "normals that faces name do not exist: made from the faces",
};
/// A colour is NaN.
pub(super) const COLOUR_MADE: Mend = Mend {
    name: "colours_made",
    what: "colours that are no numbers are shown white",
};
/// Of red, green and blue not all are there.
pub(super) const COLOUR_INCOMPLETE: Mend = Mend {
    name: "colours_incomplete",
    what: "colours of which red, green or blue is missing are left out",
};
/// The file ends before all rows that it announces.
pub(super) const ROW_MISSING: Mend = Mend {
    name: "rows_missing",
    what: "rows that the file announces are missing; the others are shown",
};
/// A number has no blank before it.
pub(super) const GLUED: Mend = Mend {
    name: "numbers_without_blanks",
    what: "rows have numbers without a blank between them (`0.5-0.3`, `1,2,3`), which are read one \
           by one",
};
/// Indices begin a strip again.
pub(super) const RESTARTED: Mend = Mend {
    name: "strips_begun_again",
    what: "lists of indices hold the largest number of their kind, which glTF does not allow: a \
           new strip, fan or triangle begins there",
};
/// Rows that connect vertices by lines.
pub(super) const EDGES_LEFT: Mend = Mend {
    name: "lines_left_out",
    what: "edges are lines, which are not drawn",
};
/// More rows than announced.
pub(super) const ROW_BEYOND: Mend = Mend {
    name: "rows_beyond_count",
    what: "rows beyond the number that the file announces are shown",
};
/// The same where they are not shown.
pub(super) const ROW_LEFT: Mend = Mend {
    name: "rows_left_out",
    what: "rows beyond the number that the file announces are left out",
};
/// A line, or a word of it, has no meaning where it stands.
pub(super) const LINE_BROKEN: Mend = Mend {
    name: "lines_broken",
    what: "lines with words that their format does not have, or that are no numbers, are left out",
};
/// A row has more words than it should.
pub(super) const WORDS_BEYOND: Mend = Mend {
    name: "rows_too_long",
    what: "rows have more values than announced; the rest of each is left out",
};
/// A face is no surface.
pub(super) const SHORT_FACE: Mend = Mend {
    name: "faces_under_three_corners",
    what: "faces with fewer than three corners, as where a file breaks off, are left out",
};
/// A curve or a surface of formulas.
pub(super) const CURVE_LEFT: Mend = Mend {
    name: "curves_left_out",
    what: "curves and free-form surfaces are not drawn",
};
/// Two lines say how opaque a material is.
pub(super) const OPACITY_TWICE: Mend = Mend {
    name: "opacities_said_twice",
    what: "materials say by `d` and by `Tr` how opaque they are, and these differ: `d` counts",
};
/// Numbers are stored the other way round.
pub(super) const BYTE_ORDER: Mend = Mend {
    name: "byte_orders_mended",
    what: "numbers are stored in the other order of bytes than the header says, and are read so",
};
/// Commas separate corners, or corners have blanks within.
pub(super) const FACE_SIGNS: Mend = Mend {
    name: "faces_with_odd_signs",
    what: "faces have commas between their corners, or blanks within them: read as meant",
};
/// Faces count vertices from 1.
pub(super) const FROM_ONE: Mend = Mend {
    name: "faces_from_one",
    what: "faces that count vertices from 1 are read so",
};
/// The corners of faces have another name.
pub(super) const CORNERS_NAMED: Mend = Mend {
    name: "corners_of_another_name",
    what: "the corners of faces are not called `vertex_indices`, and are read all the same",
};
/// Materials of faces are not all there.
pub(super) const PLY_MATERIALS: Mend = Mend {
    name: "materials_left_out",
    what: "materials that have no red, green and blue, or that nothing names, are left out",
};
/// Two materials have one name.
pub(super) const MATERIAL_TWICE: Mend = Mend {
    name: "materials_defined_twice",
    what: "materials are defined twice, in different ways: the last of each is shown",
};
/// There is a material of nearly this name.
pub(super) const MATERIAL_NEARLY: Mend = Mend {
    name: "materials_found_by_case",
    what: "materials have names that differ in capitals or blanks from those that are named, \
           and are used for them",
};
/// A black material under colours.
pub(super) const BLACK_UNDER_COLOURS: Mend = Mend {
    name: "black_under_colours",
    what: "materials are black, but the vertices of their surfaces have colours, which are shown",
};
/// Options that change a picture are ignored.
pub(super) const MAP_OPTION_LEFT: Mend = Mend {
    name: "texture_options_left_out",
    what: "pictures should be made brighter, darker or turbulent (`-mm`, `-t`): they are shown \
           unchanged",
};
/// A spectrum gives a colour.
pub(super) const SPECTRUM_LEFT: Mend = Mend {
    name: "spectra_left_out",
    what: "files of spectra give colours of materials, and are not read: these materials are grey",
};
/// ZBrush painted more or fewer colours than there are vertices.
pub(super) const POLYPAINT_LENGTH: Mend = Mend {
    name: "colours_of_another_number",
    what: "painted colours (`#MRGB`) are more or fewer than the vertices: vertices without one \
           are white",
};
/// A coordinate is missing.
pub(super) const FLAT: Mend = Mend {
    name: "coordinates_made",
    what: "vertices without a third coordinate are at 0",
};
/// A number is written with a comma.
pub(super) const COMMA: Mend = Mend {
    name: "decimal_commas",
    what: "numbers with a decimal comma are read as with a point",
};
/// An outline cannot be filled.
pub(super) const CROSSING: Mend = Mend {
    name: "faces_crossing_themselves",
    what: "faces whose outline crosses itself are filled as well as can be",
};
/// A fan of glTF turns back over itself.
pub(super) const FAN_FILLED: Mend = Mend {
    name: "concave_fans_filled",
    what: "fans of triangles that turn back over themselves are filled as outlines",
};
/// An outline has too many corners.
pub(super) const NOT_FILLED: Mend = Mend {
    name: "faces_too_large",
    what: "concave faces with too many corners are drawn as fans, which may cover too much; \
           triangulate them where they were made",
};
/// Faces count vertices from 0.
pub(super) const FROM_ZERO: Mend = Mend {
    name: "faces_from_zero",
    what: "faces that count vertices from 0 are read so",
};

/// What a part of a glTF file names is not there, or cannot be read.
pub(super) const PART_LEFT: Mend = Mend {
    name: "parts_left_out",
    what: "parts of meshes that cannot be read are left out",
};
/// The same of what vertices have besides a place.
pub(super) const ATTRIBUTE_LEFT: Mend = Mend {
    name: "attributes_left_out",
    what: "normals, colours or texture coordinates that cannot be read are left out",
};
/// They are more or fewer than the vertices.
pub(super) const ATTRIBUTE_LENGTH: Mend = Mend {
    name: "attributes_of_another_length",
    what: "lists of normals, colours or texture coordinates are longer or shorter than that of \
           the vertices: those that exist are used",
};
/// A shape of a mesh at rest cannot be read.
pub(super) const SHAPE_LEFT: Mend = Mend {
    name: "shapes_left_out",
    what: "shapes that move other numbers of vertices, or cannot be read, are left out",
};
/// An accessor claims more elements than its view has.
pub(super) const ACCESSOR_CUT: Mend = Mend {
    name: "accessors_cut",
    what: "accessors claim more elements than there are bytes for: those that exist are used",
};
/// A sparse accessor replaces elements that are not there.
pub(super) const SPARSE_LEFT: Mend = Mend {
    name: "sparse_elements_left_out",
    what: "sparse accessors replace elements that do not exist: left out",
};
/// Numbers of vertices are signed or real.
pub(super) const ODD_INDICES: Mend = Mend {
    name: "indices_of_another_kind",
    what: "lists of indices are not of unsigned whole numbers, and are read as if they were",
};
/// Numbers are of a kind that OpenGL has and glTF does not.
pub(super) const ODD_COMPONENTS: Mend = Mend {
    name: "components_of_another_kind",
    what: "accessors have kinds of numbers that glTF does not have: read as in OpenGL",
};
/// Elements would overlap.
pub(super) const STRIDE_TOO_SMALL: Mend = Mend {
    name: "strides_mended",
    what: "strides are shorter than their elements: the elements are read one after the other",
};
/// A view has no bytes.
pub(super) const VIEW_EMPTY: Mend = Mend {
    name: "views_without_length",
    what: "buffer views claim to have no bytes: they are read up to the end of their buffers",
};
/// A view goes beyond its buffer.
pub(super) const VIEW_CUT: Mend = Mend {
    name: "views_cut",
    what: "buffer views end beyond their buffers: the bytes that exist are used",
};
/// What is compressed cannot be unpacked.
pub(super) const PACKED_LEFT: Mend = Mend {
    name: "compressed_parts_left_out",
    what: "compressed parts that cannot be unpacked are left out",
};
/// A part has a material that is not there.
pub(super) const MATERIAL_NOT_FOUND: Mend = Mend {
    name: "materials_not_found",
    what: "materials that parts of meshes name do not exist: these parts are white",
};
/// A material with a picture lies on a surface without texture coordinates.
pub(super) const TEXTURE_WITHOUT_UVS: Mend = Mend {
    name: "textures_without_coordinates",
    what: "parts of meshes have a texture, but no texture coordinates: they are shown in one \
           colour, without the picture",
};
/// A texture has a sampler that is not there.
pub(super) const SAMPLER_NOT_FOUND: Mend = Mend {
    name: "samplers_not_found",
    what: "samplers that textures name do not exist: these textures repeat",
};
/// A scene, a node or a mesh that is named is not there.
pub(super) const NODE_NOT_FOUND: Mend = Mend {
    name: "nodes_not_found",
    what: "nodes, or their meshes, that the file names do not exist: left out",
};
/// The scene to show is not there.
pub(super) const SCENE_NOT_FOUND: Mend = Mend {
    name: "scenes_not_found",
    what: "the scene to show does not exist, or there is none: another is shown in its place",
};
/// A node is below itself.
pub(super) const NODE_IN_ITSELF: Mend = Mend {
    name: "nodes_in_themselves",
    what: "nodes that are below themselves are shown once there",
};
/// A node is a child of several.
pub(super) const NODE_SHARED: Mend = Mend {
    name: "nodes_with_several_parents",
    what: "nodes that have several parents, which glTF does not allow, are shown below each",
};
/// A node stands in two ways.
pub(super) const NODE_PLACED_TWICE: Mend = Mend {
    name: "nodes_placed_twice",
    what: "nodes have a matrix and also a translation, rotation or scale, which glTF does not \
           allow: the matrix counts",
};
/// A place has no meaning.
pub(super) const PLACE_MENDED: Mend = Mend {
    name: "places_mended",
    what: "rotations, matrices, skins or instances of nodes that have no meaning are left out",
};

/// All mends of a file: how often each kind was needed, and where first.
#[derive(Debug, Default)]
pub(super) struct Mends(BTreeMap<Mend, (usize, String)>);

impl Mends {
    /// Counts a mend; `place` says where, and is asked for the first of its kind alone.
    pub(super) fn add(&mut self, mend: Mend, times: usize, place: impl FnOnce() -> String) {
        if times > 0 {
            self.0.entry(mend).or_insert_with(|| (0, place())).0 += times;
        }
    }

    /// How often a mend was needed.
    pub(super) fn times(&self, mend: Mend) -> usize {
        self.0.get(&mend).map_or(0, |(times, _)| *times)
    }

    /// Reports them to a scene: by number, and in words for people.
    pub(super) fn tell(self, file: &str, scene: &mut SourceScene) {
        for (mend, (times, place)) in self.0 {
            *scene.repairs.entry(mend.name.to_owned()).or_default() += times as u64;
            let file = shortened(file);
            scene.remark(format!("{file}: {}: {times}, the first {place}", mend.what));
        }
    }
}
