//! Is what stays on the GPU left out of the picture, and does it give way?

use crate::common::share_beyond;
use crate::common::torus::from_above;
use crate::morphs::{MOST_BYTES, SIZE, Units};
use foveal_core::pack::unit::UnitId;
use foveal_render::twin::TwinScene;
use foveal_render::{Gpu, SceneLayer, SceneStyle};
use std::collections::{BTreeMap, HashSet};

const REFINING: [UnitId; 3] = [UnitId(1), UnitId(2), UnitId(3)];

#[test]
fn what_stays_is_not_drawn_until_it_is_shown_again() {
    let gpu = Gpu::open_blocking().unwrap();
    let units = Units::new();
    let (mut layer, mut twin) = (units.on_gpu(&gpu, 4), units.in_memory());
    let (view, style) = (from_above(SIZE), SceneStyle::default());
    let pictures = |layer: &mut SceneLayer, twin: &TwinScene| {
        let drawn = layer.picture(&view, &style).unwrap();
        [drawn, twin.picture(&view, &style)]
    };
    let fine = pictures(&mut layer, &twin);
    let bytes = layer.gpu_bytes();
    // One is hidden while it is on its way.
    let half = BTreeMap::from([(UnitId(1), 0.5)]);
    layer.morph(&half);
    twin.morph(&half);
    layer.keep(&HashSet::new(), &REFINING);
    twin.keep(&HashSet::new(), &REFINING);
    let mut root_alone = units.on_gpu(&gpu, 1);
    let mut twin_alone = units.in_memory();
    twin_alone.retain(&HashSet::new());
    let coarse = pictures(&mut root_alone, &twin_alone);
    assert!(coarse != fine && pictures(&mut layer, &twin) == coarse);
    assert_eq!(layer.triangles_drawn(), root_alone.triangles_drawn());
    assert_eq!(twin.triangles_drawn(), root_alone.triangles_drawn());
    assert_eq!(layer.gpu_bytes(), bytes);
    for unit in REFINING {
        assert!(layer.show(unit) && twin.show(unit));
    }
    layer.morph(&BTreeMap::new());
    twin.morph(&BTreeMap::new());
    assert!(pictures(&mut layer, &twin) == fine && layer.take_evicted().is_empty());
}

#[test]
fn what_stays_gives_way_where_memory_is_needed_but_not_what_is_about_to_be_shown() {
    let gpu = Gpu::open_blocking().unwrap();
    let units = Units::new();
    let (mut layer, mut twin) = (units.on_gpu(&gpu, 4), units.in_memory());
    let (view, style) = (from_above(SIZE), SceneStyle::default());
    let order = [UnitId(2), UnitId(1), UnitId(3)];
    layer.keep(&HashSet::new(), &order);
    layer.spare(&[UnitId(2)]);
    // Pictures as large as all memory: the pools give back what they do not use.
    let large = from_above([4096, MOST_BYTES.isqrt() as u32]);
    layer.expect(&[large]).unwrap();
    assert_eq!(layer.take_evicted(), [UnitId(3), UnitId(1)]);
    assert!(layer.show(UnitId(2)) && !layer.show(UnitId(1)));
    twin.retain(&HashSet::from([UnitId(2)]));
    let drawn = layer.picture(&view, &style).unwrap();
    assert!(share_beyond(&drawn, &twin.picture(&view, &style), 2) < 0.005);
}
