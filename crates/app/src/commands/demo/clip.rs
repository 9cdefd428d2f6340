//! What does a flat film or picture gain, as it is?

use crate::commands::demo::page::part::{ReportPart, is_little};
use crate::commands::demo::video::common::{
    bytes_card, little_saved, pictures, pixels_card, pixels_plot, score_card, table, time_card,
};
use crate::commands::demo::video::content::Prepared;
use crate::commands::demo::video::facts::paragraphs;
use crate::commands::demo::video::run::{FOVEATED, Played};
use crate::commands::demo::video::setup::PlaySetup;
use foveal_core::view::surface::Screen;

/// The part of a flat content that was played.
pub(super) fn part(setup: &PlaySetup<'_>, played: &Played) -> ReportPart {
    let content = setup.content;
    let what = match setup.judged_fps() {
        Some(_) => "clip",
        None => "picture",
    };
    ReportPart {
        title: format!("A {what} as it is: {}", content.name),
        facts: paragraphs(content, &on(&setup.conditions.view.screen)),
        cards: vec![
            pixels_card(played),
            bytes_card(played, content),
            time_card(played),
            score_card(played),
        ],
        little: little(content, played),
        pictures: pictures(played, content),
        plot: pixels_plot(played),
        table: table(played, setup),
        took_s: 0.0,
    }
}

/// What shows it.
fn on(screen: &Screen) -> String {
    let (inches, metres) = (screen.diagonal_inches, screen.distance_m);
    format!("It fills a screen of {inches} inches, {metres} m away.")
}

/// Why little is gained, where that is so: against the file itself first, which a player fetches
/// otherwise.
fn little(content: &Prepared, played: &Played) -> Option<String> {
    let bytes = played.runs[FOVEATED].summary.bytes as f64;
    let file = content
        .source_bytes()
        .filter(|file| is_little(bytes, *file));
    if let Some(file) = file {
        return Some(format!(
            "what is fetched is {:.2} times as much as the file itself for that time: the whole \
             picture is in view, and tiles that can be fetched one by one take more bytes than \
             one picture",
            bytes / file
        ));
    }
    let what = little_saved(played)?;
    Some(format!(
        "the picture is hardly finer than what the eye resolves at this distance: <code>auto\
         </code> takes nearly as many {what} as <code>viewport</code>"
    ))
}
