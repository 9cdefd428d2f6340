//! Do the shaders of points draw what their twins draw, and what was sent?

use crate::common::ball::{FINE, OCTANT, ROOT, cloud, coming, units};
use crate::common::torus::{ALL, coming_root, object, root, view};
use crate::common::{bytes_of, share_beyond, write_png};
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use foveal_render::twin::TwinScene;
use foveal_render::{Culling, Gpu, RenderError, RgbaImage, SceneLayer, SceneStyle};
use std::collections::{HashMap, HashSet};
use std::path::Path;

const MOST_BYTES: u64 = 16 << 20;
const SIZE: [u32; 2] = [192, 128];

fn in_front() -> EyeView {
    view([0.0, 0.4, 4.0], [0.0, -6.0], SIZE)
}

fn look_at(name: &str, image: &RgbaImage) {
    if let Ok(folder) = std::env::var("FOVEAL_LARGE") {
        write_png(&Path::new(&folder).join(format!("{name}.png")), image);
    }
}

fn both(objects: &[SceneObject]) -> (SceneLayer, TwinScene) {
    let gpu = Gpu::open_blocking().unwrap();
    (
        SceneLayer::new(&gpu, objects, &[], MOST_BYTES).unwrap(),
        TwinScene::new(objects, &[]),
    )
}

fn assert_alike(name: &str, layer: &mut SceneLayer, twin: &TwinScene, style: &SceneStyle) {
    for (where_from, view) in [
        ("front", in_front()),
        ("inside", view([0.1, 0.2, 0.3], [40.0, 10.0], SIZE)),
    ] {
        let drawn = layer.picture(&view, style).unwrap();
        let expected = twin.picture(&view, style);
        look_at(&format!("points_{name}_{where_from}_gpu"), &drawn);
        look_at(&format!("points_{name}_{where_from}_twin"), &expected);
        let off = share_beyond(&drawn, &expected, 2);
        assert!(
            off <= 0.01,
            "{name}, {where_from}: {off} of all pixels differ"
        );
        let background = expected.pixels.chunks(4).min().unwrap();
        let shown = drawn.pixels.chunks(4).filter(|it| it != &background);
        assert!(shown.count() > 500, "{name} shows next to nothing");
    }
}

#[test]
fn a_cloud_is_drawn_as_by_its_twin_coarse_and_refined_and_coarse_again() {
    let [root, fine] = units();
    let (mut layer, mut twin) = both(&[cloud()]);
    layer.upload(&coming(ROOT, &root, 0)).unwrap();
    twin.upload(&coming(ROOT, &root, 0)).unwrap();
    let style = SceneStyle::default();
    assert_alike("coarse", &mut layer, &twin, &style);
    let coarse = layer.picture(&in_front(), &style).unwrap();
    layer.upload(&coming(FINE, &fine, 0)).unwrap();
    twin.upload(&coming(FINE, &fine, 0)).unwrap();
    for (name, tint) in [("refined", 0.0), ("levels", 0.6)] {
        let style = SceneStyle { tint, ..style };
        assert_alike(name, &mut layer, &twin, &style);
    }
    assert!(share_beyond(&coarse, &layer.picture(&in_front(), &style).unwrap(), 2) > 0.02);
    let refined = layer.picture(&in_front(), &style).unwrap();
    let (bytes, twin_refined) = (layer.gpu_bytes(), twin.picture(&in_front(), &style));
    layer.keep(&HashSet::new(), &[FINE]);
    twin.keep(&HashSet::new(), &[FINE]);
    assert_eq!(layer.picture(&in_front(), &style).unwrap(), coarse);
    assert_alike("hidden", &mut layer, &twin, &style);
    assert!(layer.show(FINE) && twin.show(FINE));
    assert_eq!(layer.picture(&in_front(), &style).unwrap(), refined);
    assert_eq!(twin.picture(&in_front(), &style), twin_refined);
    assert_eq!(layer.gpu_bytes(), bytes);
    layer.retain(&HashSet::new());
    assert_eq!(layer.picture(&in_front(), &style).unwrap(), coarse);
}

