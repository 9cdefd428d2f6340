//! How does what was played read as one page?
//!
//! The page holds all it shows: style, plots and pictures; it loads nothing and runs no script.

use crate::commands::demo::figures::{Cost, frames, ratio, rows};
use crate::commands::demo::machine::Machine;
use crate::commands::demo::pictures::{AMPLIFIED, Png};
use crate::commands::demo::run::{FOVEATED, FULL, Played, VIEWPORT};
use crate::commands::demo::{colours, facts, plots};
use crate::report::html::escape;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use foveal_core::view::surface::Projection;

const STYLE: &str = include_str!("report.css");
/// A larger share of what `viewport` takes is little gained.
const LITTLE: f64 = 0.8;
/// Pictures narrower than this are shown with their pixels visible.
const SMALL: u32 = 400;

/// The page.
pub(super) fn page(all: &[Played], machine: &Machine, seed: u64) -> String {
    let sections: String = all.iter().map(section).collect();
    let machine = escape(&machine.text());
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Foveal: only the detail that an eye can see</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
         <h1>Only the detail that an eye can see</h1>\n\
         <p class=\"lead\">The same content over the same gaze, three times: with everything in \
         full detail, with everything in view, and with only what the eye can resolve.</p>\n\
         <p class=\"soft\">{machine}. foveal {version}.</p>\n</header>\n<main>\n{sections}\n\
         {how}\n</main>\n</body>\n</html>\n",
        version = env!("CARGO_PKG_VERSION"),
        how = how_to_read(seed),
    )
}

fn section(played: &Played) -> String {
    format!(
        "<section>\n<h2>{}</h2>\n{}{}{}{}{}{}</section>\n",
        escape(&played.content.name),
        facts::paragraphs(played),
        stats(played),
        little_gained(played),
        pictures(played),
        plots::all(played),
        table(played),
    )
}

/// What the foveated policy costs and how it scores, in four figures.
fn stats(played: &Played) -> String {
    let figure = |name: &str, cost: Cost| {
        let of = |baseline| ratio(&played.runs, cost, FOVEATED, baseline) * 100.0;
        format!(
            "<div><dt>{name}</dt><dd><b>{:.1}&#8239;%</b><span>of full, {:.1}&#8239;% of \
             viewport</span></dd></div>\n",
            of(FULL),
            of(VIEWPORT)
        )
    };
    format!(
        "<dl class=\"stats\">\n{}{}{}{}</dl>\n",
        figure("Pixels a frame", Cost::Pixels),
        figure("Bytes fetched", Cost::Bytes),
        figure("Decoding time", Cost::DecodeTime),
        score(played),
    )
}

/// How good the foveated picture looks, next to what it saves.
fn score(played: &Played) -> String {
    let score = played.runs[FOVEATED].summary.score.as_ref();
    let (jod, of) = score.map_or_else(
        || ("&ndash;".to_owned(), "nothing was drawn to be scored"),
        |score| {
            (
                format!("{:.2}", score.jod),
                "JOD against full; 10 is no difference",
            )
        },
    );
    format!("<div><dt>Score</dt><dd><b>{jod}</b><span>{of}</span></dd></div>\n")
}

/// Says so where less than a fifth of pixels or bytes is saved against `viewport`, and why.
fn little_gained(played: &Played) -> String {
    let of_viewport = |cost| ratio(&played.runs, cost, FOVEATED, VIEWPORT);
    let [pixels, bytes] = [Cost::Pixels, Cost::Bytes].map(of_viewport);
    if pixels.max(bytes) <= LITTLE {
        return String::new();
    }
    let what = match (pixels > LITTLE, bytes > LITTLE) {
        (true, true) => "pixels and bytes",
        (true, false) => "pixels",
        _ => "bytes",
    };
    let why = match played.content.file.pack().description().projection {
        Projection::Flat => {
            "the picture is hardly larger than what the eye resolves at once at this distance"
        }
        Projection::Cube | Projection::Equirect => {
            "at this density even the finest tiles in view are hardly finer than the eye resolves"
        }
    };
    format!("<p>Little is gained here in {what}, because {why}.</p>\n")
}

