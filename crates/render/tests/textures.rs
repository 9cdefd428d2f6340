//! Do textures lie where they should, as fine as their pages are there, as their twin draws them?

use crate::common::plate::{FIRST_PAGE, PlatePage, checker, object, pages, plates, texture};
use crate::common::torus::{coming_root, view};
use crate::common::{Seeded, write_png};
use foveal_core::content::images::halving::Halving;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use foveal_render::twin::TwinScene;
use foveal_render::{Gpu, RgbaImage, SceneLayer, SceneStyle};
use std::collections::HashSet;
use std::path::Path;

const MOST_BYTES: u64 = 64 << 20;

/// Plates, their textures and pages.
struct Scene {
    objects: Vec<SceneObject>,
    textures: Vec<SceneTexture>,
    pages: Vec<PlatePage>,
}

impl Scene {
    fn new(pictures: &[(TexturePicture, Wrap)], times: f64) -> Self {
        let textures: Vec<_> = pictures
            .iter()
            .map(|(it, wrap)| texture(it, *wrap))
            .collect();
        let mut all = Vec::new();
        for (number, (picture, _)) in pictures.iter().enumerate() {
            let first = FIRST_PAGE + all.len() as u32;
            all.extend(pages(number as u16, &textures[number], picture, first));
        }
        Self {
            objects: vec![object(pictures.len() as u16, times)],
            textures,
            pages: all,
        }
    }

    fn on_gpu(&self, gpu: &Gpu) -> SceneLayer {
        let mut layer = SceneLayer::new(gpu, &self.objects, &self.textures, MOST_BYTES).unwrap();
        let plates = plates(self.textures.len() as u8);
        layer.upload(&coming_root(&plates)).unwrap();
        layer
    }

    fn in_memory(&self) -> TwinScene {
        let mut twin = TwinScene::new(&self.objects, &self.textures);
        let plates = plates(self.textures.len() as u8);
        twin.upload(&coming_root(&plates)).unwrap();
        twin
    }
}

/// Share of pixels of which a channel differs by more than `most`.
fn share_beyond(a: &RgbaImage, b: &RgbaImage, most: u8) -> f64 {
    let pixels = a.pixels.chunks(4).zip(b.pixels.chunks(4));
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > most));
    off.count() as f64 / (a.pixels.len() / 4) as f64
}

fn look_at(name: &str, image: &RgbaImage) {
    if let Ok(folder) = std::env::var("FOVEAL_LARGE") {
        write_png(&Path::new(&folder).join(format!("{name}.png")), image);
    }
}

/// Draws with the pages that `there` keeps, on the GPU and by the twin.
fn drawn(
    name: &str,
    scene: &Scene,
    view: &EyeView,
    there: impl Fn(&PlatePage) -> bool,
) -> RgbaImage {
    let gpu = Gpu::open_blocking().unwrap();
    let (mut layer, mut twin) = (scene.on_gpu(&gpu), scene.in_memory());
    for page in scene.pages.iter().filter(|it| there(it)) {
        assert!(layer.upload(&page.coming()).unwrap());
        twin.upload(&page.coming()).unwrap();
    }
    let style = SceneStyle::default();
    let picture = layer.picture(view, &style).unwrap();
    let expected = twin.picture(view, &style);
    look_at(&format!("{name}_gpu"), &picture);
    look_at(&format!("{name}_twin"), &expected);
    let off = share_beyond(&picture, &expected, 3);
    assert!(
        off <= 0.005,
        "{name}: {off} of all pixels differ by more than 3"
    );
    picture
}

/// A view of one plate from its front that fills the height.
fn front(size: [u32; 2]) -> EyeView {
    // 50 degrees wide: half a metre to each side.
    let distance = 0.5 / 25_f64.to_radians().tan();
    view([0.5, 0.5, distance], [0.0, 0.0], size)
}

