//! What is a page told of a pack?

use crate::pack_in_parts::PackInParts;
use foveal_core::content::demand::Content;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::sound::SOUND;
use foveal_core::pack::{HEADER_BYTES, Header};
use foveal_core::view::surface::{Projection, Screen};
use serde_json::json;

/// The policies that a page can choose by.
const POLICIES: [Policy; 9] = [
    Policy::Viewport,
    Policy::Acuity,
    Policy::Perceptual,
    Policy::Eccentricity,
    Policy::Uniform,
    Policy::Grid,
    Policy::Distance,
    Policy::Full,
    Policy::Coarsest,
];

/// Bytes from the beginning of a pack that hold its header and description, by its first 64.
pub fn head_bytes(beginning: &[u8]) -> Result<u64, String> {
    let header = Header::parse(beginning).map_err(|error| error.to_string())?;
    Ok(header.data_offset().max(HEADER_BYTES as u64))
}

/// The `PackFacts` of `web/src/engine/api.ts`, as JSON, of a pack that begins with these bytes;
/// refuses what is no pack.
pub fn about(head: &[u8]) -> Result<String, String> {
    let pack = PackInParts::open(head, "", Screen::default()).map_err(|error| error.to_string())?;
    let video = &pack.video;
    let about = video.pack().description();
    let surface = video.grid().surface;
    let can = |policy: &&Policy| PolicyConfig::new(**policy).is_met_by(video.has());
    let policies: Vec<&Policy> = POLICIES.iter().filter(can).collect();
    let facts = json!({
        "projection": match about.projection {
            Projection::Flat => "flat",
            Projection::Cube => "cube",
        },
        "size": about.size,
        "faces": surface.faces_of_an_eye(),
        "eyes": surface.eyes,
        "levels": about.levels,
        "codec": about.codec.name(),
        "frames": about.frames,
        "seconds": video.timeline().length().0,
        "hasSound": pack.table_place(SOUND).is_some(),
        "bytes": pack.header.file_bytes,
        "name": about.source.name,
        "policies": policies,
        "fullRange": about.colour.full_range,
    });
    Ok(facts.to_string())
}
