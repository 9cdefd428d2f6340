//! How many bytes can arrive before the next frame is shown?

use crate::units::Seconds;

/// Bytes that a link can bring, saved up while nothing is worth them.
///
/// What is not spent is kept for at most [`MOST_SAVED_S`] seconds: what has not been asked for
/// cannot have travelled, but requests that were made early wait at the receiver's end. A picture
/// that stands can wait longer for a unit that takes more than that: where all that is saved buys
/// nothing, it borrows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    bytes_per_s: f64,
    saved: f64,
    is_done: bool,
    stands: bool,
    /// How often what is saved was doubled since something was bought.
    doubled: u32,
}

/// How long unspent bytes are kept, in seconds.
pub const MOST_SAVED_S: f64 = 0.25;
/// How often what is saved is doubled for a picture that stands.
const MOST_DOUBLED: u32 = 5;
/// So much is borrowed at most, in seconds of the link.
const MOST_BORROWED_S: f64 = MOST_SAVED_S * (1_u32 << MOST_DOUBLED) as f64;

impl Budget {
    /// The budget of a link that brings `bytes_per_s`; infinite for content that lies at hand.
    #[must_use]
    pub fn new(bytes_per_s: f64) -> Self {
        Self {
            bytes_per_s,
            saved: 0.0,
            is_done: false,
            stands: false,
            doubled: 0,
        }
    }

    /// It brings so many bytes a second from now on; what is saved stays.
    pub fn set_rate(&mut self, bytes_per_s: f64) {
        self.bytes_per_s = bytes_per_s;
        self.saved = self.saved.min(bytes_per_s * MOST_SAVED_S);
        self.is_done = false;
    }

    /// Whether the picture stands from now on, and may wait for what takes long to arrive.
    pub fn stand(&mut self, stands: bool) {
        if self.stands != stands {
            (self.stands, self.doubled) = (stands, 0);
            // What was asked for and did not come is not waited for any more.
            self.saved = self.saved.max(0.0);
        }
    }

    /// Bytes that can be spent now, `passed` after the call before.
    pub fn after(&mut self, passed: Seconds) -> u64 {
        if self.bytes_per_s.is_infinite() {
            return u64::MAX;
        }
        let brought = self.bytes_per_s * passed.0.max(0.0);
        self.saved = (self.saved + brought).min(self.bytes_per_s * MOST_SAVED_S);
        (self.saved.max(0.0) * f64::from(1_u32 << self.doubled)) as u64
    }

    /// Takes bytes that were spent, or 0 where nothing was worth what could be.
    pub fn spend(&mut self, bytes: u64) {
        let most = self.bytes_per_s * MOST_SAVED_S;
        let bought_nothing = bytes == 0 && (self.bytes_per_s.is_infinite() || self.saved >= most);
        let borrows = self.stands && self.bytes_per_s.is_finite() && self.doubled < MOST_DOUBLED;
        self.is_done = bought_nothing && !borrows;
        self.doubled = match bought_nothing && borrows {
            true => self.doubled + 1,
            false => 0,
        };
        // What was borrowed is paid back before anything else is bought.
        let least = if self.stands {
            -self.bytes_per_s * MOST_BORROWED_S
        } else {
            0.0
        };
        self.saved = (self.saved - bytes as f64).max(least);
    }

    /// Takes bytes that the link brought besides what was bought, such as index pages: so much less
    /// is bought from now on.
    pub fn charge(&mut self, bytes: u64) {
        let least = -self.bytes_per_s * MOST_BORROWED_S;
        self.saved = (self.saved - bytes as f64).max(least);
    }

    /// Whether all that can ever be saved up bought nothing: for the same, waiting buys nothing.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.is_done
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_saves_no_more_than_a_quarter_second_and_never_loses_a_byte_before() {
        let mut budget = Budget::new(1000.0);
        assert_eq!(budget.after(Seconds(0.1)), 100);
        budget.spend(60);
        assert_eq!(budget.after(Seconds(0.1)), 140);
        assert_eq!(budget.after(Seconds(60.0)), 250);
        assert_eq!(budget.after(Seconds(-1.0)), 250);
    }

