//! What does a page learn about a pack?

use crate::opening::OpenPack;
use crate::pack_in_parts::PackInParts;
use foveal_core::content::demand::Content;
use foveal_core::content::opened::Opened;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::demand::why_not;
use foveal_core::content::scene::description::SceneDescription;
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::sound::SOUND;
use foveal_core::view::surface::{Projection, Screen};
use serde_json::{Value, json};

/// What is known of an open pack, as JSON: part of `PackFacts` of `web/src/engine/api.ts`.
pub fn about(pack: &OpenPack) -> String {
    let parts = PackInParts::new(pack, "", Screen::default());
    let mut facts = match &parts.content {
        Opened::Video(video) => about_video(video, parts.table_to_come(SOUND).is_some()),
        Opened::Scene(scene) => about_scene(scene.pack().description()),
    };
    for kind in UnitKind::shapes() {
        let scene = parts.content.scene();
        let count = scene.map_or(0, |it| it.pack().description().samples_of(kind));
        facts[kind.facts().samples()] = count.into();
    }
    facts["bytes"] = pack.header.file_bytes.into();
    facts.to_string()
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
    }
}
