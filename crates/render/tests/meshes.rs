//! Do the shaders of meshes draw what their twins draw, and what was sent?
#![allow(clippy::unwrap_used)]

mod common;

use common::torus::{ALL, ROOT, coming, coming_root, from_above, object, refinement, root, view};
use common::{read_png, write_png};
use foveal_core::content::mesh::payload::{Attributes, MeshUnit};
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use foveal_render::twin::TwinScene;
use foveal_render::{ComingUnit, Gpu, RgbaImage, SceneLayer, SceneStyle};
use glam::{DAffine3, DVec3};
use std::collections::HashSet;
use std::path::Path;

const MOST_BYTES: u64 = 16 << 20;
const SIZE: [u32; 2] = [192, 128];

/// Share of pixels of which a channel differs by more than `most`.
fn share_beyond(a: &RgbaImage, b: &RgbaImage, most: u8) -> f64 {
    assert_eq!(a.size, b.size);
    let pixels = a.pixels.chunks(4).zip(b.pixels.chunks(4));
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > most));
    off.count() as f64 / (a.pixels.len() / 4) as f64
}

/// Writes a picture to look at, where `FOVEAL_LARGE` names a folder.
fn look_at(name: &str, image: &RgbaImage) {
    if let Ok(folder) = std::env::var("FOVEAL_LARGE") {
        write_png(&Path::new(&folder).join(format!("{name}.png")), image);
    }
}

/// A torus with some of its clusters refined.
struct Torus {
    objects: Vec<SceneObject>,
    units: Vec<MeshUnit>,
}

impl Torus {
    fn new(object: SceneObject) -> Self {
        Self {
            objects: vec![object],
            units: vec![root(), refinement(&[5, 6]), refinement(&[9, 13, 8])],
        }
    }

    fn coming(&self) -> impl Iterator<Item = ComingUnit<'_>> {
        let numbered = self.units.iter().zip(0..);
        numbered.map(|(says, unit)| match unit {
            0 => coming_root(says),
            _ => coming(unit, says),
        })
    }

    fn on_gpu(&self, gpu: &Gpu) -> SceneLayer {
        let mut layer = SceneLayer::new(gpu, &self.objects, MOST_BYTES).unwrap();
        self.coming().for_each(|it| layer.upload(&it).unwrap());
        layer
    }

    fn in_memory(&self) -> TwinScene {
        let mut twin = TwinScene::new(&self.objects);
        self.coming().for_each(|it| twin.upload(&it).unwrap());
        twin
    }
}

fn assert_alike(name: &str, object: SceneObject, view: &EyeView, style: &SceneStyle) {
    let torus = Torus::new(object);
    let gpu = Gpu::open_blocking().unwrap();
    let drawn = torus.on_gpu(&gpu).picture(view, style).unwrap();
    let expected = torus.in_memory().picture(view, style);
    look_at(&format!("{name}_gpu"), &drawn);
    look_at(&format!("{name}_twin"), &expected);
    let off = share_beyond(&drawn, &expected, 2);
    assert!(
        off <= 0.005,
        "{name}: {off} of all pixels differ by more than 2"
    );
    let background = drawn.pixel([0, 0]);
    let shown = drawn.pixels.chunks(4).filter(|it| **it != background);
    assert!(shown.count() > 500, "{name} shows next to nothing");
}

fn with(attributes: Attributes) -> SceneObject {
    object(attributes)
}

#[test]
fn a_torus_is_drawn_as_by_its_twin_whatever_its_vertices_have() {
    let flat = Attributes::default();
    let normals = Attributes {
        normals: true,
        ..flat
    };
    for (name, attributes) in [("flat", flat), ("normals", normals), ("all", ALL)] {
        let style = SceneStyle::default();
        assert_alike(name, with(attributes), &from_above(SIZE), &style);
    }
}
