//! Is a pack what its plan says: the same bytes each time, in order, whole, or not there at all?

use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::pack::order::hilbert_distance;
use foveal_core::pack::{HEADER_BYTES, Header};
use foveal_core::session::log::sha256_hex;
use std::fs::OpenOptions;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use crate::pack::pack_file::{PackFile, partial_path};
use crate::prepare::{PrepareError, PrepareSettings, ProjectionChoice, rehearse};
use crate::tests::scenes::{Scratch, VIDEO, group, plan_of, prepared, settings, write_clip};
use crate::tiles::encode_settings::Speed;
use crate::{ClipCodec, ClipFormat, ClipWriter};

fn bytes_of(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

/// A clip of a few periods of the coarsest level, the last one short.
fn flat_clip() -> Scratch {
    write_clip("mkv", ClipCodec::Ffv1, &group([150, 90], 37, 3))
}

fn sphere_clip() -> Scratch {
    write_clip("mkv", ClipCodec::Ffv1, &group([192, 96], 11, 4))
}

#[test]
fn a_pack_is_the_same_bytes_for_any_number_of_jobs_and_every_run() {
    for (clip, projection) in [
        (flat_clip(), ProjectionChoice::Flat),
        (sphere_clip(), ProjectionChoice::Equirect),
    ] {
        for codec in [Codec::Vp9, Codec::Jpeg, Codec::Png] {
            let with_jobs = |jobs| PrepareSettings {
                jobs,
                ..settings(projection, codec)
            };
            let first = bytes_of(&prepared(&clip, &with_jobs(1)));
            for jobs in [1, 2, 5] {
                let again = bytes_of(&prepared(&clip, &with_jobs(jobs)));
                assert!(again == first, "{projection:?} {codec:?}: {jobs} jobs");
            }
        }
    }
}

#[test]
fn a_small_pack_takes_its_time_at_every_level_but_the_second() {
    let clip = flat_clip();
    let of_speed = |speed| {
        let settings = PrepareSettings {
            speed,
            ..settings(ProjectionChoice::Flat, Codec::Vp9)
        };
        prepared(&clip, &settings)
    };
    let packs = [Speed::Default, Speed::Small].map(of_speed);
    let files = packs.each_ref().map(|path| PackFile::open(path).unwrap());
    for level in 0..3 {
        let [default, small] = files.each_ref().map(|file| {
            let units = file.pack().units();
            let of_level = units.filter(|unit| file.pack().tile_of(*unit).level == level);
            of_level
                .map(|unit| file.read_chunk(unit).unwrap())
                .collect::<Vec<_>>()
        });
        assert_eq!(default == small, level == 1, "level {level}");
    }
}

#[test]
fn chunks_lie_by_time_then_from_coarse_to_fine_then_along_the_hilbert_curve() {
    for (clip, projection) in [
        (flat_clip(), ProjectionChoice::Flat),
        (sphere_clip(), ProjectionChoice::Equirect),
    ] {
        let path = prepared(&clip, &settings(projection, Codec::Vp9));
        let file = PackFile::open(&path).unwrap();
        let pack = file.pack();
        let mut units: Vec<_> = pack.units().collect();
        units.sort_by_key(|unit| pack.entry(*unit).offset);
        let first = units[0];
        assert_eq!(pack.tile_of(first).level, pack.grid().coarsest());
        let head = bytes_of(&path);
        let description = u32::from_le_bytes(head[12..16].try_into().unwrap());
        let after_description = HEADER_BYTES as u64 + u64::from(description);
        assert_eq!(pack.entry(first).offset, after_description);
        let place = |unit| {
            let tile = pack.tile_of(unit);
            let side = pack.grid().tiles(tile.level).into_iter().max().unwrap();
            let along = hilbert_distance(side, [tile.x, tile.y].map(u32::from));
            let coarseness = u8::MAX - tile.level;
            (pack.frames_of(unit).start, coarseness, tile.face, along)
        };
        let places: Vec<_> = units.iter().map(|unit| place(*unit)).collect();
        assert!(places.is_sorted(), "{projection:?}");
        for pair in units.windows(2) {
            let [before, after] = [pair[0], pair[1]].map(|unit| pack.entry(unit));
            assert_eq!(before.offset + u64::from(before.bytes), after.offset);
        }
    }
}

#[test]
fn every_frame_of_a_clip_of_variable_rate_keeps_its_time() {
    let ticks = [0, 1, 2, 5, 6, 20, 21, 23];
    let pictures = group([48, 32], ticks.len() as u32, 5);
    let clip = Scratch::new("mkv");
    let format = ClipFormat {
        codec: ClipCodec::Ffv1,
        size: [48, 32],
        frame_rate: [50, 1],
        colour: VIDEO,
    };
    let mut writer = ClipWriter::create(&clip, &format).unwrap();
    for (picture, tick) in pictures.iter().zip(ticks) {
        writer.push_at(picture, tick).unwrap();
    }
    writer.finish().unwrap();
    let pack = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Png));
    let times = PackFile::open(&pack).unwrap().frame_times().unwrap();
    let expected = ticks.map(|tick| tick as i64 * 20_000_000);
    assert_eq!(times, expected);
}

