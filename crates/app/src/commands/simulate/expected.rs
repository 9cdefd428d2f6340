//! Which score is expected of a run, and where is none?

use crate::report::output;
use foveal_play::{FramePlayer, FrameReport};

/// Why `expected_jod` is null under a link.
const NO_EXPECTED_JOD: &str = "under --link no score is expected (expected_jod is null): \
                               the expectation leaves out what is loaded outside the view and \
                               what uniform leaves; --score measures it";

/// Why it is null elsewhere.
const BEYOND_JUDGED: &str = "more detail is left out than was judged of this content, so no score \
                             is expected (expected_jod is null); --score measures it";

const OTHER_EYE: &str = "the pack was judged for the default eye: for the one of --set or \
                         --sensitivity a target is kept less well";

/// The sum of the quality differences that are expected of frames; `None` where more than a tenth
/// of them lose far more than was judged of the content.
pub(super) fn expected_of(reports: &[FrameReport]) -> Option<f64> {
    let expected: Option<Vec<_>> = reports.iter().map(|report| report.expected).collect();
    let expected = expected?;
    let unknown = expected.iter().filter(|it| !it.is_known).count();
    let sum = expected.iter().map(|it| it.quality).sum();
    (unknown * 10 <= expected.len()).then_some(sum)
}

/// Says where no score is expected, or one of another density, and why.
pub(super) fn tell_expectation(player: &FramePlayer, reports: &[FrameReport]) {
    if !player.knows_score() {
        output::say(NO_EXPECTED_JOD);
    } else if reports.iter().any(|it| it.expected.is_some()) && expected_of(reports).is_none() {
        output::say(BEYOND_JUDGED);
    }
    if player.is_of_another_eye() {
        output::say(OTHER_EYE);
    }
    if let Some(density) = player.unjudged_density() {
        output::say(&format!(
            "this view shows {:.1} pixels per degree, which is outside what was judged while \
             preparing; the nearest density counts, and a target may be missed",
            density.0
        ));
    }
}
