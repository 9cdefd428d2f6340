//! Are units that do not fit refused, and is what they replaced drawn again without them?

use super::*;
use crate::content::mesh::payload::Cluster;
use crate::content::scene::part_ref::PartRef;

const ROOT: UnitId = UnitId(0);
const FINE: UnitId = UnitId(1);

fn vertex(number: u16) -> MeshVertex {
    MeshVertex {
        place: [number, 2 * number, 0],
        ..Default::default()
    }
}

fn cluster(vertices: &[u16]) -> Cluster {
    Cluster {
        vertices: vertices.to_vec(),
        triangles: vec![[0, 1, 2]],
    }
}

/// A root with two clusters that share an edge.
fn root() -> MeshUnit {
    MeshUnit {
        vertices: (0..4).map(vertex).collect(),
        clusters: vec![cluster(&[0, 1, 2]), cluster(&[2, 1, 3])],
        ..Default::default()
    }
}

/// What refines the second of them: a vertex more, on one of its edges.
fn fine() -> MeshUnit {
    MeshUnit {
        replaces: vec![PartRef { need: 0, part: 1 }],
        staying: 3,
        vertices: vec![vertex(9)],
        clusters: vec![cluster(&[0, 1, 3]), cluster(&[0, 3, 2])],
    }
}

fn places(cut: &MeshCut) -> Vec<[u16; 3]> {
    let triangles = cut.drawn();
    let triangles = triangles.flat_map(|(_, unit, number)| unit.triangles(number));
    triangles
        .map(|it| it.map(|vertex| vertex.place[0]))
        .collect()
}

#[test]
fn a_unit_is_drawn_in_place_of_what_it_replaces_until_it_goes() {
    let mut cut = MeshCut::default();
    cut.insert(ROOT, &[], &root()).unwrap();
    let coarse = cut.clone();
    assert_eq!(places(&cut), [[0, 1, 2], [2, 1, 3]]);
    cut.insert(FINE, &[ROOT], &fine()).unwrap();
    // The staying vertices are 2, 1 and 3, as the replaced cluster names them.
    assert_eq!(places(&cut), [[0, 1, 2], [2, 1, 9], [2, 9, 3]]);
    cut.remove(FINE);
    assert_eq!(cut, coarse);
}

#[test]
fn staying_vertices_are_named_once_in_the_order_of_the_replaced_clusters() {
    let mut cut = MeshCut::default();
    cut.insert(ROOT, &[], &root()).unwrap();
    let both = [1, 0].map(|part| PartRef { need: 0, part });
    let says = MeshUnit {
        replaces: both.to_vec(),
        staying: 4,
        clusters: vec![cluster(&[0, 1, 2])],
        ..Default::default()
    };
    let placed = cut.insert(FINE, &[ROOT], &says).unwrap();
    assert_eq!(placed.vertices, [2, 1, 3, 0].map(vertex));
}

#[test]
fn a_unit_that_does_not_fit_changes_nothing() {
    let mut cut = MeshCut::default();
    cut.insert(ROOT, &[], &root()).unwrap();
    let before = cut.clone();
    let broken: [fn(&mut MeshUnit); 4] = [
        |it| it.staying = 2,
        |it| it.staying = 4,
        |it| it.replaces[0].part = 2,
        |it| it.replaces[0].need = 1,
    ];
    for broken in broken {
        let mut says = fine();
        broken(&mut says);
        assert!(cut.insert(FINE, &[ROOT], &says).is_err());
        assert_eq!(cut, before);
    }
    assert!(cut.insert(FINE, &[UnitId(7)], &fine()).is_err());
    assert_eq!(cut, before);
}

#[test]
fn no_two_units_replace_one_cluster() {
    let mut cut = MeshCut::default();
    cut.insert(ROOT, &[], &root()).unwrap();
    cut.insert(FINE, &[ROOT], &fine()).unwrap();
    assert!(cut.insert(UnitId(2), &[ROOT], &fine()).is_err());
}
