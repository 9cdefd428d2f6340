//! Does a page play a scene by ranges, and say what is wrong with one?

use super::*;
use crate::facts::about;
use crate::opening::PackKind;
use foveal_core::content::policy::Policy;
use foveal_core::content::scene::pack::{begin_scene, chunk_name, finish_scene};
use foveal_core::content::scene::scripted::{scripted_scene, scripted_scene_file};
use foveal_core::pack::{HEADER_BYTES, Header};
use foveal_core::session::log_of_parts::SessionLog;

fn open(file: &[u8], policy: &str) -> Result<PagePlayer, String> {
    let text = format!(
        r#"{{"name":"a","policy":"{policy}","size":[640,400],"screenSize":[1920,1080],"log":true}}"#
    );
    let pack = open_pack(file).map_err(|error| error.to_string())?;
    PagePlayer::new(&pack, &Options::parse(&text).unwrap(), None)
}

/// Answers everything that is asked for; returns how many units that were.
fn answer(file: &[u8], player: &mut PagePlayer) -> usize {
    let needs = player.needs().to_vec();
    for need in &needs {
        let chunk = stretch(file, need);
        if player.arrived(need.offset, chunk) == Ok(Arrival::Again) {
            let told = player.arrived(need.offset, chunk).unwrap_err();
            assert!(told.contains("CRC32C"), "{told}");
        }
    }
    needs.len()
}

/// Steps and answers until nothing is missing; how many units came.
fn play(file: &[u8], player: &mut PagePlayer, from: f64) -> usize {
    let mut units = 0;
    for round in 0..50 {
        let told = player
            .step(Seconds(from + 0.05 * f64::from(round)))
            .unwrap();
        if told & flag::SETTLED != 0 {
            return units;
        }
        units += answer(file, player);
    }
    panic!("it does not settle");
}

/// The same scene with so long a name that its objects lie in a table.
fn with_object_table(file: &[u8]) -> Vec<u8> {
    let scene = scripted_scene().unwrap();
    let pack = scene.pack();
    let mut about = pack.description().clone();
    about.tables.clear();
    about.objects[0].name = "part ".repeat(10_000);
    let mut builder = begin_scene(&about);
    let mut chunks = Vec::new();
    for unit in pack.units() {
        let entry = pack.entry(unit);
        let chunk = &file[entry.offset as usize..][..entry.bytes as usize];
        builder.push(chunk_name(unit), chunk);
        chunks.extend(chunk);
    }
    let parts = finish_scene(builder, about, pack.rows()).unwrap();
    [parts.head, chunks, parts.tail].concat()
}

