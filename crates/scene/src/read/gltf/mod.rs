//! How is a glTF file read?

mod accessor;
mod buffers;
mod container;
mod draco;
mod fitted;
mod json;
mod mended;
mod mesh;
mod meshopt;
mod nodes;
mod sharing;
mod textures;

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;

use foveal_core::units::counted;

use super::error::Fault;
use super::image::transparent;
use super::mends::{Mends, VIEW_CUT, VIEW_EMPTY};
use super::polygon::Filler;
use super::search::Folder;
use super::sound::count;
use super::text::shortened;
use crate::source::{Material, Repairs, SourceObject, SourceScene};
use accessor::Accessors;
use buffers::Buffers;
use container::{Parsed, ToldOfFile};
use json::{Document, GltfMaterial, View};
use mesh::{MeshPoints, MeshReader};
use textures::{TextureReader, uv_set};

/// Reads a `.gltf` or `.glb` file; objects without a name are called `name` and a number.
pub(super) fn read(
    bytes: &[u8],
    name: &str,
    folder: &mut dyn Folder,
) -> Result<SourceScene, Fault> {
    let Opened {
        document,
        buffers,
        mut mends,
        told,
    } = opened(bytes, folder)?;
    let accessors = Accessors {
        document: &document,
        buffers,
        notes: RefCell::default(),
    };
    let mut scene = SourceScene::default();
    told.tell(accessors.buffers.short, &mut scene);
    let mut materials = materials(&accessors, name, folder, &mut scene);
    let mut meshes = mesh_reader(&accessors, &materials);
    let mut object_of: HashMap<u32, usize> = HashMap::new();
    let mut clouds_of: HashMap<u32, Range<usize>> = HashMap::new();
    for shown in nodes::shown(&accessors, &mut mends)? {
        if let Some(object) = object_of.get(&shown.mesh) {
            let object: &mut SourceObject = &mut scene.objects[*object];
            if object.placements.len() == 1 {
                object.name = object_name(&document, shown.mesh, None, name);
            }
            object.placements.push(shown.world_from_mesh);
            let clouds = clouds_of.get(&shown.mesh).cloned().unwrap_or_default();
            for cloud in &mut scene.clouds[clouds] {
                (cloud.name).clone_from(&object.name);
                cloud.placements.push(shown.world_from_mesh);
            }
            continue;
        }
        scene.meshes.push(meshes.read(shown.mesh)?);
        object_of.insert(shown.mesh, scene.objects.len());
        let of_node = shown.node.and_then(|it| document.nodes[it].name.as_deref());
        let name = object_name(&document, shown.mesh, of_node, name);
        let first = scene.clouds.len();
        let clouds = meshes.points.clouds(&name, &mut scene);
        scene.clouds.extend(clouds);
        clouds_of.insert(shown.mesh, first..scene.clouds.len());
        for cloud in &mut scene.clouds[first..] {
            cloud.placements = vec![shown.world_from_mesh];
        }
        scene.objects.push(SourceObject {
            name,
            mesh: scene.meshes.len() - 1,
            placements: vec![shown.world_from_mesh],
        });
    }
    let mut used = scene.meshes.iter().flat_map(|mesh| &mesh.materials);
    let is_used = used.any(|it| *it == meshes.without_material);
    materials.extend(is_used.then(Material::default));
    let fault = meshes.fault();
    scene.repairs.extend(meshes.repairs);
    meshes.remarks.into_iter().for_each(|it| scene.remark(it));
    let is_empty = scene.meshes.iter().all(|it| it.triangles.is_empty());
    if let (true, true, Some(fault)) = (is_empty, scene.clouds.is_empty(), fault) {
        return Err(fault);
    }
    mends.tell(name, &mut scene);
    meshes.mends.tell(name, &mut scene);
    accessors.notes.into_inner().mends.tell(name, &mut scene);
    scene.materials = materials;
    add_remarks(&mut scene, &document, object_of.keys());
    Ok(scene)
}

