//! Does a scene come back from its units?

mod codecs;
pub(crate) mod meshes;
mod scattered;
mod signatures;
pub(crate) mod textures;

use super::mesh::grid_mesh::GridMesh;
use super::textures::ShownImages;
use super::{BuildOptions, Built, build};
use crate::source::SourceScene;
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::{MeshUnit, MeshVertex};
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::pack::unit::UnitId;
use meshes::{all_meshes, fan, sphere, torus, triangle, two_materials};

fn built(source: &SourceScene) -> Built {
    build(source, &BuildOptions::default(), &|_, _| ()).unwrap()
}

fn all() -> Vec<(&'static str, SourceScene)> {
    let mut all = all_meshes();
    all.push(("textured", textures::sphere_with([48, 24], [700, 300])));
    all
}

fn grid_mesh(source: &SourceScene) -> GridMesh {
    let shown = ShownImages::new(source);
    crate::build::grid_mesh(source, &source.objects[0], 14, &shown).unwrap()
}

pub(crate) fn parsed(built: &Built, unit: usize) -> MeshUnit {
    let unit = &built.units[unit];
    if unit.row.kind == UnitKind::Image {
        return MeshUnit::default();
    }
    let attributes = built.objects[usize::from(unit.row.object)].attributes;
    MeshUnit::parse(&unit.payload, attributes, &unit.row.replaces).unwrap()
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

#[test]
fn the_full_cut_is_the_source_on_its_grid() {
    for (name, source) in all() {
        let built = built(&source);
        let mesh = grid_mesh(&source);
        let vertex = |it: u32| mesh.vertices[it as usize];
        let source = sorted(mesh.triangles.iter().map(|it| it.map(vertex)));
        let cut = full_cut(&built);
        let drawn = cut
            .drawn()
            .flat_map(|(_, unit, number)| unit.triangles(number));
        assert_eq!(sorted(drawn), source, "{name}");
        assert_eq!(
            built.objects[0].shape.samples(),
            source.len() as u64,
            "{name}"
        );
    }
}

#[test]
fn each_vertex_is_sent_once() {
    for (name, source) in all() {
        let built = built(&source);
        let mesh = grid_mesh(&source);
        let units = 0..built.units.len();
        let sent: usize = units.map(|it| parsed(&built, it).vertices.len()).sum();
        let mut used = mesh.triangles.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let there = used.len();
        // Pieces that stand for others have vertices of their own.
        let beside = if name == "pieces" {
            there / 2
        } else {
            there / 50 + 3
        };
        assert!(
            sent >= there && sent <= there + beside,
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

#[test]
fn errors_and_spheres_never_shrink_towards_the_root() {
    let distance = |a: [f32; 3], b: [f32; 3]| {
        let square = |axis: usize| (f64::from(a[axis]) - f64::from(b[axis])).powi(2);
        [0, 1, 2].map(square).iter().sum::<f64>().sqrt()
    };
    for (name, source) in all() {
        let built = built(&source);
        for (number, unit) in built.units.iter().enumerate() {
            assert_eq!(
                unit.row.needs.is_empty(),
                unit.row.error.is_infinite(),
                "{name}"
            );
            assert_eq!(
                unit.row.needs.is_empty(),
                unit.level + 1 == built.levels,
                "{name}"
            );
            for need in &unit.row.needs {
                assert!((need.0 as usize) < number, "{name}");
                let (fine, need) = (&unit.row, &built.units[need.0 as usize].row);
                assert!(need.error >= fine.error, "{name}");
                let reach = distance(need.centre, fine.centre) + f64::from(fine.radius);
                assert!(reach <= f64::from(need.radius), "{name}");
            }
        }
    }
}

#[test]
fn spheres_enclose_what_units_show() {
    for (name, source) in all() {
        let built = built(&source);
        let step = built.objects[0].grid.step;
        for (unit, placed) in full_cut(&built).units() {
            let row = &built.units[unit.0 as usize].row;
            for vertex in &placed.vertices {
                let along = |axis: usize| {
                    let at = f64::from(vertex.place[axis]) * step;
                    (at - f64::from(row.centre[axis])).powi(2)
                };
                let reach = [0, 1, 2].map(along).iter().sum::<f64>().sqrt();
                // Places are rounded to f32 before they are enclosed.
                assert!(reach <= f64::from(row.radius) * 1.000_001 + 1e-6, "{name}");
            }
        }
    }
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    for (name, source) in [("torus", torus(256, 128)), ("sphere", sphere(64, 32))] {
        let with = |jobs| {
            let options = BuildOptions {
                jobs,
                ..Default::default()
            };
            build(&source, &options, &|_, _| ()).unwrap()
        };
        let one = with(1);
        assert!(one == with(3), "{name}");
        assert!(one == with(1), "{name}");
    }
}

#[test]
fn the_torus_keeps_its_shape_at_every_level() {
    // The tube is one thick: what three halvings leave is within a tenth of that.
    let built = built(&torus(128, 64));
    for unit in built.units.iter().filter(|it| it.level < 3) {
        assert!(unit.row.error < 0.1, "{}", unit.row.error);
    }
}

#[test]
fn seams_stay_simple_to_coarsen() {
    for (name, source) in [("sphere", sphere(128, 64)), ("cube", two_materials(32))] {
        let built = built(&source);
        let roots = built.units.iter().filter(|it| it.row.needs.is_empty());
        assert!(roots.count() <= 2, "{name}: {:?}", built.repairs);
    }
}

#[test]
fn one_material_colours_the_object_and_two_its_vertices() {
    let cube = built(&two_materials(4));
    assert!(cube.objects[0].attributes.colours);
    assert_eq!(cube.objects[0].colour, [1.0; 4]);
    let mut plain = two_materials(4);
    plain.meshes[0].materials.fill(1);
    let plain = built(&plain);
    assert!(!plain.objects[0].attributes.colours);
    assert_eq!(plain.objects[0].colour, [0.0, 0.2, 1.0, 0.5]);
    let red = [255, 0, 0, 255];
    // 0.2 in linear light is 0.484 of an sRGB code's range.
    let blue = [0, 124, 255, 128];
    let units = 0..cube.units.len();
    let colours = units.flat_map(|it| parsed(&cube, it).vertices);
    let mut colours: Vec<_> = colours.map(|it| it.colour).collect();
    colours.sort_unstable();
    colours.dedup();
    assert_eq!(colours, [blue, red]);
}

#[test]
fn several_objects_share_levels_and_keep_apart() {
    let mut source = torus(96, 48);
    source.meshes.extend(triangle().meshes);
    source.objects.push(crate::source::SourceObject {
        mesh: 1,
        ..source.objects[0].clone()
    });
    let built = built(&source);
    assert_eq!(built.objects.len(), 2);
    let roots: Vec<_> = built
        .units
        .iter()
        .filter(|it| it.level + 1 == built.levels)
        .collect();
    assert_eq!(
        roots.iter().map(|it| it.row.object).collect::<Vec<_>>(),
        [0, 1]
    );
    for unit in &built.units {
        let of = |need: &UnitId| built.units[need.0 as usize].row.object;
        assert!(
            unit.row
                .needs
                .iter()
                .all(|need| of(need) == unit.row.object)
        );
    }
}

#[test]
fn what_has_no_area_is_left_out_and_counted() {
    let built = built(&fan(12));
    assert_eq!(built.repairs.get("zero_area_triangles"), Some(&1));
    assert_eq!(built.objects[0].shape.samples(), 13);
    let nothing = SourceScene::default();
    let refused = build(&nothing, &BuildOptions::default(), &|_, _| ());
    assert!(matches!(refused, Err(super::BuildError::Empty)));
}

#[test]
fn a_source_that_contradicts_itself_is_refused() {
    let broken: [fn(&mut SourceScene); 6] = [
        |it| it.meshes[0].triangles.push([0, 1, 3]),
        |it| it.meshes[0].normals.push([0.0; 3]),
        |it| it.meshes[0].materials.push(7),
        |it| it.meshes[0].positions[0].x = f64::NAN,
        |it| it.objects[0].mesh = 1,
        |it| it.objects[0].placements.clear(),
    ];
    for (number, broken) in broken.into_iter().enumerate() {
        let mut source = triangle();
        broken(&mut source);
        let refused = build(&source, &BuildOptions::default(), &|_, _| ());
        assert!(refused.is_err(), "{number}");
    }
    let options = BuildOptions {
        bits: 17,
        ..Default::default()
    };
    assert!(build(&triangle(), &options, &|_, _| ()).is_err());
}

#[test]
fn progress_ends_at_all() {
    let last = std::sync::Mutex::new((0, 1));
    let hear = |done, all| *last.lock().unwrap() = (done, all);
    build(&torus(64, 32), &BuildOptions::default(), &hear).unwrap();
    let (done, all) = *last.lock().unwrap();
    assert_eq!(done, all);
}
