//! Are surfaces drawn as the renderer draws them?

use super::lit::{LitSurface, LitTriangle};
use super::side_view::{Raster, Side, Window};
use crate::build::Built;
use crate::build::tests::meshes::{sphere, torus, two_materials};
use crate::build::tests::{built, full_cut, parsed};
use foveal_core::content::scene::lighting::LAMP_DIRECTION;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::parameters::Parameters;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::Eye;
use foveal_render::twin::TwinScene;
use foveal_render::{ComingUnit, RgbaImage, SceneStyle};
use glam::{DAffine3, DMat3, DVec3};

/// Columns and rows of the pictures.
const SIZE: u32 = 64;

/// All of the finest level from a side, and the raster that shows it.
fn ours(built: &Built, surface: &LitSurface, side: Side) -> (Vec<f64>, f64) {
    let cut = full_cut(built);
    let drawn = cut.drawn();
    let triangles = drawn.flat_map(|(_, unit, number)| unit.triangles(number));
    let triangles: Vec<LitTriangle> = triangles.map(|it| surface.triangle(&it)).collect();
    let middle = f64::from((1 << 14) - 2) / 2.0;
    let raster = Raster {
        surface,
        middle: [middle; 3],
        pixels_per_step: f64::from(SIZE - 8) / (2.0 * middle),
    };
    let window = Window {
        low: [-i64::from(SIZE / 2); 2],
        size: [SIZE; 2],
    };
    let pixel = built.objects[0].grid.step / raster.pixels_per_step;
    (raster.picture(side, window, &triangles), pixel)
}

/// The same by the renderer's twin, from far away.
fn twins(built: &Built, side: Side, pixel: f64) -> RgbaImage {
    let object = &built.objects[0];
    let mut twin = TwinScene::new(&built.objects, &built.textures);
    for (number, unit) in built.units.iter().enumerate() {
        let coming = ComingUnit {
            unit: UnitId(number as u32),
            object: unit.row.object,
            level: unit.level,
            needs: &unit.row.needs,
            says: &parsed(built, number),
        };
        twin.upload(&coming).unwrap();
    }
    let placed = object.placements().next().unwrap();
    let axis = |it: usize| placed.matrix3 * DVec3::AXES[it];
    let [right, up] = side.across().map(axis);
    let middle = object.grid.origin.map(|it| it + object.grid.step * 8191.0);
    let far = 1000.0 * f64::from(SIZE) * pixel;
    let half = f64::from(SIZE / 2) * pixel / far;
    let view = EyeView {
        position: placed.transform_point3(DVec3::from(middle)) + far * right.cross(up),
        axes: Axes {
            right,
            down: -up,
            forward: -right.cross(up),
        },
        field: Field::symmetric([half; 2]),
        size: [SIZE; 2],
        eye: Eye::default(),
    };
    twin.picture(&view, &SceneStyle::default())
}

#[test]
fn all_sides_look_as_the_renderers_twin_draws_them() {
    let mut turned = sphere(48, 24);
    let turn = DMat3::from_cols(DVec3::Z, DVec3::NEG_Y, DVec3::X);
    turned.objects[0].placements = vec![DAffine3::from_mat3(turn)];
    let mut two_sided = torus(48, 24);
    // The upper half alone, so that the inside is seen from below.
    let mesh = &mut two_sided.meshes[0];
    let is_upper = |it: &[u32; 3]| it.iter().all(|it| mesh.positions[*it as usize].y >= 0.0);
    mesh.triangles.retain(is_upper);
    two_sided.materials.push(crate::source::Material {
        two_sided: true,
        ..Default::default()
    });
    let all = [torus(48, 24), turned, two_materials(8), two_sided];
    for (number, source) in all.iter().enumerate() {
        let built = built(source);
        let surface = LitSurface::new(&built.objects[0], LAMP_DIRECTION);
        for side in Side::ALL {
            let (ours, pixel) = ours(&built, &surface, side);
            let theirs = twins(&built, side, pixel);
            look_at(&format!("{number}-{side:?}"), &ours, &theirs);
            let (pixels, _) = theirs.pixels.as_chunks::<4>();
            let theirs: Vec<[u8; 3]> = pixels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
            let theirs = Parameters::default().luminance_from_rgb(&theirs);
            let nothing = theirs[0];
            // Rows of pictures go downwards.
            let ours = ours.chunks(SIZE as usize).rev().flatten();
            let pairs = ours.zip(&theirs);
            let off = |(ours, theirs): &(&f64, &f64)| match **ours > 0.0 {
                true => (*ours - *theirs).abs() > 1.0,
                false => **theirs != nothing,
            };
            let share = pairs.filter(off).count() as f64 / theirs.len() as f64;
            assert!(share < 0.02, "{number} {side:?}: {share}");
        }
    }
}

/// Writes pictures to look at, where `FOVEAL_LARGE` names a folder: ours above the renderer's.
fn look_at(name: &str, ours: &[f64], theirs: &RgbaImage) {
    let Ok(folder) = std::env::var("FOVEAL_LARGE") else {
        return;
    };
    let mut bytes = format!("P6 {SIZE} {} 255\n", 2 * SIZE).into_bytes();
    for row in ours.chunks(SIZE as usize).rev() {
        let grey = |it: &f64| ((it / 100.0).powf(1.0 / 2.2) * 255.0) as u8;
        bytes.extend(row.iter().flat_map(|it| [grey(it); 3]));
    }
    bytes.extend(theirs.pixels.chunks(4).flat_map(|it| &it[..3]));
    std::fs::write(format!("{folder}/{name}.ppm"), bytes).unwrap();
}