/// What reads meshes whose parts have these materials, and has read none.
fn mesh_reader<'a>(accessors: &'a Accessors<'a>, materials: &[Material]) -> MeshReader<'a> {
    let document = accessors.document;
    MeshReader {
        accessors,
        opaque: opaque(document),
        uv_sets: document.materials.iter().map(uv_set).collect(),
        without_material: materials.len() as u32,
        repairs: Repairs::new(),
        remarks: Vec::new(),
        mends: Mends::default(),
        filler: Filler::default(),
        factors: materials.iter().map(|it| it.colour).collect(),
        points: MeshPoints::default(),
        spent: 0,
        is_spent: false,
        first_fault: None,
    }
}

/// A document and its buffers, unpacked.
struct Opened<'a> {
    document: Document,
    buffers: Buffers<'a>,
    mends: Mends,
    told: ToldOfFile,
}

fn opened<'a>(bytes: &'a [u8], folder: &mut dyn Folder) -> Result<Opened<'a>, Fault> {
    let Parsed {
        mut document,
        binary,
        told,
    } = container::parse(bytes)?;
    sharing::share_meshes(&mut document);
    let mut buffers = Buffers::read(&document, binary, folder);
    let mut mends = Mends::default();
    let cut = |(view, number): (&View, u32)| buffers.is_cut(view).then_some(number);
    let cut: Vec<u32> = document
        .buffer_views
        .iter()
        .zip(0..)
        .filter_map(cut)
        .collect();
    let place = || format!("is buffer view {}", cut.first().unwrap_or(&0));
    mends.add(VIEW_CUT, cut.len(), place);
    let is_empty = |(view, _): &(&View, u32)| view.byte_length == 0;
    let mut empty = document.buffer_views.iter().zip(0..).filter(is_empty);
    let first = empty.next().map(|(_, number)| number);
    let times = usize::from(first.is_some()) + empty.count();
    mends.add(VIEW_EMPTY, times, || {
        format!("is buffer view {}", first.unwrap_or(0))
    });
    meshopt::unpack(&mut document, &mut buffers, &mut mends);
    draco::unpack(&mut document, &mut buffers);
    Ok(Opened {
        document,
        buffers,
        mends,
        told,
    })
}

impl ToldOfFile {
    /// Reports how much of the JSON was mended, whether the file is as long as it says, and how
    /// many buffers were shorter than said.
    fn tell(&self, short: usize, scene: &mut SourceScene) {
        count(&mut scene.repairs, "json_mended", self.mended);
        if self.mended > 0 {
            let places = counted(self.mended as u64, "place");
            scene.remark(format!(
                "the JSON of the file breaks its rules in {places}, which were mended"
            ));
        }
        if let Some(length) = &self.length {
            count(&mut scene.repairs, "lengths_mended", 1);
            scene.remark(length.as_str());
        }
        count(&mut scene.repairs, "short_buffers", short);
        if short > 0 {
            scene.remark("buffers have fewer bytes than the file says: what is there is shown");
        }
    }
}

/// Whether each material is opaque, and what has none.
fn opaque(document: &Document) -> Vec<bool> {
    let materials = document.materials.iter();
    materials.map(is_opaque).chain([true]).collect()
}

/// The name of the only node that shows a mesh, else of the mesh, else one of the file's name.
fn object_name(document: &Document, mesh: u32, of_node: Option<&str>, file: &str) -> String {
    let of_mesh = document.meshes.get(mesh as usize);
    let of_mesh = of_mesh.and_then(|mesh| mesh.name.as_deref());
    let said = of_node.or(of_mesh).filter(|name| !name.is_empty());
    said.map_or_else(|| format!("{file} {mesh}"), str::to_owned)
}

fn is_opaque(said: &GltfMaterial) -> bool {
    said.alpha_mode
        .as_deref()
        .is_none_or(|mode| mode == "OPAQUE")
}

fn materials(
    accessors: &Accessors<'_>,
    name: &str,
    folder: &mut dyn Folder,
    scene: &mut SourceScene,
) -> Vec<Material> {
    let mut textures = TextureReader {
        accessors,
        folder,
        images: HashMap::new(),
        mends: Mends::default(),
    };
    let all = accessors.document.materials.iter();
    let read = all.map(|said| Material {
        texture: textures.read(said, scene),
        ..material(said)
    });
    let read = read.collect();
    tell_of_brightness(accessors.document, scene);
    let lights = accessors.document.materials.iter();
    let lights = lights.filter(|it| it.is_light()).count();
    count(&mut scene.repairs, "lights_shown_as_colours", lights);
    if lights > 0 {
        scene.remark(
            "materials that are black but for the light that they give off are shown in the \
             colour of that light",
        );
    }
    textures.mends.tell(name, scene);
    read
}

