//! What does a page learn about a pack?

use crate::pack_in_parts::{Head, PackInParts};
use foveal_core::content::demand::Content;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::demand::why_not;
use foveal_core::content::scene::description::SceneDescription;
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::sound::SOUND;
use foveal_core::pack::{HEADER_BYTES, Header, PackError};
use foveal_core::view::surface::{Projection, Screen};
use serde_json::{Value, json};

/// Bytes from the beginning of a pack that hold its header and description, by its first 64.
pub fn head_bytes(beginning: &[u8]) -> Result<u64, String> {
    let header = Header::parse(beginning).map_err(|error| error.to_string())?;
    Ok(header.data_offset().max(HEADER_BYTES as u64))
}

/// First byte and length of every stretch of the file that [`PackInParts::open`] needs besides
/// the head.
pub fn opening(head: &[u8]) -> Result<Vec<f64>, String> {
    let stretches = Head::read(head).and_then(|(header, head)| head.stretches(&header));
    let stretches = stretches.map_err(|error| error.to_string())?;
    let stretches = stretches.iter();
    Ok(stretches
        .flat_map(|it| [it.start as f64, (it.end - it.start) as f64])
        .collect())
}

/// The `PackFacts` of `web/src/engine/api.ts`, as JSON, of a pack that begins with these bytes;
/// refuses what is no pack.
pub fn about(head: &[u8]) -> Result<String, String> {
    let told = |error: PackError| error.to_string();
    let (header, read) = Head::read(head).map_err(told)?;
    let mut facts = match &read {
        Head::Video(_) => {
            let pack = PackInParts::open(head, &[], "", Screen::default()).map_err(told)?;
            let has_sound = pack.table_place(SOUND).is_some();
            let video = pack.content.video();
            video.map(|video| about_video(video, has_sound))
        }
        Head::Scene(about) => Some(about_scene(about)),
    }
    .unwrap_or_default();
    for kind in UnitKind::shapes() {
        let count = match &read {
            Head::Video(_) => 0,
            Head::Scene(about) => about.samples_of(kind),
        };
        facts[kind.facts().samples()] = count.into();
    }
    facts["bytes"] = header.file_bytes.into();
    Ok(facts.to_string())
}

fn about_video(video: &Video, has_sound: bool) -> Value {
    let about = video.pack().description();
    let surface = video.grid().surface;
    let can = |policy: &Policy| PolicyConfig::new(*policy).is_met_by(video.has());
    let policies: Vec<Policy> = page_policies().filter(can).collect();
    json!({
        "kind": "video",
        "projection": match about.projection {
            Projection::Flat => "flat",
            Projection::Cube => "cube",
            Projection::Equirect => "equirect",
        },
        "size": about.size,
        "faces": surface.faces_of_an_eye(),
        "eyes": surface.eyes,
        "levels": about.levels,
        "codec": about.codec.name(),
        "frames": about.frames,
        "seconds": video.timeline().length().0,
        "hasSound": has_sound,
        "name": about.source.name,
        "policies": policies,
        "fullRange": about.colour.full_range,
    })
}

fn about_scene(about: &SceneDescription) -> Value {
    let can = |policy: &Policy| why_not(*policy).is_none();
    let policies: Vec<Policy> = page_policies().filter(can).collect();
    json!({
        "kind": "scene",
        "projection": null,
        "size": [0, 0],
        "faces": 0,
        "eyes": 1,
        "levels": about.units.len(),
        "codec": "",
        "frames": 1,
        "seconds": 1,
        "hasSound": false,
        "name": about.source.names.join(", "),
        "policies": policies,
    })
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
    fn the_page_lists_what_scenes_consist_of() {
        let api = include_str!("../../../web/src/engine/api.ts");
        let samples: Vec<String> = UnitKind::shapes().map(|it| it.facts().samples()).collect();
        assert_eq!(listed(api, "SAMPLES = ["), samples);
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
