//! Which pictures of a scene are shown, and which are larger than their files can mean?

use std::collections::{HashMap, HashSet};

use super::super::sound::count;
use super::super::text::shortened;
use super::{damage, is_animated, measured};
use crate::source::{MaterialTexture, SourceScene};

/// Texels of all pictures together, each as often as it is shown in another way, whatever their
/// files are: those of one picture of 8192 x 8192.
const MOST_TEXELS: u64 = 1 << 26;
/// And more for each byte of all files. A JPEG holds 4 to 16 in a byte, a PNG of a photograph one.
const MOST_TEXELS_A_BYTE: u64 = 64;
/// Most pictures that are named of those that are left out.
const MOST_NAMED: usize = 8;

/// Leaves out pictures that are invalid or too large, and says which.
pub(in crate::read) fn leave_out_pictures(scene: &mut SourceScene) {
    let mut left = MOST_TEXELS.saturating_add(MOST_TEXELS_A_BYTE.saturating_mul(scene.bytes));
    let mut sizes = HashMap::new();
    let mut shown = HashMap::new();
    let mut out: Vec<(usize, String)> = Vec::new();
    let mut moving = Vec::new();
    for texture in scene.materials.iter().filter_map(|it| it.texture) {
        let size = sizes.entry(texture.image).or_insert_with(|| {
            let bytes = scene.images.get(texture.image).map(|it| &it.bytes);
            let size = measured(bytes.map_or(&[][..], |it| &it[..]));
            size.map_err(|fault| out.push((texture.image, fault.to_string())))
        });
        let Ok([columns, rows]) = *size else {
            continue;
        };
        shown.entry(way_of(&texture)).or_insert_with(|| {
            let texels = u64::from(columns) * u64::from(rows);
            let fits = texels <= left;
            match fits {
                true => left -= texels,
                false => out.push((
                    texture.image,
                    format!(
                        "has {columns} x {rows} texels, which with those before it are too many \
                         for the bytes of all files: make it smaller"
                    ),
                )),
            }
            fits
        });
    }
    for material in &mut scene.materials {
        let is_shown = |it: &MaterialTexture| shown.get(&way_of(it)).copied().unwrap_or(false);
        material.texture = material.texture.filter(is_shown);
    }
    count(&mut scene.repairs, "missing_images", out.len());
    let shown: HashSet<usize> = scene
        .materials
        .iter()
        .filter_map(|it| it.texture)
        .map(|it| it.image)
        .collect();
    for (number, image) in scene.images.iter().enumerate() {
        if shown.contains(&number) && is_animated(&image.bytes) {
            moving.push(shortened(&image.name));
        }
    }
    tell_damage(scene, &shown);
    count(&mut scene.repairs, "animated_images", moving.len());
    for name in moving.iter().take(MOST_NAMED) {
        scene.remark(format!(
            "the picture \"{name}\" moves: the first of its pictures is shown"
        ));
    }
    for (image, what) in out.iter().take(MOST_NAMED) {
        let name = scene.images.get(*image).map_or("", |it| it.name.as_str());
        let name = shortened(name);
        scene.remark(format!(
            "picture {image}, \"{name}\", {what}; it is left out, and surfaces have their colour \
             alone"
        ));
    }
}

/// Counts pictures that are shown although they are damaged, and says which.
fn tell_damage(scene: &mut SourceScene, shown: &HashSet<usize>) {
    let images = scene.images.iter().enumerate();
    let shown = images.filter(|(number, _)| shown.contains(number));
    let damaged = shown.filter_map(|(_, image)| Some((image, damage(&image.bytes)?)));
    let damaged: Vec<_> = damaged
        .map(|(image, what)| (shortened(&image.name), what))
        .collect();
    count(&mut scene.repairs, "damaged_images", damaged.len());
    for (name, what) in damaged.iter().take(MOST_NAMED) {
        scene.remark(format!("the picture \"{name}\" {what}"));
    }
}

/// A picture and the way in which it is shown: pages of another way are other pages.
type Way = (
    usize,
    [foveal_core::content::images::wrap::Wrap; 2],
    Option<u32>,
);

fn way_of(texture: &MaterialTexture) -> Way {
    (
        texture.image,
        texture.wrap,
        texture.cutoff.map(f32::to_bits),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Material, SourceImage};
    use foveal_core::content::images::wrap::Wrap;
    use glam::DAffine2;

    fn white([columns, rows]: [u32; 2]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, columns, rows);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::One);
        let mut writer = encoder.write_header().unwrap();
        let row = columns.div_ceil(8) as usize;
        writer
            .write_image_data(&vec![255; row * rows as usize])
            .unwrap();
        drop(writer);
        file
    }

    /// A scene of a picture that is shown in so many ways.
    fn scene(size: [u32; 2], ways: usize) -> SourceScene {
        let bytes = white(size);
        let lies = |way: usize| MaterialTexture {
            image: 0,
            wrap: [Wrap::Repeat; 2],
            picture_from_uv: DAffine2::IDENTITY,
            cutoff: Some(way as f32 / 100.0),
        };
        let material = |way| Material {
            texture: Some(lies(way)),
            ..Material::default()
        };
        SourceScene {
            bytes: bytes.len() as u64,
            materials: (0..ways).map(material).collect(),
            images: vec![SourceImage {
                name: "white.png".to_owned(),
                bytes: bytes.into(),
            }],
            ..SourceScene::default()
        }
    }

    #[test]
    fn a_picture_is_shown_in_as_many_ways_as_its_bytes_can_mean() {
        let mut small = scene([64, 64], 50);
        leave_out_pictures(&mut small);
        assert!(small.materials.iter().all(|it| it.texture.is_some()));
        let mut many = scene([4096, 4096], 50);
        leave_out_pictures(&mut many);
        let shown = many.materials.iter().filter(|it| it.texture.is_some());
        // Its file has some three kilobytes.
        assert_eq!(shown.count(), 4);
        assert_eq!(many.repairs["missing_images"], 46);
        assert_eq!(many.remarks.len(), 1, "{:?}", many.remarks);
    }

    #[test]
    fn a_picture_that_is_too_wide_is_named() {
        let mut wide = scene([100_000, 1], 2);
        leave_out_pictures(&mut wide);
        assert!(wide.materials.iter().all(|it| it.texture.is_none()));
        let [remark] = &wide.remarks[..] else {
            panic!("{:?}", wide.remarks);
        };
        assert!(
            remark.contains("\"white.png\", has 100000 x 1 texels"),
            "{remark}"
        );
        assert_eq!(wide.repairs["missing_images"], 1);
    }
}