#[test]
fn the_bytes_of_a_lossless_pack_are_what_they_always_were() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([200, 136], 10, 6));
    let path = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Png));
    let bytes = bytes_of(&path);
    let header = Header::parse(&bytes).unwrap();
    let data = header.data_offset() as usize;
    // What the clip was called, how large it was and when it was written is its writer's affair.
    let json = std::str::from_utf8(&bytes[HEADER_BYTES..data]).unwrap();
    let without = |json: &str, key: &str| {
        let (before, rest) = json.split_once(&format!("\"{key}\":{{")).unwrap();
        let (_, after) = rest.split_once('}').unwrap();
        format!("{before}{after}")
    };
    let json = without(&without(json.trim_end(), "source"), "identity");
    // Remarks are words for people, and may change.
    let told = "\"remarks\":[\"it has no sound\"],";
    assert!(json.contains(told), "{json}");
    let json = json.replace(told, "");
    let hashed = [json.as_bytes(), &bytes[data..]].concat();
    let expected = "749d09e4e9398b3c88006b768c87d644b341d9757ab12ab0eef0146d93820872";
    assert_eq!(sha256_hex(&hashed), expected);
}

#[test]
fn every_flipped_byte_of_a_pack_is_found() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 2, 6));
    let path = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Vp9));
    let whole = PackFile::open(&path).unwrap();
    assert!(whole.verify(|_, _| {}).is_empty());
    let good = bytes_of(&path);
    let mut file = OpenOptions::new().write(true).open(&*path).unwrap();
    let mut write = |place: usize, byte: u8| {
        file.seek(SeekFrom::Start(place as u64)).unwrap();
        file.write_all(&[byte]).unwrap();
    };
    for (place, byte) in good.iter().enumerate() {
        write(place, byte ^ (1 << (place % 8)));
        let found = match PackFile::open(&path) {
            Ok(file) => file.verify(|_, _| {}).places(),
            Err(_) => 1,
        };
        assert!(found > 0, "byte {place} of {}", good.len());
        write(place, *byte);
    }
    assert_eq!(bytes_of(&path), good);
}

#[test]
fn a_pack_cut_short_or_with_something_added_is_refused() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 2, 6));
    let path = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Vp9));
    let good = bytes_of(&path);
    for length in [0, 1, 63, 64, 65, 4095, 4096, good.len() / 2, good.len() - 1] {
        let cut = Scratch::holding("foveal", &good[..length]);
        let error = PackFile::open(&cut).unwrap_err().to_string();
        assert!(error.contains(cut.to_str().unwrap()), "{length}: {error}");
    }
    let longer = Scratch::holding("foveal", &[&good[..], &[0]].concat());
    let error = PackFile::open(&longer).unwrap_err().to_string();
    assert!(error.contains("something added"), "{error}");
    let folder = PackFile::open(&std::env::temp_dir()).unwrap_err();
    assert!(folder.to_string().contains("is a folder"), "{folder}");
}

#[test]
fn a_preparation_that_fails_leaves_what_was_there_and_nothing_else() {
    let clip = flat_clip();
    let whole = bytes_of(&clip);
    let cut = Scratch::holding("mkv", &whole[..whole.len() * 2 / 3]);
    let settings = PrepareSettings {
        strict: true,
        ..settings(ProjectionChoice::Flat, Codec::Vp9)
    };
    let plan = plan_of(&cut, &settings).unwrap();
    let out = Scratch::new("foveal");
    let refuse = |when: &str| {
        let error = crate::prepare::prepare(&cut, &out, &plan, &mut |_| {}).unwrap_err();
        assert!(matches!(error, PrepareError::Media(_)), "{when}: {error}");
        let text = error.to_string();
        assert!(
            text.contains(cut.to_str().unwrap()) && text.contains("frame"),
            "{text}"
        );
        assert!(!partial_path(&out).exists(), "{when}");
    };
    refuse("nothing there");
    assert!(!out.exists());
    std::fs::write(&*out, b"before").unwrap();
    refuse("something there");
    assert_eq!(bytes_of(&out), b"before");
}