    #[test]
    fn a_budget_is_done_once_all_that_it_can_save_up_bought_nothing() {
        let mut budget = Budget::new(1000.0);
        let mut spend = |passed, bytes| {
            budget.after(Seconds(passed));
            budget.spend(bytes);
            budget.is_done()
        };
        assert!(!spend(0.1, 0), "there was more to come");
        assert!(spend(60.0, 0));
        assert!(!spend(0.1, 1), "what is bought may be followed by more");
        assert!(!spend(0.0, 0));
        assert!(spend(60.0, 0));
    }

    #[test]
    fn a_picture_that_stands_borrows_for_what_takes_longer_to_arrive_than_is_saved() {
        let mut budget = Budget::new(1000.0);
        budget.stand(true);
        // How many steps it takes until this unit is bought, or nothing is waited for any more.
        let mut until = |unit: u64| {
            for step in 1.. {
                let can = budget.after(Seconds(0.03));
                budget.spend(if can >= unit { unit } else { 0 });
                if can >= unit || budget.is_done() {
                    return (step, can >= unit);
                }
            }
            unreachable!("steps without end")
        };
        assert_eq!(until(200), (7, true), "what can be saved up is");
        assert_eq!(until(1900), (11, true));
        // What was borrowed is paid back first, and what is worth nothing is not waited for.
        assert_eq!(until(u64::MAX), (69, false));
        assert_eq!(
            budget.after(Seconds(60.0)),
            250,
            "nothing borrowed is lent twice"
        );
        budget.stand(false);
        assert_eq!(budget.after(Seconds(0.0)), 250);
        budget.spend(0);
        assert!(budget.is_done(), "playing, a frame does not borrow");
    }

    #[test]
    fn a_picture_that_stands_takes_no_more_in_the_long_run_than_the_link_brings() {
        let (rate, step, steps) = (1000.0, 0.03, 4000);
        let mut budget = Budget::new(rate);
        budget.stand(true);
        let mut bought = 0;
        for _ in 0..steps {
            let can = budget.after(Seconds(step));
            let unit = if can >= 1900 { 1900 } else { 0 };
            budget.spend(unit);
            bought += unit;
        }
        let brought = rate * step * f64::from(steps);
        let most = brought + rate * (MOST_SAVED_S + MOST_BORROWED_S);
        assert!(
            (0.8 * brought..=most).contains(&(bought as f64)),
            "{bought} of {brought}"
        );
    }

    #[test]
    fn what_came_beside_what_was_bought_is_paid_before_more_is() {
        let mut budget = Budget::new(1000.0);
        assert_eq!(budget.after(Seconds(0.1)), 100);
        budget.spend(100);
        budget.charge(150);
        assert_eq!(budget.after(Seconds(0.1)), 0);
        assert_eq!(budget.after(Seconds(0.1)), 50);
        let mut at_hand = Budget::new(f64::INFINITY);
        at_hand.charge(1 << 40);
        assert_eq!(at_hand.after(Seconds(0.0)), u64::MAX);
    }

    #[test]
    fn what_is_saved_stays_when_the_link_changes_its_rate() {
        let mut budget = Budget::new(1000.0);
        assert_eq!(budget.after(Seconds(0.2)), 200);
        budget.set_rate(2000.0);
        assert_eq!(budget.after(Seconds(0.0)), 200);
        budget.set_rate(400.0);
        assert_eq!(budget.after(Seconds(0.0)), 100);
    }

    #[test]
    fn content_at_hand_has_no_limit() {
        let mut budget = Budget::new(f64::INFINITY);
        assert_eq!(budget.after(Seconds(0.0)), u64::MAX);
        budget.spend(1 << 40);
        assert!(!budget.is_done());
        assert_eq!(budget.after(Seconds(0.0)), u64::MAX);
        budget.spend(0);
        assert!(budget.is_done());
    }
}
