//! Do thousands of small parts cover as much at every level as all of them do?

use super::super::{BuildOptions, build};
use super::parsed;
use crate::generate::alone;
use crate::source::{SourceMesh, SourceScene};
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::pack::unit::UnitId;
use glam::DVec3;

/// Many small things in rows, of corners and triangles each, a quarter as large as they are apart.
fn scattered(count: usize, corners: &[[f64; 3]], triangles: &[[u32; 3]]) -> SourceScene {
    let mut mesh = SourceMesh::default();
    for number in 0..count {
        let first = mesh.positions.len() as u32;
        let at = DVec3::new((number % 64) as f64, (number / 64) as f64, 0.0);
        let place = |it: &[f64; 3]| at + 0.25 * DVec3::from_array(*it);
        mesh.positions.extend(corners.iter().map(place));
        let of_one = triangles.iter().map(|it| it.map(|corner| first + corner));
        mesh.triangles.extend(of_one);
    }
    alone("parts", mesh)
}

#[test]
fn coarse_levels_of_scattered_parts_keep_their_area() {
    let square = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let stone = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    for (corners, triangles) in [
        (&square, &[[0, 1, 2], [0, 2, 3]][..]),
        (&stone, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
    ] {
        let source = scattered(3000, corners, triangles);
        let built = build(&source, &BuildOptions::default(), &|_, _| ()).unwrap();
        let step = built.objects[0].grid.step;
        let mut areas = Vec::new();
        let mut cut = MeshCut::default();
        let mut level = u8::MAX;
        // Units come from the coarsest level on.
        for (number, unit) in built.units.iter().enumerate() {
            if unit.level != level {
                level = unit.level;
                areas.push(area(&cut, step));
            }
            cut.insert(
                UnitId(number as u32),
                &unit.row.needs,
                &parsed(&built, number),
            )
            .unwrap();
        }
        let whole = area(&cut, step);
        assert!(areas.len() > 5, "{areas:?}");
        for area in &areas[1..] {
            assert!((0.4..1.2).contains(&(area / whole)), "{areas:?} of {whole}");
        }
        let roots = built
            .units
            .iter()
            .take_while(|it| it.level == built.units[0].level);
        let triangles: u32 = roots.map(|it| it.row.samples).sum();
        assert!(triangles < 200, "{triangles}");
    }
}

/// The area of what is drawn.
fn area(cut: &MeshCut, step: f64) -> f64 {
    let all = cut
        .drawn()
        .flat_map(|(_, unit, number)| unit.triangles(number));
    let areas = all.map(|triangle| {
        let [a, b, c] = triangle.map(|it| step * DVec3::from_array(it.place.map(f64::from)));
        (b - a).cross(c - a).length() / 2.0
    });
    areas.sum()
}
