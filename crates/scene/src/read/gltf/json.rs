//! What does the JSON of a glTF file say that a scene needs?
//!
//! Only this is read, so that a file is never refused for what is not drawn anyway. Source:
//! Khronos, "glTF 2.0 Specification", section 5.

use super::super::colour::Brightness;
use super::super::error::Fault;
use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub(super) asset: Asset,
    pub(super) scene: Option<u32>,
    pub(super) scenes: Vec<SceneRoots>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) skins: Vec<Skin>,
    pub(super) materials: Vec<GltfMaterial>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<View>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) textures: Vec<GltfTexture>,
    pub(super) images: Vec<Image>,
    pub(super) samplers: Vec<Sampler>,
    pub(super) animations: Vec<IgnoredAny>,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
    pub(super) extensions: DocumentExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct DocumentExtensions {
    #[serde(rename = "CESIUM_RTC")]
    pub(super) centre: Option<Centre>,
}

/// The origin of the places of a file.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Centre {
    pub(super) center: [f64; 3],
}

impl Document {
    /// Corrects names that differ from those of glTF in capitals, or in a number, and says how many
    /// there were.
    pub(super) fn adopt_near_names(&mut self) -> usize {
        let mut adopted = 0;
        let parts = self.meshes.iter_mut().flat_map(|it| &mut it.primitives);
        for part in parts {
            adopted += part.attributes.adopt();
            adopted += part.targets.iter_mut().map(|it| it.adopt()).sum::<usize>();
            let draco = part.extensions.draco.as_mut();
            adopted += draco.map_or(0, |it| it.attributes.adopt());
        }
        let shapes = self.accessors.iter_mut().map(|it| &mut it.shape);
        let modes = self.materials.iter_mut();
        let modes = modes.filter_map(|it| it.alpha_mode.as_mut());
        for name in shapes.chain(modes) {
            if name.bytes().any(|it| it.is_ascii_lowercase()) {
                name.make_ascii_uppercase();
                adopted += 1;
            }
        }
        adopted
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    version: Version,
}

/// A version as it should be written, or as a number.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Version {
    Text(String),
    Number(f64),
}

impl Default for Version {
    fn default() -> Self {
        Self::Text(String::new())
    }
}

impl Asset {
    /// The version of glTF; empty where the file does not say it.
    pub(super) fn version(&self) -> String {
        match &self.version {
            Version::Text(text) => text.clone(),
            Version::Number(number) => number.to_string(),
        }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SceneRoots {
    pub(super) nodes: Vec<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) children: Vec<u32>,
    pub(super) mesh: Option<u32>,
    pub(super) skin: Option<u32>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
    pub(super) extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instances: Option<Box<Instances>>,
}

/// Several places for the mesh of a node.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Instances {
    pub(super) attributes: InstanceAttributes,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct InstanceAttributes {
    pub(super) translation: Option<u32>,
    pub(super) rotation: Option<u32>,
    pub(super) scale: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
    pub(super) weights: Vec<f64>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: GltfAttributes,
    pub(super) indices: Option<u32>,
    pub(super) material: Option<u32>,
    pub(super) mode: Option<u32>,
    pub(super) targets: Vec<GltfAttributes>,
    pub(super) extensions: PrimitiveExtensions,
    /// Why it could not be unpacked.
    #[serde(skip)]
    pub(super) broken: Option<Box<Fault>>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(default)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<Box<DracoPart>>,
}

/// A part of a mesh that Draco compressed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct DracoPart {
    pub(super) buffer_view: u32,
    /// By the numbers that they have there.
    pub(super) attributes: GltfAttributes,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct GltfAttributes {
    pub(super) position: Option<u32>,
    pub(super) normal: Option<u32>,
    #[serde(rename = "COLOR_0")]
    pub(super) colour: Option<u32>,
    #[serde(rename = "TEXCOORD_0")]
    uvs_0: Option<u32>,
    #[serde(rename = "TEXCOORD_1")]
    uvs_1: Option<u32>,
    #[serde(rename = "TEXCOORD_2")]
    uvs_2: Option<u32>,
    #[serde(rename = "TEXCOORD_3")]
    uvs_3: Option<u32>,
    #[serde(rename = "position", alias = "Position")]
    near_position: Option<u32>,
    #[serde(rename = "normal", alias = "Normal")]
    near_normal: Option<u32>,
    #[serde(rename = "color_0", alias = "COLOR", alias = "color")]
    near_colour: Option<u32>,
    #[serde(rename = "texcoord_0", alias = "TEXCOORD", alias = "texcoord")]
    near_uvs: Option<u32>,
}

impl GltfAttributes {
    /// All of them, in the same order for each part.
    pub(super) fn all(&mut self) -> [Option<&mut u32>; 7] {
        let Self {
            position,
            normal,
            colour,
            uvs_0,
            uvs_1,
            uvs_2,
            uvs_3,
            ..
        } = self;
        [position, normal, colour, uvs_0, uvs_1, uvs_2, uvs_3].map(Option::as_mut)
    }

