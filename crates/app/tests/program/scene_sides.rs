//! Is what units add measured on pictures that look as the viewer's do?

use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::{MeshUnit, MeshVertex};
use foveal_core::content::payload::PayloadView;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::parameters::Parameters;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::Eye;
use foveal_render::twin::TwinScene;
use foveal_render::{Coming, SceneStyle};
use foveal_scene::build::{BuildOptions, Built, build};
use foveal_scene::generate::{alone, torus};
use foveal_scene::signatures::{SideLook, side_looks};
use foveal_scene::source::{Material, SourceScene};
use glam::{DAffine3, DMat3, DVec3};

/// Pixels along the longest side of a mesh.
const ACROSS: f64 = 30.0;

fn units(built: &Built) -> Vec<MeshUnit> {
    let units = built.units.iter();
    let units = units.map(|unit| {
        let attributes = built.objects[0].attributes;
        MeshUnit::parse(&unit.payload, attributes, &unit.row.replaces).unwrap()
    });
    units.collect()
}

fn finest(built: &Built, units: &[MeshUnit]) -> Vec<[MeshVertex; 3]> {
    let mut cut = MeshCut::default();
    for ((number, unit), payload) in (0..).zip(&built.units).zip(units) {
        cut.insert(UnitId(number), &unit.row.needs, payload)
            .unwrap();
    }
    let drawn = cut.drawn();
    drawn
        .flat_map(|(_, unit, number)| unit.triangles(number))
        .collect()
}

fn twin(built: &Built, units: &[MeshUnit]) -> TwinScene {
    let mut twin = TwinScene::new(&built.objects, &built.textures);
    for ((number, unit), payload) in (0..).zip(&built.units).zip(units) {
        let coming = Coming {
            unit: UnitId(number),
            object: unit.row.object,
            level: unit.level,
            needs: &unit.row.needs,
            part: None,
            payload: PayloadView::Mesh(payload),
        };
        twin.upload(&coming).unwrap();
    }
    twin
}

/// The view that shows the same from far away.
fn view(built: &Built, look: &SideLook, pixel: f64) -> EyeView {
    let object = &built.objects[0];
    let placed = object.placements().next().unwrap();
    let [right, up] = look.across.map(|axis| placed.matrix3 * DVec3::AXES[axis]);
    let middle = object.grid.object_from_grid();
    let middle = middle.transform_point3(DVec3::from(look.middle));
    let far = 1e5 * pixel;
    let half = look.size.map(|it| f64::from(it) / 2.0 * pixel / far);
    EyeView {
        position: placed.transform_point3(middle) + far * right.cross(up),
        axes: Axes {
            right,
            down: -up,
            forward: -right.cross(up),
        },
        field: Field::symmetric(half),
        size: look.size,
        eye: Eye::default(),
    }
}

fn scenes() -> [(&'static str, SourceScene); 3] {
    let mut coloured = torus(48, 24);
    let normal = |at: &DVec3| (*at - 2.0 * DVec3::new(at.x, 0.0, at.z).normalize()).normalize();
    let normals = coloured.positions.iter().map(normal);
    coloured.normals = normals.map(|it| it.as_vec3().to_array()).collect();
    let colour = |at: &DVec3| {
        if at.x > 0.0 {
            [0.9, 0.3, 0.1, 1.0]
        } else {
            [0.1, 0.5, 0.9, 1.0]
        }
    };
    coloured.colours = coloured.positions.iter().map(colour).collect();
    let mut coloured = alone("coloured, turned", coloured);
    let turn = DMat3::from_cols(DVec3::Z, DVec3::NEG_Y, DVec3::X);
    coloured.objects[0].placements = vec![DAffine3::from_mat3(turn)];
    // The upper half alone, so that the inside is seen from below.
    let mut open = torus(48, 24);
    let positions = &open.positions;
    let is_upper = |it: &[u32; 3]| it.iter().all(|it| positions[*it as usize].y >= 0.0);
    open.triangles.retain(is_upper);
    let mut open = alone("two-sided", open);
    open.materials.push(Material {
        two_sided: true,
        ..Default::default()
    });
    [
        ("plain", alone("plain", torus(48, 24))),
        ("coloured, turned", coloured),
        ("two-sided", open),
    ]
}

#[test]
fn all_sides_look_as_the_renderers_twin_draws_them() {
    for (name, source) in scenes() {
        let built = build(&source, &BuildOptions::default(), &|_, _| ()).unwrap();
        let units = units(&built);
        let object = &built.objects[0];
        let pixel = f64::from((1 << object.grid.bits) - 2) * object.grid.step / ACROSS;
        let looks = side_looks(object, &finest(&built, &units), pixel);
        assert_eq!(looks.len(), 6, "{name}");
        let twin = twin(&built, &units);
        for look in looks {
            let theirs = twin.picture(&view(&built, &look, pixel), &SceneStyle::default());
            let (pixels, _) = theirs.pixels.as_chunks::<4>();
            let codes: Vec<[u8; 3]> = pixels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
            let theirs = Parameters::default().luminance_from_rgb(&codes);
            // Rows of pictures go downwards.
            let rows = look.luminance.chunks(look.size[0] as usize).rev();
            let is_off = |(ours, theirs): &(&f64, &f64)| match **ours > 0.0 {
                true => (*ours - *theirs).abs() > 1.0,
                false => **theirs != theirs_nothing(&codes),
            };
            let off = rows.flatten().zip(&theirs).filter(is_off).count();
            let covered = look.luminance.iter().filter(|it| **it > 0.0).count();
            assert!(covered > 100, "{name}");
            assert!(
                off * 25 < covered,
                "{name} {:?}: {off} of {covered}",
                look.across
            );
        }
    }
}

/// The luminance of the corner of a picture, where nothing stands.
fn theirs_nothing(codes: &[[u8; 3]]) -> f64 {
    Parameters::default().luminance_from_rgb(&codes[..1])[0]
}