#[test]
fn a_checker_lies_where_its_texels_do() {
    let picture = checker([512, 512], 32);
    let scene = Scene::new(&[(picture.clone(), Wrap::Repeat)], 1.0);
    let image = drawn("checker", &scene, &front([512, 512]), |_| true);
    // A pixel is a texel; edges fall between them.
    for [x, y] in [
        [5, 9],
        [100, 300],
        [250, 17],
        [400, 500],
        [257, 257],
        [511, 0],
    ] {
        let (found, texel) = (image.pixel([x, y]), picture.at([x, y]));
        let off = found
            .iter()
            .zip(texel)
            .map(|(a, b)| a.abs_diff(b))
            .max()
            .unwrap();
        assert!(off <= 2, "{x} {y}: {found:?}, the texel is {texel:?}");
    }
}

#[test]
fn textures_from_near_and_far_and_askew_are_drawn_as_by_the_twin() {
    let scene = Scene::new(&[(checker([1000, 700], 40), Wrap::Clamp)], 1.0);
    for (name, position, turn) in [
        ("near", [0.5, 0.5, 0.1], [20.0, 5.0]),
        ("askew", [0.5, 0.15, 0.4], [10.0, 30.0]),
        ("far", [0.5, 0.5, 7.0], [0.0, 0.0]),
        ("very_far", [0.5, 0.5, 90.0], [0.0, 0.0]),
    ] {
        drawn(name, &scene, &view(position, turn, [160, 120]), |_| true);
    }
}

#[test]
fn textures_repeat_mirror_and_end_as_they_are_told() {
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let scene = Scene::new(&[(checker([300, 300], 50), wrap)], 3.0);
        let name = format!("{wrap:?}");
        let image = drawn(&name, &scene, &front([300, 300]), |_| true);
        let [first, second] = [[10, 150], [110, 150]].map(|at| image.pixel(at));
        let is_same = first.iter().zip(second).all(|(a, b)| a.abs_diff(b) < 12);
        assert_eq!(
            is_same,
            wrap == Wrap::Repeat,
            "{wrap:?}: {first:?} {second:?}"
        );
    }
}

#[test]
fn two_plates_have_each_its_own_texture() {
    let pictures = [checker([64, 64], 8), checker([400, 20], 10)];
    let pictures = pictures.map(|it| (it, Wrap::Repeat));
    let scene = Scene::new(&pictures, 1.0);
    let both = view([1.0, 0.5, 2.2], [0.0, 0.0], [200, 100]);
    drawn("two", &scene, &both, |_| true);
}

#[test]
fn what_is_missing_is_drawn_coarser_and_never_black() {
    let picture = checker([1024, 1024], 64);
    let scene = Scene::new(&[(picture.clone(), Wrap::Repeat)], 1.0);
    let view = front([256, 256]);
    let all = drawn("all", &scene, &view, |_| true);
    let mean = drawn("none", &scene, &view, |_| false).pixel([99, 99]);
    let codes = scene.textures[0]
        .colour
        .map(|it| Halving::default().code(it));
    let is_near = mean.iter().zip(codes).all(|(a, b)| a.abs_diff(b) <= 1);
    assert!(is_near, "{mean:?} {codes:?}");
    let root = drawn("root", &scene, &view, |it| it.needs.is_empty());
    let seeded = |seed| {
        let mut seeded = Seeded(seed);
        let kept: HashSet<UnitId> = scene
            .pages
            .iter()
            .filter(|_| seeded.below(2) > 0)
            .map(|it| it.unit)
            .collect();
        move |page: &PlatePage| kept.contains(&page.unit)
    };
    for seed in 0..3 {
        // With all that they need.
        let keeps = seeded(seed);
        let there: HashSet<UnitId> =
            scene
                .pages
                .iter()
                .rev()
                .fold(HashSet::new(), |mut there, it| {
                    if keeps(it) || there.contains(&it.unit) {
                        there.insert(it.unit);
                        there.extend(&it.needs);
                    }
                    there
                });
        let some = drawn("some", &scene, &view, |it| there.contains(&it.unit));
        // At a pixel a level 2 texel, all of these show the same light nearly.
        assert!(share_beyond(&some, &all, 40) < 0.05, "{seed}");
        assert!(
            some.pixels.chunks(4).all(|it| it[0] > 4 || it[1] > 4),
            "{seed}"
        );
    }
    assert!(share_beyond(&root, &all, 40) < 0.05);
}

