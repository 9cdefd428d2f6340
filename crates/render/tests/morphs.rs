//! Do units come from the coarse surface to their places, on the GPU as in its twin?

use crate::common::share_beyond;
use crate::common::torus::{ALL, coming, coming_root, from_above, object, refinement, root};
use foveal_core::content::mesh::payload::{Cluster, MeshUnit, MeshVertex};
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::pack::unit::UnitId;
use foveal_render::twin::TwinScene;
use foveal_render::{Coming, Culling, Gpu, RgbaImage, SceneLayer, SceneStyle};
use std::collections::{BTreeMap, HashSet};

pub(crate) const SIZE: [u32; 2] = [192, 128];
pub(crate) const MOST_BYTES: u64 = 16 << 20;

/// A root, two units that refine parts of it, and one that refines a part of the first of these.
pub(crate) struct Units([MeshUnit; 4]);

impl Units {
    pub(crate) fn new() -> Self {
        let first = refinement(&[5, 6]);
        let above = halved(&first);
        Self([root(), first, refinement(&[9, 13, 8]), above])
    }

    fn all(&self) -> [Coming<'_>; 4] {
        let [root, first, second, above] = &self.0;
        let above = Coming {
            needs: &[UnitId(1)],
            ..coming(3, above)
        };
        [
            coming_root(root),
            coming(1, first),
            coming(2, second),
            above,
        ]
    }

    pub(crate) fn on_gpu(&self, gpu: &Gpu, count: usize) -> SceneLayer {
        let mut layer = SceneLayer::new(gpu, &[object(ALL)], &[], MOST_BYTES).unwrap();
        let units = self.all();
        units[..count]
            .iter()
            .for_each(|it| assert!(layer.upload(it).unwrap()));
        layer
    }

    pub(crate) fn in_memory(&self) -> TwinScene {
        let mut twin = TwinScene::new(&[object(ALL)], &[]);
        self.all().iter().for_each(|it| twin.upload(it).unwrap());
        twin
    }
}

/// In the place of the first cluster of a unit: each triangle with a vertex more, off its middle.
fn halved(unit: &MeshUnit) -> MeshUnit {
    let coarse = &unit.clusters[0];
    let root = root();
    let staying = coarse.vertices.len() as u16;
    // The vertices that stay are numbered as the replaced cluster names them.
    let at = |corner: u8| {
        let number = coarse.vertices[usize::from(corner)];
        match number.checked_sub(unit.staying) {
            Some(own) => unit.vertices[usize::from(own)],
            None => root.vertices[usize::from(corner_of_root(corner))],
        }
    };
    let mut says = MeshUnit {
        replaces: vec![PartRef { need: 0, part: 0 }],
        staying,
        ..MeshUnit::default()
    };
    for triangles in coarse.triangles.chunks(32) {
        let mut cluster = Cluster {
            vertices: (0..staying).collect(),
            triangles: Vec::new(),
        };
        for [a, b, c] in triangles {
            let corners = [*a, *b, *c].map(at);
            let middle = |axis: usize| {
                let sum: u32 = corners.iter().map(|it| u32::from(it.place[axis])).sum();
                (sum / 3 + 20) as u16
            };
            says.vertices.push(MeshVertex {
                place: [0, 1, 2].map(middle),
                ..corners[2]
            });
            let new = cluster.vertices.len() as u8;
            cluster
                .vertices
                .push(staying + says.vertices.len() as u16 - 1);
            cluster
                .triangles
                .extend([[*a, *b, new], [*b, *c, new], [*c, *a, new]]);
        }
        says.clusters.push(cluster);
    }
    says
}

/// The vertex of the root at a corner of its sixth cluster.
fn corner_of_root(corner: u8) -> u16 {
    root().clusters[5].vertices[usize::from(corner)]
}

fn shares<const N: usize>(of: [(u32, f64); N]) -> BTreeMap<UnitId, f64> {
    of.map(|(unit, share)| (UnitId(unit), share)).into()
}

