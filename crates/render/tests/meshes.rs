//! Do the shaders of meshes draw what their twins draw, and what was sent?

use crate::common::torus::{
    ALL, ROOT, coming, coming_root, from_above, object, refinement, root, squares_of, view,
    worth_by_cluster,
};
use crate::common::{Seeded, bytes_of, share_beyond, write_png};
use foveal_core::content::mesh::payload::{Attributes, MeshUnit};
use foveal_core::content::payload::PayloadView;
use foveal_core::content::scene::description::{Backdrop, SceneObject};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::footprints::Footprint;
use foveal_core::perception::glance::Glance;
use foveal_core::perception::parameters::EyeState;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_render::meshes::unit_bytes;
use foveal_render::twin::TwinScene;
use foveal_render::{
    Coming, Culling, DrawDevice, Gpu, RenderError, RgbaImage, SceneDrawer, SceneLayer, SceneStyle,
    Under,
};
use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

const MOST_BYTES: u64 = 16 << 20;
const SIZE: [u32; 2] = [192, 128];

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

    fn coming(&self) -> impl Iterator<Item = Coming<'_>> {
        let numbered = self.units.iter().zip(0..);
        numbered.map(|(payload, unit)| match unit {
            0 => coming_root(payload),
            _ => coming(unit, payload),
        })
    }

    fn on_gpu(&self, gpu: &Gpu) -> SceneLayer {
        let mut layer = SceneLayer::new(gpu, &self.objects, &[], MOST_BYTES).unwrap();
        self.coming()
            .for_each(|it| assert!(layer.upload(&it).unwrap()));
        layer
    }

    fn in_memory(&self) -> TwinScene {
        let mut twin = TwinScene::new(&self.objects, &[]);
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

#[test]
fn a_torus_is_drawn_as_by_its_twin_whatever_its_vertices_have() {
    let flat = Attributes::default();
    let normals = Attributes {
        normals: true,
        ..flat
    };
    for (name, attributes) in [("flat", flat), ("normals", normals), ("all", ALL)] {
        let style = SceneStyle::default();
        assert_alike(name, object(attributes), &from_above(SIZE), &style);
    }
}

#[test]
fn a_torus_seen_from_both_sides_or_mirrored_or_unlit_is_drawn_as_by_its_twin() {
    let styles = [SceneStyle::default(), cut_at(3.6)];
    for style in styles {
        let two_sided = SceneObject {
            two_sided: true,
            ..object(ALL)
        };
        let name = format!("two_sided_{}", style.near);
        assert_alike(&name, two_sided, &from_above(SIZE), &style);
        assert_alike(
            &format!("cut_{}", style.near),
            object(ALL),
            &from_above(SIZE),
            &style,
        );
    }
    let bent =
        DAffine3::from_cols_array(&[-0.9, 0.2, 0.0, 0.1, 0.7, -0.3, 0.0, 0.3, 1.1, 0.2, 0.1, 0.0]);
    for (name, attributes) in [("mirrored", ALL), ("mirrored_flat", Attributes::default())] {
        let mirrored = SceneObject {
            placements: vec![bent.to_cols_array()],
            ..object(attributes)
        };
        assert_alike(name, mirrored, &from_above(SIZE), &SceneStyle::default());
    }
    let unlit = SceneObject {
        unlit: true,
        ..object(ALL)
    };
    let tinted = SceneStyle {
        tint: 0.4,
        ..SceneStyle::default()
    };
    assert_alike("unlit", unlit, &from_above(SIZE), &tinted);
}

/// A style that cuts off what is nearer than `near` metres.
fn cut_at(near: f64) -> SceneStyle {
    SceneStyle {
        near,
        ..SceneStyle::default()
    }
}

#[test]
fn culling_leaves_clusters_out_and_the_picture_as_it_is() {
    let gpu = Gpu::open_blocking().unwrap();
    let standing = |x: f64, y: f64| DAffine3::from_translation(DVec3::new(x, 0.0, y));
    let places = [
        (0.0, 0.0),
        (3.0, -1.0),
        (-40.0, 2.0),
        (0.5, 30.0),
        (1.0, -30.0),
    ];
    let torus = Torus::new(SceneObject {
        placements: places.map(|(x, y)| standing(x, y).to_cols_array()).to_vec(),
        ..object(ALL)
    });
    let twin = torus.in_memory();
    let mut layer = torus.on_gpu(&gpu);
    for (position, to) in [
        ([0.3, 2.2, 3.6], [-4.0, -31.0]),
        ([0.0, 0.1, 2.0], [20.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0]),
        ([-39.0, 0.2, 4.0], [0.0, 40.0]),
    ] {
        let view = view(position, to, SIZE);
        let [culls, draws_all] = [Culling::ALL, Culling::NONE].map(|culls| SceneStyle {
            culls,
            ..SceneStyle::default()
        });
        let all = layer.picture(&view, &draws_all).unwrap();
        assert_eq!(layer.picture(&view, &culls).unwrap(), all);
        assert_eq!(twin.picture(&view, &culls), twin.picture(&view, &draws_all));
        let [drawn, seen] = twin.clusters_seen(&view, &culls);
        assert!(seen * 3 < drawn * 2, "{seen} of {drawn} clusters are seen");
    }
    let triangles = [layer.triangles_drawn(), twin.triangles_drawn()];
    assert_eq!(triangles, [5 * (11 * 32 + 5 * 64); 2]);
}

#[test]
fn clusters_that_show_their_backs_are_left_out_unless_both_sides_are_seen() {
    let gpu = Gpu::open_blocking().unwrap();
    let units: Vec<MeshUnit> = (0..16).map(squares_of).collect();
    for two_sided in [false, true] {
        let torus = Torus {
            objects: vec![SceneObject {
                two_sided,
                ..object(ALL)
            }],
            units: units.clone(),
        };
        let roots = units.iter().zip(0..).map(|(payload, unit)| Coming {
            unit: UnitId(unit),
            ..coming_root(payload)
        });
        let mut layer = SceneLayer::new(&gpu, &torus.objects, &[], MOST_BYTES).unwrap();
        let mut twin = TwinScene::new(&torus.objects, &[]);
        for root in roots {
            layer.upload(&root).unwrap();
            twin.upload(&root).unwrap();
        }
        let culls = SceneStyle::default();
        let draws_all = SceneStyle {
            culls: Culling::NONE,
            ..culls
        };
        let view = from_above(SIZE);
        let all = layer.picture(&view, &draws_all).unwrap();
        assert_eq!(layer.picture(&view, &culls).unwrap(), all);
        let twins = twin.picture(&view, &culls);
        assert_eq!(twins, twin.picture(&view, &draws_all));
        assert!(share_beyond(&all, &twins, 2) < 0.005);
        let [drawn, seen] = twin.clusters_seen(&view, &culls);
        assert_eq!(drawn, 256);
        assert_eq!(seen < 180, !two_sided, "{seen} clusters are seen");
    }
}

#[test]
fn what_stands_far_from_the_origin_is_drawn_as_what_stands_there() {
    let gpu = Gpu::open_blocking().unwrap();
    let far = DVec3::new(1.0e7, -2.0e6, 3.0e7);
    let away = Torus::new(SceneObject {
        placements: vec![DAffine3::from_translation(far).to_cols_array()],
        ..object(ALL)
    });
    let near_view = from_above(SIZE);
    let far_view = EyeView {
        position: near_view.position + far,
        ..near_view
    };
    let style = SceneStyle::default();
    let there = away.on_gpu(&gpu).picture(&far_view, &style).unwrap();
    let mut at_origin = Torus::new(object(ALL)).on_gpu(&gpu);
    let here = at_origin.picture(&near_view, &style).unwrap();
    assert!(share_beyond(&there, &here, 1) < 0.001);
}

#[test]
fn a_refined_surface_has_no_hole_and_what_is_removed_is_drawn_coarsely_again() {
    let gpu = Gpu::open_blocking().unwrap();
    let torus = Torus::new(SceneObject {
        unlit: true,
        colour: [1.0; 4],
        ..object(Attributes::default())
    });
    let mut layer = torus.on_gpu(&gpu);
    let style = SceneStyle::default();
    let view = from_above(SIZE);
    let fine = layer.picture(&view, &style).unwrap();
    layer.remove(UnitId(2));
    layer.retain(&HashSet::new());
    let coarse = layer.picture(&view, &style).unwrap();
    let mut only_root = SceneLayer::new(&gpu, &torus.objects, &[], MOST_BYTES).unwrap();
    only_root.upload(&coming_root(&torus.units[0])).unwrap();
    assert_eq!(coarse, only_root.picture(&view, &style).unwrap());
    // The new vertices lie outside the coarse squares, or in them: nothing is uncovered.
    let (fine, coarse) = (fine.pixels.chunks(4), coarse.pixels.chunks(4));
    assert!(fine.zip(coarse).all(|(fine, coarse)| fine[0] >= coarse[0]));
}

#[test]
fn a_unit_stays_as_long_as_another_needs_it() {
    let gpu = Gpu::open_blocking().unwrap();
    let torus = Torus::new(object(ALL));
    let mut layer = torus.on_gpu(&gpu);
    let style = SceneStyle::default();
    let before = layer.picture(&from_above(SIZE), &style).unwrap();
    layer.retain(&HashSet::from([UnitId(1), UnitId(2)]));
    assert_eq!(layer.picture(&from_above(SIZE), &style).unwrap(), before);
    layer.retain(&HashSet::from([UnitId(1)]));
    let mut twin = torus.in_memory();
    twin.remove(UnitId(2));
    let drawn = layer.picture(&from_above(SIZE), &style).unwrap();
    assert_ne!(drawn, before);
    let expected = twin.picture(&from_above(SIZE), &style);
    assert!(share_beyond(&drawn, &expected, 2) < 0.005);
}

#[test]
fn units_come_and_go_as_long_as_their_bytes_fit() {
    let gpu = Gpu::open_blocking().unwrap();
    let standing = |k: u32| DVec3::new(f64::from(k % 8) * 3.0 - 10.5, 0.0, -f64::from(k / 8) * 3.0);
    let objects: Vec<SceneObject> = (0..48)
        .map(|k| SceneObject {
            placements: vec![DAffine3::from_translation(standing(k)).to_cols_array()],
            ..object(ALL)
        })
        .collect();
    let payload = [root(), refinement(&[5, 6]), refinement(&[9, 13, 8])];
    let most = 40 * unit_bytes(&payload[0]);
    let mut layer = SceneLayer::new(&gpu, &objects, &[], most).unwrap();
    let mut twin = TwinScene::new(&objects, &[]);
    let mut there: BTreeMap<u32, u64> = BTreeMap::new();
    let (mut seeded, mut refused) = (Seeded(7), 0);
    for _ in 0..1500 {
        let object = seeded.below(48) as u16;
        let (first, which) = (3 * u32::from(object), seeded.below(3));
        let unit = first + which;
        if there.contains_key(&unit) {
            // Refined roots stay.
            if which != 0 || !(there.contains_key(&(first + 1)) || there.contains_key(&(first + 2)))
            {
                there.remove(&unit);
                layer.remove(UnitId(unit));
                twin.remove(UnitId(unit));
            }
            continue;
        }
        let needs = [UnitId(first)];
        if which != 0 && !there.contains_key(&first) {
            continue;
        }
        let payload = &payload[which as usize];
        let coming = Coming {
            unit: UnitId(unit),
            object,
            level: u8::from(which == 0),
            needs: &needs[..usize::from(which != 0)],
            part: None,
            payload: PayloadView::Mesh(payload),
        };
        let bytes = there.values().sum::<u64>() + unit_bytes(payload);
        match layer.upload(&coming) {
            Ok(is_there) => {
                assert!(is_there && bytes <= most);
                twin.upload(&coming).unwrap();
                there.insert(unit, unit_bytes(payload));
            }
            Err(RenderError::NoRoom { .. }) => {
                assert!(bytes > most, "{bytes} of {most} did not fit");
                refused += 1;
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(
        refused > 10 && there.len() > 40,
        "{refused} refused, {} there",
        there.len()
    );
    let view = view([0.0, 12.0, 6.0], [0.0, -40.0], [320, 200]);
    let style = SceneStyle::default();
    let drawn = layer.picture(&view, &style).unwrap();
    let expected = twin.picture(&view, &style);
    look_at("many_gpu", &drawn);
    look_at("many_twin", &expected);
    let off = share_beyond(&drawn, &expected, 2);
    assert!(off <= 0.02, "{off} of all pixels differ by more than 2");
}

#[test]
fn pixels_name_the_units_that_would_refine_them() {
    let gpu = Gpu::open_blocking().unwrap();
    let torus = Torus::new(object(ALL));
    let (mut layer, mut twin) = (torus.on_gpu(&gpu), torus.in_memory());
    let refiners = (0..16).map(|cluster| ((ROOT, cluster), UnitId(100 + u32::from(cluster))));
    let refiners: HashMap<_, _> = refiners.filter(|((_, cluster), _)| *cluster != 2).collect();
    layer.set_refiners(refiners.clone());
    twin.set_refiners(refiners);
    let style = SceneStyle::default();
    let expected = twin.ids(&from_above(SIZE), &style);
    let image = layer.ids(&from_above(SIZE), &style).unwrap();
    let bytes = bytes_of(&gpu, image);
    let drawn: Vec<u32> = bytes
        .as_chunks()
        .0
        .iter()
        .map(|it| u32::from_le_bytes(*it))
        .collect();
    let off = drawn.iter().zip(&expected).filter(|(a, b)| a != b).count();
    assert!(off * 200 < drawn.len(), "{off} pixels differ");
    let named: HashSet<u32> = drawn.into_iter().collect();
    assert!(named.contains(&u32::MAX) && named.contains(&100) && named.len() > 6);
    assert!(
        !named.contains(&105),
        "a cluster that is refined is not drawn"
    );
}

#[test]
fn footprints_add_up_what_each_unit_would_refine_as_the_twin_does() {
    let gpu = Gpu::open_blocking().unwrap();
    let torus = Torus::new(object(ALL));
    let (mut layer, mut twin) = (torus.on_gpu(&gpu), torus.in_memory());
    let refiners = (0..16).map(|cluster| ((ROOT, cluster), UnitId(100 + u32::from(cluster))));
    let refiners: HashMap<_, _> = refiners.collect();
    layer.set_refiners(refiners.clone());
    twin.set_refiners(refiners);
    let style = SceneStyle::default();
    let view = from_above(SIZE);
    let glance = Glance {
        gaze: GazeSample {
            gaze_in_content: view.axes.forward,
            ..GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0))
        },
        view: Some(view),
        state: EyeState::Steady,
    };
    let expected = twin.footprints(&glance, &style);
    let back = layer.footprints(&glance, &style).unwrap().unwrap();
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .unwrap();
    let found = pollster::block_on(back.list()).unwrap();
    assert!(found.len() > 6);
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found.unit, expected.unit);
        let area = f64::from(found.area) / f64::from(expected.area);
        assert!((0.9..1.1).contains(&area), "{found:?} {expected:?}");
        assert!(
            found.mean.abs_diff(expected.mean) <= 8,
            "{found:?} {expected:?}"
        );
    }
    let area: f64 = found.iter().map(Footprint::area_deg2).sum();
    let all = twin.ids(&view, &style);
    let share = all.iter().filter(|it| **it != u32::MAX).count() as f64 / all.len() as f64;
    let field = view.field;
    let [across, along] = [field.left + field.right, field.up + field.down];
    let most = share * across * along * Radians(1.0).to_degrees().powi(2);
    assert!(
        area > 0.3 * most && area <= most,
        "{area} of at most {most}"
    );
    for found in found {
        assert!(found.least <= found.mean);
    }
}

