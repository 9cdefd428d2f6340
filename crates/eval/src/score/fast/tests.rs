//! Does the fast path give the goldens, and what a score must give for any pictures?

use super::*;
use crate::score::clear::ClearJudge;
use crate::score::display::Display;
use crate::score::golden::{Foveation, Golden, scene};
use crate::score::rules::{Border, Mode, ScoreRules, SensitivityRule};
use proptest::prelude::*;
use sha2::{Digest, Sha256};

/// How far a golden may be off, JOD.
const TOLERANCE: f64 = 0.0005;
/// How far an energy may be off, as a share.
const ENERGY_TOLERANCE: f64 = 0.001;

fn viewing(golden: &Golden, rules: ScoreRules) -> Viewing {
    let display = Display::named(golden.display).unwrap();
    let foveated = golden.gaze_at(0).is_some();
    Viewing {
        rules,
        ..Viewing::new(display, golden.size, golden.fps, foveated, Mode::Compat).unwrap()
    }
}

fn score(golden: &Golden, rules: ScoreRules, threads: usize) -> Score {
    let mut judge = Judge::new(&viewing(golden, rules), threads).unwrap();
    for frame in 0..golden.frames {
        let [reference, test] = golden.pictures(frame).unwrap();
        let gaze = golden.gaze_at(frame).unwrap_or_default();
        judge.frame(&reference, &test, gaze).unwrap();
    }
    judge.score().unwrap()
}

fn assert_near(id: &str, what: &str, found: f64, wanted: f64, by: f64) {
    assert!(
        (found - wanted).abs() <= by,
        "{id}, {what}: {found}, wanted {wanted}"
    );
}

#[test]
fn golden_inputs_have_their_published_hashes() {
    for golden in Golden::all() {
        let mut hashes = [Sha256::new(), Sha256::new()];
        for frame in 0..golden.frames {
            for (hash, bytes) in hashes.iter_mut().zip(golden.bytes(frame)) {
                hash.update(&bytes);
            }
        }
        for (hash, wanted) in hashes.into_iter().zip(golden.sha256) {
            let digest = hash.finalize();
            let found: String = digest[..8]
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect();
            assert_eq!(found, wanted, "{}", golden.id);
        }
    }
}

#[test]
fn every_golden_has_its_published_score_and_energies() {
    for golden in Golden::all() {
        let found = score(golden, ScoreRules::COMPAT, 2);
        assert_near(golden.id, "JOD", found.jod, golden.jod, TOLERANCE);
        let published = golden.sustained.iter().chain(golden.transient);
        let bands = found.bands.iter();
        let energies = bands
            .clone()
            .map(|b| b.sustained)
            .chain(bands.map(|b| b.transient));
        for (band, (found, wanted)) in energies.zip(published).enumerate() {
            let by = wanted * ENERGY_TOLERANCE;
            assert_near(golden.id, &format!("energy {band}"), found, *wanted, by);
        }
        if !golden.sustained.is_empty() {
            assert_eq!(found.bands.len(), golden.sustained.len(), "{}", golden.id);
        }
    }
}

#[test]
fn with_the_right_border_every_golden_has_its_published_score() {
    let rules = ScoreRules {
        border: Border::ByColumns,
        ..ScoreRules::COMPAT
    };
    for golden in Golden::all() {
        let found = score(golden, rules, 2).jod;
        assert_near(
            golden.id,
            "right border",
            found,
            golden.jod_right_border,
            TOLERANCE,
        );
    }
}

#[test]
fn with_the_formula_in_place_of_its_table_every_golden_has_its_published_score() {
    let rules = ScoreRules {
        sensitivity: SensitivityRule::Fine,
        ..ScoreRules::COMPAT
    };
    for golden in Golden::all() {
        let found = score(golden, rules, 2).jod;
        assert_near(
            golden.id,
            "no table",
            found,
            golden.jod_fine_table,
            TOLERANCE,
        );
    }
}

/// The clear score and the mean of its heat map over the frames.
fn clear(golden: &Golden, rules: ScoreRules) -> (Score, Vec<f64>) {
    let viewing = viewing(golden, rules);
    let (mut judge, mut pool) = (ClearJudge::new(&viewing), Pool::default());
    let mut heat = vec![0.0; golden.size[0] as usize * golden.size[1] as usize];
    for frame in 0..golden.frames {
        let [reference, test] = golden.pictures(frame).unwrap();
        let gaze = golden.gaze_at(frame).unwrap_or_default();
        let found = judge.frame(&reference, &test, gaze).unwrap();
        pool.add(&found.score);
        for (sum, lost) in heat.iter_mut().zip(&found.heat.values) {
            *sum += lost / f64::from(golden.frames);
        }
    }
    (pool.score(&viewing.bands()).unwrap(), heat)
}

