//! Does a preparation that is stopped anywhere end with the bytes of one that was not?

use crate::ClipCodec;
use crate::pack::journal_file::journal_path;
use crate::pack::name_claim::{IfTaken, NameClaim};
use crate::pack::pack_file::{PackFile, partial_path};
use crate::prepare::{
    Event, PrepareError, PrepareSettings, ProjectionChoice, Witness, prepare_resumable,
};
use crate::tests::scenes::{Scratch, group, plan_of, prepared, settings, write_clip};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::description::Loss;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Two whole periods of 32 frames, and a group and a half.
const FRAMES: u32 = 76;

fn clip() -> Scratch {
    write_clip("mkv", ClipCodec::Ffv1, &group([96, 64], FRAMES, 6))
}

fn how() -> PrepareSettings {
    settings(ProjectionChoice::Flat, Codec::Vp9)
}

fn claimed(out: &Path) -> NameClaim {
    NameClaim::of(out, IfTaken::Replace).unwrap()
}

/// Prepares until `stop` frames are coded; returns what it reported, and whether it came to the
/// end.
fn run(
    clip: &Path,
    out: &Path,
    settings: &PrepareSettings,
    go_on: bool,
    stop: u32,
) -> (Vec<String>, bool) {
    let plan = plan_of(clip, settings).unwrap();
    let mut notes = Vec::new();
    let ended = catch_unwind(AssertUnwindSafe(|| {
        let mut tell = |event: Event| match event {
            Event::Begins(note) => notes.push(note),
            Event::Progress(progress) => assert!(progress.frames < stop, "stopped"),
        };
        prepare_resumable(clip, claimed(out), &plan, go_on, &mut tell)
    }));
    let ended = ended.is_ok_and(|ended| {
        ended.unwrap();
        true
    });
    (notes, ended)
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

fn nothing_left(out: &Path) -> bool {
    let partial = partial_path(out);
    !partial.exists() && !journal_path(&partial).exists()
}

#[test]
fn wherever_it_stops_the_pack_ends_the_same() {
    let clip = clip();
    let whole = bytes(&prepared(&clip, &how()));
    for stops in [&[5][..], &[32], &[33], &[40, 70], &[64, 64, 65], &[76]] {
        let out = Scratch::new("foveal");
        let mut before = 0;
        for stop in stops {
            let (notes, ended) = run(&clip, &out, &how(), true, *stop);
            assert!(!ended && !out.exists(), "{stop}");
            assert_eq!(notes.is_empty(), before < 32, "{notes:?}");
            before = *stop;
        }
        let (notes, ended) = run(&clip, &out, &how(), true, u32::MAX);
        assert!(ended && nothing_left(&out));
        assert_eq!(bytes(&out), whole, "{stops:?}");
        // A stop is noticed once a frame is coded, and its step is written before that.
        let coded = (before / 32 * 32).min(64);
        let wanted = format!("goes on after {coded} frames coded before");
        assert_eq!(notes, if coded > 0 { vec![wanted] } else { Vec::new() });
    }
}

#[test]
fn torn_and_damaged_ends_are_coded_again() {
    let clip = clip();
    let whole = bytes(&prepared(&clip, &how()));
    let out = Scratch::new("foveal");
    let partial = partial_path(&out);
    let journal = journal_path(&partial);
    run(&clip, &out, &how(), true, 70);
    let (good_partial, good_journal) = (bytes(&partial), bytes(&journal));
    let middle = |bytes: &[u8]| bytes.len() / 2;
    let flip = |bytes: &[u8], at: usize| {
        let mut bad = bytes.to_vec();
        bad[at] ^= 1;
        bad
    };
    let [p, j] = [&good_partial, &good_journal];
    for (what, partial_bytes, journal_bytes) in [
        ("torn journal", p.clone(), j[..j.len() - 3].to_vec()),
        ("damaged journal", p.clone(), flip(j, j.len() - 3)),
        ("damaged identity", p.clone(), flip(j, 20)),
        ("empty journal", p.clone(), Vec::new()),
        ("torn pack", p[..middle(p)].to_vec(), j.clone()),
        ("damaged pack", flip(p, middle(p)), j.clone()),
        (
            "more than was noted",
            [&p[..], &[7; 99]].concat(),
            j.clone(),
        ),
    ] {
        std::fs::write(&partial, partial_bytes).unwrap();
        std::fs::write(&journal, journal_bytes).unwrap();
        let (notes, ended) = run(&clip, &out, &how(), true, u32::MAX);
        assert!(ended && nothing_left(&out), "{what}");
        assert_eq!(notes.len(), 1, "{what}");
        assert_eq!(bytes(&out), whole, "{what}: {notes:?}");
    }
}

#[test]
fn what_differs_is_named_and_started_over() {
    let clip = clip();
    let out = Scratch::new("foveal");
    let other = PrepareSettings {
        codec: Codec::Png,
        ..how()
    };
    let begun = || {
        run(&clip, &out, &how(), false, 40);
        assert!(journal_path(&partial_path(&out)).exists());
    };
    let says = |settings: &PrepareSettings, go_on: bool, word: &str| {
        let (notes, ended) = run(&clip, &out, settings, go_on, u32::MAX);
        assert!(ended && nothing_left(&out));
        assert!(
            notes[0].contains("starting over") && notes[0].contains(word),
            "{notes:?}"
        );
        assert_eq!(bytes(&out), bytes(&prepared(&clip, settings)));
    };
    begun();
    says(&other, true, "other settings");
    begun();
    says(&how(), false, "--no-resume");
    begun();
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(9);
    let file = std::fs::File::options().write(true).open(&*clip).unwrap();
    file.set_modified(later).unwrap();
    says(&how(), true, "the input has changed");
    // More threads are no other settings.
    begun();
    let (notes, _) = run(
        &clip,
        &out,
        &PrepareSettings { jobs: 1, ..how() },
        true,
        u32::MAX,
    );
    assert!(notes[0].contains("goes on"), "{notes:?}");
    assert_eq!(bytes(&out), bytes(&prepared(&clip, &how())));
}

#[test]
fn a_file_that_takes_the_name_meanwhile_stays() {
    let clip = clip();
    let out = Scratch::new("foveal");
    let plan = plan_of(&clip, &how()).unwrap();
    let mut tell = |_: Event| std::fs::write(&*out, "precious").unwrap();
    let error = prepare_resumable(&clip, claimed(&out), &plan, true, &mut tell).unwrap_err();
    assert!(format!("{error}").contains("meanwhile"), "{error}");
    assert_eq!(bytes(&out), b"precious");
}

#[test]
fn an_input_that_changes_while_it_is_read_is_an_error() {
    let clip = clip();
    let out = Scratch::new("foveal");
    let plan = plan_of(&clip, &how()).unwrap();
    let mut grown = false;
    let mut tell = |_: Event| {
        if !grown {
            use std::io::Write;
            let file = std::fs::File::options().append(true).open(&*clip);
            file.unwrap().write_all(b"more").unwrap();
            grown = true;
        }
    };
    let error = prepare_resumable(&clip, claimed(&out), &plan, true, &mut tell).unwrap_err();
    assert!(matches!(error, PrepareError::Changed(_)), "{error}");
    assert!(
        error.to_string().contains("changed while it was read"),
        "{error}"
    );
    assert!(!out.exists());
}

/// A disk that keeps something else than was written.
struct BadDisk;

impl Witness for BadDisk {
    fn tell(&mut self, _: Event) {}

    fn loss_of(&mut self, pack: &Path) -> Option<Loss> {
        let mut kept = bytes(pack);
        let middle = kept.len() / 2;
        kept[middle] ^= 1;
        std::fs::write(pack, kept).unwrap();
        None
    }
}

#[test]
fn a_pack_that_cannot_be_read_back_gets_no_name() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([96, 64], 8, 6));
    let out = Scratch::new("foveal");
    let plan = plan_of(&clip, &how()).unwrap();
    let prepare =
        |witness: &mut dyn Witness| prepare_resumable(&clip, claimed(&out), &plan, true, witness);
    let told = prepare(&mut BadDisk).unwrap_err().to_string();
    assert!(told.contains("cannot be read back"), "{told}");
    assert!(!out.exists());
    // What of it is good is found again, and what is not is coded again.
    prepare(&mut |_: Event| ()).unwrap();
    assert!(PackFile::open(&out).unwrap().verify(|_, _| ()).is_empty());
    assert!(nothing_left(&out));
}

