//! Does preparing note every unit in the side tables, the same for any number of jobs?

use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile};
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::cues::Cues;
use foveal_core::perception::measures::signature::{LumaPlane, StepMeter};
use foveal_core::view::picture::{Picture, plane_size};
use std::ops::Range;
use std::path::Path;

use crate::ClipCodec;
use crate::pack::pack_file::PackFile;
use crate::prepare::{PrepareSettings, ProjectionChoice};
use crate::tests::scenes::{Scratch, group, prepared, settings, write_clip};
use crate::tiles::decode::GroupDecoder;

/// A picture whose left part is plain and whose right part is noise; the noise of its lower half
/// changes from frame to frame.
fn half_busy(size: [u32; 2], plain: u32, frame: u32) -> Picture {
    let planes = [0, 1, 2].map(|p| {
        let [w, h] = plane_size(size[0], size[1], p);
        let sample = move |x: u32, y: u32| {
            if p > 0 || x < plain {
                return 128;
            }
            let turn = if y < h / 2 { 0 } else { frame };
            let mut state = u64::from(x) << 32 | u64::from(y) << 12 | u64::from(turn);
            for _ in 0..3 {
                state = (state ^ state >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            }
            64 + (state >> 57) as u8
        };
        let row = move |y| (0..w).map(move |x| sample(x, y));
        (0..h).flat_map(row).collect()
    });
    Picture {
        width: size[0],
        height: size[1],
        planes,
    }
}

fn table_bytes<'a>(file: &PackFile, pack: &'a [u8], name: &str) -> &'a [u8] {
    let tables = &file.pack().description().tables;
    let table = tables.iter().find(|table| table.name == name).unwrap();
    &pack[table.offset as usize..][..table.bytes as usize]
}

/// Whether every unit has the rows that it must have, and no other.
fn assert_every_unit_is_noted(path: &Path, what: &str) {
    let file = PackFile::open(path).unwrap();
    assert!(file.verify(|_, _| {}).is_empty(), "{what}");
    let (signatures, cues) = (
        file.signatures().unwrap().unwrap(),
        file.cues().unwrap().unwrap(),
    );
    let (pack, bytes) = (file.pack(), std::fs::read(path).unwrap());
    let coarsest = pack.grid().coarsest();
    let (mut refining, mut finest) = (0, 0);
    for unit in pack.units() {
        let level = pack.tile_of(unit).level;
        assert_eq!(
            signatures.of(unit).is_some(),
            level < coarsest,
            "{what}: {unit:?}"
        );
        assert_eq!(cues.of(unit).is_some(), level == 0, "{what}: {unit:?}");
        refining += usize::from(level < coarsest);
        finest += usize::from(level == 0);
    }
    let lengths = ["signatures", "cues"].map(|name| table_bytes(&file, &bytes, name).len());
    assert_eq!(
        lengths,
        [refining * Signature::BYTES, finest * Cues::BYTES],
        "{what}"
    );
}

#[test]
fn every_unit_of_every_cut_and_codec_is_noted() {
    // 13 frames: the last group of each level is short.
    let flat = write_clip("mkv", ClipCodec::Ffv1, &group([101, 67], 13, 3));
    let sphere = write_clip("mkv", ClipCodec::Ffv1, &group([128, 64], 13, 4));
    let cuts = [
        (Cut::Tile(32), None, 2),
        (Cut::Tile(18), Some(1), 2),
        (Cut::Grid([3, 2]), Some(2), 4),
    ];
    let codecs = [Codec::Vp9, Codec::Jpeg, Codec::Png];
    let noted = |clip: &Path, projection, (cut, levels, ratio), codec| {
        let settings = PrepareSettings {
            cut: Some(cut),
            levels,
            ratio,
            ..settings(projection, codec)
        };
        let what = format!("{projection:?} {cut:?} {codec:?}");
        assert_every_unit_is_noted(&prepared(clip, &settings), &what);
    };
    for (cut, codec) in cuts.into_iter().zip(codecs) {
        noted(&sphere, ProjectionChoice::Equirect, cut, codec);
        for codec in codecs {
            noted(&flat, ProjectionChoice::Flat, cut, codec);
        }
    }
}

