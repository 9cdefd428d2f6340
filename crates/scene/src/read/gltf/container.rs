//! Where in a glTF file are its JSON and its binary part, and can the file be read at all?

use super::super::error::Fault;
use super::super::text::shortened;
use super::fitted::fitted;
use super::json::Document;
use super::mended::mended;

const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BINARY_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");
/// Magic, version and length.
const HEADER_BYTES: usize = 12;

/// Objects that say what files of people do have more bytes on average. Those that say next to
/// nothing take up to a hundred times their bytes of memory.
const LEAST_OBJECT_BYTES: usize = 16;
/// So few take little memory whatever they say.
const MOST_BARE: usize = 100_000;

/// What surfaces need of these is drawn.
const DRAWN: [&str; 11] = [
    "CESIUM_RTC",
    "KHR_mesh_quantization",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
    "KHR_materials_unlit",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_texture_transform",
    "EXT_texture_webp",
    "KHR_materials_variants",
];
/// These say nothing about surfaces, or of light only what is not drawn of any material. Without
/// pictures that are not read, a material has its colour; motion is not drawn.
const HARMLESS: [&str; 27] = [
    "FB_ngon_encoding",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_lights_punctual",
    "KHR_texture_basisu",
    "KHR_animation_pointer",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "KHR_node_selectability",
    "KHR_node_hoverability",
    "KHR_interactivity",
    "EXT_structural_metadata",
    "EXT_mesh_features",
    "EXT_instance_features",
    "FB_geometry_metadata",
    "GODOT_single_root",
    "MSFT_lod",
    "CESIUM_primitive_outline",
    "VRM",
];
/// The same of all extensions whose names begin so.
const HARMLESS_KINDS: [&str; 18] = [
    "KHR_materials_",
    "EXT_materials_",
    "ADOBE_materials_",
    "NV_materials_",
    "KHR_lights_",
    "EXT_lights_",
    "EXT_texture_avif",
    "KHR_audio",
    "KHR_physics",
    "KHR_collision_shapes",
    "KHR_implicit_shapes",
    "MSFT_audio",
    "MSFT_physics",
    "MSFT_packing_",
    "MSFT_texture_dds",
    "AGI_",
    "OMI_",
    "VRMC_",
];

/// Whether nothing is lost that would be drawn if an extension were followed.
pub(super) fn is_known(extension: &str) -> bool {
    DRAWN.contains(&extension) || HARMLESS.contains(&extension)
}

/// Whether shapes and places are what the rest of the file says, whatever an extension adds.
fn is_harmless(extension: &str) -> bool {
    let begins = |kind: &&str| extension.starts_with(*kind);
    is_known(extension) || HARMLESS_KINDS.iter().any(begins)
}

/// What stands in a file.
pub(super) struct Parsed<'a> {
    pub(super) document: Document,
    /// The binary part of a `.glb`.
    pub(super) binary: Option<&'a [u8]>,
    pub(super) told: ToldOfFile,
}

/// What of a file was mended before anything of it was read.
#[derive(Default)]
pub(super) struct ToldOfFile {
    /// How much of its JSON.
    pub(super) mended: usize,
    /// In what way it is longer or shorter than it says.
    pub(super) length: Option<String>,
}

/// The parts of a `.glb`.
struct Chunks<'a> {
    json: &'a [u8],
    binary: Option<&'a [u8]>,
    length: Option<String>,
}

/// Reads the JSON of a file, and finds the binary part of a `.glb`.
pub(super) fn parse(bytes: &[u8]) -> Result<Parsed<'_>, Fault> {
    let Chunks {
        json,
        binary,
        length,
    } = match bytes.starts_with(MAGIC) {
        true => chunks(bytes)?,
        false => Chunks {
            json: bytes,
            binary: None,
            length: None,
        },
    };
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    // Some fill up the JSON of a .glb with zeros.
    let end = json.iter().rposition(|byte| *byte != 0);
    let json = &json[..end.map_or(0, |end| end + 1)];
    let objects = json.iter().filter(|byte| **byte == b'{').count();
    if objects > MOST_BARE && objects * LEAST_OBJECT_BYTES > json.len() {
        let what = format!("{objects} objects in {} bytes say nothing", json.len());
        return Err(Fault::at("JSON", what));
    }
    let (mut document, mut mended) = document_of(json)?;
    mended += document.adopt_near_names();
    let version = document.asset.version();
    if !(version.starts_with("2.") || version == "2" || version.is_empty()) {
        if version == "1" || version.starts_with("1.") {
            return Err(of_version_1());
        }
        let version = shortened(&version);
        let what = format!("its version of glTF is {version:?}");
        return Err(Fault::unsupported(what, "export it as glTF 2.0"));
    }
    match document
        .extensions_required
        .iter()
        .find(|name| !is_harmless(name))
    {
        Some(name) => Err(needs(name)),
        None => Ok(Parsed {
            document,
            binary,
            told: ToldOfFile { mended, length },
        }),
    }
}

