//! Do cuts keep what was closed closed?

use super::{CutReport, CutTrial, check_cuts, odd_edges};
use crate::build::tests::meshes::{
    bladed_torus, many_pieces, mosaic, sheet, sphere, torus, two_materials,
};
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
        mosaic(96, 48),
        torus(128, 64),
        sphere(64, 32),
        two_materials(24),
        many_pieces(200),
        mosaic(96, 48),
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

/// What cannot be simplified ends as a root, and what meets it stays.
#[test]
fn a_mesh_with_an_edge_of_many_triangles_never_has_more_odd_edges_than_its_source() {
    let report = checked(&built(&bladed_torus(128, 64, 199)), &TRIAL);
    assert!(report.source_odd_edges >= 2 * 199, "{report:?}");
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
            let payload = parsed(&built, id).unwrap();
            cut.insert(id, &rows[unit].1.needs, &payload).unwrap();
            parity.insert(unit);
            if place % 7 == 0 {
                assert_eq!(parity.odd(), odd(&cut, &rows));
            }
        }
        assert_eq!(parity.odd(), odd(&cut, &rows));
    }
}

/// Whatever is on its way when, and whatever stands on it.
#[test]
fn no_edge_opens_while_vertices_are_on_their_way_in_any_order_of_arrival() {
    let mut moved = 0;
    for source in [
        torus(96, 48),
        sheet(48),
        sphere(48, 24),
        two_materials(16),
        many_pieces(60),
    ] {
        let built = built(&source);
        let rows = rows(&built);
        let most = odd(&cut_of(&built, &rows, rows.len()), &rows);
        let mut random = super::Random::new(21);
        for _ in 0..6 {
            let mut cut = MeshCut::default();
            for unit in super::order(&rows, &mut random) {
                let id = UnitId(unit as u32);
                let payload = parsed(&built, id).unwrap();
                cut.insert(id, &rows[unit].1.needs, &payload).unwrap();
                if random.unit() > 0.1 {
                    continue;
                }
                let there: Vec<UnitId> = cut.units().map(|(unit, _)| unit).collect();
                let moving = there.into_iter().filter(|_| random.unit() < 0.4);
                let moving: Vec<UnitId> = moving.collect();
                let shares = moving.into_iter().map(|unit| (unit, random.unit()));
                moved += cut.morph(&shares.collect()).len();
                if rows.iter().zip(0..).all(|((_, row), unit)| {
                    !row.needs.is_empty() || cut.unit(UnitId(unit)).is_some()
                }) {
                    assert!(odd(&cut, &rows) <= most);
                }
            }
        }
    }
    assert!(moved > 500, "{moved}");
}

/// Counting again only what moves gives what counting all triangles gives.
#[test]
fn odd_edges_of_what_moves_are_those_of_what_is_drawn_while_it_moves() {
    for source in [sheet(64), sphere(48, 24)] {
        let built = built(&source);
        let rows = rows(&built);
        let mut all = cut_of(&built, &rows, rows.len());
        let chains = super::Chains::new(&all, &rows);
        let mut random = super::Random::new(5);
        for _ in 0..8 {
            let parity = super::foveated(&chains, &rows, &mut random);
            let mut drawn = MeshCut::default();
            for unit in (0..rows.len()).filter(|it| parity.is_there(*it)) {
                let id = UnitId(unit as u32);
                let payload = parsed(&built, id).unwrap();
                drawn.insert(id, &rows[unit].1.needs, &payload).unwrap();
            }
            assert_eq!(odd(&drawn, &rows), parity.odd());
            let shares = super::random_shares(&rows, &parity, &mut random);
            let counted = super::odd_while_moving(&mut all, &rows, &parity, &shares);
            drawn.morph(&shares);
            assert_eq!(counted, odd(&drawn, &rows));
        }
    }
}

fn cut_of(built: &Built, rows: &[(u8, UnitRow)], count: usize) -> MeshCut {
    let mut cut = MeshCut::default();
    for (unit, (_, row)) in rows[..count].iter().enumerate() {
        let id = UnitId(unit as u32);
        let payload = parsed(built, id).unwrap();
        cut.insert(id, &row.needs, &payload).unwrap();
    }
    cut
}

/// Odd edges of what is drawn now, object by object.
fn odd(cut: &MeshCut, rows: &[(u8, UnitRow)]) -> u64 {
    let objects = rows.iter().map(|(_, row)| row.object).max().unwrap() + 1;
    let of_object = |object| {
        let drawn = cut.drawn();
        let drawn = drawn.filter(|(unit, ..)| rows[unit.0 as usize].1.object == object);
        let triangles =
            drawn.flat_map(|(unit, placed, number)| cut.triangles_now(unit, placed, number));
        odd_edges(triangles.map(|it| it.map(|vertex| vertex.place)))
    };
    (0..objects).map(of_object).sum()
}

#[test]
fn an_edge_of_two_triangles_is_even() {
    let [a, b, c, d] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]];
    assert_eq!(odd_edges([[a, b, c]].into_iter()), 3);
    assert_eq!(odd_edges([[a, b, c], [c, b, d]].into_iter()), 4);
    assert_eq!(odd_edges([[a, b, c], [c, b, d], [a, a, b]].into_iter()), 4);
    assert_eq!(odd_edges([[a, b, c], [a, c, b]].into_iter()), 0);
}
