//! Do pages of textures hold what surfaces have, and are they described as mesh units are?

use super::built;
use crate::build::{BuildOptions, Built, build};
use crate::cracks::{CutTrial, check_cuts};
use crate::generate::{alone, textured_sphere};
use crate::source::{Material, MaterialTexture, SourceImage, SourceScene};
use foveal_core::content::images::halving::Halving;
use foveal_core::content::images::payload::ImagePage;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::{PAGE_SIDE, PagePlace, TextureShape};
use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::mesh::payload::{MeshUnit, NO_TEXTURE};
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::scene::unit_table::OF_ALL;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use glam::{DAffine2, DAffine3, DVec3};
use std::collections::BTreeMap;

/// Waves and specks, different everywhere.
fn picture(size: [u32; 2]) -> TexturePicture {
    let texel = |column: u32, row: u32| {
        let speck = (column * 7919 + row * 104_729).wrapping_mul(2_654_435_761) >> 27;
        let wave = 100.0 + 80.0 * (f64::from(column) / 17.0).sin() * (f64::from(row) / 11.0).cos();
        [
            wave as u8,
            (wave as u8).wrapping_add(speck as u8),
            (row / 4) as u8,
            255,
        ]
    };
    let [columns, rows] = size;
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| texel(column, row)));
    TexturePicture {
        size,
        texels: all.collect(),
    }
}

fn png_of(picture: &TexturePicture) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, picture.size[0], picture.size[1]);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(picture.bytes()).unwrap();
    drop(writer);
    file
}

fn lies(image: usize) -> MaterialTexture {
    MaterialTexture {
        image,
        wrap: [Wrap::Repeat, Wrap::Clamp],
        picture_from_uv: DAffine2::IDENTITY,
        cutoff: None,
    }
}

fn textured(image: usize) -> Material {
    Material {
        texture: Some(lies(image)),
        ..Material::default()
    }
}

/// A sphere of these triangles round and along, with a picture of a size.
pub(crate) fn sphere_with(sides: [u32; 2], size: [u32; 2]) -> SourceScene {
    SourceScene {
        materials: vec![textured(0)],
        images: vec![SourceImage {
            name: "round".to_owned(),
            bytes: png_of(&picture(size)).into(),
        }],
        ..alone("sphere", textured_sphere(sides[0], sides[1]))
    }
}

fn exact(source: &SourceScene) -> Built {
    let options = BuildOptions {
        exact: true,
        ..BuildOptions::default()
    };
    build(source, &options, &|_, _| ()).unwrap()
}

fn pages(built: &Built) -> BTreeMap<(u16, PagePlace), ImagePage> {
    let images = built
        .units
        .iter()
        .filter(|it| it.row.kind == UnitKind::Image);
    let parsed = images.map(|it| ImagePage::parse(&it.payload, &built.textures).unwrap());
    parsed.map(|it| ((it.texture, it.page), it)).collect()
}

/// A level of a texture as its pages have it.
fn level_of(built: &Built, level: u8) -> TexturePicture {
    let shape = TextureShape {
        size: built.textures[0].size,
    };
    let size = shape.level_size(level);
    let mut whole = TexturePicture {
        size,
        texels: vec![[0; 4]; (size[0] * size[1]) as usize],
    };
    for ((_, page), it) in pages(built) {
        for row in 1..it.picture.size[1] - 1 {
            for column in 1..it.picture.size[0] - 1 {
                let first = page.place.map(|it| u32::from(it) * PAGE_SIDE);
                let at = (first[1] + row - 1) * size[0] + first[0] + column - 1;
                if page.level == level {
                    whole.texels[at as usize] = it.picture.at([column, row]);
                }
            }
        }
    }
    whole
}

#[test]
fn exact_pages_are_the_source_and_their_levels_its_halves() {
    let size = [700, 300];
    let built = exact(&sphere_with([32, 16], size));
    let mut expected = picture(size);
    let shape = TextureShape { size };
    for level in 0..=shape.root() {
        assert!(level_of(&built, level) == expected, "level {level}");
        expected = Halving::default().halved(&expected);
    }
    assert_eq!(built.textures[0].size, size);
    assert_eq!(
        built.levels - 1,
        built.units.iter().map(|it| it.level).max().unwrap()
    );
}