#[test]
fn a_unit_that_does_not_fit_to_what_is_there_is_refused_with_a_reason() {
    let gpu = Gpu::open_blocking().unwrap();
    let torus = Torus::new(object(ALL));
    let mut layer = SceneLayer::new(&gpu, &torus.objects, &[], MOST_BYTES).unwrap();
    let early = layer.upload(&coming(1, &torus.units[1])).unwrap_err();
    assert!(
        early.to_string().contains("unit 1, prerequisite"),
        "{early}"
    );
    let stray = Coming {
        object: 7,
        ..coming_root(&torus.units[0])
    };
    let stray = layer.upload(&stray).unwrap_err().to_string();
    assert!(
        stray.contains("object is 7; it must be less than 1"),
        "{stray}"
    );
    layer.upload(&coming_root(&torus.units[0])).unwrap();
    let again = coming(2, &torus.units[1]);
    layer.upload(&coming(1, &torus.units[1])).unwrap();
    let twice = layer.upload(&again).unwrap_err().to_string();
    assert!(twice.contains("one that no other unit replaces"), "{twice}");
}

#[test]
fn whatever_draws_is_given_the_same_units_and_shows_the_same_picture() {
    let torus = Torus::new(object(ALL));
    let view = from_above(SIZE);
    let style = SceneStyle::default();
    let gpu = DrawDevice::Gpu(Gpu::open_blocking().unwrap());
    let pictures = [gpu, DrawDevice::Twin, DrawDevice::Nothing].map(|device| {
        let mut drawer = SceneDrawer::new(&device, &torus.objects, &[], MOST_BYTES).unwrap();
        torus
            .coming()
            .for_each(|it| assert!(drawer.upload(&it).unwrap()));
        drawer.keep(&HashSet::from([UnitId(2)]), &[]);
        let under = Under::default();
        let draws_on_gpu = matches!(device, DrawDevice::Gpu(_));
        assert_eq!(
            drawer.draw(&under, &view, &style).unwrap().is_some(),
            draws_on_gpu
        );
        assert_eq!(drawer.gpu_bytes() > 0, draws_on_gpu);
        let picture = drawer.picture(&under, &view, &style).unwrap();
        let read = drawer.read(&under, &view, &style).unwrap().is_some();
        assert_eq!(read, picture.is_some());
        let triangles = if read { 13 * 32 + 3 * 64 } else { 0 };
        assert_eq!(drawer.triangles_drawn(), triangles);
        picture
    });
    let [Some(drawn), Some(expected), None] = pictures else {
        panic!("a device draws nothing, or nothing draws");
    };
    assert!(share_beyond(&drawn, &expected, 2) < 0.005);
}

