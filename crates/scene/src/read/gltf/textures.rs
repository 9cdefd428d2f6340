//! Which pictures do the materials of a glTF file have, and how do they lie?

use std::collections::HashMap;

use foveal_core::content::images::wrap::Wrap;
use glam::{DAffine2, DMat2, DVec2};

use super::super::error::Fault;
use super::super::mends::{Mends, SAMPLER_NOT_FOUND};
use super::super::search::Folder;
use super::accessor::Accessors;
use super::buffers::{bytes_of, is_inline};
use super::json::{GltfMaterial, GltfTexture, Image, TextureNamed};
use crate::source::{MaterialTexture, SourceImage, SourceScene};

/// What is discarded below where a material does not say.
const CUTOFF: f64 = 0.5;
/// The largest alpha that a cutoff may ask for: more than any.
const MOST_CUTOFF: f64 = 2.0;

/// Reads the pictures that materials name, each once.
pub(super) struct TextureReader<'a> {
    pub(super) accessors: &'a Accessors<'a>,
    pub(super) folder: &'a mut dyn Folder,
    /// Where each of the file's images went; `None` for one that is missing.
    pub(super) images: HashMap<u32, Option<usize>>,
    pub(super) mends: Mends,
}

impl TextureReader<'_> {
    /// How a material shows a picture; `None` where it has none, or that is missing.
    pub(super) fn read(
        &mut self,
        material: &GltfMaterial,
        scene: &mut SourceScene,
    ) -> Option<MaterialTexture> {
        let named = material.texture()?;
        let document = self.accessors.document;
        let texture = document.textures.get(named.index as usize);
        let image = self.image(named.index, texture.and_then(GltfTexture::image), scene)?;
        let sampler = texture.and_then(|it| it.sampler);
        let is_lost = sampler.is_some_and(|it| it as usize >= document.samplers.len());
        let place = || format!("is sampler {}", sampler.unwrap_or(0));
        self.mends
            .add(SAMPLER_NOT_FOUND, usize::from(is_lost), place);
        let sampler = sampler.and_then(|it| document.samplers.get(it as usize));
        let wraps = sampler.map_or([None; 2], |it| [it.wrap_s, it.wrap_t]);
        let alpha = material.factor()[3];
        let is_masked = material.alpha_mode.as_deref() == Some("MASK");
        let cutoff = is_masked.then(|| {
            let cutoff = material.alpha_cutoff.unwrap_or(CUTOFF) / alpha;
            if cutoff.is_finite() {
                cutoff.clamp(0.0, MOST_CUTOFF) as f32
            } else {
                MOST_CUTOFF as f32
            }
        });
        Some(MaterialTexture {
            image,
            wrap: wraps.map(wrap),
            picture_from_uv: picture_from_uv(named),
            cutoff,
        })
    }

    fn image(
        &mut self,
        texture: u32,
        number: Option<u32>,
        scene: &mut SourceScene,
    ) -> Option<usize> {
        if let Some(known) = number.and_then(|it| self.images.get(&it)) {
            return *known;
        }
        let images = &self.accessors.document.images;
        let said = number.and_then(|it| images.get(it as usize));
        let read = match said {
            Some(said) => self.bytes(said),
            None if number.is_some() => Err(format!("there are only {} images", images.len())),
            None => Err("the file does not say which it is".to_owned()),
        };
        let names = said.map(|it| [&it.name, &it.uri]).into_iter().flatten();
        let mut names = names.flatten().filter(|it| !is_inline(it));
        let name = names.next().cloned().unwrap_or_else(|| match number {
            Some(number) => format!("image {number}"),
            None => format!("texture {texture}"),
        });
        let image = match read {
            Ok(bytes) => {
                let bytes = bytes.into();
                scene.images.push(SourceImage { name, bytes });
                Some(scene.images.len() - 1)
            }
            Err(reason) => {
                scene.missing_picture(&name, &reason);
                None
            }
        };
        if let Some(number) = number {
            self.images.insert(number, image);
        }
        image
    }

    /// The bytes of an image, or why there are none.
    fn bytes(&mut self, said: &Image) -> Result<Vec<u8>, String> {
        let read = match (&said.uri, said.buffer_view) {
            (Some(uri), _) => bytes_of(uri, "image", self.folder).map(|it| it.to_vec()),
            (None, Some(view)) => {
                let document = self.accessors.document;
                self.accessors
                    .buffers
                    .view(document, view)
                    .map(<[u8]>::to_vec)
            }
            (None, None) => return Err("it has no uri and no bytes".to_owned()),
        };
        read.map_err(Fault::what)
    }
}

/// Which set of places on textures a material takes.
pub(super) fn uv_set(material: &GltfMaterial) -> Option<u32> {
    let named = material.texture()?;
    let transform = named.extensions.transform.as_ref();
    Some(transform.and_then(|it| it.set).unwrap_or(named.set))
}

fn wrap(code: Option<u32>) -> Wrap {
    match code {
        Some(33_071) => Wrap::Clamp,
        Some(33_648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// What KHR_texture_transform says: offset after rotation after scale.
fn picture_from_uv(named: &TextureNamed) -> DAffine2 {
    let Some(transform) = &named.extensions.transform else {
        return DAffine2::IDENTITY;
    };
    let (sin, cos) = transform.rotation.unwrap_or(0.0).sin_cos();
    let scale = transform.scale.unwrap_or([1.0; 2]);
    let turned = [DVec2::new(cos, -sin), DVec2::new(sin, cos)];
    let linear = DMat2::from_cols(turned[0] * scale[0], turned[1] * scale[1]);
    DAffine2::from_mat2_translation(linear, transform.offset.unwrap_or([0.0; 2]).into())
}
