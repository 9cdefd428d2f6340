//! Does a session keep its promises whatever comes late, twice, broken or never?

use crate::any_order::Stage;

/// Schedules that are run.
const SCHEDULES: u64 = 10_000;

#[test]
fn whatever_comes_when_the_picture_is_whole_and_the_same_events_give_the_same_actions() {
    let stage = Stage::new().unwrap();
    for seed in 0..SCHEDULES {
        let first = stage.run(seed);
        assert_eq!(stage.run(seed), first, "{seed} goes two ways");
    }
}
