//! What do the parts of films and pictures have in common?

use crate::commands::demo::page::part::{Card, Plot, Table, is_little, picture};
use crate::commands::demo::video::colours;
use crate::commands::demo::video::content::Prepared;
use crate::commands::demo::video::figures::{Cost, frames, jod, ratio, rows};
use crate::commands::demo::video::pictures::AMPLIFIED;
use crate::commands::demo::video::run::{COLUMNS, FOVEATED, FULL, Played, VIEWPORT};
use crate::commands::demo::video::setup::PlaySetup;
use crate::report::plot::{PlotLine, PlottedRun, lines};
use foveal_core::content::policy::DEFAULT_TARGET;
use foveal_core::units::counted;

/// What `auto` takes for a frame, over what the baselines take.
pub(crate) fn pixels_card(played: &Played) -> Card {
    let [of_full, of_viewport] = [FULL, VIEWPORT]
        .map(|baseline| percent(ratio(&played.runs, Cost::Pixels, FOVEATED, baseline)));
    let note = match of_full == of_viewport {
        true => "of full and of viewport".to_owned(),
        false => format!("of full; {of_viewport} of viewport"),
    };
    Card {
        name: "Pixels a frame",
        value: of_full,
        notes: vec![note],
    }
}

/// What `auto` fetched, over what the baselines did, and over the file itself where that is known.
pub(crate) fn bytes_card(played: &Played, content: &Prepared) -> Card {
    let bytes = played.runs[FOVEATED].summary.bytes as f64;
    let of_file = content.source_bytes().map(|file| {
        let times = bytes / file;
        format!("{times:.2} times the file for that time")
    });
    Card {
        name: "Bytes fetched",
        value: format!("{:.2}&#8239;MB", bytes / 1e6),
        notes: [of_baselines(played, Cost::Bytes)]
            .into_iter()
            .chain(of_file)
            .collect(),
    }
}

pub(crate) fn time_card(played: &Played) -> Card {
    Card {
        name: "Decoding a frame",
        value: format!(
            "{:.1}&#8239;ms",
            played.runs[FOVEATED].summary.decode_ms_mean
        ),
        notes: vec![of_baselines(played, Cost::DecodeTime)],
    }
}

/// How good `auto` looks, next to what it saves.
pub(crate) fn score_card(played: &Played) -> Card {
    let [full, own] = [FULL, FOVEATED].map(|run| &played.runs[run]);
    let against_full = jod(own.summary.score.as_ref());
    Card {
        name: "Score",
        value: format!("{against_full}&#8239;JOD"),
        notes: vec![
            format!(
                "against full, aims at {DEFAULT_TARGET}; {} judged",
                counted(played.judged, "frame")
            ),
            format!(
                "{} against the source, where full reaches {}",
                jod(own.source_score.as_ref()),
                jod(full.source_score.as_ref())
            ),
        ],
    }
}

/// What `auto` takes over what the baselines take; what is more is said as such.
fn of_baselines(played: &Played, cost: Cost) -> String {
    let [full, viewport] =
        [FULL, VIEWPORT].map(|baseline| ratio(&played.runs, cost, FOVEATED, baseline));
    let of = |share: f64, name: &str| match share > 1.0005 {
        true => format!("{} more than {name}", percent(share - 1.0)),
        false => format!("{} of {name}", percent(share)),
    };
    match percent(full) == percent(viewport) {
        true => of(full, "full and viewport"),
        false => format!("{}, {}", of(full, "full"), of(viewport, "viewport")),
    }
}

/// A share in percent, with one decimal or two digits.
pub(crate) fn percent(share: f64) -> String {
    let decimals = if share < 0.01 { 2 } else { 1 };
    format!("{:.decimals$}&#8239;%", share * 100.0)
}

/// What of pixels and bytes saves less than a fifth of what `viewport` takes, in words.
pub(crate) fn little_saved(played: &Played) -> Option<&'static str> {
    let of = |cost| is_little(ratio(&played.runs, cost, FOVEATED, VIEWPORT), 1.0);
    match (of(Cost::Pixels), of(Cost::Bytes)) {
        (true, true) => Some("pixels and bytes"),
        (true, false) => Some("pixels"),
        (false, true) => Some("bytes"),
        (false, false) => None,
    }
}

/// Pictures of one moment, under a heading.
pub(crate) fn pictures(played: &Played, content: &Prepared) -> String {
    let p = &played.pictures;
    let [inside, outside] = p.error.map(|error| format!("{error:.1}"));
    let shown = match p.atlas_shrunk {
        1 => "pixel for pixel".to_owned(),
        by => format!("at 1/{by} of the size on each side"),
    };
    let foveated = match p.error == [0.0, 0.0] {
        true => "What <code>auto</code> shows: the same, since the eye resolves all of it here.",
        false => "What <code>auto</code> shows: blurred far from the gaze, sharp near it.",
    };
    let figures = [
        picture("", &p.full, "Full", "Every tile at the finest level."),
        picture("", &p.foveated, "Foveated", foveated),
        picture(
            "",
            &p.heat_map,
            "Levels",
            "The ring is 2.5° round the gaze; thin lines are borders of tiles. Red is the finest \
             level.",
        ),
        picture(
            "",
            &p.difference,
            "Difference",
            &format!(
                "Full minus foveated, amplified {AMPLIFIED} times. Mean error of a colour value \
                 of 255: {inside} within the ring, {outside} beyond."
            ),
        ),
        picture(
            "wide atlas",
            &p.atlas,
            "Tile atlas",
            &format!(
                "All that is on the GPU for the foveated picture, {shown}: each tile framed in \
                 the colour of its level, finest first, the whole coarsest level last."
            ),
        ),
    ];
    let landed = match played.moment.landed {
        true => ", a moment after the eye has landed",
        false => "",
    };
    format!(
        "<h3>Frame {}{landed}</h3>\n<div class=\"pictures\">\n{}</div>\n{}",
        played.moment.frame,
        figures.concat(),
        colours::level_key(content.file.pack().description())
    )
}

/// Pixels over time under all policies.
pub(crate) fn pixels_plot(played: &Played) -> Plot {
    let run = PlottedRun {
        times: &played.times,
        unit: "seconds",
        moving: &played.moment.moving,
        pictured: Some(played.moment.frame as usize),
    };
    let line = |(index, class): (usize, &'static str)| PlotLine {
        class,
        values: played.runs[index]
            .reports
            .iter()
            .map(|report| report.share * 100.0)
            .collect(),
    };
    let all: Vec<PlotLine<'_>> = COLUMNS.into_iter().enumerate().map(line).collect();
    Plot {
        title: "Pixels a frame",
        text: "In % of the finest level. Grey bands are saccades; the dotted line is the frame in \
               the pictures.",
        svg: lines("Pixels a frame", &run, &all),
    }
}

/// All figures of all policies.
pub(crate) fn table(played: &Played, setup: &PlaySetup<'_>) -> Table {
    Table {
        title: format!(
            "Figures of {} (auto is {} here)",
            frames(&played.runs),
            setup.chosen.name()
        ),
        columns: COLUMNS.to_vec(),
        rows: rows(&played.runs, setup.judged_fps().is_none()),
    }
}