/// A guide that is shown the whole pack, and says what was lost unless stopped.
struct Judge {
    stops: bool,
}

const LOSS: Loss = Loss {
    psnr_db: Some(40.25),
    jod: 9.5,
};

impl Witness for Judge {
    fn tell(&mut self, _: Event) {}

    fn loss_of(&mut self, pack: &Path) -> Option<Loss> {
        assert!(PackFile::open(pack).unwrap().verify(|_, _| ()).is_empty());
        assert!(!self.stops, "stopped");
        Some(LOSS)
    }
}

#[test]
fn a_pack_tells_what_was_lost_and_is_else_the_same() {
    let clip = clip();
    let (out, plan) = (Scratch::new("foveal"), plan_of(&clip, &how()).unwrap());
    let prepare = |stops: bool| {
        let prepare = || prepare_resumable(&clip, claimed(&out), &plan, true, &mut Judge { stops });
        catch_unwind(AssertUnwindSafe(prepare))
    };
    assert!(prepare(true).is_err() && !out.exists());
    let made = prepare(false).unwrap().unwrap();
    let silent = prepared(&clip, &how());
    let [told, plain] = [&out, &silent].map(|file| PackFile::open(file).unwrap());
    let [told, plain] = [&told, &plain].map(|file| file.pack().description().clone());
    assert_eq!(told.loss, Some(LOSS));
    assert_eq!(made.description.loss, told.loss);
    let [mut rest, from] = [told, plain];
    rest.loss = None;
    assert_eq!(rest, from);
    let chunks = |file: &Path| bytes(file).split_off(4096);
    assert_eq!(chunks(&out), chunks(&silent));
}
