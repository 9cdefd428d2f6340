//! Does a page ask for the right bytes, and does it settle on what it is given?
//!
//! Whole sessions without a browser: the CPU twin shows, the test is the host and the decoder.

use crate::needs::{Kind, ROW};
use crate::options::Options;
use crate::page_player::{PagePlayer, flag};
use foveal_core::content::opened::Opened;
use foveal_core::content::payload::Payload;
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::build::{begin_pack, finish_pack, push_tile};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::description::{Description, Source};
use foveal_core::content::video::grid::tile_grid::{Cut, Tile};
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{HEADER_BYTES, Header, SideTable};
use foveal_core::units::Seconds;
use foveal_core::view::picture::{Colour, Matrix, Picture};
use foveal_core::view::surface::{Projection, Screen};
use std::collections::HashSet;
use std::sync::Arc;

mod scenes;
mod standing_in;

const SIZE: [u32; 2] = [512, 320];
const FRAMES: u32 = 12;

fn description() -> Description {
    Description {
        generator: "test".into(),
        projection: Projection::Flat,
        size: SIZE,
        eyes: 1,
        cube_faces: 6,
        mapping: foveal_core::view::surface::Mapping::Gnomonic,
        pixel_aspect: [1, 1],
        front_deg: 0.0,
        cut: Cut::Tile(32),
        levels: 3,
        ratio: 4,
        codec: Codec::Png,
        quality: vec![0; 3],
        quality_scale: Default::default(),
        quality_by_tile: false,
        bit_rates: Vec::new(),
        groups: vec![4, 4, 12],
        frames: FRAMES,
        frame_rate: [25, 1],
        colour: Colour {
            matrix: Matrix::Bt709,
            full_range: false,
            chroma_left: true,
        },
        source: Source {
            name: "a.mkv".into(),
            size: SIZE,
            bytes: 9,
            codec: "x".into(),
        },
        identity: None,
        loss: None,
        last_frame_s: None,
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: vec![],
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
        let grid = about.grid(Screen::default());
        let mut builder = begin_pack(&about);
        let mut chunks = Vec::new();
        let mut finer = 0;
        for level in (0..3).rev() {
            let group = about.groups[usize::from(level)];
            for first in (0..FRAMES).step_by(group as usize) {
                for tile in grid.tiles_of(level) {
                    finer += usize::from(level < 2);
                    let units = vec![vec![7; 5]; group as usize];
                    chunks.extend(push_tile(&mut builder, tile, first, &units));
                }
            }
        }
        let finished = finish_pack(builder, about, &tables(finer)).unwrap();
        let file = [finished.head, chunks, finished.tail].concat();
        Self { file }
    }

    fn player(&self, options: &str) -> PagePlayer {
        self.player_by("viewport", options)
    }

    fn player_by(&self, policy: &str, options: &str) -> PagePlayer {
        let header = Header::parse(&self.file).unwrap();
        let head = &self.file[..HEADER_BYTES + header.description_bytes as usize];
        let text = format!(
            r#"{{"name":"a","policy":"{policy}","size":{SIZE:?},"screenSize":{SIZE:?}{options}}}"#
        );
        let options = Options::parse(&text).unwrap();
        PagePlayer::new(head, &[], &options, None).unwrap()
    }

    /// Answers everything that is asked for.
    fn answer(&self, player: &mut PagePlayer) {
        for row in rows(player) {
            let from = row.offset as usize;
            let bytes = &self.file[from..from + row.bytes as usize];
            if row.kind == Kind::Page as u8 {
                let pack = video(player).pack();
                pack.index().add_page(row.number, bytes).unwrap();
            } else if row.kind == Kind::Picture as u8 {
                let unit = UnitId(row.number);
                let lengths = video(player).lengths(unit, bytes).unwrap();
                assert!(!lengths.is_empty() && lengths.iter().all(|length| *length == 5));
                deliver(player, unit, row.frame);
            }
        }
    }
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

#[derive(Clone, Copy, Debug)]
struct Row {
    kind: u8,
    number: u32,
    offset: u64,
    bytes: u32,
    frame: u32,
    level: u8,
}

fn rows(player: &PagePlayer) -> Vec<Row> {
    let needs = player.needs();
    let row = |row: &[f64]| Row {
        kind: row[0] as u8,
        number: row[1] as u32,
        offset: row[2] as u64,
        bytes: row[3] as u32,
        frame: row[4] as u32,
        level: row[9] as u8,
    };
    needs.chunks_exact(ROW).map(row).collect()
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
    let first = rows(&player);
    assert!(first.iter().all(|row| row.kind == Kind::Page as u8));
    assert_eq!(
        first.len(),
        3,
        "a page a level, so that no saccade waits for one"
    );
    host.answer(&mut player);
    let then = rows(&player);
    assert!(then.iter().all(|row| row.kind == Kind::Picture as u8));
    assert_eq!(then[0].level, 2);
    let finer = then.iter().skip(1).map(|row| row.level);
    assert_eq!(finer.collect::<HashSet<u8>>(), HashSet::from([0]));
}

#[test]
fn a_still_view_settles_in_two_answers_and_a_zoomed_one_asks_only_for_what_is_new() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true,"log":true"#);
    assert!(settle(&host, &mut player, 0.0) <= 4);
    assert!(rows(&player).is_empty());
    assert_eq!(player.session.figures().histogram[0], 160);
    player.step_frames(1, Seconds(1.0));
    settle(&host, &mut player, 1.0);
    assert_eq!(player.session.figures().frames, 2);
    assert!(player.log().lines().count() >= 3);
}

#[test]
fn a_damaged_page_leaves_the_coarser_picture_and_settles() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true"#);
    player.step(Seconds(0.0)).unwrap();
    let finest = rows(&player).iter().map(|row| row.number).max().unwrap();
    video(&player).fail_page(finest);
    settle(&host, &mut player, 0.0);
    assert_eq!(player.session.figures().histogram[0], 0);
    assert!(player.session.figures().damaged_units > 0);
}

#[test]
fn with_coarse_privacy_a_host_sees_blocks_and_never_which_tile_of_one() {
    let host = Host::new();
    let mut player = host.player(r#","paused":true,"coarse":true"#);
    let pane = player.pane();
    player.viewer.navigation.zoom_by(6.0, [100.0, 60.0], &pane);
    player.step(Seconds(0.0)).unwrap();
    host.answer(&mut player);
    let shelf = video(&player);
    let asked: Vec<Tile> = rows(&player)
        .iter()
        .filter(|row| row.level < 2)
        .map(|row| shelf.pack().tile_of(UnitId(row.number)))
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
    let ahead: Vec<Row> = rows(&player)
        .into_iter()
        .filter(|row| row.kind == Kind::Bytes as u8)
        .collect();
    let shelf = video(&player);
    let groups: HashSet<u32> = ahead
        .iter()
        .map(|row| shelf.pack().frames_of(UnitId(row.number)).start)
        .collect();
    assert!(groups.contains(&4) && groups.contains(&8), "{groups:?}");
    let frames: Vec<u32> = ahead.iter().map(|row| row.frame).collect();
    assert!(frames.iter().any(|frame| *frame >= 4));
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
    assert_eq!(player.session.shown_tick(), Some(0));
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
