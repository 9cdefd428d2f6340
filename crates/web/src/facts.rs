//! What is a page told of a pack?

use crate::pack_in_parts::PackInParts;
use foveal_core::content::demand::Content;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::sound::SOUND;
use foveal_core::pack::{HEADER_BYTES, Header};
use foveal_core::view::surface::{Projection, Screen};
use serde_json::json;

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
    let can = |policy: &Policy| PolicyConfig::new(*policy).is_met_by(video.has());
    let policies: Vec<Policy> = page_policies().filter(can).collect();
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

/// The policies that a page can choose by.
fn page_policies() -> impl Iterator<Item = Policy> {
    let policies = Policy::IN_TURN.into_iter();
    policies.filter(|policy| policy.facts().on_page)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names in the first list after `begin`.
    fn listed<'a>(text: &'a str, begin: &str) -> Vec<&'a str> {
        let list = text.split_once(begin).unwrap().1.split_once(']').unwrap().0;
        list.split('"').skip(1).step_by(2).collect()
    }

    #[test]
    fn the_page_lists_the_policies_that_there_are() {
        let api = include_str!("../../../web/src/engine/api.ts");
        let names: Vec<&str> = page_policies().map(Policy::name).collect();
        assert_eq!(listed(api, "POLICIES = ["), names);
        let courier = include_str!("../../../web/src/engine/courier.ts");
        let valued = |policy: &Policy| policy.has_target();
        let mut names: Vec<&str> = page_policies().filter(valued).map(Policy::name).collect();
        let mut listed = listed(courier, "VALUED: readonly PolicyName[] = [");
        names.sort_unstable();
        listed.sort_unstable();
        assert_eq!(listed, names);
    }
}
