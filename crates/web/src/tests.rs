//! Does a page ask for the right bytes, and does it settle on what it is given?
//!
//! Whole sessions without a browser: the CPU twin shows, the test is the host and the decoder.

use crate::opening::{OpenPack, Opening};
use crate::options::Options;
use crate::page_player::{PagePlayer, flag};
use crate::stretches::{Arrival, Need, Part};
use foveal_core::content::payload::Payload;
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::description::Description;
use foveal_core::content::video::bytes::small_pack::{
    refining_units, small_description, small_pack,
};
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{PackError, SideTable};
use foveal_core::units::Seconds;
use foveal_core::view::picture::Picture;
use std::collections::HashSet;
use std::sync::Arc;

mod scenes;
mod standing_in;

const SIZE: [u32; 2] = [512, 320];
const FRAMES: u32 = 12;

fn description() -> Description {
    Description {
        ratio: 4,
        ..small_description(SIZE, 32, &[4, 4, 12], FRAMES)
    }
}

/// A host with a pack whose chunks are never read.
struct Host {
    file: Vec<u8>,
}

impl Host {
    fn new() -> Self {
        Self::with(|_| Vec::new())
    }

    /// With side tables for so many units finer than the coarsest level.
    fn with(tables: impl FnOnce(usize) -> Vec<SideTable>) -> Self {
        let about = description();
        let tables = tables(refining_units(&about));
        let file = small_pack(about, &tables, |_, frames| vec![vec![7; 5]; frames.len()]).unwrap();
        Self { file }
    }

    fn player(&self, options: &str) -> PagePlayer {
        self.player_by("viewport", options)
    }

    fn player_by(&self, policy: &str, options: &str) -> PagePlayer {
        let text = format!(
            r#"{{"name":"a","policy":"{policy}","size":{SIZE:?},"screenSize":{SIZE:?}{options}}}"#
        );
        let options = Options::parse(&text).unwrap();
        let pack = open_pack(&self.file).unwrap();
        PagePlayer::new(&pack, &options, None).unwrap()
    }

    /// Answers everything that is waited for.
    fn answer(&self, player: &mut PagePlayer) {
        let needs = player.needs().to_vec();
        for need in needs.iter().filter(|need| !need.early) {
            let arrival = player.arrived(need.offset, stretch(&self.file, need));
            let Arrival::Decode(edges) = arrival.unwrap() else {
                continue;
            };
            let picture = need.picture.unwrap();
            assert_eq!(edges.len() as u32, picture.frames + 1);
            assert_eq!(u64::from(*edges.last().unwrap()), need.bytes);
            assert!(edges.windows(2).all(|edges| edges[1] - edges[0] == 5));
            deliver(player, picture.unit, picture.frame);
        }
    }
}

/// The bytes of a stretch of a file.
fn stretch<'a>(file: &'a [u8], need: &Need) -> &'a [u8] {
    &file[need.offset as usize..][..need.bytes as usize]
}

/// Gives a pack all that it needs until it is open.
fn open_pack(file: &[u8]) -> Result<OpenPack, PackError> {
    let mut opening = Opening::default();
    while opening.open().is_none() {
        for need in opening.needs() {
            assert_eq!(
                opening.arrived(need.offset, stretch(file, &need))?,
                Arrival::More
            );
        }
    }
    assert_eq!(opening.file_bytes(), Some(file.len() as u64));
    Ok(opening.open().unwrap().clone())
}

fn video(player: &PagePlayer) -> &Arc<Video> {
    player.pack.content.video().unwrap()
}

fn deliver(player: &mut PagePlayer, unit: UnitId, frame: u32) {
    let video = video(player);
    let [w, h] = video.grid().tile_size(video.pack().tile_of(unit));
    let picture = Picture::filled(w, h, [100, 128, 128]);
    player.deliver(unit.0, frame, 1, Some(Payload::Picture(picture)));
}

fn tile(player: &PagePlayer, need: &Need) -> Tile {
    let Part::Unit(unit) = need.part else {
        panic!("{need:?} is no tile");
    };
    video(player).pack().tile_of(unit)
}

/// Steps and answers until nothing is missing; how many rounds that took.
fn settle(host: &Host, player: &mut PagePlayer, from: f64) -> usize {
    for round in 0..50 {
        let told = player.step(Seconds(from + 0.01 * round as f64)).unwrap();
        if told & flag::SETTLED != 0 {
            return round;
        }
        host.answer(player);
    }
    panic!("it does not settle");
}

#[test]
fn the_index_is_asked_for_first_and_the_coarsest_level_before_the_others() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true"#);
    player.step(Seconds(0.0)).unwrap();
    let first = player.needs();
    assert!(first.iter().all(|need| matches!(need.part, Part::Page(_))));
    assert_eq!(
        first.len(),
        3,
        "a page a level, so that no saccade waits for one"
    );
    host.answer(&mut player);
    let then = player.needs().to_vec();
    assert!(then.iter().all(|need| need.picture.is_some()));
    let levels: Vec<u8> = then.iter().map(|need| tile(&player, need).level).collect();
    assert_eq!(levels[0], 2);
    assert!(levels[1..].iter().all(|level| *level == 0));
}

#[test]
fn a_still_view_settles_in_two_answers_and_a_zoomed_one_asks_only_for_what_is_new() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true,"log":true"#);
    assert!(settle(&host, &mut player, 0.0) <= 4);
    assert!(player.needs().is_empty());
    assert_eq!(player.play.session().figures().histogram[0], 160);
    player.step_frames(1, Seconds(1.0));
    settle(&host, &mut player, 1.0);
    assert_eq!(player.play.session().figures().frames, 2);
    assert!(player.log().lines().count() >= 3);
}