#[test]
fn the_fast_path_is_the_clear_one_in_both_modes() {
    for id in ["G1", "G2", "G4", "G9", "G13"] {
        let golden = Golden::named(id).unwrap();
        for rules in [ScoreRules::COMPAT, ScoreRules::STRICT] {
            let (wanted, _) = clear(golden, rules);
            let found = score(golden, rules, 1);
            assert_near(id, "JOD", found.jod, wanted.jod, 2e-5);
            for (found, wanted) in found.per_frame.iter().zip(&wanted.per_frame) {
                assert_near(id, "a frame", *found, *wanted, 5e-5);
            }
            let zones = |score: &Score| {
                score
                    .zones
                    .map_or([None; 2], |z| [z.under_5_deg, z.over_20_deg])
            };
            for (found, wanted) in zones(&found).into_iter().zip(zones(&wanted)) {
                assert_eq!(found.is_some(), wanted.is_some(), "{id}");
                if let (Some(found), Some(wanted)) = (found, wanted) {
                    // A pixel on the border of zones may fall to either.
                    assert_near(id, "a zone", found.jod, wanted.jod, 0.01);
                }
            }
        }
    }
}

#[test]
fn the_fast_path_is_the_clear_one_for_a_gaze_outside() {
    let pictures = Golden::named("G4").unwrap().bytes(0);
    let pictures = pictures.map(|rgb| ScorePicture::from_rgb8([321, 243], rgb).unwrap());
    for mode in [Mode::Compat, Mode::Strict] {
        let display = Display::named("standard_hmd").unwrap();
        let viewing = Viewing::new(display, [321, 243], None, true, mode).unwrap();
        for gaze in [[-200.0, 300.0], [9e3, -4e3], [1e300, 120.0]] {
            let mut fast = Judge::new(&viewing, 1).unwrap();
            let found = fast.frame(&pictures[0], &pictures[1], gaze).unwrap();
            let mut clear = ClearJudge::new(&viewing);
            let wanted = clear.frame(&pictures[0], &pictures[1], gaze).unwrap();
            let what = format!("{mode:?} {gaze:?}");
            assert_near("G4", &what, found.jod, wanted.score.jod, 1e-4);
        }
    }
}

#[test]
fn the_clear_text_has_the_published_scores() {
    for id in ["G3", "G4", "G9", "G10", "G11", "G12", "G13", "G15"] {
        let golden = Golden::named(id).unwrap();
        let (found, _) = clear(golden, ScoreRules::COMPAT);
        assert_near(id, "JOD", found.jod, golden.jod, TOLERANCE);
    }
}

#[test]
fn the_heat_map_is_the_clear_one() {
    for id in ["G4", "G9"] {
        let golden = Golden::named(id).unwrap();
        let (_, wanted) = clear(golden, ScoreRules::COMPAT);
        let mut judge = Judge::new(&viewing(golden, ScoreRules::COMPAT), 2).unwrap();
        judge.keep_heat();
        for frame in 0..golden.frames {
            let [reference, test] = golden.pictures(frame).unwrap();
            let gaze = golden.gaze_at(frame).unwrap_or_default();
            judge.frame(&reference, &test, gaze).unwrap();
        }
        let found = judge.heat().unwrap();
        let most = wanted.iter().copied().fold(0.0, f64::max);
        assert!(most > 0.5, "{most}");
        for (found, wanted) in found.jod_lost.iter().zip(wanted) {
            assert_near(id, "heat", f64::from(*found), wanted, 1e-3 * most);
        }
    }
}

#[test]
fn the_score_does_not_depend_on_the_number_of_threads_or_on_the_instructions() {
    let golden = Golden::named("G10").unwrap();
    for rules in [ScoreRules::COMPAT, ScoreRules::STRICT] {
        let one = score(golden, rules, 1);
        assert_eq!(one, score(golden, rules, 2));
        assert_eq!(one, score(golden, rules, 7));
        let mut judge = Judge::new(&viewing(golden, rules), 1).unwrap();
        judge.work.instructions = Instructions::least();
        for frame in 0..golden.frames {
            let [reference, test] = golden.pictures(frame).unwrap();
            let gaze = golden.gaze_at(frame).unwrap();
            judge.frame(&reference, &test, gaze).unwrap();
        }
        assert_eq!(one, judge.score().unwrap());
    }
}

#[test]
fn foveation_that_is_late_costs_half_a_jod_that_psnr_does_not_see() {
    let [right, late] = ["G9", "G10"].map(|id| Golden::named(id).unwrap());
    let [a, b] = [right, late].map(|golden| score(golden, ScoreRules::COMPAT, 2).jod);
    assert!((right.psnr_db - late.psnr_db).abs() < 0.1);
    assert!(a - b > 0.5, "{a} {b}");
}

const SIDE: u32 = 96;

fn still(mode: Mode, display: &str) -> Viewing {
    let display = Display::named(display).unwrap();
    Viewing::new(display, [SIDE; 2], None, true, mode).unwrap()
}

