//! Does the decode pool give the tiles that were asked for, whatever was asked before?

use foveal_core::content::payload::Payload;
use foveal_core::content::unit::AssetId;
use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile};
use foveal_core::session::decoder::{DecodeError, Decoded, Decoder, PackBytes};
use foveal_core::session::unit_states::Piece;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Screen;
use std::collections::{HashMap, HashSet};
use std::fs::OpenOptions;
use std::io::{Seek, SeekFrom, Write};
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;

use crate::pack::pack_file::PackFile;
use crate::prepare::{PrepareSettings, ProjectionChoice};
use crate::tests::scenes::{Scratch, group, prepared, settings, write_clip};
use crate::tiles::decode_pool::DecodePool;
use crate::{ClipCodec, GroupDecoder};

const FRAMES: u32 = 37;

fn flat_pack(codec: Codec) -> Scratch {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([150, 90], FRAMES, 3));
    prepared(&clip, &settings(ProjectionChoice::Flat, codec))
}

fn open(path: &Scratch) -> Arc<PackFile> {
    Arc::new(PackFile::open(path).unwrap())
}

fn all_tiles(file: &PackFile) -> Vec<Tile> {
    let grid = file.pack().grid();
    (0..grid.levels)
        .flat_map(|level| grid.tiles_of(level))
        .collect()
}

/// Every picture of every tile, each group decoded from its key on by a fresh decoder.
fn decoded_in_order(file: &PackFile) -> HashMap<(Tile, u32), Picture> {
    let pack = file.pack();
    let mut pictures = HashMap::new();
    for unit in pack.units() {
        let (tile, frames) = (pack.tile_of(unit), pack.frames_of(unit));
        let chunk = file.read_chunk(unit).unwrap();
        let codec = pack.description().codec;
        let mut decoder = GroupDecoder::new(codec, pack.grid().tile_size(tile)).unwrap();
        for (frame, unit) in frames
            .clone()
            .zip(split_chunk(&chunk, frames.len()).unwrap())
        {
            let (picture, number) = decoder.decode(unit, i64::from(frame)).unwrap();
            assert_eq!(number, i64::from(frame));
            pictures.insert((tile, frame), picture);
        }
    }
    pictures
}

fn random(state: &mut u64, below: usize) -> usize {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1);
    (*state >> 33) as usize % below
}

/// The bytes of a pack.
fn bytes(file: &PackFile) -> PackBytes {
    let video = file.video(Screen::default()).unwrap();
    PackBytes::new(video, file.source())
}

fn piece(file: &PackFile, tile: Tile, frame: u32) -> Piece {
    let unit = AssetId::ONLY.unit(file.pack().unit(tile, frame));
    Piece { unit, frame }
}

fn ask(pool: &mut DecodePool, file: &PackFile, tile: Tile, frame: u32) {
    let piece = piece(file, tile, frame);
    pool.request(vec![(piece, bytes(file).of(piece.unit.unit))]);
}

fn one(pool: &mut DecodePool, file: &PackFile, tile: Tile, frame: u32) -> Decoded {
    ask(pool, file, tile, frame);
    let done = pool.receive(None).unwrap();
    assert_eq!(done.piece, piece(file, tile, frame));
    done
}

/// The frame of a tile that was decoded, and its picture.
fn picture(file: &PackFile, done: Decoded) -> ((Tile, u32), Picture) {
    let tile = file.pack().tile_of(done.piece.unit.unit);
    match done.payload {
        Ok(Payload::Picture(picture)) => ((tile, done.piece.frame), picture),
        other => panic!("{other:?}"),
    }
}