/// The document, and how much of it had to be mended.
fn document_of(json: &[u8]) -> Result<(Document, usize), Fault> {
    let error = match serde_json::from_slice(json) {
        Ok(document) => return Ok((document, 0)),
        Err(error) => error,
    };
    let (text, count) = mended(json);
    if let (Ok(document), true) = (serde_json::from_slice(&text), count > 0) {
        return Ok((document, count));
    }
    if let Some((document, more)) = fitted(&text) {
        return Ok((document, count + more));
    }
    if is_version_1(&text) {
        return Err(of_version_1());
    }
    let place = format!("JSON, line {} column {}", error.line(), error.column());
    Err(Fault::at(place, format!("is no glTF: {error}")))
}

/// Whether JSON is that of glTF 1.0, which has objects by name in place of lists.
fn is_version_1(json: &[u8]) -> bool {
    let Ok(said) = serde_json::from_slice::<serde_json::Value>(json) else {
        return false;
    };
    let version = match &said["asset"]["version"] {
        serde_json::Value::String(version) => version.clone(),
        other => other.to_string(),
    };
    let is_named = ["meshes", "accessors", "nodes"]
        .iter()
        .any(|it| said[it].is_object());
    version == "1" || version.starts_with("1.") || version == "null" && is_named
}

/// Refuses glTF 1.0.
fn of_version_1() -> Fault {
    let next = "convert it to 2.0, for instance with `npx gltf-pipeline -i OLD -o NEW.glb`";
    Fault::unsupported("it is glTF 1.0", next)
}

/// Refuses a file that cannot be read without an extension.
fn needs(extension: &str) -> Fault {
    let what = format!("it needs the extension {}", shortened(extension));
    Fault::unsupported(what, "export it without this extension")
}

fn word_at(bytes: &[u8], at: usize) -> Option<u32> {
    let mut word = [0; 4];
    word.copy_from_slice(bytes.get(at..at.checked_add(4)?)?);
    Some(u32::from_le_bytes(word))
}

/// The first chunk, which is JSON, and the binary one after it.
fn chunks(bytes: &[u8]) -> Result<Chunks<'_>, Fault> {
    let short = || {
        Fault::at(
            format!("byte {}", bytes.len()),
            "the file ends in its header",
        )
    };
    let version = word_at(bytes, 4).ok_or_else(short)?;
    if version == 1 {
        return Err(of_version_1());
    }
    if version != 2 {
        let what = format!("its version of binary glTF is {version}");
        return Err(Fault::unsupported(what, "export it as glTF 2.0"));
    }
    // Chunks say themselves where they end: what the head says of all of them is not needed.
    let said = word_at(bytes, 8).ok_or_else(short)? as usize;
    let there = bytes.len();
    let mut length = (said != there).then(|| {
        format!("{said} bytes are said to be there, {there} are: those that exist are read")
    });
    let mut at = HEADER_BYTES;
    let json = chunk(bytes, &mut at, JSON_CHUNK)?.ok_or_else(|| {
        let what = match word_at(bytes, HEADER_BYTES + 4) {
            Some(_) => "there is no chunk of JSON",
            None => "the file ends in its header",
        };
        Fault::at(format!("byte {HEADER_BYTES}"), what)
    })?;
    // Some begin the next chunk where it should, but do not count what lies before it.
    let aligned = at.next_multiple_of(4);
    let behind_json = at;
    let mut binary = chunk(bytes, &mut at, BINARY_CHUNK)?;
    if binary.is_none() && aligned != behind_json {
        at = aligned;
        binary = chunk(bytes, &mut at, BINARY_CHUNK)?;
    }
    if at > there {
        length.get_or_insert_with(|| {
            "its last chunk ends beyond the file: the bytes that exist are read".to_owned()
        });
    }
    Ok(Chunks {
        json,
        binary,
        length,
    })
}

/// The next chunk of a kind, from a place on; that is then behind it, which may be behind the file
/// for a binary one. Chunks of kinds that glTF does not have are passed over, as it demands.
fn chunk<'a>(bytes: &'a [u8], at: &mut usize, kind: u32) -> Result<Option<&'a [u8]>, Fault> {
    let mut next = *at;
    loop {
        let (Some(length), Some(found)) = (word_at(bytes, next), word_at(bytes, next + 4)) else {
            return Ok(None);
        };
        let begin = next + 8;
        let end = begin.saturating_add(length as usize);
        if found != kind {
            if [JSON_CHUNK, BINARY_CHUNK].contains(&found) || end > bytes.len() {
                return Ok(None);
            }
            next = end;
            continue;
        }
        let cut = (kind == BINARY_CHUNK).then(|| &bytes[begin..]);
        let Some(chunk) = bytes.get(begin..end).or(cut) else {
            let left = bytes.len() - begin;
            let what = format!("a chunk of {length} bytes is said to follow, {left} do");
            return Err(Fault::at(format!("byte {next}"), what));
        };
        *at = end;
        return Ok(Some(chunk));
    }
}