    /// Uses what stands under nearly the right names, and says how many there were.
    fn adopt(&mut self) -> usize {
        let all = [
            (&mut self.position, self.near_position.take()),
            (&mut self.normal, self.near_normal.take()),
            (&mut self.colour, self.near_colour.take()),
            (&mut self.uvs_0, self.near_uvs.take()),
        ];
        let mut adopted = 0;
        for (own, near) in all {
            if own.is_none() && near.is_some() {
                (*own, adopted) = (near, adopted + 1);
            }
        }
        adopted
    }

    /// A set of places on textures.
    pub(super) fn uvs(&self, set: u32) -> Option<u32> {
        let sets = [self.uvs_0, self.uvs_1, self.uvs_2, self.uvs_3];
        sets.get(set as usize).copied().flatten()
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct GltfTexture {
    source: Option<u32>,
    pub(super) sampler: Option<u32>,
    extensions: OtherSources,
}

impl GltfTexture {
    /// Its picture: one that all programs read before one in a format of an extension.
    pub(super) fn image(&self) -> Option<u32> {
        let OtherSources {
            webp,
            avif,
            dds,
            basis,
        } = &self.extensions;
        let others = [webp, avif, dds, basis].into_iter().flatten();
        self.source
            .or_else(|| others.filter_map(|it| it.source).next())
    }
}

/// Pictures in formats of extensions.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct OtherSources {
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<OtherSource>,
    #[serde(rename = "EXT_texture_avif")]
    avif: Option<OtherSource>,
    #[serde(rename = "MSFT_texture_dds")]
    dds: Option<OtherSource>,
    #[serde(rename = "KHR_texture_basisu")]
    basis: Option<OtherSource>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct OtherSource {
    source: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) name: Option<String>,
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Sampler {
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) inverse_bind_matrices: Option<u32>,
    pub(super) joints: Vec<u32>,
}

/// Light of what is black.
const DARKEST: f64 = 1e-3;

/// A material, as glTF says it.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct GltfMaterial {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: BaseColour,
    pub(super) alpha_mode: Option<String>,
    pub(super) alpha_cutoff: Option<f64>,
    pub(super) normal_texture: Option<IgnoredAny>,
    pub(super) occlusion_texture: Option<IgnoredAny>,
    pub(super) emissive_texture: Option<TextureNamed>,
    pub(super) emissive_factor: Option<[f64; 3]>,
    pub(super) double_sided: bool,
    pub(super) extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_unlit")]
    pub(super) unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) glossiness: Option<Box<Glossiness>>,
}

/// The colours of a material in the way that came before metal and roughness.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Glossiness {
    #[serde(rename = "diffuseFactor")]
    factor: Option<[f64; 4]>,
    #[serde(rename = "diffuseTexture")]
    texture: Option<TextureNamed>,
}

impl GltfMaterial {
    /// The older way to give colours, where it gives any: it goes before the newer one.
    fn glossiness(&self) -> Option<&Glossiness> {
        let said = self.extensions.glossiness.as_deref();
        said.filter(|it| it.factor.is_some() || it.texture.is_some())
    }

    /// Whether it is black but for the light that it gives off, which is its colour then.
    pub(super) fn is_light(&self) -> bool {
        let is_black = self.own_factor()[..3].iter().all(|it| *it < DARKEST);
        is_black && self.emitted().iter().any(|it| *it > DARKEST)
    }

    /// What light it gives off.
    pub(super) fn emitted(&self) -> [f64; 3] {
        let said = self.emissive_factor.unwrap_or([0.0; 3]);
        said.map(|it| it / Brightness::of(said, 1.0).full())
    }