#[test]
fn any_tile_of_any_frame_in_any_order_is_the_picture_of_decoding_in_order() {
    for codec in [Codec::Vp9, Codec::Jpeg, Codec::Png] {
        let path = flat_pack(codec);
        let file = open(&path);
        let (expected, tiles) = (decoded_in_order(&file), all_tiles(&file));
        assert_eq!(expected.len(), tiles.len() * FRAMES as usize);
        let mut pool = DecodePool::new(&file, 3).unwrap();
        let mut state = 11;
        for _ in 0..40 {
            let mut asked = 0;
            for _ in 0..10 {
                let tile = tiles[random(&mut state, tiles.len())];
                ask(
                    &mut pool,
                    &file,
                    tile,
                    random(&mut state, FRAMES as usize) as u32,
                );
                asked += 1;
            }
            while let Some(done) = pool.receive(None) {
                let (place, picture) = picture(&file, done);
                assert!(picture == expected[&place], "{codec:?} {place:?}");
                asked -= 1;
            }
            // What was asked twice while it waited is decoded once.
            assert!((0..10).contains(&asked), "{asked} of 10 never came");
        }
    }
}

#[test]
fn asked_within_a_group_exactly_the_frames_from_its_key_are_decoded() {
    let path = flat_pack(Codec::Vp9);
    let file = open(&path);
    let groups = file.pack().description().groups.clone();
    let coarsest = file.pack().grid().coarsest();
    for tile in all_tiles(&file) {
        // Decoded ahead, so that how much of it was waited for is a matter of time.
        if tile.level == coarsest {
            continue;
        }
        let length = groups[usize::from(tile.level)];
        let since_key = |frame: u32| frame % length + 1;
        let mut pool = DecodePool::new(&file, 2).unwrap();
        let mut decoded = |frame| one(&mut pool, &file, tile, frame).frames;
        assert_eq!(decoded(5), 6);
        assert_eq!(decoded(6), 1, "the frame that follows");
        assert_eq!(decoded(7), 1);
        assert_eq!(decoded(7), since_key(7), "the same frame again");
        assert_eq!(decoded(3), 4, "back");
        assert_eq!(decoded(6), 3, "ahead within the group");
        assert_eq!(decoded(35), since_key(35), "another group");
        assert_eq!(decoded(36), 1);
        assert_eq!(decoded(0), 1);
    }
}

#[test]
fn no_picture_of_the_coarsest_level_is_decoded_twice_when_frames_follow_each_other() {
    let path = flat_pack(Codec::Vp9);
    let file = open(&path);
    let tile = file.pack().grid().tile_at(file.pack().grid().coarsest(), 0);
    let mut pool = DecodePool::new(&file, 1).unwrap();
    // Two turns: the clip loops.
    let frames = (0..2 * FRAMES).map(|frame| frame % FRAMES);
    let decoded: u32 = frames
        .map(|frame| one(&mut pool, &file, tile, frame).frames)
        .sum();
    assert_eq!(decoded, 2 * FRAMES);
}

#[test]
fn decoders_are_handed_on_when_the_gaze_moves_and_pictures_stay_right() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([1600, 64], 4, 3));
    let cut = PrepareSettings {
        cut: Some(Cut::Tile(16)),
        ..settings(ProjectionChoice::Flat, Codec::Vp9)
    };
    let path = prepared(&clip, &cut);
    let file = open(&path);
    let expected = decoded_in_order(&file);
    let mut pool = DecodePool::new(&file, 2).unwrap();
    // Far more tiles than decoders stay open, some at a time.
    let tiles: Vec<Tile> = file.pack().grid().tiles_of(0).collect();
    for (at, few) in tiles.chunks(20).enumerate() {
        let frame = at as u32 % 4;
        few.iter()
            .for_each(|tile| ask(&mut pool, &file, *tile, frame));
        while let Some(done) = pool.receive(None) {
            let (place, picture) = picture(&file, done);
            assert!(picture == expected[&place]);
        }
    }
}

#[test]
fn still_codecs_decode_only_the_frame_that_was_asked_for() {
    for codec in [Codec::Jpeg, Codec::Png] {
        let path = flat_pack(codec);
        let file = open(&path);
        let tile = all_tiles(&file)[0];
        let mut pool = DecodePool::new(&file, 1).unwrap();
        for frame in [5, 7, 7, 3, 36] {
            assert_eq!(one(&mut pool, &file, tile, frame).frames, 1);
        }
    }
}

