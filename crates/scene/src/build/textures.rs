//! Which textures do the surfaces of a scene have, and where do meshes lie on them?

use crate::read::image;
use crate::source::{Material, MaterialTexture, SourceMesh, SourceScene};
use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::mesh::payload::NO_TEXTURE;
use foveal_core::content::scene::description::{MOST_TEXTURES_OF_OBJECT, Texturing};
use glam::DVec2;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Most textures of a scene: the description counts them in 16 bits.
const MOST_TEXTURES: usize = u16::MAX as usize;
/// Steps of the grid of places on textures; one fewer than numbers, so that rounding fits.
const STEPS: f64 = 65_534.0;

/// A picture as some materials show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShownImage {
    /// Number of the picture.
    pub image: usize,
    /// What lies outside it.
    pub wrap: [Wrap; 2],
    /// Where its alpha is less, nothing is drawn.
    pub cutoff: Option<f32>,
    /// Its columns and rows.
    pub size: [u32; 2],
}

/// The textures of a scene: each picture as often as it is shown in another way.
#[derive(Clone, Debug, Default)]
pub(super) struct ShownImages {
    /// All of them.
    pub all: Vec<ShownImage>,
    /// For each material the number of its texture.
    of_material: Vec<Option<u16>>,
    /// Number of pictures that are missing, invalid or oversized, or too many.
    pub missing: u64,
}

impl ShownImages {
    /// The textures that materials name and whose files give a size.
    pub(super) fn new(source: &SourceScene) -> Self {
        let textures = source.materials.iter().filter_map(|it| it.texture);
        let named: HashSet<usize> = textures.map(|it| it.image).collect();
        let size = |image: usize| image::size_of(&source.images.get(image)?.bytes);
        let sizes: HashMap<usize, _> = named.into_iter().map(|it| (it, size(it))).collect();
        let mut shown = Self {
            missing: sizes.values().filter(|it| it.is_none()).count() as u64,
            ..Self::default()
        };
        let mut numbers = HashMap::new();
        for material in &source.materials {
            let texture = material
                .texture
                .and_then(|it| Some((it, sizes[&it.image]?)));
            let number = texture.and_then(|(it, size)| {
                let key = (it.image, it.wrap, it.cutoff.map(f32::to_bits));
                if shown.all.len() == MOST_TEXTURES && !numbers.contains_key(&key) {
                    shown.missing += 1;
                    return None;
                }
                Some(*numbers.entry(key).or_insert_with(|| {
                    shown.all.push(ShownImage {
                        image: it.image,
                        wrap: it.wrap,
                        cutoff: it.cutoff,
                        size,
                    });
                    (shown.all.len() - 1) as u16
                }))
            });
            shown.of_material.push(number);
        }
        shown
    }

    /// The texture of a material, and how it lies.
    fn of<'a>(
        &self,
        materials: &'a [Material],
        material: u32,
    ) -> Option<(u16, &'a MaterialTexture)> {
        let at = material as usize;
        let number = self.of_material.get(at).copied().flatten()?;
        Some((number, materials.get(at)?.texture.as_ref()?))
    }
}

/// Where the vertices of a mesh lie on its textures.
#[derive(Clone, Debug)]
pub(super) struct MeshTexturing<'a> {
    /// Its textures and the grid of places on them.
    pub texturing: Texturing,
    /// For each material that has one its place among these, and how it lies.
    of_material: BTreeMap<u32, (u8, &'a MaterialTexture)>,
}

impl<'a> MeshTexturing<'a> {
    /// `None` where no triangle has a texture; textures beyond those that a vertex can name are
    /// left out.
    pub(super) fn of(
        source: &'a SourceScene,
        mesh: &SourceMesh,
        shown: &ShownImages,
    ) -> Option<Self> {
        if mesh.uvs.is_empty() || shown.all.is_empty() {
            return None;
        }
        let (mut of_material, mut textures) = (BTreeMap::new(), Vec::new());
        let mut met = HashSet::new();
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (number, corners) in mesh.triangles.iter().enumerate() {
            let material = mesh.materials.get(number).copied().unwrap_or(0);
            if met.insert(material)
                && let Some((number, lies)) = shown.of(&source.materials, material)
            {
                let there = textures.iter().position(|it| *it == number);
                let slot = there.unwrap_or(textures.len());
                if slot < MOST_TEXTURES_OF_OBJECT {
                    if there.is_none() {
                        textures.push(number);
                    }
                    of_material.insert(material, (slot as u8, lies));
                }
            }
            if let Some((_, lies)) = of_material.get(&material) {
                for corner in corners {
                    let at = on_picture(lies, mesh.uvs[*corner as usize]);
                    (low, high) = (low.min(at), high.max(at));
                }
            }
        }
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        (!textures.is_empty()).then(|| Self {
            texturing: Texturing {
                textures,
                origin: low.to_array(),
                step: (extent / STEPS).to_array(),
            },
            of_material,
        })
    }

    /// The place on the grid of a vertex of a triangle of a material, and which texture it has.
    pub(super) fn place(&self, material: u32, uv: [f32; 2]) -> ([u16; 2], u8) {
        let Some((slot, lies)) = self.of_material.get(&material) else {
            return ([0; 2], NO_TEXTURE);
        };
        let Texturing { origin, step, .. } = &self.texturing;
        let at = on_picture(lies, uv) - DVec2::from_array(*origin);
        let place = (at / DVec2::from_array(*step)).round();
        (place.to_array().map(|it| it as u16), *slot)
    }
}

/// A vertex' place on a picture; what no place can be is at its corner.
fn on_picture(lies: &MaterialTexture, uv: [f32; 2]) -> DVec2 {
    const FARTHEST: f64 = 1e6;
    let at = lies
        .picture_from_uv
        .transform_point2(DVec2::from_array(uv.map(f64::from)));
    match at.is_finite() {
        true => at.clamp(DVec2::splat(-FARTHEST), DVec2::splat(FARTHEST)),
        false => DVec2::ZERO,
    }
}