#[test]
fn the_tables_are_the_same_bytes_for_any_number_of_jobs() {
    let pictures: Vec<Picture> = (0..19).map(|f| half_busy([150, 90], 64, f)).collect();
    let clip = write_clip("mkv", ClipCodec::Ffv1, &pictures);
    let tables = |jobs, codec| {
        let settings = PrepareSettings {
            jobs,
            ..settings(ProjectionChoice::Flat, codec)
        };
        let path = prepared(&clip, &settings);
        let (file, bytes) = (
            PackFile::open(&path).unwrap(),
            std::fs::read(&*path).unwrap(),
        );
        ["signatures", "cues"].map(|name| table_bytes(&file, &bytes, name).to_vec())
    };
    let [lossless, coded] = [Codec::Png, Codec::Vp9].map(|codec| tables(1, codec));
    for jobs in [2, 8] {
        assert_eq!(tables(jobs, Codec::Png), lossless, "{jobs} jobs");
        assert_eq!(tables(jobs, Codec::Vp9), coded, "{jobs} jobs");
    }
    // Signatures describe what is decoded, cues what was coded.
    assert_ne!(coded[0], lossless[0]);
    assert_eq!(coded[1], lossless[1]);
}

#[test]
fn plain_tiles_add_nothing_and_busy_ones_do_and_only_what_moves_changes() {
    let pictures: Vec<Picture> = (0..9).map(|f| half_busy([128, 128], 64, f)).collect();
    let clip = write_clip("mkv", ClipCodec::Ffv1, &pictures);
    let path = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Vp9));
    let file = PackFile::open(&path).unwrap();
    let (signatures, cues) = (
        file.signatures().unwrap().unwrap(),
        file.cues().unwrap().unwrap(),
    );
    let pack = file.pack();
    for unit in pack.units().filter(|unit| pack.tile_of(*unit).level == 0) {
        let tile = pack.tile_of(unit);
        let (signature, cues) = (signatures.of(unit).unwrap(), cues.of(unit).unwrap());
        let added = signature.bands[0].difference;
        if tile.x < 2 {
            assert_eq!(cues, Cues::default());
        }
        if tile.x < 1 {
            assert_eq!(signature, Signature::default());
        }
        if tile.x < 2 {
            continue;
        }
        assert!(added > 0.1, "{tile:?}: {signature:?}");
        assert!(
            cues.deviation > 20.0 && cues.edges > 5.0,
            "{tile:?}: {cues:?}"
        );
        let moves = tile.y >= 2 && pack.frames_of(unit).len() > 1;
        assert_eq!(cues.change > 10.0, moves, "{tile:?}: {cues:?}");
        let expected = measured(&file, tile, pack.frames_of(unit)).to_bytes();
        assert_eq!(signature.to_bytes(), expected, "{tile:?}");
    }
}

/// The luma of a tile in some frames of its group, as it is decoded.
fn decoded(file: &PackFile, tile: Tile, frames: Range<u32>) -> Vec<Vec<u8>> {
    let pack = file.pack();
    let unit = pack.unit(tile, frames.start);
    let of_unit = pack.frames_of(unit);
    let chunk = file.read_chunk(unit).unwrap();
    let units = split_chunk(&chunk, of_unit.len()).unwrap();
    let size = pack.grid().tile_size(tile);
    let mut decoder = GroupDecoder::new(pack.description().codec, size).unwrap();
    let all = of_unit.zip(units).map(|(frame, unit)| {
        let (picture, _) = decoder.decode(unit, 0).unwrap();
        (frame, picture.planes[0].clone())
    });
    let all: Vec<(u32, Vec<u8>)> = all.collect();
    let wanted = all.into_iter().filter(|(frame, _)| frames.contains(frame));
    wanted.map(|(_, luma)| luma).collect()
}