#[test]
fn clouds_and_meshes_hide_each_other_by_depth() {
    let [cloud_root, _] = units();
    let mesh_root = root();
    let (mut layer, mut twin) = both(&[object(ALL), cloud()]);
    layer.upload(&coming_root(&mesh_root)).unwrap();
    twin.upload(&coming_root(&mesh_root)).unwrap();
    layer.upload(&coming(ROOT, &cloud_root, 1)).unwrap();
    twin.upload(&coming(ROOT, &cloud_root, 1)).unwrap();
    assert_alike("with_torus", &mut layer, &twin, &SceneStyle::default());
}

#[test]
fn leaving_out_what_is_beside_the_view_changes_no_pixel() {
    let [root, fine] = units();
    let (mut layer, _) = both(&[cloud()]);
    layer.upload(&coming(ROOT, &root, 0)).unwrap();
    layer.upload(&coming(FINE, &fine, 0)).unwrap();
    let all = SceneStyle {
        culls: Culling::NONE,
        ..SceneStyle::default()
    };
    for yaw in (0..360).step_by(40) {
        let view = view([0.3, 0.2, 0.4], [f64::from(yaw), 15.0], SIZE);
        let culled = layer.picture(&view, &SceneStyle::default()).unwrap();
        assert_eq!(culled, layer.picture(&view, &all).unwrap(), "{yaw}");
    }
}

#[test]
fn the_image_of_units_tells_what_would_refine_the_points() {
    let [root, fine] = units();
    let gpu = Gpu::open_blocking().unwrap();
    let mut layer = SceneLayer::new(&gpu, &[cloud()], &[], MOST_BYTES).unwrap();
    let mut twin = TwinScene::new(&[cloud()], &[]);
    layer.upload(&coming(ROOT, &root, 0)).unwrap();
    layer.upload(&coming(FINE, &fine, 0)).unwrap();
    twin.upload(&coming(ROOT, &root, 0)).unwrap();
    twin.upload(&coming(FINE, &fine, 0)).unwrap();
    let of_root = (0..8).map(|octant| ((ROOT, octant), UnitId(100 + u32::from(octant))));
    let of_fine = (0..8).map(|octant| ((FINE, octant), UnitId(200 + u32::from(octant))));
    let refiners: HashMap<_, _> = of_root.chain(of_fine).collect();
    layer.set_refiners(refiners.clone());
    twin.set_refiners(refiners);
    let expected = twin.ids(&in_front(), &SceneStyle::default());
    let image = layer.ids(&in_front(), &SceneStyle::default()).unwrap();
    let bytes = bytes_of(&gpu, image);
    let words = bytes.as_chunks().0.iter();
    let drawn: Vec<u32> = words.map(|it| u32::from_le_bytes(*it)).collect();
    let off = drawn.iter().zip(&expected).filter(|(a, b)| a != b).count();
    assert!(off * 100 < drawn.len(), "{off} pixels");
    assert!(!drawn.contains(&(100 + u32::from(OCTANT))), "it is refined");
    assert!(drawn.iter().any(|it| *it >= 200 && *it < 208));
    assert!(drawn.iter().any(|it| (100..108).contains(it)));
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let [root, fine] = units();
    let gpu = Gpu::open_blocking().unwrap();
    let mut layer = SceneLayer::new(&gpu, &[cloud()], &[], 24 << 10).unwrap();
    let early = layer.upload(&coming(FINE, &fine, 0));
    assert!(
        matches!(early, Err(RenderError::Misfit { .. })),
        "{early:?}"
    );
    layer.upload(&coming(ROOT, &root, 0)).unwrap();
    let before = layer.picture(&in_front(), &SceneStyle::default()).unwrap();
    let large = layer.upload(&coming(FINE, &fine, 0));
    assert!(
        matches!(large, Err(RenderError::NoRoom { .. })),
        "{large:?}"
    );
    let after = layer.picture(&in_front(), &SceneStyle::default()).unwrap();
    assert_eq!(before, after);
}