/// Reports factors that are brighter than white.
fn tell_of_brightness(document: &Document, scene: &mut SourceScene) {
    let all = document.materials.iter().zip(0..);
    let told = all.filter_map(|(it, number): (_, u32)| {
        let name = it.name.as_deref().unwrap_or("");
        let what = format!("the colour of material {number}, {:?},", shortened(name));
        it.taken().told(&what)
    });
    for (number, (repair, remark)) in told.enumerate() {
        count(&mut scene.repairs, repair, 1);
        if number < MOST_NAMED {
            scene.remark(remark);
        }
    }
}

fn material(said: &GltfMaterial) -> Material {
    let mut colour = said.factor().map(|part| part.clamp(0.0, 1.0) as f32);
    if is_opaque(said) {
        colour[3] = 1.0;
    } else if said.is_hidden() {
        colour[3] = 0.0;
    }
    Material {
        name: said.name.clone().unwrap_or_default(),
        colour,
        two_sided: said.double_sided,
        unlit: said.extensions.unlit.is_some(),
        texture: None,
    }
}

/// Says what of the file's looks is not drawn.
fn add_remarks<'a>(
    scene: &mut SourceScene,
    document: &Document,
    meshes: impl Iterator<Item = &'a u32>,
) {
    add_remarks_of_materials(scene, document);
    let mut parts = meshes.flat_map(|mesh| &document.meshes[*mesh as usize].primitives);
    if parts.any(|part| !part.targets.is_empty()) {
        scene.remark("shapes that morph are shown at rest");
    }
    let is_skinned = |node: &json::Node| node.mesh.is_some() && node.skin.is_some();
    if document.nodes.iter().any(is_skinned) {
        scene.remark("skins are shown at rest");
    }
    if !document.animations.is_empty() {
        scene.remark("animations are not played");
    }
    let all = document.extensions_used.iter();
    let lost = all.filter(|name| !container::is_known(name));
    let lost: Vec<String> = lost.take(MOST_NAMED).map(|name| shortened(name)).collect();
    if !lost.is_empty() {
        scene.remark(format!(
            "extensions that are not drawn: {}",
            lost.join(", ")
        ));
    }
}

/// Says what of materials is not drawn.
fn add_remarks_of_materials(scene: &mut SourceScene, document: &Document) {
    let times =
        |has: fn(&GltfMaterial) -> bool| document.materials.iter().filter(|it| has(it)).count();
    let metal = |it: &GltfMaterial| it.pbr_metallic_roughness.metal.is_some();
    for (lost, remark) in [
        (
            times(|it| it.normal_texture.is_some()),
            "normal maps are not drawn",
        ),
        (times(metal), "metal and roughness are not drawn"),
        (
            times(|it| it.extensions.glossiness.is_some()),
            "gloss is not drawn",
        ),
        (
            times(|it| it.occlusion_texture.is_some()),
            "shade in occlusion maps is not drawn",
        ),
        (
            times(|it| !it.is_light() && it.emitted().iter().any(|it| *it > 0.0)),
            "light that surfaces give off is not drawn",
        ),
    ] {
        if lost > 0 {
            scene.remark(format!("{remark}: {}", counted(lost as u64, "material")));
        }
    }
    let lost = document.materials.iter().filter(|it| it.is_lost_alpha());
    let names = lost.map(|it| it.name.as_deref().unwrap_or(""));
    transparent::tell(names, scene);
    if let Some(centre) = &document.extensions.centre {
        let [x, y, z] = centre.center;
        scene.remark(format!(
            "places count from {x}, {y}, {z} (CESIUM_RTC): everything is placed there"
        ));
    }
}

/// How many extensions a remark names.
const MOST_NAMED: usize = 8;

#[cfg(test)]
mod tests;
