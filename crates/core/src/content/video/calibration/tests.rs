//! Do scores that were found come back, and is nonsense refused?

use super::*;
use crate::content::video::bytes::calibration_table::CALIBRATION_VERSION;
use proptest::prelude::*;

/// A judge that finds what a law says: of a loss the quality difference `times` that.
fn judged(times: f64) -> impl Fn(f64) -> f64 {
    move |loss| BEST_JOD - jod_lost(times * loss)
}

/// Rows of one rule at a density: the loss of a zone is half of the bound, and what a judge finds
/// of it is by zone.
fn rows(rule: Expectation, ppd: f64, times: [f64; ZONES]) -> Vec<CalibrationRow> {
    let parts = [(None, times[1])].into_iter();
    let parts = parts.chain((0..ZONES).map(|zone| (Some(zone), times[zone])));
    let rows = parts.flat_map(|(zone, times)| {
        [20.0, 80.0, 320.0, 1280.0].map(|bound| {
            let loss = bound / 2.0;
            let row = CalibrationRow {
                rule,
                ppd,
                zone,
                bound,
                loss,
                jod_mean: judged(times)(loss),
                jod_sd: 0.1,
                pixels_share: 0.5 / bound,
                bytes: 7,
            };
            row.as_told()
        })
    });
    rows.collect()
}

fn calibration() -> Calibration {
    let mut all = rows(Expectation::ByLoss, 10.0, [2.0, 1.0, 0.5]);
    all.extend(rows(Expectation::ByLoss, 20.0, [4.0, 2.0, 1.0]));
    all.extend(rows(Expectation::Elsewise, 10.0, [1.0; ZONES]));
    Calibration::new(3, 8, all).unwrap()
}

fn losses(loss: [f64; ZONES]) -> ZoneLosses {
    ZoneLosses {
        sums: loss.map(|loss| 100.0 * loss.powf(SPACE_EXPONENT)),
        pixels: [100.0; ZONES],
    }
}

#[test]
fn a_score_that_was_found_is_expected_again() {
    let scale = calibration().at(Some(Ppd(10.0)));
    let found = scale.expected(Expectation::ByLoss, &losses([40.0, 40.0, 40.0]));
    assert!(
        (found.worst_zone - judged(2.0)(40.0)).abs() < 0.01,
        "{found:?}"
    );
    let middle = judged(1.2)(40.0);
    assert!((found.jod - middle).abs() < 0.05, "{found:?} {middle}");
}

#[test]
fn nothing_lost_is_the_best_score_and_more_lost_is_a_lower_one_up_to_a_bound() {
    let scale = calibration().at(None);
    let jod = |loss: f64| {
        let losses = losses([loss; ZONES]);
        scale.expected(Expectation::ByLoss, &losses).jod
    };
    assert_eq!(jod(0.0), BEST_JOD);
    let jods: Vec<f64> = (0..60).map(|step| jod(0.01 * 1.5_f64.powi(step))).collect();
    let worst = jods[jods.len() - 1];
    let falls = |pair: &[f64]| pair[1] < pair[0] || pair[1] == worst;
    assert!(jods.windows(2).all(falls), "{jods:?}");
    assert!((7.0..8.0).contains(&worst), "{worst}");
    let is_known = |loss: f64| {
        let losses = losses([loss; ZONES]);
        scale.expected(Expectation::ByLoss, &losses).is_known
    };
    assert!(is_known(0.0) && is_known(1.0) && !is_known(1e6));
}

#[test]
fn the_bounds_of_a_target_have_that_score_in_each_zone() {
    for ppd in [10.0, 20.0, 14.0] {
        let scale = calibration().at(Some(Ppd(ppd)));
        for target in [8.5, 9.0, 9.5, 9.75] {
            let bounds = scale.bounds(target).unwrap();
            let halves = bounds.0.map(|bound| bound / 2.0);
            let found = scale.expected(Expectation::ByLoss, &losses(halves));
            // No bound goes beyond what was judged, whatever the target.
            let is_judged = bounds.0.iter().all(|bound| *bound < 1270.0);
            let off = (found.jod - target).abs();
            assert!(off < 0.02 || !is_judged, "{ppd} {target}: {found:?}");
            assert!(is_judged || target < 9.6, "{ppd} {target}: {bounds:?}");
            assert!(
                found.worst_zone > target - 0.02,
                "{ppd} {target}: {found:?}"
            );
        }
    }
}

#[test]
fn between_densities_scores_lie_between_and_beyond_them_the_nearest_counts() {
    let calibration = calibration();
    let bound = |ppd: f64| calibration.at(Some(Ppd(ppd))).bounds(9.5).unwrap().0[1];
    assert!(bound(10.0) > bound(14.0) && bound(14.0) > bound(20.0));
    assert_eq!([bound(2.0), bound(50.0)], [bound(10.0), bound(20.0)]);
    assert!(calibration.covers(Ppd(10.0)) && !calibration.covers(Ppd(30.0)));
}

#[test]
fn a_bound_changes_from_zone_to_zone_without_a_step() {
    let bounds = ZoneBounds([100.0, 200.0, 50.0]);
    let at = |degrees: f64| bounds.at(Radians::from_degrees(degrees));
    assert!((at(0.0) - 100.0).abs() < 1e-9 && (at(10.0) - 200.0).abs() < 1e-9);
    assert!((at(40.0) - 50.0).abs() < 1e-9);
    assert!((at(5.0) - 141.4).abs() < 0.1);
    for step in 0..4000 {
        let [here, next] = [0.0, 0.01].map(|more| at(f64::from(step) * 0.01 + more));
        assert!((next / here - 1.0).abs() < 0.02, "at {step}");
    }
}

