//! Which properties of a face of a PLY file name its corners?

use super::header::{Element, Property, Scalar};

/// Names of lists of corners, also those that other programs write.
const NAMES: [&str; 4] = [
    "vertex_indices",
    "vertex_index",
    "vertex_indexes",
    "vertices",
];
/// Names of single corners: with a number after them, and by themselves.
const NUMBERED: [&str; 5] = ["v", "vertex", "index", "p", "vertex_index"];
const LETTERS: [&str; 7] = ["a", "b", "c", "d", "i", "j", "k"];

/// Which properties of a face name its corners.
#[derive(Default)]
pub(super) struct Corners {
    /// The list of them.
    pub(super) at: Option<usize>,
    /// Or a number for each.
    pub(super) scalars: Vec<usize>,
    /// The name of the first one.
    pub(super) name: String,
    pub(super) is_of_another_name: bool,
    /// The number of the material of the face.
    pub(super) material: Option<usize>,
}

impl Corners {
    /// Those of an element: a list with one of the known names, else the first list of whole
    /// numbers, else numbers such as `v1`, `v2` and `v3`.
    pub(super) fn of(element: &Element) -> Self {
        let list = |is_it: &dyn Fn(&str, Scalar) -> bool| {
            element.properties.iter().position(|it| match it {
                Property::List { name, scalar, .. } => is_it(&name.to_ascii_lowercase(), *scalar),
                Property::One { .. } => false,
            })
        };
        let of_format = list(&|name, _| NAMES.contains(&name));
        let other = || list(&|name, scalar| scalar.is_whole() && !name.starts_with("tex"));
        let mut corners = Self {
            at: of_format.or_else(other),
            is_of_another_name: of_format.is_none(),
            material: element.properties.iter().position(is_material),
            ..Self::default()
        };
        if corners.at.is_none() {
            let all = element.properties.iter().enumerate();
            let found: Vec<usize> = all.filter(|(_, it)| is_corner(it)).map(|it| it.0).collect();
            corners.scalars = if found.len() >= 3 { found } else { Vec::new() };
        }
        let first = corners.at.or_else(|| corners.scalars.first().copied());
        let named = first.and_then(|at| element.properties.get(at));
        corners.name = named.map_or_else(String::new, |it| match it {
            Property::One { name, .. } | Property::List { name, .. } => name.clone(),
        });
        corners.is_of_another_name &= first.is_some();
        corners
    }
}

fn is_material(property: &Property) -> bool {
    let Property::One { name, .. } = property else {
        return false;
    };
    name.eq_ignore_ascii_case("material_index")
}

/// Whether a property names one corner.
fn is_corner(property: &Property) -> bool {
    let Property::One { name, scalar } = property else {
        return false;
    };
    let name = name.to_ascii_lowercase();
    let letters = name.trim_end_matches(|it: char| it.is_ascii_digit());
    let has_number = letters.len() < name.len();
    let is_numbered = has_number && NUMBERED.contains(&letters.trim_end_matches('_'));
    scalar.is_whole() && (is_numbered || LETTERS.contains(&&*name))
}