#[test]
fn a_page_shows_a_scene_whose_objects_lie_in_a_table() {
    let file = scripted_scene_file().unwrap();
    let tabled = with_object_table(&file);
    let text = String::from_utf8_lossy(&tabled[..4096]).into_owned();
    assert!(text.contains(r#""needs":["scene","objects"]"#), "{text}");
    let mut players = [&file, &tabled].map(|file| open(file, "viewport").unwrap());
    let [plain, of_table] = &mut players;
    assert_eq!(play(&file, plain, 0.0), play(&tabled, of_table, 0.0));
    assert_eq!(
        plain.play.session().figures().histogram,
        of_table.play.session().figures().histogram
    );
    let PackKind::Scene(pack) = open_pack(&tabled).unwrap().kind else {
        panic!("it is a scene");
    };
    let objects = pack.description().objects_table().unwrap().unwrap();
    let mut damaged = tabled.clone();
    damaged[objects.offset as usize] ^= 1;
    let refused = open_pack(&damaged).map(|_| ()).unwrap_err();
    assert!(refused.to_string().contains("objects"));
}

#[test]
fn a_scene_asks_for_its_roots_first_and_settles_on_what_is_seen() {
    let file = scripted_scene_file().unwrap();
    let mut player = open(&file, "viewport").unwrap();
    player.step(Seconds(0.0)).unwrap();
    let scene = scripted_scene().unwrap();
    let level = |need: &Need| match need.part {
        Part::Unit(unit) => scene.pack().level_of(unit),
        _ => panic!("{need:?} is no unit"),
    };
    let first: Vec<u8> = player.needs().iter().map(level).collect();
    assert_eq!(first[..2].iter().min(), Some(&3), "roots");
    let units = play(&file, &mut player, 0.0);
    assert!(units > 2 && player.play.session().figures().damaged_units == 0);
    let before = player.play.session().figures().histogram.clone();
    player
        .viewer
        .navigation
        .zoom_by(3.0, [0.0; 2], &player.pane());
    play(&file, &mut player, 9.0);
    assert!(player.needs().is_empty());
    let after = &player.play.session().figures().histogram;
    assert!(after[0] > before[0], "{before:?} then {after:?}");
}

#[test]
fn a_key_that_is_held_flies_on_until_it_is_let_go() {
    let file = scripted_scene_file().unwrap();
    let mut player = open(&file, "coarsest").unwrap();
    play(&file, &mut player, 0.0);
    let place = |player: &PagePlayer| player.shown().view.position;
    let start = place(&player);
    player.fly([0.0, 0.0, 1.0], true, false, Seconds(10.0));
    let told = player.step(Seconds(10.1)).unwrap();
    assert_eq!(told & (flag::AGAIN | flag::DRAW), flag::AGAIN | flag::DRAW);
    let usual = start.z - place(&player).z;
    assert!(usual > 0.0);
    player.fly([0.0; 3], false, true, Seconds(10.1));
    player.step(Seconds(10.2)).unwrap();
    assert!(start.z - place(&player).z > 3.0 * usual, "Shift is faster");
    player.fly([0.0, 0.0, 1.0], false, false, Seconds(10.2));
    let there = place(&player);
    player.step(Seconds(12.0)).unwrap();
    assert_eq!(place(&player), there);
}

#[test]
fn a_damaged_unit_is_counted_and_the_coarser_one_stays() {
    let mut file = scripted_scene_file().unwrap();
    let scene = scripted_scene().unwrap();
    let last = scene.pack().units().last().unwrap();
    file[scene.pack().entry(last).offset as usize] ^= 1;
    let mut player = open(&file, "full").unwrap();
    play(&file, &mut player, 0.0);
    assert_eq!(player.play.session().figures().damaged_units, 1);
}

#[test]
fn what_is_damaged_before_the_units_is_named() {
    let file = scripted_scene_file().unwrap();
    let header = Header::parse(&file).unwrap();
    let places = [
        (HEADER_BYTES, "description"),
        (header.index_offset as usize, "index"),
        (file.len() - 1, "table"),
    ];
    for (place, named) in places {
        let mut bad = file.clone();
        bad[place] ^= 1;
        let told = open_pack(&bad).map(|_| ()).unwrap_err().to_string();
        assert!(told.contains(named), "byte {place}: {told}");
    }
}

#[test]
fn only_the_policies_of_scenes_are_offered_and_taken() {
    let file = scripted_scene_file().unwrap();
    let facts = about(&open_pack(&file).unwrap());
    let facts: serde_json::Value = serde_json::from_str(&facts).unwrap();
    assert_eq!(facts["kind"], "scene");
    assert_eq!(facts["triangles"], 256);
    let offered: Vec<Policy> = serde_json::from_value(facts["policies"].clone()).unwrap();
    assert_eq!(offered[0], Policy::Viewport);
    for policy in Policy::ALL {
        let mut player = open(&file, "viewport").unwrap();
        let taken = player.set_policy(policy).is_ok();
        let on_page = policy.facts().on_page;
        assert_eq!(taken && on_page, offered.contains(&policy), "{policy:?}");
        let opened = open(&file, policy.name()).is_ok();
        assert_eq!(opened && on_page, offered.contains(&policy), "{policy:?}");
    }
}

#[test]
fn the_log_of_a_flight_replays() {
    let file = scripted_scene_file().unwrap();
    let mut player = open(&file, "acuity").unwrap();
    play(&file, &mut player, 0.0);
    player.fly([1.0, 0.0, 1.0], true, false, Seconds(9.0));
    for round in 0..20 {
        player.step(Seconds(9.0 + 0.1 * f64::from(round))).unwrap();
        answer(&file, &mut player);
    }
    let text = player.log();
    let log = SessionLog::parse(text).unwrap();
    assert!(log.parts[0].frames.len() > 5);
    let content = player.pack.content.content();
    let again = log.replay(&|_, head, config| Arc::clone(&content).demand(head, config));
    assert_eq!(again.write(), text);
}