/// Prepares a clip to `out` while `there` lies where the pack grows.
#[cfg(unix)]
fn prepare_over(out: &Path, there: &dyn Fn(&Path)) -> Result<(), PrepareError> {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 2, 6));
    let plan = plan_of(&clip, &settings(ProjectionChoice::Flat, Codec::Png)).unwrap();
    there(&partial_path(out));
    crate::prepare::prepare(&clip, out, &plan, &mut |_| {}).map(|_| ())
}

#[cfg(unix)]
#[test]
fn what_lies_where_a_pack_grows_is_never_written_through() {
    let precious = Scratch::holding("txt", b"precious");
    let out = Scratch::new("foveal");
    let partial = partial_path(&out);
    let link = |at: &Path| std::os::unix::fs::symlink(&*precious, at).unwrap();
    let hard_link = |at: &Path| std::fs::hard_link(&*precious, at).unwrap();
    let own = |at: &Path| std::fs::write(at, b"mine").unwrap();
    for there in [&link as &dyn Fn(&Path), &hard_link, &own] {
        let error = prepare_over(&out, there).unwrap_err().to_string();
        assert!(error.contains("in the way"), "{error}");
        assert_eq!(bytes_of(&precious), b"precious");
        assert!(partial.symlink_metadata().is_ok() && !out.exists());
        std::fs::remove_file(&partial).unwrap();
    }
    let killed = |at: &Path| std::fs::write(at, [0; 5000]).unwrap();
    prepare_over(&out, &killed).unwrap();
    assert!(out.exists() && !partial.exists());
}

#[test]
fn a_pack_replaces_only_plain_files() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 2, 6));
    let plan = plan_of(&clip, &settings(ProjectionChoice::Flat, Codec::Png)).unwrap();
    let folder = Scratch::new("foveal");
    std::fs::create_dir(&*folder).unwrap();
    let missing = folder.join("no such folder").join("a.foveal");
    let other = "choose another --out";
    for (out, next) in [
        (&*folder, other),
        (missing.as_path(), "no such folder first"),
        (Path::new("/dev/null"), other),
    ] {
        let error = crate::prepare::prepare(&clip, out, &plan, &mut |_| {}).unwrap_err();
        let text = error.to_string();
        assert!(text.contains(out.to_str().unwrap()), "{text}");
        assert!(text.contains(next), "{text}");
        assert!(!partial_path(out).exists());
    }
    std::fs::remove_dir(&*folder).unwrap();
    let mut null = std::fs::File::open("/dev/null").unwrap();
    assert_eq!(null.read(&mut [0]).unwrap(), 0);
}

#[test]
fn a_rehearsal_costs_as_many_bytes_as_the_pack_holds() {
    let clip = flat_clip();
    let plan = plan_of(&clip, &settings(ProjectionChoice::Flat, Codec::Vp9)).unwrap();
    let (frames, bytes) = rehearse(&clip, &plan, 100).unwrap();
    assert_eq!(frames, 37);
    let path = prepared(&clip, &settings(ProjectionChoice::Flat, Codec::Vp9));
    let levels = PackFile::open(&path)
        .unwrap()
        .pack()
        .index()
        .bytes_per_level();
    assert_eq!(bytes, levels.iter().sum::<u64>());
    assert_eq!(rehearse(&clip, &plan, 8).unwrap().0, 8);
}

#[test]
fn a_grid_and_a_pyramid_hold_every_frame_of_every_tile_once() {
    let clip = flat_clip();
    for cut in [Cut::Tile(32), Cut::Grid([3, 2])] {
        let settings = PrepareSettings {
            cut: Some(cut),
            ..settings(ProjectionChoice::Flat, Codec::Png)
        };
        let path = prepared(&clip, &settings);
        let file = PackFile::open(&path).unwrap();
        let (pack, grid) = (file.pack(), file.pack().grid());
        assert_eq!(pack.description().frames, 37);
        for level in 0..grid.levels {
            let mut frames = vec![0; grid.tiles_in_level(level) as usize];
            for unit in pack.units() {
                let tile = pack.tile_of(unit);
                if tile.level == level {
                    frames[grid.rank(tile) as usize] += pack.frames_of(unit).len();
                }
            }
            assert!(frames.iter().all(|count| *count == 37), "{cut:?}");
        }
    }
}
