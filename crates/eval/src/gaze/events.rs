//! How well do two labellings of the same samples agree?
//!
//! Sample by sample: Cohen's kappa (Cohen 1960). Event by event: F1, where a true event belongs to
//! the predicted event that overlaps it most (Zemblys et al. 2018; Dar et al. 2021, REMoDNaV).

use core::ops::Range;

/// What has been counted of two labellings; sums over trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Samples by `[true][predicted]`.
    samples: [[u64; 2]; 2],
    matched: u64,
    missed: u64,
    invented: u64,
    lags_ms: Vec<f64>,
    seconds: f64,
}

impl Agreement {
    /// Adds a trial: for each sample whether it truly is in an event and whether that was
    /// predicted, with `rate_hz` samples a second. Both must be of one length.
    pub fn add(&mut self, truly: &[bool], predicted: &[bool], rate_hz: f64) {
        assert_eq!(truly.len(), predicted.len(), "one label per sample");
        for (&t, &p) in truly.iter().zip(predicted) {
            self.samples[usize::from(t)][usize::from(p)] += 1;
        }
        let (true_events, found) = (runs(truly), runs(predicted));
        let pairs = pairs_by_overlap(&true_events, &found);
        for &(t, p) in &pairs {
            let lag = found[p].start as f64 - true_events[t].start as f64;
            self.lags_ms.push(lag / rate_hz * 1e3);
        }
        self.matched += pairs.len() as u64;
        self.missed += (true_events.len() - pairs.len()) as u64;
        self.invented += (found.len() - pairs.len()) as u64;
        self.seconds += truly.len() as f64 / rate_hz;
    }

    /// Adds what another has counted.
    pub fn merge(&mut self, other: &Self) {
        for t in 0..2 {
            for p in 0..2 {
                self.samples[t][p] += other.samples[t][p];
            }
        }
        self.matched += other.matched;
        self.missed += other.missed;
        self.invented += other.invented;
        self.lags_ms.extend(&other.lags_ms);
        self.seconds += other.seconds;
    }

    /// Cohen's kappa over samples: 1 is perfect, 0 is chance. `None` where one of the labellings
    /// leaves nothing to agree on.
    #[must_use]
    pub fn kappa(&self) -> Option<f64> {
        let n = |t: usize, p: usize| self.samples[t][p] as f64;
        let all = n(0, 0) + n(0, 1) + n(1, 0) + n(1, 1);
        let observed = (n(0, 0) + n(1, 1)) / all;
        let truly = (n(1, 0) + n(1, 1)) / all;
        let predicted = (n(0, 1) + n(1, 1)) / all;
        let chance = truly * predicted + (1.0 - truly) * (1.0 - predicted);
        (all > 0.0 && chance < 1.0).then(|| (observed - chance) / (1.0 - chance))
    }

    /// Harmonic mean of the shares of events that were found and that are true; `None` without
    /// any event.
    #[must_use]
    pub fn event_f1(&self) -> Option<f64> {
        let both = 2 * self.matched + self.missed + self.invented;
        (both > 0).then(|| (2 * self.matched) as f64 / both as f64)
    }

    /// How much later than the truth events were found, in milliseconds: the value that `share` of
    /// them do not exceed. `None` when none was.
    #[must_use]
    pub fn lag_ms(&self, share: f64) -> Option<f64> {
        let mut sorted = self.lags_ms.clone();
        sorted.sort_by(f64::total_cmp);
        let place = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(place.max(1) - 1).copied()
    }

    /// Predicted events that match none, per minute; `None` without samples.
    #[must_use]
    pub fn false_events_per_minute(&self) -> Option<f64> {
        (self.seconds > 0.0).then(|| self.invented as f64 * 60.0 / self.seconds)
    }
}

/// The stretches of `true`.
#[must_use]
pub fn runs(inside: &[bool]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = None;
    for (k, &now) in inside.iter().chain([&false]).enumerate() {
        match (now, start) {
            (true, None) => start = Some(k),
            (false, Some(from)) => {
                runs.push(from..k);
                start = None;
            }
            _ => {}
        }
    }
    runs
}

/// Pairs of true and predicted events that overlap, each event in one pair at most, the largest
/// overlaps first. Both lists in the order of time, without overlaps in themselves.
fn pairs_by_overlap(truly: &[Range<usize>], predicted: &[Range<usize>]) -> Vec<(usize, usize)> {
    let mut overlaps = Vec::new();
    let mut first = 0;
    for (t, event) in truly.iter().enumerate() {
        while predicted.get(first).is_some_and(|p| p.end <= event.start) {
            first += 1;
        }
        let near = predicted[first..]
            .iter()
            .take_while(|p| p.start < event.end);
        for (k, p) in near.enumerate() {
            overlaps.push((
                p.end.min(event.end) - p.start.max(event.start),
                t,
                first + k,
            ));
        }
    }
    overlaps.sort_by_key(|&(overlap, t, p)| (core::cmp::Reverse(overlap), t, p));
    let mut taken = (vec![false; truly.len()], vec![false; predicted.len()]);
    overlaps.retain(|&(_, t, p)| {
        let free = !taken.0[t] && !taken.1[p];
        taken.0[t] |= free;
        taken.1[p] |= free;
        free
    });
    overlaps.into_iter().map(|(_, t, p)| (t, p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Vec<bool> {
        text.bytes().map(|b| b == b's').collect()
    }

    fn agreement(truly: &str, predicted: &str) -> Agreement {
        let mut agreement = Agreement::default();
        agreement.add(&of(truly), &of(predicted), 1000.0);
        agreement
    }

    #[test]
    fn the_same_labels_agree_wholly_and_opposite_ones_not_at_all() {
        let same = agreement("..sss...ss", "..sss...ss");
        assert_eq!((same.kappa(), same.event_f1()), (Some(1.0), Some(1.0)));
        assert_eq!(same.lag_ms(0.9), Some(0.0));
        let opposite = agreement("..sss.....", "ss....ssss");
        assert!(opposite.kappa().unwrap() < 0.0);
        assert_eq!(opposite.event_f1(), Some(0.0));
    }

    #[test]
    fn kappa_has_the_value_of_cohen_s_formula() {
        // 20 both, 15 neither, 5 and 10 apart: observed 0.7, chance 0.5.
        let truly = [vec![true; 25], vec![false; 25]].concat();
        let found = [vec![true; 20], vec![false; 20], vec![true; 10]].concat();
        let mut agreement = Agreement::default();
        agreement.add(&truly, &found, 100.0);
        assert!((agreement.kappa().unwrap() - 0.4).abs() < 1e-12);
    }

    #[test]
    fn an_event_belongs_to_the_one_that_overlaps_it_most_and_to_no_other() {
        // One true event cut in two: one match, one false event.
        let cut = agreement(".ssssssss.", ".ss.sssss.");
        assert_eq!(cut.event_f1(), Some(2.0 / 3.0));
        assert_eq!(cut.lag_ms(0.5), Some(3.0));
        assert_eq!(cut.false_events_per_minute(), Some(6000.0));
        // Two true events in one predicted: one match, one miss.
        assert_eq!(
            agreement(".sss.ss...", ".ssssss...").event_f1(),
            Some(2.0 / 3.0)
        );
    }

    #[test]
    fn nothing_to_agree_on_is_not_a_number_made_up() {
        let nothing = agreement("....", "....");
        assert_eq!((nothing.kappa(), nothing.event_f1()), (None, None));
        assert_eq!(nothing.lag_ms(0.5), None);
        assert_eq!(Agreement::default().false_events_per_minute(), None);
    }
}