#[test]
fn evicted_pages_are_drawn_coarser_again_and_their_place_is_used_anew() {
    let scene = Scene::new(&[(checker([1024, 1024], 64), Wrap::Repeat)], 1.0);
    let gpu = Gpu::open_blocking().unwrap();
    let (mut layer, mut twin) = (scene.on_gpu(&gpu), scene.in_memory());
    let near = view([0.3, 0.6, 0.2], [0.0, 0.0], [96, 96]);
    let style = SceneStyle::default();
    let root = UnitId(0);
    let mut bytes = Vec::new();
    let ranges = [
        0..scene.pages.len(),
        0..3,
        1..6,
        0..scene.pages.len(),
        4..5,
        0..0,
    ];
    let all: Vec<UnitId> = scene.pages.iter().map(|it| it.unit).collect();
    // What is not wanted goes, and in a second round stays where it lies.
    let rounds = ranges.iter().map(|range| (range, &all[..0]));
    let rounds = rounds.chain(ranges.iter().map(|range| (range, &all[1..])));
    for (wanted, staying) in rounds {
        let wanted = wanted.clone();
        let wanted: HashSet<UnitId> = scene.pages[wanted].iter().map(|it| it.unit).collect();
        let with_root: HashSet<UnitId> = wanted.iter().copied().chain([root]).collect();
        layer.keep(&with_root, staying);
        twin.keep(&with_root, staying);
        for page in &scene.pages {
            let is_needed = wanted.contains(&page.unit)
                || scene
                    .pages
                    .iter()
                    .any(|it| wanted.contains(&it.unit) && it.needs.contains(&page.unit))
                || page.needs.is_empty();
            if is_needed {
                layer.upload(&page.coming()).unwrap();
                twin.upload(&page.coming()).unwrap();
            }
        }
        let [drawn, expected] = [
            layer.picture(&near, &style).unwrap(),
            twin.picture(&near, &style),
        ];
        assert!(share_beyond(&drawn, &expected, 3) <= 0.005);
        bytes.push(layer.gpu_bytes());
    }
    assert!(bytes.iter().all(|it| *it <= bytes[0]), "{bytes:?}");
}

#[test]
fn where_a_texture_is_cut_out_nothing_is_drawn() {
    let mut picture = checker([256, 256], 64);
    for (number, texel) in picture.texels.iter_mut().enumerate() {
        texel[3] = if (number / 64) % 2 == 0 { 255 } else { 20 };
    }
    let mut scene = Scene::new(&[(picture, Wrap::Repeat)], 1.0);
    scene.textures[0].cutoff = Some(0.5);
    let image = drawn("cut_out", &scene, &front([256, 256]), |_| true);
    let background = drawn(
        "outside",
        &scene,
        &view([9.0, 9.0, 9.0], [0.0, 0.0], [8, 8]),
        |_| true,
    );
    assert_eq!(image.pixel([96, 100]), background.pixel([0, 0]));
    assert_ne!(image.pixel([32, 100]), background.pixel([0, 0]));
}

#[test]
fn pages_beyond_the_memory_are_left_coarse() {
    let scene = Scene::new(&[(checker([2048, 2048], 64), Wrap::Repeat)], 1.0);
    let gpu = Gpu::open_blocking().unwrap();
    let most = 6 << 20;
    let mut layer = SceneLayer::new(&gpu, &scene.objects, &scene.textures, most).unwrap();
    layer.upload(&coming_root(&plates(1))).unwrap();
    let mut there = HashSet::new();
    for page in &scene.pages {
        let is_alone = page.needs.iter().any(|it| !there.contains(it));
        if !is_alone && layer.upload(&page.coming()).unwrap() {
            there.insert(page.unit);
        }
    }
    assert!((15..30).contains(&there.len()), "{}", there.len());
    assert!(
        layer.gpu_bytes() <= most + most / 8,
        "{}",
        layer.gpu_bytes()
    );
    layer
        .picture(&front([64, 64]), &SceneStyle::default())
        .unwrap();
}