#[test]
fn a_damaged_page_leaves_the_coarser_picture_and_settles() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true"#);
    player.step(Seconds(0.0)).unwrap();
    let finest = player.needs().last().unwrap().clone();
    assert_eq!(finest.part, Part::Page(2));
    let damaged = vec![0; finest.bytes as usize];
    let again = player.arrived(finest.offset, &damaged);
    assert_eq!(again, Ok(Arrival::Again));
    let told = player.arrived(finest.offset, &damaged).unwrap_err();
    assert!(told.contains("index page 2"), "{told}");
    // It is said once.
    let told = player.arrived(finest.offset, &damaged);
    assert_eq!(told, Ok(Arrival::Taken));
    assert!(!player.needs().contains(&finest));
    settle(&host, &mut player, 0.0);
    assert_eq!(player.play.session().figures().histogram[0], 0);
    assert!(player.play.session().figures().damaged_units > 0);
}

#[test]
fn with_coarse_privacy_a_host_sees_blocks_and_never_which_tile_of_one() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true,"coarse":true"#);
    let pane = player.pane();
    player.viewer.navigation.zoom_by(6.0, [100.0, 60.0], &pane);
    player.step(Seconds(0.0)).unwrap();
    host.answer(&mut player);
    let needs = player.needs().to_vec();
    let shelf = video(&player);
    let asked: Vec<Tile> = needs
        .iter()
        .map(|need| tile(&player, need))
        .filter(|tile| tile.level < 2)
        .collect();
    let set: HashSet<Tile> = asked.iter().copied().collect();
    assert!(!set.is_empty());
    for tile in &set {
        let [columns, rows] = shelf.grid().tiles(tile.level);
        let block = |place: u16, most: u32| {
            let from = place - place % 3;
            from..(u32::from(from) + 3).min(most) as u16
        };
        for y in block(tile.y, rows) {
            for x in block(tile.x, columns) {
                assert!(set.contains(&Tile { x, y, ..*tile }), "{tile:?} {x},{y}");
            }
        }
    }
}

#[test]
fn while_it_plays_the_next_groups_are_asked_for_ahead() {
    let host = Host::new();
    let mut player = host.player("");
    for round in 0..6 {
        player.step(Seconds(0.001 * f64::from(round))).unwrap();
        host.answer(&mut player);
    }
    player.viewer.begin(Seconds(0.006));
    player.step(Seconds(0.006)).unwrap();
    let units: Vec<UnitId> = player.needs().iter().filter_map(|it| it.ahead).collect();
    let first = |unit: &UnitId| video(&player).pack().frames_of(*unit).start;
    let groups: HashSet<u32> = units.iter().map(first).collect();
    assert!(groups.contains(&4) && groups.contains(&8), "{groups:?}");
}

#[test]
fn time_begins_with_the_first_picture_however_long_that_takes() {
    let host = Host::new();
    let mut player = host.player("");
    for round in 0..6 {
        player.step(Seconds(f64::from(round))).unwrap();
        host.answer(&mut player);
    }
    assert!(player.viewer.is_playing() && !player.is_moving());
    assert_eq!(player.time(Seconds(9.0)), Seconds(0.0));
    assert_eq!(player.play.session().shown_tick(), Some(0));
    player.viewer.begin(Seconds(9.0));
    assert!((player.time(Seconds(9.1)).0 - 0.1).abs() < 1e-9);
}

#[test]
fn a_gaze_record_rules_and_what_is_none_is_refused() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true"#);
    let record = br#"{"t_s":1,"yaw_deg":5,"pitch_deg":-2,"spread_deg":0}"#;
    player.looking.take(record, Seconds(0.0)).unwrap();
    player.step(Seconds(0.01)).unwrap();
    let stats: serde_json::Value = serde_json::from_str(&player.stats(Seconds(0.01))).unwrap();
    let [yaw, pitch] = [0, 1].map(|k| stats["gazeDeg"][k].as_f64().unwrap());
    assert!((yaw - 5.0).abs() < 1e-6 && (pitch + 2.0).abs() < 1e-6);
    assert!(player.looking.take(b"{}", Seconds(0.1)).is_err());
}

/// The script of the page names the fields as they are written.
#[test]
fn the_page_reads_what_is_written_to_it() {
    let script = [
        include_str!("../../../web/src/engine/bytes.ts"),
        include_str!("../../../web/src/engine/plan.ts"),
        include_str!("../../../web/src/engine/decoders.ts"),
        include_str!("../../../web/src/engine/needs.ts"),
    ];
    let script = script.concat();
    let host = Host::new();
    let mut player = host.player("");
    player.step(Seconds(0.0)).unwrap();
    host.answer(&mut player);
    let need = player.needs()[0].clone();
    let need = Need {
        ahead: need.picture.map(|picture| picture.unit),
        ..need
    };
    let written = serde_json::to_value(&need).unwrap();
    for object in [&written, &written["picture"]] {
        for name in object.as_object().unwrap().keys() {
            let [given, left_out] = ["", "?"].map(|it| format!("readonly {name}{it}: "));
            let is_read = script.contains(&given) || script.contains(&left_out);
            assert!(is_read, "{name}");
        }
    }
    for name in ["taken", "more", "again"] {
        assert!(script.contains(&format!("| \"{name}\"\n")), "{name}");
    }
    let decode = Arrival::Decode(vec![4, 9]);
    let all = [Arrival::Taken, Arrival::More, Arrival::Again, decode];
    let written = serde_json::to_string(&all).unwrap();
    assert_eq!(written, r#"["taken","more","again",{"decode":[4,9]}]"#);
}