#[test]
fn cancelling_takes_back_what_was_not_begun() {
    let path = flat_pack(Codec::Vp9);
    let file = open(&path);
    let tiles = all_tiles(&file);
    let mut pool = DecodePool::new(&file, 1).unwrap();
    let mut asked = 0;
    for frame in (0..FRAMES).rev() {
        for tile in &tiles {
            ask(&mut pool, &file, *tile, frame);
            asked += 1;
        }
    }
    pool.cancel();
    let mut came = 0;
    while let Some(done) = pool.receive(None) {
        assert!(done.payload.is_ok());
        came += 1;
    }
    assert!(came < asked, "all {asked} came");
    assert!(pool.receive(None).is_none());
    pool.cancel();
    assert!(one(&mut pool, &file, tiles[0], 9).payload.is_ok());
    assert!(pool.receive(None).is_none());
}

#[test]
fn what_is_not_there_by_the_deadline_comes_later() {
    let path = flat_pack(Codec::Vp9);
    let file = open(&path);
    let tile = all_tiles(&file)[0];
    let mut pool = DecodePool::new(&file, 1).unwrap();
    ask(&mut pool, &file, tile, 7);
    let early = pool.receive(Some(Duration::ZERO));
    let done = early.or_else(|| pool.receive(None)).unwrap();
    assert_eq!(done.piece, piece(&file, tile, 7));
    assert!(pool.receive(None).is_none());
}

/// Writes over some bytes of a tile's first group.
fn damage(path: &Scratch, file: &PackFile, tile: Tile) {
    let entry = file.pack().entry(file.pack().unit(tile, 0));
    let mut writer = OpenOptions::new().write(true).open(&**path).unwrap();
    let middle = entry.offset + u64::from(entry.bytes) / 2;
    writer.seek(SeekFrom::Start(middle)).unwrap();
    writer.write_all(&[0x55; 3]).unwrap();
}

#[test]
fn a_damaged_chunk_is_an_error_for_its_tile_alone() {
    for codec in [Codec::Vp9, Codec::Jpeg, Codec::Png] {
        let path = flat_pack(codec);
        let whole = open(&path);
        let tiles = all_tiles(&whole);
        let bad = tiles[2];
        damage(&path, &whole, bad);
        let file = open(&path);
        let mut pool = DecodePool::new(&file, 2).unwrap();
        for frame in [0, 3, 9] {
            tiles
                .iter()
                .for_each(|tile| ask(&mut pool, &file, *tile, frame));
            let mut came = 0;
            while let Some(done) = pool.receive(None) {
                came += 1;
                let tile = file.pack().tile_of(done.piece.unit.unit);
                let damaged = tile == bad && frame < 8;
                match done.payload {
                    Ok(_) => assert!(!damaged, "{codec:?} frame {frame}"),
                    Err(DecodeError::Damaged(error)) => {
                        assert!(damaged, "{tile:?} frame {frame}: {error}");
                        let cause = error.source().map(ToString::to_string).unwrap();
                        assert!(cause.contains("chunk of level 0"), "{cause}");
                    }
                    Err(wrong) => panic!("{wrong:?}"),
                }
            }
            assert_eq!(came, tiles.len());
        }
    }
}

/// What was asked for and what may still come, as an observer of a pool knows it.
#[derive(Default)]
struct Ledger {
    owed: HashSet<Piece>,
    /// Cancelled: comes if a worker had begun with it.
    cancelled: HashSet<Piece>,
}

impl Ledger {
    fn came(&mut self, done: &Decoded) {
        let was_asked = self.owed.remove(&done.piece) || self.cancelled.remove(&done.piece);
        assert!(was_asked, "{:?} came twice or unasked", done.piece);
    }
}

