//! Which surfaces are seen through wholly, and so are not drawn?
//!
//! Hulls for collisions, and parts that are switched off, have materials without any opacity.

use foveal_core::units::counted;

use super::super::sound::count;
use super::super::text::shortened;
use crate::source::{Material, SourceScene, keep};

/// Whether nothing of a material is seen.
pub(in crate::read) fn is_hidden(material: &Material) -> bool {
    material.colour[3] <= 0.0
}

/// Leaves out triangles of hidden materials; where nothing else is there, all of them stay, as some
/// programs write opacity the other way round. Triangles name vertices that exist.
pub(in crate::read) fn leave_out(scene: &mut SourceScene) {
    let hidden: Vec<bool> = scene.materials.iter().map(is_hidden).collect();
    let of = |material: &u32| hidden.get(*material as usize).copied().unwrap_or(false);
    let meshes = scene.meshes.iter();
    let all: usize = meshes.map(|it| it.triangles.len()).sum();
    let mut used: Vec<u32> = scene
        .meshes
        .iter()
        .flat_map(|it| it.materials.iter().copied())
        .filter(of)
        .collect();
    let times = used.len();
    used.sort_unstable();
    used.dedup();
    let Some(first) = used.first() else {
        return;
    };
    let first = shortened(&scene.materials[*first as usize].name);
    let materials = counted(used.len() as u64, "material");
    if times == all && scene.clouds.is_empty() {
        count(&mut scene.repairs, "drawn_opaque", used.len());
        scene.remark(format!(
            "all of it is wholly transparent, and drawn opaque, as nothing would be seen: \
             {materials}, the first {first:?}"
        ));
        return;
    }
    for mesh in &mut scene.meshes {
        let stays: Vec<bool> = mesh.materials.iter().map(|it| !of(it)).collect();
        if stays.contains(&false) {
            keep(&mut mesh.triangles, &stays);
            keep(&mut mesh.materials, &stays);
            mesh.leave_out_unused_vertices();
        }
    }
    count(&mut scene.repairs, "triangles_hidden", times);
    scene.remark(format!(
        "what is wholly transparent is not drawn: {} of {materials}, the first {first:?}",
        counted(times as u64, "triangle")
    ));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::SourceMesh;
    use glam::DVec3;

    fn scene(opacities: [f32; 2]) -> SourceScene {
        let mesh = SourceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 1, 2], [0, 1, 3]],
            materials: vec![0, 1],
            ..SourceMesh::default()
        };
        let material = |opacity| Material {
            colour: [1.0, 1.0, 1.0, opacity],
            ..Material::default()
        };
        SourceScene {
            meshes: vec![mesh],
            materials: opacities.map(material).to_vec(),
            ..SourceScene::default()
        }
    }

    #[test]
    fn only_what_is_wholly_transparent_goes_and_never_all() {
        for (opacities, left, name) in [
            ([1.0, 0.0], 1, Some("triangles_hidden")),
            ([1.0, 0.1], 2, None),
            ([0.0, 0.0], 2, Some("drawn_opaque")),
        ] {
            let mut found = scene(opacities);
            leave_out(&mut found);
            assert_eq!(found.meshes[0].triangles.len(), left);
            assert_eq!(found.meshes[0].positions.len(), left + 2);
            assert_eq!(found.repairs.keys().next().map(String::as_str), name);
            assert_eq!(found.remarks.len(), usize::from(name.is_some()));
        }
    }
}
