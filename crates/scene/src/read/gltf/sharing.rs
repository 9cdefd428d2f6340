//! Which meshes of a glTF file are the same one?
//!
//! Exporters write a mesh again for each node that shows it, with the same accessors. What says the
//! same is read, built and sent once, and stands in several places.

use std::collections::{HashMap, HashSet};

use super::json::{Document, Primitive};

/// Lets nodes show the first of all meshes that say the same, and forgets what meshes say that no
/// node shows.
pub(super) fn share_meshes(document: &mut Document) {
    let of = first_of_each(document);
    let mut shown = HashSet::new();
    for mesh in document.nodes.iter_mut().filter_map(|it| it.mesh.as_mut()) {
        *mesh = of.get(*mesh as usize).copied().unwrap_or(*mesh);
        shown.insert(*mesh);
    }
    // Of a file without nodes all meshes are shown.
    if document.nodes.is_empty() {
        shown.extend(of);
    }
    for (mesh, number) in document.meshes.iter_mut().zip(0..) {
        if !shown.contains(&number) {
            mesh.primitives = Vec::new();
        }
    }
}

/// For each mesh the first that says the same.
fn first_of_each(document: &Document) -> Vec<u32> {
    let mut first: HashMap<(Vec<u64>, &[Primitive]), u32> = HashMap::new();
    let meshes = document.meshes.iter().zip(0..);
    let of = meshes.map(|(mesh, number)| {
        let weights = mesh.weights.iter().map(|it| it.to_bits()).collect();
        let says = (weights, mesh.primitives.as_slice());
        *first.entry(says).or_insert(number)
    });
    of.collect()
}