#[test]
fn background_and_light_are_those_of_the_style() {
    let torus = Torus::new(object(ALL));
    let gpu = Gpu::open_blocking().unwrap();
    let view = from_above(SIZE);
    let lit_from = |light| SceneStyle {
        look: Backdrop {
            background: [0.0144, 0.0513, 1.0],
            light,
        },
        ..SceneStyle::default()
    };
    let mut layer = torus.on_gpu(&gpu);
    let twin = torus.in_memory();
    let pictures = [[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]].map(|light| {
        let style = lit_from(light);
        let drawn = layer.picture(&view, &style).unwrap();
        assert!(share_beyond(&drawn, &twin.picture(&view, &style), 2) <= 0.005);
        drawn
    });
    assert_eq!(pictures[0].pixel([0, 0]), [32, 64, 255, 255]);
    assert!(share_beyond(&pictures[0], &pictures[1], 20) > 0.05);
}

#[test]
fn what_units_are_worth_is_painted_over_what_they_would_refine_as_by_the_twin() {
    let gpu = Gpu::open_blocking().unwrap();
    let torus = Torus::new(object(ALL));
    let (mut layer, mut twin) = (torus.on_gpu(&gpu), torus.in_memory());
    let (refiners, worths) = worth_by_cluster();
    layer.set_refiners(refiners.clone());
    twin.set_refiners(refiners);
    let (view, style) = (from_above(SIZE), SceneStyle::default());
    let plain = twin.picture(&view, &style);
    let ids = twin.ids(&view, &style);
    // The buffer is made, rewritten, and made again.
    let turned: Vec<f32> = worths.iter().rev().copied().collect();
    for worths in [worths.as_slice(), &turned, &worths[..9]] {
        layer.mark(Some(worths)).unwrap();
        twin.mark(Some(worths));
        let expected = twin.picture(&view, &style);
        let drawn = layer.picture(&view, &style).unwrap();
        assert!(share_beyond(&drawn, &expected, 2) <= 0.005);
        let mut painted = 0;
        for ((unit, before), after) in ids.iter().zip(pixels(&plain)).zip(pixels(&expected)) {
            match worths.get(*unit as usize) {
                Some(worth) if *worth >= 0.0 => painted += usize::from(before != after),
                _ => assert_eq!(before, after, "nothing is known of unit {unit}"),
            }
        }
        assert!(painted > 300, "{painted}");
    }
    layer.mark(None).unwrap();
    twin.mark(None);
    assert_eq!(twin.picture(&view, &style), plain);
    assert!(share_beyond(&layer.picture(&view, &style).unwrap(), &plain, 2) <= 0.005);
}

fn pixels(image: &RgbaImage) -> &[[u8; 4]] {
    image.pixels.as_chunks().0
}
