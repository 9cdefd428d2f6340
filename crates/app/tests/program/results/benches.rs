//! Do benchmarks print what is documented?

use super::agrees;
use crate::support::json;

#[test]
fn what_weighing_costs_is_told_of_as_documented() {
    agrees(
        "bench perception",
        &[&json(&["bench", "perception", "--runs", "1"])],
    );
}

#[test]
fn what_scoring_costs_is_told_of_as_documented() {
    let least = ["--frames", "1", "--runs", "1", "--no-baseline"];
    agrees(
        "bench score",
        &[&json(&[&["bench", "score"], &least[..]].concat())],
    );
}
