//! What does a sphere gain in a headset?

use crate::commands::demo::page::part::ReportPart;
use crate::commands::demo::video::common::{
    bytes_card, little_saved, pictures, pixels_card, pixels_plot, score_card, table, time_card,
};
use crate::commands::demo::video::facts::paragraphs;
use crate::commands::demo::video::run::Played;
use crate::commands::demo::video::setup::PlaySetup;
use foveal_core::view::eye_view::EyeView;

/// The part of a sphere that was played.
pub(super) fn part(setup: &PlaySetup<'_>, played: &Played) -> ReportPart {
    let content = setup.content;
    let what = match setup.judged_fps() {
        Some(_) => "film all round",
        None => "still sphere",
    };
    let little = little_saved(played).map(|what| {
        format!(
            "even the finest tiles in view are hardly finer than what the eye resolves at this \
             density: <code>auto</code> takes nearly as many {what} as <code>viewport</code>"
        )
    });
    ReportPart {
        title: format!("A {what} in a headset: {}", content.name),
        facts: paragraphs(content, &seen(&setup.views()[0])),
        cards: vec![
            pixels_card(played),
            bytes_card(played, content),
            time_card(played),
            score_card(played),
        ],
        little,
        pictures: pictures(played, content),
        plot: pixels_plot(played),
        table: table(played, setup),
        took_s: 0.0,
    }
}

/// What shows it.
fn seen(view: &EyeView) -> String {
    let [w, h] = view.size;
    let across = 2.0 * view.field.right.atan().to_degrees();
    let ppd = view.ppd_towards(view.axes.forward).0;
    format!("The view is {w}×{h} pixels, {across:.0}° across, {ppd:.0} pixels per degree ahead.")
}
