//! Does what others hide go undrawn, without a pixel of the picture changing?

use crate::common::torus::{ALL, coming, coming_root, object, refinement, root, view};
use foveal_core::content::scene::description::SceneObject;
use foveal_core::view::eye_view::EyeView;
use foveal_render::twin::TwinScene;
use foveal_render::{Culling, Gpu, SceneLayer, SceneStyle};
use glam::{DAffine3, DVec3};

const SIZE: [u32; 2] = [201, 133];
/// Tori along each side of a square, with 16 clusters each.
const SIDE: u32 = 16;

/// Tori that stand close behind each other.
fn rows_of_tori() -> Vec<SceneObject> {
    let standing = |k: u32| {
        let [x, z] = [k % SIDE, k / SIDE].map(f64::from);
        let turn = DAffine3::from_rotation_x(1.5);
        DAffine3::from_translation(DVec3::new(2.2 * x, 0.0, -1.1 * z)) * turn
    };
    let placements = (0..SIDE * SIDE).map(standing);
    vec![SceneObject {
        placements: placements.map(|it| it.to_cols_array()).collect(),
        ..object(ALL)
    }]
}

/// Before the rows, a little aside, far aside, and looking back.
fn path() -> Vec<EyeView> {
    let steps = [
        ([12.0, 0.3, 4.0], [0.0, 0.0]),
        ([12.0, 0.3, 4.0], [0.0, 0.0]),
        ([12.6, 0.4, 3.5], [-4.0, 1.0]),
        ([12.6, 1.4, 3.5], [3.0, -6.0]),
        ([3.0, 0.2, 5.0], [25.0, 0.0]),
        ([12.0, 0.3, -18.0], [180.0, 0.0]),
        ([12.0, 0.3, -6.2], [140.0, 3.0]),
    ];
    steps.map(|(place, to)| view(place, to, SIZE)).to_vec()
}

fn style(culls: Culling) -> SceneStyle {
    SceneStyle {
        culls,
        ..SceneStyle::default()
    }
}

#[test]
fn whatever_is_left_out_the_picture_is_the_same() {
    let gpu = Gpu::open_blocking().unwrap();
    let objects = rows_of_tori();
    let (root, fine) = (root(), refinement(&Vec::from_iter(0..16)));
    let layer = || {
        let mut layer = SceneLayer::new(&gpu, &objects, &[], 16 << 20).unwrap();
        layer.upload(&coming_root(&root)).unwrap();
        layer.upload(&coming(1, &fine)).unwrap();
        layer
    };
    let mut all = layer();
    let pictures: Vec<_> = path()
        .iter()
        .map(|it| all.picture(it, &style(Culling::NONE)).unwrap())
        .collect();
    for way in 1..8 {
        let culls = Culling {
            outside: way & 1 != 0,
            backs: way & 2 != 0,
            hidden: way & 4 != 0,
        };
        let mut layer = layer();
        for (number, (view, picture)) in path().iter().zip(&pictures).enumerate() {
            let drawn = layer.picture(view, &style(culls)).unwrap();
            assert_eq!(&drawn, picture, "{culls:?}, picture {number}");
        }
    }
}

#[test]
fn what_the_picture_before_hid_is_drawn_where_this_one_shows_it() {
    let gpu = Gpu::open_blocking().unwrap();
    let objects = rows_of_tori();
    let (root, fine) = (root(), refinement(&Vec::from_iter(0..16)));
    let mut layer = SceneLayer::new(&gpu, &objects, &[], 16 << 20).unwrap();
    let mut twin = TwinScene::new(&objects, &[]);
    for unit in [coming_root(&root), coming(1, &fine)] {
        layer.upload(&unit).unwrap();
        twin.upload(&unit).unwrap();
    }
    let style = style(Culling::ALL);
    let path = path();
    layer.picture(&path[0], &style).unwrap();
    let [_, seen] = twin.clusters_seen(&path[0], &style);
    assert_eq!(layer.clusters_drawn().unwrap(), [seen as u32, 0]);
    for steps in path.windows(2) {
        // Where the view jumped, the second picture is the first of which one go draws all.
        for view in [&steps[0], &steps[0], &steps[1]] {
            layer.picture(view, &style).unwrap();
        }
        let [first, second] = layer.clusters_drawn().unwrap();
        let [_, seen] = twin.clusters_seen(&steps[1], &style);
        let hidden = twin.clusters_hidden(&steps[1], &steps[0], &style);
        let expected = (seen - hidden) as f64;
        assert!(
            (f64::from(first) - expected).abs() <= 0.02 * seen as f64,
            "{first} {expected}"
        );
        let is_still = steps[0] == steps[1];
        assert_eq!(
            second == 0,
            is_still,
            "{second} of {seen} clusters in the second go"
        );
        if is_still {
            assert!(4 * hidden > seen, "{hidden} of {seen} clusters are hidden");
        }
    }
}