#[test]
fn a_zone_that_was_not_seen_is_taken_for_the_whole() {
    let mut all = rows(Expectation::ByLoss, 10.0, [2.0, 1.0, 0.5]);
    all.retain(|row| row.zone != Some(2));
    let scale = Calibration::new(1, 1, all).unwrap().at(None);
    let found = scale.expected(Expectation::ByLoss, &losses([0.0, 0.0, 40.0]));
    assert!(
        (found.worst_zone - judged(1.0)(40.0)).abs() < 0.01,
        "{found:?}"
    );
}

#[test]
fn the_cheaper_rule_is_the_one_with_fewer_pixels() {
    let (rule, share) = calibration().cheaper(9.5, Some(Ppd(10.0))).unwrap();
    assert_eq!(rule, Expectation::ByLoss);
    assert!(share > 0.0);
    let only = rows(Expectation::Elsewise, 10.0, [1.0; ZONES]);
    let only = Calibration::new(1, 1, only).unwrap();
    assert_eq!(only.cheaper(9.5, None).unwrap().0, Expectation::Elsewise);
}

#[test]
fn without_a_judge_constants_stand_in() {
    let scale = Scale::usual();
    assert_eq!(scale.bounds(9.5), None);
    let told = Expectation::ByLoss.told(9.5);
    let found = scale.expected(Expectation::ByLoss, &losses([told; ZONES]));
    assert!((found.jod - 9.5).abs() < 1e-9);
}

#[test]
fn what_is_no_calibration_is_refused() {
    let good = calibration();
    let with = |change: &dyn Fn(&mut Vec<CalibrationRow>)| {
        let mut rows = good.rows().to_vec();
        change(&mut rows);
        Calibration::new(3, 8, rows)
    };
    assert_eq!(with(&|_| ()), Ok(good.clone()));
    for (number, change) in [
        &(|rows: &mut Vec<CalibrationRow>| rows.clear()) as &dyn Fn(&mut Vec<CalibrationRow>),
        &|rows| rows[1].jod_mean = 10.0,
        &|rows| rows[2].loss = 0.1,
        &|rows| rows[0].bound = f64::NAN,
        &|rows| rows[0].ppd = 0.0,
        &|rows| rows[0].jod_mean = 10.5,
        &|rows| rows.retain(|row| row.zone.is_some()),
        &|rows| rows[1].bound = rows[0].bound,
    ]
    .into_iter()
    .enumerate()
    {
        assert!(with(change).is_err(), "change {number}");
    }
}

#[test]
fn a_table_tells_what_was_written_and_damage_is_refused() {
    let good = calibration();
    let table = good.to_table();
    assert_eq!(Calibration::parse(table.version, &table.bytes), Ok(good));
    let refused = |version: u32, bytes: &[u8]| Calibration::parse(version, bytes).is_err();
    assert!(refused(CALIBRATION_VERSION + 1, &table.bytes));
    for cut in [0, 4, 7, 9, table.bytes.len() - 1] {
        assert!(refused(table.version, &table.bytes[..cut]), "{cut}");
    }
    let with = |change: &dyn Fn(&mut [u8])| {
        let mut bytes = table.bytes.clone();
        change(&mut bytes);
        refused(table.version, &bytes)
    };
    assert!(with(&|bytes| bytes[8] = 2), "another rule");
    let share = 1e30_f32.to_le_bytes();
    assert!(
        with(&|bytes| bytes[28..32].copy_from_slice(&share)),
        "a share"
    );
    let swapped = |bytes: &mut [u8]| bytes[8..72].rotate_left(32);
    assert!(with(&swapped), "rows in another order");
}

proptest! {
    #[test]
    fn any_bytes_are_a_calibration_that_can_be_asked_or_none(
        bytes in proptest::collection::vec(any::<u8>(), 0..400),
        count in 0u8..6,
    ) {
        let mut bytes = bytes;
        if let Some(head) = bytes.first_chunk_mut::<8>() {
            *head = [1, 0, 8, 0, count, 0, 0, 0];
        }
        bytes.truncate(8 + 32 * usize::from(count));
        if let Ok(calibration) = Calibration::parse(CALIBRATION_VERSION, &bytes) {
            let scale = calibration.at(None);
            let _ = (scale.bounds(9.5), calibration.cheaper(9.5, Some(Ppd(11.0))));
            let expected = scale.expected(Expectation::ByLoss, &losses([1.0; ZONES]));
            prop_assert!(!expected.jod.is_nan());
            prop_assert_eq!(calibration.to_table().bytes, bytes);
        }
    }
}

#[test]
fn losses_of_several_frames_are_pooled_as_those_of_one() {
    let mut all = losses([1.0, 2.0, 3.0]);
    let other = losses([1.0, 2.0, 3.0]);
    let whole = all.whole();
    all.add(&other);
    assert!((all.whole() - whole).abs() < 1e-12);
    assert!((all.zone(1).unwrap() - 2.0).abs() < 1e-12);
    assert_eq!(ZoneLosses::default().zone(0), None);
}