#[test]
fn sixteen_workers_answer_every_order_once_and_as_one_does() {
    let path = flat_pack(Codec::Vp9);
    let whole = open(&path);
    let (expected, tiles) = (decoded_in_order(&whole), all_tiles(&whole));
    let coarsest = whole.pack().grid().coarsest();
    let bad = [tiles[1], tiles[4]];
    bad.iter().for_each(|tile| damage(&path, &whole, *tile));
    let file = open(&path);
    let with_bytes = |tile: Tile, frame: u32| {
        let piece = piece(&file, tile, frame);
        (piece, bytes(&file).of(piece.unit.unit))
    };
    let check = |ledger: &mut Ledger, done: Decoded| {
        ledger.came(&done);
        let frame = done.piece.frame;
        let tile = file.pack().tile_of(done.piece.unit.unit);
        match done.payload {
            Ok(Payload::Picture(picture)) => assert!(picture == expected[&(tile, frame)]),
            Err(DecodeError::Damaged(_)) => assert!(bad.contains(&tile) && frame < 8, "{tile:?}"),
            other => panic!("{tile:?} of frame {frame}: {other:?}"),
        }
    };
    let mut pool = DecodePool::new(&file, 16).unwrap();
    let (mut ledger, mut state, mut frame) = (Ledger::default(), 7, 0);
    for _ in 0..300 {
        // Frames mostly follow each other.
        frame = match random(&mut state, 8) {
            0 => random(&mut state, FRAMES as usize) as u32,
            _ => (frame + 1) % FRAMES,
        };
        let some = (0..1 + random(&mut state, 12)).map(|_| tiles[random(&mut state, tiles.len())]);
        let asked: Vec<_> = some.map(|tile| with_bytes(tile, frame)).collect();
        for (piece, _) in &asked {
            ledger.cancelled.remove(piece);
            ledger.owed.insert(*piece);
        }
        pool.request(asked);
        let base = tiles.iter().filter(|tile| tile.level == coarsest);
        let next = base.map(|tile| with_bytes(*tile, (frame + 1) % FRAMES));
        pool.expect(next.collect());
        match random(&mut state, 4) {
            0 => pool.wait_for_all(Some(Duration::ZERO)),
            1 => pool.wait_for_all(None),
            2 => {
                pool.cancel();
                let owed = ledger.owed.drain();
                ledger.cancelled.extend(owed);
            }
            _ => {}
        }
        for _ in 0..random(&mut state, 12) {
            let patience = (random(&mut state, 2) == 0).then_some(Duration::ZERO);
            if let Some(done) = pool.receive(patience) {
                check(&mut ledger, done);
            }
        }
    }
    while let Some(done) = pool.receive(None) {
        check(&mut ledger, done);
    }
    assert!(ledger.owed.is_empty(), "{:?} never came", ledger.owed);
}

#[test]
fn when_all_are_waited_for_all_are_there() {
    let path = flat_pack(Codec::Vp9);
    let file = open(&path);
    let tiles = all_tiles(&file);
    let mut pool = DecodePool::new(&file, 3).unwrap();
    pool.wait_for_all(None);
    for frame in [4, 5, 20] {
        tiles
            .iter()
            .for_each(|tile| ask(&mut pool, &file, *tile, frame));
        pool.wait_for_all(None);
        let came = std::iter::from_fn(|| pool.receive(Some(Duration::ZERO)));
        assert_eq!(came.count(), tiles.len());
    }
}

#[test]
fn a_pool_dropped_with_work_queued_ends() {
    let path = flat_pack(Codec::Vp9);
    let file = open(&path);
    let (ended, wait) = channel();
    std::thread::spawn(move || {
        for workers in [1, 4, 16] {
            let mut pool = DecodePool::new(&file, workers).unwrap();
            for tile in all_tiles(&file) {
                (0..FRAMES).for_each(|frame| ask(&mut pool, &file, tile, frame));
            }
            drop(pool);
        }
        ended.send(()).unwrap();
    });
    let patience = Duration::from_secs(60);
    assert!(wait.recv_timeout(patience).is_ok(), "still not ended");
}