#[test]
fn pages_as_jpeg_keep_the_light_of_every_level() {
    let built = built(&sphere_with([32, 16], [600, 520]));
    let halving = Halving::default();
    let light = |level: &TexturePicture| {
        let light = level
            .texels
            .iter()
            .map(|it| f64::from(halving.light(it[1])));
        light.sum::<f64>() / level.texels.len() as f64
    };
    let source = light(&picture([600, 520]));
    for level in 0..=2 {
        let off = light(&level_of(&built, level)) / source - 1.0;
        assert!(off.abs() < 0.01, "level {level}: {off}");
    }
    let told = f64::from(built.textures[0].colour[1]);
    assert!((told / source - 1.0).abs() < 0.05, "{told} {source}");
}

#[test]
fn a_sphere_with_a_seam_and_a_texture_stays_closed() {
    let built = built(&sphere_with([64, 32], [512, 256]));
    let rows: Vec<_> = built
        .units
        .iter()
        .map(|it| (it.level, it.row.clone()))
        .collect();
    let mut payload = |unit: UnitId| -> Result<MeshUnit, PackError> {
        Ok(super::parsed(&built, unit.0 as usize))
    };
    let trial = CutTrial {
        cuts: 20,
        orders: 20,
        seed: 3,
        ignore_prerequisites: false,
    };
    let report = check_cuts(&rows, &mut payload, &trial).unwrap();
    assert_eq!((report.source_odd_edges, report.odd_edges_max), (0, 0));
    assert!(report.levels_in_cut_min >= 3, "{report:?}");
}

#[test]
fn two_textures_on_one_closed_mesh_keep_it_closed_and_each_triangle_its_own() {
    let mut source = sphere_with([48, 24], [64, 64]);
    let mut other = sphere_with([4, 2], [32, 32]).images;
    source.images.append(&mut other);
    source.materials.extend([textured(1), Material::default()]);
    let count = source.meshes[0].triangles.len();
    source.meshes[0].materials = (0..count).map(|it| (3 * it / count) as u32).collect();
    let built = built(&source);
    assert_eq!(built.textures.len(), 2);
    assert_eq!(
        built.objects[0].texturing.as_ref().unwrap().textures,
        [0, 1]
    );
    let rows: Vec<_> = built
        .units
        .iter()
        .map(|it| (it.level, it.row.clone()))
        .collect();
    let mut payload = |unit: UnitId| -> Result<MeshUnit, PackError> {
        Ok(super::parsed(&built, unit.0 as usize))
    };
    let trial = CutTrial {
        cuts: 10,
        orders: 10,
        seed: 4,
        ignore_prerequisites: false,
    };
    let report = check_cuts(&rows, &mut payload, &trial).unwrap();
    assert_eq!((report.source_odd_edges, report.odd_edges_max), (0, 0));
    let cut = super::full_cut(&built);
    let mut seen = BTreeMap::new();
    for triangle in cut
        .drawn()
        .flat_map(|(_, unit, number)| unit.triangles(number))
    {
        let of = triangle.map(|it| it.texture);
        assert!(of[0] == of[1] && of[1] == of[2], "{of:?}");
        *seen.entry(of[0]).or_insert(0) += 1;
    }
    assert_eq!(seen.keys().copied().collect::<Vec<_>>(), [0, 1, NO_TEXTURE]);
}