fn still_score(viewing: &Viewing, reference: &[u8], test: &[u8], gaze: [f64; 2]) -> f64 {
    let picture = |bytes: &[u8]| ScorePicture::from_rgb8([SIDE; 2], bytes.to_vec()).unwrap();
    let mut judge = Judge::new(viewing, 1).unwrap();
    judge
        .frame(&picture(reference), &picture(test), gaze)
        .unwrap()
        .jod
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn what_is_the_same_is_10(
        shift in 0.0..5000.0,
        gaze in [0.0..95.0, 0.0..95.0],
        mode in prop_oneof![Just(Mode::Compat), Just(Mode::Strict)],
    ) {
        let picture = scene([SIDE; 2], shift);
        let found = still_score(&still(mode, "standard_hmd"), &picture, &picture, gaze);
        prop_assert_eq!(found, 10.0);
    }

    #[test]
    fn more_blur_never_scores_higher(
        shift in 0.0..5000.0,
        gaze in [0.0..95.0, 0.0..95.0],
        mode in prop_oneof![Just(Mode::Compat), Just(Mode::Strict)],
    ) {
        let reference = scene([SIDE; 2], shift);
        let viewing = still(mode, "standard_hmd");
        let mut before = 10.0;
        for most in 1..=4 {
            let blurred = Foveation { round: gaze, radius: 1e-6, tile: 16, most };
            let test = blurred.of([SIDE; 2], &reference);
            let found = still_score(&viewing, &reference, &test, gaze);
            prop_assert!(found < before, "level {}: {} after {}", most, found, before);
            before = found;
        }
    }

    #[test]
    fn looking_past_an_even_blur_never_lowers_the_score(
        shift in 0.0..5000.0,
        towards in 0.0..std::f64::consts::TAU,
        mode in prop_oneof![Just(Mode::Compat), Just(Mode::Strict)],
    ) {
        let reference = scene([SIDE; 2], shift);
        let even = Foveation { round: [0.0; 2], radius: 1e-6, tile: 16, most: 2 };
        let test = even.of([SIDE; 2], &reference);
        let viewing = still(mode, "standard_hmd");
        let (down, right) = towards.sin_cos();
        let mut before = 0.0;
        for apart in [0.0, 120.0, 400.0, 3e3, 1e7, 1e300] {
            let gaze = [right, down].map(|part| f64::from(SIDE / 2) + part * apart);
            let found = still_score(&viewing, &reference, &test, gaze);
            prop_assert!(found >= before - 1e-3, "{}: {} after {}", apart, found, before);
            prop_assert!(found < 10.0);
            before = found;
        }
    }

    #[test]
    fn looking_at_the_blurred_part_never_raises_the_score(
        shift in 0.0..5000.0,
        row in 20.0..75.0,
        mode in prop_oneof![Just(Mode::Compat), Just(Mode::Strict)],
    ) {
        let reference = scene([SIDE; 2], shift);
        // Sharp to the left of the middle, coarse to the right.
        let coarse = Foveation { round: [0.0; 2], radius: 1e-6, tile: 16, most: 3 };
        let coarse = coarse.of([SIDE; 2], &reference);
        let half = |at: usize| (at / 3) % SIDE as usize >= SIDE as usize / 2;
        let test: Vec<u8> = (0..reference.len())
            .map(|at| if half(at) { coarse[at] } else { reference[at] })
            .collect();
        let viewing = still(mode, "standard_hmd");
        let mut before = f64::MAX;
        for column in [8.0, 72.0] {
            let found = still_score(&viewing, &reference, &test, [column, row]);
            prop_assert!(found <= before + 1e-6, "{}: {} after {}", column, found, before);
            before = found;
        }
    }
}

#[test]
fn the_smallest_picture_and_a_video_of_one_frame_have_scores() {
    let display = Display::named("standard_4k").unwrap();
    for fps in [None, Some(1.0), Some(30.0), Some(1000.0)] {
        for mode in [Mode::Compat, Mode::Strict] {
            let viewing = Viewing::new(display.clone(), [16; 2], fps, true, mode).unwrap();
            let reference = ScorePicture::from_rgb8([16; 2], scene([16; 2], 0.0)).unwrap();
            let test = ScorePicture::from_rgb8([16; 2], scene([16; 2], 7.0)).unwrap();
            let mut judge = Judge::new(&viewing, 3).unwrap();
            judge.frame(&reference, &test, [8.0, 8.0]).unwrap();
            let found = judge.score().unwrap();
            assert!(
                found.jod.is_finite() && found.jod < 10.0,
                "{fps:?}: {found:?}"
            );
            assert_eq!(found.frames, 1);
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let viewing = still(Mode::Compat, "standard_fhd");
    let mut judge = Judge::new(&viewing, 1).unwrap();
    let right = ScorePicture::from_rgb8([SIDE; 2], scene([SIDE; 2], 0.0)).unwrap();
    let wrong = ScorePicture::from_rgb8([SIDE, 48], scene([SIDE, 48], 0.0)).unwrap();
    let error = judge.frame(&right, &wrong, [0.0; 2]).unwrap_err();
    assert!(
        error.to_string().contains("96x48 pixels where 96x96"),
        "{error}"
    );
    let error = judge.frame(&right, &right, [f64::NAN, 0.0]).unwrap_err();
    assert!(error.to_string().contains("the gaze is NaN,0"), "{error}");
    assert!(Judge::new(&viewing, 0).is_err());
    assert!(judge.score().is_none());
}
