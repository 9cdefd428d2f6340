//! Does a scene come back from its units?

mod meshes;

use super::{BuildOptions, Built, build};
use crate::source::Source;
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::{MeshUnit, MeshVertex};
use foveal_core::pack::unit::UnitId;
use meshes::{fan, many_pieces, sheet, sphere, torus, triangle, two_materials};

fn built(source: &Source) -> Built {
    build(source, &BuildOptions::default(), &|_, _| ()).unwrap()
}

fn parsed(built: &Built, unit: usize) -> MeshUnit {
    let unit = &built.units[unit];
    let attributes = built.objects[usize::from(unit.row.object)].attributes;
    MeshUnit::parse(&unit.payload, attributes).unwrap()
}

fn full_cut(built: &Built) -> MeshCut {
    let mut cut = MeshCut::default();
    for number in 0..built.units.len() {
        let (id, needs) = (UnitId(number as u32), &built.units[number].row.needs);
        cut.insert(id, needs, &parsed(built, number)).unwrap();
    }
    cut
}

/// Triangles with the least corner first, in order.
fn sorted(triangles: impl Iterator<Item = [MeshVertex; 3]>) -> Vec<[MeshVertex; 3]> {
    let turned = triangles.map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min());
    let mut turned: Vec<_> = turned.flatten().collect();
    turned.sort_unstable();
    turned
}

fn all_meshes() -> Vec<(&'static str, Source)> {
    vec![
        ("torus", torus(96, 48)),
        ("sphere", sphere(64, 32)),
        ("sheet", sheet(60)),
        ("cube", two_materials(16)),
        ("fan", fan(40)),
        ("pieces", many_pieces(1000)),
        ("triangle", triangle()),
    ]
}

#[test]
fn the_full_cut_is_the_source_on_its_grid() {
    for (name, source) in all_meshes() {
        let built = built(&source);
        let mesh = super::mesh::grid_mesh(&source, &source.objects[0], 14).unwrap();
        let vertex = |it: u32| mesh.vertices[it as usize];
        let source = sorted(mesh.triangles.iter().map(|it| it.map(vertex)));
        let cut = full_cut(&built);
        let drawn = cut
            .drawn()
            .flat_map(|(_, unit, number)| unit.triangles(number));
        assert_eq!(sorted(drawn), source, "{name}");
        assert_eq!(
            built.objects[0].leaf_triangles,
            source.len() as u64,
            "{name}"
        );
    }
}

#[test]
fn each_vertex_is_sent_once() {
    for (name, source) in all_meshes() {
        let built = built(&source);
        let mesh = super::mesh::grid_mesh(&source, &source.objects[0], 14).unwrap();
        let units = 0..built.units.len();
        let sent: usize = units.map(|it| parsed(&built, it).vertices.len()).sum();
        let mut used = mesh.triangles.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let there = used.len();
        assert!(
            sent >= there && sent <= there + there / 50 + 3,
            "{name}: {sent} of {there}"
        );
    }
}

#[test]
fn the_torus_has_one_root_and_many_levels() {
    let built = built(&torus(96, 48));
    let roots = built.units.iter().filter(|it| it.row.needs.is_empty());
    assert_eq!(roots.count(), 1);
    assert!(built.levels >= 6, "{}", built.levels);
}