fn pictures(played: &Played) -> String {
    let p = &played.pictures;
    let frame = played.moment.frame;
    let [inside, outside] = p.error.map(|error| format!("{error:.1}"));
    let shown = match p.atlas_shrunk {
        1 => "pixel for pixel".to_owned(),
        by => format!("{by} times smaller than held, on a side"),
    };
    let landed = if played.moment.landed {
        ", a moment after the eye has landed"
    } else {
        ""
    };
    let foveated = if p.error == [0.0, 0.0] {
        "What <code>perceptual</code> shows: the same, since the eye resolves all of it here."
    } else {
        "What <code>perceptual</code> shows: look for blur far from the gaze, and for none near it."
    };
    let figures = [
        picture("", &p.full, "Full", "Every tile at the finest level."),
        picture("", &p.foveated, "Foveated", foveated),
        picture(
            "",
            &p.heat_map,
            "Levels",
            "The ring is 2.5° round the gaze; thin lines are borders of tiles. Red is the finest \
             level: it lies round the gaze, and reaches as far as the tiles there do.",
        ),
        picture(
            "",
            &p.difference,
            "Difference",
            &format!(
                "|full − foveated|, {AMPLIFIED} times amplified: black round the gaze. Mean error \
                 of a colour value of 255: {inside} within the ring, {outside} beyond."
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
    format!(
        "<h3>Frame {frame}{landed}</h3>\n\
         <div class=\"pictures\">\n{}</div>\n{}",
        figures.concat(),
        colours::level_key(played.content.file.pack().description())
    )
}

/// A picture that a click shows larger.
fn picture(class: &str, png: &Png, title: &str, text: &str) -> String {
    let [width, height] = png.size;
    let small = if width < SMALL {
        " class=\"small\""
    } else {
        ""
    };
    format!(
        "<figure class=\"{class}\"><label><input type=\"checkbox\" aria-label=\"{title} larger\">\
         <img{small} width=\"{width}\" height=\"{height}\" alt=\"{title}\" \
         src=\"data:image/png;base64,{}\"></label>\
         <figcaption><b>{title}.</b> {text}</figcaption></figure>\n",
        STANDARD.encode(&png.bytes)
    )
}

fn table(played: &Played) -> String {
    let runs = &played.runs;
    let head: String = runs
        .iter()
        .map(|run| {
            format!(
                "<th scope=\"col\" class=\"{0}\">{0}</th>",
                run.summary.policy
            )
        })
        .collect();
    let body: String = rows(runs)
        .iter()
        .map(|row| {
            let cells: String = row
                .cells
                .iter()
                .map(|cell| format!("<td>{cell}</td>"))
                .collect();
            let unit = match row.unit {
                "" => String::new(),
                unit => format!(" <span>{unit}</span>"),
            };
            let class = if row.opens_group {
                " class=\"first\""
            } else {
                ""
            };
            format!(
                "<tr{class}><th scope=\"row\">{}{unit}</th>{cells}</tr>\n",
                row.what
            )
        })
        .collect();
    format!(
        "<h3>Figures of {}</h3>\n<table>\n<thead><tr><th></th>{head}</tr></thead>\n\
         <tbody>\n{body}</tbody>\n</table>\n",
        frames(runs)
    )
}

fn how_to_read(seed: u64) -> String {
    format!(
        "<section>\n<h2>How to read this</h2>\n\
         <p>The gaze is simulated: fixations of 300&#8239;ms joined by saccades of 5° to 15° to \
         anywhere on the content (seed {seed}); on 360° content the head follows. \
         <code>full</code> takes every tile at the finest level. <code>viewport</code> takes what \
         is in view and a margin of 10° as densely as the display can show it, which is what \
         is usual today. <code>perceptual</code> gives each tile the coarsest level at which \
         the picture is still expected to score 9.5 of 10 against <code>full</code>, by what \
         the tile would lose and what the eye sees of it there. \
         All three also hold the whole coarsest level, so that nothing is \
         ever missing.</p>\n\
         <p>The score is that of FovVideoVDP 1.2 in just-objectionable differences, of the first \
         {scored} frames against <code>full</code> in the same view for the true gaze: 10 is no \
         difference, at 9.5 about 63 of 100 people guess right which of the two is which, at 9 \
         75.</p>\n\
         <p>Pixels are those of all tiles of a frame, over the pixels of the finest level. \
         Decoding time runs from asking for the tiles of a frame until the last one is there, on \
         all cores; a frame is late when choosing and that take longer than it is shown, and \
         incomplete when a coarser tile stands in for one that was chosen. Bytes count each \
         tile’s group of pictures once, when it is first needed. The policies take turns \
         frame by frame in one run on the machine named above, so that other work on it touches \
         them alike.</p>\n\
         <p>Not measured: a network, which is left out (nothing waits for bytes); uploading and \
         drawing; sound; the delay and the error of a real eye tracker; and whether a person \
         would see the difference, which the pictures on this page cannot show, since you look at \
         them with a gaze of your own.</p>\n</section>\n",
        scored = crate::commands::demo::run::SCORED,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::demo::run::POLICIES;

    #[test]
    fn each_policy_has_a_visible_line_and_label_in_light_and_in_dark() {
        let paper = colours_of("paper");
        assert_eq!(paper.len(), 2);
        for policy in POLICIES {
            let name = policy.name();
            for rule in [
                format!(".line.{name} {{ stroke: var(--{name})"),
                format!(".label.{name} {{ fill: var(--{name})"),
                format!("th.{name} {{ color: var(--{name})"),
            ] {
                assert!(STYLE.contains(&rule), "{rule}");
            }
            let colours = colours_of(name);
            assert_eq!(colours.len(), 2, "{name}");
            for (colour, paper) in colours.iter().zip(&paper) {
                assert!(contrast(*colour, *paper) > 3.0, "{name}");
            }
        }
    }

    /// Red, green and blue of a variable, first light, then dark.
    fn colours_of(name: &str) -> Vec<[f64; 3]> {
        let variable = format!("--{name}: #");
        let all = STYLE.split(&variable).skip(1);
        let channel = |hex: &str| f64::from(u8::from_str_radix(hex, 16).unwrap()) / 255.0;
        all.map(|rest| [&rest[..2], &rest[2..4], &rest[4..6]].map(channel))
            .collect()
    }

    /// Contrast of two colours (WCAG 2.2): 1 to 21; graphics need 3.
    fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
        let luminance = |colour: [f64; 3]| {
            let [r, g, b] = colour.map(|c| match c <= 0.04045 {
                true => c / 12.92,
                false => ((c + 0.055) / 1.055).powf(2.4),
            });
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let [a, b] = [a, b].map(luminance);
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }
}