    /// How the parts of its colour are read.
    pub(super) fn taken(&self) -> Brightness {
        match self.is_light() {
            true => Brightness::of(self.emissive_factor.unwrap_or([0.0; 3]), 1.0),
            false => {
                let [red, green, blue, alpha] = self.said_factor();
                Brightness::of([red, green, blue], alpha)
            }
        }
    }

    /// What its colour is multiplied with.
    pub(super) fn factor(&self) -> [f64; 4] {
        let own = self.own_factor();
        let [red, green, blue] = self.emitted();
        match self.is_light() {
            true => [red, green, blue, own[3]],
            false => own,
        }
    }

    fn own_factor(&self) -> [f64; 4] {
        let [red, green, blue, alpha] = self.said_factor();
        let full = Brightness::of([red, green, blue], alpha).full();
        let alpha = if alpha > 1.0 { alpha / full } else { alpha };
        [red / full, green / full, blue / full, alpha]
    }

    fn said_factor(&self) -> [f64; 4] {
        let factor = match self.glossiness() {
            Some(said) => said.factor,
            None => self.pbr_metallic_roughness.factor,
        };
        factor.unwrap_or([1.0; 4])
    }

    /// Whether it is never seen: it is wholly transparent, or cut out as a whole.
    pub(super) fn is_hidden(&self) -> bool {
        let alpha = self.own_factor()[3];
        match self.alpha_mode.as_deref() {
            Some("BLEND") => alpha <= 0.0,
            // A texture can only take away from it.
            Some("MASK") => alpha < self.alpha_cutoff.unwrap_or(0.5),
            _ => false,
        }
    }

    /// Whether it is drawn opaque but should be half transparent.
    pub(super) fn is_lost_alpha(&self) -> bool {
        self.alpha_mode.as_deref() == Some("BLEND") && !self.is_hidden()
    }

    /// The texture of its colour.
    pub(super) fn texture(&self) -> Option<&TextureNamed> {
        if self.is_light() {
            return self.emissive_texture.as_ref();
        }
        match self.glossiness() {
            Some(said) => said.texture.as_ref(),
            None => self.pbr_metallic_roughness.texture.as_ref(),
        }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct BaseColour {
    #[serde(rename = "baseColorFactor")]
    factor: Option<[f64; 4]>,
    #[serde(rename = "baseColorTexture")]
    texture: Option<TextureNamed>,
    #[serde(rename = "metallicRoughnessTexture")]
    pub(super) metal: Option<IgnoredAny>,
}

/// Which texture a material has, and how it lies.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureNamed {
    pub(super) index: u32,
    #[serde(rename = "texCoord")]
    pub(super) set: u32,
    pub(super) extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<Transform>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Transform {
    pub(super) offset: Option<[f64; 2]>,
    pub(super) rotation: Option<f64>,
    pub(super) scale: Option<[f64; 2]>,
    #[serde(rename = "texCoord")]
    pub(super) set: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<u32>,
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: u32,
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: u32,
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
    pub(super) extensions: ViewExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    of_vendors: Option<Box<MeshoptView>>,
    #[serde(rename = "KHR_meshopt_compression")]
    of_khronos: Option<Box<MeshoptView>>,
}

impl ViewExtensions {
    /// How meshoptimizer compressed the view.
    pub(super) fn meshopt(&self) -> Option<&MeshoptView> {
        self.of_khronos.as_deref().or(self.of_vendors.as_deref())
    }
}

/// A view that meshoptimizer compressed.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct MeshoptView {
    pub(super) buffer: u32,
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: u64,
    pub(super) count: u64,
    pub(super) mode: String,
    pub(super) filter: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: u64,
    extensions: BufferExtensions,
}

impl Buffer {
    /// Whether it only stands in for views that are compressed, which are read in its place.
    pub(super) fn is_fallback(&self) -> bool {
        let said = [&self.extensions.of_vendors, &self.extensions.of_khronos];
        said.into_iter().flatten().any(|it| it.fallback)
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    of_vendors: Option<Fallback>,
    #[serde(rename = "KHR_meshopt_compression")]
    of_khronos: Option<Fallback>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Fallback {
    fallback: bool,
}