#[test]
fn pages_tell_the_side_of_a_texel_and_where_they_are_seen() {
    // A square of 2 m with a picture of 512 texels: 3.9 mm each.
    let mut mesh = textured_sphere(4, 2);
    mesh.positions = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]
        .map(|[x, y]| DVec3::new(x, y, 0.0))
        .to_vec();
    mesh.uvs = vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    mesh.normals = Vec::new();
    mesh.triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mut source = sphere_with([4, 2], [512, 512]);
    source.meshes = vec![mesh];
    let built = built(&source);
    let images = built
        .units
        .iter()
        .filter(|it| it.row.kind == UnitKind::Image);
    let images: Vec<_> = images.collect();
    assert_eq!(images.len(), 5);
    assert!(images[0].row.error.is_infinite() && images[0].row.needs.is_empty());
    for page in &images[1..] {
        let texel = 2.0 / 512.0;
        assert!(
            (page.row.error / (2.0 * texel) - 1.0).abs() < 1e-3,
            "{:?}",
            page.row
        );
        assert_eq!((page.row.object, page.row.samples), (0, 256 * 256));
        // A quarter of the square.
        let radius = 0.5 * 2_f32.sqrt();
        assert!(
            (radius..1.02 * radius).contains(&page.row.radius),
            "{:?}",
            page.row
        );
        assert!(page.row.signature.bands[0].difference > 0.0);
    }
}

#[test]
fn a_texture_of_two_objects_is_sent_once_and_placed_in_the_world() {
    let mut source = sphere_with([16, 8], [300, 300]);
    let mut other = source.objects[0].clone();
    other.placements = vec![DAffine3::from_translation(DVec3::X * 10.0)];
    source.objects.push(other);
    source.meshes.push(source.meshes[0].clone());
    source.objects[1].mesh = 1;
    let built = built(&source);
    assert_eq!((built.textures.len(), pages(&built).len()), (1, 5));
    for page in built
        .units
        .iter()
        .filter(|it| it.row.kind == UnitKind::Image)
    {
        assert_eq!(page.row.object, OF_ALL);
        assert!(
            page.row.radius > 5.0 && page.row.centre[0] > 4.0,
            "{:?}",
            page.row
        );
    }
}

#[test]
fn a_missing_or_broken_picture_leaves_the_colour() {
    let mut missing = sphere_with([16, 8], [300, 300]);
    missing.images[0].bytes = b"no picture".as_slice().into();
    let missing = built(&missing);
    assert_eq!(missing.repairs["missing_images"], 1);
    assert!(missing.textures.is_empty() && !missing.objects[0].attributes.textured);
    let mut broken = sphere_with([16, 8], [300, 300]);
    let bytes = &broken.images[0].bytes;
    broken.images[0].bytes = bytes[..bytes.len() / 2].into();
    let broken = built(&broken);
    assert_eq!(broken.repairs["missing_images"], 1);
    assert_eq!(broken.textures[0].colour, [1.0; 3]);
    assert!(pages(&broken)[&(0, PagePlace::default())].picture.texels[0][0] > 250);
}

#[test]
fn only_pages_that_a_surface_shows_are_sent() {
    let mut source = sphere_with([16, 8], [1024, 1024]);
    source.meshes[0]
        .uvs
        .iter_mut()
        .for_each(|uv| *uv = uv.map(|it| 0.3 + 0.1 * it));
    let pages = pages(&built(&source));
    let finest: Vec<_> = pages.keys().filter(|(_, it)| it.level == 0).collect();
    assert_eq!(finest.len(), 1, "{finest:?}");
    assert_eq!(pages.len(), 3);
}

#[test]
fn a_texture_that_repeats_is_sent_once() {
    let mut source = sphere_with([64, 32], [512, 300]);
    let lies = source.materials[0].texture.as_mut().unwrap();
    lies.wrap = [Wrap::Repeat, Wrap::Mirror];
    lies.picture_from_uv = DAffine2::from_scale(glam::DVec2::new(5.0, -3.0));
    assert_eq!(pages(&built(&source)).len(), 5);
}

#[test]
fn the_number_of_threads_changes_no_byte_of_textures() {
    let source = sphere_with([24, 12], [800, 300]);
    let with = |jobs| {
        let options = BuildOptions {
            jobs,
            ..Default::default()
        };
        build(&source, &options, &|_, _| ()).unwrap()
    };
    assert!(with(1) == with(3));
}