/// The definition: a unit against the unit under it, in the frames that count.
fn measured(file: &PackFile, tile: Tile, frames: Range<u32>) -> Signature {
    let (grid, about) = (file.pack().grid(), file.pack().description());
    let under = grid.tile_over(tile, tile.level + 1);
    let (from, to) = (grid.origin(under), grid.origin(tile));
    let at = [0, 1].map(|k| (to[k] - from[k]) / grid.scale(tile.level));
    let meter = StepMeter::new(about.colour, grid.ratio);
    let [fine, coarse] = [tile, under].map(|tile| decoded(file, tile, frames.clone()));
    let count = fine.len();
    let all = fine.iter().zip(&coarse).enumerate();
    let counted = all.filter(|(frame, _)| frame % 2 == 0 || frame + 1 == count);
    let steps = counted.map(|(_, (fine, coarse))| {
        let [fine, coarse] = [(fine, tile), (coarse, under)].map(|(codes, tile)| LumaPlane {
            codes,
            size: grid.tile_size(tile),
        });
        meter.signature(coarse, fine, at)
    });
    steps.fold(Signature::default(), Signature::strongest)
}

#[test]
fn every_signature_is_of_what_is_decoded_against_the_level_under_it() {
    // 45 frames: the coarsest level has a full group and one of 13, the others a last one of 5.
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([101, 67], 45, 3));
    for (cut, ratio) in [
        (Cut::Tile(18), 4),
        (Cut::Tile(32), 2),
        (Cut::Grid([3, 2]), 2),
    ] {
        let how = PrepareSettings {
            cut: Some(cut),
            levels: Some(3),
            ratio,
            jobs: 2,
            ..settings(ProjectionChoice::Flat, Codec::Vp9)
        };
        let path = prepared(&clip, &how);
        let file = PackFile::open(&path).unwrap();
        let signatures = file.signatures().unwrap().unwrap();
        let pack = file.pack();
        let refining = pack
            .units()
            .filter(|unit| *unit >= pack.first_refining_unit());
        for unit in refining {
            let (tile, frames) = (pack.tile_of(unit), pack.frames_of(unit));
            let expected = measured(&file, tile, frames.clone()).to_bytes();
            let found = signatures.of(unit).unwrap().to_bytes();
            assert_eq!(found, expected, "{cut:?} {tile:?} {frames:?}");
        }
    }
}

/// Grey, with a small bright square in a tile from frame `from` on.
fn entered(from: u32, frame: u32) -> Picture {
    let mut picture = Picture::filled(128, 128, [60, 128, 128]);
    if frame >= from {
        for y in 80..86 {
            picture.planes[0][y * 128 + 74..][..6].fill(200);
        }
    }
    picture
}

#[test]
fn what_enters_a_tile_in_the_middle_of_a_group_is_told_as_if_it_had_been_there_at_first() {
    let norm = |from: u32| {
        let pictures: Vec<Picture> = (0..8).map(|frame| entered(from, frame)).collect();
        let clip = write_clip("mkv", ClipCodec::Ffv1, &pictures);
        let path = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Vp9));
        let file = PackFile::open(&path).unwrap();
        let unit = file
            .pack()
            .unit(file.pack().grid().cell_at(0, [77.0, 83.0]), 0);
        let signature = file.signatures().unwrap().unwrap().of(unit).unwrap();
        signature.bands[0].norm
    };
    let [there, never] = [norm(0), norm(8)];
    assert!(there > 0.05 && never < 0.1 * there, "{there} {never}");
    for from in 1..8 {
        let late = norm(from);
        assert!(
            (0.8..1.25).contains(&(late / there)),
            "{from}: {late} {there}"
        );
    }
}

#[test]
fn a_damaged_side_table_is_named_once() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 9, 6));
    let path = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Png));
    let good = std::fs::read(&*path).unwrap();
    let tables = PackFile::open(&path)
        .unwrap()
        .pack()
        .description()
        .tables
        .clone();
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!(names, ["frame_times", "signatures", "cues"]);
    for table in &tables {
        for place in [0, table.bytes / 2, table.bytes - 1] {
            let mut bad = good.clone();
            bad[(table.offset + place) as usize] ^= 0x10;
            let bad = Scratch::holding("foveal", &bad);
            let file = PackFile::open(&bad).unwrap();
            let damage: Vec<String> = file
                .verify(|_, _| {})
                .first()
                .iter()
                .map(|d| d.to_string())
                .collect();
            let [said] = &damage[..] else {
                panic!("{}: {damage:?}", table.name);
            };
            assert!(
                said.contains(&format!("side table {}", table.name)),
                "{said}"
            );
            assert_eq!(file.signatures().is_err(), table.name == "signatures");
            assert_eq!(file.cues().is_err(), table.name == "cues");
        }
    }
}
