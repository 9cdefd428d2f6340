//! Do cuts keep what was closed closed?

use super::{CutReport, CutTrial, check_cuts, odd_edges};
use crate::build::tests::meshes::{many_pieces, sheet, sphere, torus, two_materials};
use crate::build::{BuildOptions, Built, build};
use crate::source::SourceScene;
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::MeshUnit;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;

const TRIAL: CutTrial = CutTrial {
    cuts: 20,
    orders: 20,
    seed: 7,
    ignore_prerequisites: false,
};

fn built(source: &SourceScene) -> Built {
    build(source, &BuildOptions::default(), &|_, _| ()).unwrap()
}

fn rows(built: &Built) -> Vec<(u8, UnitRow)> {
    let units = built.units.iter();
    units.map(|it| (it.level, it.row.clone())).collect()
}

fn parsed(built: &Built, unit: UnitId) -> Result<MeshUnit, PackError> {
    let unit = &built.units[unit.0 as usize];
    let object = &built.objects[usize::from(unit.row.object)];
    MeshUnit::parse(&unit.payload, object.attributes, &unit.row.replaces)
}

fn checked(built: &Built, trial: &CutTrial) -> CutReport {
    check_cuts(&rows(built), &mut |unit| parsed(built, unit), trial).unwrap()
}

#[test]
fn no_cut_of_a_closed_mesh_has_an_odd_edge() {
    let closed = [
        torus(128, 64),
        sphere(64, 32),
        two_materials(24),
        many_pieces(200),
    ];
    for source in closed {
        let report = checked(&built(&source), &TRIAL);
        assert_eq!((report.source_odd_edges, report.odd_edges_max), (0, 0));
    }
}

#[test]
fn foveated_cuts_of_the_torus_have_at_least_three_levels() {
    let report = checked(&built(&torus(128, 64)), &TRIAL);
    assert!(report.levels_in_cut_min >= 3, "{report:?}");
}

#[test]
fn an_open_mesh_never_has_more_odd_edges_than_its_source() {
    let report = checked(&built(&sheet(64)), &TRIAL);
    assert_eq!(report.source_odd_edges, 4 * 64);
    assert_eq!(report.odd_edges_max, report.source_odd_edges);
}

#[test]
fn without_prerequisites_there_are_cracks() {
    let trial = CutTrial {
        ignore_prerequisites: true,
        ..TRIAL
    };
    let report = checked(&built(&torus(128, 64)), &trial);
    assert!(report.odd_edges_max > 500, "{report:?}");
}

/// Counting by borders gives what counting triangles gives, of what a viewer draws.
#[test]
fn odd_edges_are_those_of_what_is_drawn() {
    for source in [sheet(64), sphere(48, 24)] {
        let built = built(&source);
        let rows = rows(&built);
        let mut cut = MeshCut::default();
        let all = cut_of(&built, &rows, rows.len());
        let chains = super::Chains::new(&all, &rows);
        let mut parity = super::Parity::new(&chains);
        let mut random = super::Random::new(3);
        let order = super::order(&rows, &mut random);
        assert_eq!(order.len(), rows.len());
        for (place, unit) in order.into_iter().enumerate() {
            let id = UnitId(unit as u32);
            let says = parsed(&built, id).unwrap();
            cut.insert(id, &rows[unit].1.needs, &says).unwrap();
            parity.insert(unit);
            if place % 7 == 0 {
                assert_eq!(parity.odd(), odd(&cut));
            }
        }
        assert_eq!(parity.odd(), odd(&cut));
    }
}

fn cut_of(built: &Built, rows: &[(u8, UnitRow)], count: usize) -> MeshCut {
    let mut cut = MeshCut::default();
    for (unit, (_, row)) in rows[..count].iter().enumerate() {
        let id = UnitId(unit as u32);
        let says = parsed(built, id).unwrap();
        cut.insert(id, &row.needs, &says).unwrap();
    }
    cut
}

fn odd(cut: &MeshCut) -> u64 {
    let triangles = cut.drawn();
    let triangles = triangles.flat_map(|(_, unit, number)| unit.triangles(number));
    odd_edges(triangles.map(|it| it.map(|vertex| vertex.place)))
}

#[test]
fn an_edge_of_two_triangles_is_even() {
    let [a, b, c, d] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]];
    assert_eq!(odd_edges([[a, b, c]].into_iter()), 3);
    assert_eq!(odd_edges([[a, b, c], [c, b, d]].into_iter()), 4);
    assert_eq!(odd_edges([[a, b, c], [c, b, d], [a, a, b]].into_iter()), 4);
    assert_eq!(odd_edges([[a, b, c], [a, c, b]].into_iter()), 0);
}