/// Mean square of the difference of codes.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let pairs = a.pixels.iter().zip(&b.pixels);
    let squares = pairs.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2));
    squares.sum::<f64>() / a.pixels.len() as f64
}

fn drawn(layer: &mut SceneLayer) -> RgbaImage {
    let style = SceneStyle::default();
    layer.picture(&from_above(SIZE), &style).unwrap()
}

#[test]
fn what_is_on_its_way_is_drawn_as_by_its_twin_also_below_other_units() {
    let gpu = Gpu::open_blocking().unwrap();
    let units = Units::new();
    let (mut layer, mut twin) = (units.on_gpu(&gpu, 4), units.in_memory());
    let view = from_above(SIZE);
    let style = SceneStyle::default();
    let draws_all = SceneStyle {
        culls: Culling::NONE,
        ..style
    };
    let mut before = drawn(&mut layer);
    for shares in [
        shares([(1, 0.0), (2, 0.5), (3, 0.5)]),
        shares([(1, 0.5), (2, 0.7), (3, 0.6)]),
        shares([(2, 0.9), (3, 0.7)]),
        shares([(1, 0.3)]),
        shares([]),
    ] {
        layer.morph(&shares);
        twin.morph(&shares);
        let image = drawn(&mut layer);
        let off = share_beyond(&image, &twin.picture(&view, &style), 2);
        assert!(off <= 0.005, "{shares:?}: {off} of all pixels differ");
        assert_eq!(layer.picture(&view, &draws_all).unwrap(), image);
        assert_ne!(before, image, "{shares:?}");
        before = image;
    }
}

#[test]
fn a_unit_begins_like_what_it_is_shown_in_place_of_and_ends_bit_for_bit_in_its_place() {
    let gpu = Gpu::open_blocking().unwrap();
    let units = Units::new();
    let coarse = drawn(&mut units.on_gpu(&gpu, 1));
    let mut layer = units.on_gpu(&gpu, 3);
    let fine = drawn(&mut layer);
    let popping = difference(&coarse, &fine);
    let mut last = popping;
    for share in [0.0, 0.3, 0.7, 1.0] {
        layer.morph(&shares([(1, share), (2, share)]));
        let image = drawn(&mut layer);
        let left = difference(&image, &fine);
        assert!(left <= last, "{left} after {last}");
        last = left;
        if share == 0.0 {
            let off = difference(&image, &coarse);
            assert!(off * 8.0 < popping, "{off} of {popping} show at once");
        }
    }
    assert_eq!(drawn(&mut layer), fine);
    layer.morph(&shares([]));
    assert_eq!(drawn(&mut layer), fine);
}

#[test]
fn what_is_evicted_on_its_way_leaves_the_coarse_surface_as_it_was() {
    let gpu = Gpu::open_blocking().unwrap();
    let units = Units::new();
    let coarse = drawn(&mut units.on_gpu(&gpu, 1));
    let mut layer = units.on_gpu(&gpu, 4);
    layer.morph(&shares([(1, 0.4), (2, 0.1), (3, 0.2)]));
    layer.retain(&HashSet::new());
    assert_eq!(drawn(&mut layer), coarse);
    layer.morph(&shares([(1, 0.5), (2, 0.2)]));
    assert_eq!(drawn(&mut layer), coarse);
    // What stands on a unit that moves is drawn anywhere it may be, from the first picture on.
    let all = units.all();
    layer.upload(&all[1]).unwrap();
    layer.morph(&shares([(1, 0.5)]));
    layer.upload(&all[3]).unwrap();
    let mut twin = TwinScene::new(&[object(ALL)], &[]);
    for k in [0, 1, 3] {
        twin.upload(&all[k]).unwrap();
    }
    twin.morph(&shares([(1, 0.5)]));
    let expected = twin.picture(&from_above(SIZE), &SceneStyle::default());
    assert!(share_beyond(&drawn(&mut layer), &expected, 2) <= 0.005);
}
